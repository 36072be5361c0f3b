// Calibration of robots of links on drops that another simulator made (maximal.hpp), noise put on.
#include "tools/study/body_calibration.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>

#include "common/degrees.hpp"
#include "common/random.hpp"
#include "landing/drops/drop_rollout.hpp"
#include "test/folder.hpp"
#include "test/legs/maximal.hpp"
#include "test/legs/robots.hpp"

using namespace legs;
using namespace ukemi::tools;

namespace {

constexpr std::uint64_t kSeed = 20261125;
constexpr double kNoiseAcc = 1, kNoisePlace = 5e-4, kNoiseAngle = 0.2 * kDegree, kRate = 1000;

/// A drop of the scene from a height, its joints held; what each channel of `logged` measures, with noise.
BodyLoggedDrop dropped(const BodyScene& scene, const std::vector<double>& held_deg, double height, int samples,
                       std::uint64_t draw) {
  BodyScene s = scene;
  s.drop.height = height;
  BodyLoggedDrop d{.log = {}, .motion = held_posture(s), .thrown = s.drop};
  for (std::size_t j = 0; j < held_deg.size(); ++j) d.motion[j] = {held_deg[j] * kDegree, held_deg[j] * kDegree, 1};
  d.log.file = "simulated";
  const std::vector<DropChannel> channels = body_channels(s.robot);
  d.log.output.assign(channels.size(), {});
  Random random(kSeed, draw);
  for (const MaximalRobot::Row& row : MaximalRobot(s, d.motion).run(samples, kRate)) {
    d.log.t.push_back(row.t);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const auto k = std::size_t(channels[c].index);
      auto& to = d.log.output[c];
      switch (channels[c].kind) {
        case DropChannel::Kind::kAcc:
          to.push_back(row.acc.norm() + kNoiseAcc * random.normal());
          break;
        case DropChannel::Kind::kOriginX:
          if (k == 0 && s.robot.base == Base::kFree) to.push_back(row.origin[k].x() + kNoisePlace * random.normal());
          break;
        case DropChannel::Kind::kOriginY:
          if (k == 0) to.push_back(row.origin[k].y() + kNoisePlace * random.normal());
          break;
        case DropChannel::Kind::kTheta:
          if (k == 0 && s.robot.base == Base::kFree) to.push_back(row.theta[k] + kNoiseAngle * random.normal());
          break;
        case DropChannel::Kind::kPhi:
          to.push_back(row.phi[k] + kNoiseAngle * random.normal());
          break;
        default:
          break;
      }
    }
  }
  return d;
}

/// A floor of a law for a leg on a rail, drawn.
BodyScene drawn_floor(const FloorLaw& law, std::uint64_t draw) {
  BodyScene s = shipped("hopper");
  Random r(kSeed, draw);
  ContactLaw to{.stiffness = r.uniform(8e3, 25e3), .damping_normal = r.uniform(60, 200), .damping_tangential = 0};
  to.damping_tangential = r.uniform(30, 80);
  if (law.coulomb) to.friction = r.uniform(0.25, 0.6), to.stiffness_tangential = to.stiffness * r.uniform(0.5, 1.2);
  if (law.hunt_crossley) {
    to.hunt_crossley = true, to.damping_normal = 0;
    to.exponent = r.uniform(1.3, 1.7), to.dissipation = r.uniform(0.2, 0.8), to.stiffness *= r.uniform(6, 12);
  }
  const Pad pad{r.uniform(0.005, 0.02), r.uniform(2e3, 6e3), r.uniform(20, 60)};
  for (ContactPoint& c : s.robot.contacts) {
    c.law = to;
    if (law.pads) c.pad = pad;
  }
  return s;
}
/// Three drops of it in three postures.
std::vector<BodyLoggedDrop> three_drops(const BodyScene& s, std::uint64_t draw) {
  constexpr int kSamples = 500;
  return {dropped(s, {35, -70}, 0.3, kSamples, 3 * draw), dropped(s, {60, -70}, 0.2, kSamples, 3 * draw + 1),
          dropped(s, {10, -60}, 0.15, kSamples, 3 * draw + 2)};
}
/// Its constants off by up to 30 %.
BodyScene guess(BodyScene s, std::uint64_t draw) {
  Random r(kSeed, 1000 + draw);
  const auto off = [&](double& x) { x *= r.uniform(0.75, 1.3); };
  ContactLaw law = s.robot.contacts[0].law;
  off(law.stiffness), off(law.damping_normal), off(law.dissipation);
  off(law.damping_tangential), off(law.stiffness_tangential), off(law.friction);
  std::optional<Pad> pad = s.robot.contacts[0].pad;
  if (pad) off(pad->thickness), off(pad->stiffness), off(pad->damping);
  for (ContactPoint& c : s.robot.contacts) {
    const bool linear = !law.hunt_crossley;
    c.law = law, c.pad = pad;
    if (linear) c.law.dissipation = 0;
  }
  return s;
}
BodyCalibration fitted(const BodyScene& from, const std::vector<BodyLoggedDrop>& drops, int restarts,
                       bool rivals = false) {
  BodyCalibrationOptions o;
  o.terms = drop_choice(from), o.restarts = restarts;
  o.rivals = rivals ? BodyCalibrationOptions::Rivals::kTried : BodyCalibrationOptions::Rivals::kNone;
  return calibrate(from, drops, o);
}
const identify::Estimate& constant(const BodyCalibration& c, const std::string& name) {
  return *std::find_if(c.parameters.begin(), c.parameters.end(), [&](auto& e) { return e.name == name; });
}

