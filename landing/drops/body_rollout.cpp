#include "landing/drops/body_rollout.hpp"

#include <cmath>

#include "common/integrate/tableaus.hpp"
#include "landing/body/body_follow.hpp"

namespace ukemi::landing {

std::vector<BodyChannel> body_channels(const Robot& robot) {
  using enum BodyChannel::Kind;
  std::vector<BodyChannel> out = {
      {{"acc", "m/s^2", true}, kAcc}, {{"ax", "m/s^2", true}, kAccX}, {{"ay", "m/s^2", true}, kAccY}};
  for (int i = 0; i < int(robot.links.size()); ++i) {
    const std::string& link_name = robot.links[std::size_t(i)].name;
    out.push_back({{"x_" + link_name, "m"}, kOriginX, i}), out.push_back({{"y_" + link_name, "m"}, kOriginY, i});
    out.push_back({{"theta_" + link_name, "rad"}, kTheta, i});
  }
  for (int i = 0; i < int(robot.joints.size()); ++i)
    if (const Joint& j = robot.joints[std::size_t(i)]; j.kind != DriveKind::kLocked)
      out.push_back({{"phi_" + j.name, "rad"}, kPhi, i});
  return out;
}

std::vector<DropChannel> drop_channels(const std::vector<BodyChannel>& channels) {
  return {channels.begin(), channels.end()};
}

namespace {

/// Channels and times to sample, and the result.
struct Sampling {
  const std::vector<BodyChannel>& channels;
  const std::vector<double>& times;
  BodyRollout& out;
};

/// Samples a run at given times; used instead of BodyRecorder.
template <class System, bool>
class BodySampler {
 public:
  using State = typename System::State;

  BodySampler(const BodyScene& scene, BodyLanding&, const Sampling& sampling)
      : slope_(scene.slope), level_(scene.slope), sampling_(sampling) {}

  void start(const System&, const State&) {}
  void jump() {}
  void row(const System&, double, const State&) {}
  void touchdown(int, double) {}
  void liftoff(int, double) {}
  void force_jumps(double t) { sampling_.out.jumps.push_back(t); }
  void finish() {}
  template <class Fall>
  void fall(const System& s, const Fall& f) {
    for (; next_ < sampling_.times.size() && sampling_.times[next_] < f.until; ++next_)
      sample(s, sampling_.times[next_], f.at(sampling_.times[next_]));
  }
  template <class Integrator>
  void step(const System& s, Integrator& integrator) {
    const auto& step = integrator.step();
    for (; next_ < sampling_.times.size() && sampling_.times[next_] <= step.t + step.h; ++next_) {
      const double t = std::max(sampling_.times[next_], step.t);
      sample(s, t, integrator.dense().at(step.place_of(t)));
    }
  }

 private:
  void sample(const System& s, double t, const State& y) {
    const auto p = s.pose(y);
    const auto acc = s.accelerations_of(s.derivative(t, y));
    const Vec2<double> a = level_(acceleration(s.body.peak, p, acc, s.body.bodies));
    for (std::size_t c = 0; c < sampling_.channels.size(); ++c)
      sampling_.out.value[c].push_back(value(sampling_.channels[c], s, y, p, a));
  }
  double value(const BodyChannel& c, const System& s, const State& y, const typename System::Pose& p,
               const Vec2<double>& a) const {
    const auto k = std::size_t(c.index);
    const auto origin = [&] { return level_(position(s.body.origin[k], p, s.body.bodies)); };
    switch (c.kind) {
      case BodyChannel::Kind::kAcc:
        return a.norm();
      case BodyChannel::Kind::kAccX:
        return a.x();
      case BodyChannel::Kind::kAccY:
        return a.y();
      case BodyChannel::Kind::kOriginX:
        return origin().x();
      case BodyChannel::Kind::kOriginY:
        return origin().y();
      case BodyChannel::Kind::kTheta:
        return y[System::kTheta + s.body.body_of[k]] + s.body.offset[k] + slope_;
      case BodyChannel::Kind::kPhi:
        for (int i = 0; i < s.body.joints; ++i)
          if (s.body.joint[i].joint == c.index) return s.joint_state(i, y).phi;
    }
    return 0;
  }

  double slope_;
  ToLevel level_;
  Sampling sampling_;
  std::size_t next_ = 0;
};

template <Capacity kSize>
BodyLanding follow(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options,
                   const Sampling& sampling) {
  BodyLanding out;
  BodyFollower<integrate::DormandPrince853, kSize, true, BodySampler>(scene, motion, options, out, sampling).follow();
  return out;
}

}  // namespace

BodyRollout roll_drop(const BodyScene& scene, const BodyMotion& motion, const std::vector<BodyChannel>& channels,
                      const std::vector<double>& times, const SimulateOptions& options) {
  validate(scene.robot, motion), options.validate();
  check_drop_times(times);
  BodyRollout out;
  out.value.resize(channels.size());
  if (times.empty()) return out.complete = true, out;
  BodyScene drop_scene = scene;
  drop_scene.loads.clear();
  constexpr double kBeyond = 1e-9;  // so that the last time is inside a step [s]
  drop_scene.t_end = times.back() + kBeyond;
  drop_scene.validate();
  SimulateOptions drop_options = options;
  drop_options.rest = SimulateOptions::Rest::kIgnore;
  const Sampling sampling{channels, times, out};
  const BodyLanding landing = in_kernel<kSmall, kLate, kAny>(
      scene.robot, [&]<Capacity kSize>() { return follow<kSize>(drop_scene, motion, drop_options, sampling); });
  out.first_touchdown = landing.contacts.first(), out.peak = landing.peak;
  out.steps = landing.work.steps + landing.work.rejected;
  out.complete = channels.empty() ? landing.end == End::kTimeLimit || landing.end == End::kNoContact
                                  : out.value[0].size() == times.size();
  return out;
}

}  // namespace ukemi::landing
