// One landing of the paper's robot in scalars with P derivatives. Private to gradient.cpp and drop_rollout.cpp.
#pragma once

#include <algorithm>
#include <limits>

#include "common/integrate/tableaus.hpp"
#include "landing/derivatives/differentiated_run.hpp"
#include "landing/derivatives/seeds.hpp"
#include "landing/run/rest.hpp"
#include "landing/run/schedule.hpp"

namespace ukemi::landing {

/// The landing in Jets and, in the same mode, the system in doubles; a Landing of follow_with_derivatives.
template <int P, LandingTerms kTerms>
class DifferentiatedLanding {
 public:
  using Jet = ceres::Jet<double, P>;
  using Derivatives = Eigen::Matrix<double, P, 1>;
  using System = LandingSystem<kTerms, false, Jet, double>;
  using Plain = LandingSystem<kTerms, false>;
  using State = typename System::State;
  using Values = typename Plain::State;
  using Driver = integrate::Integrator<integrate::DormandPrince853, System>;
  using Dual = ceres::Jet<double, 1>;  ///< a value and its time derivative

  using Outcome = DifferentiatedOutcome;

  /// Derivatives by the P parameters from `first` on. Scene and options must outlive it.
  DifferentiatedLanding(const Scene& scene, const SeaParameters<double>& sea, const Motion& m,
                        const SimulateOptions& options, Parameter first)
      : scene_(scene),
        options_(options),
        seed_(first),
        motion_(seed_(m)),
        system_(scene.robot, seed_(scene.floor.value_or(Floor<double>{1, 0, 0})), seed_(sea), motion_),
        plain_(scene, sea, m),
        plain_motion_(m),
        schedule_(scene, m, true) {  // moving even if phi_I = phi_F, for the derivatives
    system_.present = plain_.present;
  }

  template <class Observer>
  Outcome run(Observer& observer) {
    State y = released(system_, scene_, seed_(scene_.drop), motion_);
    if (schedule_.ballistic()) {
      observer.flight(*this, y, schedule_.start());
      fly(system_, scene_, schedule_.start(), y);
    }
    if (schedule_.ends_in_flight()) return {.t_end = schedule_.start(), .end = End::kNoContact, .work = {}};
    return follow_with_derivatives(*this, schedule_.start(), y, observer);
  }

  const Scene& scene() const { return scene_; }
  const System& system() const { return system_; }
  const Plain& plain() const { return plain_; }
  const ContactOrder& contacts() const { return contacts_; }
  /// Scale of each derivative: it is by parameter / unit.
  const Eigen::Array<double, P, 1>& unit() const { return seed_.unit(); }

  static Values values(const State& y) {
    Values v;
    for (int k = 0; k < System::kStates; ++k) v[k] = value_of(y[k]);
    return v;
  }
  /// ddr_0 with its derivatives at a fixed time.
  Vec2<Jet> acceleration(const State& y, const State& dy) const {
    return thigh_acceleration(system_.link, system_.pose(y), {dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]});
  }
  /// ddr_0 with its time derivative.
  Vec2<Dual> acceleration_rate(double t, const Values& y, const Values& dy) const {
    const LandingSystem<kTerms, false, Dual, double> dual(plain_);
    Eigen::Matrix<Dual, System::kStates, 1> x, dx;
    for (int k = 0; k < System::kStates; ++k) x[k].a = y[k], x[k].v[0] = dy[k];
    dual.derivative(Dual(t, 0), x, dx);
    return thigh_acceleration(dual.link, dual.pose(x), {dx[kVx], dx[kVy], dx[kOmega0], dx[kOmega1]});
  }

  int touchdowns() const { return contacts_.size(); }

  // The course, as required by follow_with_derivatives.
  const SimulateOptions& options() const { return options_; }
  integrate::Options step_options() const {
    return {.accuracy = step_accuracy(options_.accuracy, plain_.sea),
            .first_step = std::min(options_.max_step, schedule_.first_step()),
            .max_step = options_.max_step};
  }
  void open(double t, const State& y) {
    change(schedule_.initial_change(system_), Jet(t));
    system_.settle(t, y), sync_modes();
  }
  double longest_step() const {
    return system_.phase == Phase::kMoving ? schedule_.motion_max_step() : std::numeric_limits<double>::infinity();
  }
  double stop() const { return schedule_.stop(); }
  bool end_moves() const { return !schedule_.fixed_end(); }
  Deadline reached(double t) {
    const Schedule::Deadline deadline = schedule_.reached(t, system_);
    const bool lands = deadline.change == ReferenceChange::kLand;
    if (!deadline.end && !lands) change(deadline.change, Jet(t));
    return {deadline.end, lands};
  }
  void land(const Jet& t, State& y) {
    change(ReferenceChange::kLand, t);
    system_.settle(-1, t.a, y), sync_modes();
  }
  bool cross(int event, const Jet& t, State& y) {
    const Schedule::Crossing crossing = schedule_.cross(event, t.a, system_, Limits(), contacts_);
    change(crossing.change, t);
    system_.settle(event, t.a, y), sync_modes();
    return crossing.first;
  }
  bool rests(double, const Values& y, double square) const { return at_rest(plain_, y, square, impact_energy(plain_)); }

 private:
  void sync_modes() { static_cast<Mode&>(plain_) = system_; }
  void change(ReferenceChange to, const Jet& t) {
    sync_modes();
    system_.change(to, motion_, t);
    plain_.change(to, plain_motion_, t.a);
  }

  const Scene& scene_;
  const SimulateOptions& options_;
  Seeds<P> seed_;
  MotionOf<Jet> motion_;
  System system_;
  Plain plain_;
  const Motion plain_motion_;
  Schedule schedule_;
  ContactOrder contacts_;
};

/// Calls f<kTerms>() with the terms of the kernel for an actuator.
template <class F>
auto with_terms(const SeaParameters<double>& sea, F&& f) {
  if (is_late(sea)) return f.template operator()<kLateTerms>();
  if (is_extended(sea)) return f.template operator()<kExtendedTerms>();
  return f.template operator()<kLimitedTerms>();
}

}  // namespace ukemi::landing
