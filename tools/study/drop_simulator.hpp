// Simulated drops of a robot as a function of the fitted terms: the interface of the fit of a floor to the robot.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "landing/driven/contact_change.hpp"
#include "landing/drops/drop_log.hpp"
#include "landing/run/simulate.hpp"
#include "tools/study/drop_terms.hpp"

namespace ukemi::tools {

/// A term and its value; in Settings constants come first, since a nuisance term is added to one.
struct Setting {
  const DropTerm* term;
  double value;
};
using Settings = std::vector<Setting>;

/// A drop, simulated at given times.
struct FollowedDrop {
  std::vector<std::vector<double>> value;  ///< of each channel at each time
  /// Derivatives of each channel's values, times x settings; empty: not computed yet.
  std::vector<Eigen::MatrixXd> slope;
  std::vector<double> jumps;                    ///< times of touchdowns and lift-offs from release [s], in order
  std::vector<landing::ContactChange> changes;  ///< of a robot driven by its log, times from its first row [s]
  bool complete = false;                        ///< there are values at every time
  long steps = 0;                               ///< integrated, taken or rejected
};

/// What the logs are of.
enum class LogsOf { kDrops, kTrials };
/// The words of a fit's messages; `hint`: what to check where no start is close.
struct FitWords {
  const char *one, *many, *model, *title, *next, *hint;
};
constexpr FitWords words(LogsOf logs) {
  if (logs == LogsOf::kTrials)
    return {.one = "trial",
            .many = "trials",
            .model = "robot",
            .title = "Identification of a robot",
            .next = "`ukemi predict LOG --robot robot.toml` says whether it holds on another log.",
            .hint = "are the columns' signs and units right, are the robot's constants near?"};
  return {.one = "drop",
          .many = "drops",
          .model = "floor",
          .title = "Calibration",
          .next = "`ukemi optimize` with scene.toml plans on this floor.",
          .hint = "are the drop's height, speed and pitch right, is t = 0 the release?"};
}

/// Simulates a drop with perturbed settings, in which `term` has been changed by `step`.
using FollowPerturbed = std::function<FollowedDrop(const Settings& perturbed, const DropTerm& term, double step)>;
/// Fills the slopes of `followed` by one-sided differences, on threads (0: all cores; results do not depend on it); the
/// step is `relative_step` times a constant's value, or a term's size where that is larger. A step that leaves the
/// term's bounds or cannot be simulated is taken backwards. False, without slopes: neither direction is possible.
bool finite_difference_slopes(const Settings& settings, double relative_step, int threads,
                              const FollowPerturbed& follow, FollowedDrop& followed);

class DropSimulator {
 public:
  virtual ~DropSimulator() = default;

  virtual LogsOf logs_of() const { return LogsOf::kDrops; }
  /// Horizons of the fit's parts, from a drop's first touchdown [s], increasing: what follows a touchdown can be fitted
  /// only once the touchdown is. The last is the whole. Tuned by `test_regression "calibrate*"`, from starts 30 % off.
  virtual std::vector<double> horizons() const {
    return {0.02, 0.03, 0.05, 0.08, 0.13, 0.2, 0.3, 0.5, std::numeric_limits<double>::infinity()};
  }

  /// The channels that its logs may hold.
  virtual const std::vector<landing::DropChannel>& channels() const = 0;
  virtual std::size_t drops() const = 0;
  virtual const landing::DropLog& log(std::size_t drop) const = 0;
  /// The scene's value of a constant.
  virtual double value(const DropTerm& constant) const = 0;
  /// Time of the first touchdown under the scene's constants, from release [s]; 0: not known beforehand.
  virtual double first_touchdown(std::size_t drop) const = 0;
  /// Simulates a drop at times from release [s] that include the log's shift. A run that fails is not complete.
  virtual FollowedDrop follow(std::size_t drop, const Settings& settings, const std::vector<double>& times,
                              const landing::SimulateOptions& options) const = 0;
  /// Adds the slopes to a drop that was simulated with these arguments, and the steps that this takes. False: the drop
  /// cannot be simulated with perturbed terms.
  virtual bool differentiate(std::size_t drop, const Settings& settings, const std::vector<double>& times,
                             const landing::SimulateOptions& options, FollowedDrop& followed) const = 0;
  /// Limit of the work from one start, as a multiple of that with exact derivatives.
  virtual double work_factor(std::size_t /*settings*/) const { return 1; }
  /// Largest acceleration up to time `until` [m/s^2]; NaN: the acceleration is not simulated.
  virtual double peak(std::size_t drop, const Settings& settings, double until,
                      const landing::SimulateOptions& options) const = 0;
};

}  // namespace ukemi::tools
