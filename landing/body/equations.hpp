// The equations of motion of a planar tree of bodies: links that turn together are one body.
//
// A point is base + sum_j (A_j u(theta_j) + B_j n(theta_j)) over the bodies j, A and B constants of the robot. With
// X_j = A_j sin theta_j + B_j cos theta_j and Y_j = A_j cos theta_j - B_j sin theta_j
//
//     p = base + sum (X_j, -Y_j),   v = dbase + sum omega_j (Y_j, X_j),   a = ddbase + sum alpha_j (Y_j, X_j)
//                                                                                  + omega_j^2 (-X_j, Y_j)
//
// and a force F at it turns body j with Y_j F_x + X_j F_y. The angles obey
//
//     sum_k M_jk alpha_k + sum_k omega_k^2 (P_jk sin - Q_jk cos)(theta_j - theta_k) = torques_j + forces_j + weight_j
//     M_jj = N_jj + P_jj,   M_jk = N_jk + P_jk cos(theta_j - theta_k) + Q_jk sin(theta_j - theta_k)
//     P_jk = sum_i m_i (A_ij A_ik + B_ij B_ik),   Q_jk = sum_i m_i (A_ij B_ik - B_ij A_ik)    over the links i
//
// N: inertias about the centres of mass, and armatures. Free base: A and B count from the total centre of mass R, which
// decouples, R'' = sum F / m + g, and has no weight term. Rail: the base is R0 + s e, one more unknown s with
// M_ss = m, M_sj = sum_i m_i e.(Y_ij, X_ij), and the first body's angle stays. Pinned: the base is fixed.
// Ours; test/legs/laws.cpp.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "common/trigonometry.hpp"
#include "landing/body/places.hpp"

