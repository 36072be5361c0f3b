// Tables of drops of a robot of links, one per row, as those of landing/scatter/drop_file.hpp.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "landing/plan/body_drops.hpp"

namespace ukemi::landing {

/// A number of a drop as a column of a table, in the unit of its name.
struct BodyDropColumn {
  std::string name;  ///< height, forward_speed, pitch_deg, pitch_rate_deg, slope_deg, delay; phi_off_JOINT_deg, ...;
                     ///< else one of design_names
  std::function<double(const BodyDrop&)> get;
  std::function<void(BodyDrop&, double)> set;
};
/// The columns in which a drop differs from the scene: enough to read the drops back.
std::vector<BodyDropColumn> scattered_columns(std::span<const BodyDrop> drops, const BodyScene& scene);

/// Reads drops. A number without a column is the scene's; columns of other names are ignored, but at least one must be
/// of these names. Throws InputError with file:line:column.
std::vector<BodyDrop> read_drops(const std::string& path, const BodyScene& scene);

}  // namespace ukemi::landing
