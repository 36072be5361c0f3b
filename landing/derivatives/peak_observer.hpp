// The local maxima of |ddr_0| of a landing of any robot and their derivatives; for the method see gradient.hpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "landing/derivatives/differentiated_run.hpp"
#include "landing/derivatives/gradient.hpp"

namespace ukemi::landing {

/// |ddr_0|^2 and its rate along the motion.
struct Square {
  double value, rate;
};

/// Inserts a maximum into the list of the max_count largest, largest first.
template <int P>
void keep_largest(std::vector<PeakGradient<P>>& peaks, const PeakGradient<P>& p, std::size_t max_count) {
  peaks.insert(std::find_if(peaks.begin(), peaks.end(), [&](const auto& other) { return other.value < p.value; }), p);
  if (peaks.size() > max_count) peaks.pop_back();
}

/// The quantity |ddr_0| for PeakObserver.
template <class Landing>
struct AccelerationQuantity {
  using Jet = typename Landing::Jet;
  static Square square(const Landing& l, double t, const typename Landing::Values& y,
                       const typename Landing::Values& dy) {
    const auto a = l.acceleration_rate(t, y, dy);
    const auto q = a.x() * a.x() + a.y() * a.y();
    return {q.a, q.v[0]};
  }
  /// With its derivatives at a fixed time.
  static Jet magnitude(const Landing& l, double, const typename Landing::State& y, const typename Landing::State& dy) {
    using std::sqrt;
    const auto a = l.acceleration(y, dy);
    return sqrt(a.x() * a.x() + a.y() * a.y());
  }
};

/// An observer of follow_with_derivatives that collects the local maxima of |ddr_0|, or of another quantity.
template <class Landing, class Quantity = AccelerationQuantity<Landing>>
class PeakObserver {
  using Jet = typename Landing::Jet;
  using Derivatives = typename Landing::Derivatives;
  using State = typename Landing::State;
  using Values = typename Landing::Values;
  using Driver = typename Landing::Driver;

  /// A one-sided limit of |ddr_0|, with its total derivative at its moving time.
  struct Limit {
    double t;
    int contact;  ///< see PeakGradient
    Square square;
    Jet acceleration;
  };

 public:
  explicit PeakObserver(int max_peaks, Quantity quantity = {})
      : max_peaks_(std::size_t(std::max(1, max_peaks))), quantity_(std::move(quantity)) {}

  void begin(const Landing& l, double t, const State& y) {
    after_ = limit_at(l, t, y, l.system().derivative(t, y), Derivatives::Zero());
    last_ = after_.square;
  }
  void step(const Landing& l, Driver& driver) {
    check_event_limits();
    scan(l, driver);
  }
  void before_event(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) {
    if (!at_event_) before_ = limit_at(l, t, y, dy, shift), at_event_ = true;
  }
  void after_event(const Landing& l, double t, const State& y, const Derivatives& shift, int) {
    after_ = limit_at(l, t, y, l.system().derivative(t, y), shift);
    last_ = after_.square;
    running_ = std::max(running_, last_.value);
  }
  void time_limit(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) {
    if (last_.rate > 0) add(limit_at(l, t, y, dy, shift), PeakKind::kLeftLimit);
  }
  void finish(const Landing&) { check_event_limits(); }
  double running() const { return running_; }
  double last() const { return last_.value; }  ///< at the end of the last step, squared

  std::vector<PeakGradient<Jet::DIMENSION>> peaks;  ///< the largest first; derivatives by scaled parameters, see unit()

 private:
  Square square(const Landing& l, double t, const Values& y, const Values& dy) const {
    return quantity_.square(l, t, y, dy);
  }

  /// The one-sided limit at a state in the present mode; `shift`: derivative of its time.
  Limit limit_at(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) const {
    const Square q = square(l, t, Landing::values(y), Landing::values(dy));
    Jet a = quantity_.magnitude(l, t, y, dy);
    if (a.a > 0) a.v += 0.5 * q.rate / a.a * shift;
    return {t, l.touchdowns() - 1, q, a};
  }

  /// After the events of an instant: adds one of its one-sided limits if it is a maximum.
  void check_event_limits() {
    if (!at_event_) return;
    at_event_ = false;
    constexpr double kJump = 1e-9;  // relative: below it |ddr_0| counts as continuous
    const Square &a = before_.square, &b = after_.square;
    const double jump = b.value - a.value, threshold = kJump * std::max(a.value, b.value);
    if (jump < -threshold) {
      if (a.rate > 0) add(before_, PeakKind::kLeftLimit);
    } else if (b.rate <= 0 && (jump > threshold || a.rate > 0)) {
      add(after_, PeakKind::kRightLimit);
    }
  }

  /// Adds the maxima inside the last step, where the rate falls through zero.
  void scan(const Landing& l, Driver& driver) {
    const auto& step = driver.step();
    const Square start = last_;
    last_ = square(l, driver.time(), Landing::values(driver.state()), Landing::values(driver.slope()));
    running_ = std::max(running_, last_.value);
    constexpr double kMaxGrowth = 4;  // a resolved step with a maximum has an end above a quarter of it
    if (kMaxGrowth * kMaxGrowth * std::max(start.value, last_.value) < threshold_square()) return;
    const auto at = [&](double s) {
      const Values y = Landing::values(driver.dense().at(s));
      const double t = step.t + s * step.h;
      return square(l, t, y, l.plain().derivative(t, y));
    };
    constexpr int kParts = 4;
    Square left = start;
    for (int q = 1; q <= kParts; ++q) {
      const double sa = (q - 1.0) / kParts, sb = double(q) / kParts;
      const Square right = q == kParts ? last_ : at(sb);
      if (left.rate > 0 && right.rate <= 0) {
        constexpr double kResolution = 1e-10;  // of the step
        const double s = integrate::root(
            sa, left.rate, sb, right.rate, [&](double x) { return at(x).rate; }, kResolution);
        const State y = driver.dense().at(s);
        const double t = step.t + s * step.h;
        add(t, quantity_.magnitude(l, t, y, l.system().derivative(t, y)), PeakKind::kInside, l.touchdowns() - 1);
      }
      left = right;
    }
  }

  /// The square that a further maximum must exceed.
  double threshold_square() const { return peaks.size() < max_peaks_ ? 0 : peaks.back().value * peaks.back().value; }
  void add(const Limit& limit, PeakKind kind) { add(limit.t, limit.acceleration, kind, limit.contact); }
  void add(double t, const Jet& a, PeakKind kind, int contact) {
    running_ = std::max(running_, a.a * a.a);
    keep_largest(peaks, {t, a.a, a.v, kind, contact}, max_peaks_);
  }

  std::size_t max_peaks_;
  Quantity quantity_;
  double running_ = 0;                             ///< the running peak, squared
  Square last_{0, 0};                              ///< at the end of the last step, or after the last event
  bool at_event_ = true;                           ///< events, or the release, lie between the last step and the next
  Limit before_{0, -1, {0, 0}, Jet(0)}, after_{};  ///< the one-sided limits at that instant
};

}  // namespace ukemi::landing
