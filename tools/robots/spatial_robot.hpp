// A spatial robot as its description gives it: bodies in a tree, before a plane is chosen. Output of the readers of
// URDF and MJCF, input of the projection.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace ukemi::tools {

/// Mass properties of a body, in one frame.
struct SpatialInertia {
  double mass = 0;                                   ///< [kg], >= 0
  Eigen::Vector3d com = Eigen::Vector3d::Zero();     ///< centre of mass [m]
  Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();  ///< about the centre of mass [kg m^2], symmetric
};
/// The inertia in another frame: `frame` is the old frame's pose in it; the tensor rotates as R I R^T.
SpatialInertia in_frame(const SpatialInertia& inertia, const Eigen::Isometry3d& frame);
/// The inertia of two bodies joined rigidly, in their common frame: masses add, each tensor is moved to the common
/// centre of mass by Steiner's theorem, I + m (d.d 1 - d d^T).
SpatialInertia merged(const SpatialInertia& a, const SpatialInertia& b);

/// The joint between a body and its parent. Angles are measured from the posture of SpatialBody::in_parent.
struct SpatialJoint {
  enum class Motion { kFixed, kTurns, kFloats, kOther };  ///< kOther: slides, turns about more than one axis
  std::string name;
  std::string type = "fixed";                        ///< as the file calls it: "revolute", "hinge"
  Motion motion = Motion::kFixed;                    ///< kTurns: about `axis` through `anchor`, in the child's frame
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< of length 1
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<double> lower, upper;                ///< of the angle [rad]
  std::optional<std::array<double, 2>> travel;       ///< limits of a joint that slides [m]
  std::optional<double> effort, speed;               ///< maximum of its motor [Nm], [rad/s]; > 0
  double damping = 0, friction = 0, armature = 0;    ///< [Nm/(rad/s)], [Nm], [kg m^2]; >= 0
  double stiffness = 0, rest = 0;                    ///< of a spring in the joint [Nm/rad], >= 0; [rad]
  double zero = 0;                                   ///< its angle in that posture by its description [rad]
  std::string follows;                               ///< joint that its angle follows (mimic); empty: none
};

struct SpatialBody {
  std::string name;
  int parent = -1;                                              ///< index of an earlier body; -1: the root
  Eigen::Isometry3d in_parent = Eigen::Isometry3d::Identity();  ///< pose where every joint is at 0
  SpatialInertia inertia;                                       ///< in the body's frame
  SpatialJoint joint;                                           ///< to the parent
};

/// A named point, which may become a contact.
struct SpatialPoint {
  std::string name, kind;  ///< "link", "site", "geom"
  int body = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< in the body's frame [m]
};

struct SpatialRobot {
  std::string file, format;  ///< "URDF"
  std::string no_drive;      ///< why joints have no drive: "URDF knows no drive"
  std::vector<SpatialBody> bodies;
  std::vector<SpatialPoint> points;        ///< of equal names the first counts
  std::optional<Eigen::Vector3d> gravity;  ///< in the root's frame [m/s^2]; absent: the file holds none
  std::vector<std::string> left_out;       ///< what is ignored, as "3 visuals"
  std::vector<std::string> warnings;       ///< of the parser

  /// Throws InputError "FILE: ..." for numbers that no body or joint has: not finite, a mass below 0, principal moments
  /// that break the triangle rule, inertia without mass.
  void validate() const;
};

/// Whether a file's extension is that of a robot description: .urdf, .xml, .mjcf, .xacro.
bool is_description(const std::string& path);
/// Reads URDF or MJCF, whichever root element comes first. Throws InputError: FILE, with line and column where the
/// parser knows them; or the package that is missing.
SpatialRobot read_description(const std::string& path);

/// Reads URDF by liburdfdom; points are the links' origins.
SpatialRobot read_urdf(const std::string& path);
/// Reads MJCF by MuJoCo's compiler, which resolves geoms, defaults and includes; points are sites, bodies and geoms.
SpatialRobot read_mjcf(const std::string& path);

}  // namespace ukemi::tools
