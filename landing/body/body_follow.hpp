// One landing of a robot of any joints from event to event. Included by what compiles kernels, by no other.
//
// Every driven joint starts its motion at the first touchdown of any contact, detection_delay later, from where its
// reference is then, and holds phi_F once its own duration is over; before it the move in the air, where it has one.
#pragma once

#include <algorithm>
#include <cmath>

#include "landing/body/body_record.hpp"
#include "landing/body/body_rest.hpp"
#include "landing/run/peak_tracker.hpp"

namespace ukemi::landing {

template <class Method, Capacity kSize, bool kReport>
class BodyFollower {
 public:
  using System = BodySystem<kSize, kReport>;
  using State = typename System::State;

  BodyFollower(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options, BodyLanding& out,
               double rate)
      : scene_(scene),
        motion_(motion),
        options_(options),
        out_(out),
        system_(scene.robot, scene.slope),
        recorder_(scene, out, rate) {
    if (!scene.floor) system_.body.contacts = 0;
    for (int i = 0; i < joints(); ++i) {
      const Motion& m = motion_of(i);
      system_.piece[i] = standing_at(m.release_phi());
      if (value_of(system_.drive[i].sea.tau_max) == 0) system_.joint[i].saturation = 1;  // one branch, never left
      air_[i] = joint_of(i).driven() && m.reposition ? m.reposition->from : kNever;
      end_[i] = kNever;
    }
    limit_ = scene.t_end.value_or(flight_limit());
    impact_ = impact_energy(system_);
  }

