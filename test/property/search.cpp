// What the solvers stand on: the goals, the budget, and the planner's promises.
#include <catch2/catch.hpp>

#include <atomic>
#include <cstdlib>
#include <new>

#include "common/degrees.hpp"
#include "common/error.hpp"
#include "common/random.hpp"
#include "landing/judge/evidence.hpp"
#include "landing/run/simulate.hpp"
#include "landing/search/optimize.hpp"
#include "landing/search/planner.hpp"
#include "landing/search/population.hpp"
#include "landing/search/solvers.hpp"
#include "landing/search/two_link_objective.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;

namespace {
std::atomic<long> allocations{0};
}  // namespace

// Every allocation of this program is counted; a sanitizer counts for itself. GCC takes free() for a stranger to the
// operators new below.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
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
  const SeaParameters<double> sea = table2_sea();
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    std::vector<std::vector<Candidate>> results;
    for (const int threads : {1, 3}) {
      TwoLinkObjective o(scene, sea, {.goal = goal, .accuracy = 1e-7, .threads = threads});
      Random r(4);
      std::vector<Candidate> points;
      for (int i = 0; i < 40; ++i) points.push_back(random_point(r, 3));
      o.evaluate(points, goal);
      CHECK(o.motions() == 40);
      CHECK(o.landings() <= (goal == Goal::kPeak ? 40 : 600));
      results.push_back(points);
    }
    int passed_over = 0;  // a landing that chatters for twenty times the usual number of steps is not waited for
    for (std::size_t i = 0; i < 40; ++i) {
      const Candidate& p = results[0][i];
      CHECK(p.value == results[1][i].value);
      TwoLinkObjective o(scene, sea, {.goal = goal});
      const double exact = o.verified(p, 1e-9);
      if (p.value >= kNoMotion) {
        ++passed_over;
        continue;
      }
      CHECK(std::abs(p.value - exact) < 1e-5 * exact);
      if (goal == Goal::kTolerant)
        CHECK(exact == Approx(tolerant_peak(scene, sea, o.play(p).motion, {.accuracy = 1e-9}, 0, 1, 1).value));
    }
    CHECK(passed_over <= 1);
  }
}

TEST_CASE("search: the lanes at the accuracy that judges an answer agree with the scalar path to 1e-7") {
  const SeaParameters<double> sea = table2_sea();
  for (const char* name : {"paper", "paper_rough_a", "paper_rough_b", "paper_soft", "tilted"}) {
    const Scene scene = scene_of(name);
    TwoLinkObjective o(scene, sea, {.goal = Goal::kTolerant, .accuracy = 1e-9});
    Search s(o, {.motions = 400}, 2);
    auto_search(s);
    Candidate best = s.best();
    best.bound = kNoMotion;
    o.evaluate({&best, 1}, Goal::kTolerant);
    CHECK(best.value == Approx(o.verified(best, 1e-11)).epsilon(1e-7));
  }
}

TEST_CASE("search: what no longer keeps the limits when it is judged is no answer") {
  const SeaParameters<double> sea = table2_sea();
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    Scene scene = scene_of("paper");
    TwoLinkObjective o(scene, sea, {.goal = goal, .limits = {.motor_speed = 20}});
    Search s(o, {.motions = 200}, 1);
    auto_search(s);
    REQUIRE(s.best().value < kNoMotion);
    scene.drop.height = 50;
    CHECK(s.judge(1e-9).value >= kNoMotion);
  }
}

TEST_CASE("search: where time was for screening alone, the best of that is played") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  TwoLinkObjective o(scene, sea, {.goal = Goal::kTolerant});
  Search s(o, {}, 1);
  const Candidate held = s.held();
  CHECK(s.best().u == held.u);
  Random r(6);
  std::vector<Candidate> points;
  for (int i = 0; i < 200; ++i) points.push_back(random_point(r, 3));
  s.evaluate(points, Goal::kPeak);
  CHECK(s.best().u == held.u);
  const Candidate best = *std::min_element(points.begin(), points.end());
  REQUIRE(best.value < held.value);
  // Once the deadline has passed, holding stands; else the best that was screened is played, and counts if it is
  // better.
  CHECK(s.judge(1e-9, o.watch.seconds()).u == held.u);
  const Candidate settled = s.judge(1e-9);
  const double played = o.verified(best, 1e-9), still = o.verified(held, 1e-9);
  CHECK(settled.value == Approx(std::min(played, still)).epsilon(1e-7));
}

