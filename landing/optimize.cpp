#include "landing/optimize.hpp"

#include <algorithm>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/planner.hpp"
#include "landing/solvers.hpp"

namespace ukemi::landing {

void OptimizeOptions::validate() const {
  if (evaluations && *evaluations < 1)
    throw InputError("evaluations: " + std::to_string(*evaluations) + ": at least 1 is needed");
  if (deadline) check_deadline(*deadline);
  if (!(tolerance >= 0 && tolerance < 1))
    throw InputError("tolerance: " + shortest(tolerance) + ": at least 0 and below 1 is needed");
  check_solver(solver);
}

Optimum optimize(const Scene& scene, const SeaParameters<double>& sea, const OptimizeOptions& options) {
  options.validate();
  Objective objective(scene, sea,
                      {.goal = options.goal,
                       .accuracy = options.search_accuracy,
                       .limits = options.limits,
                       .reference_rate = options.reference_rate,
                       .threads = options.threads,
                       .time = options.time});
  Budget budget;
  if (options.deadline) budget.seconds = *options.deadline - verification_time(*options.deadline);
  if (options.evaluations || !options.deadline)
    budget.motions = options.evaluations.value_or(default_evaluations(options.goal));
  budget.tolerance = options.tolerance;
  Optimum out;
  out.solver = options.solver;
  constexpr std::size_t kKept = 4096;
  out.progress.reserve(kKept);
  Search search(objective, budget, options.seed, &out.progress);
  search.tell = options.progress;
  run_solver(options.solver, search);
  out.evaluations = search.motions();
  const Point3 best = search.settle(options.accuracy, options.deadline.value_or(budget.seconds));
  out.seconds = objective.watch.seconds();
  out.motion = objective.motion(best);
  out.landings = objective.landings();
  out.found = best.value < kNoMotion;
  if (!out.found) {
    const bool limited = options.limits.any_forbidden() || options.limits.rated() || options.reference_rate < kNoMotion;
    const bool floor = peak_acceleration(scene, sea, objective.motion({}), {}).end != End::kNoContact;
    out.message = !floor    ? "no point of the robot touches the floor: there is no landing to plan"
                  : limited ? "no motion of the search range was found that keeps the limits"
                            : "no motion of the search range could be followed";
    return out;
  }
  const SimulateOptions tight{.accuracy = options.accuracy};
  out.landing = peak_acceleration(scene, sea, out.motion, tight);
  out.tolerant = tolerant_peak(scene, sea, out.motion, tight, options.tolerance_samples, options.seed, options.threads);
  out.value = options.goal == Goal::kPeak ? out.landing.peak : out.tolerant.value;
  return out;
}

}  // namespace ukemi::landing
