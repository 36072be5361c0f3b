#include "landing/atlas/atlas_reader.hpp"

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/model/release.hpp"

namespace ukemi::landing {

AtlasReader::AtlasReader(const std::string& path, const Scene& scene, const SeaParameters<double>& sea,
                         const Options& options)
    : file_(path),
      scene_(scene),
      space_(std::make_unique<ReferenceSpace>(scene, sea)),
      options_(options),
      objective_(scene_, *space_, {.goal = options.goal, .accuracy = options.accuracy, .limits = options.limits}) {
  if (options.goal == Goal::kRobust) throw InputError("atlas: the goal of its reader is the peak or the tolerant peak");
  if (!(options.deadline > 0)) throw InputError("deadline: " + shortest(options.deadline) + ": above 0 s is needed");
  const AtlasHeader& h = header();
  bool same = h.variables == std::size_t(space_->dimension());
  for (std::size_t k = 0; same && k < h.variables; ++k) same = space_->variables()[k].name == h.variable[k].name;
  if (!same) throw InputError({path}, "its motions have other variables than those of the scene");
  if (robot_checksum(scene, sea) != std::string_view(h.robot, sizeof h.robot))
    throw InputError({path}, "it was planned for another robot, floor or actuator than these");
  const auto cells = file_.cells();
  if (std::any_of(cells.begin(), cells.end(), [](auto& c) { return c.state == AtlasCell::State::kOpen; }))
    throw InputError({path}, "drops of it are not planned: a shard is merged with the others first");
}

/// The drops of the grid's cell that holds this one; false where none does.
bool AtlasReader::around(const Drop& d, std::array<std::size_t, kCorners>& corners) const {
  const double g = scene_.robot.gravity, v = d.vertical_speed;
  const double height = d.height + (v != 0 && g > 0 ? v * v / (2 * g) : 0);
  const double fall = d.pitch_rate != 0 ? fall_time(scene_) : 0;
  const std::array<double, AtlasGrid::kAxes> x = {height, d.forward_speed,
                                                  d.pitch + (std::isfinite(fall) ? fall * d.pitch_rate : 0)};
  const AtlasGrid& grid = header().grid;
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
AtlasEntry AtlasReader::best_of(std::span<const std::size_t> drops) {
  std::array<Candidate, kCorners> points;
  std::array<std::size_t, kCorners> order{};
  std::size_t n = 0;
  for (const std::size_t i : drops) {
    if (!file_.cells()[i].planned()) continue;
    points[n].u = space_->unit(file_.cells()[i].coordinates(space_->dimension()));
    order[n++] = i;
  }
  if (n == 0) return {};
  objective_.evaluate(std::span(points).first(n), Goal::kPeak);
  std::array<std::size_t, kCorners> by{};
  for (std::size_t k = 0; k < n; ++k) by[k] = k;
  std::sort(by.begin(), by.begin() + long(n), [&](auto a, auto b) { return points[a].value < points[b].value; });
  std::size_t best = by[0];
  if (options_.goal == Goal::kTolerant) {
    double bound = kNoMotion;
    for (std::size_t k = 0; k < n; ++k) {
      Candidate& p = points[by[k]];
      if (p.value >= bound) continue;  // its peak alone is worse
      p.bound = bound;
      objective_.evaluate({&p, 1}, Goal::kTolerant);
      if (p.value < bound) bound = p.value, best = by[k];
    }
    points[best].value = bound;
  }
  const Play play = objective_.play(points[best]);
  AtlasEntry out{.motion = play.motion, .sea = play.sea, .values = space_->values(points[best].u)};
  out.value = points[best].value, out.drop = order[best], out.inside = out.found = true;
  out.around[out.count++] = out.values;
  for (std::size_t k = 0; k < n; ++k)
    if (by[k] != best) out.around[out.count++] = space_->values(points[by[k]].u);
  return out;
}

AtlasEntry AtlasReader::at(const Drop& drop) {
  scene_.drop = drop;
  if (scene_.release) space_->release(scene_);
  objective_.watch.restart();
  objective_.deadline = options_.deadline;
  std::array<std::size_t, kCorners> corners{};
  if (around(drop, corners))
    if (const AtlasEntry entry = best_of(corners); entry.found) return entry;
  const std::size_t safest = header().safest.drop;
  if (safest == SafestMotion::kNoDrop) return {};
  AtlasEntry entry = best_of({&safest, 1});
  entry.inside = false;
  return entry;
}

}  // namespace ukemi::landing
