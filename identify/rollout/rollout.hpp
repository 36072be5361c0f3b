// Prediction of a trial's angles from the constants, for double or ceres::Jet.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/integrate/method.hpp"
#include "common/jet.hpp"
#include "identify/logs/trial.hpp"
#include "identify/rig/one_link.hpp"
#include "identify/rig/rig.hpp"
#include "identify/rollout/nuisance.hpp"

namespace ukemi::identify {

using integrate::Method;

/// A trial divided into segments at the breakpoints of its inputs, see Excitation.
struct PreparedTrial {
  explicit PreparedTrial(const Trial& trial);  ///< which must outlive it; throws InputError, see Trial::validate

  struct Segment {
    Excitation<double> input;
    double t_end;  ///< [s]
    bool jumps;    ///< force, reference or command jumps at its start
  };
  /// The segments with the force (0 outside its log) moved later by `shift`, and the command by `delay` [s].
  std::vector<Segment> cut(double shift, double delay = 0) const;

  const Trial* trial;
  std::vector<Segment> segments;  ///< with shift and delay 0
  double phi_start;               ///< phi_ref at the first sample, else 0 [rad]
  double spacing;                 ///< median interval between samples [s]
};

/// Work that several rollouts may spend together: integrated steps and single intervals, counted and not timed.
struct Budget {
  double left = 0;
  double overdraft = 0;  ///< how far below 0 a rollout may take it before it diverges
  bool spent() const { return left <= 0; }
};

struct RolloutOptions {
  double accuracy = 1e-9;          ///< relative tolerance of each step
  double max_step = kLongestStep;  ///< longest step; the step of a fixed-step method [s]
  /// Absent: the explicit method of the trial's kernel. kAuto: for stiff constants; the others: for comparison. With
  /// derivatives explicit methods only, in a Jet of kSmallJet. A drive with delay or filter: absent or kAuto.
  std::optional<Method> method;
  /// Where the rig is linear: solved exactly (linear.hpp), or integrated like the rest, for comparison.
  enum class Linear { kExact, kIntegrated } linear = Linear::kExact;
  integrate::Counters* work = nullptr;  ///< receives the work done by integrating
  double escape = kEscape;              ///< infinite for multi-turn trials [rad]
  long max_steps = 10'000;              ///< beyond it, and two per segment, the rollout diverges: too stiff
  Budget* budget = nullptr;             ///< work is taken from it; once it is exhausted every rollout diverges
  void validate() const;                ///< throws InputError
};

/// phi_1, phi_m and, where `torque` is given, the spring's torque as a sensor logs it, at every sample, with
/// derivatives where T is a Jet (exact through every event; they jump where a slip ends); a Jet's phi_m and torque stay
/// empty where not logged. Exact where the rig is linear. A trial's own rig replaces `rig`. Incomplete unless kDone.
template <class T>
[[nodiscard]] RolloutStatus rollout(const Rig& rig, const SeaParameters<T>& sea, const Nuisance<T>& nuisance,
                                    const PreparedTrial& trial, const RolloutOptions& options, std::vector<T>& phi,
                                    std::vector<T>& phi_m, std::vector<T>* torque = nullptr);

/// `rollout` with the method that the options name, on one kernel for every trial. double or a Jet of kSmallJet.
template <class T>
[[nodiscard]] RolloutStatus rollout_with_method(const Rig& rig, const SeaParameters<T>& sea,
                                                const Nuisance<T>& nuisance, const PreparedTrial& trial,
                                                const RolloutOptions& options, std::vector<T>& phi,
                                                std::vector<T>& phi_m, std::vector<T>* torque);

/// Number of derivatives of the two Jets that are compiled: for the five constants, or with nuisance terms. Even, for
/// whole registers.
inline constexpr int kSmallJet = 6, kLargeJet = 16;

}  // namespace ukemi::identify
