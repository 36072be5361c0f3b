#include "landing/atlas/atlas.hpp"

#include <mutex>

#include "common/csv.hpp"
#include "common/files.hpp"
#include "common/parallel.hpp"
#include "common/random.hpp"

namespace ukemi::landing {

void AtlasOptions::validate() const {
  grid.validate();
  shard.validate(grid);
  search.validate();
  robust.validate();
}

long AtlasOptions::effort() const {
  const long standard = robust.measure ? kLandings : search.goal == Goal::kTolerant ? kTolerantMotions : kMotions;
  return search.evaluations.value_or(standard);
}

std::string atlas_identity(const AtlasRobot& robot, const AtlasOptions& options) {
  std::string text = UKEMI_VERSION + robot.text();  // another version may plan differently
  const auto add = [&](double x) { text += shortest(x) + "\n"; };
  for (const AtlasAxis& a : options.grid.axes) add(a.lower), add(a.upper), add(double(a.count));
  add(double(options.search.goal)), add(double(robot.effort(options)));
  text += std::to_string(options.search.seed) + "\n";
  if (const auto& measure = options.robust.measure) {
    text += measure->name() + "\n";
    const Scatter scatter = robot.scatter(options.robust.scatter);
    for (const ScatterTerm& term : kScatterTerms) add(scatter.*term.deviation);
    add(options.robust.inflate), add(double(options.robust.samples)), add(options.robust.penalty);
  }
  return checksum(text);
}

void plan_atlas(const AtlasRobot& robot, const AtlasOptions& options, std::span<AtlasCell> cells) {
  constexpr long kFirst = 4;  // factor of the effort without warm starts
  options.validate(), robot.validate(options.grid);
  options.grid.check_cells(cells.size());
  const std::vector<std::size_t> blocks = options.shard.blocks(options.grid);
  const int dimension = int(robot.variables().size());
  const long effort = robot.effort(options);
  long open = 0, planned = 0;
  for (const std::size_t i : options.shard.drops(options.grid)) open += cells[i].state == AtlasCell::State::kOpen;
  std::mutex mutex;
  parallel_for(int(blocks.size()), options.search.threads, [&](int b) {
    std::vector<MotionValues> starts;
    for (const std::size_t i : options.grid.block(blocks[std::size_t(b)])) {
      if (cells[i].state == AtlasCell::State::kOpen) {
        const AtlasCell cell = robot.plan(options, {options.grid.drop(i), effort * (starts.empty() ? kFirst : 1),
                                                    Random(options.search.seed, i).bits(), starts});
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
