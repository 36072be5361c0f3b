#include "landing/search/planner.hpp"

#include <algorithm>

#include "common/csv.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

double verification_time(double budget, double landing) {
  return std::min(0.45 * budget, std::max(kTightLanding * landing, std::clamp(0.05 * budget, 0.003, 0.1)));
}

void check_deadline(double deadline) {
  if (!(deadline > 0)) throw InputError("deadline: " + shortest(deadline) + " s: above 0 is needed");
}

Planner::Planner(const Scene& scene, const SeaParameters<double>& sea, const Options& options)
    : scene_(scene),
      sea_(sea),
      options_(options),
      objective_(scene_, sea_,
                 {.goal = options.goal,
                  .accuracy = options.accuracy,
                  .limits = options.limits,
                  .reference_rate = options.reference_rate}) {}

Plan Planner::plan(const Drop& drop, double deadline, std::uint64_t seed) {
  objective_.watch.restart();
  check_deadline(deadline);
  scene_.drop = drop;
  const long before = objective_.motions();
  Search search(objective_, {.seconds = deadline - verification_time(deadline, objective_.landing_time())}, seed);
  search_.run(search);
  const long searched = objective_.motions() - before;
  const Point3 best = search.settle(options_.verified, deadline);
  return {objective_.motion(best), best.value, searched, best.value < kNoMotion};
}

}  // namespace ukemi::landing
