// A motion space that this test alone knows: what searches, maps and judges motions asks a space what it may vary.
#include "landing/model/motion_space.hpp"

#include <catch2/catch.hpp>

#include "common/error.hpp"
#include "landing/derivatives/gradient.hpp"
#include "landing/judge/evidence.hpp"
#include "landing/judge/survey.hpp"
#include "landing/search/optimize.hpp"
#include "landing/search/planner.hpp"
#include "landing/search/solvers.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;

namespace {

std::vector<Variable> four_variables(const Scene& scene, const std::array<double, 2>& stiffness) {
  std::vector<Variable> v = ReferenceSpace(scene, {}).variables();
  v.push_back({"stiffness", "stiffness", "1", stiffness[0], stiffness[1]});
  return v;
}

/// The motions of Eq. 6, and a factor of the drive's K_p.
class CompliantSpace : public MotionSpace {
 public:
  explicit CompliantSpace(const Scene& scene, const std::array<double, 2>& stiffness = {0.25, 4})
      : MotionSpace(four_variables(scene, stiffness)) {}
  DrivenMotion play(const Coordinates& x) const override {
    DrivenMotion p{{x[0], x[1], x[2]}, table2_};
    p.sea.k_p *= x[3];
    return p;
  }

 private:
  SeaParameters<double> table2_ = table2_sea();
};

}  // namespace

TEST_CASE("motion space: every solver searches four variables, and repeats itself") {
  const Scene scene = paper();
  const CompliantSpace space(scene);
  for (const std::string& solver : solver_names()) {
    INFO(solver);
    const auto run = [&](Goal goal, int threads) {
      return optimize(scene, space,
                      {.solver = solver, .goal = goal, .evaluations = 40, .threads = threads, .tolerance_samples = 0});
    };
    const Optimum a = run(Goal::kPeak, 1), b = run(Goal::kPeak, 2);
    REQUIRE(a.found);
    CHECK(a.values == b.values);
    REQUIRE(a.values.size() == 4);
    CHECK(a.sea.k_p == table2_sea().k_p * a.values[3]);
    CHECK(a.landing.peak == peak_acceleration(scene, a.sea, a.motion, {.accuracy = 1e-9}).peak);
    if (solver == "auto") CHECK(run(Goal::kTolerant, 2).tolerant.complete);
  }
}

