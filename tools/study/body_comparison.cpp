#include "tools/study/body_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "landing/plan/body_drops.hpp"
#include "landing/plan/body_space.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/scatter/sampler.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// A joint's drive as an actuator.
Actuator drive_of(const Joint& j) {
  return {.name = j.name, .sea = j.sea, .uncertain = j.uncertain, .covariance = j.covariance};
}

/// The constants of each drive that differs, or of all drives where none does, without those that are 0 in both sets.
std::vector<ConstantDifference> drive_differences(const PerSet<BodyScene>& scenes) {
  std::vector<ConstantDifference> all, out;
  for (std::size_t i = 0; i < scenes[0].robot.joints.size(); ++i) {
    const PerSet<Joint> joint = {scenes[0].robot.joints[i], scenes[1].robot.joints[i]};
    if (!joint[0].driven() || !joint[1].driven()) continue;
    std::vector<ConstantDifference> rows = differences({drive_of(joint[0]), drive_of(joint[1])}, "_" + joint[0].name);
    std::erase_if(rows, [](const ConstantDifference& c) { return c.value[0] == 0 && c.value[1] == 0; });
    all.insert(all.end(), rows.begin(), rows.end());
    if (std::any_of(rows.begin(), rows.end(), [](auto& c) { return c.difference() != 0; }))
      out.insert(out.end(), rows.begin(), rows.end());
  }
  return out.empty() ? all : out;
}

/// Appends the plans for drops that scatter; false where one could not be found or was stopped.
bool compare_plans(const PerSet<BodyScene>& scenes, const BodyComparisonOptions& options,
                   std::vector<ComparedBodyPlan>& plans) {
  const bool drawn = !options.measured[1];
  BodyPlanOptions search = options.search;
  search.scatter = scatter_for(options.search.scatter, scenes[1]);
  const std::vector<BodyDrop> drops =
      drawn
          ? BodyDropModel(scenes[1], *search.scatter, {.inflate = 0}).independent(search.fresh, fresh_seed(search.seed))
          : *options.measured[1];
  search.fresh = 0;  // evaluated on the drops of the identified set below
  for (std::size_t n = 0; n < (drawn && scenes[1].robot.fitted() ? 3 : 2); ++n) {
    const std::string set = planned_with(n);
    if (options.monitor) search.monitor = options.monitor("robust, " + set);
    search.inflate = n == 2 ? options.search.inflate : 0;
    search.measured = options.measured[std::min<std::size_t>(n, 1)];
    BodyPlan best = plan(scenes[std::min<std::size_t>(n, 1)], search);
    if (!best.found || search.monitor.stopped()) return false;
    constexpr double kAccuracy = 1e-6;
    const std::vector<double> peaks = peaks_over(drops, best.motion, kAccuracy, search.threads).peaks;
    plans.push_back({set, std::move(best), distribution(peaks)});
  }
  return true;
}

}  // namespace

void check_sets(const PerSet<BodyScene>& scenes) {
  const auto non_drive_names = [](const BodyScene& scene) {
    std::vector<std::string> out = design_names(scene);
    std::erase_if(out, [](const std::string& name) { return name.starts_with("drive."); });
    return out;
  };
  const std::vector<std::string> names = non_drive_names(scenes[0]);
  if (names != non_drive_names(scenes[1]) || scenes[0].robot.joints.size() != scenes[1].robot.joints.size())
    throw InputError("nominal, identified: they are two robots: one scene with two sets of drives is needed");
  for (const std::string& name : names) {
    const PerSet<double> value = {design_number(scenes[0], name), design_number(scenes[1], name)};
    if (value[0] != value[1] && !(std::isnan(value[0]) && std::isnan(value[1])))
      throw InputError(
          fmt::format("nominal, identified: {}: {:g} and {:g}: only drives may differ", name, value[0], value[1]));
  }
  const BodySpace nominal(scenes[0]), identified(scenes[1]);
  const auto same = [](const Variable& a, const Variable& b) {
    return a.name == b.name && a.lower == b.lower && a.upper == b.upper;
  };
  const auto [one, other] = std::mismatch(nominal.variables().begin(), nominal.variables().end(),
                                          identified.variables().begin(), identified.variables().end(), same);
  if (one != nominal.variables().end() || other != identified.variables().end())
    throw InputError(fmt::format("nominal, identified: search of {}: only drives may differ",
                                 one != nominal.variables().end() ? one->name : other->name));
}

BodyComparison compare(const PerSet<BodyScene>& scenes, const BodyComparisonOptions& options) {
  BodyComparison out{.scenes = scenes, .constants = drive_differences(scenes)};
  BodyPlanOptions search = options.search;
  search.measure.reset(), search.scatter.reset(), search.fresh = 0;
  const auto best = [&](std::size_t s) {
    if (options.monitor) search.monitor = options.monitor(kSets[s]);
    return plan(scenes[s], search);
  };
  const auto land = [&](std::size_t s, const BodyMotion& motion) {
    const std::function<bool()>& stop = search.monitor.stop;
    return simulate(scenes[s], motion, {.accuracy = search.accuracy, .over = stop ? &stop : nullptr}, options.rate);
  };
  out.complete = compare_motions(out.motions, best, land, [&] { return search.monitor.stopped(); });
  if (options.search.measure) out.complete = compare_plans(scenes, options, out.plans) && out.complete;
  return out;
}

}  // namespace ukemi::tools
