#include "landing/atlas/atlas_table.hpp"

#include "common/csv.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

AtlasTable::AtlasTable(const std::string& path, Goal goal, double deadline, const std::vector<Variable>& variables,
                       const std::string& robot)
    : file_(path) {
  if (goal == Goal::kRobust) throw InputError("atlas: the goal of its reader is the peak or the tolerant peak");
  if (!(deadline > 0)) throw InputError("deadline: " + shortest(deadline) + ": above 0 s is needed");
  const AtlasHeader& h = file_.header();
  bool same = h.variables == variables.size();
  for (std::size_t k = 0; same && k < h.variables; ++k) same = h.variable[k].is(variables[k]);
  if (!same) throw InputError({path}, "its motions have other variables than those of the scene");
  if (robot != std::string_view(h.robot, sizeof h.robot))
    throw InputError({path}, "it was planned for another robot, floor or actuator than these");
  const auto cells = file_.cells();
  if (std::any_of(cells.begin(), cells.end(), [](auto& c) { return c.state == AtlasCell::State::kOpen; }))
    throw InputError({path}, "drops of it are not planned: a shard is merged with the others first");
}

AtlasTable::Drops AtlasTable::around(const Drop& d, double g, double fall) const {
  const double v = d.vertical_speed;
  const std::array<double, AtlasGrid::kAxes> x = {d.height + (v != 0 && g > 0 ? v * v / (2 * g) : 0), d.forward_speed,
                                                  d.pitch + (std::isfinite(fall) ? fall * d.pitch_rate : 0)};
  const AtlasGrid& grid = header().grid;
  AtlasGrid::Place low{};
  for (std::size_t k = 0; k < x.size(); ++k) {
    const AtlasAxis& a = grid.axes[k];
    if (!a.contains(x[k])) return {};
    if (a.stands()) continue;
    const double step = (a.upper - a.lower) / double(a.count - 1);
    low[k] = std::min(std::size_t((x[k] - a.lower) / step), std::size_t(a.count - 2));
  }
  Drops out;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const AtlasGrid::Place up{c >> 2 & 1, c >> 1 & 1, c & 1};
    bool exists = true;
    for (std::size_t k = 0; k < up.size(); ++k) exists = exists && !(up[k] == 1 && grid.axes[k].stands());
    if (exists) out.index[out.count++] = grid.index({low[0] + up[0], low[1] + up[1], low[2] + up[2]});
  }
  return out;
}

AtlasTable::Drops AtlasTable::safest() const {
  const std::uint64_t drop = header().safest.drop;
  return drop == SafestMotion::kNoDrop ? Drops{} : Drops{{drop}, 1};
}

void AtlasTable::sort(Ranking& f) {
  std::array<std::size_t, kCorners + 1> order{};
  for (std::size_t k = 0; k < f.count; ++k) order[k] = k;
  std::sort(order.begin(), order.begin() + long(f.count),
            [&](auto a, auto b) { return f.points[a].value < f.points[b].value; });
  const Ranking before = f;
  for (std::size_t k = 0; k < f.count; ++k) f.points[k] = before.points[order[k]], f.drop[k] = before.drop[order[k]];
}

}  // namespace ukemi::landing
