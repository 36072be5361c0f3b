// Recorder of a run for reports. Private to simulate.cpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "landing/run/simulate.hpp"
#include "landing/run/touch_log.hpp"

namespace ukemi::landing {

/// Collects touches, peaks, demands, the energy check and the trajectory.
template <class System>
class Recorder {
 public:
  Recorder(Landing* out, double rate) : out_(*out), rate_(rate), log_(out->touches, out->peaks, kPoints) {}

  void start(const System& system, double t, const typename System::State& y) {
    energy_start_ = system.link_energy(y), motor_start_ = system.motor_energy(y);
    energy_turnover_ = kinetic_energy(system.link, system.pose(y));
    work_.setZero();
    out_.demands.phi_min = out_.demands.phi_max = y[kTheta1] - y[kTheta0];
    log_.since.t = t;
  }

  void jump() { log_.since.jump(); }
  void row(const System& system, double t, const typename System::State& y) {
    if (rate_ > 0) out_.trajectory.push_back(sample(system, t, y));
  }

  /// Adds the rows before `until` of the ballistic flight from release, in closed form.
  void ballistic(const System& system, const Drop& drop, typename System::State y, double until) {
    const double y0 = y[kY], x0 = y[kX], vx = y[kVx], vy = y[kVy], g = system.link.gravity;
    for (; rate_ > 0 && next_row() < until; ++rows_) {
      const double t = next_row();
      y[kX] = x0 + vx * t, y[kY] = y0 + vy * t - 0.5 * g * t * t;
      y[kVy] = vy - g * t;
      row(system, t, y);
    }
    energy_turnover_ += system.link.total_mass * g * drop.height;
    log_.since.consider(g * g, 0);
  }

  template <class Integrator>
  void step(const System& system, Integrator& integrator) {
    (void)log_.since.step(system, integrator);  // the follower has checked the step
    const auto& step = integrator.step();
    for (const double s : {0.0, 0.25, 0.5, 0.75, 1.0})
      observe(system.evaluate(step.t + s * step.h, integrator.dense().at(s)));
    for (; rate_ > 0 && next_row() <= step.t + step.h; ++rows_)
      if (next_row() >= step.t) row(system, next_row(), integrator.dense().at(step.place_of(next_row())));
    for (int i = System::kWorkJoint; i < System::kWithAccounts; ++i)
      energy_turnover_ += std::abs(step.y_end[i] - work_[i - System::kWorkJoint]);
    work_ = step.y_end.template tail<3>();
    const double links = system.link_energy(step.y_end) - energy_start_ - step.y_end[System::kWorkJoint] -
                         step.y_end[System::kWorkFloor];
    const double motor = system.motor_energy(step.y_end) - motor_start_ - step.y_end[System::kWorkMotor];
    mismatch_ = std::max({mismatch_, std::abs(links), std::abs(motor)});
  }

  void touchdown(Point point, double t) { log_.touchdown(point, t); }
  void liftoff(Point point, double t) { log_.liftoff(point, t); }

  void finish() {
    log_.finish();
    out_.energy_residual = energy_turnover_ > 0 ? mismatch_ / energy_turnover_ : 0;
  }

 private:
  Landing& out_;
  double rate_;
  long rows_ = 0;
  double energy_start_ = 0, motor_start_ = 0, energy_turnover_ = 0, mismatch_ = 0;
  Eigen::Vector3d work_;
  TouchLog log_;

  double next_row() const { return double(rows_) / rate_; }

  void observe(const typename System::Field& f) {
    for (int j = 0; j < kPoints; ++j)
      if (Touch* const touch = log_.current(j)) touch->peak_force = std::max(touch->peak_force, f.force[j].norm());
    Demands& d = out_.demands;
    d.motor_speed = std::max(d.motor_speed, std::abs(f.sea.dphi_m));
    d.motor_torque = std::max(d.motor_torque, std::abs(f.tau_mot));
    d.sea_torque = std::max(d.sea_torque, std::abs(f.tau_sea));
    d.phi_min = std::min(d.phi_min, f.sea.phi), d.phi_max = std::max(d.phi_max, f.sea.phi);
  }

  static Sample sample(const System& system, double t, const typename System::State& y) {
    const auto f = system.evaluate(t, y);
    const auto dy = system.derivative(t, y);
    const Vec2<double> r = thigh_position(system.link, f.pose), v = thigh_velocity(system.link, f.pose),
                       a = thigh_acceleration(system.link, f.pose, {dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]});
    Sample out{t,          r.x(),      r.y(), y[kTheta0], f.sea.phi, f.sea.phi_m, v.x(),           v.y(), y[kOmega0],
               f.sea.dphi, y[kOmegaM], a.x(), a.y(),      a.norm(),  f.tau_sea,   f.reference.phi, {}};
    for (std::size_t j = 0; j < kPoints; ++j) out.force[j] = {f.force[j].x(), f.force[j].y()};
    return out;
  }
};

/// A recorder that records nothing.
struct NoRecorder {
  NoRecorder(Landing*, double) {}
};

}  // namespace ukemi::landing
