#include "landing/judge/speed.hpp"

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/model/motion_space.hpp"

namespace ukemi::landing {

namespace {

void check(const char* what, const std::vector<double>& values) {
  if (values.empty()) throw InputError(std::string(what) + ": at least one value is needed");
  for (const double v : values)
    if (!(v > 0))
      throw InputError(std::string(what) + ": " + shortest(v) + ": above 0 is needed");  // infinite: no limit
}

}  // namespace

std::vector<RatedPlan> rated_plans(const Scene& scene, const Actuator& actuator, const RatingOptions& options) {
  check("speeds", options.speeds), check("torques", options.torques);
  const ReferenceSpace space(scene, actuator.sea);
  const auto search = [&](Goal goal, double speed, double torque) {
    OptimizeOptions o = options.search;
    o.goal = goal;
    o.limits.motor_speed = o.limits.reference_rate = speed, o.limits.motor_torque = torque;
    return optimize(scene, space, o);
  };
  const auto improve = [](Optimum& best, const Optimum& weaker) {
    if (weaker.found && (!best.found || weaker.value < best.value)) best = weaker;
  };
  std::vector<RatedPlan> out;
  const std::size_t columns = options.torques.size(), searches = 2 * columns * options.speeds.size();
  const Monitor& monitor = options.search.monitor;
  for (std::size_t i = 0; i < options.speeds.size(); ++i)
    for (std::size_t j = 0; j < columns && !monitor.stopped(); ++j) {
      const double speed = options.speeds[i], torque = options.torques[j];
      RatedPlan plan{speed, torque, search(Goal::kPeak, speed, torque), search(Goal::kTolerant, speed, torque)};
      if (const double peak = plan.tolerant.landing.peak;
          plan.tolerant.found && (!plan.lowest.found || peak < plan.lowest.value))
        plan.lowest = plan.tolerant, plan.lowest.value = peak;
      for (const std::size_t weaker : {i > 0 ? out.size() - columns : out.size(), j > 0 ? out.size() - 1 : out.size()})
        if (weaker < out.size()) improve(plan.lowest, out[weaker].lowest), improve(plan.tolerant, out[weaker].tolerant);
      out.push_back(plan);
      monitor.progress(long(2 * out.size()), long(searches));
    }
  return out;
}

}  // namespace ukemi::landing