namespace ukemi::landing {

template <class T>
using Vec2 = Eigen::Matrix<T, 2, 1>;

/// What a kernel leaves out.
enum class Plain {
  kNothing,
  kLinks,          ///< for robots of has_plain_links
  kLinksAndDrives  ///< and of has_plain_drives
};

/// Maximum sizes that a kernel is compiled for.
struct Capacity {
  int bodies, joints, contacts;
  bool exact = false;  ///< bodies and moving joints are exactly so many: their loops are unrolled
  bool late = false;   ///< for robots with a late drive, see DriveLag
  Plain plain = Plain::kNothing;
  constexpr bool straight() const { return plain != Plain::kNothing; }  ///< only robots of has_plain_links
};
/// The compiled kernels: exact for the paper's robot, a double pendulum, legs of 2 and 3 joints; others by maximum
/// size. Those that leave something out are not for derivatives by a term that is 0.
inline constexpr Capacity kPlainPair{2, 1, 3, true, false, Plain::kLinksAndDrives},
    kStraightPair{2, 1, 3, true, false, Plain::kLinks}, kPair{2, 1, 3, true}, kPendulum{2, 2, 2, true},
    kPlainTriple{3, 2, 4, true, false, Plain::kLinksAndDrives}, kStraightTriple{3, 2, 4, true, false, Plain::kLinks},
    kTriple{3, 2, 4, true}, kQuad{4, 3, 5, true}, kSmall{3, 2, 4}, kMiddle{5, 4, 7},
    kAny{kMaxLinks, kMaxJoints, kMaxContacts}, kLateLeg{3, 2, 4, false, true},
    kLate{kMaxLateLinks, kMaxLateJoints, kMaxLateContacts, false, true};

/// Whether links and contacts have the terms of the paper alone: a free base, straight links with the centres of mass,
/// contacts and the peak point on them, linear contacts without tangential spring, friction or pad, no stops, and
/// elastic drives in the order of the links without parallel springs.
inline bool has_plain_links(const Robot& robot) {
  const auto on_axis = [](const Place& p) { return p.across == 0; };
  return robot.base == Base::kFree && on_axis(robot.peak) &&
         contacts_and_stop_ends(robot) == int(robot.contacts.size()) &&
         std::all_of(robot.links.begin(), robot.links.end(),
                     [&](const Link& l) { return on_axis(l.at) && on_axis(l.com); }) &&
         std::all_of(robot.contacts.begin(), robot.contacts.end(),
                     [&](const ContactPoint& c) {
                       return on_axis(c.at) && !c.pad && !c.law.hunt_crossley && c.law.stiffness_tangential == 0 &&
                              !std::isfinite(c.law.friction);
                     }) &&
         std::all_of(robot.joints.begin(), robot.joints.end(), [&](const Joint& j) {
           return j.kind == DriveKind::kElastic && j.parallel_stiffness == 0 &&
                  j.child == int(&j - robot.joints.data()) + 1;
         });
}
/// Whether drives have the terms of Eq. 2-4 alone.
inline bool has_plain_drives(const Robot& robot) {
  return std::none_of(robot.joints.begin(), robot.joints.end(), [](const Joint& j) { return is_extended(j.sea); });
}
inline bool fits(const Robot& robot, const Capacity& c) {
  if (c.late != has_late_drive(robot)) return false;
  if (c.plain != Plain::kNothing && !has_plain_links(robot)) return false;
  if (c.plain == Plain::kLinksAndDrives && !has_plain_drives(robot)) return false;
  const auto locked = [](const Joint& j) { return j.kind == DriveKind::kLocked; };
  if (c.exact && (int(robot.links.size()) != c.bodies || int(robot.joints.size()) != c.joints ||
                  std::any_of(robot.joints.begin(), robot.joints.end(), locked)))
    return false;
  return robot.links.size() <= std::size_t(c.bodies) && robot.joints.size() <= std::size_t(c.joints) &&
         contacts_and_stop_ends(robot) <= c.contacts;
}

/// Calls f<kernel>() with the first of the given kernels that fits the robot; the last is taken unchecked.
template <Capacity kFirst, Capacity... kRest, class F>
auto in_kernel(const Robot& robot, F&& f) {
  if constexpr (sizeof...(kRest) > 0)
    if (!fits(robot, kFirst)) return in_kernel<kRest...>(robot, f);
  return f.template operator()<kFirst>();
}

/// Calls f<kernel>() with the first kernel of gradients, or of peaks, that fits the robot; as listed in CMakeLists.txt.
/// `plain`: kernels that leave terms out will do.
template <class F>
auto in_gradient_kernel(const Robot& robot, bool plain, F&& f) {
  if (plain && fits(robot, kPlainPair)) return f.template operator()<kPlainPair>();
  if (plain && fits(robot, kPlainTriple)) return f.template operator()<kPlainTriple>();
  return in_kernel<kPair, kTriple, kQuad, kMiddle, kLateLeg, kLate, kAny>(robot, f);
}
template <class F>
auto in_peak_kernel(const Robot& robot, F&& f) {
  return in_kernel<kPlainPair, kPlainTriple, kStraightPair, kStraightTriple, kPair, kTriple, kQuad, kMiddle, kLateLeg,
                   kLate, kAny>(robot, f);
}

/// A number of bodies or joints: a constant expression where the kernel is exact.
template <int kMax, bool kExact>
struct Count {
  int n = 0;
  operator int() const { return n; }
};
template <int kMax>
struct Count<kMax, true> {
  Count(int = kMax) {}
  constexpr operator int() const { return kMax; }
};
/// Calls f(0), ..., f(n - 1). For a constant n unrolled at once, so that inner loops whose bounds are those indices
/// have constant bounds too, and small arrays stay in registers.
template <class N, class F>
UKEMI_INLINE void for_indices(const N& n, F&& f) {
  for (int i = 0; i < n; ++i) f(i);
}
template <int kMax, class F>
UKEMI_INLINE void for_indices(const Count<kMax, true>&, F&& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) UKEMI_INLINE_LAMBDA { (f(i), ...); }
  (std::make_integer_sequence<int, kMax>());
}

/// Lever arms of a point, for each body; with kStraight every B is 0.
template <class T, int kBodies, bool kStraight = false>
struct Arms {
  std::array<T, kBodies> a{}, b{};  ///< A, B [m]

