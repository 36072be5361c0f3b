// Finds the largest value of each load of a run: by the tracker of the peak, whose place the square of the load takes;
// a touch and an impulse are told by events. Included by body_follow.hpp alone.
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
    for (const Load& l : scene.loads) {
      Item item{.load = &l, .own = own(l, scene.robot)};
      if (l.kind == Kind::kAcceleration)
        item.arms = shifted(s.body, s.body.origin[std::size_t(l.index)], l.index, l.at);
      item.index = l.index;
      for (int i = 0; i < s.body.joints; ++i)
        if (of_joint(l.kind) && s.body.joint[i].joint == l.index) item.index = i;
      items_.push_back(item);
    }
  }

  /// `own`: of the acceleration that counts, told of the same step.
  template <class Integrator>
  void step(const System& s, Integrator& integrator, const PeakTracker& own) {
    for (Item& x : items_) {
      if (x.own) {
        x.peak = {std::sqrt(own.square), own.t};
      } else if (x.load->kind == Kind::kImpulse) {
        if (x.down) gather(s, integrator, x);
      } else if (x.load->kind != Kind::kTouch) {
        const Square<Integrator> square{s, x, integrator.step()};
        (void)x.tracker.step(square, integrator);  // the run has judged the step
        x.last = square.peak_square(integrator.step().y_end, integrator.step().slope_end);
        x.peak = {value(x, std::sqrt(x.tracker.square)), x.tracker.t};
      }
    }
  }
  void jump() {
    for (Item& x : items_) x.tracker.jump();
  }
  void touchdown(int contact, double t) {
    for (Item& x : items_) {
      if (x.load->index != contact) continue;
      if (x.load->kind == Kind::kTouch && x.peak.value == 0) x.peak = {1, t};
      if (x.load->kind == Kind::kImpulse) x.down = true, x.impulse.setZero();
    }
  }
  void liftoff(int contact, double t) {
    for (Item& x : items_)
      if (x.load->kind == Kind::kImpulse && x.load->index == contact) lift(x, t);
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
      if (!x.load->limit) out = std::max(out, x.peak.value / x.load->rating);
    return out;
  }
  /// The first limit that does not hold any more; -1: each holds.
  int exceeded() const {
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (items_[i].load->limit && items_[i].peak.value > items_[i].load->rating) return int(i);
    return -1;
  }
  /// The square by which a run is judged to rest: of the smallest acceleration that is asked for; where another load
  /// stands near its largest value, of a ten-thousandth of it; while a touch still gathers its impulse never.
  double rest_square(double square) const {
    constexpr double kNear = 0.81, kFiner = 1e-8;  // of squares
    bool near = false;
    for (const Item& x : items_) {
      if (x.down) return -1;
      if (x.own || x.tracker.square == 0) continue;
      if (x.load->kind == Kind::kAcceleration)
        square = std::min(square, x.tracker.square);
      else
        near = near || x.last > kNear * x.tracker.square;
    }
    return near ? kFiner * square : square;
  }

 private:
  struct Item {
    const Load* load;
    bool own = false;
    int index = 0;  ///< of the system's joints or contacts
    Arms<double, System::kB> arms{};
    PeakTracker tracker{};
    double last = 0;  ///< the square at the end of the last step
    LoadPeak peak{};
    bool down = false;  ///< its touch has begun
    Vec2<double> impulse = Vec2<double>::Zero();
  };
  static bool of_joint(Kind k) {
    return k == Kind::kTorque || k == Kind::kDeflection || k == Kind::kMotorSpeed || k == Kind::kMotorTorque ||
           k == Kind::kAngle;
  }
  /// From what is tracked, the distance from the middle of the range.
  static double value(const Item& x, double tracked) {
    return x.load->kind == Kind::kAngle ? std::max(0.0, tracked - 0.5 * (x.load->phi[1] - x.load->phi[0])) : tracked;
  }
  static double tracked(const System& s, const Item& x, double t, const State& y) {
    if (x.load->kind == Kind::kForce)
      return x.index < s.body.contacts ? contact_force(s, x.index, s.pose(y), y).norm() : 0;
    const SeaState<double> q = s.joint_state(x.index, y);
    const auto& drive = s.drive[x.index];
    // A step may end a rounding beyond the limit of a torque.
    const auto motor = [&] { return std::min(motor_demand(s, x.index, t, q).second, drive.sea.tau_max); };
    switch (x.load->kind) {
      case Kind::kDeflection:
        return q.phi_m - q.phi;
      case Kind::kMotorSpeed:
        return motor_demand(s, x.index, t, q).first;
      case Kind::kMotorTorque:
        return drive.kind == DriveKind::kGeared ? motor() : motor_demand(s, x.index, t, q).second;
      case Kind::kAngle:
        return q.phi - 0.5 * (x.load->phi[0] + x.load->phi[1]);
      default:
        break;
    }
    if (drive.kind == DriveKind::kGeared) return motor();
    if (drive.kind == DriveKind::kPassive) return drive.stiffness * (q.phi - drive.rest) + drive.damping * q.dphi;
    return std::min(std::abs(spring_torque<System::kSea>(drive.sea, q)), drive.sea.tau_max);
  }
  /// What PeakTracker asks a system for, of one load.
  template <class Integrator>
  struct Square {
    const System& s;
    const Item& x;
    const typename std::remove_cvref_t<decltype(std::declval<Integrator&>().step())>& step;
    mutable double t = 0;  ///< of the state that the derivative was asked for

    State derivative(double time, const State& y) const {
      t = time;
      return x.load->kind == Kind::kAcceleration ? s.derivative(time, y) : State(State::Zero());
    }
    double peak_square(const State& y, const State& dy) const {
      return at(y, dy, &y == &step.y_end ? step.t + step.h : &y == &step.y ? step.t : t);
    }
    double at(const State& y, const State& dy, double time) const {
      if (x.load->kind == Kind::kAcceleration)
        return acceleration(x.arms, s.pose(y), s.accelerations_of(dy), s.body.bodies).squaredNorm();
      const double v = tracked(s, x, time, y);
      return v * v;
    }
  };
  static void lift(Item& x, double t) {
    if (const double v = x.impulse.norm(); v > x.peak.value) x.peak = {v, t};
    x.down = false;
  }
  /// The step's part of the integral of the force, by Gauss and Legendre's five points.
  template <class Integrator>
  static void gather(const System& s, Integrator& integrator, Item& x) {
    constexpr std::array<double, 5> kAt = {0.5, 0.23076534494715845, 0.7692346550528415, 0.04691007703066802,
                                           0.9530899229693319},
                                    kWeight = {0.28444444444444444, 0.23931433524968324, 0.23931433524968324,
                                               0.11846344252809454, 0.11846344252809454};
    for (std::size_t k = 0; k < kAt.size(); ++k) {
      const State y = integrator.dense().at(kAt[k]);
      x.impulse += kWeight[k] * integrator.step().h * contact_force(s, x.index, s.pose(y), y);
    }
  }

  std::vector<Item> items_;
};

}  // namespace ukemi::landing