  void follow() {
    const State y = released();
    if constexpr (kReport) recorder_.start(system_, y);
    integrate::Integrator<Method, System> driver(
        system_, 0, y, {.accuracy = accuracy(), .first_step = 1e-4, .max_step = options_.max_step});
    std::optional<End> end;
    for (long n = 0; !end; ++n) end = advance(driver, n);
    out_.end = *end, out_.t_end = t_, out_.work = driver.counters();
    out_.peak = std::sqrt(peak_.square), out_.t_peak = peak_.t;
    const State& last = driver.state();
    const bool free = scene_.robot.base == Base::kFree;
    out_.base = {last[System::kX], free ? last[System::kY] : 0},
    out_.speed = {last[System::kVx], free ? last[System::kVy] : 0};
    if constexpr (kReport) recorder_.finish();
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  int joints() const { return system_.body.joints; }
  const Joint& joint_of(int i) const { return scene_.robot.joints[std::size_t(system_.body.joint[i].joint)]; }
  const Motion& motion_of(int i) const { return motion_[std::size_t(system_.body.joint[i].joint)]; }
  double accuracy() const {
    double out = options_.accuracy;
    for (int i = 0; i < joints(); ++i) {
      SeaParameters<double> sea = joint_of(i).sea;
      if (joint_of(i).kind == DriveKind::kGeared) sea.output_friction = sea.friction;
      out = std::min(out, step_accuracy(options_.accuracy, sea));
    }
    return out;
  }

  /// How long a run is followed for its first touchdown: until the highest rise and the longest fall are over, and as
  /// long again as any landing [s].
  double flight_limit() const {
    const Robot& robot = scene_.robot;
    double rates = std::abs(scene_.drop.pitch_rate);
    for (int i = 0; i < joints(); ++i)
      if (joint_of(i).driven()) rates += std::abs(motion_of(i).release_rate());
    const double g = robot.gravity, far = 2 * reach(robot),
                 rise = far * rates + std::max(0.0, scene_.drop.vertical_speed);
    if (!scene_.touches() || !(g > 0) || robot.base == Base::kPinned) return Scene::kFollow;
    return (rise + std::sqrt(rise * rise + 2 * g * (scene_.drop.height + 2 * far))) / g + Scene::kFollow;
  }

  /// At rest but for the drop's speeds, the joints at phi_I or where passive ones are let go, their springs relaxed.
  State released() {
    const Robot& robot = scene_.robot;
    State y = State::Zero();
    y[System::kTheta] = scene_.drop.pitch - scene_.slope;
    if (!system_.body.first_stays) y[System::kOmega] = scene_.drop.pitch_rate;
    for (int i = 0; i < joints(); ++i) {
      const JointPlace& at = system_.body.joint[i];
      const bool driven = joint_of(i).driven();
      const double phi = driven ? motion_of(i).release_phi() : joint_of(i).phi,
                   rate = driven ? motion_of(i).release_rate() : 0;
      // The ground of a pinned joint is the true one.
      const double theta = at.parent >= 0 ? y[System::kTheta + at.parent] : -scene_.slope;
      if (at.parent >= 0 || driven) y[System::kTheta + at.child] = theta + phi - at.offset;
      if (at.parent >= 0 || driven)
        y[System::kOmega + at.child] = (at.parent >= 0 ? y[System::kOmega + at.parent] : 0) + rate;
      y[System::kPhiM + i] = phi, y[System::kOmegaM + i] = joint_of(i).kind == DriveKind::kElastic ? rate : 0;
    }
    place(robot, y);
    return y;
  }
  /// The base where the drop has it.
  void place(const Robot& robot, State& y) {
    const typename System::Pose p = system_.pose(y);
    if (robot.base == Base::kPinned) {
      system_.base = {0, robot.pin_height};
      return;
    }
    double lowest = kNever;
    for (int i = 0; i < system_.body.contacts; ++i)
      lowest = std::min(lowest, system_.point_at(i, p).y - system_.point[i].thickness);
    const double lift = scene_.drop.height - (lowest < kNever ? lowest : 0);
    if (robot.base == Base::kRail) {
      system_.base = {0, lift};
      if (const double up = scene_.drop.vertical_speed; up != 0) y[System::kVx] = up / std::sin(robot.rail_direction);
      return;
    }
    // The first link's origin begins over x = 0, and has the forward speed.
    const auto origin = position(system_.body.first, p, system_.body.bodies),
               speed = velocity(system_.body.first, p, system_.body.bodies);
    const double v = scene_.drop.forward_speed, up = scene_.drop.vertical_speed, c = std::cos(scene_.slope),
                 s = std::sin(scene_.slope);
    y[System::kX] = -origin[0], y[System::kY] = lift;
    y[System::kVx] = v * c + up * s - speed[0], y[System::kVy] = -v * s + up * c - speed[1];
  }

  /// One step, and what it means for the landing: how the run ended, if it did.
  template <class Driver>
  std::optional<End> advance(Driver& driver, long n) {
    if (shortest_ < kNever) driver.limit_next_step(kPart * shortest_);
    const integrate::Outcome outcome = driver.step(stop());
    t_ = driver.time(), out_.status = outcome.status;
    if (n >= options_.max_steps) return failed(Failure::kSteps);
    if (outcome.status > integrate::Status::kEvent) return failed(Failure::kIntegration);
    if (!outcome.immediate && driver.step().h > 0) {
      if (!peak_.step(system_, driver)) return failed(Failure::kUnresolved);
      if (softened(driver.state())) return failed(Failure::kGivesWay);
      if constexpr (kReport) recorder_.step(system_, driver);
      if (!scene_.limits.joints.empty() && !out_.broken) look(driver);
    }
    if (out_.broken && scene_.limits.broken == BodyLimits::Broken::kEnds) return End::kBroken;
    if (peak_.square > options_.abandon_above * options_.abandon_above) return End::kAbandoned;
    if (options_.stopped(n)) return End::kStopped;
    if (outcome.event >= 0) return cross(driver, outcome.event), std::nullopt;
    if (outcome.status == integrate::Status::kReached) {
      if (t_ >= limit_) return out_.first_touchdown < kNever || !scene_.touches() ? End::kTimeLimit : End::kNoContact;
      turn(), jump(driver);
    }
    const bool asked =
        options_.rest == SimulateOptions::Rest::kStop && out_.first_touchdown < kNever && detected_ == kNever;
    if (asked && at_rest(system_, t_, driver.state(), peak_.square, impact_)) return End::kRest;
    return std::nullopt;
  }
  void broken(BrokenLimit::Kind kind, int index) {
    if (!out_.broken) out_.broken = {kind, index, t_};
  }
  /// Whether the step breaks a joint's limits at its quarters, at which a report too looks for demands.
  template <class Driver>
  void look(Driver& driver) {
    const auto& step = driver.step();
    for (const double part : {0.25, 0.5, 0.75, 1.0}) {
      const double t = step.t + part * step.h;
      const State y = driver.dense().at(part);
      for (int i = 0; i < joints(); ++i) {
        if (!joint_of(i).driven()) continue;
        const int joint = system_.body.joint[i].joint;
        const BodyLimits::Joint& most = scene_.limits.joints[std::size_t(joint)];
        const SeaState<double> q = system_.joint_state(i, y);
        const auto [speed, torque] = motor_demand(system_, i, t, q);
        if (!(most.phi[0] <= q.phi && q.phi <= most.phi[1])) broken(BrokenLimit::Kind::kStop, joint);
        if (speed > most.motor_speed) broken(BrokenLimit::Kind::kMotorSpeed, joint);
        if (torque > most.motor_torque) broken(BrokenLimit::Kind::kMotorTorque, joint);
      }
    }
  }
  bool softened(const State& y) const {
    for (int i = 0; i < joints(); ++i) {
      const auto& sea = system_.drive[i].sea;
      const SeaState<double> s = system_.joint_state(i, y);
      if (system_.drive[i].kind == DriveKind::kElastic && gives_way(sea.k_sea, sea.k_sea_cubic, s.phi_m - s.phi))
        return true;
    }
    return false;
  }
  End failed(Failure why) {
    out_.failure = why;
    return End::kFailed;
  }
  template <class Driver>
  void jump(Driver& driver) {
    driver.refresh(), peak_.jump();
    if constexpr (kReport) recorder_.jump();
  }
  template <class Driver>
  void cross(Driver& driver, int event) {
    if constexpr (kReport) recorder_.row(system_, t_, driver.state());
    State y = driver.state();
    const int touched = system_.cross(event, y);
    const bool surface = event < System::kJointGuards && event % System::kOfContact == System::kSurface;
    driver.refresh(y);
    if (touched >= 0 && !scene_.limits.forbidden.empty() && scene_.limits.forbidden[std::size_t(touched)])
      broken(BrokenLimit::Kind::kForbidden, touched);
    if (touched >= 0 && out_.first_touchdown == kNever) {
      out_.first_touchdown = t_;
      if (!scene_.t_end) limit_ = t_ + Scene::kFollow;
      detected_ = t_ + scene_.detection_delay;
      if (scene_.detection_delay == 0) land();
    }
    jump(driver);
    if constexpr (kReport) {
      if (touched >= 0) recorder_.touchdown(touched, t_);
      if (surface && touched < 0) recorder_.liftoff(event / System::kOfContact, t_);
      recorder_.row(system_, t_, driver.state());
    }
  }

  double stop() const {
    double t = std::min(limit_, detected_);
    for (int i = 0; i < joints(); ++i) t = std::min({t, air_[i], end_[i]});
    return t;
  }
  /// The landing motions start.
  void land() {
    detected_ = kNever;
    for (int i = 0; i < joints(); ++i) {
      if (!joint_of(i).driven()) continue;
      const auto& limits = scene_.limits.joints;
      const int joint = system_.body.joint[i].joint;
      if (!limits.empty() && peak_reference_rate(motion_of(i), t_) > limits[std::size_t(joint)].reference_rate)
        broken(BrokenLimit::Kind::kReferenceRate, joint);
      set(i, Turn::kLand), system_.joint[i].phase = Phase::kMoving;
      air_[i] = kNever, end_[i] = t_ + motion_of(i).duration;
      system_.drive[i].sea = with_landing_gains(system_.drive[i].sea, motion_of(i));
    }
    find_shortest();
  }
  void set(int i, Turn to) { system_.piece[i] = piece_behind(to, motion_of(i), system_.piece[i], t_); }
  /// What is due at a deadline.
  void turn() {
    const double now = t_ + 1e-14;
    if (now >= detected_) land();
    for (int i = 0; i < joints(); ++i) {
      Phase& phase = system_.joint[i].phase;
      if (now >= end_[i]) phase = Phase::kAfter, end_[i] = kNever;
      if (!(now >= air_[i])) continue;
      const bool begins = phase == Phase::kBefore && air_[i] == motion_of(i).reposition->from;
      set(i, begins ? Turn::kReposition : Turn::kStand);
      phase = begins ? Phase::kMoving : Phase::kBefore;
      air_[i] = begins ? motion_of(i).reposition->to : kNever;
    }
    find_shortest();
  }
  /// A step while a reference moves is no longer than a part of it, or the motion is passed over.
  void find_shortest() {
    shortest_ = kNever;
    for (int i = 0; i < joints(); ++i)
      if (system_.joint[i].phase == Phase::kMoving &&
          (system_.piece[i].a != system_.piece[i].b || has_bumps(motion_of(i))))
        shortest_ = std::min(shortest_, system_.piece[i].duration);
  }

  static constexpr double kPart = 0.125;
  const BodyScene& scene_;
  const BodyMotion& motion_;
  const SimulateOptions& options_;
  BodyLanding& out_;
  System system_;
  BodyRecorder<System, kReport> recorder_;
  PeakTracker peak_;
  std::array<double, kSize.joints> air_{}, end_{};
  double t_ = 0, limit_, impact_, detected_ = kNever, shortest_ = kNever;
};

}  // namespace ukemi::landing