  Arms() = default;
  template <bool kOther>
  Arms(const Arms<T, kBodies, kOther>& o) : a(o.a), b(o.b) {}

  /// Calls f(number of x, same number of y) for every number.
  template <class A, class B, class F>
  static void for_each(A& x, const B& y, F&& f) {
    for (std::size_t j = 0; j < kBodies; ++j) f(x.a[j], y.a[j]), f(x.b[j], y.b[j]);
  }
};

/// A moving joint between two bodies.
struct TreeJoint {
  int parent = -1, child = 0;  ///< bodies; parent -1: the ground
  double offset = 0;           ///< phi = theta_child - theta_parent + offset [rad]
  int joint = 0;               ///< of Robot::joints

  bool operator==(const TreeJoint&) const = default;
};

/// One end of a stop: a contact on a joint or the rail, whose height is the remaining travel.
template <class T>
struct TreeStop {
  int joint = -1;      ///< of Body::joint; -1: the rail
  double inwards = 1;  ///< 1: at the low end, -1: at the high one
  T end{0};            ///< [rad] or [m]

  template <class U>
  void copy_structure(const TreeStop<U>& o) {
    joint = o.joint, inwards = o.inwards;
  }
  template <class U>
  bool same_structure(const TreeStop<U>& o) const {
    return joint == o.joint && inwards == o.inwards;
  }
};

template <class T, Capacity kSize>
struct Body {
  static constexpr int kBodies = kSize.bodies;
  using Arm = Arms<T, kBodies, kSize.straight()>;
  Count<kBodies, kSize.exact> bodies;
  Count<kSize.joints, kSize.exact> joints;
  int contacts = 0;                    ///< of the robot, without ends of stops
  int stops_begin = 0, stops_end = 0;  ///< ends of stops, numbered after the contacts
  Base base = Base::kFree;
  bool first_fixed = false;  ///< the first body's angle is constant: rail, or locked pin
  std::array<std::array<T, kBodies>, kBodies> n{}, p{}, q{};  ///< N, its diagonal with P_jj; P, Q
  std::array<Arm, kSize.contacts> contact{};
  std::array<TreeStop<T>, kSize.contacts> stop{};  ///< from stops_begin on
  Arm peak{}, first{};                             ///< `first`: the origin of the first link
  std::array<Arm, kMaxLinks> origin{};             ///< of every link
  Arm moment{};                                    ///< sum_i m_i A_i, sum_i m_i B_i [kg m]; 0 with a free base
  T mass{0}, inverse_mass{0}, inverse_first{0};    ///< the last: 1 / n[0][0], for kernels of straight links
  std::array<T, 2> rail{T(0), T(1)};               ///< e
  std::array<TreeJoint, kSize.joints> joint{};
  std::array<double, kMaxLinks> offset{};  ///< theta of a link minus theta of its body [rad]
  std::array<int, kMaxLinks> body_of{};    ///< of a link

