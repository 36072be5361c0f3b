// What lands on the page: a scene with the paper's robot or one of links, behind one face.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "landing/model/variables.hpp"
#include "tools/program/json.hpp"

namespace ukemi::tools {

/// A landing that was played.
struct Played {
  double peak;          ///< [m/s^2]
  std::string failure;  ///< why there is no landing; empty: there is one
  Json animation;
  std::vector<std::string> doubts;  ///< what a reader must know
};

class Lander {
 public:
  virtual ~Lander() = default;
  /// Keys of [drop] that this robot's base has.
  virtual std::vector<std::string> drop_keys() const = 0;
  /// The numbers of a motion, with their ranges; none where no joint is driven.
  virtual std::vector<landing::Variable> variables() const = 0;
  /// Those of the held posture.
  virtual landing::MotionValues holding() const = 0;
  /// The same as `ukemi simulate` takes it.
  virtual std::string hold_arguments() const = 0;
  virtual std::string motion_toml(const landing::MotionValues& values) const = 0;
  virtual Played held() const = 0;
  /// A landing of what a motion file says.
  virtual Played play(const std::string& motion_file) const = 0;
  /// The softest motion that is found in a time [s], searched from where the page stands, too.
  virtual std::optional<landing::MotionValues> plan(double seconds, const landing::MotionValues& start) const = 0;
};

/// Of a scene file; `actuator`: the drive of the paper's robot, of a robot of links that of the joint without one;
/// empty: none is given. Throws InputError.
std::unique_ptr<Lander> read_lander(const std::string& scene, const std::string& actuator);

}  // namespace ukemi::tools
