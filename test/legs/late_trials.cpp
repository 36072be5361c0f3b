// Trials of robots whose drives are late: hits on a rig as a robot of one link, beside a simulator that keeps the
// history of what its drive asked for.
#include <catch2/catch.hpp>
#include <cmath>

#include "test/legs/hits.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace ukemi::tools;
using namespace legs;

namespace {

constexpr const char *kDelay = "drive.arm.control_delay", *kFilter = "drive.arm.velocity_filter";

bool any_trusted(const RobotFit& fit, double beyond) {
  for (std::size_t k = 0; k < kConstants; ++k) {
    const identify::Estimate& e = found(fit, std::string("drive.arm.") + kConstantNames[k]);
    if (e.verdict == Identifiability::kTrusted && std::abs(e.value - kTruth[k]) > beyond * *e.std) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("a robot whose drive is late moves as the simulator that keeps its history", "[driven]") {
  for (const auto& [delay, filter] : {std::pair{1e-3, 0.0}, {0.0, 2e-3}, {5e-3, 1e-3}}) {
    Effects effects{.delay = delay, .filter = filter};
    effects.angle_noise = 0;
    Hits hits(test::eight_hits(effects, 1), 1);
    const auto apart = [&](double step) {
      double out = 0;
      for (const RobotTrial& t : hits.trials) {
        const DrivenRollout r =
            roll_driven(hits.robot.scene.robot, hits.robot.path, *t.commands, {{{0, 0, 0}}}, t.log.t, {.step = step});
        REQUIRE(r.complete);
        for (std::size_t i = 0; i < t.log.t.size(); ++i)
          out = std::max(out, std::abs(r.joint[0][kAngle][i] - t.log.output[kAngle][i]));
      }
      return out;
    };
    constexpr double kFine = 5e-5, kOfItsOwn = 0;  // [s]
    const double prompt = apart(kFine);
    hits.sea().control_delay = delay, hits.sea().velocity_filter = filter;
    INFO(delay << " s, " << filter << " s: " << apart(kFine) << " rad, in its own steps " << apart(kOfItsOwn)
               << ", at once " << prompt);
    CHECK(apart(kFine) < 2e-6);
    CHECK(apart(kOfItsOwn) < 1e-4);
    CHECK(prompt > 1e-3);
  }
}

TEST_CASE("derivatives by a drive's delay and filter are right where it is not late yet", "[driven]") {
  constexpr double kLate = 2e-4;  // [s]
  Effects prompt, late{.delay = kLate}, filtered{.filter = kLate};
  for (Effects* e : {&prompt, &late, &filtered}) e->angle_noise = 0;
  const Hits hits(test::eight_hits(prompt, 1), 1), by_delay(test::eight_hits(late, 1), 1),
      by_filter(test::eight_hits(filtered, 1), 1);
  const RobotTrials simulator(hits.robot, hits.trials, hits.options);
  const Settings at_once = {{&hits.options.terms[kDelay], 0}, {&hits.options.terms[kFilter], 0}};
  for (std::size_t m : {0U, 3U, 7U}) {
    const std::vector<double>& t = hits.trials[m].log.t;
    FollowedDrop d = simulator.follow(m, at_once, t, {});
    REQUIRE(simulator.differentiate(m, at_once, t, {}, d));
    const Hits* of[] = {&by_delay, &by_filter};
    for (long k : {0L, 1L}) {
      double off = 0, size = 0;
      for (std::size_t i = 0; i < t.size(); ++i) {
        const auto measured = [&](const Hits& h) { return h.trials[m].log.output[kAngle][i]; };
        const double by = (measured(*of[k]) - measured(hits)) / kLate;
        off = std::max(off, std::abs(d.slope[kAngle](long(i), k) - by)), size = std::max(size, std::abs(by));
      }
      INFO(m << " " << k << ": " << off << " of " << size);
      CHECK(off < 0.02 * size);
    }
  }
}

TEST_CASE("constants of a drive that is late come back, and those of a fit without the delay are not trusted wrong",
          "[driven]") {
  const Effects effects{.delay = 1e-3};
  Hits hits(test::eight_hits(effects, 11), 1.15);
  {
    INFO("taken to act at once");
    RobotFitOptions o = hits.options;
    o.errors = {{kDelay, 0}, {kFilter, 0}};
    const RobotFit fit = fit_robot(hits.robot, hits.trials, o);
    CHECK(fit.considered.empty());
    CHECK(worst(fit) > 10);
  }
  {
    INFO("as it comes");
    const RobotFit fit = fit_robot(hits.robot, hits.trials, hits.options);
    REQUIRE(fit.considered.size() == 2);
    CHECK_FALSE(any_trusted(fit, 3));
    CHECK(worst(fit) < 3);
  }
  {
    INFO("its delay fitted: these hits take it for damping, and it ends at its bound");
    RobotFitOptions o = hits.options;
    o.terms.free.push_back(kDelay), o.errors = {{kFilter, 0}};
    const RobotFit fit = fit_robot(hits.robot, hits.trials, o);
    const identify::Estimate* delay = identify::find_constant(fit, kDelay);
    REQUIRE((delay && delay->at_bound && !delay->std));
    CHECK_FALSE(any_trusted(fit, 3));
    CHECK(worst(fit) < 3);
  }
}

TEST_CASE("a drive's delay is told from its constants where it is long", "[driven]") {
  Effects effects{.delay = 5e-3};
  effects.angle_noise = 2e-4;
  Hits hits(test::eight_hits(effects, 12), 1.15);
  hits.options.terms.free.push_back(kDelay), hits.options.errors = {{kFilter, 0}};
  const RobotFit fit = fit_robot(hits.robot, hits.trials, hits.options);
  REQUIRE(fit.converged);
  const identify::Estimate& delay = found(fit, kDelay);
  INFO(delay.value << " +- " << *delay.std);
  CHECK(std::abs(delay.value - effects.delay) < 4 * *delay.std);
  CHECK(*delay.std < 0.3 * effects.delay);
  CHECK(worst(fit) < 4);
  CHECK(fit.robot.scene.robot.joints[0].sea.control_delay == delay.value);
}