  /// Calls f(number of x, same number of y) for every number except those of `origin`, which only reports use.
  template <class A, class B, class F>
  static void for_each(A& x, const B& y, F&& f) {
    for (std::size_t j = 0; j < kBodies; ++j)
      for (std::size_t k = 0; k < kBodies; ++k)
        f(x.n[j][k], y.n[j][k]), f(x.p[j][k], y.p[j][k]), f(x.q[j][k], y.q[j][k]);
    for (std::size_t i = 0; i < x.contact.size(); ++i) Arm::for_each(x.contact[i], y.contact[i], f);
    Arm::for_each(x.peak, y.peak, f), Arm::for_each(x.first, y.first, f), Arm::for_each(x.moment, y.moment, f);
    for (std::size_t i = 0; i < x.stop.size(); ++i) f(x.stop[i].end, y.stop[i].end);
    f(x.mass, y.mass), f(x.inverse_mass, y.inverse_mass), f(x.inverse_first, y.inverse_first), f(x.rail[0], y.rail[0]),
        f(x.rail[1], y.rail[1]);
  }
  /// Copies everything that is not a number of T.
  template <class U>
  void copy_structure(const Body<U, kSize>& o) {
    bodies = {int(o.bodies)}, joints = {int(o.joints)}, contacts = o.contacts, base = o.base,
    first_fixed = o.first_fixed;
    stops_begin = o.stops_begin, stops_end = o.stops_end;
    for (std::size_t i = 0; i < stop.size(); ++i) stop[i].copy_structure(o.stop[i]);
    joint = o.joint, offset = o.offset, body_of = o.body_of;
  }
  template <class Other>
  bool same_structure(const Other& o) const {
    bool same = bodies == o.bodies && joints == o.joints && contacts == o.contacts && base == o.base &&
                first_fixed == o.first_fixed && joint == o.joint && body_of == o.body_of &&
                stops_begin == o.stops_begin && stops_end == o.stops_end;
    for (std::size_t i = 0; i < stop.size(); ++i) same = same && stop[i].same_structure(o.stop[i]);
    return same;
  }
  /// In another scalar, without derivatives.
  template <class U>
  Body<U, kSize> cast() const {
    Body<U, kSize> out;
    out.copy_structure(*this);
    const auto set = [](U& to, const T& from) { to = U(value_of(from)); };
    Body<U, kSize>::for_each(out, *this, set);
    for (std::size_t i = 0; i < origin.size(); ++i) Body<U, kSize>::Arm::for_each(out.origin[i], origin[i], set);
    return out;
  }
};

/// Sines, cosines and rates of a state; the base is R, or the first link's origin.
template <class T, int kBodies>
struct TreePose {
  T x, y, vx, vy;
  std::array<T, kBodies> sin, cos, omega;
};

/// Solution of the equations of motion.
template <class T, int kBodies>
struct TreeAccelerations {
  T x{0}, y{0};  ///< of the base
  std::array<T, kBodies> alpha{};
};

template <class T, int kBodies, bool kStraight>
T x_of(const Arms<T, kBodies, kStraight>& r, const TreePose<T, kBodies>& p, int j) {
  if constexpr (kStraight) return r.a[j] * p.sin[j];
  return r.a[j] * p.sin[j] + r.b[j] * p.cos[j];
}
template <class T, int kBodies, bool kStraight>
T y_of(const Arms<T, kBodies, kStraight>& r, const TreePose<T, kBodies>& p, int j) {
  if constexpr (kStraight) return r.a[j] * p.cos[j];
  return r.a[j] * p.cos[j] - r.b[j] * p.sin[j];
}
template <class T, int kBodies, bool kStraight>
Eigen::Matrix<T, 2, 1> position(const Arms<T, kBodies, kStraight>& r, const TreePose<T, kBodies>& p, int bodies) {
  Eigen::Matrix<T, 2, 1> out(p.x, p.y);
  for (int j = 0; j < bodies; ++j) out[0] += x_of(r, p, j), out[1] -= y_of(r, p, j);
  return out;
}
template <class T, int kBodies, bool kStraight>
Eigen::Matrix<T, 2, 1> velocity(const Arms<T, kBodies, kStraight>& r, const TreePose<T, kBodies>& p, int bodies) {
  Eigen::Matrix<T, 2, 1> out(p.vx, p.vy);
  for (int j = 0; j < bodies; ++j) out[0] += p.omega[j] * y_of(r, p, j), out[1] += p.omega[j] * x_of(r, p, j);
  return out;
}
template <class T, int kBodies, bool kStraight>
Eigen::Matrix<T, 2, 1> acceleration(const Arms<T, kBodies, kStraight>& r, const TreePose<T, kBodies>& p,
                                    const TreeAccelerations<T, kBodies>& acc, int bodies) {
  Eigen::Matrix<T, 2, 1> out(acc.x, acc.y);
  for (int j = 0; j < bodies; ++j) {
    const T x = x_of(r, p, j), y = y_of(r, p, j), w = p.omega[j] * p.omega[j];
    out[0] += acc.alpha[j] * y - w * x, out[1] += acc.alpha[j] * x + w * y;
  }
  return out;
}

