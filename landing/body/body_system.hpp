// A robot on the floor as a hybrid system, one smooth mode at a time. State: base, angles, motor angles, their rates,
// then the slip z of each contact; with kAccounts the work of joints, floor and rail on the links, for the energy
// check. Heights are distances from the floor along its normal; on a slope the frame is the floor's, and gravity is
// turned.
//
#pragma once

#include "common/integrate/guards.hpp"
#include "landing/body/contact.hpp"
#include "landing/body/equations.hpp"
#include "landing/model/motion.hpp"
#include "landing/model/two_link.hpp"

namespace ukemi::landing {

/// The drive of a joint in its scalar.
template <class T>
struct JointConstants {
  DriveKind kind = DriveKind::kElastic;
  SeaParameters<T> sea{T(0), T(0), T(0), T(0), T(1)};
  T stiffness{0}, damping{0}, rest{0};  ///< passive
  T parallel_stiffness{0}, parallel_rest{0};

  /// f(a's, b's) of every constant; a takes the rest of b.
  template <class A, class B, class F>
  static void for_each(A& a, const B& b, F&& f) {
    a.kind = b.kind, a.sea.feedback = b.sea.feedback;
    SeaParameters<T>::for_each(a.sea, b.sea, f);
    f(a.stiffness, b.stiffness), f(a.damping, b.damping), f(a.rest, b.rest);
    f(a.parallel_stiffness, b.parallel_stiffness), f(a.parallel_rest, b.parallel_rest);
  }
};

struct JointMode {
  int saturation = 0;  ///< of the spring's torque, or of the geared motor's
  Phase phase = Phase::kBefore;
};

template <Capacity kSize>
struct BodyMode {
  std::array<PointMode, kSize.contacts> contact{};
  std::array<JointMode, kSize.joints> joint{};
};

template <Capacity kSize, bool kAccounts = false, Scalar T = double>
class BodySystem : public BodyMode<kSize> {
 public:
  static constexpr int kB = kSize.bodies, kJ = kSize.joints, kC = kSize.contacts;
  /// The state; kPositions of them are positions, as many rates follow, then the slips.
  enum { kX, kY, kTheta, kPhiM = kTheta + kB, kPositions = kPhiM + kJ };
  enum { kVx = kPositions, kVy, kOmega, kOmegaM = kOmega + kB, kSlip = kOmegaM + kJ, kWork = kSlip + kC };
  static constexpr int kStates = kWork + kAccounts;
  /// Guards: of each contact, then of each joint.
  enum { kSurface, kPadForce, kBottom, kFloorForce, kSlideUp, kSlideDown, kOfContact };
  enum { kUpper, kLower, kOfJoint };
  static constexpr int kJointGuards = kOfContact * kC, kGuards = kJointGuards + kOfJoint * kJ, kControlled = kWork;
  using State = Eigen::Matrix<T, kStates, 1>;
  using Pose = TreePose<T, kB>;
  using Accelerations = TreeAccelerations<T, kB>;
  using BodyMode<kSize>::contact, BodyMode<kSize>::joint;
  static constexpr SeaTerms kSea{true, true};

  BodySystem(const Robot& robot, double slope)
      : links(int(robot.links.size())), body(body_of<kSize>(robot).template cast<T>()) {
    gravity = robot.gravity * Eigen::Vector2d(-std::sin(slope), -std::cos(slope));
    const double direction = robot.rail_direction - slope;
    body.rail = {std::cos(direction), std::sin(direction)};
    rail_viscous = T(robot.rail_viscous);
    for (int i = 0; i < body.contacts; ++i) point[i] = ContactConstants<T>(robot.contacts[i]);
    for (int i = 0; i < body.joints; ++i) {
      const Joint& j = robot.joints[body.joint[i].joint];
      drive[i] = {j.kind,    j.sea.cast<T>(),         T(j.stiffness),    T(j.damping),
                  T(j.rest), T(j.parallel_stiffness), T(j.parallel_rest)};
    }
  }

