// Readers of tables that files of scenes and motions share with those of robots of links.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "common/toml.hpp"
#include "landing/model/constants.hpp"
#include "landing/model/files.hpp"

namespace ukemi::landing {

/// Reads the variables besides the paper's three from [motion]: bumps, bump_deg, landing_gains. Throws InputError.
Freedom read_freedom(TomlSection& motion);

/// An invalid key of a scene's [release].
struct ReleaseFault {
  std::string key, message;
};
/// The fault of a release outside the joint's stops, or of a move that would begin after the first touchdown, if any.
std::optional<ReleaseFault> release_fault(const Scene& scene);

/// [robot] in the short form: the paper's robot, and which points may touch.
struct TwoLinkTable {
  TwoLink<double> robot;
  std::array<bool, kPoints> contacts{};
};
TwoLinkTable read_two_link(TomlSection& robot);

/// Reads a motion from [motion] and, if present, [reposition].
Motion read_motion(TomlSection& motion, std::optional<TomlSection> reposition);

/// The text of a motion's tables; with a joint's name [motion.JOINT] and [reposition.JOINT].
std::string motion_tables(const Motion& motion, const std::string& joint = "");

}  // namespace ukemi::landing
