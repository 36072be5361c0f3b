// A robot on the floor as a hybrid system, one smooth mode at a time. State: base, angles, motor angles, their rates,
// then the slip z of each contact, the states of DriveLag of each joint if a drive is late, and with kAccounts the work
// of joints, floor and rail on the links, for the energy check. Heights are distances from the floor along its normal;
// on a slope the frame is the floor's, and gravity is turned.
#pragma once

#include "landing/body/body_drives.hpp"
#include "landing/body/body_friction.hpp"
#include "landing/body/body_guards.hpp"
#include "landing/body/contact.hpp"
#include "landing/body/equations.hpp"
#include "landing/body/joint.hpp"
#include "landing/model/motion.hpp"
#include "landing/run/landing.hpp"

namespace ukemi::landing {

template <Capacity kSize>
struct BodyMode {
  std::array<PointMode, kSize.contacts> contact{};
  std::array<JointMode, kSize.joints> joint{};
  int rail_slip = 0;  ///< as JointMode::slip
};

/// The mode of a system by scalar: BodyMode, but for packs a mode per lane (landing/lanes).
template <Capacity kSize, class T>
struct BodyModeOf {
  using type = BodyMode<kSize>;
};

template <Capacity kCapacity, bool kAccounts = false, Scalar T = double>
class BodySystem
    : public BodyModeOf<kCapacity, T>::type,
      public BodyDrives<BodySystem<kCapacity, kAccounts, T>, T>,
      public BodyGuards<BodySystem<kCapacity, kAccounts, T>, T>,
      public BodyFriction<BodySystem<kCapacity, kAccounts, T>, kCapacity.joints, !kCapacity.straight(), T> {
 public:
  static constexpr Capacity kSize = kCapacity;
  static constexpr int kB = kSize.bodies, kJ = kSize.joints, kC = kSize.contacts;
  static constexpr bool kStraight = kSize.straight(),        ///< only robots of has_plain_links
      kPlainDrives = kSize.plain == Plain::kLinksAndDrives;  ///< and of has_plain_drives
  static constexpr int kSlips = kStraight ? 0 : kC;
  /// The state; kPositions of them are positions, as many rates follow, then the slips.
  enum { kX, kY, kTheta, kPhiM = kTheta + kB, kPositions = kPhiM + kJ };
  enum { kVx = kPositions, kVy, kOmega, kOmegaM = kOmega + kB, kSlip = kOmegaM + kJ, kLag = kSlip + kSlips };
  static constexpr int kLags = DriveLag<T>::kStates, kWork = kLag + (kSize.late ? kLags * kJ : 0);
  static constexpr int kStates = kWork + kAccounts;
  /// Guards of each contact, of each joint, and, if there is dry friction (`guards_used`), of each place of it.
  enum {
    kSurface,
    kFloorForce,
    kPadForce,
    kBottom,
    kSlideUp,
    kSlideDown,
    kGuardsPerContact = kStraight ? kPadForce : 6
  };
  enum { kUpper, kLower, kGuardsPerJoint };
  using Friction = BodyFriction<BodySystem, kJ, !kSize.straight(), T>;
  static constexpr int kJointGuards = kGuardsPerContact * kC, kFrictionGuards = kJointGuards + kGuardsPerJoint * kJ,
                       kGuards = kFrictionGuards + (kPlainDrives ? 0 : Friction::kGuardsPerPlace * Friction::kPlaces),
                       kControlled = kWork;
  using State = Eigen::Matrix<T, kStates, 1>;
  using Pose = TreePose<T, kB>;
  using Accelerations = TreeAccelerations<T, kB>;
  using Mode = typename BodyModeOf<kSize, T>::type;
  using Mode::contact, Mode::joint, Mode::rail_slip;
  using typename Friction::Lane, typename Friction::PlaceHolds;
  using Drives = BodyDrives<BodySystem, T>;
  using Drives::reference, Drives::torque, Drives::elastic_torque, Drives::elastic_motor_torque, Drives::geared_torque,
      Drives::requested_torque, Drives::joint_torque, Drives::mean_friction, Drives::asymmetry;
  using Value = std::remove_cvref_t<decltype(value_of(std::declval<T>()))>;
  using GuardValues = integrate::Guards<kGuards, Value>;
  static constexpr SeaTerms kPlainSea{true, false}, kSea{true, !kPlainDrives};

  BodySystem() = default;  ///< without a robot: lanes are set one by one
  BodySystem(const Robot& robot, double slope)
      : links(int(robot.links.size())), body(body_of<kSize>(robot).template cast<T>()) {
    gravity = {T(-std::sin(slope) * robot.gravity), T(-std::cos(slope) * robot.gravity)};
    const double direction = robot.rail_direction - slope;
    body.rail = {T(std::cos(direction)), T(std::sin(direction))};
    rail_viscous = T(robot.rail_viscous), rail_friction = T(robot.rail_friction);
    rail_load_friction = T(robot.rail_load_friction);
    for (int i = 0; i < body.contacts; ++i) point[i] = ContactConstants<T>(robot.contacts[i]);
    for_each_stop_end(robot,
                      [&, i = body.stops_begin](const Stop& s, int) mutable { point[i++] = ContactConstants<T>(s); });
    for (int i = 0; i < body.joints; ++i) {
      const Joint& j = robot.joints[body.joint[i].joint];
      drive[i] = {j.kind,
                  j.sea.cast<T>(),
                  T(j.stiffness),
                  T(j.damping),
                  T(j.rest),
                  T(j.parallel_stiffness),
                  T(j.parallel_rest),
                  T(1),
                  is_extended(j.sea)};
    }
    complete_constants();
  }
  /// Sets what follows from other constants: 1 / i_motor, and where there is dry friction, or derivatives by it.
  void complete_constants() {
    for (int i = 0; i < body.joints; ++i) drive[i].inverse_i_motor = T(1) / drive[i].sea.i_motor;
    rail_has_friction = body.base == Base::kRail && any(present(rail_friction) | present(rail_load_friction));
    has_friction = links_may_stick = rail_has_friction;
    for (int i = 0; i < body.joints; ++i) {
      const SeaParameters<T>& sea = drive[i].sea;
      const bool motor = any(present(sea.friction) | present(sea.spring_loss)),
                 elastic = drive[i].kind == DriveKind::kElastic;
      drive[i].has_friction = {elastic ? any(present(sea.output_friction)) : motor, elastic && motor};
      links_may_stick = links_may_stick || drive[i].has_friction[kOutputSide];
      has_friction = has_friction || drive[i].has_friction[kOutputSide] || drive[i].has_friction[kMotorSide];
    }
  }

  /// The same system in the same mode, without the derivatives of `o`.
  template <bool kOther, class U>
  explicit BodySystem(const BodySystem<kSize, kOther, U>& o) {
    copy_structure(o);
    for_each(*this, o, kCopyValue);
    copy_mode(o);
  }
  /// Copies everything that is not a number of T.
  template <bool kOther, class U>
  void copy_structure(const BodySystem<kSize, kOther, U>& o) {
    links = o.links, has_friction = o.has_friction, rail_has_friction = o.rail_has_friction;
    links_may_stick = o.links_may_stick, shaped = o.shaped;
    body.copy_structure(o.body);
    for (std::size_t i = 0; i < point.size(); ++i) point[i].copy_structure(o.point[i]);
    for (std::size_t i = 0; i < drive.size(); ++i) drive[i].copy_structure(o.drive[i]);
  }
  /// Whether `o` differs only in numbers of T.
  template <class Other>
  bool same_structure(const Other& o) const {
    bool same = body.same_structure(o.body) && links == o.links && rail_has_friction == o.rail_has_friction;
    for (std::size_t i = 0; i < point.size(); ++i) same = same && point[i].same_structure(o.point[i]);
    for (std::size_t i = 0; i < drive.size(); ++i) same = same && drive[i].same_structure(o.drive[i]);
    return same;
  }
  /// Calls f(number of a, same number of b) for every number that is constant during a landing.
  template <class A, class B, class F>
  static void for_each(A& a, const B& b, F&& f) {
    Body<T, kSize>::for_each(a.body, b.body, f);
    f(a.gravity[0], b.gravity[0]), f(a.gravity[1], b.gravity[1]), f(a.rail_viscous, b.rail_viscous);
    f(a.rail_friction, b.rail_friction), f(a.rail_load_friction, b.rail_load_friction);
    f(a.base[0], b.base[0]), f(a.base[1], b.base[1]);
    for (std::size_t i = 0; i < a.point.size(); ++i) ContactConstants<T>::for_each(a.point[i], b.point[i], f);
    for (std::size_t i = 0; i < a.drive.size(); ++i) JointConstants<T>::for_each(a.drive[i], b.drive[i], f);
  }
  /// The same for the numbers that change with the mode: references and gains.
  template <class A, class B, class F>
  static void for_each_scheduled(A& a, const B& b, F&& f) {
    for (std::size_t i = 0; i < a.piece.size(); ++i) {
      ReferencePiece<T>::for_each(a.piece[i], b.piece[i], f);
      f(a.drive[i].sea.k_p, b.drive[i].sea.k_p), f(a.drive[i].sea.k_d, b.drive[i].sea.k_d);
    }
  }
  /// Copies the mode of `o`, its references and its gains.
  template <bool kOther, class U>
  void copy_mode(const BodySystem<kSize, kOther, U>& o) {
    static_cast<Mode&>(*this) = o;
    for_each_scheduled(*this, o, kCopyValue);
  }

  int links = 0;                                         ///< of the robot; links joined by locked joints share a body
  bool has_friction = false, rail_has_friction = false;  ///< dry friction anywhere; along the rail
  bool links_may_stick = false;                          ///< dry friction along the rail or at the output of a joint
  Body<T, kSize> body;
  std::array<T, 2> gravity{};  ///< in the floor's frame
  T rail_viscous{0}, rail_friction{0}, rail_load_friction{0};
  std::array<T, 2> base{};  ///< of a rail the origin, s = 0; of a pin its place
  std::array<ContactConstants<T>, kC> point{};
  std::array<JointConstants<T>, kJ> drive{};
  std::array<ReferencePiece<T>, kJ> piece{};
  bool shaped = true;  ///< a piece may have shape terms

  /// The sines and cosines of the last angles are cached: field, guards and peak use the same state.
  Pose pose(const State& y) const {
    Pose p;
    if (is_free()) {
      p.x = y[kX], p.y = y[kY], p.vx = y[kVx], p.vy = y[kVy];
    } else {  // s is the first component
      const T &ex = body.rail[0], &ey = body.rail[1];
      p.x = base[0] + y[kX] * ex, p.y = base[1] + y[kX] * ey, p.vx = y[kVx] * ex, p.vy = y[kVx] * ey;
    }
    update_sin_cos(y);
    p.sin = sin_, p.cos = cos_;
    for (int j = 0; j < body.bodies; ++j) p.omega[j] = y[kOmega + j];
    return p;
  }

  bool is_free() const { return kStraight || body.base == Base::kFree; }
  /// The kind of a moving joint, and whether its drive has terms beyond Eq. 2-4.
  DriveKind kind(int i) const { return kStraight ? DriveKind::kElastic : drive[i].kind; }
  bool extended(int i) const { return !kPlainDrives && drive[i].extended; }

  /// The bodies of a moving joint; parent -1: the ground.
  int child_of(int i) const { return kStraight ? i + 1 : body.joint[i].child; }
  int parent_of(int i) const { return kStraight && (kJ == 1 || i == 0) ? 0 : body.joint[i].parent; }

  /// Joint angle and rate, and those of the motor.
  SeaState<T> joint_state(int i, const State& y) const {
    const int child = child_of(i), parent = parent_of(i);
    T phi = y[kTheta + child];
    if constexpr (!kStraight) phi += T(body.joint[i].offset);
    if (parent < 0) return {phi, y[kPhiM + i], y[kOmega + child], y[kOmegaM + i]};
    return {phi - y[kTheta + parent], y[kPhiM + i], y[kOmega + child] - y[kOmega + parent], y[kOmegaM + i]};
  }

  /// Whether |phi| of a driven joint is beyond kLostJoint.
  Lane lost_joint(const State& y) const {
    using std::abs;
    Lane out(false);
    for (int i = 0; i < body.joints; ++i)
      if (kind(i) != DriveKind::kPassive) out = out | (abs(joint_state(i, y).phi) > T(kLostJoint));
    return out;
  }

  /// x = y without the derivatives of y.
  static constexpr auto kCopyValue = [](T& x, const auto& y) { x = T(value_of(y)); };

  /// Height, velocity and acceleration of a contact normal to and (_t) along the floor; accelerations only with `acc`.
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
  bool has_stops() const { return !kStraight && body.stops_end > body.stops_begin; }
  bool is_padded(int i) const { return !kStraight && point[i].padded; }
  bool has_contact_friction(int i) const { return !kStraight && point[i].has_friction; }
  /// The remaining travel to an end of a stop, as a height.
  Point stop_at(int i, const Pose& p, const State& y, const Accelerations* acc = nullptr) const {
    const TreeStop<T>& s = body.stop[i];
    const T inwards(s.inwards);
    const auto along = [&](const T& a, const T& b) { return a * body.rail[0] + b * body.rail[1]; };
    if (s.joint < 0)
      return {inwards * (along(p.x, p.y) - s.end), inwards * along(p.vx, p.vy),
              acc ? inwards * along(acc->x, acc->y) : T(0), T(0), T(0)};
    const SeaState<T> q = joint_state(s.joint, y);
    const TreeJoint& at = body.joint[s.joint];
    Point out{inwards * (q.phi - s.end), inwards * q.dphi, T(0), T(0), T(0)};
    if (acc) out.a = inwards * (acc->alpha[at.child] - (at.parent < 0 ? T(0) : acc->alpha[at.parent]));
    return out;
  }
  /// Adds the forces of the stops to the loads, and their power.
  [[gnu::noinline]] void add_stop_forces(const Pose& p, const State& y, TreeLoads<T, kB>& load, T& power) const {
    for (int i = body.stops_begin; i < body.stops_end; ++i) {
      if (!any(contact[i].touching)) continue;
      const TreeStop<T>& s = body.stop[i];
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
  /// K_t z + C_t v, -F_t of a contact that sticks [N].
  T sticking_force(int i, const State& y, const Point& at) const {
    if constexpr (kStraight) return point[i].c_t * at.v_t;
    return point[i].k_t * y[kSlip + i] + point[i].c_t * at.v_t;
  }

  /// F_n and -F_t of a contact in its mode [N].
  UKEMI_INLINE T normal_at(int i, const Point& at) const {
    if constexpr (kStraight)
      return masked(contact[i].floor, floor_force(point[i], at.y, at.v, T(0)).value);
    else
      return normal_force(point[i], contact[i], at.y, at.v, T(0)).value;
  }
  UKEMI_INLINE T tangential_at(int i, const State& y, const Point& at, const T& normal) const {
    const T sticking = sticking_force(i, y, at);
    if constexpr (kStraight)
      return sticking;
    else
      return tangential_force(point[i], contact[i], sticking, normal);
  }

  /// dz of a contact on which the tangential force -along acts.
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
  /// The derivative with joint torques torque_of(i, motor) and loads added by push(load, pose). Sticking constraints
  /// are those of `stick` if given, else those of the mode.
  template <class Torque, class Push = NoPush>
  UKEMI_INLINE void derivative_under(const State& y, State& dy, Torque&& torque_of, Push&& push = {},
                                     StickConstraints<T, kSize>* stick = nullptr) const {
    const Pose p = pose(y);
    TreeLoads<T, kB> load;
    [[maybe_unused]] T power(0);  // on the links
    for (int i = 0; i < kSlips; ++i) dy[kSlip + i] = T(0);
    for (int i = 0; i < kC; ++i) {
      if (i >= body.contacts) break;  // a constant bound is unrolled
      const auto& m = contact[i];
      if (!any(m.touching)) continue;
      const Point at = point_at(i, p);
      const T normal = normal_at(i, at), along = masked(m.touching, tangential_at(i, y, at, normal));
      load.add(body.contact[i], p, body.bodies, -along, normal);
      if constexpr (kAccounts) power += normal * at.v - along * at.v_t;
      if constexpr (!kStraight)
        if (point[i].has_friction || any(present(point[i].k_t))) dy[kSlip + i] = slip_rate(i, y, at.v_t, along);
    }
    if (has_stops()) [[unlikely]]
      add_stop_forces(p, y, load, power);
    push(load, p);
    for (int i = 0; i < kJ; ++i) dy[kPhiM + i] = y[kOmegaM + i], dy[kOmegaM + i] = T(0);
    for (int i = 0; i < body.joints; ++i) {
      T motor(0);
      const T tau = torque_of(i, &motor);
      if constexpr (kAccounts) power += tau * joint_state(i, y).dphi;
      load.torque[child_of(i)] += tau;
      if (parent_of(i) >= 0) load.torque[parent_of(i)] -= tau;
      dy[kOmegaM + i] = motor;
    }
    T along_rail(0);
    const Accelerations acc = !kPlainDrives && links_may_stick && !stick
                                  ? accelerations_with_sticking(p, load, y, along_rail)
                                  : accelerations(p, load, y, along_rail, stick);
    if constexpr (kAccounts) power += along_rail * y[kVx];
    dy[kX] = y[kVx], dy[kY] = y[kVy];
    if (is_free())
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
  /// d(dy/dt)/dy and d(dy/dt)/dt of the present mode, by differences.
  template <class Matrix>
  void linearize(double t, const State& y, Matrix& jacobian, State& rate) const {
    constexpr double kShare = 1e-7, kTimeStep = 1e-7;  // of a component's unit; [s]
    State at = y, up, down;
    jacobian.setZero();
    for (int i = 0; i < kStates; ++i) {
      if (!is_used(i)) continue;
      const double h = kShare * std::max(tolerance_unit(i), std::abs(y[i]));
      at[i] = y[i] + h, derivative(t, at, up);
      at[i] = y[i] - h, derivative(t, at, down);
      at[i] = y[i];
      jacobian.col(i) = (up - down) / (2 * h);
    }
    derivative(t, y, down), derivative(t + kTimeStep, y, up);
    rate = (up - down) / kTimeStep;
  }
  /// Whether the robot has component i of the state.
  bool is_used(int i) const {
    const int k = i < kVx ? i : i - kPositions;  // of a position or its rate
    return i >= kSlip || k < kTheta + body.bodies || (k >= kPhiM && k < kPhiM + body.joints);
  }
  /// Accelerations with the sticking constraints of the mode.
  [[gnu::noinline]] Accelerations accelerations_with_sticking(const Pose& p, const TreeLoads<T, kB>& load,
                                                              const State& y, T& along_rail) const {
    StickConstraints<T, kSize> stick = stick_constraints();
    return accelerations(p, load, y, along_rail, any(stick.any_held()) ? &stick : nullptr);
  }
  /// `along_rail` is set to the rail's force along itself [N]: viscous friction and, where it slips, dry friction
  /// F = -(F_c + mu |N|) sgn v. N, the force across the rail, depends on F: both are solved for.
  Accelerations accelerations(const Pose& p, const TreeLoads<T, kB>& load, const State& y, T& along_rail,
                              StickConstraints<T, kSize>* stick = nullptr) const {
    if (kStraight || body.base != Base::kRail) return solve(body, p, load, gravity, T(0), stick);
    along_rail = -rail_viscous * y[kVx];
    if (!rail_has_friction) return solve(body, p, load, gravity, along_rail, stick);
    const T sign = direction_of<T>(rail_slip);
    along_rail -= rail_friction * sign;
    const Accelerations without = solve(body, p, load, gravity, along_rail, stick);
    if (!any(present(rail_load_friction))) return without;
    const T n = rail_normal_force(p, load, without),
            per_force = rail_normal_force(p, load, solve(body, p, load, gravity, T(along_rail + T(1)), stick)) - n;
    const T mu = rail_load_friction * sign, magnitude = select(n < T(0), T(-n), n),
            slope = select(n < T(0), T(-per_force), per_force), denominator = T(1) + mu * slope;
    constexpr double kJammed = 0.1;  // lower bound of the denominator: a jamming rail is not modelled
    along_rail -= mu * magnitude / select(denominator > T(kJammed), denominator, T(kJammed));
    if (stick) stick->rail_normal_force = n;  // for the friction limit of a stuck rail
    return solve(body, p, load, gravity, along_rail, stick);
  }
  /// Force of the rail on the robot across its direction, positive to the left [N].
  T rail_normal_force(const Pose& p, const TreeLoads<T, kB>& load, const Accelerations& acc) const {
    Accelerations scaled = acc;
    scaled.x = body.mass * acc.x, scaled.y = body.mass * acc.y;
    const auto momentum = acceleration(body.moment, p, scaled, body.bodies);  // its time derivative [N]
    const T fx = momentum[0] - load.x - body.mass * gravity[0], fy = momentum[1] - load.y - body.mass * gravity[1];
    return body.rail[0] * fy - body.rail[1] * fx;
  }
  Accelerations accelerations_of(const State& dy) const {
    Accelerations out;
    for (int j = 0; j < body.bodies; ++j) out.alpha[j] = dy[kOmega + j];
    if (is_free())
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
  /// |acceleration|^2 of the peak point [m^2/s^4].
  T peak_square(const State& y, const State& dy) const {
    return acceleration(body.peak, pose(y), accelerations_of(dy), body.bodies).squaredNorm();
  }

  // Dry friction, see dry_friction.hpp.

  Lane stuck(int i, Side side) const { return Friction::stuck(kSides * i + side); }
  /// The constraints of the joints and the rail that stick in the mode.
  StickConstraints<T, kSize> stick_constraints() const {
    StickConstraints<T, kSize> out;
    for (int i = 0; i < body.joints; ++i) out.held[i] = stuck(i, kOutputSide);
    if constexpr (!kStraight) out.held[StickConstraints<T, kSize>::kRail] = Friction::stuck(Friction::kRailPlace);
    return out;
  }
  /// Driving torque and friction limits of each place that sticks.
  template <class Time>
  PlaceHolds holds(const Time& t, const State& y) const {
    return holds_under(
        y, [&](int i, T* motor) UKEMI_INLINE_LAMBDA { return torque(i, t, y, motor); },
        [&](int i, const SeaState<T>& s) {
          if (drive[i].kind == DriveKind::kElastic) return elastic_motor_torque(i, t, y, s);
          return limited_torque<kSea>(drive[i].sea, geared_torque(i, t, s), joint[i].saturation);
        });
  }
  /// The same with joint torques and loads as in derivative_under and the motor torques motor_torque_of(i, state) [Nm].
  template <class Torque, class MotorTorque, class Push = NoPush>
  PlaceHolds holds_under(const State& y, Torque&& torque_of, MotorTorque&& motor_torque_of, Push&& push = {}) const {
    State dy;
    StickConstraints<T, kSize> stick = stick_constraints();
    if (any(stick.any_held())) derivative_under(y, dy, torque_of, push, &stick);  // a motor's hold needs no reaction
    PlaceHolds out;
    for (int i = 0; i < body.joints; ++i) {
      const JointConstants<T>& d = drive[i];
      const SeaState<T> s = joint_state(i, y);
      const bool elastic = d.kind == DriveKind::kElastic;
      const T motor = d.kind == DriveKind::kPassive ? T(0) : T(motor_torque_of(i, s));
      const T tau = elastic ? elastic_torque(i, s) : motor;
      const auto hold = [&](Side side, const T& driving_torque) {
        out[kSides * i + side] = Hold<T>(d.sea, mean_friction(i, side, tau), asymmetry(i, side), driving_torque);
      };
      if (d.has_friction[kOutputSide]) hold(kOutputSide, stick.reaction[i]);
      if (d.has_friction[kMotorSide]) hold(kMotorSide, torque_on_motor<kSea>(d.sea, s.dphi_m, motor, tau));
    }
    if constexpr (kStraight) return out;
    Hold<T>& rail = out[Friction::kRailPlace];
    rail.torque = stick.reaction[StickConstraints<T, kSize>::kRail];
    const T& n = stick.rail_normal_force;
    rail.up = rail.down = rail_friction + rail_load_friction * select(n < T(0), T(-n), n);
    return out;
  }
  /// Changes the mode at the zero of a guard. Returns the contact that touches down, or -1.
  int cross(int guard, State& y) {
    if (guard >= kFrictionGuards) {
      this->cross_friction(guard - kFrictionGuards, y);
      return -1;
    }
    if (guard >= kJointGuards) {
      int& saturation = joint[(guard - kJointGuards) / kGuardsPerJoint].saturation;
      saturation = saturation ? 0 : (guard - kJointGuards) % kGuardsPerJoint == kUpper ? 1 : -1;
      return -1;
    }
    const int i = guard / kGuardsPerContact;
    PointMode& m = contact[i];
    switch (guard % kGuardsPerContact) {
      case kSurface:
        m = m.touching
                ? PointMode{}
                : PointMode{
                      .touching = true, .pad = point[i].padded, .below = !point[i].padded, .floor = !point[i].padded};
        if constexpr (!kStraight) y[kSlip + i] = T(0);
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
        m.slides = m.slides != 0 ? 0 : guard % kGuardsPerContact == kSlideUp ? 1 : -1;
        return -1;
    }
    settle_friction(i, y);
    return guard % kGuardsPerContact == kSurface && m.touching && !is_stop(i) ? i : -1;
  }
  /// Sets the friction mode of a contact, where the normal force may have jumped.
  void settle_friction(int i, const State& y) {
    PointMode& m = contact[i];
    m.slides = 0;
    if (!m.touching || !has_contact_friction(i)) return;
    const Point at = point_at(i, pose(y));
    const double f = value_of(sticking_force(i, y, at)),
                 limit = value_of(point[i].mu) * value_of(normal_force(point[i], m, at.y, at.v, T(0)).value) +
                         kStickTolerance;
    m.slides = f > limit ? 1 : f < -limit ? -1 : 0;
  }

  /// Scale of a component for the absolute part of the error tolerance.
  double tolerance_unit(int i) const {
    constexpr double kRate = 10, kLength = 0.3;
    if (i >= kLag) return lag_unit((i - kLag) / kLags, (i - kLag) % kLags == int(DriveLag<T>::kRate));
    if (i >= kSlip) return 0.01;  // [m]
    const bool base_place = i == kX || i == kY || i == kVx || i == kVy;
    return (base_place ? kLength : 1.0) * (i >= kVx ? kRate : 1.0);
  }

 private:
  UKEMI_INLINE void update_sin_cos(const State& y) const {
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
  /// Scale of a state of DriveLag: of a rate 10 rad/s, of a torque that of Eq. 3 for 0.1 rad and 1 rad/s.
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
