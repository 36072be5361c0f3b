// Calibration: the floor's constants and the pitch that make simulated drops meet the logs of measured ones,
//
//     min sum_d sum_o sum_n ( (sim_do(t_n + s_d) - meas_do(n)) / sigma_o )^2  +  priors,
//
// over U = [K_f C_fy C_fx phi_0], with exact derivatives through the touchdowns (landing/drops/drop_rollout.hpp) and
// identify's bounded least squares. sigma_o is the noise of output o, so that accelerations and poses mix.
//
// ddr_0 jumps where a point touches or leaves the floor: a sample of it within one sampling interval of such a
// simulated time is left out, for it tells little but on which side it fell, and its residual jumps as the time passes
// over it. A weight that falls to 0 smoothly, its slope counted, was tried and claims information about weak contacts
// that is not there (mean square of the standardised errors 1.8 instead of 1.3).
//
// No printing, no files: tools/verbs/calibrate.cpp is the verb. Tests: test/regression/calibrate.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/monitor.hpp"
#include "identify/trust/diagnostics.hpp"
#include "landing/drops/drop_log.hpp"
#include "tools/study/drop_terms.hpp"

namespace ukemi::tools {

using identify::Identifiability;

/// One drop: its log and how it was played and thrown.
struct LoggedDrop {
  landing::DropLog log;
  landing::Motion motion;
  landing::Drop thrown;  ///< its pitch is the scene's, whatever stands here
};

struct CalibrationOptions {
  identify::Terms<DropTerm> terms = drop_choice();  ///< what is fitted
  double accuracy = 1e-9;                           ///< relative tolerance of the rollout
  int restarts = 8;        ///< further starts, drawn about the given one, where the residual stays far above the noise
  std::uint64_t seed = 1;  ///< of those
  int max_iterations = 100;
  Monitor monitor;        ///< told of the fit's parts; where it stops, the last part that was done is kept
  void validate() const;  ///< throws InputError
};

/// One drop, simulated beside its log.
struct DropResult {
  std::string file;
  bool simulated = false;                                    ///< false: the run failed; nothing below holds
  std::array<std::vector<double>, landing::kOutputs> value;  ///< as DropLog::output, NaN where not measured
  std::array<std::vector<bool>, landing::kOutputs> used;     ///< false: not measured, or left out
  std::array<double, landing::kOutputs> rms{};               ///< of sim - meas, where used; NaN: not measured
  std::vector<double> jumps;                     ///< touchdowns and lift-offs of the simulation, at the log's times [s]
  double peak_measured = 0, peak_simulated = 0;  ///< largest |ddr_0| at the log's samples [m/s^2]; NaN: not measured
  double peak_between = 0;                       ///< the simulated one over all times up to the log's end [m/s^2]
};

/// The four constants, and the nuisance terms drop by drop.
struct Calibration : identify::Estimates {
  landing::Scene scene;  ///< the given one with the fitted constants, their covariance and verdicts
  /// What the residuals say against the floor: see calibrate. Nothing of `validate`.
  identify::ResidualTests tests;
  std::array<double, landing::kOutputs> noise{};  ///< sigma_o of the logs themselves; NaN: not measured
  std::array<double, landing::kOutputs> rms{};    ///< over all drops; `cost` is the sum above, with sigma_o = rms
  std::vector<DropResult> drops;
  long steps = 0;  ///< integrated for the fit
};

/// Drops and what became of them.
struct CalibratedDrops {
  std::vector<LoggedDrop> drops;
  Calibration result;
};

/// Throws InputError where the scene lacks a floor or contacts, where there is no drop, and where one has no measured
/// value or ends before its first touchdown.
void check_drops(const landing::Scene& scene, const std::vector<LoggedDrop>& drops);

/// Fits the constants of `scene` to the drops. The residuals then test the floor as those of trials test a rig: they
/// are white, ask for no term of the table that was not fitted (a constant that is held: at another value), and no drop
/// asks for constants of its own. Where they speak up the floor is rejected: errors are widened
/// (identify::widen_errors) and nothing is trusted. Throws InputError as check_drops; never throws on numbers: see
/// Calibration::converged.
[[nodiscard]] Calibration calibrate(const landing::Scene& scene, const SeaParameters<double>& sea,
                                    const std::vector<LoggedDrop>& drops, const CalibrationOptions& options = {});

/// The drops for given constants. The nuisance terms, which are each drop's own, are fitted to it; no constant is.
[[nodiscard]] Calibration validate(const landing::Scene& scene, const SeaParameters<double>& sea,
                                   const std::vector<LoggedDrop>& drops, const CalibrationOptions& options = {});

}  // namespace ukemi::tools
