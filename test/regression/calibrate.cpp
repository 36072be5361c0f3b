// The calibration of tools/study/calibration.hpp on simulated drops: the shipped ones, whose truth their comments
// state, and noise drawn here.
#include "common/degrees.hpp"
#include "tools/study/calibration.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/error.hpp"
#include "common/random.hpp"
#include "landing/run/simulate.hpp"
#include "test/folder.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::tools;
using landing::kAcc, landing::kOutputs, landing::kThighAngle, landing::kThighX, landing::kThighY;
using test::table2_sea;

namespace {

const std::string kFolder = UKEMI_DATASETS "/drops/";
constexpr std::size_t kCalibrated = 4;
constexpr std::array<double, kCalibrated> kTruth = {6000, 110, 40, -8 * kDegree};  // tools/data/make_drops.cpp

landing::Scene first_guess() { return landing::read_scene(kFolder + "first_guess.toml"); }
landing::Scene truth() {
  landing::Scene s = first_guess();
  s.floor = landing::Floor<double>{kTruth[0], kTruth[1], kTruth[2]}, s.drop.pitch = kTruth[3];
  return s;
}
/// The constants off by these shares.
landing::Scene off(const std::array<double, kCalibrated>& shares) {
  landing::Scene s = truth();
  s.floor->stiffness *= 1 + shares[0], s.floor->damping_normal *= 1 + shares[1];
  s.floor->damping_tangential *= 1 + shares[2], s.drop.pitch *= 1 + shares[3];
  return s;
}

LoggedDrop shipped(const std::string& log, const std::string& motion, double height) {
  LoggedDrop d{.log = landing::read_drop(kFolder + log + ".csv"),
               .motion = landing::read_motion(kFolder + motion + ".toml"),
               .thrown = first_guess().drop};
  d.thrown.height = height;
  return d;
}
std::vector<LoggedDrop> fitted() {
  return {shipped("drop_1", "hold", 0.4), shipped("drop_2", "hold", 0.25), shipped("drop_3", "bend", 0.4)};
}
LoggedDrop unseen() { return shipped("validation", "bend", 0.32); }

void check_truth(const Calibration& c, double standard_errors) {
  REQUIRE(c.converged);
  for (std::size_t k = 0; k < kCalibrated; ++k) {
    const identify::Estimate& e = c.parameters[k];
    INFO(e.name << " " << e.value << " +- " << e.std.value_or(-1));
    REQUIRE(e.std.has_value());
    CHECK(std::abs(e.value - kTruth[k]) < standard_errors * *e.std);
    CHECK(c.parameters[k].verdict == Identifiability::kTrusted);
  }
}

constexpr landing::Motion kHold{-45 * kDegree, -45 * kDegree, 1}, kBend{-25 * kDegree, -80 * kDegree, 0.2};
constexpr double kNoiseAcc = 2, kNoisePlace = 5e-4, kNoiseAngle = 0.2 * kDegree;

/// A drop simulated here, by `simulate`, another path through the events than the fit's. The log's clock starts `late`
/// seconds after the release.
LoggedDrop simulated(const landing::Scene& scene, const landing::Motion& motion, double height, std::uint64_t draw,
                     double late = 0, double until = 1) {
  landing::Scene s = scene;
  s.drop.height = height, s.t_end = until;
  LoggedDrop d{.log = {}, .motion = motion, .thrown = s.drop};
  d.log.file = "simulated";
  constexpr double kFine = 1e4;
  const landing::Landing l = landing::simulate(
      s, table2_sea(), motion, {.accuracy = 1e-12, .rest = landing::SimulateOptions::Rest::kIgnore}, kFine);
  Random random(2026, draw);
  long next = std::lround(late * kFine);
  for (const landing::Sample& x : l.trajectory) {
    if (std::abs(x.t * kFine - double(next)) > 1e-5) continue;
    next += 10;
    d.log.t.push_back(x.t - late);
    d.log.output[kAcc].push_back(x.acc + kNoiseAcc * random.normal());
    d.log.output[kThighX].push_back(x.x0 + kNoisePlace * random.normal());
    d.log.output[kThighY].push_back(x.y0 + kNoisePlace * random.normal());
    d.log.output[kThighAngle].push_back(x.phi0 + kNoiseAngle * random.normal());
  }
  return d;
}

}  // namespace

