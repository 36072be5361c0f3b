// Output of a rollout: the angles and, where requested, the torque, as encoders and a sensor log them, at each sample
// of a trial. Included by roll.hpp only.
#pragma once

#include <cmath>
#include <vector>

#include "common/jet.hpp"
#include "common/scalar.hpp"
#include "identify/logs/trial.hpp"
#include "identify/rollout/nuisance.hpp"

namespace ukemi::identify {

/// Allowed range of phi_1: less than `escape` from the start [rad].
struct EscapeBounds {
  double start, escape;

  bool contain(double angle) const { return std::abs(angle - start) < escape; }
  /// kDone while `angle` is within the bounds.
  RolloutStatus status(double angle) const {
    if (contain(angle)) return RolloutStatus::kDone;
    return std::isfinite(angle) ? RolloutStatus::kEscaped : RolloutStatus::kDiverged;
  }
};

/// Fills `phi`, `phi_m` and `torque` in the order of the trial's samples. A Jet's phi_m and torque stay empty where the
/// trial did not log them.
template <class System, class T>
class Recorder {
 public:
  using State = typename System::State;

  Recorder(const System& system, const Nuisance<T>& nuisance, const Trial& trial, std::vector<T>& phi,
           std::vector<T>& phi_m, std::vector<T>* torque)
      : system_(system),
        nuisance_(nuisance),
        t_(trial.t),
        has_motor_(kDerivatives<T> == 0 || !trial.phi_motor.empty()),
        phi_(phi),
        phi_m_(phi_m),
        torque_(kDerivatives<T> == 0 || !trial.torque.empty() ? torque : nullptr) {}

  /// Allocates all samples, and records the first.
  void begin(const State& y) {
    phi_.resize(t_.size()), phi_m_.resize(has_motor_ ? t_.size() : 0);
    if (torque_) torque_->resize(t_.size());
    next_ = 0;
    record(y);
  }
  /// Whether the next sample is not after `t_end` [s]; its time [s].
  bool due(double t_end) const { return next_ < t_.size() && t_[next_] <= t_end; }
  double time() const { return t_[next_]; }

  /// Records the next sample from the state y.
  void record(const State& y) {
    phi_[next_] = y[System::kPhi] + nuisance_.encoder_offset;
    if (has_motor_) phi_m_[next_] = y[System::kPhiM];
    record_torque(next_, y);
    ++next_;
  }

  /// Records the samples within the driver's last step; that at its end only where it has `reached` `t_end`.
  template <class Driver>
  void record_step(Driver& driver, double t_end, bool reached) {
    const double end = driver.time();
    while (next_ < t_.size() && (reached ? t_[next_] <= t_end : t_[next_] < end)) {
      if (t_[next_] == t_end) {
        record(driver.state());
        continue;
      }
      const auto& step = driver.dense();
      const double s = step.place_of(t_[next_]);
      phi_[next_] = step.component_at(System::kPhi, s) + nuisance_.encoder_offset;
      if (has_motor_) phi_m_[next_] = step.component_at(System::kPhiM, s);
      if (torque_) {
        State y;
        for (int i = 0; i < System::kStates; ++i) y[i] = step.component_at(i, s);
        record_torque(next_, y);
      }
      ++next_;
    }
  }

  /// How many of the next samples are at t + k spacing, within `off_grid` intervals; at most a block, and to `t_end`.
  int on_grid(double t, double t_end, double spacing, double off_grid, int block) const {
    const int max_samples = torque_ ? 1 : block;  // a block gives the angles of its samples, not their rates
    int n = 0;
    while (n < max_samples && next_ + std::size_t(n) < t_.size() && t_[next_ + std::size_t(n)] <= t_end &&
           std::abs(t_[next_ + std::size_t(n)] - t - (n + 1) * spacing) <= off_grid * spacing)
      ++n;
    return n;
  }
  /// Records the next n samples, without their torque, by the flow from z about `rest`. Stops at an angle out of
  /// bounds, with its status.
  template <class Flow>
  RolloutStatus record_block(const Flow& flow, const T& rest, const State& z, int n, const EscapeBounds bounds) {
    const T offset = rest + nuisance_.encoder_offset;
    T* const phi = &phi_[next_];
    T* const phi_m = has_motor_ ? &phi_m_[next_] : nullptr;
    next_ += std::size_t(n);
    for (int j = 0; j < n; ++j) {
      flow.angle(phi[j], offset, 0, j, z);
      if (phi_m) flow.angle(phi_m[j], rest, 1, j, z);
      if (!bounds.contain(value_of(phi[j]))) return bounds.status(value_of(phi[j]));
    }
    return RolloutStatus::kDone;
  }
  /// Time of the last recorded sample [s]; records its torque from the state y.
  double last_time() const { return t_[next_ - 1]; }
  void record_last_torque(const State& y) { record_torque(next_ - 1, y); }
  bool has_torque() const { return torque_ != nullptr; }

  /// Applies the gain of the link's encoder.
  void finish() {
    if (const T& gain = nuisance_.encoder_gain; present(T(gain - T(1))))
      for (T& x : phi_) x = gain * (x - nuisance_.encoder_offset) + nuisance_.encoder_offset;
  }

 private:
  void record_torque(std::size_t sample, const State& y) {
    if (torque_) (*torque_)[sample] = nuisance_.torque_gain * system_.spring_on_output(y) + nuisance_.torque_bias;
  }

  const System& system_;
  const Nuisance<T>& nuisance_;
  const std::vector<double>& t_;
  const bool has_motor_;  ///< phi_m is recorded
  std::vector<T>&phi_, &phi_m_;
  std::vector<T>* const torque_;  ///< null: not recorded
  std::size_t next_ = 0;          ///< index of the sample to be recorded next
};

}  // namespace ukemi::identify
