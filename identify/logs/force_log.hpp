// A force measured by another instrument: a file, and perhaps a clock, of its own.
#pragma once

#include <string>
#include <vector>

#include "identify/logs/trial.hpp"
#include "identify/rig/rig.hpp"

namespace ukemi::identify {

struct ForceLog {
  std::string file;
  std::vector<double> t;      ///< [s], increasing, from the first row on
  std::vector<double> force;  ///< at the link's tip, along +y [N]
  double t_origin = 0;        ///< what the log's clock read at t = 0 [s]
  void validate() const;      ///< throws InputError
};

/// Reads a force log (CSV): t and force, by name or by `columns` ("t=Time,force=-Fy"), suffixes as in a trial. Throws
/// InputError with file:line:column as read_trial does.
ForceLog read_force_log(const std::string& path, const std::string& columns = {});

/// kShared: both files count time from the same instant; kOwn: the force's clock is shifted onto the trial's.
enum class ForceClock { kShared, kOwn };

/// Gives `trial` the force of a log; returns by how much the log's clock is moved onto the trial's [s],
/// both as the files have them; 0 with kShared.
///
/// kOwn aligns coarsely, onset to onset: a link that no torque holds yet, M ddphi_1 = l F_e (Eq. 5 right after the
/// hit), leaves its rest by a small angle some time after the force begins; the shift is what makes it leave when the
/// measured angle does. Good to a sample or so: fit the rest of it. Notes what the force does not cover, and a
/// reference that moves too.
///
/// Throws InputError: a trial that has a force already; logs that do not overlap (both ranges named); with kOwn, a
/// force that is 0 throughout and an angle that never leaves its rest.
double attach_force(Trial& trial, const ForceLog& log, const Rig& rig, ForceClock clock);

}  // namespace ukemi::identify
