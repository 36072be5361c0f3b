// A plan is never worse than holding still: every search judges the best posture to hold by its own goal.
#include <catch2/catch.hpp>

#include "common/degrees.hpp"
#include "common/error.hpp"
#include "landing/judge/answer.hpp"
#include "landing/search/optimize.hpp"
#include "landing/search/planner.hpp"
#include "landing/search/solvers.hpp"
#include "landing/search/two_link_objective.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;

namespace {

constexpr double kReleased = -45 * kDegree;

/// Already falling, 0.1 s after release.
Scene falling(int bumps) {
  Scene scene = paper();
  scene.release = Release{kReleased, 0, 0.1};
  scene.freedom.bumps = bumps;
  return scene;
}

struct Asked {
  const char* name;
  Goal goal;
  Measure measure;
};
const std::vector<Asked> kGoals = {{"peak", Goal::kPeak, {}},
                                   {"tolerant", Goal::kTolerant, {}},
                                   {"mean", Goal::kRobust, {Measure::Kind::kMean}},
                                   {"cvar", Goal::kRobust, {Measure::Kind::kCvar}}};

std::shared_ptr<const Robust> robust_of(const Scene& scene, const Asked& asked) {
  if (asked.goal != Goal::kRobust) return nullptr;
  auto out = std::make_shared<Robust>();
  const DropModel model(scene, Scatter::assumed());
  out->measure = asked.measure, out->drops = model.even(8, 1), out->judging = model.even(16, 2);
  return out;
}

/// How closely values are known: lanes alone judge under scatter.
double within(const Asked& asked) { return asked.goal == Goal::kRobust ? 1e-4 : 1e-6; }

/// What a motion is worth by a goal, one landing after the other.
double value_of(const Scene& scene, const MotionSpace& space, const DrivenMotion& play, Goal goal,
                const Robust* robust) {
  if (goal == Goal::kPeak) return peak_acceleration(scene, play.sea, play.motion, {.accuracy = 1e-9}).peak;
  if (goal == Goal::kTolerant) return tolerant_peak(scene, space, play, {.accuracy = 1e-9}, 0, 1, 1).value;
  std::vector<double> peaks;
  for (const ScatteredDrop& d : robust->judging) {
    const DrivenMotion p = d.played(space, play);
    peaks.push_back(peak_acceleration(d.scene, p.sea, p.motion, {.accuracy = 1e-9}).peak);
  }
  return robust->measure.of(peaks);
}

}  // namespace

TEST_CASE("hold: the motion whose reference never moves is in every space, also beyond its ranges") {
  for (const double phi : {kReleased, 20 * kDegree}) {
    Scene scene = falling(4);
    scene.freedom.gains = {1.5, 2};
    scene.release->phi = phi;
    const ReferenceSpace space(scene, table2().sea);
    const DrivenMotion held = space.play(space.values(space.place(*space.holding(phi))));
    CHECK(held.motion.phi_i == Approx(phi).epsilon(1e-12));
    CHECK(held.motion.phi_f == Approx(phi).epsilon(1e-12));
    CHECK(!has_bumps(held.motion));
    CHECK(held.motion.gain_p == Approx(1).epsilon(1e-12));
    CHECK(held.motion.gain_d == Approx(1).epsilon(1e-12));
    CHECK(held.motion.reposition->phi == phi);
  }
}

TEST_CASE("hold: no search in the air is worse, whatever the goal, the solver, the shape terms and the budget") {
  const SeaParameters<double> sea = table2().sea;
  for (const Asked& asked : kGoals)
    for (int bumps = 0; bumps <= kMaxBumps; ++bumps) {
      const Scene scene = falling(bumps);
      const ReferenceSpace space(scene, sea);
      const auto robust = robust_of(scene, asked);
      const double held = value_of(scene, space, space.play(*space.holding(kReleased)), asked.goal, robust.get());
      for (const std::string solver : {"auto", "de", "sbplx"})
        for (const long motions : {1, 2, 15, 16, 50}) {
          INFO(asked.name << ", " << bumps << " bumps, " << solver << ", " << motions << " motions");
          const Optimum best = optimize(scene, space,
                                        {.solver = solver,
                                         .goal = asked.goal,
                                         .robust = robust,
                                         .evaluations = motions,
                                         .threads = 1,
                                         .tolerance_samples = 0});
          REQUIRE(best.found);
          CHECK(best.value <= held * (1 + within(asked)));
          REQUIRE(best.held);
          CHECK(best.held->motion.phi_i == Approx(kReleased));
        }
    }
}

