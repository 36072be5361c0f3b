// One module of a HEBI log as a trial.
#pragma once

#include <optional>
#include <string>

#include "identify/logs/hebilog.hpp"
#include "identify/logs/trial.hpp"

namespace ukemi::identify {

struct HebiTrialOptions {
  std::string module;  ///< name, "family/name", or number from 1; may be empty where the log has one module
  TrialOptions::Angles angles = TrialOptions::Angles::kOneTurn;
  std::optional<double> gear_ratio;  ///< divides the motor's position; without it phi_motor stays empty
  /// kTorque: the module's effort is the trial's torque. It is the module's own spring constant times the deflection:
  /// it determines K_SEA only as well as that constant is right.
  enum class Effort { kIgnored, kTorque } effort = Effort::kIgnored;
};

/// phi: position; phi_ref: position command, held at the first position before the first command and over gaps in it;
/// phi_motor: motor position / gear ratio, its zero (where the module was switched on) moved so that the median of
/// phi_motor - phi is 0. Defects of real logs are handled and counted in Trial::notes: samples without time or position
/// and duplicate stamps (closer than a tenth of the nominal interval) dropped, stamps that go back by up to 1 s sorted,
/// gaps (longer than 3 nominal intervals) kept. Throws InputError naming the file: a module that is missing (the error
/// lists them) or that several share, fewer than two samples, a stamp further back, an angle beyond 2 pi unless
/// multi-turn, and a requested effort that is missing.
Trial hebi_trial(const HebiLog& log, const HebiTrialOptions& options);

/// The module that `module` names among those with samples; throws as hebi_trial.
const HebiModule& choose_module(const HebiLog& log, const std::string& module);

}  // namespace ukemi::identify
