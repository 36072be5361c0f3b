// Inputs of the rig in a trial: force, reference and command with the gains, biases, shift and delay applied. Included
// by roll.hpp only.
#pragma once

#include <vector>

#include "identify/rollout/rollout.hpp"

namespace ukemi::identify {

/// `sea` with the gains of Eq. 3 that the drive has: K_t times its own gain, or 0 with a known command.
template <class T>
SeaParameters<T> with_drive_gains(const Drive& drive, SeaParameters<T> sea) {
  if (drive.kind == Drive::Kind::kGains) return sea;
  const bool controller = !drive.known_command();
  sea.k_p = controller ? T(sea.k_t * T(drive.gain)) : T(0), sea.k_d = T(0);
  if (controller && drive.feedback) sea.feedback = *drive.feedback;
  return sea;
}

template <class T>
class RigInput {
  using Segment = PreparedTrial::Segment;

 public:
  RigInput(const Drive& drive, const SeaParameters<T>& sea, const Nuisance<T>& nuisance, const PreparedTrial& trial)
      : known_command_(drive.known_command()),
        nuisance_(nuisance),
        trial_(trial),
        delay_(known_command_ ? sea.control_delay : T(0)),
        shifted_(is_shifted() ? trial.cut(shift(), value_of(delay_)) : std::vector<Segment>()) {}

  /// The trial's segments, with shift and delay applied.
  const std::vector<Segment>& segments() const { return is_shifted() ? shifted_ : trial_.segments; }
  /// Delay of a logged command [s]; a drive in the loop has it in DriveLag.
  const T& delay() const { return delay_; }

  /// A segment's input as it acts on the rig. Segments begin where the shift's value puts them; the force is continuous
  /// there, so only its derivative by the shift remains.
  Excitation<T> driving(const Excitation<double>& e) const {
    const T shift_derivative = nuisance_.time_shift - T(shift());  // value 0
    std::array<T, 4> force;
    bool has_force = false;
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double slope = i + 1 < force.size() ? double(i + 1) * e.force[i + 1] : 0;
      force[i] = nuisance_.force_gain * (T(e.force[i]) - T(slope) * shift_derivative);
      if (i == 0) force[i] += nuisance_.force_bias;
      has_force = has_force || present(force[i]);
    }
    Excitation<T> out = e.with_force(has_force, force);
    if (!known_command_) out.command = 0;  // it is logged, but does not drive
    return out;
  }

 private:
  double shift() const { return value_of(nuisance_.time_shift); }
  /// Whether the segments differ from those of the log.
  bool is_shifted() const { return shift() != 0 || value_of(delay_) != 0; }

  const bool known_command_;
  const Nuisance<T>& nuisance_;
  const PreparedTrial& trial_;
  const T delay_;
  const std::vector<Segment> shifted_;  ///< where the force is shifted or the command delayed
};

}  // namespace ukemi::identify
