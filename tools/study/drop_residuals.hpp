// Residuals of one drop against its log, with derivatives, as a function of the fitted terms, and the simulated drop;
// noise and rms residuals over several drops.
#pragma once

#include <vector>

#include "tools/study/floor_fit.hpp"

namespace ukemi::tools {

using DropLayout = identify::Layout<DropTerm>;
using identify::Prior;

/// Keeps references to its arguments. Adds the steps that it integrates to `steps`.
class DropResiduals {
 public:
  DropResiduals(const DropSimulator& simulator, std::size_t drop, const DropLayout& layout,
                const CalibrationOptions& options, long& steps);

  /// Residuals (sim - meas) / sigma up to `seconds` after release, then the priors'. `sigma` is copied. Evaluation
  /// fails once the monitor stops.
  identify::ResidualBlock block(const std::vector<double>& sigma, double seconds,
                                const std::vector<Prior>& priors) const;

  enum class Peaks { kFind, kSkip };
  /// Simulates the whole drop against its log; its peaks take a further simulation.
  DropResult replay(const double* shared, const double* own, Peaks peaks = Peaks::kFind) const;

 private:
  struct Rollout {
    Settings settings;
    std::vector<double> times;
    FollowedDrop drop;
    double shift;  ///< of the log [s]
  };
  /// The last point that was evaluated: the solver asks for the cost and then the Jacobian at the same point.
  struct Cache {
    std::vector<double> point;
    Rollout rollout;
  };
  const Rollout* rollout_at(Cache& cache, const double* shared, const double* own, std::size_t end, bool slopes) const;
  void roll(const double* shared, const double* own, std::size_t end, const landing::SimulateOptions& options,
            Rollout& out) const;
  /// Whether a sample is within a sampling interval of a jump.
  bool left_out(const Rollout& rollout, std::size_t channel, std::size_t i) const;
  const landing::DropLog& log() const { return simulator_.log(drop_); }

  const DropSimulator& simulator_;
  std::size_t drop_;
  const DropLayout& layout_;
  const Monitor& monitor_;
  long& steps_;
  landing::SimulateOptions options_;
  std::size_t first_ = 0;         ///< first row that is used
  std::vector<double> interval_;  ///< sampling interval of each output [s]
};

/// Noise (standard deviation) of each output over all drops; NaN where not measured.
std::vector<double> noise_of(const DropSimulator& drops);
/// RMS residual of each output over all drops; NaN where not measured.
std::vector<double> rms_of(const std::vector<DropResult>& drops);

}  // namespace ukemi::tools
