// Finds the largest value of each load of a run: by PeakTracker on the square of the load; touches, impulses and rates
// of references come from events. Included only by body_follow.hpp.
#pragma once

#include <cmath>
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
    for (const Load& l : scene.loads)
      items_.push_back(
          {.evaluator{l, s}, .is_peak = is_peak_acceleration(l, scene.robot), .limit = rating_limit(l, scene.robot)});
  }

  /// `peak`: the tracker of the peak point, already updated with this step.
  template <class Integrator>
  void step(const System& s, Integrator& integrator, const PeakTracker& peak) {
    for (Item& x : items_) {
      if (x.is_peak) {
        x.peak = {std::sqrt(peak.square), peak.t};
      } else if (x.kind() == Kind::kImpulse) {
        if (x.touching) integrate_impulse(s, integrator, x);
      } else if (is_state_function(x.kind())) {
        const Square<Integrator> square{s, x, integrator.step()};
        (void)x.tracker.step(square, integrator);  // the follower has checked the step
        x.last = square.peak_square(integrator.step().y_end, integrator.step().slope_end);
        x.peak = {x.evaluator.value(std::sqrt(x.tracker.square)), x.tracker.t};
      }
    }
  }
  void jump() {
    for (Item& x : items_) x.tracker.jump();
  }
  void touchdown(int contact, double t) {
    for (Item& x : items_) {
      if (x.evaluator.load().index != contact) continue;
      if (x.kind() == Kind::kTouch && x.peak.value == 0) x.peak = {1, t};
      if (x.kind() == Kind::kImpulse) x.touching = true, x.impulse.setZero();
    }
  }
  /// Called when the landing motions start.
  void land(const BodyMotion& motion, double t) {
    for (Item& x : items_)
      if (x.kind() == Kind::kReferenceRate)
        x.peak = {peak_reference_rate(motion[std::size_t(x.evaluator.load().index)], t), t};
  }
  void liftoff(int contact, double t) {
    for (Item& x : items_)
      if (x.kind() == Kind::kImpulse && x.evaluator.load().index == contact) close_touch(x, t);
  }
  std::vector<LoadPeak> finish(double t, const PeakTracker& peak) {
    std::vector<LoadPeak> out;
    for (Item& x : items_) {
      if (x.touching) close_touch(x, t);
      if (x.is_peak) x.peak = {std::sqrt(peak.square), peak.t};
      out.push_back(x.peak);
    }
    return out;
  }

  /// The largest value / rating so far of the loads that a plan minimises.
  double worth() const {
    double out = 0;
    for (const Item& x : items_)
      if (!x.evaluator.load().limit) out = std::max(out, x.peak.value / x.evaluator.load().rating);
    return out;
  }
  /// Index of the first broken limit; -1: none.
  int exceeded() const {
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (items_[i].evaluator.load().limit && items_[i].peak.value > items_[i].limit) return int(i);
    return -1;
  }
  /// See RestSquare; -1, never at rest, during a touch whose impulse is a load.
  double rest_square(double peak_square) const {
    RestSquare out(peak_square);
    for (const Item& x : items_) {
      if (x.touching) return -1;
      if (!x.is_peak) out.add(x.kind(), reference_square(x.evaluator.load(), x.tracker.square), x.last);
    }
    return out.value();
  }

 private:
  struct Item {
    LoadValue<System> evaluator;
    bool is_peak = false;  ///< the acceleration of the peak point
    double limit;          ///< see rating_limit
    PeakTracker tracker{};
    double last = 0;  ///< the square at the end of the last step
    LoadPeak peak{};
    bool touching = false;  ///< its contact touches
    Vec2<double> impulse = Vec2<double>::Zero();
    Kind kind() const { return evaluator.load().kind; }
  };
  /// The square of one load, with the interface of a system for PeakTracker.
  template <class Integrator>
  struct Square {
    const System& s;
    const Item& x;
    const typename std::remove_cvref_t<decltype(std::declval<Integrator&>().step())>& step;
    mutable double t = 0;  ///< of the state of the last derivative()

    State derivative(double time, const State& y) const {
      t = time;
      return x.kind() == Kind::kAcceleration ? s.derivative(time, y) : State(State::Zero());
    }
    double peak_square(const State& y, const State& dy) const {
      return x.evaluator.square(s, &y == &step.y_end ? step.t + step.h : &y == &step.y ? step.t : t, y, dy);
    }
  };
  static void close_touch(Item& x, double t) {
    if (const double v = x.impulse.norm(); v > x.peak.value) x.peak = {v, t};
    x.touching = false;
  }
  /// Adds the integral of the force over the step.
  template <class Integrator>
  static void integrate_impulse(const System& s, Integrator& integrator, Item& x) {
    for (const auto& [at, weight] : kImpulseNodes) {
      const State y = integrator.dense().at(at);
      x.impulse += weight * integrator.step().h * contact_force(s, x.evaluator.load().index, s.pose(y), y);
    }
  }

  std::vector<Item> items_;
};

}  // namespace ukemi::landing