TEST_CASE("search: every solver works in any number of variables, within their ranges") {
  Scene scene = scene_of("paper");
  scene.freedom.bumps = 2, scene.freedom.gains = {0.5, 2};
  scene.release = Release{-0.785, 0, 0.1};
  const ReferenceSpace space(scene, table2_sea());
  REQUIRE(space.dimension() == 8);
  for (const std::string& solver : solver_names()) {
    INFO(solver);
    const OptimizeOptions options{.solver = solver, .evaluations = 60, .tolerance_samples = 0};
    const Optimum a = optimize(scene, space, options), b = optimize(scene, space, options);
    REQUIRE(a.found);
    CHECK(a.values == b.values);
    CHECK(a.value == b.value);
    for (int k = 0; k < space.dimension(); ++k) {
      const Variable& v = space.variables()[std::size_t(k)];
      CHECK((a.values[k] >= v.lower && a.values[k] <= v.upper));
    }
    CHECK(a.motion.reposition->to > scene.release->from);
  }
}

TEST_CASE("search: every solver keeps its budget of motions and of time, and repeats itself") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  for (const std::string& solver : solver_names())
    for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
      INFO(solver << (goal == Goal::kPeak ? ", peak" : ", tolerant"));
      const auto run = [&](std::uint64_t seed, const Budget& budget, int threads) {
        TwoLinkObjective o(scene, sea, {.goal = goal, .threads = threads});
        Search s(o, budget, seed);
        run_solver(solver, s);
        CHECK(s.motions() <= budget.motions);
        if (budget.seconds < 1) CHECK(s.seconds() < budget.seconds + 0.5);
        return s.best();
      };
      const Candidate a = run(3, {.motions = 150}, 1), b = run(3, {.motions = 150}, 2);
      CHECK(a.u == b.u);
      CHECK(a.value == b.value);
      CHECK(a.value < kNoMotion);
      CHECK(run(3, {.motions = 1}, 1).value < kNoMotion);
      run(3, {.seconds = 0.02}, 1);
    }
}

TEST_CASE("search: a tolerance stops it once the best stands still") {
  const Scene scene = scene_of("paper_rough_b");
  const SeaParameters<double> sea = table2_sea();
  TwoLinkObjective o(scene, sea, {});
  Search s(o, {.motions = 1'000'000, .tolerance = 1e-3, .patience = 3000}, 1);
  auto_search(s);
  CHECK(s.motions() > 3000);
  CHECK(s.motions() < 100'000);
  CHECK(s.best().value < 1.02 * 173.70);
}

TEST_CASE("search: a planner answers for any drop, without allocating") {
  const SeaParameters<double> sea = table2_sea();
  const Scene scene = scene_of("paper");
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    // Searches as exactly as it judges: on a loaded machine no time may be left to judge.
    Planner planner(scene, sea, {.goal = goal, .accuracy = 1e-9});
    for (const double height : {0.2, 0.4, 0.6}) {
      Drop drop = scene.drop;
      drop.height = height;
      const long before = allocations;
      const Plan plan = planner.plan(drop, 0.4);  // of it 20 ms to judge, which needs 3: other work may stand between
      CHECK(allocations == before);
      REQUIRE(plan.found());
      CHECK(plan.motions > 0);
      Scene there = scene;
      there.drop = drop;
      const double exact = goal == Goal::kPeak
                               ? peak_acceleration(there, sea, plan.motion, {.accuracy = 1e-10}).peak
                               : tolerant_peak(there, sea, plan.motion, {.accuracy = 1e-10}, 0, 1, 1).value;
      CHECK(plan.value == Approx(exact).epsilon(1e-7));
    }
    CHECK(planner.plan(scene.drop, 0).status == Plan::Status::kBadInput);
  }
}

