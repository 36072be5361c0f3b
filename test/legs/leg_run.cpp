#include "test/legs/leg_run.hpp"

#include "common/error.hpp"
#include "common/integrate/hybrid.hpp"
#include "common/integrate/tableaus.hpp"
#include "landing/run/peak_tracker.hpp"
#include "test/legs/leg_system.hpp"

namespace ukemi::landing {

namespace {

template <Capacity kSize>
class LegRun {
  using System = LegSystem<kSize>;
  using State = typename System::State;
  using Driver = integrate::Integrator<integrate::DormandPrince853, System>;
  static constexpr double kNever = std::numeric_limits<double>::infinity();

 public:
  LegRun(const LegScene& scene, const LegMotion& motion)
      : scene_(scene), motion_(motion), system_(scene.robot, scene.slope) {
    for (int i = 0; i < joints(); ++i) {
      const Motion& m = motion_of(i);
      system_.piece[i] = standing_at(m.release_phi());
      air_[i] = m.reposition ? m.reposition->from : kNever;
    }
    limit_ = scene.t_end.value_or(10 * Scene::kFollow);
  }

  LegLanding run(double accuracy) {
    State y = released();
    Driver driver(system_, 0, y, {.accuracy = accuracy, .first_step = 1e-4, .max_step = 0.1});
    for (long n = 0;; ++n) {
      const integrate::Outcome outcome = driver.step(stop());
      const double t = out_.t_end = driver.time();
      out_.status = outcome.status;
      if (outcome.status > integrate::Status::kEvent || n > 2'000'000) break;
      if (!outcome.immediate && driver.step().h > 0) (void)peak_.step(system_, driver);
      if (outcome.event >= 0) {
        State at = driver.state();
        const int touched = system_.cross(outcome.event, at), guard = outcome.event;
        const bool surface = guard < System::kJointGuards && guard % System::kOfContact == System::kSurface;
        if (surface && touched < 0) out_.last_liftoff = t;
        if (touched >= 0) touch(touched, t);
        driver.refresh(at), peak_.jump();
      } else if (outcome.status == integrate::Status::kReached) {
        if (t >= limit_) {
          out_.end = End::kTimeLimit;
          break;
        }
        turn(t);
        driver.refresh(), peak_.jump();
      }
    }
    out_.work = driver.counters();
    const State& y_end = driver.state();
    out_.base_x = y_end[System::kX], out_.base_y = y_end[System::kY];
    out_.base_vx = y_end[System::kVx], out_.base_vy = y_end[System::kVy];
    out_.peak = std::sqrt(peak_.square), out_.t_peak = peak_.t;
    return out_;
  }

 private:
  int joints() const { return system_.body.joints; }
  const Joint& joint_of(int i) const { return scene_.robot.joints[system_.body.joint[i].joint]; }
  const Motion& motion_of(int i) const { return motion_[system_.body.joint[i].joint]; }

  State released() {
    const Robot& robot = scene_.robot;
    State y = State::Zero();
    y[System::kTheta] = scene_.drop.pitch - scene_.slope;
    for (int i = 0; i < joints(); ++i) {
      const JointPlace& at = system_.body.joint[i];
      const double phi = joint_of(i).driven() ? motion_of(i).release_phi() : joint_of(i).phi;
      // The ground of a pinned joint is the true one.
      if (at.parent >= 0)
        y[System::kTheta + at.child] = y[System::kTheta + at.parent] + phi - at.offset;
      else if (joint_of(i).driven())
        y[System::kTheta] = phi;
      y[System::kPhiM + i] = phi;
    }
    typename System::Pose p = system_.pose(y);
    if (robot.base == Base::kPinned) {
      system_.base = {0, robot.pin_height};
      return y;
    }
    double lowest = kNever;
    for (int i = 0; i < system_.body.contacts; ++i)
      lowest = std::min(lowest, system_.point_at(i, p).y - system_.point[i].thickness);
    const double lift = scene_.drop.height - lowest;
    if (robot.base == Base::kRail) {
      system_.base = {0, lift};
    } else {
      const double v = scene_.drop.forward_speed;
      y[System::kY] = lift;
      y[System::kVx] = v * std::cos(scene_.slope), y[System::kVy] = -v * std::sin(scene_.slope);
    }
    return y;
  }
  double stop() const {
    double t = limit_;
    for (int i = 0; i < joints(); ++i) t = std::min({t, air_[i], end_[i]});
    return std::min(t, detected_);
  }
  void touch(int contact, double t) {
    out_.contacts.push_back(contact), out_.times.push_back(t);
    if (out_.first < kNever) return;
    out_.first = t;
    if (!scene_.t_end) limit_ = t + Scene::kFollow;
    if (scene_.detection_delay > 0)
      detected_ = t + scene_.detection_delay;
    else
      land(t);
  }
  void land(double t) {
    detected_ = kNever;
    for (int i = 0; i < joints(); ++i) {
      if (!joint_of(i).driven()) continue;
      set(i, Turn::kLand, t), system_.joint[i].phase = Phase::kMoving;
      air_[i] = kNever, end_[i] = t + motion_of(i).duration;
      system_.drive[i].sea = with_landing_gains(system_.drive[i].sea, motion_of(i));
    }
  }
  void set(int i, Turn to, double t) { system_.piece[i] = piece_behind(to, motion_of(i), system_.piece[i], t); }
  void turn(double t) {
    const double now = t + 1e-14;
    if (now >= detected_) land(t);
    for (int i = 0; i < joints(); ++i) {
      Phase& phase = system_.joint[i].phase;
      if (now >= end_[i]) phase = Phase::kAfter, end_[i] = kNever;
      if (!(now >= air_[i])) continue;
      const bool begins = phase == Phase::kBefore && system_.piece[i].a == system_.piece[i].b;
      set(i, begins ? Turn::kReposition : Turn::kStand, t);
      phase = begins ? Phase::kMoving : Phase::kBefore;
      air_[i] = begins ? motion_of(i).reposition->to : kNever;
    }
  }

  const LegScene& scene_;
  const LegMotion& motion_;
  System system_;
  std::array<double, kSize.joints> air_ = filled(), end_ = filled();
  double limit_, detected_ = kNever;
  PeakTracker peak_;
  LegLanding out_;
  static std::array<double, kSize.joints> filled() {
    std::array<double, kSize.joints> out;
    out.fill(kNever);
    return out;
  }
};

}  // namespace

LegLanding land(const LegScene& scene, const LegMotion& motion, double accuracy) {
  constexpr Capacity kAny{kMostLinks, kMostJoints, kMostContacts};
  return LegRun<kAny>(scene, motion).run(accuracy);
}

}  // namespace ukemi::landing
