// The discrete course of a landing of a robot of links, for every scalar: the release, and the changes at events and
// deadlines. The scalar run (body_follow.hpp) and the one with derivatives
// (landing/derivatives) only step from one to the next.
//
// Every driven joint starts its motion at the first touchdown of any contact, detection_delay later, from where its
// reference is then, and holds phi_F once its own duration is over; before it the move in the air, where it has one.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "landing/body/body_scene.hpp"
#include "landing/body/body_system.hpp"
#include "landing/body/places.hpp"
#include "landing/model/release.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

template <Capacity kSize, bool kAccounts, Scalar T = double>
class BodyCourse {
 public:
  using System = BodySystem<kSize, kAccounts, T>;
  using State = typename System::State;
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  /// Before released(), `system`, `motion` and `drop` may be seeded with derivatives.
  BodyCourse(const BodyScene& scene, const BodyMotion& motions)
      : system(scene.robot, scene.slope),
        drop{T(scene.drop.height), T(scene.drop.forward_speed), T(scene.drop.pitch), T(scene.drop.pitch_rate),
             T(scene.drop.vertical_speed)},
        scene_(scene) {
    if (!scene.floor) system.body.contacts = 0;
    system.shaped = kDerivatives<T> > 0;  // derivatives by a shape term of 0
    for (int i = 0; i < joints(); ++i) {
      const Motion& m = motions[std::size_t(system.body.joint[i].joint)];
      motion[i] = m.cast<T>();
      system.shaped = system.shaped || has_bumps(m);
      if (value_of(system.drive[i].sea.tau_max) == 0) system.joint[i].saturation = 1;  // one branch, never left
      reposition_deadline_[i] = driven(i) && m.reposition ? m.reposition->from : kNever;
      motion_end_[i] = kNever;
    }
  }

  System system;
  std::array<MotionOf<T>, kSize.joints> motion{};
  DropOf<T> drop;

  int joints() const { return system.body.joints; }
  const Joint& joint_of(int i) const { return scene_.robot.joints[std::size_t(system.body.joint[i].joint)]; }
  bool driven(int i) const { return joint_of(i).driven(); }
  bool touched() const { return first_touchdown_ < kNever; }
  /// The first touchdown has happened, the landing motions have not started.
  bool detecting() const { return detection_ < kNever; }
  /// Time limit of the run [s], and whether it moves with the first touchdown.
  double limit() const { return t_limit_; }
  bool limit_moves() const { return !scene_.t_end && touched(); }
  /// The next deadline, which no step may cross [s].
  double stop() const {
    double t = std::min(t_limit_, detection_);
    for (int i = 0; i < joints(); ++i) t = std::min({t, reposition_deadline_[i], motion_end_[i]});
    return t;
  }
  /// Maximum step while a reference moves, so that no step skips the motion [s].
  double longest_step() const { return max_step_; }

  /// Accuracy of the steps: `requested`, or finer if the friction of a drive requires it.
  double step_accuracy(double requested) const {
    double out = requested;
    for (int i = 0; i < joints(); ++i) {
      SeaParameters<double> sea = joint_of(i).sea;
      if (joint_of(i).kind == DriveKind::kGeared) sea.output_friction = sea.friction + sea.spring_loss;
      out = std::min(out, landing::step_accuracy(requested, sea));
    }
    return out;
  }

  /// State at release: the drop's speeds, joints at their angles and rates of release, springs relaxed.
  State released() {
    t_limit_ = scene_.t_end.value_or(flight_limit());
    State y = State::Zero();
    y[System::kTheta] = drop.pitch - T(scene_.slope);
    if (!system.body.first_fixed) y[System::kOmega] = drop.pitch_rate;
    for (int i = 0; i < joints(); ++i) {
      const TreeJoint& at = system.body.joint[i];
      const T phi = driven(i) ? motion[i].release_phi() : T(joint_of(i).phi),
              rate = driven(i) ? motion[i].release_rate() : T(0);
      // A pinned joint measures its angle against the true level.
      const T theta = at.parent >= 0 ? y[System::kTheta + at.parent] : T(-scene_.slope);
      if (at.parent >= 0 || driven(i)) y[System::kTheta + at.child] = theta + phi - T(at.offset);
      if (at.parent >= 0 || driven(i))
        y[System::kOmega + at.child] = (at.parent >= 0 ? y[System::kOmega + at.parent] : T(0)) + rate;
      y[System::kPhiM + i] = phi, y[System::kOmegaM + i] = joint_of(i).kind == DriveKind::kElastic ? rate : T(0);
      system.piece[i] = constant_reference(motion[i].release_phi());
    }
    place_base(y);
    system.settle_lags_at(0.0, y);
    system.settle(0.0, y);
    return y;
  }

