#include "landing/drops/drop_rollout.hpp"

#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/integrate/tableaus.hpp"
#include "landing/body/body_follow.hpp"
#include "landing/body/by_links.hpp"
#include "landing/derivatives/differentiated_body.hpp"

namespace ukemi::landing {

namespace {

/// Channels and times to sample, and the result.
struct Sampling {
  const std::vector<DropChannel>& channels;
  const std::vector<double>& times;
  DropRollout& out;
  std::size_t next = 0;

  /// Calls sample(t, state) at each time in a fall, or in a step.
  template <class Fall, class Sample>
  void in_fall(const Fall& fall, Sample&& sample) {
    for (; next < times.size() && times[next] < fall.until; ++next) sample(times[next], fall.at(times[next]));
  }
  template <class Integrator, class Sample>
  void in_step(Integrator& integrator, Sample&& sample) {
    const auto& step = integrator.step();
    for (; next < times.size() && times[next] <= step.t + step.h; ++next) {
      const double t = std::max(times[next], step.t);
      sample(t, integrator.dense().at(step.place_of(t)));
    }
  }
};

/// Channels of a robot at an instant, in the scalars of its system.
template <class System>
class Outputs {
 public:
  using State = typename System::State;
  using T = typename State::Scalar;

  Outputs(const System& system, double slope, const State& y, const State& dy)
      : system_(system),
        slope_(slope),
        level_(slope),
        y_(y),
        pose_(system.pose(y)),
        acceleration_(level_(acceleration(system.body.peak, pose_, system.accelerations_of(dy), system.body.bodies))) {}

  T operator()(const DropChannel& c) const {
    using enum DropChannel::Kind;
    const auto& body = system_.body;
    const auto k = std::size_t(c.index);
    const auto place = [&](const auto& point) { return level_(position(point, pose_, body.bodies)); };
    switch (c.kind) {
      case kAcc: {
        using std::sqrt;
        const T square = acceleration_.x() * acceleration_.x() + acceleration_.y() * acceleration_.y();
        return square > 0 ? sqrt(square) : T(0);  // the norm has no derivative at 0
      }
      case kAccX:
        return acceleration_.x();
      case kAccY:
        return acceleration_.y();
      case kPeakX:
        return place(body.peak).x();
      case kPeakY:
        return place(body.peak).y();
      case kOriginX:
        return place(body.origin[k]).x();
      case kOriginY:
        return place(body.origin[k]).y();
      case kTheta:
        return y_[System::kTheta + body.body_of[k]] + body.offset[k] + slope_;
      case kPhi:
        for (int i = 0; i < body.joints; ++i)
          if (body.joint[i].joint == c.index) return system_.joint_state(i, y_).phi;
        break;
      case kOther:
        break;
    }
    return T(0);
  }

  /// The time derivative, in scalars that have one.
  double rate(const DropChannel& c) const {
    using enum DropChannel::Kind;
    const T value = (*this)(c), &x = acceleration_.x(), &y = acceleration_.y();
    if (c.kind == kAcc && value.a > 0) return (x.a * x.v[0] + y.a * y.v[0]) / value.a;
    if (c.kind != kPeakX && c.kind != kPeakY) return value.v[0];
    const Vec2<T> speed = level_(velocity(system_.body.peak, pose_, system_.body.bodies));
    return c.kind == kPeakX ? speed.x().a : speed.y().a;
  }

 private:
  const System& system_;
  double slope_;
  ToLevel level_;
  const State& y_;
  typename System::Pose pose_;
  Vec2<T> acceleration_;
};

/// Samples a run; used instead of BodyRecorder.
template <class System, bool>
class BodySampler {
 public:
  using State = typename System::State;

  BodySampler(const BodyScene& scene, BodyLanding&, const Sampling& sampling)
      : slope_(scene.slope), sampling_(sampling) {}

  void start(const System&, const State&) {}
  void jump() {}
  void row(const System&, double, const State&) {}
  void touchdown(int, double) {}
  void liftoff(int, double) {}
  void force_jumps(double t) { sampling_.out.jumps.push_back(t); }
  void finish() {}
  template <class Fall>
  void fall(const System& s, const Fall& f) {
    sampling_.in_fall(f, [&](double t, const State& y) { sample(s, t, y); });
  }
  template <class Integrator>
  void step(const System& s, Integrator& integrator) {
    sampling_.in_step(integrator, [&](double t, const State& y) { sample(s, t, y); });
  }

 private:
  void sample(const System& s, double t, const State& y) {
    const Outputs<System> outputs(s, slope_, y, s.derivative(t, y));
    for (std::size_t c = 0; c < sampling_.channels.size(); ++c)
      sampling_.out.value[c].push_back(outputs(sampling_.channels[c]));
  }

  double slope_;
  Sampling sampling_;
};

/// Samples a run with derivatives; an observer of follow_with_derivatives.
template <class Landing>
class DifferentiatedSampler {
  using State = typename Landing::State;
  using System = typename Landing::System;
  using Derivatives = typename Landing::Derivatives;

 public:
  explicit DifferentiatedSampler(const Sampling& sampling) : sampling_(sampling) {}

