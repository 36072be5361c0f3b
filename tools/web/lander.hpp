// Common interface of the page to scenes of the paper's robot and of robots of links.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "landing/model/variables.hpp"
#include "tools/program/json.hpp"

namespace ukemi::tools {

/// A simulated landing.
struct Played {
  double peak;          ///< [m/s^2]
  std::string failure;  ///< why there is no landing; empty: there is one
  Json animation;
  std::vector<std::string> doubts;  ///< reasons to doubt the peak
};

class Lander {
 public:
  virtual ~Lander() = default;
  /// Keys of [drop] that apply to this robot's base.
  virtual std::vector<std::string> drop_keys() const = 0;
  /// Variables of a motion with their ranges; none where no joint is driven.
  virtual std::vector<landing::Variable> variables() const = 0;
  /// Their values in the held posture.
  virtual landing::MotionValues hold_values() const = 0;
  /// Arguments of `ukemi simulate` for the held posture.
  virtual std::string hold_arguments() const = 0;
  virtual std::string motion_toml(const landing::MotionValues& values) const = 0;
  virtual Played held() const = 0;
  /// Lands with the motion of a file.
  virtual Played play(const std::string& motion_file) const = 0;
  /// The softest motion found within `seconds` [s], with `start` among the starts; absent: none found.
  virtual std::optional<landing::MotionValues> plan(double seconds, const landing::MotionValues& start) const = 0;
};

/// Reads a scene file. `actuator`: drive file of the paper's robot, or of the one joint without a drive; empty: none.
/// Throws InputError.
std::unique_ptr<Lander> read_lander(const std::string& scene, const std::string& actuator);

}  // namespace ukemi::tools