/// A law that a floor has, and one that it has not.
struct Case {
  const char* name;
  FloorLaw truth, wrong;
};
constexpr Case kCases[] = {{"linear fitted to Hunt and Crossley", {true, true, false}, {false, true, false}},
                           {"viscous fitted to Coulomb", {false, true, false}, {false, false, false}},
                           {"none fitted to pads", {false, true, true}, {false, true, false}}};

}  // namespace

// With UKEMI_DRAWS=20 the floors of issue 38: half an hour.
TEST_CASE("calibrate: friction within its errors, right laws kept and wrong ones rejected on drawn floors") {
  const char* asked = std::getenv("UKEMI_DRAWS");
  const int draws = asked ? std::max(1, std::atoi(asked)) : 1;
  for (const Case& of : kCases) {
    int kept = 0, rejected = 0, near = 0, most_starts = 0;
    for (std::uint64_t k = 0; k < std::uint64_t(draws); ++k) {
      const BodyScene truth = drawn_floor(of.truth, k), start = guess(truth, k);
      const std::vector<BodyLoggedDrop> drops = three_drops(truth, k);
      const BodyCalibration right = fitted(start, drops, 2), wrong = fitted(with_law(start, of.wrong), drops, 0);
      const identify::Estimate& mu = constant(right, "friction");
      const double off = std::abs(mu.value - truth.robot.contacts[0].law.friction);
      const bool keeps = right.converged && !right.law_rejected(),
                 rejects = !wrong.trusted() && (wrong.law_rejected() || !wrong.converged);
      kept += keeps, rejected += rejects, near += mu.std && off < 3 * *mu.std;
      most_starts = std::max(most_starts, right.starts);
      if (asked)
        WARN(
            fmt::format("{}, floor {}: kept {}, rms {:.3f}, {} starts, friction off by {:.1f} errors; wrong law "
                        "rejected {}, rms {:.3f}",
                        of.name, k, keeps, right.laws.empty() ? NAN : right.laws[0].rms, right.starts,
                        off / mu.std.value_or(NAN), rejects, wrong.laws.empty() ? NAN : wrong.laws[0].rms));
    }
    INFO(of.name << ": kept " << kept << ", rejected " << rejected << ", friction within 3 errors " << near << " of "
                 << draws);
    CHECK(kept >= 0.9 * draws);
    CHECK(rejected >= 0.9 * draws);
    CHECK(near >= 0.9 * draws);
    if (asked)
      WARN(of.name << ": kept " << kept << ", rejected " << rejected << ", friction within 3 errors " << near << " of "
                   << draws << ", starts " << most_starts);
  }
}

TEST_CASE("calibrate: the law that the drops ask for is named, and taken where that is wished") {
  const Case& of = kCases[1];
  const BodyScene truth = drawn_floor(of.truth, 0);
  const std::vector<BodyLoggedDrop> drops = three_drops(truth, 0);
  BodyCalibrationOptions o;
  const BodyScene start = with_law(guess(truth, 0), of.wrong);
  o.terms = drop_choice(start), o.restarts = 0;
  BodyCalibration c = calibrate(start, drops, o);
  REQUIRE(c.laws.size() >= 3);
  CHECK(c.laws[0].law == of.wrong);
  CHECK(c.laws[c.best_law].law == of.truth);
  CHECK(c.laws[c.best_law].bic < -kDecisive);
  CHECK(c.laws[c.best_law].held_out < c.laws[0].held_out);
  CHECK(c.law_rejected());
  CHECK_FALSE(c.trusted());
  adopt_best_law(c, drops, o);
  CHECK(c.scene_law == c.best_law);
  CHECK(law_of(c.scene.robot) == of.truth);
  const identify::Estimate& mu = constant(c, "friction");
  REQUIRE(mu.std.has_value());
  CHECK(std::abs(mu.value - truth.robot.contacts[0].law.friction) < 3 * *mu.std);
  CHECK(mu.verdict == Identifiability::kTrusted);
  CHECK_FALSE(c.law_rejected());
}

