// One landing of a robot of links from event to event. Included only by files that compile kernels.
#pragma once

#include <algorithm>
#include <cmath>

#include "landing/body/body_course.hpp"
#include "landing/body/body_record.hpp"
#include "landing/body/body_rest.hpp"
#include "landing/body/load_observer.hpp"
#include "landing/run/peak_tracker.hpp"

namespace ukemi::landing {

/// `Recorder` observes a run with kReport; it is constructed from the last argument of the constructor.
template <class Method, Capacity kSize, bool kReport, template <class, bool> class Recorder = BodyRecorder>
class BodyFollower {
 public:
  using Course = BodyCourse<kSize, kReport>;
  using System = typename Course::System;
  using State = typename System::State;
  static_assert(kMaxContacts <= ContactOrder::kMaxPoints);

  template <class Recorded>
  BodyFollower(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options, BodyLanding& out,
               const Recorded& recorded)
      : scene_(scene),
        motion_(motion),
        options_(options),
        out_(out),
        course_(scene, motion),
        system_(course_.system),
        recorder_(scene, out, recorded),
        abandon_peak_(options.abandon_above * peak_rating(scene)),
        rest_energy_(system_, options.accuracy) {
    if (observed(scene)) loads_.emplace(scene, system_);
  }

  void follow() {
    const State y = course_.released();
    if constexpr (kReport) recorder_.start(system_, y);
    const typename Course::Fall fall = course_.fall(y);
    if constexpr (kReport)
      if (fall.until > 0) recorder_.fall(system_, fall);
    integrate::Integrator<Method, System> integrator(system_, fall.until, fall.at(fall.until),
                                                     {.accuracy = course_.step_accuracy(options_.accuracy),
                                                      .first_step = std::min(fall.first_step(), options_.max_step),
                                                      .max_step = options_.max_step});
    std::optional<End> end;
    for (long n = 0; !end; ++n) end = advance(integrator, n);
    out_.end = *end, out_.t_end = t_, out_.work = integrator.counters();
    out_.peak = std::sqrt(peak_.square), out_.t_peak = peak_.t;
    const State& last = integrator.state();
    const bool free = scene_.robot.base == Base::kFree;
    out_.base = {last[System::kX], free ? last[System::kY] : 0},
    out_.speed = {last[System::kVx], free ? last[System::kVy] : 0};
    for (int j = 0; j < system_.body.bodies; ++j) out_.theta[std::size_t(j)] = last[System::kTheta + j];
    if (loads_) {
      out_.loads = loads_->finish(t_, peak_);
      check_limits();
    }
    if constexpr (kReport) recorder_.finish();
  }

 private:
  int joints() const { return course_.joints(); }