  /// A free fall in closed form.
  struct Fall {
    double until = 0;   ///< the first touchdown, or the first deadline; 0: there is none [s]
    State start, rate;  ///< at release
    double first_step() const { return until > 0 ? 1e-3 : 1e-4; }  ///< after it [s]

    State at(double t) const {
      State y = start;
      for (const int k : {System::kX, System::kY}) {
        const int v = k + int(System::kPositions);
        y[k] += T(t) * (start[v] + T(0.5 * t) * rate[v]), y[v] += T(t) * rate[v];
      }
      return y;
    }
  };
  /// The fall from release at y, if no joint or link turns or accelerates relative to the base.
  Fall fall(const State& y) const {
    constexpr double kShort = 1e-5;   // a shorter fall is not worth it [s]
    constexpr double kBelow = 1e-14;  // so that rounding leaves no contact above the floor [s]
    constexpr double kStill = 1e-8;   // rounding error of an acceleration of 0 [rad/s^2], [m/s^2]
    constexpr int kAngles = int(System::kVx) - int(System::kTheta), kTail = int(System::kOmega);
    const Body<T, kSize>& body = system.body;
    Fall out{.start = y};
    const auto in_free_fall = [&](double t, const State& at, State& rate) {
      system.derivative(t, at, rate);
      const auto largest = [&rate](int from, int to) {
        double found = 0;
        for (int k = from; k < to; ++k) found = std::max(found, std::abs(value_of(rate[k])));
        return found;
      };
      return largest(System::kTheta, System::kTheta + kAngles) == 0 && largest(kTail, int(rate.size())) <= kStill;
    };
    const bool rail_stop = std::any_of(body.stop.begin() + body.stops_begin, body.stop.begin() + body.stops_end,
                                       [](auto& s) { return s.joint < 0; });
    if (body.base == Base::kPinned || rail_stop || !in_free_fall(0, y, out.rate)) return out;
    const typename System::Pose p = system.pose(y);
    const typename System::Accelerations acc = system.accelerations_of(out.rate);
    double t = kNever;
    for (int i = 0; i < body.contacts; ++i) {
      const typename System::Point at = system.point_at(i, p, &acc);
      t = std::min(t,
                   landing::fall_time(-value_of(at.a), value_of(T(at.y - system.point[i].thickness)), value_of(at.v)));
    }
    if (!(t > kShort && t < kNever)) return out;
    t = std::min(t + kBelow, stop());
    State rate;
    if (in_free_fall(0, out.at(t), rate) &&
        std::hypot(value_of(T(rate[System::kVx] - out.rate[System::kVx])),
                   value_of(T(rate[System::kVy] - out.rate[System::kVy]))) <= kStill)
      out.until = t;
    return out;
  }

  /// The mode change of guard `event`, which fell through zero at time t.
  struct Crossing {
    int touched = -1;      ///< the contact that touches down
    bool surface = false;  ///< it touches down or lifts off
    bool lands = false;    ///< the landing motions start now: call `land`
  };
  Crossing cross(int event, const T& t, State& y) {
    Crossing out{.touched = system.cross(event, y)};
    out.surface = event < System::kJointGuards && event % System::kGuardsPerContact == System::kSurface &&
                  !system.is_stop(event / System::kGuardsPerContact);
    if (out.touched < 0 || touched()) return out;
    first_touchdown_ = value_of(t);
    if (!scene_.t_end) t_limit_ = first_touchdown_ + Scene::kFollow;
    detection_ = first_touchdown_ + scene_.detection_delay;
    out.lands = scene_.detection_delay == 0;
    return out;
  }
  /// After a crossing and after `land`: places that friction no longer holds start to slip.
  void settle(double t, State& y) { system.hold_or_slip(t, y); }
  /// Whether the landing motions start at the deadline t; other changes are made by `advance`.
  bool lands_at(double t) const { return t + kRounding >= detection_; }
  /// Starts the landing motions.
  void land(const T& t) {
    detection_ = kNever;
    for (int i = 0; i < joints(); ++i) {
      if (!driven(i)) continue;
      set_piece(i, ReferenceChange::kLand, t), system.joint[i].phase = Phase::kMoving;
      reposition_deadline_[i] = kNever, motion_end_[i] = value_of(t) + value_of(motion[i].duration);
      system.drive[i].sea = with_landing_gains(system.drive[i].sea, motion[i]);
    }
    update_longest_step();
  }
  /// Changes at a deadline other than `land`: references begin and end, smoothly.
  void advance(double t) {
    for (int i = 0; i < joints(); ++i) {
      Phase& phase = system.joint[i].phase;
      if (t + kRounding >= motion_end_[i]) phase = Phase::kAfter, motion_end_[i] = kNever;
      if (!(t + kRounding >= reposition_deadline_[i])) continue;
      const bool begins = phase == Phase::kBefore && reposition_deadline_[i] == value_of(motion[i].reposition->from);
      set_piece(i, begins ? ReferenceChange::kReposition : ReferenceChange::kHoldInitial, T(t));
      phase = begins ? Phase::kMoving : Phase::kBefore;
      reposition_deadline_[i] = begins ? value_of(motion[i].reposition->to) : kNever;
    }
    update_longest_step();
  }

