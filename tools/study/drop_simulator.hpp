// Drops of a robot as a function of a fit's terms: all that the fit of a floor knows of the robot.
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

/// Terms at their values; constants first, for a nuisance is added to one.
struct Setting {
  const DropTerm* term;
  double value;
};
using Settings = std::vector<Setting>;

/// One drop at given times.
struct FollowedDrop {
  std::vector<std::vector<double>> value;  ///< of each channel, one a time
  /// Values of each channel, times x settings; empty: not known yet.
  std::vector<Eigen::MatrixXd> slope;
  std::vector<double> jumps;                    ///< touchdowns and lift-offs, from release [s], in order
  std::vector<landing::ContactChange> changes;  ///< of a robot that is driven by its log, from its first row [s]
  bool complete = false;                        ///< every time has its values
  long steps = 0;                               ///< integrated, taken or rejected
};

/// What the logs are of.
enum class LogsOf { kDrops, kTrials };
/// How a fit of them is told; `unlike`: where no start is near.
struct FitWords {
  const char *one, *many, *model, *title, *next, *unlike;
};
constexpr FitWords words(LogsOf logs) {
  if (logs == LogsOf::kTrials)
    return {.one = "trial",
            .many = "trials",
            .model = "robot",
            .title = "Identification of a robot",
            .next = "`ukemi predict LOG --robot robot.toml` says whether it holds on another log.",
            .unlike = "are the columns' signs and units right, are the robot's constants near?"};
  return {.one = "drop",
          .many = "drops",
          .model = "floor",
          .title = "Calibration",
          .next = "`ukemi optimize` with scene.toml plans on this floor.",
          .unlike = "are the drop's height, speed and pitch right, is t = 0 the release?"};
}

/// A drop followed with settings, of which the term `moved` is `by` beside where it was.
using FollowBeside = std::function<FollowedDrop(const Settings& settings, const DropTerm& moved, double by)>;
/// Fills the slopes of `followed` by one-sided differences, on threads (0: all cores; without influence on the result);
/// the step is `part` of a constant's value, or of a term's size where that is larger. A way that leaves the term's
/// bounds, or that cannot be followed, is taken the other way. False: neither could be, there are no slopes then.
bool differentiate_by_differences(const Settings& settings, double part, int threads, const FollowBeside& follow,
                                  FollowedDrop& followed);

class DropSimulator {
 public:
  virtual ~DropSimulator() = default;

  virtual LogsOf logs_of() const { return LogsOf::kDrops; }
  /// From a drop's first touchdown on, how far it is followed, part by part [s]: what comes after a touchdown can be
  /// met only once the touchdown is. The last is the whole. `test_regression "calibrate*"` chose these, from starts 30
  /// % off.
  virtual std::vector<double> parts() const {
    return {0.02, 0.03, 0.05, 0.08, 0.13, 0.2, 0.3, 0.5, std::numeric_limits<double>::infinity()};
  }

  /// What its logs may hold.
  virtual const std::vector<landing::DropChannel>& channels() const = 0;
  virtual std::size_t drops() const = 0;
  virtual const landing::DropLog& log(std::size_t drop) const = 0;
  /// A constant as the scene has it.
  virtual double value(const DropTerm& constant) const = 0;
  /// When a drop of the scene first touches the floor, from release; 0: not known beforehand [s].
  virtual double first_touchdown(std::size_t drop) const = 0;
  /// At times from release [s]; a settings' shift of the log is in them already. A run that fails is not complete.
  virtual FollowedDrop follow(std::size_t drop, const Settings& settings, const std::vector<double>& times,
                              const landing::SimulateOptions& options) const = 0;
  /// Adds the slopes to a drop that was followed so, and the steps that this takes. False: it cannot be followed
  /// nearby.
  virtual bool differentiate(std::size_t drop, const Settings& settings, const std::vector<double>& times,
                             const landing::SimulateOptions& options, FollowedDrop& followed) const = 0;
  /// Work that may be spent before a start is given up, as a multiple of that of an exact derivative.
  virtual double patience(std::size_t /*settings*/) const { return 1; }
  /// Largest acceleration over all times up to one [m/s^2]; NaN: no acceleration is followed.
  virtual double peak(std::size_t drop, const Settings& settings, double until,
                      const landing::SimulateOptions& options) const = 0;
};

}  // namespace ukemi::tools
