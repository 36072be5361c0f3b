// Landings computed independently in extended precision (datasets/reference, method in its README): peaks, order and
// times of touchdowns at the default accuracy. The default, 1e-9, is chosen here: at 1e-8 the chattering case c019
// comes within a factor of two of the 1e-6 that is promised, at 1e-9 every peak is within 1e-7.
#include <catch2/catch.hpp>
#include <cmath>

#include "common/actuator.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "landing/derivatives/gradient.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/run/simulate.hpp"
#include "test/folder.hpp"
#include "tools/bench/reference.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

using Case = ReferenceCase;
/// Reads rich_cases.csv: motions with shape terms and moves in the air; of results only peaks.
std::vector<Case> read_rich_reference(const std::string& folder) {
  const CsvTable table = read_csv(
      folder + "/rich_cases.csv", [](const std::string&) { return true; }, NanCells::kAsEmpty);
  std::vector<Case> out;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto value = [&](const std::string& name) { return table.columns[std::size_t(table.require(name))][row]; };
    Case c;
    c.id = "rich " + std::to_string(row + 1);
    c.scene.name = "reference";
    c.scene.robot = {{value("m0"), value("m1")}, {value("I0"), value("I1")}, value("l"), value("g")};
    c.scene.contacts = {true, true, true};
    c.scene.floor = Floor<double>{value("K_f"), value("C_fy"), value("C_fx")};
    c.scene.drop = {value("h"), value("V_H"), value("pitch_deg") * kDegree};
    c.sea = {value("K_p"), value("K_d"), value("K_SEA"), value("C_SEA"), value("I_motor"), value("tau_max")};
    c.motion = {value("phi_i_deg") * kDegree, value("phi_f_deg") * kDegree, value("duration")};
    for (std::size_t k = 0; k < kMaxBumps; ++k) c.motion.bumps[k] = value("b" + std::to_string(k) + "_deg") * kDegree;
    if (const double phi = value("release_phi_deg"); !std::isnan(phi))
      c.motion.reposition = Reposition{phi * kDegree, 0, value("from"), value("to")};
    c.peak = value("peak");
    out.push_back(c);
  }
  return out;
}

std::vector<Case> cases() { return read_reference(UKEMI_DATASETS "/reference"); }

std::string order_of(const Landing& l) {
  std::string s;
  for (const Touch& t : l.touches) s += "HKF"[t.point];
  return s;
}

void check(const SimulateOptions& options, double tolerance_peak, double tolerance_time, double tolerance_chatter) {
  const auto all = cases();
  REQUIRE(all.size() == 80);
  for (const Case& c : all) {
    const Landing l = simulate(c.scene, c.sea, c.motion, options);
    INFO(c.id << " peak " << l.peak << " reference " << c.peak << " order " << order_of(l) << " reference " << c.order);
    REQUIRE(l.end != End::kFailed);
    const bool chatters = c.id == "c019";
    CHECK(std::abs(l.peak - c.peak) <= (chatters ? tolerance_chatter : tolerance_peak) * c.peak);
    CHECK(peak_acceleration(c.scene, c.sea, c.motion, options).peak == l.peak);  // one run, reported or not
    const std::string order = order_of(l);
    if (chatters) {  // 202 touchdowns: only the first and the last are compared
      CHECK(order.front() == c.order.front());
      CHECK(order.back() == c.order.back());
      continue;
    }
    // Exact up to rest: a run that ended there may lack later touchdowns, never have others.
    if (l.end == End::kRest)
      CHECK(c.order.substr(0, order.size()) == order);
    else
      CHECK(order == c.order);
    for (std::size_t i = 0; i < std::min(order.size(), c.touchdowns.size()); ++i)
      CHECK(std::abs(l.touches[i].t_touchdown - c.touchdowns[i]) <= tolerance_time);
  }
}

}  // namespace

TEST_CASE(
    "reference landings at the default accuracy: peaks within 1e-6, order exact up to rest, times within 1e-6 s") {
  check({}, 1e-6, 1e-6, 1e-6);
}

