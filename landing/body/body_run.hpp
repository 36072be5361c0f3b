// One landing of a robot of any joints: released, in flight, through its contacts, to rest.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "landing/body/body_scene.hpp"
#include "landing/run/landing.hpp"

namespace ukemi::landing {

/// One row of a trajectory in the true frame (on a slope, x and y are not the floor's), SI units.
struct BodySample {
  double t;
  std::array<double, kMostLinks> x, y, theta;                      ///< of each link's origin; its absolute angle
  std::array<double, kMostJoints> phi, dphi, phi_m, tau, phi_ref;  ///< of each joint; tau: on its child [Nm]
  double acc_x, acc_y, acc;                                        ///< of the peak's point [m/s^2]
  std::array<double, kMostContacts> contact_x, contact_y, force_x, force_y;  ///< where each contact is; its force [N]
  double energy;                                                             ///< of the links [J]
};

/// Largest values that a joint and its drive stand, over the whole run.
struct JointDemands {
  double motor_speed = 0, motor_torque = 0;  ///< max |dphi_m|, of a geared drive |dphi| [rad/s]; of the motor [Nm]
  double torque = 0;                         ///< max |tau| on the child [Nm]
  double phi_min = 0, phi_max = 0;           ///< range of the joint [rad]
};

/// Where a landing first breaks a limit of its scene.
struct BrokenLimit {
  int load = -1;  ///< of BodyScene::loads
  double t = 0;   ///< [s]
  explicit operator bool() const { return load >= 0; }
};

struct LoadPeak {
  double value = 0, t = 0;  ///< of a load, the largest of a run, and when [s]
};

/// A landing. Empty where peak_acceleration made it: touches, peaks, demands, trajectory, energy_residual.
struct BodyLanding : RunEnd {
  double first_touchdown = std::numeric_limits<double>::infinity();  ///< from release [s]
  int first_contact = -1;                 ///< of Robot::contacts, which touches then; -1: none
  BrokenLimit broken;                     ///< which limit, if any
  std::vector<LoadPeak> loads;            ///< of BodyScene::loads
  std::vector<Touch> touches;             ///< in their order
  std::vector<Peak> peaks;                ///< between touchdowns, chatter left out; point: of Robot::contacts
  std::vector<JointDemands> demands;      ///< of Robot::joints
  std::vector<BodySample> trajectory;     ///< empty unless a rate was given
  double energy_residual = 0;             ///< mismatch of the energy check over the energy turned over
  std::array<double, 2> base{}, speed{};  ///< at its end: centre of mass, else travel and 0; floor's frame
};

// Both throw InputError for a scene, a motion or options that break the ranges of their fields; of the options
// accuracy, abandon_above, max_steps, max_step, over and rest count. A run that fails is a status. Deterministic.

/// Closed by events as `simulate` of the paper's robot; with a rate above 0 [Hz] a trajectory: a row every 1/rate s
/// from release, and two at each event. A run whose energy balance does not close has failed. Tests: test/legs.
[[nodiscard]] BodyLanding simulate(const BodyScene& scene, const BodyMotion& motion,
                                   const SimulateOptions& options = {}, double rate = 0);
/// The peak alone, at accuracies from 1e-7 up by a kernel of the robot's own size and a lower order.
[[nodiscard]] BodyLanding peak_acceleration(const BodyScene& scene, const BodyMotion& motion,
                                            const SimulateOptions& options = {});

}  // namespace ukemi::landing