TEST_CASE("search: a planner in the air answers as the search does, time after time, without allocating") {
  const SeaParameters<double> sea = table2_sea();
  Scene scene = scene_of("paper");
  const double phi = -45 * kDegree, g = scene.robot.gravity, height = scene.drop.height;
  scene.release = Release{phi};
  scene.freedom.bumps = 2;
  Planner planner(scene, sea, {.goal = Goal::kPeak, .accuracy = 1e-9});  // as it judges: there may be no time left to
  const auto falling = [&](double elapsed) {
    return FallState{.height = height - 0.5 * g * elapsed * elapsed,
                     .forward_speed = scene.drop.forward_speed,
                     .pitch = scene.drop.pitch,
                     .phi = phi,
                     .elapsed = elapsed};
  };
  std::optional<Plan> last;
  for (const double elapsed : {0.0, 0.05}) {
    const double deadline = 0.1;
    const long before = allocations;
    const Plan plan = planner.plan(falling(elapsed), deadline);
    CHECK(allocations == before);
    REQUIRE(plan.found());
    REQUIRE(plan.motion.reposition);
    CHECK(plan.motion.reposition->phi == phi);
    CHECK(plan.motion.reposition->from == deadline);
    Scene now = scene;
    now.drop.height = height - 0.5 * g * elapsed * elapsed, now.drop.vertical_speed = -g * elapsed;
    now.release = Release{phi, 0, deadline};
    CHECK(plan.value == Approx(peak_acceleration(now, sea, plan.motion, {.accuracy = 1e-10}).peak).epsilon(1e-7));
    // What was found before is tried again, its end where it was, though its move begins later now: a move that would
    // have ended before that is no motion any more.
    if (last && last->motion.reposition->to - elapsed > deadline) {
      Motion kept = last->motion;
      kept.reposition->from = deadline, kept.reposition->to -= elapsed;
      CHECK(plan.value <= peak_acceleration(now, sea, kept, {.accuracy = 1e-10}).peak * 1.001);
    }
    last = plan;
  }
  // A vertical speed that is measured counts in place of the time since release.
  FallState measured = falling(0.05);
  measured.vertical_speed = -g * 0.05, measured.elapsed = 0;
  CHECK(planner.plan(measured, 0.05).found());
  CHECK(planner.plan(falling(0.2), 0.1).status == Plan::Status::kFloorFirst);  // the floor comes 85 ms later
  CHECK(planner.plan(falling(0), 0).status == Plan::Status::kBadInput);
  Planner at_phi_i(scene_of("paper"), sea, {.goal = Goal::kPeak});
  CHECK_THROWS_AS(at_phi_i.plan(falling(0), 0.1), InputError);
}

TEST_CASE("search: a planner that is asked again, in less time, answers no worse, whatever the goal") {
  const Goal goal = GENERATE(Goal::kPeak, Goal::kTolerant, Goal::kRobust);
  Planner planner(paper(), table2().sea, {.goal = goal, .under_scatter = {.measure = {Measure::Kind::kCvar}}});
  const Plan first = planner.plan(paper().drop, 0.5);
  REQUIRE(first.found());
  for (const double deadline : {0.1, 0.05}) {
    const Plan again = planner.plan(paper().drop, deadline, 2);
    REQUIRE(again.found());
    CHECK(again.value <= first.value * (1 + 1e-3));  // of places closer than the search tells apart one is kept
  }
}

TEST_CASE("search: a planner under scatter allocates nothing either, on the ground and in the air") {
  Scene scene = scene_of("paper");
  scene.release = Release{-45 * kDegree};
  scene.freedom.bumps = 2;
  for (const Measure::Kind kind : {Measure::Kind::kMean, Measure::Kind::kCvar}) {
    Planner planner(scene, table2_sea(), {.goal = Goal::kRobust, .under_scatter = {.measure = {kind}, .drops = 24}});
    for (int i = 0; i < 4; ++i) {
      const long before = allocations;
      const Plan ground = planner.plan(scene.drop, 0.3, std::uint64_t(i));
      const Plan air = planner.plan({.height = 0.4, .forward_speed = 0.63, .pitch = 0.3, .phi = -45 * kDegree}, 0.15);
      CHECK(allocations == before);
      CHECK((ground.found() && air.found()));
    }
  }
}