// The chattering case c019 wanders between 5e-9 and 4e-8 from 1e-11 on: its shortest hops are at the resolution of
// time.
TEST_CASE("reference landings at tight accuracy: peaks within 1e-10, the chattering one within 4e-8") {
  check({.accuracy = 1e-14}, 1e-10, 1e-9, 4e-8);
}

TEST_CASE("reference landings with shape terms and moves in the air: peaks within 1e-5, scalar, lanes and gradients") {
  const auto all = read_rich_reference(UKEMI_DATASETS "/reference");
  REQUIRE(all.size() == 80);
  std::vector<BatchCase> cases;
  for (const Case& c : all) cases.push_back({&c.scene, &c.sea, c.motion});
  std::vector<LandingPeak> lanes(all.size());
  batch_peaks(cases, lanes, {.accuracy = 1e-7});
  int moved = 0, shaped = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Case& c = all[i];
    const Landing l = simulate(c.scene, c.sea, c.motion);
    const auto gradients = motion_peaks(c.scene, c.sea, c.motion, {}, 1);
    INFO(c.id << " peak " << l.peak << " lanes " << lanes[i].peak << " reference " << c.peak);
    CHECK(l.end == End::kRest);
    CHECK(l.peak == Approx(c.peak).epsilon(1e-5));
    CHECK(peak_acceleration(c.scene, c.sea, c.motion).peak == l.peak);
    CHECK(lanes[i].peak == Approx(c.peak).epsilon(1e-5));
    REQUIRE(!gradients.peaks.empty());
    CHECK(gradients.peaks[0].value == Approx(c.peak).epsilon(1e-5));
    moved += c.motion.reposition.has_value(), shaped += has_bumps(c.motion);
  }
  CHECK(moved >= 20);
  CHECK(shaped >= 40);
}

TEST_CASE("published facts of the paper's landing and regression values of the calibrated floors") {
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const SimulateOptions tight{.accuracy = 1e-12};
  const auto land = [&](const std::string& scene, double phi_i, double phi_f, double duration) {
    return simulate(read_scene(std::string(UKEMI_DATASETS "/scenes/") + scene + ".toml"), sea,
                    {phi_i * kDegree, phi_f * kDegree, duration}, tight);
  };
  const Landing held = land("paper", -45, -45, 1);
  CHECK(std::abs(held.peak - 466.171207916) < 5e-7);  // 466 m/s^2 in the paper
  CHECK(order_of(held) == "FKHKF");                   // as printed
  CHECK(held.peaks.size() == 6);                      // before the first touchdown, then five intervals
  CHECK(std::abs(held.t_peak - 0.498515682975) < 1e-9);
  const double times[] = {0.285568625, 0.461251336, 0.498515683, 0.732860483, 1.146607957};
  for (std::size_t i = 0; i < 5; ++i) CHECK(std::abs(held.touches[i].t_touchdown - times[i]) < 2e-9);
  CHECK(held.end == End::kRest);

  const Landing best = land("paper", -27.418553, -79.011567, 0.175278);  // on a cliff
  CHECK(std::abs(best.peak - 171.881381180) < 5e-9 * 171.9);
  CHECK(order_of(best) == "FFKF");
  CHECK(std::abs(land("paper", -27.206, -82.364, 0.16885).peak - 174.803141107) < 5e-9 * 174.8);
  const Landing balanced = land("paper", -32.50056, -19.30209, 0.388696);
  CHECK(std::abs(balanced.peak - 182.602492688) < 5e-9 * 182.6);
  CHECK(order_of(balanced) == "FKHKFF");

  for (const auto& [scene, peak] :
       {std::pair{"paper_rough_a", 466.796217317}, {"paper_rough_b", 466.678983725}, {"paper_soft", 466.250632709}}) {
    const Landing l = land(scene, -45, -45, 1);
    INFO(scene);
    CHECK(std::abs(l.peak - peak) < 1e-8 * peak);
    CHECK(order_of(l) == "FKHKF");
  }
}

