// A robot of links, its floor, its drop, its motions, and the search range of plans.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "landing/body/robot.hpp"
#include "landing/model/motion_data.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// Search range of a plan in one joint.
struct JointSearch {
  std::array<double, 2> phi{-1.5707963267948966, 0};  ///< of phi_I and phi_F [rad]
  std::optional<double> hold;                         ///< angle held without a plan [rad]; absent: mid-range
  double held() const { return hold.value_or(0.5 * (phi[0] + phi[1])); }
};

/// State of the joints when the robot lets go, or when a plan arrives; references stay there until `from`.
struct BodyRelease {
  struct Joint {
    double phi = 0, rate = 0;  ///< spring relaxed [rad], [rad/s]
  };
  std::vector<Joint> joints;  ///< of Robot::joints; unused where not driven
  double from = 0;            ///< when the references may begin to move, from release [s], >= 0
};

/// A load on a part of the robot, with its rating; kinds, units and places: tools/docs/loads.md.
struct Load {
  enum class Kind {
    kAcceleration,
    kTorque,
    kDeflection,
    kMotorSpeed,
    kMotorTorque,
    kAngle,
    kForce,
    kImpulse,
    kTouch,
    kReferenceRate
  };
  std::string name;
  Kind kind = Kind::kAcceleration;
  int index = 0;                ///< of Robot::links, joints or contacts
  Place at;                     ///< of kAcceleration
  std::array<double, 2> phi{};  ///< of kAngle: the range [rad]
  double rating = 1;            ///< in the unit of the kind, > 0; of a limit >= 0
  bool limit = false;           ///< a constraint on plans; of other loads they minimise the largest value / rating
};

struct BodyScene {
  std::string name;
  Robot robot;
  bool floor = false;                                  ///< false: no contact
  double slope = 0;                                    ///< of the floor, > 0: it rises forward; |slope| < pi/2 [rad]
  std::string robot_file;                              ///< named by the scene file; empty: none
  std::vector<std::string> drive_files;                ///< actuator files that were read
  std::string source;                                  ///< where the floor's constants come from
  std::optional<Uncertainty> uncertainty, identified;  ///< of floor and pitch from calibrate; of the robot from its fit
  Verdicts verdicts, robot_verdicts;                   ///< of calibrate; of the robot's fit
  Drop drop;      ///< height: of the lowest contact's surface, not of a pinned robot; pitch: theta of the first
                  ///< link; forward speed: of a free base; pitch_rate: not on a rail
  Place drop_at;  ///< the place of a free base's first link that starts at x = 0 with the drop's speeds
  double detection_delay = 0;                ///< from the first touchdown to the motion's start [s], >= 0
  std::optional<double> t_end;               ///< upper bound of a run, from release [s]; absent: as Scene::t_end
  std::vector<JointSearch> search;           ///< of Robot::joints; unused where not driven
  std::array<double, 2> duration{0.1, 1.0};  ///< range for plans [s]
  bool own_durations = false;                ///< each driven joint has its own duration
  Freedom freedom;                           ///< further variables of a plan, for every driven joint
  std::optional<Scatter> scatter;            ///< of its drops; absent: not stated
  ExecutionTolerance execution;              ///< of every joint
  std::optional<BodyRelease> release;        ///< absent: released at phi_I
  std::vector<Load> loads;   ///< of [[load]], then the limits of [joint], of `forbid` and of `respect_ratings`
  bool ends_broken = false;  ///< a run ends with End::kBroken where a limit is first passed

  /// Throws InputError for a number outside its documented range.
  void validate() const;
  bool touches() const { return floor && !robot.contacts.empty(); }
  bool limited() const;  ///< whether a load is a limit
};

/// The motion of each of Robot::joints, from the first touchdown of any contact on; ignored where not driven.
using BodyMotion = std::vector<Motion>;

/// Every driven joint held at its release angle or, without a release, at JointSearch::held().
BodyMotion held_posture(const BodyScene& scene);
/// Adds a limit CONTACT.touch for each of the named contacts. Throws InputError "OPTION: ..." for an unknown name.
void forbid(BodyScene& scene, const std::vector<std::string>& contacts, const std::string& option = "forbid");
/// Makes the ratings of each drive limits: JOINT.motor_speed, JOINT.motor_torque, and JOINT.reference_rate with the
/// motor's speed. Returns the joints whose drive has neither rating. Throws InputError "OPTION: ..." if none has one.
std::vector<std::string> respect_ratings(BodyScene& scene, const std::string& option = "respect_ratings");
/// Throws InputError unless there is a motion for every joint, and those of driven joints are valid.
void validate(const Robot& robot, const BodyMotion& motion);

/// An actuator file for the drive of a joint, which overrides the robot's. An empty name: the only joint without a
/// drive, else the only driven one.
struct GivenDrive {
  std::string joint, file;
  std::string option = "--actuator";  ///< named in messages
};

/// Reads scene.toml, the robot here or in the file that robot = "FILE" names, relative to this one:
/// tools/docs/files.md. The paper's short form has links thigh and shank, joint knee. [command] is applied to
/// the drives, see CommandPath. Without [floor] contacts touch by their own laws, if all have a stiffness of their own.
/// Throws InputError with file:line:column. Tests: test/legs.
BodyScene read_body_scene(const std::string& path, const std::vector<GivenDrive>& drives = {});
/// The same, dropped from another height [m]; the file may hold a robot only. Every contact may touch.
BodyScene read_dropped(const std::string& path, double height, const std::vector<GivenDrive>& drives = {});
/// A robot for trials: [drop] is optional and [command] not applied.
BodyScene read_robot(const std::string& path, const std::vector<GivenDrive>& drives = {});

/// Reads motion.toml with [motion.JOINT] and [reposition.JOINT], for a single driven joint also [motion]; a path that
/// ends in .csv: the rows of body_motion_csv. Throws InputError.
BodyMotion read_body_motion(const std::string& path, const Robot& robot);
/// The text of a motion.toml that `read_body_motion` reads back; `comments` goes in front, each line after "# ".
std::string body_motion_toml(const BodyMotion& motion, const Robot& robot, const std::string& comments);
/// Rows of phi_ref_JOINT and dphi_ref_JOINT over the time from the first touchdown, of one driven joint phi_ref and
/// dphi_ref; `rate` rows a second [Hz], > 0. `start`: when the landing motions are expected to start, from release [s];
/// finite: the moves in the air that have begun by then are the rows before t = 0. Tests: test/legs/plans.cpp.
std::string body_motion_csv(const BodyMotion& motion, const Robot& robot, double rate, const std::string& comments,
                            double start = std::numeric_limits<double>::infinity());

}  // namespace ukemi::landing
