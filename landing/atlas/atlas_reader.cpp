#include "landing/atlas/atlas_reader.hpp"

#include "landing/atlas/atlas_table.hpp"
#include "landing/atlas/two_link_atlas.hpp"
#include "landing/model/release.hpp"
#include "landing/search/two_link_objective.hpp"

namespace ukemi::landing {

/// The mapped file, and what plays its motions.
struct AtlasReader::Table {
  Table(const std::string& path, const Scene& s, const SeaParameters<double>& sea, const Options& o)
      : scene(s),
        space(s, sea),
        options(o),
        atlas(path, o.goal, o.deadline, space.variables(), robot_checksum(s, sea)),
        objective(scene, space, {.goal = o.goal, .accuracy = o.accuracy, .limits = o.limits}) {}
  AtlasEntry best_of(std::span<const std::size_t> drops);

  Scene scene;
  ReferenceSpace space;
  Options options;
  AtlasTable atlas;
  TwoLinkObjective objective;
};

AtlasEntry AtlasReader::Table::best_of(std::span<const std::size_t> drops) {
  const Coordinates hold = space.place(*space.holding(held_angle(scene)));
  const AtlasTable::Ranking found = atlas.best_of(
      drops, hold, options.goal, [&](const Coordinates& values) { return space.unit(values); },
      [&](std::span<Candidate> points, Goal goal) { objective.evaluate(points, goal); });
  if (found.count == 0) return {};
  const DrivenMotion play = objective.play(found.points[0]);
  AtlasEntry out{.motion = play.motion, .sea = play.sea, .values = space.values(found.points[0].u)};
  out.value = found.points[0].value, out.drop = found.drop[0], out.holds = found.holds(0);
  out.inside = out.found = true;
  for (std::size_t k = 0; k < found.count; ++k)
    if (!found.holds(k)) out.around[out.count++] = space.values(found.points[k].u);
  return out;
}

AtlasReader::AtlasReader(const std::string& path, const Scene& scene, const SeaParameters<double>& sea,
                         const Options& options)
    : table_(std::make_unique<Table>(path, scene, sea, options)) {}
AtlasReader::~AtlasReader() = default;

AtlasEntry AtlasReader::at(const Drop& drop) {
  Table& t = *table_;
  t.scene.drop = drop;
  if (t.scene.release) t.space.release(t.scene);
  t.objective.watch.restart();
  t.objective.deadline = t.options.deadline;
  const double fall = drop.pitch_rate != 0 ? fall_time(t.scene) : 0;
  const AtlasTable::Drops around = t.atlas.around(drop, t.scene.robot.gravity, fall);
  if (const AtlasEntry entry = t.best_of(around.span()); entry.found) return entry;
  AtlasEntry entry = t.best_of(t.atlas.safest().span());
  entry.inside = false;
  return entry;
}

}  // namespace ukemi::landing