 private:
  static constexpr double kRounding = 1e-14;  // [s]

  /// Time limit before the first touchdown: an upper bound of the flight, plus Scene::kFollow [s].
  double flight_limit() const {
    const Robot& robot = scene_.robot;
    double rates = std::abs(scene_.drop.pitch_rate);
    for (int i = 0; i < joints(); ++i)
      if (driven(i)) rates += std::abs(value_of(motion[i].release_rate()));
    const double g = robot.gravity, twice_reach = 2 * reach(robot),
                 rise = twice_reach * rates + std::max(0.0, scene_.drop.vertical_speed);
    if (!scene_.touches() || !(g > 0) || robot.base == Base::kPinned) return Scene::kFollow;
    return (rise + std::sqrt(rise * rise + 2 * g * (scene_.drop.height + 2 * twice_reach))) / g + Scene::kFollow;
  }

  /// Places the base as the drop says.
  void place_base(State& y) {
    const Robot& robot = scene_.robot;
    const typename System::Pose p = system.pose(y);
    if (robot.base == Base::kPinned) {
      system.base = {T(0), T(robot.pin_height)};
      return;
    }
    T lowest(kNever);
    for (int i = 0; i < int(robot.contacts.size()); ++i) {  // also without a floor
      const T surface = system.point_at(i, p).y - system.point[i].thickness;
      if (value_of(surface) < value_of(lowest)) lowest = surface;
    }
    // Above the floor by more than rounding: a point that starts below it at rest would have no touchdown.
    constexpr double kOnFloor = 1e-12;  // [m]
    const T height = drop.height + T(std::max(0.0, kOnFloor - value_of(drop.height)));
    const T lift = value_of(lowest) < kNever ? T(height - lowest) : height;
    if (robot.base == Base::kRail) {
      system.base = {T(0), lift};
      if (present(drop.vertical_speed)) y[System::kVx] = drop.vertical_speed / T(std::sin(robot.rail_direction));
      return;
    }
    const auto at = shifted(system.body, system.body.first, 0, scene_.drop_at);
    const auto place = position(at, p, system.body.bodies), speed = velocity(at, p, system.body.bodies);
    const T v = drop.forward_speed, up = drop.vertical_speed, c(std::cos(scene_.slope)), s(std::sin(scene_.slope));
    y[System::kX] = -place[0], y[System::kY] = lift;
    y[System::kVx] = v * c + up * s - speed[0], y[System::kVy] = -v * s + up * c - speed[1];
  }

  void set_piece(int i, ReferenceChange to, const T& t) {
    system.piece[i] = piece_after(to, motion[i], system.piece[i], t);
  }
  void update_longest_step() {
    constexpr double kFraction = 0.125;
    double shortest = kNever;
    for (int i = 0; i < joints(); ++i) {
      const ReferencePiece<T>& piece = system.piece[i];
      if (system.joint[i].phase == Phase::kMoving && (value_of(piece.a) != value_of(piece.b) || has_bumps(motion[i])))
        shortest = std::min(shortest, value_of(piece.duration));
    }
    max_step_ = kFraction * shortest;
  }

  const BodyScene& scene_;
  std::array<double, kSize.joints> reposition_deadline_{}, motion_end_{};
  double t_limit_ = kNever, first_touchdown_ = kNever, detection_ = kNever, max_step_ = kNever;
};

}  // namespace ukemi::landing
