// What drives the rig in a trial: its force, reference and command as gains, biases, shift and delay have them.
// Included by roll.hpp, by no other.
#pragma once

#include <vector>

#include "identify/rollout/rollout.hpp"

namespace ukemi::identify {

/// Eq. 3 as the drive has it: with its own gain, or not at all.
template <class T>
SeaParameters<T> driven_by(const Drive& drive, SeaParameters<T> sea) {
  if (drive.kind == Drive::Kind::kGains) return sea;
  const bool controller = !drive.by_command();
  sea.k_p = controller ? T(sea.k_t * T(drive.gain)) : T(0), sea.k_d = T(0);
  if (controller && drive.feedback) sea.feedback = *drive.feedback;
  return sea;
}

template <class T>
class RigInput {
  using Stretch = PreparedTrial::Stretch;

 public:
  RigInput(const Drive& drive, const SeaParameters<T>& sea, const Nuisance<T>& nuisance, const PreparedTrial& trial)
      : by_command_(drive.by_command()),
        nuisance_(nuisance),
        trial_(trial),
        delay_(by_command_ ? sea.control_delay : T(0)),
        shifted_(moved() ? trial.cut(shift(), value_of(delay_)) : std::vector<Stretch>()) {}

  /// The trial's cuts, where shift and delay put them.
  const std::vector<Stretch>& stretches() const { return moved() ? shifted_ : trial_.stretches; }
  /// Of a logged command; that of a drive in the loop is the system's [s].
  const T& delay() const { return delay_; }

  /// A cut's input as it drives the rig. The cuts stand where the shift's value puts them; the force is continuous
  /// there, so its derivative by the shift is all there is.
  Excitation<T> driving(const Excitation<double>& e) const {
    const T delay = nuisance_.time_shift - T(shift());
    std::array<T, 4> force;
    bool pushed = false;
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double next = i + 1 < force.size() ? double(i + 1) * e.force[i + 1] : 0;
      force[i] = nuisance_.force_gain * (T(e.force[i]) - T(next) * delay);
      if (i == 0) force[i] += nuisance_.force_bias;
      pushed = pushed || present(force[i]);
    }
    Excitation<T> out = e.with_force(pushed, force);
    if (!by_command_) out.command = 0;  // it is logged, but does not drive
    return out;
  }

 private:
  double shift() const { return value_of(nuisance_.time_shift); }
  /// Whether the trial's cuts are not where its log has them.
  bool moved() const { return shift() != 0 || value_of(delay_) != 0; }

  const bool by_command_;
  const Nuisance<T>& nuisance_;
  const PreparedTrial& trial_;
  const T delay_;
  const std::vector<Stretch> shifted_;  ///< where the force is shifted or the command is late
};

}  // namespace ukemi::identify
