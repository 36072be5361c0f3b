#include "landing/search/optimize.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/search/deadline.hpp"
#include "landing/search/planner.hpp"
#include "landing/search/population.hpp"
#include "landing/search/solvers.hpp"
#include "landing/search/two_link_objective.hpp"

namespace ukemi::landing {

void OptimizeOptions::validate() const {
  if (evaluations && *evaluations < 1)
    throw InputError("evaluations: " + std::to_string(*evaluations) + ": at least 1 is needed");
  if (deadline) check_deadline(*deadline);
  if (!(tolerance >= 0 && tolerance < 1))
    throw InputError("tolerance: " + shortest(tolerance) + ": at least 0 and below 1 is needed");
  check_solver(solver);
}

namespace {

/// Why nothing was found, or why the search ended early; else empty.
std::string message_of(const OptimizeOptions& options, const TwoLinkObjective& objective, bool found, bool exhausted) {
  if (!found && options.monitor.stopped()) return "interrupted before a motion was found";
  const std::string bound = fmt::format(
      "the landings of this scene are long ({} of them took {} steps): the search ended at its bound of work",
      objective.landings(), objective.work());
  if (found) return exhausted ? bound : "";
  if (objective.flights() > 0 && objective.flights() == objective.landings())
    return "no point of the robot touches the floor: there is no landing to plan";
  const bool limited = objective.limits().any();
  if (options.deadline)
    return fmt::format("no motion could be followed{} in the {:g} s given", limited ? " within the limits" : "",
                       *options.deadline);
  std::string none = limited ? "no motion of the search range was found that keeps the limits"
                             : "no motion of the search range could be followed";
  if (limited && options.goal == Goal::kRobust)
    none += fmt::format(" in {:g} % of the drops", 100 * options.robust->measure.share());
  return exhausted ? none + "; " + bound : none;
}

/// The best of the starts in the unit cube, under scatter over a few drops; absent where none can be followed.
std::optional<Coordinates> best_start(Search& search, const MotionSpace& space,
                                      const std::vector<MotionValues>& starts) {
  constexpr std::size_t kDrops = 16;
  const Goal goal = search.objective().goal();
  Candidate best = search.centre();
  for (std::size_t from = 0; from < starts.size(); from += kBatch) {
    std::vector<Candidate> points;
    for (std::size_t i = from; i < std::min(from + kBatch, starts.size()); ++i) {
      points.push_back({space.unit(starts[i])});
      points.back().bound = best.value;
    }
    search.evaluate(points, {goal, kDrops});
    best = std::min(best, *std::min_element(points.begin(), points.end()));
  }
  return best.value < kNoMotion ? std::optional(best.u) : std::nullopt;
}

/// Budget of the search; `reserve`: time before the deadline that is kept for the verification [s].
Budget budget_of(const OptimizeOptions& options, const TwoLinkObjective& objective, double reserve) {
  Budget out;
  if (options.deadline)
    out.seconds = *options.deadline - objective.watch.seconds() - reserve -
                  verification_time(*options.deadline, objective.landing_time());
  if (options.evaluations || !options.deadline)
    out.motions = options.evaluations.value_or(default_evaluations(options.goal, objective.dimension()));
  out.work = work_allowed(objective.landings_per_motion(options.goal), out.motions);
  out.tolerance = options.tolerance;
  return out;
}

void set_motion(const Candidate& answer, const TwoLinkObjective& objective, Optimum& out) {
  const DrivenMotion play = objective.play(answer);
  out.motion = play.motion, out.sea = play.sea;
  out.values = objective.space().values(answer.u),
  out.edges = objective.space().edges(objective.space().values(answer.u));
}

/// Plays the landing of the answer and its execution box at OptimizeOptions::accuracy; `value`: of the search.
void verify(double value, const OptimizeOptions& options, const TwoLinkObjective& objective, Optimum& out) {
  const Scene& scene = objective.scene();
  const MotionSpace& space = objective.space();
  const DrivenMotion play{out.motion, out.sea};
  const SimulateOptions tight{.accuracy = options.accuracy, .over = objective.over()};
  const bool peak = options.goal == Goal::kPeak;
  out.landing = peak_acceleration(scene, play.sea, play.motion, tight);
  out.verified = out.landing.end != End::kStopped;
  if (!out.verified)
    out.landing.peak = peak ? std::max(out.landing.peak, value) : std::numeric_limits<double>::quiet_NaN();
  const int samples = std::isfinite(objective.deadline) ? 0 : options.tolerance_samples;
  out.tolerant = tolerant_peak(scene, space, play, tight, samples, options.seed, options.threads);
  if (!out.tolerant.complete)
    out.tolerant.value = std::max(out.tolerant.value, options.goal == Goal::kTolerant ? value : out.landing.peak);
  out.value = peak ? out.landing.peak : options.goal == Goal::kRobust ? value : out.tolerant.value;
  if (out.held && options.goal == Goal::kTolerant && out.held->value < kNoMotion) out.held->tolerant = out.held->value;
}

}  // namespace

Optimum optimize(const Scene& scene, const SeaParameters<double>& sea, const OptimizeOptions& options) {
  return optimize(scene, ReferenceSpace(scene, sea), options);
}

Optimum optimize(const Scene& scene, const MotionSpace& space, const OptimizeOptions& options) {
  options.validate();
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double deadline = options.deadline.value_or(kNever);
  TwoLinkObjective objective(scene, space,
                             {.goal = options.goal,
                              .accuracy = options.search_accuracy,
                              .limits = options.limits,
                              .threads = options.threads,
                              .time = options.time,
                              .deadline = deadline,
                              .stop = options.monitor.stop,
                              .robust = options.robust});
  double reserve = 0;  // for the landing and the execution box of the result [s]
  if (options.deadline)
    reserve = std::min(0.2 * deadline, (1 + kExecutionPoints) * kTightCost * objective.landing_time());
  Optimum out;
  out.solver = options.solver;
  constexpr std::size_t kMaxProgress = 4096;
  out.progress.reserve(kMaxProgress);
  Search search(objective, budget_of(options, objective, reserve), options.seed, &out.progress);
  search.on_progress = options.monitor.on_progress;
  const std::optional<Coordinates> start = best_start(search, space, options.starts);
  if (start) search.warm_starts = {&*start, 1};
  run_solver(options.solver, search);
  out.evaluations = search.motions();
  out.work = objective.work();
  const bool exhausted = objective.exhausted();
  double end = deadline;
  const auto allow_leave = [&] {  // once: the rest may still take kLeave
    if (!objective.stop || !options.monitor.stopped()) return;
    objective.stop = nullptr;
    end = std::min(end, objective.watch.seconds() + OptimizeOptions::kLeave);
    reserve = 0.5 * (end - objective.watch.seconds());
  };
  allow_leave();
  const Candidate best = search.judge(options.accuracy, end - reserve);
  out.seconds = objective.watch.seconds();
  const Candidate& held = search.held();
  if (space.holding(0)) out.held = Held{objective.play(held).motion, held.value};
  set_motion(best, objective, out);
  out.landings = objective.landings();
  out.found = best.value < kNoMotion;
  out.message = message_of(options, objective, out.found, exhausted);
  if (!out.found) return out;
  allow_leave();
  objective.deadline = end;
  objective.limit_work(kUnbounded);
  verify(best.value, options, objective, out);
  const bool worse_than_held = options.goal != Goal::kRobust && out.value > held.value;  // if unverified before
  if (worse_than_held && best.u != held.u) {
    set_motion(held, objective, out);
    verify(held.value, options, objective, out);
  }
  return out;
}

}  // namespace ukemi::landing
