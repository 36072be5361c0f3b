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
/// The same curve with u counted from `du` [s] on.
Cubic shifted(const Cubic& c, double du);

/// The samples of a force. They must outlive its curve.
struct ForceSamples {
  std::span<const double> t, force;   ///< [s], increasing; [N]
  double rest = 0;                    ///< reading between pulses [N]
  std::optional<double> smooth = {};  ///< blending factor s below; none: linear between samples
  double within = 0;                  ///< a sample this far from rest, or less, is in no pulse [N]
};

/// F(t) as pieces on the force's own clock, from its first sample to its last; s blends
///
///     F = (1 - s) F_linear + s F_smooth.
///
/// F_smooth is linear between pulses. A pulse is a run of at least four samples off rest, and
/// F_smooth the cubic spline through them. Where that is steep rather than bent at an end of the run, it is continued
/// to where it meets rest within the next interval, so that a blow that begins between two samples keeps its impulse;
/// else the spline reaches to the next sample, with slope 0 there. Shorter runs, and runs with intervals below 0.1
/// or above 2 times their median, stay linear. Ours: the paper does not say how its force is interpolated.
class ForceCurve {
 public:
  explicit ForceCurve(const ForceSamples& samples);
  std::size_t pieces() const {
    return samples_.t.empty() ? 0 : blended_.empty() ? samples_.t.size() - 1 : blended_.size() - 1;
  }
  /// Start of piece k [s]; for k = pieces() the end of the last piece. The same for every s.
  double begin(std::size_t k) const { return blended_.empty() ? samples_.t[k] : blended_[k].t; }
  /// Cubic of piece k, u from its start.
  Cubic piece(std::size_t k) const { return blended_.empty() ? linear(k) : blended_[k].c; }
  /// Cubic at t, u from t, valid to the end of the piece that contains t; before the first sample and from the last on
  /// the force is constant. Needs at least one sample.
  Cubic from(double t) const;

 private:
  struct Piece {
    double t;
    Cubic c;
  };
  Cubic rest() const { return {samples_.rest, 0, 0, 0}; }
  Cubic linear(std::size_t interval) const;
  Cubic hermite(std::size_t interval, double first_slope, double last_slope) const;
  std::vector<double> spline(std::size_t first, std::size_t last, bool clamp_first, bool clamp_last) const;
  bool evenly_sampled(std::size_t first, std::size_t last) const;
  void add(std::size_t interval, double t, const Cubic& smooth);
  void add_pulse(std::size_t first, std::size_t last);
  void add_onset(std::size_t interval, const Cubic& end, double crossing, bool before);

  ForceSamples samples_;
  std::vector<Piece> blended_;  ///< empty where the force is linear: nothing is stored then
  bool at_rest_ = false;        ///< whether both curves are, in the last piece
};

}  // namespace ukemi