TEST_CASE("hold: nor by a deadline") {
  const SeaParameters<double> sea = table2().sea;
  for (const Asked& asked : kGoals)
    for (const int bumps : {0, 2, kMaxBumps}) {
      const Scene scene = falling(bumps);
      const ReferenceSpace space(scene, sea);
      const auto robust = robust_of(scene, asked);
      const double held = value_of(scene, space, space.play(*space.holding(kReleased)), asked.goal, robust.get());
      for (const double deadline : {0.05, 0.1, 0.3}) {
        INFO(asked.name << ", " << bumps << " bumps, " << deadline << " s");
        const Optimum best = optimize(scene, space,
                                      {.goal = asked.goal,
                                       .robust = robust,
                                       .deadline = deadline,
                                       .time = Stopwatch::Time::kProcessor,
                                       .threads = 1,
                                       .tolerance_samples = 0});
        REQUIRE(best.found);
        CHECK(best.value <= held * (1 + within(asked)));
        if (deadline >= 0.3) CHECK(best.value < 0.75 * held);  // a tenth of that time is plenty for some better motion
      }
    }
}

TEST_CASE("hold: nor a planner in the air, in any state, by the clock") {
  Scene scene = paper();
  scene.release = Release{kReleased};
  const SeaParameters<double> sea = table2().sea;
  Planner planner(scene, sea);
  for (int i = 0; i < 10; ++i) {
    const double deadline = 0.05, elapsed = 0.01 * i, g = scene.robot.gravity;
    const FallState now{.height = 0.4 - 0.5 * g * elapsed * elapsed,
                        .forward_speed = 0.63,
                        .pitch = scene.drop.pitch,
                        .phi = kReleased,
                        .elapsed = elapsed};
    const Plan plan = planner.plan(now, deadline);
    if (!plan.found()) continue;  // a busy machine may leave no time at all
    Scene there = scene;
    there.drop.height = now.height, there.drop.vertical_speed = -g * elapsed, there.release->from = deadline;
    const ReferenceSpace space(there, sea);
    const double held = value_of(there, space, space.play(*space.holding(kReleased)), Goal::kTolerant, nullptr);
    CHECK(plan.value <= held * (1 + 1e-6));
  }
}

TEST_CASE("hold: without a release the best of many postures is known, and no answer is worse") {
  const Scene scene = paper();
  const ReferenceSpace space(scene, table2().sea);
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
    const double middle = value_of(scene, space, space.play(*space.holding(-45 * kDegree)), goal, nullptr);
    for (const long motions : {1, 2, 16, 2000}) {
      const Optimum best = optimize(scene, space, {.goal = goal, .evaluations = motions, .tolerance_samples = 0});
      REQUIRE(best.found);
      REQUIRE(best.held);
      CHECK(best.value <= best.held->value * (1 + 1e-5));
      CHECK(best.held->value <= middle * (1 + 1e-5));
      CHECK(best.held->motion.phi_i == best.held->motion.phi_f);
      if (motions == 2000) CHECK(best.held->value < 0.7 * middle);
      CHECK(best.held->value ==
            Approx(value_of(scene, space, {best.held->motion, table2().sea}, goal, nullptr)).epsilon(1e-4));
    }
  }
}

TEST_CASE("hold: a posture that breaks the limits is no answer") {
  Scene scene = falling(0);
  scene.release->phi = -85 * kDegree;
  Limits limits;
  limits.motor_speed = limits.reference_rate = 1e-3;  // nothing lands so gently
  const Optimum none = optimize(scene, table2().sea, {.evaluations = 50, .limits = limits, .tolerance_samples = 0});
  CHECK_FALSE(none.found);
  REQUIRE(none.held);
  CHECK(none.held->value == kNoMotion);
}

