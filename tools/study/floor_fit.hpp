// The fit of a floor to drops of any robot: constants that make simulated drops meet the logs of measured ones,
//
//     min sum_d sum_o sum_n ( (sim_do(t_n + s_d) - meas_do(n)) / sigma_o )^2  +  priors,
//
// by identify's bounded least squares. sigma_o is the noise of output o, so that accelerations and poses mix.
//
// The acceleration jumps where a point touches or leaves the floor: a sample of it within one sampling interval of such
// a simulated time is left out, since it shows little but on which side it fell, and its residual jumps as the time
// passes over it. A weight that falls to 0 smoothly, its slope counted, was tried and claims information about weak
// contacts that is not there (mean square of the standardised errors 1.8 instead of 1.3).
//
// No printing, no files: tools/verbs/calibrate.cpp is the verb. Tests: test/regression/calibrate.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/monitor.hpp"
#include "common/verdict.hpp"
#include "identify/trust/profile.hpp"
#include "tools/study/drop_simulator.hpp"
#include "tools/study/promise.hpp"

namespace ukemi::tools {

using identify::Identifiability;

struct CalibrationOptions {
  identify::Terms<DropTerm> terms = drop_choice();  ///< what is fitted
  double accuracy = 1e-9;                           ///< relative tolerance of the rollout
  int restarts = 8;        ///< further starts, drawn about the given one, where the residual stays far above the noise
  std::uint64_t seed = 1;  ///< of those
  int max_iterations = 100;
  /// Up to this multiple of the logs' noise a residual counts as the minimum's: no further start is tried.
  double believed = identify::kFarAboveNoise;
  enum class Parts {
    kGrow,   ///< each drop is fitted part by part, every part a little longer
    kWhole,  ///< at once: where the start is close
  } parts = Parts::kGrow;
  /// Of constants that are not fitted: their standard deviations, >= 0. What they make of the fitted ones counts in
  /// all errors and verdicts (identify::Considered).
  std::vector<std::pair<std::string, double>> errors;
  std::vector<std::string> profiles;  ///< constants whose likelihood profile is made; each must be fitted
  Monitor monitor;        ///< progress in the fit's parts; where it stops, the last part that was done is kept
  void validate() const;  ///< throws InputError
};

/// One drop, simulated, and its log.
struct DropResult {
  std::string file;
  bool simulated = false;                        ///< false: the run failed; nothing below holds
  std::vector<std::vector<double>> value;        ///< as DropLog::output, NaN where not measured
  std::vector<std::vector<bool>> used;           ///< false: not measured, or left out
  std::vector<double> rms;                       ///< of sim - meas, where used; NaN: not measured
  std::vector<double> jumps;                     ///< touchdowns and lift-offs of the simulation, at the log's times [s]
  std::vector<landing::ContactChange> changes;   ///< see FollowedDrop
  double peak_measured = 0, peak_simulated = 0;  ///< largest acceleration at the log's samples [m/s^2]; NaN: none
  double peak_between = 0;                       ///< the simulated one over all times up to the log's end [m/s^2]
};

/// The constants of a floor, and the nuisance terms drop by drop.
struct FloorFit : identify::Estimates {
  LogsOf logs_of = LogsOf::kDrops;
  /// What the residuals say against the floor: see fit_floor. Nothing of validate_floor.
  identify::ResidualTests tests;
  std::vector<landing::DropChannel> channels;
  std::vector<double> noise;  ///< sigma_o of the logs themselves; NaN: not measured
  std::vector<double> rms;    ///< over all drops; `cost` is the sum above, with sigma_o = rms
  std::vector<DropResult> drops;
  std::vector<Promise> promises;            ///< of each drop that was predicted; empty: of none
  std::vector<identify::Profile> profiles;  ///< as asked for, of constants that have a standard error
  long steps = 0;                           ///< integrated for the fit

  Verdicts verdicts() const;  ///< of every constant
  /// Uncertainty of the fitted constants, as far as it is known; with `among` of those alone.
  std::optional<Uncertainty> uncertainty(const std::vector<std::string>* among = nullptr) const;
};

/// Throws InputError where there is no drop, and where one has no measured value or ends before its first touchdown.
void check_logs(const DropSimulator& drops);

/// Fits the constants to the drops, from those of the simulator's scene. The residuals then test the floor as those of
/// trials test a rig: they are white, ask for no term of the table that was not fitted (a constant that is held: at
/// another value), and no drop asks for constants of its own. Where they speak up the floor is rejected: errors are
/// widened (identify::widen_errors) and nothing is trusted. Throws InputError as check_logs; never throws on numbers:
/// see Estimates::converged.
[[nodiscard]] FloorFit fit_floor(const DropSimulator& drops, const CalibrationOptions& options);

/// The drops for the simulator's constants. The nuisance terms, which are each drop's own, are fitted to it; no
/// constant is.
[[nodiscard]] FloorFit validate_floor(const DropSimulator& drops, const CalibrationOptions& options);

/// Fisher information of the fitted terms, drop by drop, at the simulator's constants, for residuals of standard
/// deviation `sigma` in each channel; the drop's own nuisance terms eliminated, which stand where `own` says, else
/// absent. Rows as DropLayout::shared: the free constants come first. Empty for a drop that cannot be followed.
[[nodiscard]] std::vector<Eigen::MatrixXd> informations(const DropSimulator& drops, const CalibrationOptions& options,
                                                        const std::vector<double>& sigma,
                                                        const std::vector<identify::Estimate>& own);

/// rms of a drop's residuals, in units of the outputs' noise, under the constants fitted to all others from those of
/// the simulator's scene, its own nuisance terms fitted: the median over the drops, since one of them alone may fix a
/// constant. NaN where a drop cannot be followed. Two drops at least.
[[nodiscard]] double held_out(const DropSimulator& drops, const CalibrationOptions& options);

}  // namespace ukemi::tools
