#include "landing/scatter/drop_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

namespace {

using N = DropNumbers;
constexpr std::array<DropColumn, 18> kColumns = {{
    {"height", 1, &N::height, Range::non_negative},
    {"forward_speed", 1, &N::forward_speed, Range::any},
    {"pitch_deg", kDegree, &N::pitch, Range::any},
    {"pitch_rate_deg", kDegree, &N::pitch_rate, Range::any},
    {"stiffness", 1, &N::stiffness, Range::positive},
    {"damping_normal", 1, &N::damping_normal, Range::non_negative},
    {"damping_tangential", 1, &N::damping_tangential, Range::non_negative},
    {"delay", 1, &N::delay, Range::non_negative},
    {"phi_off_deg", kDegree, &N::phi_off, Range::any},
    {"rate_off_deg", kDegree, &N::rate_off, Range::any},
    {"k_p", 1, &N::k_p, Range::non_negative},
    {"k_d", 1, &N::k_d, Range::non_negative},
    {"k_sea", 1, &N::k_sea, Range::non_negative},
    {"c_sea", 1, &N::c_sea, Range::non_negative},
    {"i_motor", 1, &N::i_motor, Range::positive},
    {"phi_i_off_deg", kDegree, &N::phi_i_off, Range::any},
    {"phi_f_off_deg", kDegree, &N::phi_f_off, Range::any},
    {"duration_off", 1, &N::duration_off, Range::any},
}};

/// The other way of `numbers`.
ScatteredDrop drop_of(const DropNumbers& n, const Scene& scene, const SeaParameters<double>& sea) {
  ScatteredDrop out{.scene = scene, .phi = n.phi_off, .rate = n.rate_off};
  out.scene.uncertainty.reset(), out.scene.verdicts.clear();  // of the planned floor
  Drop& drop = out.scene.drop;
  drop.height = n.height, drop.forward_speed = n.forward_speed, drop.pitch = n.pitch, drop.pitch_rate = n.pitch_rate;
  if (auto& floor = out.scene.floor) *floor = {n.stiffness, n.damping_normal, n.damping_tangential};
  out.scene.detection_delay = n.delay;
  const std::array<double, kConstants> own = constants(sea), given = {n.k_p, n.k_d, n.k_sea, n.c_sea, n.i_motor};
  for (std::size_t k = 0; k < own.size(); ++k) out.constants[k] = given[k] - own[k];
  out.scene.execution = {1, 1};  // so that what was missed stands in rad and s, also beyond the scene's tolerance
  out.deviation = {n.phi_i_off, n.phi_f_off, n.duration_off};
  return out;
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const DropColumn& c : kColumns) out.push_back(c.name);
  return out;
}

}  // namespace

DropNumbers numbers(const ScatteredDrop& d, const SeaParameters<double>& sea) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const Scene& s = d.scene;
  const Floor<double> floor = s.floor.value_or(Floor<double>{kNaN, kNaN, kNaN});
  std::array<double, kConstants> u = constants(sea);
  for (std::size_t k = 0; k < u.size(); ++k) u[k] = std::max(0.0, u[k] + d.constants[k]);
  return {.height = s.drop.height,
          .forward_speed = s.drop.forward_speed,
          .pitch = s.drop.pitch,
          .pitch_rate = s.drop.pitch_rate,
          .stiffness = floor.stiffness,
          .damping_normal = floor.damping_normal,
          .damping_tangential = floor.damping_tangential,
          .delay = s.detection_delay,
          .phi_off = d.phi,
          .rate_off = d.rate,
          .k_p = u[0],
          .k_d = u[1],
          .k_sea = u[2],
          .c_sea = u[3],
          .i_motor = u[4],
          .phi_i_off = d.deviation.phi_i * s.execution.phi,
          .phi_f_off = d.deviation.phi_f * s.execution.phi,
          .duration_off = d.deviation.duration * s.execution.duration};
}

std::vector<DropColumn> scattered_columns(std::span<const ScatteredDrop> drops, const Scene& scene,
                                          const SeaParameters<double>& sea) {
  const DropNumbers planned = numbers({.scene = scene}, sea);
  std::vector<DropNumbers> all;
  for (const ScatteredDrop& d : drops) all.push_back(numbers(d, sea));
  std::vector<DropColumn> out;
  for (const DropColumn& c : kColumns) {
    const double own = planned.*c.number;
    if (!std::isnan(own) && std::any_of(all.begin(), all.end(), [&](auto& n) { return n.*c.number != own; }))
      out.push_back(c);
  }
  return out;
}

std::vector<ScatteredDrop> read_drops(const std::string& path, const Scene& scene, const SeaParameters<double>& sea) {
  const std::vector<std::string> known = names();
  const CsvTable table = read_csv(
      path, [&](const std::string& name) { return std::find(known.begin(), known.end(), name) != known.end(); });
  std::vector<DropNumbers> rows(table.rows(), numbers({.scene = scene}, sea));
  bool any = false;
  for (const DropColumn& c : kColumns) {
    const int column = table.find(c.name);
    if (column < 0) continue;
    any = true;
    table.require_full(column);
    if (std::isnan(rows[0].*c.number))
      throw InputError({path, table.header_line, table.header_column[std::size_t(column)]},
                       fmt::format("{}: the scene has no [floor]", quoted(c.name)));
    const Range range = c.range();
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const double x = table.columns[std::size_t(column)][row];
      if (!range.holds(x))
        throw InputError(table.at(column, row),
                         fmt::format("{}: {}: must be {}", quoted(c.name), shortest(x), range.rule));
      rows[row].*c.number = x * c.unit;
    }
  }
  if (!any) throw InputError({path, table.header_line}, "no column of a drop: " + one_of(table.header.front(), known));
  std::vector<ScatteredDrop> out;
  for (const DropNumbers& n : rows) out.push_back(drop_of(n, scene, sea));
  return out;
}

}  // namespace ukemi::landing
