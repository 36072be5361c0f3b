// One drop as a function of a point of the fit: its residuals against the log with their derivatives, and the whole
// replayed; noise and residuals of many.
#pragma once

#include <vector>

#include "tools/study/floor_fit.hpp"

namespace ukemi::tools {

using DropLayout = identify::Layout<DropTerm>;
using identify::Prior;

/// What it is made from must outlive it. `steps` counts what it integrates.
class DropResiduals {
 public:
  DropResiduals(const DropSimulator& simulator, std::size_t drop, const DropLayout& layout,
                const CalibrationOptions& options, long& steps);

  /// Residuals (sim - meas) / sigma up to `seconds` after release, then the priors'. `sigma` is copied. They cannot be
  /// evaluated any more once the monitor stops.
  identify::ResidualBlock block(const std::vector<double>& sigma, double seconds,
                                const std::vector<Prior>& priors) const;

  enum class Peaks { kFind, kLeave };
  /// The whole drop and its log; its peaks take a run of their own.
  DropResult replay(const double* shared, const double* own, Peaks peaks = Peaks::kFind) const;

 private:
  struct Rolled {
    Settings settings;
    std::vector<double> times;
    FollowedDrop drop;
    double shift;
  };
  /// The last point that was evaluated: the solver wants the cost and then the Jacobian of the same.
  struct Memory {
    std::vector<double> point;
    Rolled rolled;
  };
  const Rolled* recall(Memory& m, const double* shared, const double* own, std::size_t end, bool with_slopes) const;
  void roll(const double* shared, const double* own, std::size_t end, const landing::SimulateOptions& options,
            Rolled& out) const;
  /// True within a sampling interval of a jump.
  bool left_out(const Rolled& rolled, std::size_t channel, std::size_t i) const;
  const landing::DropLog& log() const { return simulator_.log(drop_); }

  const DropSimulator& simulator_;
  std::size_t drop_;
  const DropLayout& layout_;
  const Monitor& monitor_;
  long& steps_;
  landing::SimulateOptions options_;
  std::size_t first_ = 0;         ///< rows before it are left out
  std::vector<double> interval_;  ///< an output's sampling interval [s]
};

/// The noise of each output, over all drops; NaN where none measured it.
std::vector<double> noise_of(const DropSimulator& drops);
/// The residual of each output over all drops.
std::vector<double> rms_of(const std::vector<DropResult>& drops);

}  // namespace ukemi::tools
