// One logged trial in SI units, with the checks that a log must pass.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "identify/rig/rig.hpp"

namespace ukemi::identify {

/// A log. Every column has as many samples as `t`, or none where the log lacks it; a force of its own clock has as many
/// as `force_t`.
struct Trial {
  std::string file;
  std::vector<double> t;          ///< [s], increasing, within 1e5 s of 0; see count_from_first
  double t_origin = 0;            ///< what the log's clock read at t = 0 [s]
  std::vector<double> phi;        ///< measured output angle [rad]
  std::vector<double> force;      ///< at the link's tip, along +y [N]; see force_smooth
  std::vector<double> force_t;    ///< the force's own sample times on the clock of `t` [s], increasing; empty: `t`
  std::vector<double> phi_ref;    ///< reference [rad]; held from sample to sample, linear where dphi_ref is given
  std::vector<double> dphi_ref;   ///< [rad/s]; linear between samples
  std::vector<double> phi_motor;  ///< measured motor angle at the gear's output side [rad]
  std::vector<double> command;    ///< command of the motor [V, A or Nm]; held from sample to sample
  std::vector<double> torque;     ///< measured torque of the spring, as it turns the output [Nm]
  std::optional<Rig> rig = {};    ///< the trial's own rig; absent: that of all trials
  double force_smooth = 0;  ///< between its samples the force is 0: linear, 1: a smooth curve; see force_curve.hpp
  double force_noise = 0;   ///< standard deviation of each sample of the force within hits [N]; see hits.hpp
  double force_rest = 0;    ///< reading of the load cell between hits, where estimated [N]
  std::vector<std::string> notes;  ///< what was handled and counted while reading, a sentence each

  std::size_t samples() const { return t.size(); }
  /// The rig that it was logged on: its own, else `common`.
  const Rig& rig_or(const Rig& common) const { return rig ? *rig : common; }
  /// The outputs that a fit compares; those that were not logged are empty.
  std::array<const std::vector<double>*, 3> measured() const { return {&phi, &phi_motor, &torque}; }
  /// Number of samples of the measured outputs.
  std::size_t measurements() const { return phi.size() + phi_motor.size() + torque.size(); }
  /// The time of the file's clock at t = `at`, to a microsecond, "1700000000.25" [s].
  std::string clock_time(double at) const;
  void validate() const;  ///< throws InputError naming the file, the column and the sample
};
/// Shifts t, force_t and t_origin so that the first sample is at t = 0: a recorder's clock may count from 1970.
void count_from_first(Trial& trial);

/// How a file's columns become a Trial.
struct TrialOptions {
  std::string columns;      ///< "t=Time,phi=-defl_deg,force=0.001*Fy,...": name here = scale * name there
  bool require_phi = true;  ///< false: for prediction
  enum class Force { kInFile, kElsewhere } force = Force::kInFile;       ///< kElsewhere: a separate log holds it
  enum class Angles { kOneTurn, kMultiTurn } angles = Angles::kOneTurn;  ///< kOneTurn refuses |angle| > 2 pi
  double gear_ratio = 1;                                                 ///< divides phi_motor
};

/// Reads a trial file (CSV). Columns by name: t, phi, force, phi_ref, dphi_ref, phi_motor, command, torque, dphi,
/// dphi_motor; unit suffixes convert (see Quantity). Where an angle was not logged but its rate was, the angle is the
/// rate's running sum. Times count from the first row (t_origin). A column name that is wrong only in its case is an
/// error where no other holds the quantity; one that resembles a missing quantity is noted. Throws InputError with
/// file:line:column on whatever read_csv refuses, on a missing column (nearest name given), fewer than two rows, an
/// empty cell, a time_fault, and an angle beyond 2 pi unless multi-turn.
Trial read_trial(const std::string& path, const TrialOptions& options = {});

}  // namespace ukemi::identify