TEST_CASE("a landing beside an event a few millionths of a step ahead: no peak from outside of a step") {
  // Once 3.78e17 m/s^2: the step retaken up to the event was 250,000 times shorter than the one before it, and what
  // was made up to the event was 25 times its length.
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/tilted.toml");
  const Motion motion{-70.759054270053724 * kDegree, -4.2268562476172145 * kDegree, 0.36381212436564669};
  for (const double accuracy : {1e-6, 1e-9, 1e-11}) {
    const Landing l = simulate(scene, sea, motion, {.accuracy = accuracy}, 1000);
    CHECK(l.end == End::kRest);
    CHECK(l.peak == Approx(1303.2533).epsilon(1e-6));
    for (const Sample& s : l.trajectory) CHECK(s.acc <= l.peak * (1 + 1e-9));
    for (const Touch& t : l.touches) CHECK(t.peak_acc <= l.peak * (1 + 1e-9));
  }
}

TEST_CASE("a landing whose first step behind a touchdown is far too long: its error is seen") {
  // Once 0.2 % off at the default accuracy, and the energy with it: dop853's combined estimate hid an error of 537
  // tolerances behind one of three millions.
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/straight.toml");
  const Motion motion{-49.212252475496484 * kDegree, -2.0808687462904469 * kDegree, 0.98701002518697223};
  const Landing l = simulate(scene, sea, motion), tight = simulate(scene, sea, motion, {.accuracy = 1e-13});
  CHECK(l.end == End::kRest);
  CHECK(l.energy_residual < 1e-8);
  CHECK(l.peak == Approx(tight.peak).epsilon(1e-7));
  CHECK(tight.peak == Approx(419.525231).epsilon(1e-8));
}

TEST_CASE("each touch has the largest acceleration up to the next one, of chattering contacts as well") {
  for (const Case& c : cases()) {
    if (c.id != "c019" && c.id != "c000" && c.id != "c005") continue;
    const Landing l = simulate(c.scene, c.sea, c.motion, {}, 20'000);
    INFO(c.id);
    double largest = 0;
    for (std::size_t i = 0; i < l.touches.size(); ++i) {
      const Touch& touch = l.touches[i];
      const double from = touch.t_touchdown,
                   to = i + 1 < l.touches.size() ? l.touches[i + 1].t_touchdown : l.trajectory.back().t;
      double inside = 0, with_limits = 0;  // rows between both touchdowns; the rows at them are limits of either side
      for (const Sample& s : l.trajectory) {
        if (s.t >= from && s.t <= to) with_limits = std::max(with_limits, s.acc);
        if (s.t > from && s.t < to) inside = std::max(inside, s.acc);
      }
      INFO("touch " << i << " at " << from);
      CHECK(touch.peak_acc >= inside * (1 - 1e-9));
      CHECK(touch.peak_acc <= with_limits * 1.001);
      largest = std::max(largest, touch.peak_acc);
    }
    CHECK(largest == Approx(l.peak).epsilon(1e-12));  // 9.81 before the first touchdown
  }
}

TEST_CASE("reference landings: what is missing in their files is said where it is missing") {
  const test::Folder f;
  const auto copy = [&](const char* name, const std::string& from, const std::string& to) {
    f.write("landing_cases.csv", test::read(UKEMI_DATASETS "/reference/landing_cases.csv"));
    f.write("landing_peaks.csv", test::read(UKEMI_DATASETS "/reference/landing_peaks.csv"));
    f.write(name, test::replaced(test::read(UKEMI_DATASETS "/reference/" + std::string(name)), from, to));
  };
  const auto refused = [&](const std::string& text) {
    CHECK_THROWS_WITH(read_reference(f.at("")), Catch::Matchers::Contains(text));
  };
  copy("landing_cases.csv", "K_f,", "stiff,");
  refused("column 'K_f': missing");
  copy("landing_peaks.csv", "peak_acc,", "peak,");
  refused("column 'peak_acc': missing");
  copy("landing_peaks.csv", "433.154486552", "");
  refused("landing_peaks.csv:2:");
  copy("landing_peaks.csv", "0.285568624585;", "0.28x;");
  refused("'0.28x': a number is needed");
  copy("landing_peaks.csv", "c000,", "c001,");
  refused("'c000'");
}