TEST_CASE("calibrate: the shipped drops give their truth back from a first guess 30 % off, and predict the fourth") {
  const Calibration c = calibrate(first_guess(), table2_sea(), fitted());
  check_truth(c, 4);
  CHECK(c.trusted());
  CHECK(c.starts == 1);
  CHECK(c.warnings.empty());
  CHECK(c.rms[kAcc] == Approx(kNoiseAcc).epsilon(0.03));
  CHECK(c.rms[kThighX] == Approx(kNoisePlace).epsilon(0.03));
  CHECK(c.rms[kThighY] == Approx(kNoisePlace).epsilon(0.03));
  CHECK(c.rms[kThighAngle] == Approx(kNoiseAngle).epsilon(0.03));
  CHECK(c.correlation(0, 1) > 0.9);  // K_f with C_fy

  const Calibration v = validate(c.scene, table2_sea(), {unseen()});
  CHECK(v.converged);
  CHECK(v.warnings.empty());
  CHECK(v.rms[kAcc] == Approx(kNoiseAcc).epsilon(0.06));
  CHECK(v.rms[kThighY] == Approx(kNoisePlace).epsilon(0.06));
  CHECK(v.drops[0].peak_simulated == Approx(v.drops[0].peak_measured).margin(4 * kNoiseAcc));
  CHECK(v.drops[0].peak_between > v.drops[0].peak_simulated);  // the peak is a right limit between two samples
}

TEST_CASE("calibrate: starts 30 % off in every constant, either way, end at one minimum") {
  const std::vector<LoggedDrop> drops = fitted();
  CalibrationOptions once;
  once.restarts = 0;
  const double cost = calibrate(truth(), table2_sea(), drops, once).cost;
  for (int corner = 0; corner < 16; corner += 3) {
    const auto share = [&](int bit) { return corner >> bit & 1 ? 0.3 : -0.3; };
    const Calibration c = calibrate(off({share(0), share(1), share(2), share(3)}), table2_sea(), drops, once);
    INFO("corner " << corner);
    CHECK(c.converged);
    CHECK(c.cost == Approx(cost).epsilon(1e-6));
  }
}

TEST_CASE("calibrate: the acceleration alone is enough") {
  std::vector<LoggedDrop> drops = fitted();
  for (LoggedDrop& d : drops)
    for (const auto o : {kThighX, kThighY, kThighAngle}) d.log.output[o].clear();
  const Calibration c = calibrate(first_guess(), table2_sea(), drops);
  check_truth(c, 4);
  CHECK(std::isnan(c.rms[kThighX]));
}

TEST_CASE("calibrate: 95 % of the 95 % intervals hold the truth") {
  constexpr int kDraws = 24;
  int inside = 0;
  double squares = 0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const Calibration c = calibrate(truth(), table2_sea(), {simulated(truth(), kHold, 0.4, i)});
    REQUIRE(c.converged);
    for (std::size_t k = 0; k < kCalibrated; ++k) {
      const identify::Estimate& e = c.parameters[k];
      REQUIRE(e.std.has_value());
      inside += e.ci_low < kTruth[k] && kTruth[k] < e.ci_high;
      squares += std::pow((e.value - kTruth[k]) / *e.std, 2) / (kDraws * kCalibrated);
    }
  }
  // The four constants of a draw correlate, so 96 intervals count for some 48: 0.95 +- 3 sqrt(0.95 0.05 / 48).
  CAPTURE(inside, squares);
  CHECK(inside >= 0.855 * kDraws * kCalibrated);
  CHECK(squares < 1.7);
  CHECK(squares > 0.5);
}

TEST_CASE("calibrate: the instant of the release is fitted along, drop by drop, and on a drop that validates") {
  const std::vector<double> late = {0.0013, 0.0021};
  CalibrationOptions options;
  options.terms.nuisance = {"time_shift"};
  const Calibration c =
      calibrate(first_guess(), table2_sea(),
                {simulated(truth(), kHold, 0.4, 100, late[0]), simulated(truth(), kBend, 0.4, 101, late[1])}, options);
  check_truth(c, 4);
  REQUIRE(c.nuisance.size() == 2);
  for (std::size_t m = 0; m < 2; ++m) {
    REQUIRE(c.nuisance[m].std.has_value());
    CHECK(*c.nuisance[m].std < 1e-4);
    CHECK(std::abs(c.nuisance[m].value - late[m]) < 4 * *c.nuisance[m].std);
    CHECK(c.nuisance[m].trial == int(m));
  }
  const LoggedDrop other = simulated(truth(), kBend, 0.32, 102, 0.0025);
  const Calibration v = validate(c.scene, table2_sea(), {other}, options);
  REQUIRE(v.nuisance.size() == 1);
  CHECK(v.nuisance[0].value == Approx(0.0025).margin(1e-4));
  CHECK(v.rms[kAcc] == Approx(kNoiseAcc).epsilon(0.06));
  const Calibration wrong = validate(c.scene, table2_sea(), {other});  // an instant 2.5 ms off shows
  CHECK(wrong.rms[kAcc] > 2 * kNoiseAcc);
  CHECK(wrong.warnings.size() >= 1);
}

