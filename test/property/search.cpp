// What the solvers stand on: the goals, the budget, and the planner's promises.
#include <catch2/catch.hpp>

#include <atomic>
#include <cstdlib>
#include <new>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "common/random.hpp"
#include "landing/optimize.hpp"
#include "landing/planner.hpp"
#include "landing/population.hpp"
#include "landing/scene_file.hpp"
#include "landing/solvers.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {
std::atomic<long> allocations{0};
Scene scene_of(const std::string& name) { return read_scene(UKEMI_DATASETS "/scenes/" + name + ".toml"); }
SeaParameters<double> table2() { return read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea; }
}  // namespace

// Every allocation of this program is counted; a sanitizer counts for itself.
#if !defined(__SANITIZE_ADDRESS__)
void* operator new(std::size_t n) {
  ++allocations;
  if (void* p = std::malloc(n)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t n, std::align_val_t a) {
  ++allocations;
  const auto align = std::size_t(a);
  if (void* p = std::aligned_alloc(align, (n + align - 1) / align * align)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
#endif

TEST_CASE("search: both goals agree with the landings one by one, whatever the threads") {
  const Scene scene = scene_of("paper_soft");
  const SeaParameters<double> sea = table2();
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    std::vector<std::vector<Point3>> results;
    for (const int threads : {1, 3}) {
      Objective o(scene, sea, {.goal = goal, .accuracy = 1e-7, .threads = threads});
      Random r(4);
      std::vector<Point3> points;
      for (int i = 0; i < 40; ++i) points.push_back(random_point(r));
      o.evaluate(points, goal);
      CHECK(o.motions() == 40);
      CHECK(o.landings() <= (goal == Goal::kPeak ? 40 : 600));
      results.push_back(points);
    }
    int passed_over = 0;  // a landing that chatters for twenty times the usual number of steps is not waited for
    for (std::size_t i = 0; i < 40; ++i) {
      const Point3& p = results[0][i];
      CHECK(p.value == results[1][i].value);
      Objective o(scene, sea, {.goal = goal});
      const double exact = o.verified(o.motion(p), 1e-9);
      if (p.value >= kNoMotion) {
        ++passed_over;
        continue;
      }
      CHECK(std::abs(p.value - exact) < 1e-5 * exact);
      if (goal == Goal::kTolerant)
        CHECK(exact == Approx(tolerant_peak(scene, sea, o.motion(p), {.accuracy = 1e-9}, 0, 1, 1).value));
    }
    CHECK(passed_over <= 1);
  }
}

TEST_CASE("search: the lanes at the accuracy that judges an answer agree with the scalar path to 1e-7") {
  const SeaParameters<double> sea = table2();
  for (const char* name : {"paper", "paper_rough_a", "paper_rough_b", "paper_soft", "tilted"}) {
    const Scene scene = scene_of(name);
    Objective o(scene, sea, {.goal = Goal::kTolerant, .accuracy = 1e-9});
    Search s(o, {.motions = 400}, 2);
    auto_search(s);
    Point3 best = s.best();
    best.bound = kNoMotion;
    o.evaluate({&best, 1}, Goal::kTolerant);
    CHECK(best.value == Approx(o.verified(o.motion(best), 1e-11)).epsilon(1e-7));
  }
}

TEST_CASE("search: what no longer keeps the limits when it is judged is no answer") {
  const SeaParameters<double> sea = table2();
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    Scene scene = scene_of("paper");
    Objective o(scene, sea, {.goal = goal, .limits = {.motor_speed = 20}});
    Search s(o, {.motions = 200}, 1);
    auto_search(s);
    REQUIRE(s.best().value < kNoMotion);
    scene.drop.height = 50;
    CHECK(s.settle(1e-9).value >= kNoMotion);
  }
}

TEST_CASE("search: where time was for screening alone, the best of that is played") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2();
  Objective o(scene, sea, {.goal = Goal::kTolerant});
  Search s(o, {}, 1);
  Random r(6);
  std::vector<Point3> points;
  for (int i = 0; i < 20; ++i) points.push_back(random_point(r));
  s.evaluate(points, Goal::kPeak);
  CHECK(s.best().value >= kNoMotion);
  const Point3 best = *std::min_element(points.begin(), points.end());
  const double passed = o.watch.seconds();  // even where the deadline has
  CHECK(s.settle(1e-9, passed).u == best.u);
  const Point3 settled = s.settle(1e-9);
  CHECK(settled.u == best.u);
  CHECK(settled.value == Approx(o.verified(o.motion(best), 1e-9)).epsilon(1e-7));
}

