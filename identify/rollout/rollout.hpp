// From constants to predicted angles: one trial on the rig, for double or ceres::Jet.
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

/// A trial cut where its inputs bend: between cuts force and reference are linear in time.
struct PreparedTrial {
  explicit PreparedTrial(const Trial& trial);  ///< which must outlive it; throws InputError, see Trial::validate

  struct Stretch {
    Excitation<double> input;
    double t_end;  ///< [s]
    bool jumps;    ///< force or reference jumps where it starts
  };
  /// The cuts with the force moved later by `shift` [s], it is 0 outside its log; and a command that is followed later
  /// by `delay` [s].
  std::vector<Stretch> cut(double shift, double delay = 0) const;

  const Trial* trial;
  std::vector<Stretch> stretches;  ///< of shift 0
  double phi_start;                ///< phi_ref at the first sample, else 0 [rad]
  double spacing;                  ///< median interval between samples [s]
};

/// What several rollouts may spend together, in integrated steps and intervals followed one by one. Counted, not
/// timed: the same whatever the machine.
struct Budget {
  double left = 0;
  double overdraft = 0;  ///< how far below 0 a rollout may take it before it diverges
  bool spent() const { return left <= 0; }
};

struct RolloutOptions {
  double accuracy = 1e-9;          ///< relative tolerance of each step
  double max_step = kLongestStep;  ///< longest step; the step of a fixed-step method [s]
  /// Absent: the explicit one that suits the trial's kernel. The others are for comparison, and kAuto for values of
  /// stiff constants; derivatives are explicit only, and with another method only in a Jet of kSmallJet. A drive with
  /// delay or filter: none, or kAuto.
  std::optional<Method> method;
  /// Where the rig is linear: exactly (linear.hpp), or integrated like the rest, for comparison and other methods.
  enum class Linear { kExact, kIntegrated } linear = Linear::kExact;
  integrate::Counters* work = nullptr;  ///< receives the work done by integrating
  double escape = kEscape;              ///< infinite for multi-turn trials [rad]
  long max_steps = 10'000;   ///< beyond it, and two for each stretch, the constants are too stiff to follow: diverged
  Budget* budget = nullptr;  ///< what is spent is taken from it; once it is empty every rollout diverges
  void validate() const;     ///< throws InputError
};

/// phi_1, phi_m and, where `torque` is asked for, the spring's torque as a sensor logs it, at every sample, with
/// derivatives where T is a Jet (exact through every event: the torque limit is continuous, where a slip ends they
/// jump); a Jet's phi_m and torque stay empty where the trial did not log them. Exact where the rig is linear. A
/// trial's own rig goes before `rig`. On kEscaped or kDiverged the outputs are not complete.
template <class T>
[[nodiscard]] RolloutStatus rollout(const Rig& rig, const SeaParameters<T>& sea, const Nuisance<T>& nuisance,
                                    const PreparedTrial& trial, const RolloutOptions& options, std::vector<T>& phi,
                                    std::vector<T>& phi_m, std::vector<T>* torque = nullptr);

/// `rollout` with the method that the options name, on one kernel for every trial. double or a Jet of kSmallJet.
template <class T>
[[nodiscard]] RolloutStatus roll_with_method(const Rig& rig, const SeaParameters<T>& sea, const Nuisance<T>& nuisance,
                                             const PreparedTrial& trial, const RolloutOptions& options,
                                             std::vector<T>& phi, std::vector<T>& phi_m, std::vector<T>* torque);

/// Derivative slots of the two Jets that are compiled: for the five constants, or with nuisance terms. Even: whole
/// registers.
inline constexpr int kSmallJet = 6, kLargeJet = 16;

}  // namespace ukemi::identify
