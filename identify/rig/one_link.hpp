// The rig as a hybrid system: Eq. 5 with the actuator of Eq. 2-4. No floor, no gravity: nothing of them is in this
// kernel.
#pragma once

#include "common/integrate/hybrid.hpp"
#include "common/sea.hpp"

namespace ukemi::identify {

/// Force and reference on one stretch of a trial, linear in time from `t`.
template <class T>
struct Excitation {
  double t = 0;                            ///< start [s]
  bool pushed = false;                     ///< there is a force, or a derivative by one of its terms
  T force{0}, force_rate{0};               ///< F_e [N], [N/s]
  double phi_ref = 0, phi_ref_rate = 0;    ///< [rad], [rad/s]
  double dphi_ref = 0, dphi_ref_rate = 0;  ///< what Eq. 3 sees as the reference's rate [rad/s], [rad/s^2]

  template <class U>
  Excitation<U> with_force(bool is_pushed, const U& f, const U& rate) const {
    return {t, is_pushed, f, rate, phi_ref, phi_ref_rate, dphi_ref, dphi_ref_rate};
  }
};

/// M ddphi_1 = tau_SEA + l cos(phi_1) F_e(t), Eq. 5 of [1]; state [phi_1, phi_m, dphi_1, dphi_m].
/// Test: test/unit/one_link.cpp against the closed-form linear response.
template <SeaTerms kTerms, Scalar T>
class OneLinkSystem {
 public:
  enum { kPhi, kPhiM, kOmega, kOmegaM, kStates };
  static constexpr int kControlled = kStates, kPositions = 2, kGuards = 2, kTorqueUpper = 0, kTorqueLower = 1;
  using State = Eigen::Matrix<T, kStates, 1>;

  OneLinkSystem(const SeaParameters<T>& actuator, double length, double inertia)
      : sea(actuator), length_(length), inverse_inertia_(1 / inertia) {
    if (kTerms.torque_limit && value_of(sea.tau_max) == 0) saturation = 1;
  }

  SeaParameters<T> sea;
  Excitation<T> input;
  int saturation = 0;

  static SeaState<T> sea_state(const State& y) { return {y[kPhi], y[kPhiM], y[kOmega], y[kOmegaM]}; }

  /// `t` may be a double or, to differentiate by it, a T. Flattened: operations on Jets are worth no calls.
  template <class Time>
  [[gnu::flatten]] void derivative(const Time& t, const State& y, State& dy) const {
    const Time u = t - input.t;
    const SeaState<T> s = sea_state(y);
    const T tau = limited_torque<kTerms>(sea, spring_torque<kTerms>(sea, s), saturation);
    const Reference<T> ref{T(input.phi_ref + input.phi_ref_rate * u), T(input.dphi_ref + input.dphi_ref_rate * u)};
    dy[kPhi] = y[kOmega];
    dy[kPhiM] = y[kOmegaM];
    dy[kOmega] = tau * T(inverse_inertia_);
    if (input.pushed) {
      using std::cos;
      dy[kOmega] += T(length_ * inverse_inertia_) * (input.force + input.force_rate * u) * cos(y[kPhi]);
    }
    dy[kOmegaM] = motor_acceleration<kTerms>(sea, s, ref, tau);
  }

  /// d(dy/dt)/dy and d(dy/dt)/dt of the present mode, exact; values only, so for T = double.
  template <class Matrix>
  void linearize(double t, const State& y, Matrix& jacobian, State& rate) const {
    using Dual = ceres::Jet<double, kStates + 1>;
    OneLinkSystem<kTerms, Dual> dual(sea.template cast<Dual>(), length_, 1 / inverse_inertia_);
    dual.input = input.with_force(input.pushed, Dual(input.force), Dual(input.force_rate));
    dual.saturation = saturation;
    Eigen::Matrix<Dual, kStates, 1> x, dx;
    for (int i = 0; i < kStates; ++i) x[i] = Dual(y[i], i);
    dual.derivative(Dual(t, kStates), x, dx);
    for (int i = 0; i < kStates; ++i)
      jacobian.row(i) = dx[i].v.template head<kStates>().transpose(), rate[i] = dx[i].v[kStates];
  }

  void guards(double, const State& y, const State& dy, integrate::Guards<kGuards>& out) const {
    out = {};
    if constexpr (kTerms.torque_limit) {
      if (value_of(sea.tau_max) == 0) return;
      const SeaState<double> s{value_of(y[kPhi]), value_of(y[kPhiM]), value_of(y[kOmega]), value_of(y[kOmegaM])};
      const SeaParameters<double> p{
          0, 0, value_of(sea.k_sea), value_of(sea.c_sea), 1, value_of(sea.tau_max), 0, value_of(sea.k_sea_cubic)};
      const double tau = spring_torque<kTerms>(p, s), limit = p.tau_max,
                   rate = spring_torque_rate<kTerms>(p, s, value_of(dy[kOmega]), value_of(dy[kOmegaM]));
      if (saturation >= 0) out.set(kTorqueUpper, saturation ? tau - limit : limit - tau, saturation ? rate : -rate);
      if (saturation <= 0) out.set(kTorqueLower, saturation ? -limit - tau : limit + tau, saturation ? -rate : rate);
    }
  }

  void cross(int guard) { saturation = saturation ? 0 : (guard == kTorqueUpper ? 1 : -1); }

  /// 0.1 rad, and that at 10 1/s.
  double tolerance_unit(int i) const { return i < kOmega ? 0.1 : 1.0; }

 private:
  double length_, inverse_inertia_;
};

}  // namespace ukemi::identify