  /// The same system in the same mode, without the derivatives of `o`.
  template <bool kOther, class U>
  explicit BodySystem(const BodySystem<kSize, kOther, U>& o)
      : links(o.links), body(o.body.template cast<T>()), gravity(o.gravity) {
    follow(o);
    rail_viscous = T(value_of(o.rail_viscous));
    base = {T(value_of(o.base[0])), T(value_of(o.base[1]))};
    for (std::size_t i = 0; i < point.size(); ++i) {
      point[i].hunt_crossley = o.point[i].hunt_crossley, point[i].padded = o.point[i].padded;
      point[i].rubs = o.point[i].rubs;
      ContactConstants<T>::for_each(point[i], o.point[i], kWithout);
    }
    for (std::size_t i = 0; i < drive.size(); ++i) JointConstants<T>::for_each(drive[i], o.drive[i], kWithout);
  }
  /// Into the mode of `o`, its references and its gains.
  template <bool kOther, class U>
  void follow(const BodySystem<kSize, kOther, U>& o) {
    static_cast<BodyMode<kSize>&>(*this) = o;
    for (std::size_t i = 0; i < piece.size(); ++i) ReferencePiece<T>::for_each(piece[i], o.piece[i], kWithout);
    for (std::size_t i = 0; i < drive.size(); ++i) JointConstants<T>::for_each(drive[i], o.drive[i], kWithout);
  }

  int links;  ///< of the robot; locked ones share a body
  Body<T, kSize> body;
  Eigen::Vector2d gravity;  ///< in the floor's frame
  T rail_viscous{0};
  Eigen::Matrix<T, 2, 1> base{T(0), T(0)};  ///< of a rail, where s = 0; of a pin
  std::array<ContactConstants<T>, kC> point{};
  std::array<JointConstants<T>, kJ> drive{};
  std::array<ReferencePiece<T>, kJ> piece{};

  Pose pose(const State& y) const {
    Pose p;
    if (body.base == Base::kFree) {
      p.x = y[kX], p.y = y[kY], p.vx = y[kVx], p.vy = y[kVy];
    } else {  // s is the first component
      const T ex(body.rail.x()), ey(body.rail.y());
      p.x = base[0] + y[kX] * ex, p.y = base[1] + y[kX] * ey, p.vx = y[kVx] * ex, p.vy = y[kVx] * ey;
    }
    for (int j = 0; j < body.bodies; j += 2) {
      const int k = j + 1 < body.bodies ? j + 1 : j;
      const auto turn = sin_cos(y[kTheta + j], y[kTheta + k]);
      p.sin[j] = turn[0].sin, p.cos[j] = turn[0].cos, p.sin[k] = turn[1].sin, p.cos[k] = turn[1].cos;
    }
    for (int j = 0; j < body.bodies; ++j) p.omega[j] = y[kOmega + j];
    return p;
  }

  /// Joint angle and rate, and those of the motor.
  SeaState<T> joint_state(int i, const State& y) const {
    const JointPlace& at = body.joint[i];
    const T phi = y[kTheta + at.child] + T(at.offset), rate = y[kOmega + at.child];
    if (at.parent < 0) return {phi, y[kPhiM + i], rate, y[kOmegaM + i]};
    return {phi - y[kTheta + at.parent], y[kPhiM + i], rate - y[kOmega + at.parent], y[kOmegaM + i]};
  }

  template <class Time>
  Reference<T> reference(int i, const Time& t) const {
    const ReferencePiece<T>& r = piece[i];
    if (joint[i].phase == Phase::kMoving) return r.at(T(t), true);
    return {joint[i].phase == Phase::kAfter ? r.b : r.a, T(0)};
  }

  /// x = y, without y's derivatives.
  static constexpr auto kWithout = [](T& x, const auto& y) { x = T(value_of(y)); };