/// Generalised forces: sums of forces and torques.
template <class T, int kBodies>
struct TreeLoads {
  T x{0}, y{0};
  std::array<T, kBodies> torque{};

  template <bool kStraight>
  void add(const Arms<T, kBodies, kStraight>& r, const TreePose<T, kBodies>& p, int bodies, const T& fx, const T& fy) {
    x += fx, y += fy;
    for (int j = 0; j < bodies; ++j) torque[j] += y_of(r, p, j) * fx + x_of(r, p, j) * fy;
  }
};

/// A symmetric positive definite matrix, stored in its lower triangle.
template <class T, int kMax>
struct Symmetric {
  std::array<std::array<T, kMax>, kMax> m{};

  /// M = L D L', in place: L below the diagonal, the inverse of D on it; n: its size, an int or a Count.
  template <class N>
  UKEMI_INLINE void factor(const N& n) {
    factor(n, T(T(1) / m[0][0]));
  }
  /// The same with the inverse of the first element of M.
  template <class N>
  UKEMI_INLINE void factor(const N& n, const T& first) {
    for_indices(n, [&](int j) UKEMI_INLINE_LAMBDA {
      m[j][j] = j == 0 ? first : T(T(1) / m[j][j]);
      for_indices(n, [&](int above) UKEMI_INLINE_LAMBDA {
        const int i = n - 1 - above;  // upwards: the rows above still have their elements of M
        if (i <= j) return;
        const T l = m[i][j] * m[j][j];
        for (int k = j + 1; k <= i; ++k) m[i][k] -= l * m[k][j];
        m[i][j] = l;
      });
    });
  }
  template <class N>
  UKEMI_INLINE void solve(const N& n, std::array<T, kMax>& x) const {
    for_indices(n, [&](int i) UKEMI_INLINE_LAMBDA {
      for (int k = 0; k < i; ++k) x[i] -= m[i][k] * x[k];
    });
    for_indices(n, [&](int above) UKEMI_INLINE_LAMBDA {
      const int i = n - 1 - above;
      x[i] *= m[i][i];
      for (int k = i + 1; k < n; ++k) x[i] -= m[k][i] * x[k];
    });
  }
};

/// M of the angles and, as last row, of the rail's s; a body with a constant angle has a row of the identity.
template <class T, Capacity kSize>
struct MassMatrix : Symmetric<T, kSize.bodies + 1> {
  static constexpr int kMax = kSize.bodies + 1;
  using Symmetric<T, kMax>::m;

  MassMatrix(const Body<T, kSize>& b, const TreePose<T, kSize.bodies>& p, std::array<T, kMax>& right) {
    for_indices(b.bodies, [&](int j) UKEMI_INLINE_LAMBDA {
      m[j][j] = b.n[j][j];
      for (int k = 0; k < j; ++k) {
        const T c = p.cos[j] * p.cos[k] + p.sin[j] * p.sin[k], s = p.sin[j] * p.cos[k] - p.cos[j] * p.sin[k];
        m[j][k] = b.p[j][k] * c;
        T h = b.p[j][k] * s;  // coefficient of omega_k^2 in row j; in row k it is negative
        if constexpr (!kSize.straight()) m[j][k] += b.n[j][k] + b.q[j][k] * s, h -= b.q[j][k] * c;
        right[j] -= p.omega[k] * p.omega[k] * h, right[k] += p.omega[j] * p.omega[j] * h;
      }
    });
    if constexpr (kSize.straight()) return;
    if (b.base == Base::kRail) add_rail(b, p, right);
    if (!b.first_fixed) return;
    for (int j = 1; j < kMax; ++j) m[j][0] = T(0);
    m[0][0] = T(1), right[0] = T(0);
  }
  /// The row of s.
  void add_rail(const Body<T, kSize>& b, const TreePose<T, kSize.bodies>& p, std::array<T, kMax>& right) {
    const int n = b.bodies;
    const T &ex = b.rail[0], &ey = b.rail[1];
    m[n][n] = b.mass;
    for (int j = 0; j < n; ++j) {
      const T x = x_of(b.moment, p, j), y = y_of(b.moment, p, j), w = p.omega[j] * p.omega[j];
      m[n][j] = ex * y + ey * x;
      right[n] -= w * (ey * y - ex * x);
    }
  }
};

