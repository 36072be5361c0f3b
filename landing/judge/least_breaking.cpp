#include "landing/judge/least_breaking.hpp"

#include <algorithm>
#include <cmath>

#include "common/parallel.hpp"
#include "landing/run/simulate.hpp"
#include "landing/search/population.hpp"
#include "landing/search/robust.hpp"

namespace ukemi::landing {

namespace {

/// The rating that one landing exceeds most; an infinite demand where it breaks another limit.
LeastBreaking demand_of(const Scene& scene, const DrivenMotion& play, const Limits& limits) {
  Limits others = limits;
  constexpr double kAny = std::numeric_limits<double>::infinity();
  others.motor_speed = others.motor_torque = others.reference_rate = kAny;
  const Landing l = simulate(scene, play.sea, play.motion, {.accuracy = 1e-6, .max_steps = 20'000, .limits = others});
  if (no_landing(l.end)) return {play.motion, "", "", kAny, 1};
  const double rate = peak_reference_rate(play.motion, l.contacts.first() + scene.detection_delay);
  LeastBreaking worst{play.motion, "reference_rate", "rad/s", rate, limits.reference_rate};
  for (const LeastBreaking& m :
       {LeastBreaking{play.motion, "motor_speed", "rad/s", l.demands.motor_speed, limits.motor_speed},
        {play.motion, "motor_torque", "Nm", l.demands.motor_torque, limits.motor_torque}})
    if (m.excess() > worst.excess()) worst = m;
  return worst;
}

/// The largest demand of a motion over the share of its execution box or drops that must keep the ratings.
LeastBreaking demand_of(const Scene& scene, const MotionSpace& space, const DrivenMotion& play,
                        const OptimizeOptions& options) {
  constexpr std::size_t kDrops = 8;
  std::vector<LeastBreaking> all;
  double share = 1;
  if (options.robust) {
    share = options.robust->measure.share();
    for (const ScatteredDrop& d :
         std::span(options.robust->drops).first(std::min(kDrops, options.robust->drops.size())))
      all.push_back(demand_of(d.scene, d.played(space, play), options.limits));
  } else {
    for (int k = 0; k < kExecutionPoints; ++k)
      all.push_back(demand_of(scene, space.execution_point(play, scene.execution, k), options.limits));
  }
  std::sort(all.begin(), all.end(), [](auto& a, auto& b) { return a.excess() < b.excess(); });
  LeastBreaking out = all[std::size_t(std::ceil(share * double(all.size()))) - 1];
  out.motion = play.motion;
  return out;
}

}  // namespace

std::optional<LeastBreaking> least_breaking(const Scene& scene, const MotionSpace& space,
                                            const OptimizeOptions& options) {
  constexpr std::size_t kPopulation = 20;
  constexpr int kGenerations = 20;
  OptimizeOptions o = options;
  if (scene.joint) o.limits.joint = *scene.joint;
  const auto demand = [&](const Candidate& p) { return demand_of(scene, space, space.play(space.values(p.u)), o); };
  const auto play = [&](std::span<Candidate> points) {
    parallel_for(int(points.size()), o.threads, [&](int i) {
      Candidate& p = points[std::size_t(i)];
      p.value = std::min(demand(p).excess(), kNoMotion);
    });
  };
  Random random(o.seed, 0xb4ea);
  std::vector<Candidate> population, trials(kPopulation);
  const double phi = held_angle(scene);
  if (const auto held = space.holding(phi)) population.push_back({space.place(*held)});
  while (population.size() < kPopulation) population.push_back(random_point(random, space.dimension()));
  play(population);
  for (int n = 0; n < kGenerations && !o.monitor.stopped(); ++n) evolve(play, random, population, trials, {});
  const Candidate& best = *std::min_element(population.begin(), population.end());
  return best.value < kNoMotion ? std::optional(demand(best)) : std::nullopt;
}

}  // namespace ukemi::landing
