// Drops as a table, a row a drop: as they were measured, or the worst of those that were drawn.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/toml.hpp"
#include "landing/scatter/drop_model.hpp"

namespace ukemi::landing {

/// Every number of a drop that may scatter, SI. NaN where the scene has no floor.
struct DropNumbers {
  double height, forward_speed, pitch, pitch_rate;
  double stiffness, damping_normal, damping_tangential;  ///< of the floor
  double delay;                                          ///< of the touchdown's detection
  double phi_off, rate_off;                              ///< of the joint at release, less the planned
  double phi_i_off, phi_f_off, duration_off;             ///< of the motion, less the planned
  SeaParameters<double> sea;                             ///< the actuator's constants
};
DropNumbers numbers(const ScatteredDrop& drop, const SeaParameters<double>& sea);

/// A number of a drop as a column of a table.
struct DropColumn {
  const char* name;
  double unit;  ///< of the column, in SI: a degree or 1
  double DropNumbers::*number;
  Range range;
  double SeaParameters<double>::*constant = nullptr;  ///< instead of `number`

  const double& of(const DropNumbers& n) const { return constant ? n.sea.*constant : n.*number; }
  double& of(DropNumbers& n) const { return constant ? n.sea.*constant : n.*number; }
};
/// Those in which a drop differs from what the scene and the actuator say: with them the drops read back.
std::vector<DropColumn> scattered_columns(std::span<const ScatteredDrop> drops, const Scene& scene,
                                          const SeaParameters<double>& sea);

/// Reads drops. A column that is absent is the scene's own or the actuator's; columns by other names may hold anything,
/// but one of ours must be there. Throws InputError with file:line:column.
std::vector<ScatteredDrop> read_drops(const std::string& path, const Scene& scene, const SeaParameters<double>& sea);

}  // namespace ukemi::landing