TEST_CASE("search: a planner answers whatever is measured, and throws nothing") {
  Scene scene = scene_of("paper");
  scene.release = Release{-45 * kDegree};
  Planner planner(scene, table2_sea(), {.goal = Goal::kPeak});
  const FallState good{.height = 0.4, .forward_speed = 0.63, .pitch = 0.3, .phi = -45 * kDegree};
  constexpr double kInf = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
  CHECK(planner.plan(good, 0.02).status == Plan::Status::kFound);
  struct Field {
    double FallState::*number;
    const char* name;
    double beyond;
  };
  for (const Field& f : {Field{&FallState::height, "height", -1e-9},
                         {&FallState::height, "height", 2e4},
                         {&FallState::forward_speed, "forward_speed", 2e3},
                         {&FallState::pitch, "pitch", 17},  // degrees
                         {&FallState::pitch_rate, "pitch_rate", -2e3},
                         {&FallState::phi, "phi", -45},
                         {&FallState::rate, "rate", 2e3},
                         {&FallState::elapsed, "elapsed", -0.01}})
    for (const double wrong : {f.beyond, kNan, kInf, -kInf}) {
      FallState s = good;
      s.*f.number = wrong;
      const Plan plan = planner.plan(s, 0.02);
      INFO(f.name << " " << wrong);
      CHECK(plan.status == Plan::Status::kBadInput);
      CHECK_THAT(plan.wrong, Catch::Matchers::StartsWith(f.name) && Catch::Matchers::Contains("needed"));
      CHECK_FALSE(plan.found());
    }
  FallState turned = good;
  turned.vertical_speed = kNan;
  CHECK_THAT(planner.plan(turned, 0.02).wrong, Catch::Matchers::StartsWith("vertical_speed"));
  for (const double deadline : {0.0, -1.0, 1001.0, kInf, kNan}) {
    CHECK_THAT(planner.plan(good, deadline).wrong, Catch::Matchers::StartsWith("deadline"));
    CHECK_THAT(planner.plan(scene.drop, deadline).wrong, Catch::Matchers::StartsWith("deadline"));
  }
  CHECK(planner.plan(Drop{.height = kNan}, 0.02).status == Plan::Status::kBadInput);
  FallState low = good;
  low.height = 1e-3;
  CHECK(planner.plan(low, 0.02).status == Plan::Status::kFloorFirst);
  CHECK(std::string(name(Plan::Status::kFloorFirst)) == "floor_first");
  CHECK(planner.plan(good, 0.02).found());  // as before
  // Nothing that keeps the limits.
  Planner strict(scene, table2_sea(), {.goal = Goal::kPeak, .limits = {.motor_speed = 1e-6}});
  CHECK(strict.plan(good, 0.02).status == Plan::Status::kNothing);
  Planner scattered(scene, table2_sea(),
                    {.goal = Goal::kRobust, .limits = {.motor_speed = 1e-6}, .under_scatter = {.drops = 8}});
  CHECK(scattered.plan(good, 0.05).status == Plan::Status::kNothing);
  for (const int drops : {0, -1, 5000})
    CHECK_THROWS_AS(Planner(scene, table2_sea(), {.goal = Goal::kRobust, .under_scatter = {.drops = drops}}),
                    InputError);
}

TEST_CASE("search: where the floor ends the move in the air, the landing motion from there keeps the rate") {
  Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  Motion cut{-80 * kDegree, -80 * kDegree, 0.15};
  cut.reposition = Reposition{-45 * kDegree, 0, 0.1, 0.8};  // the floor comes at 0.29 s
  scene.detection_delay = 0.01;
  const Landing landing = simulate(scene, sea, cut);
  REQUIRE(landing.touches.front().t_touchdown == landing.contacts.first());
  const double rate = peak_reference_rate(cut, landing.contacts.first() + 0.01);
  CHECK(rate > 2 * peak_reference_rate(cut));
  for (const double limit : {0.99 * rate, 1.01 * rate}) {
    const Limits limits{.reference_rate = limit};
    CHECK((peak_acceleration(scene, sea, cut, {.limits = limits}).end == End::kBroken) == (limit < rate));
    const std::vector<BatchCase> cases(3, {&scene, &sea, cut});
    std::vector<LandingPeak> peaks(cases.size());
    batch_peaks(cases, peaks, {.limits = limits});
    for (const LandingPeak& p : peaks) CHECK((p.end == End::kBroken) == (limit < rate));
  }
}

TEST_CASE("search: limits hold for the answer, and what cannot be kept is said") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  OptimizeOptions o;
  o.evaluations = 3000, o.tolerance_samples = 0;
  o.limits.motor_speed = o.limits.reference_rate = 3.14, o.limits.motor_torque = 20;
  const Optimum rated = optimize(scene, sea, o);
  REQUIRE(rated.found);
  CHECK(peak_reference_rate(rated.motion) <= 3.14);
  const Landing landing = simulate(scene, sea, rated.motion, {.accuracy = 1e-9});
  CHECK(landing.demands.motor_speed <= 3.14 * 1.01);
  CHECK(landing.demands.motor_torque <= 20 * 1.01);
  o.limits = {};
  o.limits.forbidden = {true, true, true};
  const Optimum none = optimize(scene, sea, o);
  CHECK_FALSE(none.found);
  CHECK(none.message == "no motion of the search range was found that keeps the limits");
}

