// Finds the largest value of each load of a run: by the tracker of the peak, whose place the square of the load takes;
// touches, impulses and rates of references are told by events. Included by body_follow.hpp alone.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "landing/body/body_record.hpp"
#include "landing/body/load.hpp"
#include "landing/run/peak_tracker.hpp"

namespace ukemi::landing {

template <class System>
class LoadObserver {
 public:
  using State = typename System::State;
  using Kind = Load::Kind;

  LoadObserver(const BodyScene& scene, const System& s) {
    for (const Load& l : scene.loads) items_.push_back({.of{l, s}, .own = own(l, scene.robot)});
  }

  /// `own`: of the acceleration that counts, told of the same step.
  template <class Integrator>
  void step(const System& s, Integrator& integrator, const PeakTracker& own) {
    for (Item& x : items_) {
      if (x.own) {
        x.peak = {std::sqrt(own.square), own.t};
      } else if (x.kind() == Kind::kImpulse) {
        if (x.down) gather(s, integrator, x);
      } else if (at_every_state(x.kind())) {
        const Square<Integrator> square{s, x, integrator.step()};
        (void)x.tracker.step(square, integrator);  // the run has judged the step
        x.last = square.peak_square(integrator.step().y_end, integrator.step().slope_end);
        x.peak = {x.of.value(std::sqrt(x.tracker.square)), x.tracker.t};
      }
    }
  }
  void jump() {
    for (Item& x : items_) x.tracker.jump();
  }
  void touchdown(int contact, double t) {
    for (Item& x : items_) {
      if (x.of.load().index != contact) continue;
      if (x.kind() == Kind::kTouch && x.peak.value == 0) x.peak = {1, t};
      if (x.kind() == Kind::kImpulse) x.down = true, x.impulse.setZero();
    }
  }
  /// The landing motions start.
  void land(const BodyMotion& motion, double t) {
    for (Item& x : items_)
      if (x.kind() == Kind::kReferenceRate)
        x.peak = {peak_reference_rate(motion[std::size_t(x.of.load().index)], t), t};
  }
  void liftoff(int contact, double t) {
    for (Item& x : items_)
      if (x.kind() == Kind::kImpulse && x.of.load().index == contact) lift(x, t);
  }
  std::vector<LoadPeak> finish(double t, const PeakTracker& own) {
    std::vector<LoadPeak> out;
    for (Item& x : items_) {
      if (x.down) lift(x, t);
      if (x.own) x.peak = {std::sqrt(own.square), own.t};
      out.push_back(x.peak);
    }
    return out;
  }

  /// The largest value / rating so far of those that a plan makes small.
  double worth() const {
    double out = 0;
    for (const Item& x : items_)
      if (!x.of.load().limit) out = std::max(out, x.peak.value / x.of.load().rating);
    return out;
  }
  /// The first limit that does not hold any more; -1: each holds.
  int exceeded() const {
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (items_[i].of.load().limit && items_[i].peak.value > items_[i].of.load().rating) return int(i);
    return -1;
  }
  /// See RestSquare; while a touch still gathers its impulse a run never rests.
  double rest_square(double own) const {
    RestSquare out(own);
    for (const Item& x : items_) {
      if (x.down) return -1;
      if (!x.own) out.add(x.kind(), large_square(x.of.load(), x.tracker.square), x.last);
    }
    return out.value();
  }

 private:
  struct Item {
    LoadValue<System> of;
    bool own = false;
    PeakTracker tracker{};
    double last = 0;  ///< the square at the end of the last step
    LoadPeak peak{};
    bool down = false;  ///< its touch has begun
    Vec2<double> impulse = Vec2<double>::Zero();
    Kind kind() const { return of.load().kind; }
  };
  /// What PeakTracker asks a system for, of one load.
  template <class Integrator>
  struct Square {
    const System& s;
    const Item& x;
    const typename std::remove_cvref_t<decltype(std::declval<Integrator&>().step())>& step;
    mutable double t = 0;  ///< of the state that the derivative was asked for

    State derivative(double time, const State& y) const {
      t = time;
      return x.kind() == Kind::kAcceleration ? s.derivative(time, y) : State(State::Zero());
    }
    double peak_square(const State& y, const State& dy) const {
      return x.of.square(s, &y == &step.y_end ? step.t + step.h : &y == &step.y ? step.t : t, y, dy);
    }
  };
  static void lift(Item& x, double t) {
    if (const double v = x.impulse.norm(); v > x.peak.value) x.peak = {v, t};
    x.down = false;
  }
  /// The step's part of the integral of the force.
  template <class Integrator>
  static void gather(const System& s, Integrator& integrator, Item& x) {
    for (const auto& [at, weight] : kImpulseNodes) {
      const State y = integrator.dense().at(at);
      x.impulse += weight * integrator.step().h * contact_force(s, x.of.load().index, s.pose(y), y);
    }
  }

  std::vector<Item> items_;
};

}  // namespace ukemi::landing
