#include "landing/gradient.hpp"

#include <algorithm>
#include <cmath>

#include "common/integrate/tableaus.hpp"
#include "landing/release.hpp"
#include "landing/rest.hpp"
#include "landing/seeds.hpp"

namespace ukemi::landing {

namespace {

/// |ddr_0|^2 and its rate along the motion.
struct Square {
  double value, rate;
};

/// One landing in scalars with P derivatives, and the same system in plain doubles, in the same mode, for all that asks
/// for values alone.
template <int P, LandingTerms kTerms>
class Differentiation {
  using Jet = ceres::Jet<double, P>;
  using Derivatives = Eigen::Matrix<double, P, 1>;
  using System = LandingSystem<kTerms, false, Jet, double>;
  using Plain = LandingSystem<kTerms, false>;
  using State = typename System::State;
  using Values = typename Plain::State;
  using Driver = integrate::Integrator<integrate::DormandPrince853, System>;

  /// A one-sided limit of |ddr_0|, with its total derivative at its moving time.
  struct Limit {
    double t;
    int contact;  ///< see PeakGradient
    Square square;
    Jet acceleration;
  };

 public:
  Differentiation(const Scene& scene, const SeaParameters<double>& sea, const Motion& m, const SimulateOptions& options,
                  int most)
      : scene_(scene),
        options_(options),
        most_(std::size_t(std::max(1, most))),
        motion_(seed_(m)),
        system_(scene.robot, seed_(scene.floor.value_or(Floor<double>{1, 0, 0})), seed_(sea), motion_),
        plain_(scene, sea, m) {
    system_.present = plain_.present;
  }

  PeakGradients<P> run() {
    State y = released(system_, scene_, seed_(scene_.drop), motion_);
    double t = 0, limit = scene_.t_end.value_or(Scene::kFollow);
    const bool ballistic = is_ballistic(scene_);
    if (ballistic) {
      const double fall = fall_time(scene_), g = scene_.robot.gravity;
      t = std::min(fall, limit);
      fly(system_, scene_, t, y);
      add(0, Jet(g), PeakKind::kInside, -1);
      before_ = {0, -1, {running_ = g * g, 0}, Jet(g)};
      if (t < fall) {
        out_.t_end = t, out_.end = End::kTimeLimit;
        return finished();
      }
    }
    follow(t, y, limit, ballistic);
    return finished();
  }

 private:
  /// From event to event, as landing/follow.hpp does. The motion is played even where phi_I = phi_F: the derivatives
  /// need it.
  void follow(double t, const State& start, double limit, bool ballistic) {
    Driver driver(system_, t, start,
                  {.accuracy = options_.accuracy,
                   .first_step = std::min(options_.max_step, ballistic ? 1e-3 : 1e-2),
                   .max_step = options_.max_step});
    const double impact = impact_energy(plain_), duration = value_of(motion_.duration);
    double motion_end = std::numeric_limits<double>::infinity();
    bool touched = false;
    behind_ = limit_of(t, start, system_.derivative(t, start), Derivatives::Zero());
    last_ = behind_.square;
    for (long n = 0;; ++n) {
      if (system_.phase == Phase::kMoving) driver.limit_next_step(0.125 * duration);
      const integrate::Outcome outcome = driver.step(std::min(limit, motion_end));
      t = driver.time();
      out_.status = outcome.status;
      if (outcome.status > integrate::Status::kEvent || n >= options_.max_steps) break;
      if (!outcome.immediate && driver.step().h > 0) {
        join();
        scan(driver);
      }
      if (outcome.event >= 0) {
        const int event = outcome.event;
        const Derivatives shift = event_shift(t, driver, event);
        if (!shift.allFinite()) {
          out_.status = integrate::Status::kNotFinite;
          break;
        }
        if (!joint_) before_ = limit_of(t, driver.state(), driver.slope(), shift), joint_ = true;
        if (event < kPoints) {
          const bool touchdown = system_.contact[event] == Contact::kClear;
          touchdown ? contacts_.touchdown(Point(event), t) : contacts_.liftoff(Point(event), t);
          if (touchdown && !touched) {
            touched = true;
            system_.motion_start = Jet(t, shift);
            system_.phase = Phase::kMoving;
            motion_end = t + duration;
            if (!scene_.t_end) limit = t + Scene::kFollow;
          }
        }
        pass(t, driver, event, shift);
        continue;
      }
      if (outcome.status == integrate::Status::kReached) {
        if (t >= motion_end - 1e-14) {
          system_.phase = plain_.phase = Phase::kAfter;
          motion_end = std::numeric_limits<double>::infinity();
        }
        if (t >= limit - 1e-14) {
          out_.end = End::kTimeLimit;
          const Derivatives shift = scene_.t_end || !touched ? Derivatives::Zero() : system_.motion_start.v;
          if (last_.rate > 0) add(limit_of(t, driver.state(), driver.slope(), shift), PeakKind::kLeftLimit);
          break;
        }
      }
      if (options_.rest == SimulateOptions::Rest::kStop &&
          at_rest(plain_, values(driver.state()), values(driver.slope()), running_, impact)) {
        out_.end = End::kRest;
        break;
      }
    }
    join();
    out_.t_end = t;
    out_.work = driver.counters();
  }

  /// dt*/dp of the event that guard `i` reports: -(dg/dp) / (dg/dt).
  Derivatives event_shift(double t, const Driver& driver, int i) const {
    integrate::Guards<System::kGuards, Jet> guards;
    system_.guards(t, driver.state(), driver.slope(), guards);
    return guards.value[i].v / -value_of(guards.rate[i]);
  }

