// Scenes and motions as files.
#pragma once

#include <optional>
#include <string>

#include "common/toml.hpp"
#include "landing/model/motion.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// Reads scene.toml: [robot] and [drop] are required, [floor], [search], [execution], [run], [motion],
/// [release], [joint], [detection], [uncertainty], [verdict], [scatter] optional; an absent table or key is an absent
/// term. Throws InputError with file:line:column.
Scene read_scene(const std::string& path);

/// What motions may have beside the paper's three numbers, of [motion]: bumps, bump_deg, landing_gains. Throws
/// InputError.
Freedom read_freedom(TomlSection& motion);

/// What is wrong with a scene's release.
struct ReleaseFault {
  std::string key, message;
};
/// A release outside of the joint's stops, or a move that would begin after the first touchdown; else nothing.
std::optional<ReleaseFault> release_fault(const Scene& scene);

/// The text of a scene.toml that `read_scene` reads back; `comments` goes in front, each line behind "# ".
std::string to_toml(const Scene& scene, const std::string& comments);

/// Reads motion.toml: [motion] phi_i_deg, phi_f_deg (or phi_i, phi_f in rad), duration; optional bumps_deg, gain_p,
/// gain_d, and [reposition] phi_deg, rate_deg, from, to. A path that ends in .csv: see landing/model/motion_csv.hpp.
Motion read_motion(const std::string& path);
/// The same from its tables, of which the second may be absent.
Motion read_motion(TomlSection& motion, std::optional<TomlSection> reposition);

/// The text of a motion.toml; `comments` goes in front, each line behind "# ".
std::string to_toml(const Motion& motion, const std::string& comments);
/// Its tables alone; of one of several joints, whose name stands in theirs: [motion.JOINT].
std::string motion_tables(const Motion& motion, const std::string& joint = "");

}  // namespace ukemi::landing
