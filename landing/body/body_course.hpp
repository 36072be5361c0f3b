// The discrete course of a landing of a robot of links, told once for every scalar: how it is released, what every
// event and every deadline changes. The scalar run (body_follow.hpp) and the one with derivatives
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

  /// What is played by each joint of `system`, and how the robot falls: to be seeded with derivatives before
  /// released().
  BodyCourse(const BodyScene& scene, const BodyMotion& given)
      : system(scene.robot, scene.slope),
        drop{T(scene.drop.height), T(scene.drop.forward_speed), T(scene.drop.pitch), T(scene.drop.pitch_rate),
             T(scene.drop.vertical_speed)},
        scene_(scene) {
    if (!scene.floor) system.body.contacts = 0;
    for (int i = 0; i < joints(); ++i) {
      const Motion& m = given[std::size_t(system.body.joint[i].joint)];
      motion[i] = m.cast<T>();
      if (value_of(system.drive[i].sea.tau_max) == 0) system.joint[i].saturation = 1;  // one branch, never left
      air_[i] = driven(i) && m.reposition ? m.reposition->from : kNever;
      end_[i] = kNever;
    }
  }

  System system;
  std::array<MotionOf<T>, kSize.joints> motion{};
  DropOf<T> drop;

  int joints() const { return system.body.joints; }
  const Joint& joint_of(int i) const { return scene_.robot.joints[std::size_t(system.body.joint[i].joint)]; }
  bool driven(int i) const { return joint_of(i).driven(); }
  bool touched() const { return first_touchdown_ < kNever; }
  double first_touchdown() const { return first_touchdown_; }
  int first_contact() const { return first_contact_; }
  /// The landing motions still wait for their start.
  bool waits() const { return detected_ < kNever; }
  /// Where the run ends at the latest [s], and whether that moves with the first touchdown.
  double limit() const { return limit_; }
  bool limit_moves() const { return !scene_.t_end && touched(); }
  /// The next deadline: no step goes beyond it [s].
  double stop() const {
    double t = std::min(limit_, detected_);
    for (int i = 0; i < joints(); ++i) t = std::min({t, air_[i], end_[i]});
    return t;
  }
  /// A step while a reference moves is no longer, or the motion is passed over [s].
  double longest_step() const { return longest_; }

  /// Of the steps: no looser than what the drives' friction asks for.
  double step_accuracy(double asked) const {
    double out = asked;
    for (int i = 0; i < joints(); ++i) {
      SeaParameters<double> sea = joint_of(i).sea;
      if (joint_of(i).kind == DriveKind::kGeared) sea.output_friction = sea.friction + sea.spring_loss;
      out = std::min(out, landing::step_accuracy(asked, sea));
    }
    return out;
  }

  /// At rest but for the drop's speeds, the joints at phi_I or where passive ones are let go, their springs relaxed.
  State released() {
    limit_ = scene_.t_end.value_or(flight_limit());
    State y = State::Zero();
    y[System::kTheta] = drop.pitch - T(scene_.slope);
    if (!system.body.first_stays) y[System::kOmega] = drop.pitch_rate;
    for (int i = 0; i < joints(); ++i) {
      const JointPlace& at = system.body.joint[i];
      const T phi = driven(i) ? motion[i].release_phi() : T(joint_of(i).phi),
              rate = driven(i) ? motion[i].release_rate() : T(0);
      // The ground of a pinned joint is the true one.
      const T theta = at.parent >= 0 ? y[System::kTheta + at.parent] : T(-scene_.slope);
      if (at.parent >= 0 || driven(i)) y[System::kTheta + at.child] = theta + phi - T(at.offset);
      if (at.parent >= 0 || driven(i))
        y[System::kOmega + at.child] = (at.parent >= 0 ? y[System::kOmega + at.parent] : T(0)) + rate;
      y[System::kPhiM + i] = phi, y[System::kOmegaM + i] = joint_of(i).kind == DriveKind::kElastic ? rate : T(0);
      system.piece[i] = standing_at(motion[i].release_phi());
    }
    place(y);
    system.settle_lags(0.0, y);
    system.settle(0.0, y);
    return y;
  }

  /// Where nothing turns and nothing strains the first flight is closed-form: only the base moves, as under gravity.
  /// Moves y, as it was released, to shortly before the first touchdown or to the first deadline, and returns when that
  /// is; else 0 [s].
  double fall(State& y) const {
    constexpr double kShortly = 1e-5;  // [s]
    constexpr double kStill = 1e-8;    // what rounding makes of no acceleration [rad/s^2], and its like
    constexpr int kAngles = int(System::kVx) - int(System::kTheta), kBehind = int(System::kOmega);
    const Body<T, kSize>& body = system.body;
    State dy, later;
    const auto stands = [&](double t, const State& at, State& rate) {
      system.derivative(t, at, rate);
      return rate.template segment<kAngles>(System::kTheta).isZero(0) &&
             rate.tail(State::RowsAtCompileTime - kBehind).isZero(kStill);
    };
    const bool rail_stop = std::any_of(body.stop.begin() + body.stops_begin, body.stop.begin() + body.stops_end,
                                       [](auto& s) { return s.joint < 0; });
    if (body.base == Base::kPinned || rail_stop || !stands(0, y, dy)) return 0;
    const typename System::Pose p = system.pose(y);
    const typename System::Accelerations acc = system.accelerations_of(dy);
    double t = kNever;
    for (int i = 0; i < body.contacts; ++i) {
      const typename System::Point at = system.point_at(i, p, &acc);
      t = std::min(t, landing::fall_time(-at.a, at.y - system.point[i].thickness, at.v));
    }
    if (!(t > kShortly && t < kNever)) return 0;
    t = std::min(t - kShortly, stop());
    State end = y;
    for (const int k : {System::kX, System::kY}) {
      const int v = k + int(System::kPositions);
      end[k] += t * (y[v] + 0.5 * t * dy[v]), end[v] += t * dy[v];
    }
    if (!stands(0, end, later) ||
        std::hypot(later[System::kVx] - dy[System::kVx], later[System::kVy] - dy[System::kVy]) > kStill)
      return 0;
    y = end;
    return t;
  }

  /// Beyond guard `event`, which fell through zero at time t.
  struct Crossing {
    int touched = -1;      ///< the contact that touches down
    bool surface = false;  ///< it touches down or lifts off
    bool lands = false;    ///< the landing motions start at once: `land` is due
  };
  Crossing cross(int event, const T& t, State& y) {
    Crossing out{.touched = system.cross(event, y)};
    out.surface = event < System::kJointGuards && event % System::kOfContact == System::kSurface &&
                  !system.is_stop(event / System::kOfContact);
    if (out.touched < 0 || touched()) return out;
    first_touchdown_ = value_of(t), first_contact_ = out.touched;
    if (!scene_.t_end) limit_ = first_touchdown_ + Scene::kFollow;
    detected_ = first_touchdown_ + scene_.detection_delay;
    out.lands = scene_.detection_delay == 0;
    return out;
  }
  /// After a crossing, and where landing motions start: what friction no longer holds slips.
  void settle(double t, State& y) { system.hold_or_slip(t, y); }
  /// Whether the landing motions are due at a deadline; what else is, `advance` does.
  bool lands_at(double t) const { return t + kRounding >= detected_; }
  /// The landing motions start.
  void land(const T& t) {
    detected_ = kNever;
    for (int i = 0; i < joints(); ++i) {
      if (!driven(i)) continue;
      set(i, ReferenceChange::kLand, t), system.joint[i].phase = Phase::kMoving;
      air_[i] = kNever, end_[i] = value_of(t) + value_of(motion[i].duration);
      system.drive[i].sea = with_landing_gains(system.drive[i].sea, motion[i]);
    }
    find_longest();
  }
  /// What is due at a deadline beside `land`: references begin and end, smoothly.
  void advance(double t) {
    for (int i = 0; i < joints(); ++i) {
      Phase& phase = system.joint[i].phase;
      if (t + kRounding >= end_[i]) phase = Phase::kAfter, end_[i] = kNever;
      if (!(t + kRounding >= air_[i])) continue;
      const bool begins = phase == Phase::kBefore && air_[i] == value_of(motion[i].reposition->from);
      set(i, begins ? ReferenceChange::kReposition : ReferenceChange::kStand, T(t));
      phase = begins ? Phase::kMoving : Phase::kBefore;
      air_[i] = begins ? value_of(motion[i].reposition->to) : kNever;
    }
    find_longest();
  }

 private:
  static constexpr double kRounding = 1e-14;  // [s]

  /// How long a run is followed for its first touchdown: until the highest rise and the longest fall are over, and as
  /// long again as any landing [s].
  double flight_limit() const {
    const Robot& robot = scene_.robot;
    double rates = std::abs(scene_.drop.pitch_rate);
    for (int i = 0; i < joints(); ++i)
      if (driven(i)) rates += std::abs(value_of(motion[i].release_rate()));
    const double g = robot.gravity, far = 2 * reach(robot),
                 rise = far * rates + std::max(0.0, scene_.drop.vertical_speed);
    if (!scene_.touches() || !(g > 0) || robot.base == Base::kPinned) return Scene::kFollow;
    return (rise + std::sqrt(rise * rise + 2 * g * (scene_.drop.height + 2 * far))) / g + Scene::kFollow;
  }

  /// The base where the drop has it.
  void place(State& y) {
    const Robot& robot = scene_.robot;
    const typename System::Pose p = system.pose(y);
    if (robot.base == Base::kPinned) {
      system.base = {T(0), T(robot.pin_height)};
      return;
    }
    T lowest(kNever);
    for (int i = 0; i < system.body.contacts; ++i) {
      const T surface = system.point_at(i, p).y - system.point[i].thickness;
      if (value_of(surface) < value_of(lowest)) lowest = surface;
    }
    // Off the floor by more than rounding: what begins below it, at rest, never falls through its surface.
    constexpr double kOnFloor = 1e-12;  // [m]
    const T height = drop.height + T(std::max(0.0, kOnFloor - value_of(drop.height)));
    const T lift = value_of(lowest) < kNever ? T(height - lowest) : height;
    if (robot.base == Base::kRail) {
      system.base = {T(0), lift};
      if (present(drop.vertical_speed)) y[System::kVx] = drop.vertical_speed / T(std::sin(robot.rail_direction));
      return;
    }
    // The first link's origin begins over x = 0, and has the forward speed.
    const auto origin = position(system.body.first, p, system.body.bodies),
               speed = velocity(system.body.first, p, system.body.bodies);
    const T v = drop.forward_speed, up = drop.vertical_speed, c(std::cos(scene_.slope)), s(std::sin(scene_.slope));
    y[System::kX] = -origin[0], y[System::kY] = lift;
    y[System::kVx] = v * c + up * s - speed[0], y[System::kVy] = -v * s + up * c - speed[1];
  }

  void set(int i, ReferenceChange to, const T& t) { system.piece[i] = piece_after(to, motion[i], system.piece[i], t); }
  void find_longest() {
    constexpr double kPart = 0.125;
    double shortest = kNever;
    for (int i = 0; i < joints(); ++i) {
      const ReferencePiece<T>& piece = system.piece[i];
      if (system.joint[i].phase == Phase::kMoving && (value_of(piece.a) != value_of(piece.b) || has_bumps(motion[i])))
        shortest = std::min(shortest, value_of(piece.duration));
    }
    longest_ = kPart * shortest;
  }

  const BodyScene& scene_;
  std::array<double, kSize.joints> air_{}, end_{};
  double limit_ = kNever, first_touchdown_ = kNever, detected_ = kNever, longest_ = kNever;
  int first_contact_ = -1;
};

}  // namespace ukemi::landing