/// Constraints of sticking dry friction, for each joint and last, if there may be one, the rail, and their reactions,
/// which are subtracted from the torques and the force along the rail [Nm], [N].
template <class T, Capacity kSize>
struct StickConstraints {
  static constexpr int kRail = kSize.joints, kMax = kRail + !kSize.straight();
  std::array<typename MaskOf<T>::type, kMax> held{};
  std::array<T, kMax> reaction{};
  T rail_normal_force{0};  ///< N on the rail, where its friction depends on N [N]

  auto any_held() const {
    auto out = held[0];
    for (int i = 1; i < kMax; ++i) out = out | held[i];
    return out;
  }

  /// Solves J (x - M^-1 J' reaction) = 0 with J the Jacobian of the constraints, and applies the reactions to x.
  [[gnu::noinline]] void apply(const Body<T, kSize>& b, const MassMatrix<T, kSize>& mass,
                               std::array<T, kSize.bodies + 1>& x) {
    const int n = b.bodies + int(!kSize.straight() && b.base == Base::kRail);
    std::array<std::array<T, kSize.bodies + 1>, kMax> response{};  // columns of M^-1 J'
    Symmetric<T, kMax> w;
    for (int i = 0; i < kMax; ++i) {
      reaction[i] = T(0), w.m[i][i] = T(1);
      if (!any(held[i])) continue;
      add_unit(b, i, response[i]), mass.solve(n, response[i]);
      reaction[i] = masked(held[i], constraint_rate(b, i, x));
      for (int k = 0; k <= i; ++k)
        if (any(held[k])) w.m[i][k] = select(held[i] & held[k], constraint_rate(b, k, response[i]), w.m[i][k]);
    }
    w.factor(kMax), w.solve(kMax, reaction);
    for (int i = 0; i < kMax; ++i) {
      if (!any(held[i])) continue;
      for (int j = 0; j < n; ++j) x[j] -= reaction[i] * response[i][j];
    }
    for (int i = 0; i < kMax; ++i) {  // exact zeros, from the base outwards
      T& rate = x[std::size_t(i == kRail ? int(b.bodies) : b.joint[i].child)];
      rate = select(held[i], T(i == kRail || parent(b, i) < 0 ? T(0) : x[std::size_t(parent(b, i))]), rate);
    }
  }

 private:
  /// Parent body of joint i; -1 if it does not turn.
  static int parent(const Body<T, kSize>& b, int i) {
    const int of = b.joint[i].parent;
    return !kSize.straight() && of == 0 && b.first_fixed ? -1 : of;
  }
  static void add_unit(const Body<T, kSize>& b, int i, std::array<T, kSize.bodies + 1>& x) {
    if (i == kRail) return void(x[std::size_t(int(b.bodies))] = T(1));
    x[std::size_t(b.joint[i].child)] = T(1);
    if (parent(b, i) >= 0) x[std::size_t(parent(b, i))] = T(-1);
  }
  static T constraint_rate(const Body<T, kSize>& b, int i, const std::array<T, kSize.bodies + 1>& x) {
    if (i == kRail) return x[std::size_t(int(b.bodies))];
    const T& child = x[std::size_t(b.joint[i].child)];
    return parent(b, i) < 0 ? child : T(child - x[std::size_t(parent(b, i))]);
  }
};