  /// Into the mode beyond guard `i`, with the saltation y_p += (f(-) - f(+)) dt*/dp.
  void pass(double t, Driver& driver, int i, const Derivatives& shift) {
    system_.cross(i);
    plain_.contact = system_.contact, plain_.saturation = system_.saturation, plain_.phase = system_.phase;
    plain_.motion_start = value_of(system_.motion_start);
    State y = driver.state();
    const Values before = values(driver.slope()), after = plain_.derivative(t, values(y));
    for (int k = 0; k < kMechanical; ++k) y[k].v += (before[k] - after[k]) * shift;
    driver.refresh(y);
    behind_ = limit_of(t, y, system_.derivative(t, y), shift);
    last_ = behind_.square;
    running_ = std::max(running_, last_.value);
  }

  static Values values(const State& y) {
    Values v;
    for (int k = 0; k < kMechanical; ++k) v[k] = value_of(y[k]);
    return v;
  }

  Jet acceleration(const State& y, const State& dy) const {
    using std::sqrt;
    const Vec2<Jet> a = thigh_acceleration(system_.link, system_.pose(y), {dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]});
    return sqrt(a.x() * a.x() + a.y() * a.y());
  }

  Square square(double t, const Values& y, const Values& dy) const {
    using Dual = ceres::Jet<double, 1>;
    const LandingSystem<kTerms, false, Dual, double> dual(plain_);
    Eigen::Matrix<Dual, kMechanical, 1> x, dx;
    for (int k = 0; k < kMechanical; ++k) x[k].a = y[k], x[k].v[0] = dy[k];
    dual.derivative(Dual(t, 0), x, dx);
    const Vec2<Dual> a = thigh_acceleration(dual.link, dual.pose(x), {dx[kVx], dx[kVy], dx[kOmega0], dx[kOmega1]});
    const Dual q = a.x() * a.x() + a.y() * a.y();
    return {q.a, q.v[0]};
  }

  /// The limit at a state on the side of the present mode; its time moves by `shift`.
  Limit limit_of(double t, const State& y, const State& dy, const Derivatives& shift) const {
    const Square q = square(t, values(y), values(dy));
    Jet a = acceleration(y, dy);
    a.v += 0.5 * q.rate / a.a * shift;
    return {t, contacts_.size() - 1, q, a};
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
  void scan(Driver& driver) {
    const auto& step = driver.step();
    const Square start = last_;
    last_ = square(driver.time(), values(driver.state()), values(driver.slope()));
    running_ = std::max(running_, last_.value);
    constexpr double kDoubles = 4;  // a resolved step that holds a maximum ends above a quarter of it
    if (kDoubles * kDoubles * std::max(start.value, last_.value) < least_square()) return;
    const auto at = [&](double s) {
      const Values y = values(driver.dense().at(s));
      const double t = step.t + s * step.h;
      return square(t, y, plain_.derivative(t, y));
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
        add(t, acceleration(y, system_.derivative(t, y)), PeakKind::kInside, contacts_.size() - 1);
      }
      left = right;
    }
  }

  /// What a further maximum must exceed, squared.
  double least_square() const {
    return out_.peaks.size() < most_ ? 0 : out_.peaks.back().value * out_.peaks.back().value;
  }
  void add(const Limit& limit, PeakKind kind) { add(limit.t, limit.acceleration, kind, limit.contact); }
  void add(double t, const Jet& a, PeakKind kind, int contact) {
    running_ = std::max(running_, a.a * a.a);
    auto& peaks = out_.peaks;
    const auto place = std::find_if(peaks.begin(), peaks.end(), [&](const auto& p) { return p.value < a.a; });
    if (std::size_t(place - peaks.begin()) >= most_) return;
    peaks.insert(place, {t, a.a, a.v, kind, contact});
    if (peaks.size() > most_) peaks.pop_back();
  }
  PeakGradients<P> finished() {
    for (auto& p : out_.peaks) p.d.array() /= seed_.unit();
    return std::move(out_);
  }

  const Scene& scene_;
  const SimulateOptions& options_;
  std::size_t most_;
  Seeds<P> seed_;
  MotionOf<Jet> motion_;
  System system_;
  Plain plain_;
  PeakGradients<P> out_;
  ContactOrder contacts_;
  double running_ = 0;  ///< the running peak, squared
  Square last_{0, 0};   ///< at the end of the last step, or behind the last event
  bool joint_ = true;   ///< events, or the release, stand between the last step and the next
  Limit before_{0, -1, {0, 0}, Jet(0)}, behind_{};  ///< the limits at that instant
};

template <int P>
PeakGradients<P> differentiate(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                               const SimulateOptions& options, int most) {
  constexpr LandingTerms kLimited{SeaTerms{true, false}}, kExtended{SeaTerms{true, true}};
  if (is_extended(sea)) return Differentiation<P, kExtended>(scene, sea, motion, options, most).run();
  return Differentiation<P, kLimited>(scene, sea, motion, options, most).run();
}

}  // namespace

PeakGradients<kMotionParameters> motion_peaks(const Scene& scene, const SeaParameters<double>& sea,
                                              const Motion& motion, const SimulateOptions& options, int most) {
  return differentiate<kMotionParameters>(scene, sea, motion, options, most);
}

PeakGradients<kParameters> all_gradients(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                         const SimulateOptions& options, int most) {
  return differentiate<kParameters>(scene, sea, motion, options, most);
}

}  // namespace ukemi::landing
