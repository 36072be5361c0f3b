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
#include "identify/fit/fit.hpp"
#include "landing/drops/drop_log.hpp"

namespace ukemi::tools {

using identify::Verdict;

/// What a calibration may fit: constants, one for all drops, and nuisance terms, each drop its own.
enum class Term {
  kStiffness,          ///< K_f [N/m], > 0
  kDampingNormal,      ///< C_fy [N/(m/s)], >= 0
  kDampingTangential,  ///< C_fx [N/(m/s)], >= 0
  kPitch,              ///< phi_0 at release [rad]
  kTimeShift,          ///< s_d: the log's t = 0 is s_d after the release [s], within kLargestShift
  kHeightOffset,       ///< added to the drop's height [m]
  kSpeedOffset,        ///< added to its forward speed [m/s]
  kPitchOffset,        ///< added to its pitch [rad]
};
inline constexpr int kCalibrated = 4, kTerms = 8;
inline constexpr std::array<const char*, kTerms> kTermNames = {"stiffness",    "damping_normal", "damping_tangential",
                                                               "pitch",        "time_shift",     "height_offset",
                                                               "speed_offset", "pitch_offset"};
inline constexpr std::array<const char*, kTerms> kTermUnits = {"N/m", "N/(m/s)", "N/(m/s)", "rad",
                                                               "s",   "m",       "m/s",     "rad"};
inline constexpr double kLargestShift = 0.02;  ///< [s]; with kTimeShift, samples before it are left out

/// One drop: its log and how it was played and thrown.
struct LoggedDrop {
  landing::DropLog log;
  landing::Motion motion;
  landing::Drop thrown;  ///< its pitch is the scene's, whatever stands here
};

/// A term is known beforehand: normal about `value` with standard deviation `std`, > 0, in the term's unit.
struct Prior {
  Term term;
  double value, std;
};

struct CalibrationOptions {
  std::vector<Term> free = {Term::kStiffness, Term::kDampingNormal, Term::kDampingTangential, Term::kPitch};
  std::vector<Term> nuisance;  ///< none, or of kTimeShift .. kPitchOffset
  std::array<double, kCalibrated> lower{0, 0, 0, -3.141592653589793};
  std::array<double, kCalibrated> upper{kInfinity, kInfinity, kInfinity, 3.141592653589793};
  std::vector<Prior> priors;
  double accuracy = 1e-9;  ///< relative tolerance of the rollout
  int restarts = 8;        ///< further starts, drawn about the given one, where the residual stays far above the noise
  std::uint64_t seed = 1;  ///< of those
  int max_iterations = 100;
  Monitor monitor;        ///< told of the fit's parts; where it stops, the last part that was done is kept
  void validate() const;  ///< throws InputError

  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
};

/// A pitch is judged against at least this: its zero is a convention [rad].
inline constexpr double kPitchSize = 0.17453292519943295;

/// One drop, simulated beside its log.
struct DropResult {
  std::string file;
  bool simulated = false;                                    ///< false: the run failed; nothing below holds
  std::array<std::vector<double>, landing::kOutputs> value;  ///< as DropLog::output, NaN where not measured
  std::array<std::vector<bool>, landing::kOutputs> used;     ///< false: not measured, or left out
  std::array<double, landing::kOutputs> rms{};               ///< of sim - meas, where used; NaN: not measured
  double peak_measured = 0, peak_simulated = 0;  ///< largest |ddr_0| at the log's samples [m/s^2]; NaN: not measured
  double peak_between = 0;                       ///< the simulated one over all times up to the log's end [m/s^2]
};

struct Calibration {
  landing::Scene scene;                           ///< the given one with the fitted constants
  std::vector<identify::Estimate> parameters;     ///< the four constants
  std::vector<identify::Estimate> nuisance;       ///< drop by drop
  std::vector<std::string> fitted;                ///< order of `covariance`
  Eigen::MatrixXd covariance, correlation;        ///< NaN where not determined
  Eigen::VectorXd eigenvalues;                    ///< of the scaled information, ascending, largest 1
  std::array<double, landing::kOutputs> noise{};  ///< sigma_o of the logs themselves; NaN: not measured
  std::array<double, landing::kOutputs> rms{};    ///< over all drops
  double cost = 0;                                ///< the sum above, with sigma_o = rms
  double half_width = 1.96;                       ///< 95 % interval in standard errors
  bool converged = false;
  int iterations = 0, starts = 0;
  std::string message;  ///< why it did not converge, or that it was interrupted
  std::vector<std::string> warnings;
  std::vector<DropResult> drops;

  bool trusted() const;  ///< every fitted constant is
};

/// Throws InputError where the scene lacks a floor or contacts, where there is no drop, and where one has no measured
/// value or ends before its first touchdown.
void check_drops(const landing::Scene& scene, const std::vector<LoggedDrop>& drops);

/// Fits the constants of `scene` to the drops. Throws InputError as check_drops; never throws on numbers: see
/// Calibration::converged.
[[nodiscard]] Calibration calibrate(const landing::Scene& scene, const SeaParameters<double>& sea,
                                    const std::vector<LoggedDrop>& drops, const CalibrationOptions& options = {});

/// The drops for given constants. The nuisance terms, which are each drop's own, are fitted to it; no constant is.
[[nodiscard]] Calibration validate(const landing::Scene& scene, const SeaParameters<double>& sea,
                                   const std::vector<LoggedDrop>& drops, const CalibrationOptions& options = {});

}  // namespace ukemi::tools