TEST_CASE("motion space: a variable whose range is one value changes nothing of a landing") {
  const Scene scene = paper();
  const CompliantSpace fixed(scene, {1, 1});
  const Optimum best = optimize(scene, fixed, {.evaluations = 3'000, .tolerance_samples = 0});
  REQUIRE(best.found);
  CHECK(best.values[3] == 1);
  CHECK(best.landing.peak == peak_acceleration(scene, table2_sea(), best.motion, {.accuracy = 1e-9}).peak);
  CHECK(best.value < 200);
}

TEST_CASE("motion space: gradients follow its variables") {
  const Scene scene = paper();
  const CompliantSpace space(scene);
  Coordinates x(4);
  x << -0.6, -1.1, 0.3, 0.8;
  const SimulateOptions tight{.accuracy = 1e-13};
  const auto peak = [&](const Coordinates& at) {
    const DrivenMotion p = space.play(at);
    return peak_acceleration(scene, p.sea, p.motion, tight).peak;
  };
  const DrivenMotion play = space.play(x);
  const auto found = all_gradients(scene, play.sea, play.motion, tight, 1);
  REQUIRE(found.peaks.size() == 1);
  Eigen::Matrix<double, kDrivenNumbers, 1> by_numbers;
  by_numbers << found.peaks[0].d.head<kMotionNumbers>(), found.peaks[0].d.tail<kConstants>();
  const Eigen::VectorXd gradient = space.jacobian(x).transpose() * by_numbers;
  for (int k = 0; k < 4; ++k) {
    constexpr double kStep = 1e-5;
    Coordinates up = x, down = x;
    up[k] += kStep, down[k] -= kStep;
    INFO(space.variables()[std::size_t(k)].name);
    CHECK(gradient[k] == Approx((peak(up) - peak(down)) / (2 * kStep)).epsilon(1e-5));
  }
}

TEST_CASE("motion space: a slice of its map, its basins and its evidence") {
  const Scene scene = paper();
  const CompliantSpace space(scene);
  MapOptions options;
  options.cells = {8, 8, 1, 3}, options.polished = 2;
  options.slice = space.values(space.centre());
  options.slice[2] = 0.3;
  const PeakMap map = map_peaks(scene, space, options);
  REQUIRE(map.grid.size() == 8 * 8 * 3);
  for (const std::size_t i : {std::size_t(0), std::size_t(77), map.grid.size() - 1}) {
    const Coordinates x = map.values(map.place(i));
    CHECK(map.index(map.place(i)) == i);
    CHECK(x[2] == 0.3);
    const DrivenMotion p = space.play(x);
    CHECK(map.grid[i].peak == Approx(peak_acceleration(scene, p.sea, p.motion).peak).epsilon(1e-3));
  }
  CHECK(map.neighbours(0).size() == 8);           // a corner of three axes
  CHECK(map.neighbours(3 * 9 + 1).size() == 27);  // inside
  const auto found = basins(scene, space, map, options);
  REQUIRE_FALSE(found.empty());
  CHECK(found[0].peak <= map.grid[0].peak);
  const Evidence e = evidence(scene, space, found[0].values, {});
  REQUIRE(e.width.size() == 4);
  for (const auto& [down, up] : e.width) CHECK((down >= 0 && up >= 0));
  CHECK(e.peak == Approx(found[0].peak).epsilon(1e-6));
  options.cells = {8, 8, 8, 8, 8};
  CHECK_THROWS_AS(map_peaks(scene, space, options), InputError);
}

TEST_CASE("motion space: a planner plans in it") {
  const Scene scene = paper();
  Planner planner(scene, std::make_shared<CompliantSpace>(scene), {.goal = Goal::kPeak});
  const Plan plan = planner.plan(scene.drop, 0.2);
  REQUIRE(plan.found());
  CHECK(plan.sea.k_p <= 4 * table2_sea().k_p);
  // Where the deadline left no time to judge it, the value is that of the search's own accuracy.
  CHECK(plan.value == Approx(peak_acceleration(scene, plan.sea, plan.motion, {.accuracy = 1e-10}).peak).epsilon(1e-5));
}

TEST_CASE("map: a slice holds the peaks of its motions, the first row lowest") {
  Scene scene = paper();
  const Motion m{-0.7, -1.2, 0.3, {0.3, 0, 0, 0}};
  const auto peaks =
      peak_slice(scene, table2_sea(), m, {&Motion::phi_i, -0.9, -0.5}, {&Motion::duration, 0.2, 0.4}, 3, 1);
  REQUIRE(peaks.size() == 9);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      Motion at = m;
      at.phi_i = -0.9 + 0.2 * i, at.duration = 0.2 + 0.1 * j;
      CHECK(peaks[std::size_t(3 * j + i)] == Approx(peak_acceleration(scene, table2_sea(), at).peak).epsilon(1e-3));
    }
  scene.contacts = {};  // never a landing
  CHECK(std::isnan(peak_slice(scene, table2_sea(), m, {&Motion::phi_i, -0.9, -0.5}, {&Motion::phi_f, -1, 0}, 2, 1)[0]));
}

TEST_CASE("motion space: ranges must be ranges") {
  class Bare : public MotionSpace {
   public:
    using MotionSpace::MotionSpace;
    DrivenMotion play(const Coordinates&) const override { return {}; }
  };
  CHECK_THROWS_AS(Bare(std::vector<Variable>{}), InputError);
  CHECK_THROWS_AS(Bare(std::vector<Variable>{{"x", "x", "1", 2, 1}}), InputError);
  CHECK_THROWS_AS(Bare(std::vector<Variable>(kMaxVariables + 1, {"x", "x", "1", 0, 1})), InputError);
}