/// Eq. 1 for a tree: the accelerations under loads (joint torques included), gravity and a force along the rail; joints
/// that `stick` holds keep their rates.
template <class T, Capacity kSize>
TreeAccelerations<T, kSize.bodies> solve(const Body<T, kSize>& b, const TreePose<T, kSize.bodies>& p,
                                         const TreeLoads<T, kSize.bodies>& load, const std::array<T, 2>& gravity,
                                         const T& along_rail, StickConstraints<T, kSize>* stick = nullptr) {
  const T &gx = gravity[0], &gy = gravity[1];
  std::array<T, MassMatrix<T, kSize>::kMax> right{};
  const int bodies = b.bodies;
  const Base base = kSize.straight() ? Base::kFree : b.base;
  for (int j = 0; j < bodies; ++j) {
    right[j] = load.torque[j];
    if (base != Base::kFree) right[j] += y_of(b.moment, p, j) * gx + x_of(b.moment, p, j) * gy;
  }
  const T fx = load.x + b.mass * gx, fy = load.y + b.mass * gy;
  if (base == Base::kRail) right[bodies] = b.rail[0] * fx + b.rail[1] * fy + along_rail;
  MassMatrix<T, kSize> mass(b, p, right);
  if (base == Base::kRail)  // separate calls: loop counts are constants in exact kernels
    mass.factor(bodies + 1), mass.solve(bodies + 1, right);
  else if constexpr (kSize.straight())
    mass.factor(b.bodies, b.inverse_first), mass.solve(b.bodies, right);
  else
    mass.factor(b.bodies), mass.solve(b.bodies, right);
  if (stick) [[unlikely]]
    stick->apply(b, mass, right);
  TreeAccelerations<T, kSize.bodies> out;
  for (int j = 0; j < bodies; ++j) out.alpha[j] = right[j];
  if (base == Base::kFree)
    out.x = fx * b.inverse_mass, out.y = fy * b.inverse_mass;
  else if (base == Base::kRail)
    out.x = right[bodies] * b.rail[0], out.y = right[bodies] * b.rail[1];
  return out;
}

/// Kinetic energy [J].
template <class T, Capacity kSize>
T kinetic_energy(const Body<T, kSize>& b, const TreePose<T, kSize.bodies>& p) {
  T twice = b.mass * (p.vx * p.vx + p.vy * p.vy);
  for (int j = 0; j < b.bodies; ++j) {
    twice += b.n[j][j] * p.omega[j] * p.omega[j];
    for (int k = 0; k < j; ++k) {
      const T c = p.cos[j] * p.cos[k] + p.sin[j] * p.sin[k], s = p.sin[j] * p.cos[k] - p.cos[j] * p.sin[k];
      T m = b.p[j][k] * c;
      if constexpr (!kSize.straight()) m += b.n[j][k] + b.q[j][k] * s;
      twice += T(2) * m * p.omega[j] * p.omega[k];
    }
    if (!kSize.straight() && b.base != Base::kFree)
      twice += T(2) * p.omega[j] * (p.vx * y_of(b.moment, p, j) + p.vy * x_of(b.moment, p, j));
  }
  return T(0.5) * twice;
}

/// Lever arms of a place of a link, from those of its origin.
template <class T, Capacity kSize>
Arms<T, kSize.bodies> shifted(const Body<T, kSize>& b, std::type_identity_t<Arms<T, kSize.bodies>> from, int link,
                              const Place& at) {
  const std::size_t body = std::size_t(b.body_of[link]);
  const double c = std::cos(b.offset[link]), s = std::sin(b.offset[link]);
  from.a[body] += at.along * c - at.across * s, from.b[body] += at.along * s + at.across * c;
  return from;
}

/// Sets the joints of the tree, and adds the inertia of geared motors.
template <Capacity kSize>
void set_joints(Body<double, kSize>& out, const Robot& robot) {
  int joints = 0;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& joint = robot.joints[i];
    if (joint.kind == DriveKind::kLocked) continue;
    const int parent = robot.links[joint.child].parent, child = out.body_of[joint.child];
    TreeJoint& place = out.joint[joints++];
    place = {parent < 0 ? -1 : out.body_of[parent], child, parent < 0 ? 0 : -out.offset[parent], int(i)};
    if (joint.kind != DriveKind::kGeared) continue;
    out.n[child][child] += joint.sea.i_motor;
    if (place.parent < 0) continue;
    out.n[place.parent][place.parent] += joint.sea.i_motor;
    out.n[child][place.parent] -= joint.sea.i_motor, out.n[place.parent][child] -= joint.sea.i_motor;
  }
  out.joints = {joints};
}

