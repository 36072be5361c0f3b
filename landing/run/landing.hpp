// One landing: release, flight, contacts, rest.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "common/integrate/counters.hpp"
#include "landing/model/motion_data.hpp"
#include "landing/model/scene.hpp"

namespace ukemi {
namespace integrate {
enum class Method;
}
}  // namespace ukemi

namespace ukemi::landing {

/// Why a run ended.
enum class End {
  kRest,       ///< at rest (landing/body/body_rest.hpp): no later peak can exceed the running one
  kTimeLimit,  ///< at t_end
  kNoContact,  ///< at t_end, and no point has touched the floor: `peak` is that of a flight
  kAbandoned,  ///< the running peak passed SimulateOptions::abandon_above: `peak` is a lower bound
  kStopped,    ///< by SimulateOptions::over: `peak` is a lower bound
  kBroken,     ///< a limit of SimulateOptions::limits was broken: `peak` is meaningless
  kFailed,     ///< see `failure`; the result so far is kept
};
const char* name(End end);
/// Whether the peak of a run with this end is not that of a landing.
constexpr bool no_landing(End end) { return end == End::kNoContact || end == End::kBroken || end == End::kFailed; }

/// Why a run failed.
enum class Failure : unsigned char {
  kNone,
  kIntegration,  ///< the integrator stopped; see LandingPeak::status
  kSteps,        ///< more than SimulateOptions::max_steps
  kUnresolved,   ///< |ddr_0| inside a step is far above its ends: the step does not resolve the peak
  kGivesWay,     ///< a softening spring was deflected to where its stiffness vanishes
  kUnbalanced,   ///< the energy balance does not close
};

/// A touchdown of a point within this time of its last lift-off is chatter: it starts no interval of Peak [s].
inline constexpr double kChatter = 0.01;

/// Beyond this |phi| a joint has made a full turn and its drive has lost it [rad].
inline constexpr double kLostJoint = 6.283185307179586;

/// Limits on a landing. A run ends where it first breaks one.
struct Limits {
  std::array<bool, kPoints> forbidden{};                          ///< points that must never touch
  double motor_speed = std::numeric_limits<double>::infinity();   ///< of |dphi_m| [rad/s], >= 0
  double motor_torque = std::numeric_limits<double>::infinity();  ///< of |tau_mot| [Nm], >= 0
  /// Range of the joint angle phi_1 [rad].
  std::array<double, 2> joint{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  /// Maximum |dphi_ref| [rad/s]. A landing breaks it if a touchdown interrupts the move in the air and the motion from
  /// there is too fast; for the planned rate see peak_reference_rate.
  double reference_rate = std::numeric_limits<double>::infinity();
  void validate() const;  ///< throws InputError
  bool any_forbidden() const { return forbidden[kHip] || forbidden[kKnee] || forbidden[kFoot]; }
  bool joint_stops() const { return std::isfinite(joint[0]) || std::isfinite(joint[1]); }
  bool rated() const { return std::isfinite(motor_speed) || std::isfinite(motor_torque); }
  /// Whether states break them, not only a touch or the reference.
  bool within_steps() const { return rated() || joint_stops(); }
  bool any() const { return any_forbidden() || within_steps() || std::isfinite(reference_rate); }
};

struct SimulateOptions {
  /// Relative tolerance of each step, 1e-14..1e-2; see test/regression/reference.cpp for why, and step_accuracy.
  double accuracy = 1e-9;
  double abandon_above =
      std::numeric_limits<double>::infinity();  ///< give up once the running peak is above this [m/s^2], >= 0
  long max_steps = 200'000;                     ///< maximum steps and events of a run
  double max_step = 0.1;                        ///< maximum step; the step of a fixed-step method [s], > 0
  Limits limits;
  integrate::Method method{};                   ///< auto; others for comparison, for robots of two links
  std::vector<double>* touchdowns = nullptr;    ///< if set, receives the times of touchdowns, from release [s]
  const std::function<bool()>* over = nullptr;  ///< if set, polled every few dozen steps: true ends the run
  enum class Rest { kStop, kIgnore } rest = Rest::kStop;  ///< kIgnore: no rest test, run to t_end
  void validate() const;                                  ///< throws InputError
  /// Polls `over` every 32 steps, some tens of microseconds.
  bool stopped(long step) const { return over && step % 32 == 31 && (*over)(); }
};

/// The sequence of touchdowns, without chatter (kChatter), up to kCapacity. Points: of Robot::contacts; of the paper's
/// robot a Point.
class ContactOrder {
 public:
  static constexpr int kCapacity = 32, kMaxPoints = 12;
  ContactOrder() { lifted_.fill(-std::numeric_limits<double>::infinity()); }
  int size() const { return size_; }
  int operator[](int i) const { return point_[std::size_t(i)]; }
  void touchdown(int p, double t) {
    first_ = std::min(first_, t);
    touched_ |= 1u << p;
    if (size_ < kCapacity && !(t - lifted_[std::size_t(p)] < kChatter)) point_[std::size_t(size_++)] = std::int8_t(p);
  }
  void liftoff(int p, double t) { lifted_[std::size_t(p)] = t; }
  /// Time of the first touchdown, from release; infinite if none [s].
  double first() const { return first_; }
  /// Its point; -1: none.
  int first_point() const { return size_ > 0 ? point_[0] : -1; }
  /// Whether a point touched at all, chatter and touchdowns beyond kCapacity included.
  bool touched(int p) const { return (touched_ >> p & 1) != 0; }
  /// Numbers each point p as to(p).
  template <class To>
  void renumber(To&& to) {
    for (int i = 0; i < size_; ++i) point_[std::size_t(i)] = std::int8_t(to(point_[std::size_t(i)]));
    std::uint32_t touched = 0;
    for (int p = 0; p < kMaxPoints; ++p)
      if (this->touched(p)) touched |= 1u << to(p);
    touched_ = touched;
  }

