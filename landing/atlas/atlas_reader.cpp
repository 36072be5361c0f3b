#include "landing/atlas/atlas_reader.hpp"

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/model/release.hpp"
#include "landing/search/objective.hpp"

namespace ukemi::landing {

namespace {
constexpr std::size_t kCorners = Planner::kStarts;
}

/// The mapped file, and what plays its motions.
struct AtlasReader::Table {
  Table(const std::string& path, const Scene& s, const SeaParameters<double>& sea, const Options& o);
  bool around(const Drop& drop, std::array<std::size_t, kCorners>& corners) const;
  AtlasEntry best_of(std::span<const std::size_t> drops);

  MappedAtlas file;
  Scene scene;
  ReferenceSpace space;
  Options options;
  Objective objective;
};

AtlasReader::Table::Table(const std::string& path, const Scene& s, const SeaParameters<double>& sea, const Options& o)
    : file(path),
      scene(s),
      space(s, sea),
      options(o),
      objective(scene, space, {.goal = o.goal, .accuracy = o.accuracy, .limits = o.limits}) {
  if (o.goal == Goal::kRobust) throw InputError("atlas: the goal of its reader is the peak or the tolerant peak");
  if (!(o.deadline > 0)) throw InputError("deadline: " + shortest(o.deadline) + ": above 0 s is needed");
  const AtlasHeader& h = file.header();
  bool same = h.variables == std::size_t(space.dimension());
  for (std::size_t k = 0; same && k < h.variables; ++k) same = space.variables()[k].name == h.variable[k].name;
  if (!same) throw InputError({path}, "its motions have other variables than those of the scene");
  if (robot_checksum(s, sea) != std::string_view(h.robot, sizeof h.robot))
    throw InputError({path}, "it was planned for another robot, floor or actuator than these");
  const auto cells = file.cells();
  if (std::any_of(cells.begin(), cells.end(), [](auto& c) { return c.state == AtlasCell::State::kOpen; }))
    throw InputError({path}, "drops of it are not planned: a shard is merged with the others first");
}

/// The drops of the grid's cell that holds this one; false where none does.
bool AtlasReader::Table::around(const Drop& d, std::array<std::size_t, kCorners>& corners) const {
  const double g = scene.robot.gravity, v = d.vertical_speed;
  const double height = d.height + (v != 0 && g > 0 ? v * v / (2 * g) : 0);
  const double fall = d.pitch_rate != 0 ? fall_time(scene) : 0;
  const std::array<double, AtlasGrid::kAxes> x = {height, d.forward_speed,
                                                  d.pitch + (std::isfinite(fall) ? fall * d.pitch_rate : 0)};
  const AtlasGrid& grid = file.header().grid;
  AtlasGrid::Place low{};
  for (std::size_t k = 0; k < x.size(); ++k) {
    const AtlasAxis& a = grid.axes[k];
    if (!a.holds(x[k])) return false;
    const double step = (a.upper - a.lower) / double(a.count - 1);
    low[k] = std::min(std::size_t((x[k] - a.lower) / step), std::size_t(a.count - 2));
  }
  for (std::size_t c = 0; c < kCorners; ++c)
    corners[c] = grid.index({low[0] + (c >> 2 & 1), low[1] + (c >> 1 & 1), low[2] + (c & 1)});
  return true;
}

/// All by their peaks first; then, where the goal asks for more, one after the other, the best first.
AtlasEntry AtlasReader::Table::best_of(std::span<const std::size_t> drops) {
  std::array<Candidate, kCorners> points;
  std::array<std::size_t, kCorners> order{};
  std::size_t n = 0;
  for (const std::size_t i : drops) {
    if (!file.cells()[i].planned()) continue;
    points[n].u = space.unit(file.cells()[i].coordinates(space.dimension()));
    order[n++] = i;
  }
  if (n == 0) return {};
  objective.evaluate(std::span(points).first(n), Goal::kPeak);
  std::array<std::size_t, kCorners> by{};
  for (std::size_t k = 0; k < n; ++k) by[k] = k;
  std::sort(by.begin(), by.begin() + long(n), [&](auto a, auto b) { return points[a].value < points[b].value; });
  std::size_t best = by[0];
  if (options.goal == Goal::kTolerant) {
    double bound = kNoMotion;
    for (std::size_t k = 0; k < n; ++k) {
      Candidate& p = points[by[k]];
      if (p.value >= bound) continue;  // its peak alone is worse
      p.bound = bound;
      objective.evaluate({&p, 1}, Goal::kTolerant);
      if (p.value < bound) bound = p.value, best = by[k];
    }
    points[best].value = bound;
  }
  const Play play = objective.play(points[best]);
  AtlasEntry out{.motion = play.motion, .sea = play.sea, .values = space.values(points[best].u)};
  out.value = points[best].value, out.drop = order[best], out.inside = out.found = true;
  out.around[out.count++] = out.values;
  for (std::size_t k = 0; k < n; ++k)
    if (by[k] != best) out.around[out.count++] = space.values(points[by[k]].u);
  return out;
}

AtlasReader::AtlasReader(const std::string& path, const Scene& scene, const SeaParameters<double>& sea,
                         const Options& options)
    : table_(std::make_unique<Table>(path, scene, sea, options)) {}
AtlasReader::~AtlasReader() = default;

const AtlasHeader& AtlasReader::header() const { return table_->file.header(); }

AtlasEntry AtlasReader::at(const Drop& drop) {
  Table& t = *table_;
  t.scene.drop = drop;
  if (t.scene.release) t.space.release(t.scene);
  t.objective.watch.restart();
  t.objective.deadline = t.options.deadline;
  std::array<std::size_t, kCorners> corners{};
  if (t.around(drop, corners))
    if (const AtlasEntry entry = t.best_of(corners); entry.found) return entry;
  const std::size_t safest = header().safest.drop;
  if (safest == SafestMotion::kNoDrop) return {};
  AtlasEntry entry = t.best_of({&safest, 1});
  entry.inside = false;
  return entry;
}

}  // namespace ukemi::landing