  /// Of joint i on its child [Nm]; of a motor behind a spring, its acceleration in `motor`.
  template <class Time>
  T torque(int i, const Time& t, const State& y, T* motor = nullptr) const {
    const JointConstants<T>& d = drive[i];
    const SeaState<T> s = joint_state(i, y);
    T out = -d.parallel_stiffness * (s.phi - d.parallel_rest);
    if (d.kind == DriveKind::kElastic) {
      const T tau = limited_torque<kSea>(d.sea, spring_torque<kSea>(d.sea, s), joint[i].saturation);
      out += output_torque<kSea>(d.sea, s.dphi, tau);
      if (motor) *motor = motor_acceleration<kSea>(d.sea, s, reference(i, t), tau);
    } else if (d.kind == DriveKind::kGeared) {
      const T tau = limited_torque<kSea>(d.sea, geared_torque(i, t, s), joint[i].saturation);
      out += tau - friction_torque<kSea>(d.sea, s.dphi, tau);
    } else {
      out -= d.stiffness * (s.phi - d.rest) + d.damping * s.dphi;
    }
    return out;
  }
  template <class Time>
  T geared_torque(int i, const Time& t, const SeaState<T>& s) const {
    const Reference<T> r = reference(i, t);
    return drive[i].sea.k_p * (r.phi - s.phi) + drive[i].sea.k_d * (r.dphi - s.dphi);
  }

  /// Height, speed and acceleration of a contact over and along the floor; accelerations where `acc` is given.
  struct Point {
    T y, v, a, v_t, a_t;
  };
  Point point_at(int i, const Pose& p, const Accelerations* acc = nullptr) const {
    const auto at = position(body.contact[i], p, body.bodies), rate = velocity(body.contact[i], p, body.bodies);
    Point out{at[1], rate[1], T(0), rate[0], T(0)};
    if (!acc) return out;
    const auto second = acceleration(body.contact[i], p, *acc, body.bodies);
    out.a = second[1], out.a_t = second[0];
    return out;
  }
  /// K_t z + C_t v.
  T held(int i, const State& y, const Point& at) const { return point[i].k_t * y[kSlip + i] + point[i].c_t * at.v_t; }

  template <class Time>
  void derivative(const Time& t, const State& y, State& dy) const {
    const Pose p = pose(y);
    TreeLoads<T, kB> load;
    T power = T(-rail_viscous * y[kVx] * y[kVx]);  // on the links
    for (int i = 0; i < kC; ++i) dy[kSlip + i] = T(0);
    for (int i = 0; i < body.contacts; ++i) {
      const PointMode& m = contact[i];
      if (!m.touching) continue;
      const Point at = point_at(i, p);
      const T normal = normal_force(point[i], m, at.y, at.v, T(0)).value;
      const T along = tangential_force(point[i], m, held(i, y, at), normal);
      load.add(body.contact[i], p, body.bodies, -along, normal);
      power += normal * at.v - along * at.v_t;
      if (point[i].rubs || any(present(point[i].k_t)))
        dy[kSlip + i] = m.slides == 0 ? at.v_t : T((along - point[i].k_t * y[kSlip + i]) / point[i].c_t);
    }
    for (int i = 0; i < kJ; ++i) dy[kPhiM + i] = y[kOmegaM + i], dy[kOmegaM + i] = T(0);
    for (int i = 0; i < body.joints; ++i) {
      T motor(0);
      const T tau = torque(i, t, y, &motor);
      if constexpr (kAccounts) power += tau * joint_state(i, y).dphi;
      load.turn[body.joint[i].child] += tau;
      if (body.joint[i].parent >= 0) load.turn[body.joint[i].parent] -= tau;
      dy[kOmegaM + i] = motor;
    }
    const Accelerations acc = accelerations(p, load, y);
    dy[kX] = y[kVx], dy[kY] = y[kVy];
    if (body.base == Base::kFree)
      dy[kVx] = acc.x, dy[kVy] = acc.y;
    else
      dy[kVx] = acc.x * T(body.rail.x()) + acc.y * T(body.rail.y()), dy[kVy] = T(0);
    for (int j = 0; j < kB; ++j) {
      dy[kTheta + j] = y[kOmega + j];
      dy[kOmega + j] = j < body.bodies ? acc.alpha[j] : T(0);
    }
    if constexpr (kAccounts) dy[kWork] = power;
  }
  State derivative(double t, const State& y) const {
    State dy;
    derivative(t, y, dy);
    return dy;
  }
  Accelerations accelerations(const Pose& p, const TreeLoads<T, kB>& load, const State& y) const {
    return solve(body, p, load, gravity, T(-rail_viscous * y[kVx]));
  }
  Accelerations accelerations_of(const State& dy) const {
    Accelerations out;
    for (int j = 0; j < body.bodies; ++j) out.alpha[j] = dy[kOmega + j];
    if (body.base == Base::kFree)
      out.x = dy[kVx], out.y = dy[kVy];
    else
      out.x = dy[kVx] * T(body.rail.x()), out.y = dy[kVx] * T(body.rail.y());
    return out;
  }
  /// Kinetic and gravitational energy of the links, armatures included [J]; zero height: the floor, or the true level
  /// through its origin.
  T link_energy(const State& y) const {
    const Pose p = pose(y);
    T out = kinetic_energy(body, p) - body.mass * (gravity.x() * p.x + gravity.y() * p.y);
    for (int j = 0; j < body.bodies; ++j)
      out -= x_of(body.moment, p, j) * gravity.x() - y_of(body.moment, p, j) * gravity.y();
    return out;
  }
  /// |acceleration|^2 of the point that counts.
  T peak_square(const State& y, const State& dy) const {
    return acceleration(body.peak, pose(y), accelerations_of(dy), body.bodies).squaredNorm();
  }

