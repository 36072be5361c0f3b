// A robot in space, as its description gives it: bodies in a tree, before a plane is chosen. The readers of URDF and of
// MJCF end here, the projection begins here.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

namespace ukemi::tools {

/// What a body weighs, in one frame.
struct SpatialInertia {
  double mass = 0;                                   ///< [kg], >= 0
  Eigen::Vector3d com = Eigen::Vector3d::Zero();     ///< centre of mass [m]
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();  ///< about the centre of mass [kg m^2], symmetric
};
/// The same body seen from another frame: `frame` is the old one's pose in it; the tensor turns as R I R^T.
SpatialInertia in_frame(const SpatialInertia& inertia, const Eigen::Isometry3d& frame);
/// Two bodies that are one, in their common frame: masses add, each tensor is moved to the common centre of mass by
/// Steiner's theorem, I + m (d.d 1 - d d^T).
SpatialInertia merged(const SpatialInertia& a, const SpatialInertia& b);

/// How a body moves against its parent. Every angle and length is counted from the posture of the poses.
struct SpatialJoint {
  enum class Motion { kFixed, kTurns, kFloats, kOther };  ///< kOther: slides, turns about more than one axis
  std::string name;
  std::string type = "fixed";                        ///< in the file's words: "revolute", "hinge"
  Motion motion = Motion::kFixed;                    ///< kTurns: about `axis` through `anchor`, in the child's frame
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< of length 1
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<double> lower, upper;                ///< of the angle [rad]
  std::optional<double> effort, speed;               ///< what its motor gives at most [Nm], [rad/s]; > 0
  double damping = 0, friction = 0, armature = 0;    ///< [Nm/(rad/s)], [Nm], [kg m^2]; >= 0
  double stiffness = 0, rest = 0;                    ///< of a spring in the joint [Nm/rad], >= 0; [rad]
  double zero = 0;                                   ///< what its description calls the angle of the poses [rad]
  std::string follows;                               ///< what its angle is bound to; empty: to nothing
};

struct SpatialBody {
  std::string name;
  int parent = -1;                                              ///< index of an earlier body; -1: the root
  Eigen::Isometry3d in_parent = Eigen::Isometry3d::Identity();  ///< the posture in which every joint is at 0
  SpatialInertia inertia;                                       ///< in the body's frame
  SpatialJoint joint;                                           ///< with the parent
};

/// A point with a name, which may become a contact.
struct SpatialPoint {
  std::string name, kind;  ///< "link", "site", "geom"
  int body = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< in the body's frame [m]
};

struct SpatialRobot {
  std::string file, format;  ///< "URDF"
  std::string no_drive;      ///< why joints have no drive: "URDF knows no drive"
  std::vector<SpatialBody> bodies;
  std::vector<SpatialPoint> points;        ///< of two of a name the first counts
  std::optional<Eigen::Vector3d> gravity;  ///< in the root's frame [m/s^2]; absent: the file holds none
  std::vector<std::string> left_out;       ///< what the file holds beside, as "3 visuals"
  std::vector<std::string> warnings;       ///< of the parser

  /// Throws InputError "FILE: ..." for numbers that no body or joint has: not finite, a mass below 0, principal moments
  /// that break the triangle rule, inertia without mass.
  void validate() const;
};

/// Whether a file is a robot's description by its name: .urdf, .xml, .mjcf, .xacro.
bool is_description(const std::string& path);
/// Reads URDF or MJCF, whichever root element comes first. Throws InputError: FILE, with line and column where the
/// parser knows them; or the package that is missing.
SpatialRobot read_description(const std::string& path);

/// By liburdfdom; points are the links' origins.
SpatialRobot read_urdf(const std::string& path);
/// By MuJoCo's compiler: what it works out of geoms, defaults and includes counts; points are sites, bodies and geoms.
SpatialRobot read_mjcf(const std::string& path);

}  // namespace ukemi::tools