TEST_CASE("calibrate: the friction of a foot that never slides is not identifiable") {
  BodyScene sticks = shipped("hopper");
  for (ContactPoint& c : sticks.robot.contacts) c.law.friction = 3;
  const std::vector<BodyLoggedDrop> drops = {dropped(sticks, {35, -70}, 0.3, 400, 90)};
  BodyCalibrationOptions o;
  o.terms = drop_choice(sticks), o.restarts = 0, o.rivals = BodyCalibrationOptions::Rivals::kNone;
  const BodyCalibration c = calibrate(sticks, drops, o);
  CHECK(constant(c, "friction").verdict == Identifiability::kNotIdentifiable);
  CHECK_FALSE(c.trusted());
}

TEST_CASE("calibrate: which constants a scene of links has") {
  BodyScene s = shipped("hopper");
  CHECK(drop_choice(s).free == std::vector<std::string>{"stiffness", "damping_normal", "damping_tangential",
                                                        "stiffness_tangential", "friction"});
  s.robot.contacts[2].own_keys = {"friction"}, s.robot.contacts[2].law.friction = 0.5;
  s.robot.contacts[2].pad = Pad{0.01, 2000, 20};
  CHECK(drop_choice(s).free == std::vector<std::string>{"stiffness", "damping_normal", "damping_tangential",
                                                        "stiffness_tangential", "friction", "foot.friction",
                                                        "pad_stiffness", "pad_damping", "pad_thickness"});
  s = with_law(s, {true, false, false});
  CHECK(words(law_of(s.robot)) == "Hunt and Crossley, viscous along the floor, without pads");
  CHECK(drop_choice(s).free == std::vector<std::string>{"stiffness", "exponent", "dissipation", "damping_tangential"});
  // There and back a floor is as stiff where a drop presses it, and damps as much.
  const BodyScene linear = shipped("hopper"),
                  back = with_law(with_law(linear, {true, true, false}), {false, true, false});
  CHECK(back.robot.contacts[0].law.stiffness == Approx(linear.robot.contacts[0].law.stiffness).epsilon(0.3));
  CHECK(back.robot.contacts[0].law.damping_normal == Approx(linear.robot.contacts[0].law.damping_normal).epsilon(0.3));
}

TEST_CASE("calibrate: the rollout of a robot of links is that of another simulator, on every floor") {
  for (const FloorLaw& law :
       {FloorLaw{false, true, false}, {true, true, false}, {false, true, true}, {true, false, true}}) {
    const BodyScene s = drawn_floor(law, 7);
    const BodyLoggedDrop d = dropped(s, {50, -75}, 0.25, 500, 91);
    const std::vector<DropChannel> channels = body_channels(s.robot);
    BodyScene q = s;
    q.drop = d.thrown;
    const DropRollout r = roll_drop(q, d.motion, channels, d.log.t, {.accuracy = 1e-10});
    REQUIRE(r.complete);
    CHECK(r.first_touchdown == Approx(std::sqrt(2 * 0.25 / 9.81)));
    INFO(words(law));
    for (std::size_t c = 0; c < channels.size(); ++c) {
      if (d.log.output[c].empty()) continue;
      double squares = 0, count = 0;
      for (std::size_t i = 0; i < d.log.t.size(); ++i) {
        const auto near = [&](double t) { return std::abs(t - d.log.t[i]) < 1 / kRate; };
        if (channels[c].jumps && std::any_of(r.jumps.begin(), r.jumps.end(), near)) continue;
        squares += std::pow(r.value[c][i] - d.log.output[c][i], 2), ++count;
      }
      const double noise = channels[c].unit == "m" ? kNoisePlace : channels[c].unit == "rad" ? kNoiseAngle : kNoiseAcc;
      INFO(channels[c].name);
      CHECK(std::sqrt(squares / count) == Approx(noise).epsilon(0.1));
    }
  }
}

TEST_CASE("calibrate: robots of links that cannot be calibrated are refused") {
  using Catch::Matchers::Contains;
  BodyScene s = shipped("hopper");
  const std::vector<BodyLoggedDrop> drops = {dropped(s, {35, -70}, 0.3, 300, 92)};
  BodyCalibrationOptions o;
  o.terms = drop_choice(s);
  const auto refused = [&](const BodyScene& scene, const std::vector<BodyLoggedDrop>& d, const std::string& text) {
    CHECK_THAT(test::refusal([&] { (void)calibrate(scene, d, o); }), Contains(text));
  };
  refused(s, {}, "no drops");
  std::vector<BodyLoggedDrop> high = drops;
  high[0].thrown.height = 10;
  refused(s, high, "before the first touchdown");
  BodyScene airy = s;
  airy.floor = false;
  refused(airy, drops, "no [floor]");
  o.terms.free = {"frictions"};
  refused(s, drops, "friction");
}
