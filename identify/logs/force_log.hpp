// A force measured by another instrument, in a separate file and perhaps on a separate clock.
#pragma once

#include <string>
#include <vector>

#include "identify/logs/trial.hpp"
#include "identify/rig/rig.hpp"

namespace ukemi::identify {

struct ForceLog {
  std::string file;
  std::vector<double> t;      ///< [s], increasing, 0 at the first row
  std::vector<double> force;  ///< at the link's tip, along +y [N]
  double t_origin = 0;        ///< what the log's clock read at t = 0 [s]
  void validate() const;      ///< throws InputError
};

/// Reads a force log (CSV): t and force, by name or by `columns` ("t=Time,force=-Fy"), suffixes as in a trial. Throws
/// InputError with file:line:column as read_trial does.
ForceLog read_force_log(const std::string& path, const std::string& columns = {});

/// kShared: both files count time from the same instant; kOwn: the force's clock is shifted onto the trial's.
enum class ForceClock { kShared, kOwn };

/// Gives `trial` the force of a log; returns the shift from the log's clock to the trial's, both as in the files [s];
/// 0 with kShared.
///
/// kOwn aligns the onsets coarsely: a free link, M ddphi_1 = l F_e (Eq. 5 right after the hit), reaches a small angle
/// some time after the onset of the force; the shift makes it reach that angle when the measured one does. Accurate to
/// about a sample: fit the remainder. Notes what the force does not cover, and a reference that moves too.
///
/// Throws InputError: a trial that has a force already; logs that do not overlap (both ranges named); with kOwn, a
/// force that is 0 throughout and an angle that never leaves its rest.
double attach_force(Trial& trial, const ForceLog& log, const Rig& rig, ForceClock clock);

}  // namespace ukemi::identify