TEST_CASE("search: every solver keeps its budget of motions and of time, and repeats itself") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2();
  for (const std::string& solver : solver_names())
    for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
      INFO(solver << (goal == Goal::kPeak ? ", peak" : ", tolerant"));
      const auto run = [&](std::uint64_t seed, const Budget& budget, int threads) {
        Objective o(scene, sea, {.goal = goal, .threads = threads});
        Search s(o, budget, seed);
        run_solver(solver, s);
        CHECK(s.motions() <= budget.motions);
        if (budget.seconds < 1) CHECK(s.seconds() < budget.seconds + 0.5);
        return s.best();
      };
      const Point3 a = run(3, {.motions = 150}, 1), b = run(3, {.motions = 150}, 2);
      CHECK(a.u == b.u);
      CHECK(a.value == b.value);
      CHECK(a.value < kNoMotion);
      CHECK(run(3, {.motions = 1}, 1).value < kNoMotion);
      run(3, {.seconds = 0.02}, 1);
    }
}

TEST_CASE("search: a tolerance stops it once the best stands still") {
  const Scene scene = scene_of("paper_rough_b");
  const SeaParameters<double> sea = table2();
  Objective o(scene, sea, {});
  Search s(o, {.motions = 1'000'000, .tolerance = 1e-3, .patience = 3000}, 1);
  auto_search(s);
  CHECK(s.motions() > 3000);
  CHECK(s.motions() < 100'000);
  CHECK(s.best().value < 1.02 * 173.70);
}

TEST_CASE("search: a planner answers for any drop, without allocating") {
  const SeaParameters<double> sea = table2();
  const Scene scene = scene_of("paper");
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    Planner planner(scene, sea, {.goal = goal});
    for (const double height : {0.2, 0.4, 0.6}) {
      Drop drop = scene.drop;
      drop.height = height;
      const long before = allocations;
      const Plan plan = planner.plan(drop, 0.4);  // of it 20 ms to judge, which needs 3: other work may stand between
      CHECK(allocations == before);
      REQUIRE(plan.found);
      CHECK(plan.motions > 0);
      Scene there = scene;
      there.drop = drop;
      const double exact = goal == Goal::kPeak
                               ? peak_acceleration(there, sea, plan.motion, {.accuracy = 1e-10}).peak
                               : tolerant_peak(there, sea, plan.motion, {.accuracy = 1e-10}, 0, 1, 1).value;
      CHECK(plan.value == Approx(exact).epsilon(1e-7));
    }
    CHECK_THROWS_AS(planner.plan(scene.drop, 0), InputError);
  }
}

TEST_CASE("search: limits hold for the answer, and what cannot be kept is said") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2();
  OptimizeOptions o;
  o.evaluations = 3000, o.tolerance_samples = 0;
  o.limits.motor_speed = o.reference_rate = 3.14, o.limits.motor_torque = 20;
  const Optimum rated = optimize(scene, sea, o);
  REQUIRE(rated.found);
  CHECK(peak_reference_rate(rated.motion) <= 3.14);
  const Landing landing = simulate(scene, sea, rated.motion, {.accuracy = 1e-9});
  CHECK(landing.demands.motor_speed <= 3.14 * 1.01);
  CHECK(landing.demands.motor_torque <= 20 * 1.01);
  o.limits = {}, o.reference_rate = kNoMotion;
  o.limits.forbidden = {true, true, true};
  const Optimum none = optimize(scene, sea, o);
  CHECK_FALSE(none.found);
  CHECK(none.message == "no motion of the search range was found that keeps the limits");
}
