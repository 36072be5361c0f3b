// Exact gradients of every local maximum of |ddr_0| of a landing, through its events.
//
// f of Eq. 6 is the largest of the local maxima a_k of |ddr_0|; near a minimum several of them are equal and f has a
// kink, while each a_k stays smooth as long as the order of the events does. What is integrated are the derivatives of
// the state with respect to the parameters p at a fixed time, y_p, through the events by
// common/integrate/saltation.hpp. A maximum that is a right or a left limit at an event has the total derivative at the
// moving time t*; one inside a smooth phase has the partial derivative at its fixed time (envelope theorem). Events at
// one instant are taken in the order in which they happen: the gradient is one-sided there. Source for the maximum:
// Danskin (1966). Tests: test/property/gradient.cpp.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/actuator.hpp"
#include "landing/derivatives/peak_kind.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

/// Parameters of derivatives; those of the motion come first, so that its gradient is the head of the full one.
enum class Parameter {
  kPhiI,               ///< [rad]
  kPhiF,               ///< [rad]
  kDuration,           ///< [s]
  kBump0,              ///< [rad]
  kBump1,              ///< [rad]
  kBump2,              ///< [rad]
  kBump3,              ///< [rad]
  kGainP,              ///< factor of K_p in the motion
  kGainD,              ///< factor of K_d in the motion
  kTo,                 ///< end of the move in the air [s]
  kHeight,             ///< [m]
  kForwardSpeed,       ///< [m/s]
  kPitch,              ///< [rad]
  kStiffness,          ///< [N/m]
  kDampingNormal,      ///< [N/(m/s)]
  kDampingTangential,  ///< [N/(m/s)]
  kKp,                 ///< [Nm/rad]
  kKd,                 ///< [Nm/(rad/s)]
  kKSea,               ///< [Nm/rad]
  kCSea,               ///< [Nm/(rad/s)]
  kIMotor,             ///< [kg m^2]
};
/// Numbers of parameters of Eq. 6; of a motion with all its variables; of Parameter.
inline constexpr int kQuinticParameters = int(Parameter::kBump0), kMotionParameters = int(Parameter::kHeight),
                     kParameters = int(Parameter::kIMotor) + 1;
static_assert(kQuinticParameters == kBumpSlot && kMotionParameters == kMotionNumbers, "as motion_numbers()");
static_assert(kParameters == int(Parameter::kKp) + kConstants, "the last are those of constants()");

/// One local maximum of |ddr_0| and its gradient, in the order of Parameter.
template <int P>
struct PeakGradient {
  double t;                       ///< from release [s]
  double value;                   ///< [m/s^2]
  Eigen::Matrix<double, P, 1> d;  ///< by each parameter [m/s^2 per unit]
  PeakKind kind;
  int contact;  ///< last touchdown before it, see LandingPeak::peak_contact
};

/// The local maxima of one landing.
template <int P>
struct PeakGradients {
  std::vector<PeakGradient<P>> peaks;  ///< the largest first; the first is f
  double t_end = 0;                    ///< end of the run, from release [s]
  End end = End::kFailed;
  integrate::Status status = integrate::Status::kStepped;  ///< with kFailed; kNotFinite: an event at zero rate
  integrate::Counters work;
};

/// The `max_peaks` largest local maxima with their gradients by the three numbers of Eq. 6. Uses of the options
/// accuracy, max_step, max_steps, rest and over: a run is never abandoned and has no limits. A failed run is reported
/// in `status`, with the peaks found so far. Throws InputError as peak_acceleration does.
[[nodiscard]] PeakGradients<kQuinticParameters> quintic_peaks(const Scene& scene, const SeaParameters<double>& sea,
                                                              const Motion& motion, const SimulateOptions& options,
                                                              int max_peaks);

/// The same by all numbers of a motion; derivatives by `to` are 0 without a move in the air.
[[nodiscard]] PeakGradients<kMotionParameters> motion_peaks(const Scene& scene, const SeaParameters<double>& sea,
                                                            const Motion& motion, const SimulateOptions& options,
                                                            int max_peaks);

/// The same by all of Parameter; derivatives by the constants of an absent floor are 0.
[[nodiscard]] PeakGradients<kParameters> all_gradients(const Scene& scene, const SeaParameters<double>& sea,
                                                       const Motion& motion, const SimulateOptions& options,
                                                       int max_peaks);

}  // namespace ukemi::landing
