#include "tools/study/comparison.hpp"

#include <cmath>

#include "common/actuator_constants.hpp"
#include "landing/plan/body_drops.hpp"

namespace ukemi::tools {

using namespace landing;

std::optional<double> ConstantDifference::z() const {
  return std && *std > 0 ? std::optional(difference() / *std) : std::nullopt;
}
std::optional<bool> ConstantDifference::inside() const {
  return z() ? std::optional(std::abs(*z()) <= kNormal975) : std::nullopt;
}

std::vector<ConstantDifference> differences(const PerSet<Actuator>& sets, const std::string& suffix) {
  std::vector<ConstantDifference> out;
  for (std::size_t i = 0; i < actuator_constants().size(); ++i) {
    const ActuatorConstant& c = actuator_constants()[i];
    const PerSet<double> value = {sets[0].sea.*c.at, sets[1].sea.*c.at};
    if (i < kConstants || value[0] != value[1])
      out.push_back({c.key + suffix, c.unit, value, sets[1].standard_error(c.key)});
  }
  return out;
}

namespace {

PerSet<identify::Fit> predictions(const PerSet<Actuator>& sets, const RigTrials& measured, double escape) {
  identify::FitOptions options;
  options.escape = escape;
  PerSet<identify::Fit> out;
  for (std::size_t s = 0; s < 2; ++s) {
    const SeaParameters<double> sea = measured.rig.mounted(sets[s].sea);
    out[s] = identify::predict(measured.rig, measured.trials, sea, options);
  }
  return out;
}

/// Appends each set's best motion, then lands each under both actuators; false where one failed or was stopped.
bool compare_motions(const PerSet<Actuator>& sets, const Scene& scene, const ComparisonOptions& options,
                     std::vector<ComparedMotion>& motions) {
  OptimizeOptions search = options.search;
  const auto best = [&](std::size_t s) {
    if (options.monitor) search.monitor = options.monitor(kSets[s]);
    return optimize(scene, sets[s].sea, search);
  };
  const auto land = [&](std::size_t s, const Motion& motion) {
    const SimulateOptions tight{.accuracy = search.accuracy, .over = &search.monitor.stop};
    return simulate(scene, sets[s].sea, motion, tight, options.rate);
  };
  return compare_motions(motions, best, land, [&] { return search.monitor.stopped(); });
}

/// Appends the plans for drops that scatter; false where one could not be found or was stopped.
bool compare_plans(const PerSet<Actuator>& sets, const Scene& scene, const ComparisonOptions& options,
                   std::vector<ComparedPlan>& plans) {
  const Scatter scatter = scatter_for(options.robust.scatter, scene);
  const bool measured = !options.robust.drops.empty();
  const DropModel drops = measured ? DropModel::measured(scene, options.robust.drops) : DropModel(scene, scatter);
  const bool covariance = !measured && sets[1].covariance.size() > 0;
  for (std::size_t n = 0; n < (covariance ? 3 : 2); ++n) {
    const Actuator& actuator = sets[std::min<std::size_t>(n, 1)];
    const DropModel planned_for =
        measured ? drops : DropModel(scene, scatter, actuator, {.actuator = n == 2, .inflate = options.robust.inflate});
    ComparedPlan& plan = plans.emplace_back();
    plan.set = planned_with(n);
    OptimizeOptions search = options.search;
    if (options.monitor) search.monitor = options.monitor("robust, " + plan.set);
    search.goal = Goal::kRobust, search.search_accuracy = Robust::kAccuracy, search.tolerance_samples = 0;
    search.robust = robust_goal(planned_for, options.robust, search.seed);
    plan.best = optimize(scene, actuator.sea, search);
    if (!plan.best.found || search.monitor.stopped()) return plans.pop_back(), false;
    plan.truth = under_scatter(drops, ReferenceSpace(scene, sets[1].sea), {plan.best.motion, sets[1].sea},
                               {.measure = *options.robust.measure, .seed = search.seed, .threads = search.threads});
  }
  return true;
}

}  // namespace

Comparison compare(const PerSet<Actuator>& sets, const std::optional<RigTrials>& measured,
                   const std::optional<Scene>& scene, const ComparisonOptions& options) {
  Comparison out{.sets = sets, .measured = measured, .scene = scene, .constants = differences(sets)};
  if (measured) {
    out.predictions = predictions(sets, *measured, options.escape);
    for (const identify::Fit& fit : *out.predictions) out.complete = out.complete && fit.converged;
  }
  if (scene) out.complete = compare_motions(sets, *scene, options, out.motions) && out.complete;
  if (scene && options.robust.measure) out.complete = compare_plans(sets, *scene, options, out.plans) && out.complete;
  return out;
}

}  // namespace ukemi::tools
