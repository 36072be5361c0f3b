// Tables of drops, one per row: measured ones, or the worst of those that were drawn.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/toml.hpp"
#include "landing/scatter/drop_model.hpp"

namespace ukemi::landing {

/// Every number of a drop that may scatter, in SI units. The floor's are NaN where the scene has none.
struct DropNumbers {
  double height, forward_speed, pitch, pitch_rate;
  double stiffness, damping_normal, damping_tangential;  ///< of the floor
  double delay;                                          ///< of the touchdown's detection
  double phi_off, rate_off;                              ///< of the joint at release, minus the planned
  double phi_i_off, phi_f_off, duration_off;             ///< of the motion, minus the planned
  SeaParameters<double> sea;                             ///< the actuator's constants
};
DropNumbers numbers(const ScatteredDrop& drop, const SeaParameters<double>& sea);

/// A number of a drop as a column of a table.
struct DropColumn {
  const char* name;
  double unit;  ///< of the column, in SI: a degree or 1
  double DropNumbers::*number;
  Range range;
  double SeaParameters<double>::*constant = nullptr;  ///< used instead of `number` if set

  const double& of(const DropNumbers& n) const { return constant ? n.sea.*constant : n.*number; }
  double& of(DropNumbers& n) const { return constant ? n.sea.*constant : n.*number; }
};
/// The columns in which a drop differs from the scene and the actuator: enough to read the drops back.
std::vector<DropColumn> scattered_columns(std::span<const ScatteredDrop> drops, const Scene& scene,
                                          const SeaParameters<double>& sea);

/// A column that a table of drops may have.
struct ReadColumn {
  std::string name;
  std::string absent;                                  ///< why the scene has no such number; empty: it has one
  std::function<void(std::size_t row, double x)> set;  ///< throws InputError "..." for a value that is not allowed
};
/// Calls `begin` with the number of rows, then the setters of the columns in their order. Columns of other names are
/// ignored, but at least one must be of these names. Throws InputError with file:line:column.
void read_drop_rows(const std::string& path, const std::vector<ReadColumn>& columns,
                    const std::function<void(std::size_t rows)>& begin);

/// Reads drops. A number without a column is the scene's or the actuator's; columns of other names are ignored, but at
/// least one must be of these names. Throws InputError with file:line:column.
std::vector<ScatteredDrop> read_drops(const std::string& path, const Scene& scene, const SeaParameters<double>& sea);

}  // namespace ukemi::landing
