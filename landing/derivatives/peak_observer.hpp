// The local maxima of |ddr_0| of a landing and their derivatives, see gradient.hpp for the law. Of any robot.
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

/// Adds a maximum to the largest so many, the largest first.
template <int P>
void keep_largest(std::vector<PeakGradient<P>>& peaks, const PeakGradient<P>& p, std::size_t most) {
  peaks.insert(std::find_if(peaks.begin(), peaks.end(), [&](const auto& other) { return other.value < p.value; }), p);
  if (peaks.size() > most) peaks.pop_back();
}

/// What is largest: |ddr_0|.
template <class Landing>
struct OfAcceleration {
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

/// Collects the local maxima of |ddr_0| of a landing in scalars with derivatives, or of another `Of`; it is an observer
/// of follow_with_derivatives.
template <class Landing, class Of = OfAcceleration<Landing>>
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
  explicit PeakObserver(int most, Of of = {}) : most_(std::size_t(std::max(1, most))), of_(std::move(of)) {}

  void flight(const Landing& l, const State&, double) {
    const double g = l.scene().robot.gravity;
    add(0, Jet(g), PeakKind::kInside, -1);
    before_ = {0, -1, {running_ = g * g, 0}, Jet(g)};
  }
  void begin(const Landing& l, double t, const State& y) {
    behind_ = limit_of(l, t, y, l.system().derivative(t, y), Derivatives::Zero());
    last_ = behind_.square;
  }
  void step(const Landing& l, Driver& driver) {
    join();
    scan(l, driver);
  }
  void before(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) {
    if (!joint_) before_ = limit_of(l, t, y, dy, shift), joint_ = true;
  }
  void after_event(const Landing& l, double t, const State& y, const Derivatives& shift, int) {
    behind_ = limit_of(l, t, y, l.system().derivative(t, y), shift);
    last_ = behind_.square;
    running_ = std::max(running_, last_.value);
  }
  void cut(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) {
    if (last_.rate > 0) add(limit_of(l, t, y, dy, shift), PeakKind::kLeftLimit);
  }
  void finish(const Landing&) { join(); }
  double running() const { return running_; }
  double last() const { return last_.value; }  ///< at the end of the last step, squared

  std::vector<PeakGradient<Jet::DIMENSION>> peaks;  ///< the largest first; derivatives by the landing's units

 private:
  Square square(const Landing& l, double t, const Values& y, const Values& dy) const { return of_.square(l, t, y, dy); }

  /// The limit at a state on the side of the present mode; its time moves by `shift`.
  Limit limit_of(const Landing& l, double t, const State& y, const State& dy, const Derivatives& shift) const {
    const Square q = square(l, t, Landing::values(y), Landing::values(dy));
    Jet a = of_.magnitude(l, t, y, dy);
    if (a.a > 0) a.v += 0.5 * q.rate / a.a * shift;
    return {t, l.touchdowns() - 1, q, a};
  }

  /// Before the first step behind an instant's events: is one of its limits, or the instant itself, a maximum?
  void join() {
    if (!joint_) return;
    joint_ = false;
    constexpr double kJump = 1e-9;  // relative: below it |ddr_0| is continuous and only its rate jumps
    const Square &a = before_.square, &b = behind_.square;
    const double jump = b.value - a.value, least = kJump * std::max(a.value, b.value);
    if (jump < -least) {
      if (a.rate > 0) add(before_, PeakKind::kLeftLimit);
    } else if (b.rate <= 0 && (jump > least || a.rate > 0)) {
      add(behind_, PeakKind::kRightLimit);
    }
  }

  /// The maxima inside the step just taken: where the rate falls through zero.
  void scan(const Landing& l, Driver& driver) {
    const auto& step = driver.step();
    const Square start = last_;
    last_ = square(l, driver.time(), Landing::values(driver.state()), Landing::values(driver.slope()));
    running_ = std::max(running_, last_.value);
    constexpr double kDoubles = 4;  // a resolved step that holds a maximum ends above a quarter of it
    if (kDoubles * kDoubles * std::max(start.value, last_.value) < least_square()) return;
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
        add(t, of_.magnitude(l, t, y, l.system().derivative(t, y)), PeakKind::kInside, l.touchdowns() - 1);
      }
      left = right;
    }
  }

  /// What a further maximum must exceed, squared.
  double least_square() const { return peaks.size() < most_ ? 0 : peaks.back().value * peaks.back().value; }
  void add(const Limit& limit, PeakKind kind) { add(limit.t, limit.acceleration, kind, limit.contact); }
  void add(double t, const Jet& a, PeakKind kind, int contact) {
    running_ = std::max(running_, a.a * a.a);
    keep_largest(peaks, {t, a.a, a.v, kind, contact}, most_);
  }

  std::size_t most_;
  Of of_;
  double running_ = 0;  ///< the running peak, squared
  Square last_{0, 0};   ///< at the end of the last step, or behind the last event
  bool joint_ = true;   ///< events, or the release, stand between the last step and the next
  Limit before_{0, -1, {0, 0}, Jet(0)}, behind_{};  ///< the limits at that instant
};

}  // namespace ukemi::landing