TEST_CASE("calibrate: what a log does not tell is said, and a prior fills in") {
  // A log that ends 3 ms after the first touchdown: one short push of the floor.
  landing::Scene slippery = truth();
  slippery.floor->damping_tangential = 0.2;
  const std::vector<LoggedDrop> drops = {simulated(slippery, kHold, 0.4, 200, 0, 0.289)};
  const Calibration c = calibrate(slippery, table2_sea(), drops);
  CHECK_FALSE(c.trusted());
  CHECK(c.parameters[2].verdict != Identifiability::kTrusted);
  CHECK(c.parameters[2].verdict != Identifiability::kWeak);
  CHECK(c.warnings.size() >= 1);

  CalibrationOptions known;
  known.terms.priors = {{"damping_tangential", 0.2, 0.01}};
  const Calibration p = calibrate(slippery, table2_sea(), drops, known);
  REQUIRE(p.parameters[2].std.has_value());
  CHECK(*p.parameters[2].std == Approx(0.01).epsilon(0.2));
  CHECK(p.parameters[2].value == Approx(0.2).margin(0.01));

  CalibrationOptions fewer;
  fewer.terms.free = {"stiffness"};
  const Calibration one = calibrate(slippery, table2_sea(), drops, fewer);
  for (std::size_t k = 1; k < kCalibrated; ++k) CHECK(one.parameters[k].verdict == Identifiability::kFixed);
  CHECK(one.scene.floor->damping_normal == 110);
  CHECK_FALSE(one.parameters[1].free);
}

TEST_CASE("calibrate: a robot that is not the scene's is not trusted") {
  landing::Scene wrong = truth();
  wrong.robot.mass[1] *= 1.1;
  CalibrationOptions once;
  once.restarts = 0;
  const Calibration c = calibrate(wrong, table2_sea(), fitted(), once);
  CHECK_FALSE(c.trusted());
  CHECK(c.rms[kAcc] > identify::kFarAboveNoise * c.noise[kAcc]);
  CHECK(c.warnings.size() >= 1);
}

TEST_CASE("calibrate: its scene holds the verdicts, and what was worked is told wherever it ends") {
  CalibrationOptions options;
  options.restarts = 0;
  const Calibration whole = calibrate(first_guess(), table2_sea(), fitted(), options);
  REQUIRE(whole.scene.verdicts.size() == kCalibrated);
  for (std::size_t k = 0; k < kCalibrated; ++k)
    CHECK(whole.scene.verdicts[k] == std::pair(whole.parameters[k].name, std::string("trusted")));
  long asked = 0;
  options.monitor.stop = [&] { return ++asked > 2; };
  const Calibration ended = calibrate(first_guess(), table2_sea(), fitted(), options);
  CHECK_FALSE(ended.converged);
  CHECK(ended.steps > 0);
  CHECK(ended.steps < whole.steps);
  CHECK(ended.scene.verdicts[0] == std::pair(std::string("stiffness"), std::string("not identifiable")));
}

TEST_CASE("calibrate: logs and options that cannot be fitted are refused") {
  using Catch::Matchers::Contains;
  const std::vector<LoggedDrop> drops = {fitted()[0]};
  const auto refused = [&](const landing::Scene& s, const std::vector<LoggedDrop>& d, const CalibrationOptions& o,
                           const std::string& text) {
    CHECK_THAT(test::refusal([&] { (void)calibrate(s, table2_sea(), d, o); }), Contains(text));
  };
  refused(truth(), {}, {}, "no drops");
  landing::Scene airy = truth();
  airy.floor.reset();
  refused(airy, drops, {}, "no [floor]");
  std::vector<LoggedDrop> high = drops;
  high[0].thrown.height = 10;
  refused(truth(), high, {}, "before the first touchdown");
  std::vector<LoggedDrop> empty = drops;
  for (auto& o : empty[0].log.output) o.clear();
  refused(truth(), empty, {}, "no measured value");
  CalibrationOptions o;
  o.terms.free = {};
  refused(truth(), drops, o, "nothing to fit");
  o = {}, o.terms.lower["damping_normal"] = -1;
  refused(truth(), drops, o, "at least 0");
  o = {}, o.terms.upper["stiffness"] = 0;
  refused(truth(), drops, o, "lower < upper");
  o = {}, o.terms.priors = {{"pitch", 0, 0}};
  refused(truth(), drops, o, "above 0");
  o = {}, o.terms.nuisance = {"pitch_offset"};
  refused(truth(), drops, o, "not both");
}
