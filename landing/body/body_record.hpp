// Recorder of a run for reports. Private to body_run.cpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "landing/body/body_run.hpp"
#include "landing/body/load_value.hpp"
#include "landing/run/touch_log.hpp"

namespace ukemi::landing {

/// |Speed| of the motor of a driven joint, at the output [rad/s], and its |torque| [Nm].
template <class System>
std::pair<double, double> motor_demand(const System& s, int i, double t, const typename System::State& y) {
  const SeaState<double> q = s.joint_state(i, y);
  return {std::abs(s.drive[i].kind == DriveKind::kGeared ? q.dphi : q.dphi_m), std::abs(motor_torque_at(s, i, t, y))};
}

/// Torque of the spring of a driven joint, of a geared drive of its motor [Nm].
template <class System>
double drive_torque(const System& s, int i, double t, const typename System::State& y) {
  if (s.drive[i].kind == DriveKind::kElastic) return s.elastic_torque(i, s.joint_state(i, y));
  return motor_torque_at(s, i, t, y);
}

/// Rotates from the floor's frame to the true one.
struct ToLevel {
  explicit ToLevel(double slope) : c(std::cos(slope)), s(std::sin(slope)) {}
  template <class T>
  Vec2<T> operator()(const Vec2<T>& v) const {
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
  }
  double c, s;
};

/// Collects touches, peaks, demands, the energy check and the trajectory.
template <class System, bool kReport>
class BodyRecorder {
 public:
  using State = typename System::State;

  BodyRecorder(const BodyScene& scene, BodyLanding& out, double rate)
      : scene_(scene), out_(out), rate_(rate), log_(out.touches, out.peaks) {}

  void start(const System& s, const State& y) {
    energy_start_ = s.link_energy(y);
    energy_turnover_ =
        kinetic_energy(s.body, s.pose(y)) + s.body.mass * std::hypot(s.gravity[0], s.gravity[1]) * scene_.drop.height;
    out_.demands.assign(scene_.robot.joints.size(), {});
    for (int i = 0; i < s.body.joints; ++i) {
      JointDemands& d = out_.demands[std::size_t(s.body.joint[i].joint)];
      d.phi_min = d.phi_max = s.joint_state(i, y).phi;
    }
  }
  void jump() { log_.since.jump(); }
  void row(const System& s, double t, const State& y) {
    if (rate_ > 0) out_.trajectory.push_back(sample(s, t, y));
  }

  /// The free fall from release, a BodyCourse::Fall.
  template <class Fall>
  void fall(const System& s, const Fall& f) {
    log_.since.consider(s.peak_square(f.start, f.rate), 0);
    for (; rate_ > 0 && next_row() < f.until; ++rows_) row(s, next_row(), f.at(next_row()));
  }
  template <class Integrator>
  void step(const System& s, Integrator& integrator) {
    (void)log_.since.step(s, integrator);  // the follower has checked the step
    const auto& step = integrator.step();
    for (const double fraction : {0.0, 0.25, 0.5, 0.75, 1.0})
      observe(s, step.t + fraction * step.h, integrator.dense().at(fraction));
    for (; rate_ > 0 && next_row() <= step.t + step.h; ++rows_)
      if (next_row() >= step.t) row(s, next_row(), integrator.dense().at(step.place_of(next_row())));
    const double work = step.y_end[System::kWork];
    energy_turnover_ += std::abs(work - work_), work_ = work;
    mismatch_ = std::max(mismatch_, std::abs(s.link_energy(step.y_end) - energy_start_ - work));
  }

  void force_jumps(double) {}
  void touchdown(int contact, double t) { log_.touchdown(contact, t); }
  void liftoff(int contact, double t) { log_.liftoff(contact, t); }
  void finish() {
    log_.finish();
    out_.energy_residual = energy_turnover_ > 0 ? mismatch_ / energy_turnover_ : 0;
  }

 private:
  double next_row() const { return double(rows_) / rate_; }