TEST_CASE("hold: an answer on the edge of its search box says so") {
  Scene scene = paper();
  scene.search.duration = {0.8, 1.0};  // all good motions are quicker
  const ReferenceSpace space(scene, table2().sea);
  const Optimum best = optimize(scene, space, {.evaluations = 3000, .tolerance_samples = 0});
  REQUIRE(best.found);
  for (int k = 0; k < 3; ++k) {
    const Variable& v = space.variables()[std::size_t(k)];
    const double at = (best.values[k] - v.lower) / (v.upper - v.lower);
    CHECK(int(best.edges[std::size_t(k)]) == (at >= 0.999) - (at <= 0.001));
  }
  Coordinates x(3);
  x << scene.search.phi[0], -0.5, 1.0;
  CHECK(space.edges(x)[0] == -1);
  CHECK(space.edges(x)[1] == 0);
  CHECK(space.edges(x)[2] == 1);
  x[0] -= 1;  // beyond it
  CHECK(space.edges(x)[0] == -1);
}

TEST_CASE("a robot that starts on the floor is a scene like any other") {
  const SeaParameters<double> sea = table2().sea;
  for (const char* name : {"paper", "paper_soft", "straight"}) {
    INFO(name);
    Scene scene = read_scene(std::string(UKEMI_DATASETS "/scenes/") + name + ".toml");
    scene.drop.height = 0;
    const Motion held{kReleased, kReleased, 1};
    Scene above = scene;
    above.drop.height = 1e-15;
    CHECK(peak_acceleration(scene, sea, held).peak == Approx(peak_acceleration(above, sea, held).peak).epsilon(1e-5));
    const Optimum on = optimize(scene, sea, {.evaluations = 2000, .tolerance_samples = 0}),
                  near = optimize(above, sea, {.evaluations = 2000, .tolerance_samples = 0});
    REQUIRE(on.found);
    CHECK(on.value == Approx(near.value).epsilon(0.05));
  }
}

TEST_CASE("where nothing keeps the ratings a plan for scatter is none, and the least breaking is named") {
  Actuator weak = table2();
  weak.speed_max = 0.05;
  AnswerOptions o;
  o.robust.measure = Measure{Measure::Kind::kCvar}, o.robust.samples = 64, o.robust.judging = 128;
  o.search.evaluations = 4'000, o.search.tolerance_samples = 0;
  respect_ratings(weak, o.search);
  const Answer a = answer(paper(), weak, o);
  CHECK_FALSE(a.best.found);
  CHECK_THAT(a.best.message, Catch::Matchers::Contains("keeps the limits in 90 % of the drops"));
  REQUIRE(a.least_breaking);
  CHECK(a.least_breaking->excess() > 1);
  CHECK(a.least_breaking->limit == Approx(a.least_breaking->unit == std::string("Nm") ? 20 : 0.05));
  // Holding breaks it more, or is it.
  const Landing held = simulate(paper(), weak.sea, {kReleased, kReleased, 1});
  CHECK(a.least_breaking->excess() <= 1.5 * held.demands.motor_speed / 0.05);
}

TEST_CASE("hold: a search of a single basin leaves the postures out") {
  const Scene scene = paper();
  const SeaParameters<double> sea = table2().sea;
  TwoLinkObjective o(scene, sea, {});
  const Search all(o, {.motions = 1000}, 1), one(o, {.motions = 1000, .hold = 0}, 1);
  CHECK(all.best().value < kNoMotion);
  CHECK(all.held().value == all.best().value);
  CHECK(all.motions() == 1 + 2 * 16);  // the peak is the goal: the best of each round is not played again
  CHECK(one.motions() == 0);
  CHECK(one.best().value == kNoMotion);
}

TEST_CASE("hold: the best posture to hold is that of a fine grid, narrow as its valley may be") {
  const Scene scene = paper();
  double best = kNoMotion;
  for (double phi = -90; phi <= 0; phi += 0.25)
    best = std::min(best, peak_acceleration(scene, table2().sea, {phi * kDegree, phi * kDegree, 1}).peak);
  const Optimum found = optimize(scene, table2().sea, {.goal = Goal::kPeak, .evaluations = 3000});
  REQUIRE(found.held);
  CHECK(found.held->value <= best * 1.001);
  CHECK(found.value < found.held->value);
}
