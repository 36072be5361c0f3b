// A robot in the vertical plane: links in a tree, joints with their drives, points that may touch the floor. The
// paper's two-link robot is one instance. Ours.
//
// Frames: link i has an absolute angle theta_i and an origin, its joint with its parent; the first link's origin is the
// end that its file calls so. u(theta) = (sin, -cos) points along the link, n(theta) = (cos, sin) across it; theta = 0
// hangs straight down, across points forward (+x). A joint's angle is phi = theta_child - theta_parent (0: in line).
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/sea_parameters.hpp"
#include "common/uncertainty.hpp"

namespace ukemi::landing {

/// Maximum sizes of a robot; one of the joints may be the pin of a pinned base.
inline constexpr int kMaxLinks = 8, kMaxJoints = 8, kMaxContacts = 12;

/// A point of a link: origin + along u + across n [m].
struct Place {
  double along = 0, across = 0;
};

struct Link {
  std::string name;
  int parent = -1;     ///< index of an earlier link; -1 for the first link, moved by the base
  Place at;            ///< place of its joint in the parent
  double mass;         ///< [kg], > 0
  double inertia_com;  ///< about the centre of mass [kg m^2], > 0
  Place com;           ///< centre of mass
};

/// How a joint is driven: +tau acts on the child, -tau on the parent.
enum class DriveKind {
  kElastic,  ///< Eq. 2-4, a motor behind a spring; the motor's reaction on the links is the spring's torque alone
  kGeared,   ///< a motor that turns with the joint: tau = clamp(Eq. 3, +- tau_max) - friction - i_motor ddphi
  kPassive,  ///< tau = -stiffness (phi - rest) - damping dphi - dry friction
  kLocked,   ///< stays at its angle of release
};
const char* name(DriveKind kind);  ///< "elastic"

/// The joint between a link and its parent; of the first link of a pinned robot, with the ground.
struct Joint {
  std::string name;
  int child = 0;  ///< link
  DriveKind kind = DriveKind::kElastic;
  SeaParameters<double> sea{0, 0, 0, 0,
                            1};  ///< elastic; geared: k_p, k_d, i_motor, tau_max, friction terms; passive: friction
  std::optional<double> speed_max, motor_torque_max;  ///< rated, of the motor at the output [rad/s], [Nm], > 0
  double stiffness = 0, damping = 0;                  ///< passive [Nm/rad], [Nm/(rad/s)], >= 0
  double rest = 0;                                    ///< of the passive spring [rad]
  double parallel_stiffness = 0, parallel_rest = 0;   ///< of a parallel spring, not if locked, >= 0 [Nm/rad]; [rad]
  double phi = 0;                                     ///< at release, passive and locked [rad]
  std::vector<std::string> uncertain;                 ///< drive constants with known errors, see Actuator
  DenseMatrix covariance;                             ///< of `uncertain`, in that order
  std::string q_name;                                 ///< in the robot's description and messages; empty: `name`
  double q_sign = 1, q_zero = 0;                      ///< its angle there, q = zero + sign phi: 1 or -1; [rad]

  bool driven() const { return kind == DriveKind::kElastic || kind == DriveKind::kGeared; }
};

/// A cover of a contact point, which bottoms out on the floor.
struct Pad {
  double thickness;  ///< d [m], > 0
  double stiffness;  ///< K_p [N/m], > 0
  double damping;    ///< C_p [N/(m/s)], >= 0
};

/// Force of the floor on a point below it (contact.hpp). The defaults are the paper's law.
struct ContactLaw {
  double stiffness = 0;                                       ///< K [N/m], of Hunt and Crossley [N/m^p], > 0
  double damping_normal = 0;                                  ///< C [N/(m/s)], >= 0
  double damping_tangential = 0;                              ///< C_t [N/(m/s)], >= 0; with friction > 0
  double stiffness_tangential = 0;                            ///< K_t [N/m], >= 0
  double friction = std::numeric_limits<double>::infinity();  ///< mu, >= 0; infinite: no limit
  bool hunt_crossley = false;
  double exponent = 1.5;   ///< p, of Hunt and Crossley, >= 1
  double dissipation = 0;  ///< c, of Hunt and Crossley [s/m], >= 0
};

struct ContactPoint {
  std::string name;
  int link = 0;
  Place at;
  ContactLaw law;
  std::optional<Pad> pad;
  std::vector<std::string> own_keys = {};  ///< keys of `law` set in the contact's own table
};

/// Where a measured force pushes in trials: a hammer, a rod, a cable.
struct PushPoint {
  std::string name;
  int link = 0;
  Place at;
};

/// End stops of a joint or of the rail: F = max(0, K delta + C ddelta), delta the penetration.
struct Stop {
  int joint = -1;                     ///< of Robot::joints; -1: the rail, by the first link's origin
  std::array<double, 2> ends{};       ///< low, high [rad] or, along the rail, [m]; infinite: none
  double stiffness = 0, damping = 0;  ///< K, > 0; C, >= 0
};

/// kRail: the first link's origin slides along a line, its angle stays; kPinned: it is fixed.
enum class Base { kFree, kRail, kPinned };

struct Robot {
  double gravity = 9.81;  ///< [m/s^2], >= 0
  Base base = Base::kFree;
  double rail_direction = 1.5707963267948966;        ///< from +x, counter-clockwise, against the true level [rad]
  double rail_viscous = 0;                           ///< [N/(m/s)], >= 0
  double rail_friction = 0, rail_load_friction = 0;  ///< dry [N], >= 0; over the force across the rail, 0 to 1
  double pin_height = 0;                             ///< of a pinned origin above the floor [m]
  int peak_link = 0;
  Place peak;  ///< the point whose acceleration is minimised
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::vector<ContactPoint> contacts;
  std::vector<Stop> stops;
  std::vector<PushPoint> pushes;  ///< see Commands::push

  /// The joint above a link; null: none.
  const Joint* joint_of(int link) const {
    for (const Joint& j : joints)
      if (j.child == link) return &j;
    return nullptr;
  }
  double mass() const;  ///< [kg]
  /// Whether any drive has a covariance of its constants.
  bool fitted() const {
    return std::any_of(joints.begin(), joints.end(), [](const Joint& j) { return j.covariance.size() > 0; });
  }
  /// Throws InputError for a number outside its documented range, sizes beyond the maxima, a parent after its child,
  /// a joint that is missing, repeated or out of order.
  void validate() const;
};

/// Warnings about implausible numbers, one sentence each: a mass or an inertia that no link of that size has, a centre
/// of mass outside its link, a contact that can never touch.
std::vector<std::string> doubts(const Robot& robot);

}  // namespace ukemi::landing