  void observe(const System& s, double t, const State& y) {
    const auto p = s.pose(y);
    for (int i = 0; i < s.body.contacts; ++i)
      if (Touch* const touch = log_.current(i))
        touch->peak_force = std::max(touch->peak_force, contact_force(s, i, p, y).norm());
    const auto joint_torques = s.torques(t, y);
    for (int i = 0; i < s.body.joints; ++i) {
      const SeaState<double> q = s.joint_state(i, y);
      const auto& drive = s.drive[i];
      JointDemands& d = out_.demands[std::size_t(s.body.joint[i].joint)];
      d.phi_min = std::min(d.phi_min, q.phi), d.phi_max = std::max(d.phi_max, q.phi);
      d.torque = std::max(d.torque, std::abs(joint_torques[std::size_t(i)]));
      if (drive.kind != DriveKind::kGeared && drive.kind != DriveKind::kElastic) continue;
      const auto [speed, torque] = motor_demand(s, i, t, y);
      d.motor_speed = std::max(d.motor_speed, speed), d.motor_torque = std::max(d.motor_torque, torque);
      d.drive_torque = std::max(d.drive_torque, std::abs(drive_torque(s, i, t, y)));
    }
  }

  /// A trajectory row, in the true frame (the floor's is rotated by the slope).
  BodySample sample(const System& s, double t, const State& y) const {
    const ToLevel level(scene_.slope);
    const auto p = s.pose(y);
    const State dy = s.derivative(t, y);
    BodySample out{};
    out.t = t, out.energy = s.link_energy(y);
    for (int i = 0; i < s.links; ++i) {
      const Vec2<double> r = level(position(s.body.origin[std::size_t(i)], p, s.body.bodies));
      const std::size_t k = std::size_t(i);
      const Vec2<double> v = level(velocity(s.body.origin[k], p, s.body.bodies));
      out.x[k] = r.x(), out.y[k] = r.y(), out.vx[k] = v.x(), out.vy[k] = v.y();
      out.omega[k] = y[System::kOmega + s.body.body_of[k]];
      out.theta[k] = y[System::kTheta + s.body.body_of[k]] + s.body.offset[k] + scene_.slope;
    }
    for (std::size_t j = 0; j < scene_.robot.joints.size(); ++j)
      out.phi[j] = out.phi_ref[j] = scene_.robot.joints[j].phi;
    const auto joint_torques = s.torques(t, y);
    for (int i = 0; i < s.body.joints; ++i) {
      const std::size_t j = std::size_t(s.body.joint[i].joint);
      const SeaState<double> q = s.joint_state(i, y);
      const bool elastic = s.drive[i].kind == DriveKind::kElastic, driven = scene_.robot.joints[j].driven();
      out.phi[j] = q.phi, out.dphi[j] = q.dphi;
      out.phi_m[j] = elastic ? q.phi_m : q.phi, out.dphi_m[j] = elastic ? q.dphi_m : q.dphi;
      out.drive_torque[j] = driven ? drive_torque(s, i, t, y) : 0;
      out.tau[j] = joint_torques[std::size_t(i)], out.phi_ref[j] = driven ? s.reference(i, t).phi : q.phi;
    }
    const Vec2<double> a = level(acceleration(s.body.peak, p, s.accelerations_of(dy), s.body.bodies));
    out.acc_x = a.x(), out.acc_y = a.y(), out.acc = a.norm();
    for (int i = 0; i < s.body.contacts; ++i) {
      Vec2<double> force = contact_force(s, i, p, y);
      force.y() = std::max(0.0, force.y());  // at its event it is 0 to rounding
      const Vec2<double> r = level(position(s.body.contact[i], p, s.body.bodies)), f = level(force);
      const std::size_t k = std::size_t(i);
      out.contact_x[k] = r.x(), out.contact_y[k] = r.y(), out.force_x[k] = f.x(), out.force_y[k] = f.y();
    }
    return out;
  }

  const BodyScene& scene_;
  BodyLanding& out_;
  double rate_;
  long rows_ = 0;
  double energy_start_ = 0, energy_turnover_ = 0, mismatch_ = 0, work_ = 0;
  TouchLog log_;
};

}  // namespace ukemi::landing
