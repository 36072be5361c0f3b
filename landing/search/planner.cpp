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

Planner::Planner(const Scene& scene, std::shared_ptr<const MotionSpace> space, const Options& options)
    : scene_(scene),
      space_(std::move(space)),
      options_(options),
      objective_(scene_, *space_,
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
  const Candidate best = search.judge(options_.verified, deadline);
  const Play play = objective_.play(best);
  return {play.motion, play.sea, best.value, searched, best.value < kNoMotion};
}

}  // namespace ukemi::landing