 private:
  std::array<std::int8_t, kCapacity> point_{};
  int size_ = 0;
  std::uint32_t touched_ = 0;
  double first_ = std::numeric_limits<double>::infinity();
  std::array<double, kMaxPoints> lifted_;
};

/// The outcome of a landing of any robot.
struct RunEnd {
  double peak = 0;    ///< f(x) of Eq. 6: maximum acceleration of the peak point, |ddr_0| of [1] [m/s^2]
  double t_peak = 0;  ///< time of the peak, from release [s]
  double t_end = 0;   ///< end of the run, from release [s]
  End end = End::kFailed;
  Failure failure = Failure::kNone;                        ///< with kFailed
  integrate::Status status = integrate::Status::kStepped;  ///< with Failure::kIntegration
  integrate::Counters work;
  ContactOrder contacts;    ///< touchdowns
  int peak_contact = -1;    ///< index of the last one before the peak; -1: none
  bool joint_lost = false;  ///< |phi| of a driven joint exceeded kLostJoint at the end of a step: the link whirls
};
/// Why a landing failed, in words.
const char* reason(const RunEnd& run);

/// The result of a landing of the paper's robot; contacts are numbered as Point.
using LandingPeak = RunEnd;

/// One touch of a point, from touchdown to lift-off.
struct Touch {
  int point;              ///< a Point; of a robot of links, of Robot::contacts
  double t_touchdown;     ///< from release [s]
  double t_liftoff;       ///< when it rises through y = 0 again [s]; NaN if it never does
  double peak_force = 0;  ///< largest |F_j| of this contact [N]
  double peak_acc = 0;    ///< largest |ddr_0| from this touchdown to the next one of any point [m/s^2]
};

/// The largest |ddr_0| between touchdowns, as numbered in Figs. 6 and 7 of [1]; chatter starts no interval.
struct Peak {
  double t;             ///< [s]
  double acceleration;  ///< [m/s^2]
  int point;            ///< Point whose touchdown started the interval; -1: before the first
};

/// One row of a trajectory, SI units; phi_0, phi_1 as in [1], r_0 the thigh's centre of mass.
struct Sample {
  double t, x0, y0, phi0, phi1, phi_m, dx0, dy0, dphi0, dphi1, dphi_m, ddx0, ddy0, acc, tau_sea, phi_ref;
  double energy;  ///< kinetic and gravitational, of both links; the floor is zero [J]
  std::array<std::array<double, 2>, kPoints> force;  ///< of the floor on each point, along x and y [N]
};

/// Largest values of the actuator over the whole run.
struct Demands {
  double motor_speed = 0;           ///< max |dphi_m| [rad/s]
  double motor_torque = 0;          ///< max |tau_mot| [Nm]
  double sea_torque = 0;            ///< max |tau_SEA| [Nm]
  double phi_min = 0, phi_max = 0;  ///< range of the joint phi_1 [rad]
};

/// A landing with everything that a report needs.
struct Landing : LandingPeak {
  std::vector<Touch> touches;
  std::vector<Peak> peaks;
  std::vector<Sample> trajectory;  ///< empty unless a rate was given
  Demands demands;
  double energy_residual = 0;  ///< mismatch of the energy check over the energy turned over
};
/// Maximum energy residual of a valid landing; steps that keep the accuracy stay far below it.
inline double energy_tolerance(double accuracy) { return std::clamp(1e3 * accuracy, 1e-6, 1.0); }

// The functions below throw InputError for a scene, actuator, motion or options outside the ranges of their fields.

/// Throws InputError for an invalid scene, actuator or motion.
void validate(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion);

/// f(x) of one motion: closed-form flight, then the hybrid system from event to event (Sec. 2, 4 of [1]). Peaks are
/// taken at right and left limits of events and inside steps. Deterministic. A failed run is reported in the result.
[[nodiscard]] LandingPeak peak_acceleration(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                            const SimulateOptions& options = {});

/// Time of the first touchdown, from release [s]; infinite if there is none within the flight limit.
[[nodiscard]] double first_touchdown(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion);

/// The run of `peak_acceleration` with touches, peaks, demands, the energy check and, with rate > 0 [Hz], a trajectory:
/// a row every 1/rate s from release, 2e6 at most, and two at each event, its left and right limits. A run whose energy
/// balance does not close has failed.
[[nodiscard]] Landing simulate(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                               const SimulateOptions& options = {}, double rate = 0);

}  // namespace ukemi::landing
