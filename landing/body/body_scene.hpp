// A robot of any joints, its floor, its drop, what it plays, and what a plan may be.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "landing/body/robot.hpp"
#include "landing/model/motion_data.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// What a plan may be in one joint.
struct JointSearch {
  std::array<double, 2> phi{-1.5707963267948966, 0};  ///< of phi_I and phi_F [rad]
  std::optional<double> hold;                         ///< where the joint is held without a plan [rad]
  double held() const { return hold.value_or(0.5 * (phi[0] + phi[1])); }  ///< absent: in the middle of the range
};

/// How the joints are where the robot lets go, or where a plan arrives; the reference stands there until `from`.
struct BodyRelease {
  struct Joint {
    double phi = 0, rate = 0;  ///< the spring relaxed [rad], [rad/s]
  };
  std::vector<Joint> joints;  ///< of Robot::joints; of those that are not driven without meaning
  double from = 0;            ///< when the references may begin to move, from release [s], >= 0
};

/// What a part bears, beside what it can; kinds, units and places: tools/docs/loads.md.
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
  bool limit = false;           ///< plans keep it; of the others they make the largest value / rating small
};

struct BodyScene {
  std::string name;
  Robot robot;
  bool floor = false;                    ///< false: nothing can touch
  double slope = 0;                      ///< the floor rises forward by so much, within a right angle [rad]
  std::string robot_file;                ///< that the scene's names; empty: none
  std::vector<std::string> drive_files;  ///< actuators that were read
  std::string source;                    ///< where the floor's constants come from
  std::optional<Uncertainty> uncertainty, identified;  ///< of floor and pitch by calibrate; of the robot by its fit
  Verdicts verdicts, robot_verdicts;  ///< of those, by the calibration that wrote them; of the robot's, by its fit
  Drop drop;  ///< height: of the lowest contact's surface, not of a pinned robot; pitch: theta of the first
              ///< link; forward speed: of a free base; pitch_rate: not on a rail
  double detection_delay = 0;                ///< from the first touchdown to the motion's start [s], >= 0
  std::optional<double> t_end;               ///< upper bound of a run, from release [s]; absent: as Scene::t_end
  std::vector<JointSearch> search;           ///< of Robot::joints; of those that are not driven without meaning
  std::array<double, 2> duration{0.1, 1.0};  ///< of a plan, one for all joints or for each [s]
  bool own_durations = false;                ///< each driven joint has its own
  Freedom freedom;                           ///< what a plan may have beside, in every driven joint
  std::optional<Scatter> scatter;            ///< of its drops; absent: nothing is said
  ExecutionTolerance execution;              ///< how exactly every joint plays its motion
  std::optional<BodyRelease> release;        ///< absent: released at phi_I
  std::vector<Load> loads;   ///< of [[load]], then the limits of [joint], of `forbid` and of `respect_ratings`
  bool ends_broken = false;  ///< a run ends with End::kBroken where a limit is first passed

  /// Throws InputError for a number outside the range that stands beside it.
  void validate() const;
  bool touches() const { return floor && !robot.contacts.empty(); }
  bool limited() const;  ///< a load is a limit
};

/// What each joint of Robot::joints plays from the first touchdown of any contact on; of those that are not driven
/// nothing, whatever stands there.
using BodyMotion = std::vector<Motion>;

/// Every driven joint held where it is released, without a release where JointSearch::held says.
BodyMotion held_posture(const BodyScene& scene);
/// Contacts that must never touch, by their names: a limit CONTACT.touch for each. Throws InputError "OPTION: ..." for
/// a name that is no contact's.
void forbid(BodyScene& scene, const std::vector<std::string>& contacts, const std::string& option = "forbid");
/// The ratings of each drive become limits, JOINT.motor_speed and JOINT.motor_torque, and no reference may be faster
/// than its motor, JOINT.reference_rate. Returns the joints whose drive has neither rating.
std::vector<std::string> respect_ratings(BodyScene& scene);
/// Throws InputError unless there is a motion for every joint, and those of driven joints are motions.
void validate(const Robot& robot, const BodyMotion& motion);

/// The drive of a joint from an actuator file: it wins over the robot's own. An empty name: of the only joint that has
/// no drive of its own, or of the only driven one.
struct GivenDrive {
  std::string joint, file;
  std::string option = "--actuator";  ///< that gave it, for messages
};

/// Reads scene.toml, the robot here or in the file that robot = "FILE" names, relative to this one:
/// tools/docs/files.md. The paper's short form has links thigh and shank, joint knee. Its drives are those behind
/// [command], see CommandPath. Without [floor] contacts touch by their own laws, if all have a stiffness of their own.
/// Throws InputError with file:line:column. Tests: test/legs.
BodyScene read_body_scene(const std::string& path, const std::vector<GivenDrive>& drives = {});
/// The same, dropped from another height [m]; the file may be a robot alone. Every contact touches.
BodyScene read_dropped(const std::string& path, double height, const std::vector<GivenDrive>& drives = {});
/// The same of a file that may be a robot alone, without a drop, as it is driven: [command] is not applied.
BodyScene read_robot(const std::string& path, const std::vector<GivenDrive>& drives = {});

/// Reads motion.toml of several joints, [motion.JOINT] and [reposition.JOINT], of one driven joint also [motion]; a
/// path that ends in .csv: the rows of body_motion_csv. Throws InputError.
BodyMotion read_body_motion(const std::string& path, const Robot& robot);
/// The text of a motion.toml that `read_body_motion` reads back; `comments` goes in front, each line behind "# ".
std::string body_motion_toml(const BodyMotion& motion, const Robot& robot, const std::string& comments);
/// Rows of phi_ref_JOINT and dphi_ref_JOINT over the time from the first touchdown, of one driven joint phi_ref and
/// dphi_ref; `rate` rows a second [Hz], > 0. `start`: when the landing motions are expected to start, from release [s];
/// finite: the moves in the air that have begun by then are the rows before t = 0. Tests: test/legs/plans.cpp.
std::string body_motion_csv(const BodyMotion& motion, const Robot& robot, double rate, const std::string& comments,
                            double start = std::numeric_limits<double>::infinity());

}  // namespace ukemi::landing