  /// In doubles, or with the derivatives of their values.
  template <class G>
  void guards(double t, const State& y, const State& dy, integrate::Guards<kGuards, G>& out) const {
    out = {};
    const Pose p = pose(y);
    const Accelerations acc = accelerations_of(dy);
    for (int i = 0; i < body.contacts; ++i) contact_guards(i, p, acc, y, dy, out);
    for (int i = 0; i < body.joints; ++i) joint_guards(i, t, y, dy, out);
  }
  template <class G>
  void contact_guards(int i, const Pose& p, const Accelerations& acc, const State& y, const State& dy,
                      integrate::Guards<kGuards, G>& out) const {
    const ContactConstants<T>& x = point[i];
    const PointMode& m = contact[i];
    const Point at = point_at(i, p, &acc);
    const int first = kOfContact * i;
    const auto set = [&](int guard, bool positive, const T& value, const T& rate) {
      const G sign(positive ? 1 : -1);
      out.set(first + guard, G(sign * narrowed<G>(value)), G(sign * narrowed<G>(rate)));
    };
    set(kSurface, !m.touching, T(at.y - x.thickness), at.v);
    if (!m.touching) return;
    const WithRate<T> pad = pad_force(x, at.y, at.v, at.a), floor = floor_force(x, at.y, at.v, at.a);
    if (x.padded) set(kPadForce, m.pad, pad.value, pad.rate), set(kBottom, !m.below, at.y, at.v);
    if (m.below && !(x.hunt_crossley && !any(x.dissipation != T(0))))
      set(kFloorForce, m.floor, floor.value, floor.rate);
    if (!x.rubs) return;
    const WithRate<T> normal = normal_force(x, m, at.y, at.v, at.a);
    const T f = held(i, y, at), df = x.k_t * dy[kSlip + i] + x.c_t * at.a_t;
    if (m.slides == 0) {
      set(kSlideUp, true, T(x.mu * normal.value - f), T(x.mu * normal.rate - df));
      set(kSlideDown, true, T(x.mu * normal.value + f), T(x.mu * normal.rate + df));
    } else {
      const T s(double(m.slides));
      set(kSlideUp, true, T(s * f - x.mu * normal.value), T(s * df - x.mu * normal.rate));
    }
  }
  template <class G>
  void joint_guards(int i, double t, const State& y, const State& dy, integrate::Guards<kGuards, G>& out) const {
    const JointConstants<T>& d = drive[i];
    const T& limit = d.sea.tau_max;
    if (d.kind == DriveKind::kPassive ||
        !(value_of(limit) > 0 && value_of(limit) < std::numeric_limits<double>::infinity()))
      return;
    const SeaState<T> s = joint_state(i, y);
    const JointPlace& at = body.joint[i];
    const T ddphi = dy[kOmega + at.child] - (at.parent < 0 ? T(0) : T(dy[kOmega + at.parent]));
    T tau, rate;
    if (d.kind == DriveKind::kElastic) {
      tau = spring_torque<kSea>(d.sea, s);
      rate = spring_torque_rate<kSea>(d.sea, s, ddphi, T(dy[kOmegaM + i]));
    } else {
      constexpr double kStep = 1e-7;  // the reference's own acceleration, by a difference [s]
      const Reference<T> r = reference(i, t), later = reference(i, t + kStep);
      tau = geared_torque(i, t, s);
      rate = d.sea.k_p * (r.dphi - s.dphi) + d.sea.k_d * ((later.dphi - r.dphi) / T(kStep) - ddphi);
    }
    const int first = kJointGuards + kOfJoint * i, saturation = joint[i].saturation;
    const auto set = [&](int guard, const T& value, const T& its_rate) {
      out.set(first + guard, narrowed<G>(value), narrowed<G>(its_rate));
    };
    if (saturation >= 0) set(kUpper, saturation ? T(tau - limit) : T(limit - tau), saturation ? rate : T(-rate));
    if (saturation <= 0) set(kLower, saturation ? T(-limit - tau) : T(limit + tau), saturation ? T(-rate) : rate);
  }

