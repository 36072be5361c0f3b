// One landing in scalars with P derivatives, from event to event, and who watches it. Private to landing's sources that
// compile it (gradient.cpp, drop_rollout.cpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/integrate/saltation.hpp"
#include "common/integrate/tableaus.hpp"
#include "landing/derivatives/seeds.hpp"
#include "landing/run/rest.hpp"
#include "landing/run/schedule.hpp"

namespace ukemi::landing {

/// The landing and, in the same mode, the same system in plain doubles for all that asks for values alone.
///
/// An observer sees, in this order of time:
///   flight(landing, y, until)               the closed-form flight from the state y at release, where there is one
///   begin(landing, t, y)                    where the integration starts
///   step(landing, driver)                   a step of positive length, in the mode before its event
///   before(landing, t, y, dy, shift)        the left limit of an event; `shift` is dt*/dp of its time t*
///   behind(landing, t, y, shift, event)     the right limit, in the mode beyond guard `event`
///   cut(landing, t, y, dy, shift)           the time limit
///   finish(landing)
/// and says by running() the largest |ddr_0|^2 so far, which rest is judged by (asked for with Rest::kStop alone).
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
  using Dual = ceres::Jet<double, 1>;  ///< a value and its rate along the motion

  /// How it ended.
  struct Outcome {
    double t_end = 0;
    End end = End::kFailed;
    integrate::Status status = integrate::Status::kStepped;
    integrate::Counters work;
  };

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
        schedule_(scene, m, true) {  // played even where phi_I = phi_F: the derivatives need it
    system_.present = plain_.present;
  }

  template <class Observer>
  Outcome run(Observer& observer) {
    State y = released(system_, scene_, seed_(scene_.drop), motion_);
    if (schedule_.ballistic()) {
      observer.flight(*this, y, schedule_.start());
      fly(system_, scene_, schedule_.start(), y);
    }
    if (schedule_.flies_on()) return {.t_end = schedule_.start(), .end = End::kNoContact, .work = {}};
    return follow(schedule_.start(), y, observer);
  }

  const Scene& scene() const { return scene_; }
  const System& system() const { return system_; }
  const Plain& plain() const { return plain_; }
  const ContactOrder& contacts() const { return contacts_; }
  /// What a derivative counts, by slot.
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
  /// ddr_0 with its rate.
  Vec2<Dual> acceleration_rate(double t, const Values& y, const Values& dy) const {
    const LandingSystem<kTerms, false, Dual, double> dual(plain_);
    Eigen::Matrix<Dual, System::kStates, 1> x, dx;
    for (int k = 0; k < System::kStates; ++k) x[k].a = y[k], x[k].v[0] = dy[k];
    dual.derivative(Dual(t, 0), x, dx);
    return thigh_acceleration(dual.link, dual.pose(x), {dx[kVx], dx[kVy], dx[kOmega0], dx[kOmega1]});
  }

 private:
  template <class Observer>
  Outcome follow(double t, const State& start, Observer& observer) {
    Driver driver(system_, t, start,
                  {.accuracy = step_accuracy(options_.accuracy, plain_.sea),
                   .first_step = std::min(options_.max_step, schedule_.first_step()),
                   .max_step = options_.max_step});
    Outcome out;
    const double impact = impact_energy(plain_);
    turn(schedule_.opening(system_), Jet(t));
    observer.begin(*this, t, start);
    for (long n = 0;; ++n) {
      if (system_.phase == Phase::kMoving) driver.limit_next_step(schedule_.motion_part());
      const integrate::Outcome outcome = driver.step(schedule_.stop());
      t = driver.time();
      out.status = outcome.status;
      if (outcome.status > integrate::Status::kEvent || n >= options_.max_steps || options_.stopped(n)) break;
      if (!outcome.immediate && driver.step().h > 0) observer.step(*this, driver);
      if (outcome.event >= 0) {
        if (cross(t, driver, outcome.event, observer)) continue;
        out.status = integrate::Status::kNotFinite;
        break;
      }
      if (outcome.status == integrate::Status::kReached) {
        const Schedule::Deadline deadline = schedule_.reached(t, system_);
        if (deadline.end) {
          out.end = *deadline.end;
          const Derivatives shift = schedule_.fixed_end() ? Derivatives::Zero() : touchdown_;
          observer.cut(*this, t, driver.state(), driver.slope(), shift);
          break;
        }
        // The field is continuous at every turn but that to the landing motion, which moves with the touchdown.
        if (deadline.turn == Turn::kLand)
          jump(t, driver, touchdown_, kLandingGuards, observer, [&] { turn(Turn::kLand, Jet(t, touchdown_)); });
        else
          turn(deadline.turn, Jet(t));
      }
      if (options_.rest == SimulateOptions::Rest::kStop &&
          at_rest(plain_, values(driver.state()), observer.running(), impact)) {
        out.end = End::kRest;
        break;
      }
    }
    observer.finish(*this);
    out.t_end = t;
    out.work = driver.counters();
    return out;
  }

  /// Into the mode beyond guard `event`, the derivatives with it; false where its time has no derivative.
  template <class Observer>
  bool cross(double t, Driver& driver, int event, Observer& observer) {
    integrate::Guards<System::kGuards, Jet> guards;
    system_.guards(t, driver.state(), driver.slope(), guards);
    const double rate = value_of(guards.rate[event]);
    // At no speed the time of an event has no derivative, but by what the guard does not depend on: a robot that is
    // released on the floor touches it at release, whatever its motion.
    constexpr double kRounding = 1e-12;
    const Derivatives shift = rate == 0 && guards.value[event].v.isZero(kRounding)
                                  ? Derivatives(Derivatives::Zero())
                                  : Derivatives(integrate::event_shift(guards.value[event], rate));
    if (!shift.allFinite()) return false;
    jump(t, driver, shift, event, observer, [&] {
      const Schedule::Crossing crossing = schedule_.cross(event, t, system_, Limits(), contacts_);
      if (crossing.first) touchdown_ = shift;
      turn(crossing.turn, Jet(t, shift));
    });
    return true;
  }

  /// Through a change of the field at a time that moves by `shift`.
  template <class Observer, class Change>
  void jump(double t, Driver& driver, const Derivatives& shift, int event, Observer& observer, Change&& change) {
    observer.before(*this, t, driver.state(), driver.slope(), shift);
    change();
    State y = driver.state();
    integrate::saltate(y, values(driver.slope()), plain_.derivative(t, values(y)), shift);
    driver.refresh(y);
    observer.behind(*this, t, y, shift, event);
  }

  void turn(Turn to, const Jet& t) {
    static_cast<Mode&>(plain_) = system_;
    system_.turn(to, motion_, t);
    plain_.turn(to, plain_motion_, t.a);
  }

  const Scene& scene_;
  const SimulateOptions& options_;
  Seeds<P> seed_;
  MotionOf<Jet> motion_;
  System system_;
  Plain plain_;
  const Motion plain_motion_;
  Schedule schedule_;
  Derivatives touchdown_ = Derivatives::Zero();  ///< dt_0/dp of the first
  ContactOrder contacts_;
};

/// f<the terms of the kernel that an actuator needs>().
template <class F>
auto with_terms(const SeaParameters<double>& sea, F&& f) {
  if (is_late(sea)) return f.template operator()<kLateTerms>();
  if (is_extended(sea)) return f.template operator()<kExtendedTerms>();
  return f.template operator()<kLimitedTerms>();
}

}  // namespace ukemi::landing
