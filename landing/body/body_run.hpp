// One landing of a robot of links: release, flight, contacts, rest.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "landing/body/body_scene.hpp"
#include "landing/run/landing.hpp"

namespace ukemi::landing {

/// One row of a trajectory in the true frame (on a slope, x and y are not the floor's), SI units.
struct BodySample {
  double t;
  std::array<double, kMaxLinks> x, y, theta;                ///< origin and absolute angle of each link
  std::array<double, kMaxLinks> vx, vy, omega;              ///< their rates
  std::array<double, kMaxJoints> phi, dphi, phi_m, dphi_m;  ///< of each joint and its motor
  std::array<double, kMaxJoints> tau, drive_torque,
      phi_ref;               ///< tau acts on the child [Nm]; of the drive see JointDemands
  double acc_x, acc_y, acc;  ///< of the peak point [m/s^2]
  std::array<double, kMaxContacts> contact_x, contact_y, force_x, force_y;  ///< place of each contact; its force [N]
  double energy;                                                            ///< of the links [J]
};

/// Largest values of a joint and its drive over the whole run.
struct JointDemands {
  double motor_speed = 0, motor_torque = 0;  ///< max |dphi_m|, of a geared drive |dphi| [rad/s]; of the motor [Nm]
  double torque = 0;                         ///< max |tau| on the child [Nm]
  double drive_torque = 0;                   ///< the same of the spring alone, of a geared drive of the motor [Nm]
  double phi_min = 0, phi_max = 0;           ///< range of the joint [rad]
};

/// When a landing first breaks a limit of its scene.
struct BrokenLimit {
  int load = -1;  ///< of BodyScene::loads
  double t = 0;   ///< [s]
  explicit operator bool() const { return load >= 0; }
};

struct LoadPeak {
  double value = 0, t = 0;  ///< largest value of a load in a run, and when [s]
};

/// A landing. peak_acceleration leaves touches, peaks, demands, trajectory and energy_residual empty.
struct BodyLanding : RunEnd {
  BrokenLimit broken;                     ///< the first broken limit, if any
  std::vector<LoadPeak> loads;            ///< of BodyScene::loads
  std::vector<Touch> touches;             ///< in order of touchdown
  std::vector<Peak> peaks;                ///< between touchdowns without chatter; point: of Robot::contacts
  std::vector<JointDemands> demands;      ///< of Robot::joints
  std::vector<BodySample> trajectory;     ///< empty unless a rate was given
  double energy_residual = 0;             ///< mismatch of the energy check over the energy turned over
  std::array<double, 2> base{}, speed{};  ///< at the end: centre of mass, else travel and 0; floor's frame
  std::array<double, kMaxLinks> theta{};  ///< at the end, in the scalar path: angles of links that turn together [rad]
};

// Both throw InputError for a scene, a motion or options outside the ranges of their fields. They use of the options
// accuracy, abandon_above, max_steps, max_step, over and rest, a peak also method and touchdowns. A failed run is
// reported in the result. Deterministic.

/// A landing with its report, as `simulate` of the paper's robot; with rate > 0 [Hz] a trajectory: a row every 1/rate s
/// from release, and two at each event. A run whose energy balance does not close has failed. Tests: test/legs.
[[nodiscard]] BodyLanding simulate(const BodyScene& scene, const BodyMotion& motion,
                                   const SimulateOptions& options = {}, double rate = 0);
/// The peak only; for accuracies of 1e-7 and looser by a kernel of the robot's size and a method of lower order.
[[nodiscard]] BodyLanding peak_acceleration(const BodyScene& scene, const BodyMotion& motion,
                                            const SimulateOptions& options = {});

}  // namespace ukemi::landing