  /// Into the mode beyond the zero of a guard. Returns the contact that touches down there, or -1.
  int cross(int guard, State& y) {
    if (guard >= kJointGuards) {
      int& saturation = joint[(guard - kJointGuards) / kOfJoint].saturation;
      saturation = saturation ? 0 : (guard - kJointGuards) % kOfJoint == kUpper ? 1 : -1;
      return -1;
    }
    const int i = guard / kOfContact;
    PointMode& m = contact[i];
    switch (guard % kOfContact) {
      case kSurface:
        m = m.touching
                ? PointMode{}
                : PointMode{
                      .touching = true, .pad = point[i].padded, .below = !point[i].padded, .floor = !point[i].padded};
        y[kSlip + i] = T(0);
        break;
      case kBottom:
        m.below = m.floor = !m.below;
        break;
      case kPadForce:
        m.pad = !m.pad;
        break;
      case kFloorForce:
        m.floor = !m.floor;
        break;
      default:
        m.slides = m.slides != 0 ? 0 : guard % kOfContact == kSlideUp ? 1 : -1;
        return -1;
    }
    settle_friction(i, y);
    return guard % kOfContact == kSurface && m.touching ? i : -1;
  }
  /// The mode of friction where the normal force may have jumped.
  void settle_friction(int i, const State& y) {
    PointMode& m = contact[i];
    m.slides = 0;
    if (!m.touching || !point[i].rubs) return;
    const Point at = point_at(i, pose(y));
    const double f = value_of(held(i, y, at)),
                 most = value_of(point[i].mu) * value_of(normal_force(point[i], m, at.y, at.v, T(0)).value);
    m.slides = f > most ? 1 : f < -most ? -1 : 0;
  }

  double tolerance_unit(int i) const {
    constexpr double kRate = 10, kLength = 0.3;
    if (i >= kSlip) return 0.01;  // [m]
    const bool base_place = i == kX || i == kY || i == kVx || i == kVy;
    return (base_place ? kLength : 1.0) * (i >= kVx ? kRate : 1.0);
  }
};

}  // namespace ukemi::landing
