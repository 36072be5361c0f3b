#include "landing/scatter/drop_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/actuator_constants.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"
#include "landing/scatter/moved.hpp"

namespace ukemi::landing {

namespace {

using N = DropNumbers;
const std::vector<DropColumn>& columns() {
  static const std::vector<DropColumn> list = [] {
    const Range any = Range::any(), non_negative = Range::non_negative();
    std::vector<DropColumn> out = {
        {"height", 1, &N::height, non_negative},
        {"forward_speed", 1, &N::forward_speed, any},
        {"pitch_deg", kDegree, &N::pitch, any},
        {"pitch_rate_deg", kDegree, &N::pitch_rate, any},
        {"stiffness", 1, &N::stiffness, Range::positive()},
        {"damping_normal", 1, &N::damping_normal, non_negative},
        {"damping_tangential", 1, &N::damping_tangential, non_negative},
        {"delay", 1, &N::delay, non_negative},
        {"phi_off_deg", kDegree, &N::phi_off, any},
        {"rate_off_deg", kDegree, &N::rate_off, any},
    };
    for (const ActuatorConstant& c : actuator_constants()) out.push_back({c.key, 1, nullptr, c.range, c.at});
    for (const DropColumn& c : std::initializer_list<DropColumn>{{"phi_i_off_deg", kDegree, &N::phi_i_off, any},
                                                                 {"phi_f_off_deg", kDegree, &N::phi_f_off, any},
                                                                 {"duration_off", 1, &N::duration_off, any}})
      out.push_back(c);
    return out;
  }();
  return list;
}

/// The drop of these numbers: the inverse of `numbers`.
ScatteredDrop drop_of(const DropNumbers& n, const Scene& scene, const SeaParameters<double>& sea) {
  ScatteredDrop out{.scene = scene, .phi = n.phi_off, .rate = n.rate_off};
  out.scene.uncertainty.reset(), out.scene.verdicts.clear();  // of the planned floor
  Drop& drop = out.scene.drop;
  drop.height = n.height, drop.forward_speed = n.forward_speed, drop.pitch = n.pitch, drop.pitch_rate = n.pitch_rate;
  if (auto& floor = out.scene.floor) *floor = {n.stiffness, n.damping_normal, n.damping_tangential};
  out.scene.detection_delay = n.delay;
  for (std::size_t k = 0; k < actuator_constants().size(); ++k)
    if (const auto at = actuator_constants()[k].at; n.sea.*at != sea.*at) out.constants[k] = n.sea.*at - sea.*at;
  out.scene.execution = {1, 1};  // so that deviations are in rad and s, also beyond the scene's tolerance
  out.deviation = {n.phi_i_off, n.phi_f_off, n.duration_off};
  return out;
}

/// Throws InputError for an unread column whose name is a known one misspelt or without its unit: the scene's number
/// would silently be used. Short names are not compared.
void refuse_near_misses(const CsvTable& table, const std::vector<std::string>& known) {
  constexpr std::size_t kShort = 4;
  std::vector<std::string> missing;
  for (const std::string& name : known)
    if (table.find(name) < 0 && name.size() > kShort) missing.push_back(name);
  const auto other = [&](const std::string& column) {
    return column.size() <= kShort || std::find(known.begin(), known.end(), column) != known.end();
  };
  for (const auto& [c, similar] : table.near_misses(other, missing)) table.refuse_unread(c, similar);
}

}  // namespace

DropNumbers numbers(const ScatteredDrop& d, const SeaParameters<double>& sea) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const Scene& s = d.scene;
  const Floor<double> floor = s.floor.value_or(Floor<double>{kNaN, kNaN, kNaN});
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
          .phi_i_off = d.deviation.phi_i * s.execution.phi,
          .phi_f_off = d.deviation.phi_f * s.execution.phi,
          .duration_off = d.deviation.duration * s.execution.duration,
          .sea = moved(sea, d.constants)};
}

std::vector<DropColumn> scattered_columns(std::span<const ScatteredDrop> drops, const Scene& scene,
                                          const SeaParameters<double>& sea) {
  const DropNumbers planned = numbers({.scene = scene}, sea);
  std::vector<DropNumbers> all;
  for (const ScatteredDrop& d : drops) all.push_back(numbers(d, sea));
  std::vector<DropColumn> out;
  for (const DropColumn& c : columns()) {
    const double own = c.of(planned);
    if (!std::isnan(own) && std::any_of(all.begin(), all.end(), [&](auto& n) { return c.of(n) != own; }))
      out.push_back(c);
  }
  return out;
}

void read_drop_rows(const std::string& path, const std::vector<ReadColumn>& columns,
                    const std::function<void(std::size_t rows)>& begin) {
  std::vector<std::string> known;
  for (const ReadColumn& c : columns) known.push_back(c.name);
  const CsvTable table = read_csv(
      path, [&](const std::string& name) { return std::find(known.begin(), known.end(), name) != known.end(); });
  refuse_near_misses(table, known);
  begin(table.rows());
  bool any = false;
  for (const ReadColumn& c : columns) {
    const int column = table.find(c.name);
    if (column < 0) continue;
    any = true;
    table.require_full(column);
    if (!c.absent.empty())
      throw InputError({path, table.header_line, table.header_column[std::size_t(column)]},
                       fmt::format("{}: {}", quoted(c.name), c.absent));
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const double x = table.columns[std::size_t(column)][row];
      try {
        c.set(row, x);
      } catch (const InputError& e) {
        throw InputError(table.at(column, row), fmt::format("{}: {}: {}", quoted(c.name), shortest(x), e.what()));
      }
    }
  }
  if (!any) throw InputError({path, table.header_line}, "no column of a drop: " + one_of(table.header.front(), known));
}

std::vector<ScatteredDrop> read_drops(const std::string& path, const Scene& scene, const SeaParameters<double>& sea) {
  const DropNumbers planned = numbers({.scene = scene}, sea);
  std::vector<DropNumbers> rows;
  std::vector<ReadColumn> read;
  for (const DropColumn& c : columns()) {
    const std::string absent = std::isfinite(c.of(planned)) ? ""
                               : c.constant                 ? "the actuator has none"
                                                            : "the scene has no [floor]";
    read.push_back({c.name, absent, [&rows, &c](std::size_t row, double x) {
                      if (!c.range.holds(x)) throw InputError("must be " + c.range.rule);
                      c.of(rows[row]) = x * c.unit;
                    }});
  }
  read_drop_rows(path, read, [&](std::size_t n) { rows.assign(n, planned); });
  std::vector<ScatteredDrop> out;
  for (const DropNumbers& n : rows) out.push_back(drop_of(n, scene, sea));
  return out;
}

}  // namespace ukemi::landing