TEST_CASE("search: within limits the corner that breaks them most is learned, whatever the goal") {
  Scene scene = scene_of("paper");
  scene.execution = {3 * kDegree, 0.03};
  const SeaParameters<double> sea = table2_sea();
  const Limits limits{.motor_speed = 3};
  // Motions that keep them where they are played exactly.
  TwoLinkObjective screen(scene, sea, {.goal = Goal::kTolerant, .limits = limits});
  Random r(3);
  std::vector<Candidate> points;
  for (int i = 0; i < 400; ++i) points.push_back(random_point(r, 3));
  screen.evaluate(points, Goal::kPeak);
  std::erase_if(points, [](const Candidate& p) { return p.value >= kNoMotion; });
  REQUIRE(points.size() > 32);
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    TwoLinkObjective o(scene, sea, {.goal = goal, .limits = limits});
    std::vector<Candidate> first = points, again = points;
    o.evaluate(first, goal);
    const long landings = o.landings();
    o.evaluate(again, goal);
    CHECK(o.landings() - landings < landings);
    for (std::size_t i = 0; i < first.size(); ++i)
      CHECK((first[i].value >= kNoMotion) == (again[i].value >= kNoMotion));
  }
}

namespace {
Scene stiff() {
  Scene scene = scene_of("paper");
  scene.floor->stiffness = 1e9;
  return scene;
}
}  // namespace

TEST_CASE("search: the deadline ends landings in the scalar path too") {
  const Scene scene = stiff();
  const SeaParameters<double> sea = table2_sea();
  const std::function<bool()> at_once = [] { return true; };
  const LandingPeak cut = peak_acceleration(scene, sea, {-0.7, -1.2, 0.3}, {.over = &at_once});
  CHECK(cut.end == End::kStopped);
  CHECK(cut.work.steps <= 32);
  // Lanes that hand a landing over, and all that a search plays beside.
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    std::atomic<int> asked{0};
    TwoLinkObjective o(scene, sea, {.goal = goal, .stop = [&] { return ++asked > 200; }});
    const long until = o.work();
    Search s(o, {}, 1);
    auto_search(s);
    CHECK(s.over());
    CHECK(o.verified({o.centre()}, 1e-9) == 0);
    CHECK(o.work() - until < 200 * 32 * 8);
  }
  // A planner's promise on a floor where one landing takes longer: by the processor's time, with room for a busy
  // machine.
  Planner planner(scene, sea, {});
  for (const double deadline : {0.02, 0.05}) {
    const Stopwatch watch(Stopwatch::Time::kProcessor);
    (void)planner.plan(scene.drop, deadline);
    CHECK(watch.seconds() < deadline + 0.02);
  }
}

