// The force of a log between its samples: linear, or a smooth curve through each pulse.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ukemi {

/// c[0] + c[1] u + c[2] u^2 + c[3] u^3 [N], u [s].
using Cubic = std::array<double, 4>;
double value(const Cubic& c, double u);
/// The same curve with u counted from `by` [s] on.
Cubic moved(const Cubic& c, double by);

/// The samples of a force. They must outlive its curve.
struct ForceSamples {
  std::span<const double> t, force;   ///< [s], increasing; [N]
  double rest = 0;                    ///< what is read between pulses [N]
  std::optional<double> smooth = {};  ///< s below; none: linear, from sample to sample
};

/// F(t) as pieces on the force's own clock, from its first sample to its last; s blends
///
///     F = (1 - s) F_linear + s F_smooth.
///
/// F_smooth is at rest between pulses. A pulse is a run of at least four samples off rest, and
/// F_smooth the cubic spline through them. Where that is steep rather than bent at an end of the run, it is continued
/// to where it meets rest within the next interval, so that a blow that begins between two samples keeps its impulse;
/// else the spline reaches to the sample at rest, with slope 0 there. Shorter runs, and runs with intervals below 0.1
/// or above 2 times their median, stay linear. Ours: the paper does not say how its force is interpolated.
class ForceCurve {
 public:
  explicit ForceCurve(const ForceSamples& samples);
  std::size_t pieces() const {
    return samples_.t.empty() ? 0 : blended_.empty() ? samples_.t.size() - 1 : blended_.size() - 1;
  }
  /// Where piece k begins [s]; of k = pieces(): where the samples end. The same places for every s.
  double begin(std::size_t k) const { return blended_.empty() ? samples_.t[k] : blended_[k].t; }
  /// Of piece k, u from its begin.
  Cubic piece(std::size_t k) const { return blended_.empty() ? linear(k) : blended_[k].c; }
  /// From t on, u from there, to the end of the piece that it lies in; before the first sample and from the last on the
  /// force is theirs. One sample at least is needed.
  Cubic from(double t) const;

 private:
  struct Piece {
    double t;
    Cubic c;
  };
  Cubic rest() const { return {samples_.rest, 0, 0, 0}; }
  Cubic linear(std::size_t interval) const;
  Cubic hermite(std::size_t interval, double from, double to) const;
  std::vector<double> spline(std::size_t first, std::size_t last, bool hold_first, bool hold_last) const;
  bool even(std::size_t first, std::size_t last) const;
  void add(std::size_t interval, double t, const Cubic& smooth);
  void add_pulse(std::size_t first, std::size_t last);
  void add_onset(std::size_t interval, const Cubic& end, double meets, bool before);

  ForceSamples samples_;
  std::vector<Piece> blended_;  ///< empty where the force is linear: nothing is stored then
  bool rests_ = false;          ///< whether both curves do in the last piece
};

}  // namespace ukemi
