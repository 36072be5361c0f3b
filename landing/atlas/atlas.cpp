#include "landing/atlas/atlas.hpp"

#include <atomic>
#include <cmath>
#include <mutex>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/files.hpp"
#include "common/parallel.hpp"
#include "common/random.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/model/scene_file.hpp"

namespace ukemi::landing {

void AtlasOptions::validate() const {
  grid.validate();
  shard.validate(grid);
  search.validate();
  robust.validate();
}

long AtlasOptions::effort() const {
  const long usual = robust.measure ? kLandings : search.goal == Goal::kTolerant ? kTolerantMotions : kMotions;
  return search.evaluations.value_or(usual);
}

namespace {

AtlasCell cell_of(const Optimum& best) {
  AtlasCell out{.state = AtlasCell::State::kNone};
  if (!best.found || best.landing.joint_lost) return out;
  out.state = AtlasCell::State::kPlanned;
  out.value = best.value, out.peak = best.landing.peak;
  out.tolerant_peak = best.tolerant.failed ? std::nan("") : best.tolerant.value;
  std::copy(best.values.begin(), best.values.end(), out.values.begin());
  return out;
}

/// The best motion for one drop, the search starting from what neighbours play.
AtlasCell plan_drop(Scene scene, const Actuator& actuator, const AtlasOptions& options, std::size_t drop,
                    std::vector<MotionValues> starts) {
  constexpr long kFirst = 4;
  constexpr long kJudging = 256;
  scene.drop = options.grid.drop(drop);
  OptimizeOptions search = options.search;
  search.evaluations = options.effort() * (starts.empty() ? kFirst : 1);
  search.starts = std::move(starts);
  search.threads = 1, search.tolerance_samples = 0;
  search.seed = Random(options.search.seed, drop).bits();
  search.monitor = {{}, options.monitor.stop};
  if (options.robust.measure) {
    const DropModel drops(scene, scatter_for(options.robust.scatter, scene), actuator,
                          {.inflate = options.robust.inflate});
    RobustOptions robust = options.robust;
    robust.judging = kJudging;
    search.goal = Goal::kRobust, search.search_accuracy = Robust::kAccuracy;
    search.robust = robust_goal(drops, robust, options.search.seed);
  }
  return cell_of(optimize(scene, actuator.sea, search));
}

}  // namespace

std::string atlas_identity(const Scene& scene, const Actuator& actuator, const AtlasOptions& options) {
  std::string text = UKEMI_VERSION + to_toml(scene, "") + to_toml(actuator);  // another version may plan otherwise
  const auto add = [&](double x) { text += shortest(x) + "\n"; };
  for (const AtlasAxis& a : options.grid.axes) add(a.lower), add(a.upper), add(double(a.count));
  add(double(options.search.goal)), add(double(options.effort()));
  text += std::to_string(options.search.seed) + "\n";
  if (const auto& measure = options.robust.measure) {
    text += measure->name() + "\n";
    const Scatter scatter = scatter_for(options.robust.scatter, scene);
    for (const ScatterTerm& term : kScatterTerms) add(scatter.*term.deviation);
    add(options.robust.inflate), add(double(options.robust.samples)), add(options.robust.penalty);
  }
  return checksum(text);
}

void plan_atlas(const Scene& scene, const Actuator& actuator, const AtlasOptions& options, std::span<AtlasCell> cells) {
  options.validate(), scene.validate(), validate(actuator);
  options.grid.check_cells(cells.size());
  const std::vector<std::size_t> blocks = options.shard.blocks(options.grid);
  const int dimension = ReferenceSpace(scene, actuator.sea).dimension();
  long open = 0, planned = 0;
  for (const std::size_t i : options.shard.drops(options.grid)) open += cells[i].state == AtlasCell::State::kOpen;
  std::mutex mutex;
  parallel_for(int(blocks.size()), options.search.threads, [&](int b) {
    std::vector<MotionValues> starts;
    for (const std::size_t i : options.grid.block(blocks[std::size_t(b)])) {
      if (cells[i].state == AtlasCell::State::kOpen) {
        const AtlasCell cell = plan_drop(scene, actuator, options, i, starts);
        if (options.monitor.stopped()) return;  // it may have been cut short
        const std::lock_guard lock(mutex);
        cells[i] = cell;
        if (options.done) options.done(i, cell);
        options.monitor.progress(++planned, open);
      }
      if (cells[i].planned()) starts.push_back(cells[i].coordinates(dimension));
    }
  });
}

}  // namespace ukemi::landing
