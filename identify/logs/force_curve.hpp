// The force of a log between its samples: linear, or a smooth curve through each pulse.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "identify/logs/trial.hpp"

namespace ukemi::identify {

/// c[0] + c[1] u + c[2] u^2 + c[3] u^3 [N], u [s].
using Cubic = std::array<double, 4>;
/// The same curve with u counted from `by` [s] on.
Cubic moved(const Cubic& c, double by);

/// F(t) as pieces on the force's own clock, from its first sample to its last; the trial's force_smooth = s blends
///
///     F = (1 - s) F_linear + s F_smooth.
///
/// F_smooth is at rest, 0 or force_rest, between pulses. A pulse is a run of at least four samples off rest, and
/// F_smooth the cubic spline through them. Where that is steep rather than bent at an end of the run, it is continued
/// to where it meets rest within the next interval, so that a blow that begins between two samples keeps its impulse;
/// else the spline reaches to the sample at rest, with slope 0 there. Shorter runs, and runs with intervals below 0.1
/// or above 2 times their median, stay linear. Ours: the paper does not say how its force is interpolated.
class ForceCurve {
 public:
  explicit ForceCurve(const Trial& trial);
  std::size_t pieces() const {
    return times().empty() ? 0 : blended_.empty() ? times().size() - 1 : blended_.size() - 1;
  }
  /// Where piece k begins [s]; of k = pieces(): where the log ends.
  double begin(std::size_t k) const { return blended_.empty() ? times()[k] : blended_[k].t; }
  /// Of piece k, u from its begin.
  Cubic piece(std::size_t k) const { return blended_.empty() ? linear(k) : blended_[k].c; }

 private:
  struct Piece {
    double t;
    Cubic c;
  };
  const std::vector<double>& times() const { return trial_->force_t.empty() ? trial_->t : trial_->force_t; }
  Cubic rest() const { return {trial_->force_rest, 0, 0, 0}; }
  Cubic linear(std::size_t interval) const;
  Cubic hermite(std::size_t interval, double from, double to) const;
  std::vector<double> spline(std::size_t first, std::size_t last, bool hold_first, bool hold_last) const;
  bool even(std::size_t first, std::size_t last) const;
  void add(std::size_t interval, double t, const Cubic& smooth);
  void add_pulse(std::size_t first, std::size_t last);
  void add_onset(std::size_t interval, const Cubic& end, double meets, bool before);

  const Trial* trial_;
  std::vector<Piece> blended_;  ///< empty where the force is linear: nothing is stored then
};

}  // namespace ukemi::identify
