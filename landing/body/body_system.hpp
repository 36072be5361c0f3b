// A robot on the floor as a hybrid system, one smooth mode at a time. State: base, angles, motor angles, their rates,
// then the slip z of each contact, the states of DriveLag of each joint where a drive is late; with kAccounts the work
// of joints, floor and rail on the links, for the energy check. Heights are distances from the floor along its normal;
// on a slope the frame is the floor's, and gravity is turned.
#pragma once

#include "common/integrate/guards.hpp"
#include "landing/body/body_friction.hpp"
#include "landing/body/contact.hpp"
#include "landing/body/equations.hpp"
#include "landing/body/joint.hpp"
#include "landing/model/motion.hpp"
#include "landing/model/two_link.hpp"

namespace ukemi::landing {

template <Capacity kSize>
struct BodyMode {
  std::array<PointMode, kSize.contacts> contact{};
  std::array<JointMode, kSize.joints> joint{};
  int rail_slip = 0;  ///< as JointMode::slip
};

/// The mode of a system in a scalar: one for a double and all its derivatives; lanes of it in landing/lanes.
template <Capacity kSize, class T>
struct BodyModeOf {
  using type = BodyMode<kSize>;
};

template <Capacity kSize, bool kAccounts = false, Scalar T = double>
class BodySystem : public BodyModeOf<kSize, T>::type,
                   public BodyFriction<BodySystem<kSize, kAccounts, T>, kSize.joints, T> {
 public:
  static constexpr int kB = kSize.bodies, kJ = kSize.joints, kC = kSize.contacts;
  /// The state; kPositions of them are positions, as many rates follow, then the slips.
  enum { kX, kY, kTheta, kPhiM = kTheta + kB, kPositions = kPhiM + kJ };
  enum { kVx = kPositions, kVy, kOmega, kOmegaM = kOmega + kB, kSlip = kOmegaM + kJ, kLag = kSlip + kC };
  static constexpr int kLags = DriveLag<T>::kStates, kWork = kLag + (kSize.late ? kLags * kJ : 0);
  static constexpr int kStates = kWork + kAccounts;
  /// Guards: of each contact, then of each joint; where there is dry friction (`guards_used`) of each of its places.
  enum { kSurface, kPadForce, kBottom, kFloorForce, kSlideUp, kSlideDown, kOfContact };
  enum { kUpper, kLower, kOfJoint };
  using Friction = BodyFriction<BodySystem, kJ, T>;
  static constexpr int kJointGuards = kOfContact * kC, kFrictionGuards = kJointGuards + kOfJoint * kJ,
                       kGuards = kFrictionGuards + Friction::kOfPlace * Friction::kPlaces, kControlled = kWork;
  using State = Eigen::Matrix<T, kStates, 1>;
  using Pose = TreePose<T, kB>;
  using Accelerations = TreeAccelerations<T, kB>;
  using Mode = typename BodyModeOf<kSize, T>::type;
  using Mode::contact, Mode::joint, Mode::rail_slip;
  using typename Friction::Lane, typename Friction::PlaceHolds;
  using Value = std::remove_cvref_t<decltype(value_of(std::declval<T>()))>;
  using GuardValues = integrate::Guards<kGuards, Value>;
  static constexpr SeaTerms kSea{true, true}, kPlainSea{true, false};

  BodySystem() = default;  ///< of no robot: lanes take theirs one by one
  BodySystem(const Robot& robot, double slope)
      : links(int(robot.links.size())), body(body_of<kSize>(robot).template cast<T>()) {
    gravity = {T(-std::sin(slope) * robot.gravity), T(-std::cos(slope) * robot.gravity)};
    const double direction = robot.rail_direction - slope;
    body.rail = {T(std::cos(direction)), T(std::sin(direction))};
    rail_viscous = T(robot.rail_viscous), rail_friction = T(robot.rail_friction);
    rail_load_friction = T(robot.rail_load_friction);
    for (int i = 0; i < body.contacts; ++i) point[i] = ContactConstants<T>(robot.contacts[i]);
    for_each_end(robot, [&, i = body.stops_begin](const Stop& s, int) mutable { point[i++] = ContactConstants<T>(s); });
    for (int i = 0; i < body.joints; ++i) {
      const Joint& j = robot.joints[body.joint[i].joint];
      drive[i] = {j.kind,    j.sea.cast<T>(),         T(j.stiffness),     T(j.damping),
                  T(j.rest), T(j.parallel_stiffness), T(j.parallel_rest), is_extended(j.sea)};
    }
    find_rubbing();
  }
  /// Where there is dry friction, or derivatives by it are needed.
  void find_rubbing() {
    rail_rubs = body.base == Base::kRail && any(present(rail_friction) | present(rail_load_friction));
    rubs = rail_rubs;
    for (int i = 0; i < body.joints; ++i) {
      const SeaParameters<T>& sea = drive[i].sea;
      const bool own = any(present(sea.friction) | present(sea.spring_loss)),
                 elastic = drive[i].kind == DriveKind::kElastic;
      drive[i].rubs = {elastic ? any(present(sea.output_friction)) : own, elastic && own};
      rubs = rubs || drive[i].rubs[kOutputSide] || drive[i].rubs[kMotorSide];
    }
  }

  /// The same system in the same mode, without the derivatives of `o`.
  template <bool kOther, class U>
  explicit BodySystem(const BodySystem<kSize, kOther, U>& o) {
    take_structure(o);
    for_each(*this, o, kWithout);
    follow(o);
  }
  /// What is no number of T, of `o`.
  template <bool kOther, class U>
  void take_structure(const BodySystem<kSize, kOther, U>& o) {
    links = o.links, rubs = o.rubs, rail_rubs = o.rail_rubs, body.take_structure(o.body);
    for (std::size_t i = 0; i < point.size(); ++i) point[i].take_structure(o.point[i]);
    for (std::size_t i = 0; i < drive.size(); ++i) drive[i].take_structure(o.drive[i]);
  }
  /// Whether `o` differs in numbers alone.
  template <class Other>
  bool same_structure(const Other& o) const {
    bool same = body.same_structure(o.body) && links == o.links && rail_rubs == o.rail_rubs;
    for (std::size_t i = 0; i < point.size(); ++i) same = same && point[i].same_structure(o.point[i]);
    for (std::size_t i = 0; i < drive.size(); ++i) same = same && drive[i].same_structure(o.drive[i]);
    return same;
  }
  /// f(a's, b's) of every number that stays through a landing.
  template <class A, class B, class F>
  static void for_each(A& a, const B& b, F&& f) {
    Body<T, kSize>::for_each(a.body, b.body, f);
    f(a.gravity[0], b.gravity[0]), f(a.gravity[1], b.gravity[1]), f(a.rail_viscous, b.rail_viscous);
    f(a.rail_friction, b.rail_friction), f(a.rail_load_friction, b.rail_load_friction);
    f(a.base[0], b.base[0]), f(a.base[1], b.base[1]);
    for (std::size_t i = 0; i < a.point.size(); ++i) ContactConstants<T>::for_each(a.point[i], b.point[i], f);
    for (std::size_t i = 0; i < a.drive.size(); ++i) JointConstants<T>::for_each(a.drive[i], b.drive[i], f);
  }
  /// Of those that change with the mode: references and gains.
  template <class A, class B, class F>
  static void for_each_played(A& a, const B& b, F&& f) {
    for (std::size_t i = 0; i < a.piece.size(); ++i) {
      ReferencePiece<T>::for_each(a.piece[i], b.piece[i], f);
      f(a.drive[i].sea.k_p, b.drive[i].sea.k_p), f(a.drive[i].sea.k_d, b.drive[i].sea.k_d);
    }
  }
  /// Into the mode of `o`, its references and its gains.
  template <bool kOther, class U>
  void follow(const BodySystem<kSize, kOther, U>& o) {
    static_cast<Mode&>(*this) = o;
    for_each_played(*this, o, kWithout);
  }

  int links = 0;                         ///< of the robot; locked ones share a body
  bool rubs = false, rail_rubs = false;  ///< dry friction acts somewhere; along the rail
  Body<T, kSize> body;
  std::array<T, 2> gravity{};  ///< in the floor's frame
  T rail_viscous{0}, rail_friction{0}, rail_load_friction{0};
  std::array<T, 2> base{};  ///< of a rail, where s = 0; of a pin
  std::array<ContactConstants<T>, kC> point{};
  std::array<JointConstants<T>, kJ> drive{};
  std::array<ReferencePiece<T>, kJ> piece{};

  /// The sines and cosines of the last angles are remembered: the field, the guards and the peak ask in turn.
  Pose pose(const State& y) const {
    Pose p;
    if (body.base == Base::kFree) {
      p.x = y[kX], p.y = y[kY], p.vx = y[kVx], p.vy = y[kVy];
    } else {  // s is the first component
      const T &ex = body.rail[0], &ey = body.rail[1];
      p.x = base[0] + y[kX] * ex, p.y = base[1] + y[kX] * ey, p.vx = y[kVx] * ex, p.vy = y[kVx] * ey;
    }
    turn(y);
    p.sin = sin_, p.cos = cos_;
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
    const auto& phase = joint[i].phase;
    const T held = select(after(phase), r.b, r.a);
    if (!any(moving(phase))) return {held, T(0)};
    const Reference<T> played = r.at(T(t), true);
    return {select(moving(phase), played.phi, held), masked(moving(phase), played.dphi)};
  }

  /// x = y, without y's derivatives.
  static constexpr auto kWithout = [](T& x, const auto& y) { x = T(value_of(y)); };

  /// Of joint i on its child [Nm]; of a motor behind a spring, its acceleration in `motor`, and in `dy` the rates of a
  /// drive that is late.
  template <class Time>
  T torque(int i, const Time& t, const State& y, T* motor = nullptr, State* dy = nullptr) const {
    const JointConstants<T>& d = drive[i];
    const SeaState<T> s = joint_state(i, y);
    return joint_torque(i, s, motor, [&]() UKEMI_INLINE_LAMBDA {
      if (d.kind == DriveKind::kGeared) return limited_torque<kSea>(d.sea, geared_torque(i, t, s), joint[i].saturation);
      return elastic_motor_torque(i, t, y, s, dy);
    });
  }
  /// Of all joints, what holds them at rest taken from it [Nm].
  template <class Time>
  std::array<T, kJ> torques(const Time& t, const State& y) const {
    std::array<T, kJ> out{};
    for (int i = 0; i < body.joints; ++i) out[i] = torque(i, t, y);
    if (!rubs || !any(this->some_stuck())) return out;
    const PlaceHolds hold = holds(t, y);
    for (int i = 0; i < body.joints; ++i) out[i] -= masked(stuck(i, kOutputSide), hold[kSides * i].torque);
    return out;
  }
  /// Of the motor of an elastic drive, as late as the drive is [Nm].
  template <class Time>
  UKEMI_INLINE T elastic_motor_torque(int i, const Time& t, const State& y, const SeaState<T>& s,
                                      [[maybe_unused]] State* dy = nullptr) const {
    if constexpr (kSize.late) {
      const auto x = y.template segment<kLags>(kLag + kLags * i);
      const DriveLag<T> lag(drive[i].sea);
      const T ask = asked_of(i, t, lag.seen(s, x));
      if (dy) dy->template segment<kLags>(kLag + kLags * i) = lag.derivative(ask, s, x);
      return lag.torque(ask, x);
    } else {
      return asked_of(i, t, s);
    }
  }
  /// Eq. 3 of what an elastic drive sees [Nm].
  template <class Time>
  UKEMI_INLINE T asked_of(int i, const Time& t, const SeaState<T>& s) const {
    const JointConstants<T>& d = drive[i];
    return d.extended ? motor_torque<kSea>(d.sea, s, reference(i, t))
                      : motor_torque<kPlainSea>(d.sea, s, reference(i, t));
  }
  /// Sets drives that are late as if the rates of y, and what is asked for at time t, had been constant for ever.
  template <class Time>
  void settle_lags(const Time& t, State& y) const {
    if constexpr (kSize.late)
      for (int i = 0; i < body.joints; ++i) {
        if (drive[i].kind != DriveKind::kElastic) continue;
        const SeaState<T> s = joint_state(i, y);
        y.template segment<kLags>(kLag + kLags * i) = DriveLag<T>(drive[i].sea).steady(asked_of(i, t, s), s);
      }
  }
  /// The same of a motor whose torque is asked() [Nm].
  template <class Asked>
  UKEMI_INLINE T joint_torque(int i, const SeaState<T>& s, T* motor, Asked&& asked) const {
    const JointConstants<T>& d = drive[i];
    T out = -d.parallel_stiffness * (s.phi - d.parallel_rest), tau(0);
    if (d.kind == DriveKind::kElastic) {
      tau = limited_torque<kSea>(d.sea, spring_torque<kSea>(d.sea, s), joint[i].saturation);
      if (d.extended) {
        out += output_torque<kSea>(d.sea, s.dphi, tau);
        if (motor) *motor = torque_on_motor<kSea>(d.sea, s.dphi_m, asked(), tau);
        if (motor && d.rubs[kMotorSide])
          *motor = masked(!stuck(i, kMotorSide), T(*motor - coulomb(i, kMotorSide, s.dphi_m, tau)));
      } else {
        out += tau;
        if (motor) *motor = torque_on_motor<kPlainSea>(d.sea, s.dphi_m, asked(), tau);
      }
      if (motor) *motor = *motor / d.sea.i_motor;
    } else if (d.kind == DriveKind::kGeared) {
      tau = asked();
      out += tau;
      if (d.extended) out -= d.sea.viscous * s.dphi;
    } else {
      out -= d.stiffness * (s.phi - d.rest) + d.damping * s.dphi;
    }
    if (d.rubs[kOutputSide]) out -= coulomb(i, kOutputSide, s.dphi, tau);
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
  bool is_stop(int i) const { return i >= body.stops_begin; }
  bool has_stops() const { return body.stops_end > body.stops_begin; }
  /// The way left to an end of a stop, as a height.
  Point stop_at(int i, const Pose& p, const State& y, const Accelerations* acc = nullptr) const {
    const StopPlace<T>& s = body.stop[i];
    const T inwards(s.inwards);
    const auto along = [&](const T& a, const T& b) { return a * body.rail[0] + b * body.rail[1]; };
    if (s.joint < 0)
      return {inwards * (along(p.x, p.y) - s.end), inwards * along(p.vx, p.vy),
              acc ? inwards * along(acc->x, acc->y) : T(0), T(0), T(0)};
    const SeaState<T> q = joint_state(s.joint, y);
    const JointPlace& at = body.joint[s.joint];
    Point out{inwards * (q.phi - s.end), inwards * q.dphi, T(0), T(0), T(0)};
    if (acc) out.a = inwards * (acc->alpha[at.child] - (at.parent < 0 ? T(0) : acc->alpha[at.parent]));
    return out;
  }
  /// Loads the links with what the stops push with; adds their power.
  [[gnu::noinline]] void push_stops(const Pose& p, const State& y, TreeLoads<T, kB>& load, T& power) const {
    for (int i = body.stops_begin; i < body.stops_end; ++i) {
      if (!any(contact[i].touching)) continue;
      const StopPlace<T>& s = body.stop[i];
      const Point at = stop_at(i, p, y);
      const T normal = normal_force(point[i], contact[i], at.y, at.v, T(0)).value, f = T(s.inwards) * normal;
      power += normal * at.v;
      if (s.joint < 0) {
        load.x += f * body.rail[0], load.y += f * body.rail[1];
        continue;
      }
      load.torque[body.joint[s.joint].child] += f;
      if (body.joint[s.joint].parent >= 0) load.torque[body.joint[s.joint].parent] -= f;
    }
  }
  /// K_t z + C_t v.
  T held(int i, const State& y, const Point& at) const { return point[i].k_t * y[kSlip + i] + point[i].c_t * at.v_t; }

  /// dz of a contact that is pulled by -along.
  T slip_rate(int i, const State& y, const T& v_t, const T& along) const {
    const auto& m = contact[i];
    if (!(any(slides_forward(m)) || any(slides_back(m)))) return masked(m.touching, v_t);
    const T sliding = (along - point[i].k_t * y[kSlip + i]) / point[i].c_t;
    const T rate = select(slides_forward(m), sliding, select(slides_back(m), sliding, v_t));
    return masked(m.touching, rate);
  }

  struct NoPush {
    UKEMI_INLINE void operator()(TreeLoads<T, kB>&, const Pose&) const {}
  };
  template <class Time>
  void derivative(const Time& t, const State& y, State& dy) const {
    if constexpr (kSize.late) dy.template segment<kLags * kJ>(kLag).setConstant(T(0));
    derivative_under(y, dy, [&](int i, T* motor) UKEMI_INLINE_LAMBDA { return torque(i, t, y, motor, &dy); });
  }
  /// Where joint i turns its child with torque_of(i, motor), and push(load, pose) adds to what acts on the links. What
  /// `still` says is held, where it is given; else what the mode says.
  template <class Torque, class Push = NoPush>
  UKEMI_INLINE void derivative_under(const State& y, State& dy, Torque&& torque_of, Push&& push = {},
                                     HeldStill<T, kSize>* still = nullptr) const {
    const Pose p = pose(y);
    TreeLoads<T, kB> load;
    [[maybe_unused]] T power(0);  // on the links
    for (int i = 0; i < kC; ++i) dy[kSlip + i] = T(0);
    for (int i = 0; i < body.contacts; ++i) {
      const auto& m = contact[i];
      if (!any(m.touching)) continue;
      const Point at = point_at(i, p);
      const T normal = normal_force(point[i], m, at.y, at.v, T(0)).value,
              along = masked(m.touching, tangential_force(point[i], m, held(i, y, at), normal));
      load.add(body.contact[i], p, body.bodies, -along, normal);
      if constexpr (kAccounts) power += normal * at.v - along * at.v_t;
      if (point[i].rubs || any(present(point[i].k_t))) dy[kSlip + i] = slip_rate(i, y, at.v_t, along);
    }
    if (has_stops()) [[unlikely]]
      push_stops(p, y, load, power);
    push(load, p);
    for (int i = 0; i < kJ; ++i) dy[kPhiM + i] = y[kOmegaM + i], dy[kOmegaM + i] = T(0);
    for (int i = 0; i < body.joints; ++i) {
      T motor(0);
      const T tau = torque_of(i, &motor);
      if constexpr (kAccounts) power += tau * joint_state(i, y).dphi;
      load.torque[body.joint[i].child] += tau;
      if (body.joint[i].parent >= 0) load.torque[body.joint[i].parent] -= tau;
      dy[kOmegaM + i] = motor;
    }
    T along_rail(0);
    const Accelerations acc =
        rubs && !still ? held_accelerations(p, load, y, along_rail) : accelerations(p, load, y, along_rail, still);
    if constexpr (kAccounts) power += along_rail * y[kVx];
    dy[kX] = y[kVx], dy[kY] = y[kVy];
    if (body.base == Base::kFree)
      dy[kVx] = acc.x, dy[kVy] = acc.y;
    else
      dy[kVx] = acc.x * body.rail[0] + acc.y * body.rail[1], dy[kVy] = T(0);
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
  /// In the mode, where there is dry friction.
  [[gnu::noinline]] Accelerations held_accelerations(const Pose& p, const TreeLoads<T, kB>& load, const State& y,
                                                     T& along_rail) const {
    HeldStill<T, kSize> still = held_still();
    return accelerations(p, load, y, along_rail, any(still.some()) ? &still : nullptr);
  }
  /// `along_rail`: becomes the rail's force in its direction [N]: viscous, and where it slips dry friction
  /// F = -(F_c + mu |N|) sgn v. N is the force across the rail, on which F acts in turn: both are solved for.
  Accelerations accelerations(const Pose& p, const TreeLoads<T, kB>& load, const State& y, T& along_rail,
                              HeldStill<T, kSize>* still = nullptr) const {
    if (body.base != Base::kRail) return solve(body, p, load, gravity, T(0), still);
    along_rail = -rail_viscous * y[kVx];
    if (!rail_rubs) return solve(body, p, load, gravity, along_rail, still);
    const T sign = direction_of<T>(rail_slip);
    along_rail -= rail_friction * sign;
    const Accelerations without = solve(body, p, load, gravity, along_rail, still);
    if (!any(present(rail_load_friction))) return without;
    const T n = across_rail(p, load, without),
            per_force = across_rail(p, load, solve(body, p, load, gravity, T(along_rail + T(1)), still)) - n;
    const T mu = rail_load_friction * sign, up = select(n < T(0), T(-n), n),
            turned = select(n < T(0), T(-per_force), per_force), resists = T(1) + mu * turned;
    constexpr double kJammed = 0.1;  // of `resists`: a rail that jams is not modelled
    along_rail -= mu * up / select(resists > T(kJammed), resists, T(kJammed));
    if (still) still->across_rail = n;  // of what is held, on which no friction acts
    return solve(body, p, load, gravity, along_rail, still);
  }
  /// The rail's force across its direction, on the robot, left of it [N].
  T across_rail(const Pose& p, const TreeLoads<T, kB>& load, const Accelerations& acc) const {
    Accelerations turning = acc;
    turning.x = body.mass * acc.x, turning.y = body.mass * acc.y;
    const auto momentum = acceleration(body.moment, p, turning, body.bodies);  // its rate [N]
    const T fx = momentum[0] - load.x - body.mass * gravity[0], fy = momentum[1] - load.y - body.mass * gravity[1];
    return body.rail[0] * fy - body.rail[1] * fx;
  }
  Accelerations accelerations_of(const State& dy) const {
    Accelerations out;
    for (int j = 0; j < body.bodies; ++j) out.alpha[j] = dy[kOmega + j];
    if (body.base == Base::kFree)
      out.x = dy[kVx], out.y = dy[kVy];
    else
      out.x = dy[kVx] * body.rail[0], out.y = dy[kVx] * body.rail[1];
    return out;
  }
  /// Kinetic and gravitational energy of the links, armatures included [J]; zero height: the floor, or the true level
  /// through its origin.
  T link_energy(const State& y) const {
    const Pose p = pose(y);
    T out = kinetic_energy(body, p) - body.mass * (gravity[0] * p.x + gravity[1] * p.y);
    for (int j = 0; j < body.bodies; ++j)
      out -= x_of(body.moment, p, j) * gravity[0] - y_of(body.moment, p, j) * gravity[1];
    return out;
  }
  /// |acceleration|^2 of the point that counts.
  T peak_square(const State& y, const State& dy) const {
    return acceleration(body.peak, pose(y), accelerations_of(dy), body.bodies).squaredNorm();
  }

  /// In doubles, with the derivatives of their values, or in lanes.
  template <class Time, class G>
  void guards(const Time& t, const State& y, const State& dy, integrate::Guards<kGuards, G>& out) const {
    out = {};
    const Pose p = pose(y);
    const Accelerations acc = accelerations_of(dy);
    contact_guards(p, acc, y, dy, out);
    for (int i = 0; i < body.joints; ++i) joint_guards(i, t, y, dy, out);
    if (rubs) [[unlikely]]
      this->friction_guards(kFrictionGuards, t, y, dy, out);
  }
  int guards_used() const { return rubs ? kGuards : kFrictionGuards; }
  template <class G>
  void contact_guards(const Pose& p, const Accelerations& acc, const State& y, const State& dy,
                      integrate::Guards<kGuards, G>& out) const {
    for (int i = 0; i < body.contacts; ++i) {
      if constexpr (!kIsPack<T>)
        if (!contact[i].touching) {  // its acceleration has no say
          surface_guard(i, point_at(i, p), out);
          continue;
        }
      guards_of(i, point_at(i, p, &acc), y, dy, out);
    }
    if (has_stops()) [[unlikely]]
      stop_guards(p, acc, y, dy, out);
  }
  template <class G>
  [[gnu::noinline]] void stop_guards(const Pose& p, const Accelerations& acc, const State& y, const State& dy,
                                     integrate::Guards<kGuards, G>& out) const {
    for (int i = body.stops_begin; i < body.stops_end; ++i) guards_of(i, stop_at(i, p, y, &acc), y, dy, out);
  }
  template <class G>
  void surface_guard(int i, const Point& at, integrate::Guards<kGuards, G>& out) const {
    const auto down = contact[i].touching;
    const G height = narrowed<G>(T(at.y - point[i].thickness)), speed = narrowed<G>(at.v);
    out.set(kOfContact * i + kSurface, select(down, G(-height), height), select(down, G(-speed), speed));
  }
  /// Of a contact where it is.
  template <class G>
  void guards_of(int i, const Point& at, const State& y, const State& dy, integrate::Guards<kGuards, G>& out) const {
    const ContactConstants<T>& x = point[i];
    const auto& m = contact[i];
    const int first = kOfContact * i;
    // `holds`: the value is positive while it does.
    const auto set = [&](int guard, const auto& holds, const T& value, const T& rate, const auto& active) {
      const G v = narrowed<G>(value), r = narrowed<G>(rate);
      out.set(first + guard, select(holds, v, G(-v)), select(holds, r, G(-r)), active);
    };
    surface_guard(i, at, out);
    const auto down = m.touching;
    if (!any(down)) return;
    const WithRate<T> pad = pad_force(x, at.y, at.v, at.a), floor = floor_force(x, at.y, at.v, at.a);
    if (x.padded) {
      set(kPadForce, m.pad, pad.value, pad.rate, down);
      set(kBottom, !m.below, at.y, at.v, down);
    }
    if (!(x.hunt_crossley && !any(x.dissipation != T(0)))) set(kFloorForce, m.floor, floor.value, floor.rate, m.below);
    if (!x.rubs) return;
    const WithRate<T> normal = normal_force(x, m, at.y, at.v, at.a);
    const T f = held(i, y, at), df = x.k_t * dy[kSlip + i] + x.c_t * at.a_t;
    const T most = x.mu * normal.value + T(kCling), d_most = x.mu * normal.rate;
    const auto forward = slides_forward(m), back = slides_back(m);
    const auto sticks = down & !forward & !back;
    set(kSlideUp, sticks, T(most - select(back, T(-f), f)), T(d_most - select(back, T(-df), df)), down);
    set(kSlideDown, sticks, T(most + f), T(d_most + df), sticks);
  }
  template <class Time, class G>
  void joint_guards(int i, const Time& t, const State& y, const State& dy, integrate::Guards<kGuards, G>& out) const {
    const JointConstants<T>& d = drive[i];
    if (d.kind == DriveKind::kPassive) return;
    const Value limit = value_of(d.sea.tau_max);
    const auto limited = (limit > Value(0)) & (limit < Value(std::numeric_limits<double>::infinity()));
    if (!any(limited)) return;
    const SeaState<T> s = joint_state(i, y);
    const JointPlace& at = body.joint[i];
    const T ddphi = dy[kOmega + at.child] - (at.parent < 0 ? T(0) : T(dy[kOmega + at.parent]));
    T tau, rate;
    if (d.kind == DriveKind::kElastic) {
      tau = spring_torque<kSea>(d.sea, s);
      rate = spring_torque_rate<kSea>(d.sea, s, ddphi, T(dy[kOmegaM + i]));
    } else {
      constexpr double kStep = 1e-7;  // the reference's own acceleration, by a difference [s]
      const Reference<T> r = reference(i, t), next = reference(i, t + Time(kStep));
      tau = geared_torque(i, t, s);
      rate = d.sea.k_p * (r.dphi - s.dphi) + d.sea.k_d * ((next.dphi - r.dphi) / T(kStep) - ddphi);
    }
    const int first = kJointGuards + kOfJoint * i;
    const auto upper = at_upper(joint[i].saturation), lower = at_lower(joint[i].saturation);
    const auto set = [&](int guard, const auto& holds, const T& value, const T& its_rate, const auto& active) {
      const G v = narrowed<G>(value), r = narrowed<G>(its_rate);
      out.set(first + guard, select(holds, v, G(-v)), select(holds, r, G(-r)), active);
    };
    set(kUpper, upper, T(tau - d.sea.tau_max), rate, limited & !lower);
    set(kLower, !lower, T(tau + d.sea.tau_max), rate, limited & !upper);
  }

  // Dry friction, see dry_friction.hpp.

  /// Of a side of joint i that carries tau [Nm], and its asymmetry. A motor that turns with its joint has its own
  /// there.
  T mean_friction(int i, Side side, const T& tau) const {
    const JointConstants<T>& d = drive[i];
    if (side == kOutputSide && d.kind == DriveKind::kElastic) return d.sea.output_friction;
    return d.kind == DriveKind::kPassive ? d.sea.friction : loaded(d.sea.friction, d.sea.spring_loss, tau);
  }
  const T& asymmetry(int i, Side side) const {
    const bool output = side == kOutputSide && drive[i].kind == DriveKind::kElastic;
    return output ? drive[i].sea.output_friction_asymmetry : drive[i].sea.friction_asymmetry;
  }
  /// What slips at the rate v is slowed by [Nm].
  T coulomb(int i, Side side, const T& v, const T& tau) const {
    return coulomb_torque(drive[i].sea, mean_friction(i, side, tau), asymmetry(i, side),
                          direction_of<T>(joint[i].slip[side]), v);
  }
  Lane stuck(int i, Side side) const { return Friction::stuck(kSides * i + side); }
  /// What is stuck of joints and rail.
  HeldStill<T, kSize> held_still() const {
    HeldStill<T, kSize> out;
    for (int i = 0; i < body.joints; ++i) out.held[i] = stuck(i, kOutputSide);
    out.held[HeldStill<T, kSize>::kRail] = Friction::stuck(Friction::kRailPlace);
    return out;
  }
  /// What moves each place that is stuck, and what holds it.
  template <class Time>
  PlaceHolds holds(const Time& t, const State& y) const {
    return holds_under(
        y, [&](int i, T* motor) UKEMI_INLINE_LAMBDA { return torque(i, t, y, motor); },
        [&](int i, const SeaState<T>& s) {
          if (drive[i].kind == DriveKind::kElastic) return elastic_motor_torque(i, t, y, s);
          return limited_torque<kSea>(drive[i].sea, geared_torque(i, t, s), joint[i].saturation);
        });
  }
  /// The same under joints' torques and pushes as of derivative_under, where the motor of joint i is driven by
  /// driving(i, state) [Nm].
  template <class Torque, class Driving, class Push = NoPush>
  PlaceHolds holds_under(const State& y, Torque&& torque_of, Driving&& driving, Push&& push = {}) const {
    State dy;
    HeldStill<T, kSize> still = held_still();
    derivative_under(y, dy, torque_of, push, &still);
    PlaceHolds out;
    for (int i = 0; i < body.joints; ++i) {
      const JointConstants<T>& d = drive[i];
      const SeaState<T> s = joint_state(i, y);
      const bool elastic = d.kind == DriveKind::kElastic;
      const T driven = d.kind == DriveKind::kPassive ? T(0) : T(driving(i, s));
      const T tau = elastic ? limited_torque<kSea>(d.sea, spring_torque<kSea>(d.sea, s), joint[i].saturation) : driven;
      const auto hold = [&](Side side, const T& moved_by) {
        out[kSides * i + side] = Hold<T>(d.sea, mean_friction(i, side, tau), asymmetry(i, side), moved_by);
      };
      if (d.rubs[kOutputSide]) hold(kOutputSide, still.needed[i]);
      if (d.rubs[kMotorSide]) hold(kMotorSide, torque_on_motor<kSea>(d.sea, s.dphi_m, driven, tau));
    }
    Hold<T>& rail = out[Friction::kRailPlace];
    rail.torque = still.needed[HeldStill<T, kSize>::kRail];
    const T& across = still.across_rail;
    rail.up = rail.down = rail_friction + rail_load_friction * select(across < T(0), T(-across), across);
    return out;
  }
  /// Into the mode beyond the zero of a guard. Returns the contact that touches the floor there, or -1.
  int cross(int guard, State& y) {
    if (guard >= kFrictionGuards) {
      this->cross_friction(guard - kFrictionGuards, y);
      return -1;
    }
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
    return guard % kOfContact == kSurface && m.touching && !is_stop(i) ? i : -1;
  }
  /// The mode of friction where the normal force may have jumped.
  void settle_friction(int i, const State& y) {
    PointMode& m = contact[i];
    m.slides = 0;
    if (!m.touching || !point[i].rubs) return;
    const Point at = point_at(i, pose(y));
    const double f = value_of(held(i, y, at)),
                 most = value_of(point[i].mu) * value_of(normal_force(point[i], m, at.y, at.v, T(0)).value) + kCling;
    m.slides = f > most ? 1 : f < -most ? -1 : 0;
  }

  /// Sizes below which a component need not be relatively exact.
  double tolerance_unit(int i) const {
    constexpr double kRate = 10, kLength = 0.3;
    if (i >= kLag) return lag_unit((i - kLag) / kLags, (i - kLag) % kLags == int(DriveLag<T>::kRate));
    if (i >= kSlip) return 0.01;  // [m]
    const bool base_place = i == kX || i == kY || i == kVx || i == kVy;
    return (base_place ? kLength : 1.0) * (i >= kVx ? kRate : 1.0);
  }

 private:
  UKEMI_INLINE void turn(const State& y) const {
    if constexpr (kDerivatives<T> == 0) {  // angles that compare equal may still differ in their derivatives
      auto moved = y[kTheta] != theta_[0];
      for (int j = 1; j < body.bodies; ++j) moved = moved | (y[kTheta + j] != theta_[j]);
      if (!any(moved)) return;
      for (int j = 0; j < body.bodies; ++j) theta_[j] = y[kTheta + j];
    }
    for (int j = 0; j < body.bodies; j += 2) {
      const int k = j + 1 < body.bodies ? j + 1 : j;
      const auto pair = sin_cos(y[kTheta + j], y[kTheta + k]);
      sin_[j] = pair[0].sin, cos_[j] = pair[0].cos, sin_[k] = pair[1].sin, cos_[k] = pair[1].cos;
    }
  }
  /// Of a lag's rate; of its torques what Eq. 3 makes of a tenth of a radian and of 10 rad/s.
  double lag_unit(int i, bool rate) const {
    constexpr double kRate = 10;
    if constexpr (kSize.late)
      if (!rate) return 0.1 * (value_of(drive[i].sea.k_p) + kRate * value_of(drive[i].sea.k_d)) + 1e-6;
    return kRate;
  }

  mutable std::array<T, kB> theta_ = filled(std::numeric_limits<double>::quiet_NaN()), sin_{}, cos_{};
  static std::array<T, kB> filled(double x) {
    std::array<T, kB> out;
    out.fill(T(x));
    return out;
  }
};

}  // namespace ukemi::landing
