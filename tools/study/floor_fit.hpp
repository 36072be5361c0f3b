// The fit of a floor to drops of any robot: constants that minimise the residuals of simulated against logged drops,
//
//     min sum_d sum_o sum_n ( (sim_do(t_n + s_d) - meas_do(n)) / sigma_o )^2  +  priors,
//
// by identify's bounded least squares. sigma_o is the noise of output o, which weighs accelerations against poses.
//
// The acceleration jumps where a point touches or leaves the floor: its samples within one sampling interval of such a
// simulated time are left out, since they mainly show on which side of the jump they lie, and their residuals jump as
// the time passes them. A weight that falls smoothly to 0, with its derivative, claims information about weak contacts
// that is not there (mean square of the standardised errors 1.8 instead of 1.3).
//
// No printing, no files: tools/verbs/calibrate.cpp is the verb. Tests: test/regression/calibrate.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/monitor.hpp"
#include "common/verdict.hpp"
#include "identify/trust/profile.hpp"
#include "tools/study/drop_simulator.hpp"
#include "tools/study/promise.hpp"

namespace ukemi::tools {

using identify::Identifiability;

struct CalibrationOptions {
  identify::Terms<DropTerm> terms = drop_choice();  ///< the free ones are fitted
  double accuracy = 1e-9;                           ///< relative tolerance of the rollout
  int restarts = 8;        ///< further starts, drawn about the given one, where the residual stays far above the noise
  std::uint64_t seed = 1;  ///< of the restarts
  int max_iterations = 100;
  /// A residual up to this multiple of the logs' noise is accepted as the minimum: no further start is tried.
  double believed = identify::kFarAboveNoise;
  enum class Parts {
    kGrow,   ///< drops are fitted up to growing horizons, see DropSimulator::horizons
    kWhole,  ///< whole drops at once: where the start is close
  } parts = Parts::kGrow;
  /// Standard deviations, >= 0, of terms that are not fitted. Their effect on the fitted ones counts in all errors
  /// and verdicts (identify::Considered).
  std::vector<std::pair<std::string, double>> errors;
  std::vector<std::string> profiles;  ///< constants whose likelihood profile is made; each must be fitted
  Monitor monitor;                    ///< progress in the fit's parts; when it stops, the last complete part is kept
  void validate() const;              ///< throws InputError
};

/// One drop: its log, the motion that was played, and its initial conditions.
template <class Motion>
struct LoggedDropOf {
  landing::DropLog log;
  Motion motion;
  landing::Drop thrown;  ///< the pitch is ignored: the scene's counts
};

/// A simulated drop against its log.
struct DropResult {
  std::string file;
  bool simulated = false;                        ///< false: the simulation failed; what follows is not valid
  std::vector<std::vector<double>> value;        ///< as DropLog::output, NaN where not measured
  std::vector<std::vector<bool>> used;           ///< false: not measured, or left out
  std::vector<double> rms;                       ///< of sim - meas, where used; NaN: not measured
  std::vector<double> jumps;                     ///< touchdowns and lift-offs of the simulation, at the log's times [s]
  std::vector<landing::ContactChange> changes;   ///< see FollowedDrop
  double peak_measured = 0, peak_simulated = 0;  ///< largest acceleration at the log's samples [m/s^2]; NaN: none
  double peak_between = 0;  ///< largest simulated acceleration up to the log's end, between samples too [m/s^2]
};

/// The constants of a floor, and the nuisance terms of each drop.
struct FloorFit : identify::Estimates {
  LogsOf logs_of = LogsOf::kDrops;
  /// Tests of the floor by the residuals, see fit_floor; empty after validate_floor.
  identify::ResidualTests tests;
  std::vector<landing::DropChannel> channels;
  std::vector<double> noise;  ///< sigma_o of the logs themselves; NaN: not measured
  std::vector<double> rms;    ///< over all drops; `cost` is the sum above, with sigma_o = rms
  std::vector<DropResult> drops;
  std::vector<PredictionBands> bands;       ///< of each predicted drop; empty: none
  std::vector<identify::Profile> profiles;  ///< the requested ones, of constants with a standard error
  long steps = 0;                           ///< integrated for the fit

  Verdicts verdicts() const;  ///< of every constant
  /// Uncertainty of the fitted constants, as far as it is known; with `among` only of these.
  std::optional<Uncertainty> uncertainty(const std::vector<std::string>* among = nullptr) const;
};

/// Throws InputError where the scene has no floor or no contacts.
template <class Scene>
void check_floor(const Scene& scene) {
  if (!scene.touches())
    throw InputError("the scene has no [floor] or no contacts: both are needed, the floor's constants as a start");
}
/// Throws InputError where there is no drop, or one has no measured value or ends before its first touchdown.
void check_logs(const DropSimulator& drops);

/// Fits the constants to the drops, started at those of the simulator's scene. The residuals then test the floor as
/// those of trials test a rig: whether they are white, whether a term of the table that was not fitted would explain
/// them (a constant: at another value), and whether a drop needs constants of its own. Where a test fails the floor is
/// rejected: errors are widened (identify::widen_errors) and no constant is trusted. Throws InputError as check_logs;
/// numerical failure is reported by Estimates::converged.
[[nodiscard]] FloorFit fit_floor(const DropSimulator& drops, const CalibrationOptions& options);

/// Simulates the drops with the simulator's constants. Only the nuisance terms of each drop are fitted to it.
[[nodiscard]] FloorFit validate_floor(const DropSimulator& drops, const CalibrationOptions& options);

/// Fisher information of the fitted terms from each drop, at the simulator's constants, for residuals of standard
/// deviation `sigma` in each channel. The drop's nuisance terms, at the values in `nuisance` or without effect, are
/// eliminated. Rows as DropLayout::shared: the free constants first. Empty for a drop that cannot be simulated.
[[nodiscard]] std::vector<Eigen::MatrixXd> drop_information(const DropSimulator& drops,
                                                            const CalibrationOptions& options,
                                                            const std::vector<double>& sigma,
                                                            const std::vector<identify::Estimate>& nuisance);

/// Leave-one-out error: the rms of a drop's residuals, in units of the outputs' noise, under constants fitted to the
/// other drops, its nuisance terms fitted to itself. The median over the drops, since a single one may determine a
/// constant. NaN where a drop cannot be simulated. At least two drops.
[[nodiscard]] double held_out(const DropSimulator& drops, const CalibrationOptions& options);

}  // namespace ukemi::tools