  template <class Fall>
  void fall(const Landing& l, const Fall& f) {
    sampling_.in_fall(f, [&](double t, const State& y) { sample(l, t, y); });
  }
  void begin(const Landing&, double, const State&) {}
  void step(const Landing& l, typename Landing::Driver& driver) {
    sampling_.in_step(driver, [&](double t, const State& y) { sample(l, t, y); });
  }
  void before_event(const Landing&, double, const State&, const State&, const Derivatives&) {}
  void after_event(const Landing&, double t, const State&, const Derivatives&, int event) {
    if (event < System::kJointGuards && event % System::kGuardsPerContact == System::kSurface)
      sampling_.out.jumps.push_back(t);
  }
  void time_limit(const Landing& l, double t, const State& y, const State&, const Derivatives&) {
    for (; sampling_.next < sampling_.times.size(); ++sampling_.next)
      sample(l, t, y);  // the last time, if it exceeds the time limit by rounding
  }
  void finish(const Landing&) {}
  double running() const { return 0; }  // no rest test: a drop is followed to its last time

 private:
  void sample(const Landing& l, double t, const State& y) {
    const double slope = l.scene().slope;
    const auto v = Landing::values(y);
    const Outputs<System> outputs(l.system(), slope, y, l.system().derivative(t, y));
    const auto set_rate = [&](const auto& system, const auto&, const auto& x, const auto& dx) {
      const Outputs moving(system, slope, x, dx);
      for (std::size_t c = 0; c < sampling_.channels.size(); ++c)
        sampling_.out.slope[c](long(sampling_.next), kDropParameters.size()) = moving.rate(sampling_.channels[c]);
    };
    l.along_motion(t, v, l.plain().derivative(t, v), set_rate);
    for (std::size_t c = 0; c < sampling_.channels.size(); ++c) {
      const auto value = outputs(sampling_.channels[c]);
      sampling_.out.value[c].push_back(value.a);
      for (int k = 0; k < int(kDropParameters.size()); ++k)
        sampling_.out.slope[c](long(sampling_.next), k) = value.v[k] / l.unit()[k];
    }
  }

  Sampling sampling_;
};

void check_times(const std::vector<double>& times) {
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!(std::isfinite(times[i]) && times[i] >= (i > 0 ? times[i - 1] : 0)))
      throw InputError("times: " + shortest(times[i]) + " s: finite times that do not decrease, from 0 on, are needed");
}

/// The options for a drop, which is followed to its last time.
SimulateOptions to_the_end(SimulateOptions options) {
  options.rest = SimulateOptions::Rest::kIgnore;
  return options;
}

}  // namespace

DropRollout roll_drop(const BodyScene& scene, const BodyMotion& motion, const std::vector<DropChannel>& channels,
                      const std::vector<double>& times, const SimulateOptions& options) {
  validate(scene.robot, motion), options.validate();
  check_times(times);
  DropRollout out;
  out.value.resize(channels.size());
  if (times.empty()) return out.complete = true, out;
  BodyScene drop_scene = scene;
  drop_scene.loads.clear();
  constexpr double kBeyond = 1e-9;  // so that the last time is inside a step [s]
  drop_scene.t_end = times.back() + kBeyond;
  drop_scene.validate();
  const SimulateOptions drop_options = to_the_end(options);
  BodyLanding landing;
  in_kernel<kSmall, kLate, kAny>(scene.robot, [&]<Capacity kSize>() {
    BodyFollower<integrate::DormandPrince853, kSize, true, BodySampler>(drop_scene, motion, drop_options, landing,
                                                                        Sampling{channels, times, out})
        .follow();
  });
  out.first_touchdown = landing.contacts.first(), out.peak = landing.peak;
  out.steps = landing.work.steps + landing.work.rejected;
  out.complete = channels.empty() ? landing.end == End::kTimeLimit || landing.end == End::kNoContact
                                  : out.value[0].size() == times.size();
  return out;
}

DropRollout differentiated_drop(const BodyScene& scene, const BodyMotion& motion,
                                const std::vector<DropChannel>& channels, const std::vector<double>& times,
                                const SimulateOptions& options) {
  check_times(times);
  DropRollout out;
  out.value.resize(channels.size());
  out.slope.assign(channels.size(), Eigen::MatrixXd(long(times.size()), long(kDropParameters.size()) + 1));
  if (times.empty()) return out.complete = true, out;
  BodyScene drop_scene = scene;
  drop_scene.t_end = times.back();
  const SimulateOptions drop_options = to_the_end(options);
  std::array<BodyParameter, kDropParameters.size()> parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k) parameters[k] = kDropParameters[k].is;
  const auto outcome = in_kernel<kPlainPair, kPair, kLateLeg>(scene.robot, [&]<Capacity kSize>() {
    constexpr int kJets = 8;  // as many registers as for the parameters
    DifferentiatedBody<kJets, kSize> run(drop_scene, motion, parameters, drop_options);
    DifferentiatedSampler<decltype(run)> sampler({channels, times, out});
    return run.run(sampler);
  });
  out.steps = outcome.work.steps + outcome.work.rejected;
  out.complete = out.value[0].size() == times.size();
  return out;
}

DropRollout roll_drop(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                      const std::vector<double>& times, const SimulateOptions& options) {
  validate(scene, sea, motion), options.validate();
  const TwoLinkLanding drop(scene, sea, motion);
  return differentiated_drop(drop.scene, drop.motion, thigh_channels(), times, options);
}

}  // namespace ukemi::landing
