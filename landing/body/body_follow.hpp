// One landing of a robot of any joints from event to event. Included by what compiles kernels, by no other.
#pragma once

#include <algorithm>
#include <cmath>

#include "landing/body/body_course.hpp"
#include "landing/body/body_record.hpp"
#include "landing/body/body_rest.hpp"
#include "landing/body/load_observer.hpp"
#include "landing/run/peak_tracker.hpp"

namespace ukemi::landing {

/// `Recorder`: what sees a run with kReport; it is made from the last argument of the constructor.
template <class Method, Capacity kSize, bool kReport, template <class, bool> class Recorder = BodyRecorder>
class BodyFollower {
 public:
  using Course = BodyCourse<kSize, kReport>;
  using System = typename Course::System;
  using State = typename System::State;

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
        abandon_(options.abandon_above * own_rating(scene)),
        impact_(impact_energy(system_)) {
    if (observed(scene)) loads_.emplace(scene, system_);
  }

  void follow() {
    State y = course_.released();
    if constexpr (kReport) recorder_.start(system_, y);
    const double fallen = kReport ? 0 : course_.fall(y);
    integrate::Integrator<Method, System> driver(
        system_, fallen, y,
        {.accuracy = course_.step_accuracy(options_.accuracy), .first_step = 1e-4, .max_step = options_.max_step});
    std::optional<End> end;
    for (long n = 0; !end; ++n) end = advance(driver, n);
    out_.end = *end, out_.t_end = t_, out_.work = driver.counters();
    out_.peak = std::sqrt(peak_.square), out_.t_peak = peak_.t;
    out_.first_touchdown = course_.first_touchdown(), out_.first_contact = course_.first_contact();
    const State& last = driver.state();
    const bool free = scene_.robot.base == Base::kFree;
    out_.base = {last[System::kX], free ? last[System::kY] : 0},
    out_.speed = {last[System::kVx], free ? last[System::kVy] : 0};
    if (loads_) {
      out_.loads = loads_->finish(t_, peak_);
      find_broken();
    }
    if constexpr (kReport) recorder_.finish();
  }

 private:
  int joints() const { return course_.joints(); }

  /// One step, and what it means for the landing: how the run ended, if it did.
  template <class Driver>
  std::optional<End> advance(Driver& driver, long n) {
    if (course_.longest_step() < Course::kNever) driver.limit_next_step(course_.longest_step());
    const integrate::Outcome outcome = driver.step(course_.stop());
    t_ = driver.time(), out_.status = outcome.status;
    if (n >= options_.max_steps) return failed(Failure::kSteps);
    if (outcome.status > integrate::Status::kEvent) return failed(Failure::kIntegration);
    if (!outcome.immediate && driver.step().h > 0) {
      if (!peak_.step(system_, driver)) return failed(Failure::kUnresolved);
      if (softened(driver.state())) return failed(Failure::kGivesWay);
      if constexpr (kReport) recorder_.step(system_, driver);
      if (loads_) bear(driver);
    }
    if (out_.broken && scene_.ends_broken) return End::kBroken;
    if (peak_.square > abandon_ * abandon_ || (loads_ && loads_->worth() > options_.abandon_above))
      return End::kAbandoned;
    if (options_.stopped(n)) return End::kStopped;
    if (outcome.event >= 0) return cross(driver, outcome.event), std::nullopt;
    if (outcome.status == integrate::Status::kReached) {
      if (t_ >= course_.limit()) return course_.touched() || !scene_.touches() ? End::kTimeLimit : End::kNoContact;
      if (course_.lands_at(t_)) land();
      course_.advance(t_), jump(driver);
    }
    const bool asked = options_.rest == SimulateOptions::Rest::kStop && course_.touched() && !course_.waits();
    const double least = loads_ ? loads_->rest_square(peak_.square) : peak_.square;
    if (asked && at_rest(system_, t_, driver.state(), least, impact_)) return End::kRest;
    return std::nullopt;
  }
  /// What the step brings to the loads.
  template <class Driver>
  [[gnu::noinline]] void bear(Driver& driver) {
    loads_->step(system_, driver, peak_);
    find_broken();
  }
  void find_broken() {
    if (out_.broken) return;
    if (const int load = loads_->exceeded(); load >= 0) out_.broken = {load, t_};
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
    State y = driver.state();
    course_.settle(t_, y);
    driver.refresh(y), peak_.jump();
    if (loads_) loads_->jump();
    if constexpr (kReport) recorder_.jump();
  }
  template <class Driver>
  void cross(Driver& driver, int event) {
    if constexpr (kReport) recorder_.row(system_, t_, driver.state());
    State y = driver.state();
    const typename Course::Crossing crossing = course_.cross(event, t_, y);
    const int touched = crossing.touched;
    driver.refresh(y);
    if (loads_ && crossing.surface) {
      touched >= 0 ? loads_->touchdown(touched, t_) : loads_->liftoff(event / System::kOfContact, t_);
      find_broken();
    }
    if (crossing.lands) land();
    jump(driver);
    if constexpr (kReport) {
      const bool bottoms = event < System::kJointGuards && event % System::kOfContact == System::kBottom;
      if (crossing.surface || bottoms) recorder_.force_jumps(t_);
      if (touched >= 0) recorder_.touchdown(touched, t_);
      if (crossing.surface && touched < 0) recorder_.liftoff(event / System::kOfContact, t_);
      recorder_.row(system_, t_, driver.state());
    }
  }

  void land() {
    if (loads_) loads_->land(motion_, t_), find_broken();
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
  double t_ = 0, abandon_, impact_;
};

}  // namespace ukemi::landing