/// Sets the ends of stops, after the contacts.
template <Capacity kSize>
void set_stops(Body<double, kSize>& out, const Robot& robot) {
  out.stops_begin = out.stops_end = out.contacts;
  for_each_stop_end(robot, [&](const Stop& s, int end) {
    const auto at = std::find_if(out.joint.begin(), out.joint.end(), [&](auto& j) { return j.joint == s.joint; });
    out.stop[std::size_t(out.stops_end++)] = {s.joint < 0 ? -1 : int(at - out.joint.begin()), end == 0 ? 1.0 : -1.0,
                                              s.ends[std::size_t(end)]};
  });
}

/// The constants of the equations of a robot, which must fit the kernel.
template <Capacity kSize>
Body<double, kSize> body_of(const Robot& robot) {
  using Arm = Arms<double, kSize.bodies>;
  Body<double, kSize> out;
  out.base = robot.base;
  int bodies = 0;
  const std::size_t links = robot.links.size();
  std::array<Arm, kMaxLinks> origin{}, com{};
  const auto shifted = [&](const Arm& from, int link, const Place& at) {
    return landing::shifted(out, from, link, at);
  };
  for (int i = 0; i < int(robot.links.size()); ++i) {
    const Link& link = robot.links[i];
    const Joint* joint = robot.joint_of(i);
    const bool locked = joint && joint->kind == DriveKind::kLocked;
    if (i == 0) {
      bodies = 1, out.first_fixed = robot.base == Base::kRail || locked;
    } else {
      origin[i] = shifted(origin[link.parent], link.parent, link.at);
      out.offset[i] = locked ? out.offset[link.parent] + joint->phi : 0;
      out.body_of[i] = locked ? out.body_of[link.parent] : bodies++;
    }
    com[i] = shifted(origin[i], i, link.com);
    out.mass += link.mass;
  }
  out.inverse_mass = 1 / out.mass;
  Arm centre;
  for (std::size_t i = 0; i < links; ++i)
    for (int j = 0; j < bodies; ++j)
      centre.a[j] += robot.links[i].mass * com[i].a[j], centre.b[j] += robot.links[i].mass * com[i].b[j];
  if (robot.base != Base::kFree) out.moment = centre;
  const auto from_base = [&](Arm arm) {  // the base of a free robot is its centre of mass
    for (int j = 0; j < bodies && robot.base == Base::kFree; ++j)
      arm.a[j] -= centre.a[j] / out.mass, arm.b[j] -= centre.b[j] / out.mass;
    return arm;
  };
  for (std::size_t i = 0; i < links; ++i) {
    const Arm r = from_base(com[i]);
    const double m = robot.links[i].mass;
    out.n[out.body_of[i]][out.body_of[i]] += robot.links[i].inertia_com;
    for (int j = 0; j < bodies; ++j)
      for (int k = 0; k < bodies; ++k)
        out.p[j][k] += m * (r.a[j] * r.a[k] + r.b[j] * r.b[k]), out.q[j][k] += m * (r.a[j] * r.b[k] - r.b[j] * r.a[k]);
  }
  set_joints(out, robot);
  for (int j = 0; j < bodies; ++j) out.n[j][j] += out.p[j][j];
  out.inverse_first = 1 / out.n[0][0];
  out.bodies = {bodies};
  for (const ContactPoint& c : robot.contacts)
    out.contact[out.contacts++] = from_base(shifted(origin[c.link], c.link, c.at));
  set_stops(out, robot);
  out.peak = from_base(shifted(origin[robot.peak_link], robot.peak_link, robot.peak));
  for (std::size_t i = 0; i < links; ++i) out.origin[i] = from_base(origin[i]);
  out.first = out.origin[0];
  return out;
}

}  // namespace ukemi::landing