TEST_CASE("search: a bound of work ends it where every landing is long, the same whatever the threads") {
  const SeaParameters<double> sea = table2_sea();
  const Scene scene = stiff();
  CHECK(work_allowed(1, 200) == kCheckWork);
  CHECK(work_allowed(1, 40'000) == 60'000'000);
  CHECK(work_allowed(1, kUnbounded) == kUnbounded);
  constexpr long kWork = 200'000, kLongest = 16 * 300'000;  // landings of two batches may end beyond it
  Candidate best;
  for (const int threads : {1, 3}) {
    TwoLinkObjective o(scene, sea, {.threads = threads});
    Search s(o, {.motions = 100'000, .work = kWork}, 1);
    auto_search(s);
    CHECK(o.exhausted());
    CHECK(s.motions() < 1'000);
    CHECK(o.work() >= kWork);
    CHECK(o.work() < kWork + kLongest);
    if (threads == 1) best = s.best();
    CHECK(s.best().u == best.u);
    CHECK(s.best().value == best.value);
  }
  // Ordinary scenes never come near it.
  for (const char* name : {"paper", "tilted", "hard"}) {
    const Scene ordinary = scene_of(name);
    TwoLinkObjective o(ordinary, sea, {});
    Search s(o, {.motions = 2'000}, 1);
    auto_search(s);
    CHECK(o.work() < work_allowed(1, 2'000) / 2);
  }
}

TEST_CASE("search: a stiff actuator has an answer or a reason, after work that is bounded") {
  const Scene scene = scene_of("paper");
  OptimizeOptions o;
  o.evaluations = 200, o.tolerance_samples = 0;
  SeaParameters<double> sea = table2_sea();
  sea.c_sea = 1e9;  // every landing fails after 200,000 steps
  const Optimum none = optimize(scene, sea, o);
  CHECK_FALSE(none.found);
  CHECK_THAT(none.message,
             Catch::Matchers::Contains("could be followed") && Catch::Matchers::Contains("bound of work"));
  CHECK(none.work < 4 * kCheckWork);
}

TEST_CASE("search: a monitor stops it, and the best so far is judged") {
  const Scene scene = scene_of("paper");
  OptimizeOptions o;
  long told = 0;
  o.monitor = {[&](long done, long) { told = done; }, [&] { return told >= 1000; }};
  const Optimum best = optimize(scene, table2_sea(), o);
  CHECK(best.evaluations >= 1000);
  CHECK(best.evaluations < 1100);
  REQUIRE(best.found);
  CHECK(best.verified);
  CHECK(best.landing.peak == peak_acceleration(scene, table2_sea(), best.motion, {.accuracy = 1e-9}).peak);
}

TEST_CASE("evidence: the pitch and the floor's damping are among what may not be as planned, a bound leaves it out") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  // The motion that a robot can hold, with the pitch off by 1 deg: no basin of the motion's own box tells of it.
  const Motion held{-32.522982220702566 * kDegree, -21.587856884504102 * kDegree, 0.37464990016785615};
  const Evidence e = evidence(scene, sea, held, {});
  CHECK(e.complete);
  CHECK(e.peak == Approx(186.311).epsilon(1e-4));
  CHECK(e.pitch_one_degree == Approx(441.3).epsilon(1e-3));
  double damped = 0;
  for (const double share : {0.9, 1.1}) {
    Scene s = scene;
    s.floor->damping_normal *= share, s.floor->damping_tangential *= share;
    damped = std::max(damped, peak_acceleration(s, sea, held, {.accuracy = 1e-9}).peak);
  }
  CHECK(e.damping_ten_percent == Approx(damped).epsilon(1e-6));
  const Evidence none = evidence(scene, sea, held, {.work = 1000});
  CHECK_FALSE(none.complete);
  CHECK(none.work > 1000);
  CHECK(std::isnan(none.pitch_one_degree));
  CHECK(std::isnan(none.tolerant.value));
}

TEST_CASE("search: the tolerant peak counts where each point touches") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  OptimizeOptions o;
  o.evaluations = 2000, o.tolerance_samples = 200, o.limits.forbidden = {true, false, false};
  const Optimum best = optimize(scene, sea, o);
  REQUIRE(best.found);
  CHECK_FALSE(best.landing.contacts.touched(kHip));
  int hip = 0;
  for (int k = 0; k < kExecutionPoints; ++k)
    hip += peak_acceleration(scene, sea, deviated(best.motion, scene.execution, execution_deviation(k)),
                             {.limits = o.limits})
               .end == End::kBroken;
  CHECK(best.tolerant.touching[kHip] == hip);
  CHECK(best.tolerant.touching[kFoot] == kExecutionPoints);
  CHECK(best.tolerant.samples_touching[kFoot] == 200);
}

TEST_CASE("search: more freedom is worth no less within ratings, where few motions keep them") {
  Scene scene = read_scene(UKEMI_DATASETS "/scenes/high.toml");
  const Actuator actuator = read_actuator(UKEMI_DATASETS "/actuators/table2.toml");
  OptimizeOptions o{.evaluations = 12'000, .seed = 11, .tolerance_samples = 0};
  o.limits.motor_speed = o.limits.reference_rate = *actuator.speed_max, o.limits.motor_torque = actuator.sea.tau_max;
  const Optimum quintic = optimize(scene, actuator.sea, o);
  scene.freedom.bumps = 4;
  const Optimum four = optimize(scene, actuator.sea, o);
  REQUIRE((quintic.found && four.found));
  CHECK(four.value < 1.05 * quintic.value);
}
