// Tables of scenes and motions, as their files and those of robots of links hold them.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "common/toml.hpp"
#include "landing/model/constants.hpp"
#include "landing/model/files.hpp"

namespace ukemi::landing {

/// What motions may have besides the paper's three numbers, of [motion]: bumps, bump_deg, landing_gains. Throws
/// InputError.
Freedom read_freedom(TomlSection& motion);

/// A fault of a scene's release.
struct ReleaseFault {
  std::string key, message;
};
/// A release outside of the joint's stops, or a move that would begin after the first touchdown; else nothing.
std::optional<ReleaseFault> release_fault(const Scene& scene);

/// [robot] in the short form: the paper's two links, and which points may touch.
struct TwoLinkTable {
  TwoLink<double> robot;
  std::array<bool, kPoints> contacts{};
};
TwoLinkTable read_two_link(TomlSection& robot);

/// A motion from its tables, of which the second may be absent.
Motion read_motion(TomlSection& motion, std::optional<TomlSection> reposition);

/// A motion's tables alone; of one of several joints, with its name: [motion.JOINT].
std::string motion_tables(const Motion& motion, const std::string& joint = "");

}  // namespace ukemi::landing
