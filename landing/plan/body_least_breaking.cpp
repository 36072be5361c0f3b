#include "landing/plan/body_least_breaking.hpp"

#include <algorithm>

#include "landing/body/load.hpp"
#include "landing/plan/body_drops.hpp"

namespace ukemi::landing {

std::optional<BodyLeastBreaking> least_breaking(const BodyScene& scene, const BodyPlanOptions& options) {
  constexpr long kMotions = 1'500;
  BodyScene rated = scene;
  std::erase_if(rated.loads, [](const Load& l) { return !l.limit; });
  const std::size_t own = rated.loads.size();
  for (std::size_t j = 0; j < rated.limits.joints.size(); ++j) {
    const auto to_load = [&](Load::Kind kind, double& rating) {
      if (rating < BodyLimits::kNone && rated.robot.joints[j].driven())
        rated.loads.push_back({.name = "rating", .kind = kind, .index = int(j), .rating = rating});
      rating = BodyLimits::kNone;
    };
    to_load(Load::Kind::kMotorSpeed, rated.limits.joints[j].motor_speed);
    to_load(Load::Kind::kMotorTorque, rated.limits.joints[j].motor_torque);
  }
  if (rated.loads.size() == own) return std::nullopt;
  const BodyPlan best = plan(rated, {.goal = Goal::kTolerant,
                                     .fresh = 0,
                                     .evaluations = kMotions,
                                     .accuracy = options.accuracy,
                                     .seed = options.seed,
                                     .threads = options.threads,
                                     .monitor = {{}, options.monitor.stop}});
  if (!best.found) return std::nullopt;
  std::optional<BodyLeastBreaking> out;
  for (const BodyDrop& drop : execution_drops(rated)) {
    const BodyLanding l = peak_acceleration(drop.scene, drop.played(best.motion), {.accuracy = options.accuracy});
    const std::vector<LoadPeak> loads = loads_of(drop.scene, l);
    for (std::size_t i = own; i < loads.size(); ++i)
      if (const Load& x = rated.loads[i]; !out || loads[i].value / x.rating > out->excess())
        out = {best.motion, x.index, x.kind, loads[i].value, x.rating};
  }
  if (out && out->excess() <= 1) out.reset();  // what is broken is another limit
  return out;
}

}  // namespace ukemi::landing