  /// Takes a step and handles its event or deadline. Returns how the run ended, if it did.
  template <class Integrator>
  std::optional<End> advance(Integrator& integrator, long n) {
    if (course_.longest_step() < Course::kNever) integrator.limit_next_step(course_.longest_step());
    const integrate::Outcome outcome = integrator.step(course_.stop());
    t_ = integrator.time(), out_.status = outcome.status;
    if (n >= options_.max_steps) return fail(Failure::kSteps);
    if (outcome.status > integrate::Status::kEvent) return fail(Failure::kIntegration);
    if (!outcome.immediate && integrator.step().h > 0) {
      const double before = peak_.square;
      if (!peak_.step(system_, integrator)) return fail(Failure::kUnresolved);
      if (peak_.square != before) out_.peak_contact = out_.contacts.size() - 1;
      out_.joint_lost = out_.joint_lost || any(system_.lost_joint(integrator.state()));
      if (spring_gave_way(integrator.state())) return fail(Failure::kGivesWay);
      if constexpr (kReport) recorder_.step(system_, integrator);
      if (loads_) update_loads(integrator);
    }
    if (out_.broken && scene_.ends_broken) return End::kBroken;
    if (peak_.square > abandon_peak_ * abandon_peak_ || (loads_ && loads_->worth() > options_.abandon_above))
      return End::kAbandoned;
    if (options_.stopped(n)) return End::kStopped;
    if (outcome.event >= 0) return cross(integrator, outcome.event), std::nullopt;
    if (outcome.status == integrate::Status::kReached) {
      if (t_ >= course_.limit()) return course_.touched() || !scene_.touches() ? End::kTimeLimit : End::kNoContact;
      if (course_.lands_at(t_)) land();
      course_.advance(t_), jump(integrator);
    }
    const bool may_rest = options_.rest == SimulateOptions::Rest::kStop && course_.touched() && !course_.detecting();
    return may_rest && rest_test_.due(double(n)) && rests(n, integrator.state()) ? std::optional(End::kRest)
                                                                                 : std::nullopt;
  }
  bool rests(long step, const State& y) {
    const double square = loads_ ? loads_->rest_square(peak_.square) : peak_.square;
    return rest_test_(double(step), system_, t_, y, rest_energy_(square));
  }
  /// Tracks the loads in the step.
  template <class Integrator>
  [[gnu::noinline]] void update_loads(Integrator& integrator) {
    loads_->step(system_, integrator, peak_);
    check_limits();
  }
  void check_limits() {
    if (out_.broken) return;
    if (const int load = loads_->exceeded(); load >= 0) out_.broken = {load, t_};
  }
  bool spring_gave_way(const State& y) const {
    for (int i = 0; i < joints(); ++i) {
      const auto& sea = system_.drive[i].sea;
      const SeaState<double> s = system_.joint_state(i, y);
      if (system_.drive[i].kind == DriveKind::kElastic && gives_way(sea.k_sea, sea.k_sea_cubic, s.phi_m - s.phi))
        return true;
    }
    return false;
  }
  End fail(Failure why) {
    out_.failure = why;
    return End::kFailed;
  }
  template <class Integrator>
  void jump(Integrator& integrator) {
    State y = integrator.state();
    course_.settle(t_, y);
    integrator.refresh(y), peak_.jump();
    if (loads_) loads_->jump();
    if constexpr (kReport) recorder_.jump();
  }
  template <class Integrator>
  void cross(Integrator& integrator, int event) {
    if constexpr (kReport) recorder_.row(system_, t_, integrator.state());
    State y = integrator.state();
    const typename Course::Crossing crossing = course_.cross(event, t_, y);
    const int touched = crossing.touched;
    integrator.refresh(y);
    if (crossing.surface) {
      const int lifted = event / System::kGuardsPerContact;
      touched >= 0 ? out_.contacts.touchdown(touched, t_) : out_.contacts.liftoff(lifted, t_);
      if (loads_) {
        touched >= 0 ? loads_->touchdown(touched, t_) : loads_->liftoff(lifted, t_);
        check_limits();
      }
    }
    if (touched >= 0 && options_.touchdowns) options_.touchdowns->push_back(t_);
    if (crossing.lands) land();
    jump(integrator);
    if constexpr (kReport) {
      const bool bottoms = event < System::kJointGuards && event % System::kGuardsPerContact == System::kBottom;
      if (crossing.surface || bottoms) recorder_.force_jumps(t_);
      if (touched >= 0) recorder_.touchdown(touched, t_);
      if (crossing.surface && touched < 0) recorder_.liftoff(event / System::kGuardsPerContact, t_);
      recorder_.row(system_, t_, integrator.state());
    }
  }

  void land() {
    if (loads_) loads_->land(motion_, t_), check_limits();
    course_.land(t_);
  }

  const BodyScene& scene_;
  const BodyMotion& motion_;
  const SimulateOptions& options_;
  BodyLanding& out_;
  Course course_;
  System& system_;
  Recorder<System, kReport> recorder_;
  PeakTracker peak_;
  std::optional<LoadObserver<System>> loads_;
  double t_ = 0, abandon_peak_;
  RestEnergy rest_energy_;
  RestTest rest_test_;
};

}  // namespace ukemi::landing
