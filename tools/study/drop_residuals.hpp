// One drop as a function of a point of the fit: its residuals against the log with their derivatives, and the whole
// replayed; noise and residuals of many.
#pragma once

#include <vector>

#include "tools/study/calibration.hpp"

namespace ukemi::tools {

using PerOutput = std::array<double, landing::kOutputs>;

using DropLayout = identify::Layout<DropTerm>;
using identify::Prior;

/// What it is made from must outlive it. `steps` counts what it integrates.
class DropResiduals {
 public:
  DropResiduals(const landing::Scene& scene, const SeaParameters<double>& sea, const LoggedDrop& drop,
                const DropLayout& layout, const CalibrationOptions& options, long& steps);

  const LoggedDrop& drop() const { return drop_; }

  /// Residuals (sim - meas) / sigma up to `seconds` after release, then the priors'. `sigma` is copied. They cannot be
  /// evaluated any more once the monitor stops.
  identify::ResidualBlock block(const PerOutput& sigma, double seconds, const std::vector<Prior>& priors) const;

  /// The whole drop beside its log.
  DropResult replay(const double* shared, const double* own) const;

 private:
  struct Rolled {
    landing::Scene scene;
    landing::DropRollout rollout;
    double shift;
  };
  /// The last point that was asked for: the solver wants the cost and then the Jacobian of the same.
  struct Memory {
    std::vector<double> point;
    Rolled rolled;
    bool complete = false;
  };
  const Rolled* recall(Memory& m, const double* shared, const double* own, std::size_t end) const;
  bool roll(const double* shared, const double* own, std::size_t end, const landing::SimulateOptions& options,
            Rolled& out) const;
  /// True within a sampling interval of a jump.
  bool left_out(const Rolled& rolled, landing::DropOutput o, std::size_t i) const;

  const landing::Scene& scene_;
  const SeaParameters<double>& sea_;
  const LoggedDrop& drop_;
  const DropLayout& layout_;
  const Monitor& monitor_;
  long& steps_;
  landing::SimulateOptions options_;
  std::size_t first_ = 0;  ///< rows before it are left out
  PerOutput interval_{};   ///< an output's sampling interval [s]
};

/// The noise of each output, over all drops; NaN where none measured it.
PerOutput noise_of(const std::vector<LoggedDrop>& drops);
/// The residual of each output over all drops.
PerOutput rms_of(const std::vector<DropResult>& drops);

}  // namespace ukemi::tools
