#include "landing/plan/body_least_breaking.hpp"

#include "landing/body/load.hpp"
#include "landing/plan/body_drops.hpp"

namespace ukemi::landing {

std::optional<BodyLeastBreaking> least_breaking(const BodyScene& scene, const BodyPlanOptions& options) {
  constexpr long kMotions = 1'500;
  BodyScene rated = scene;
  std::erase_if(rated.loads, [](const Load& l) { return !l.limit; });
  for (Load& l : rated.loads) l.limit = l.rating == 0 || l.kind == Load::Kind::kReferenceRate;
  if (!landing::rated(rated)) return std::nullopt;
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
    for (std::size_t i = 0; i < loads.size(); ++i)
      if (const Load& x = rated.loads[i]; !x.limit && (!out || loads[i].value / x.rating > out->excess()))
        out = {best.motion, x, loads[i].value};
  }
  if (out && out->excess() <= 1) out.reset();  // only a limit that must be kept was broken
  return out;
}

}  // namespace ukemi::landing
