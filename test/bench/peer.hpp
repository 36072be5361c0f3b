// What a landing needs beside an integrator, for the peers: its start, its modes, where a guard falls through zero
// inside a step, and where |ddr_0| is largest. Written apart from landing/body/body_follow.hpp, so that the two check
// each other; only the equations of landing/body/body_system.hpp are shared.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "landing/body/body_system.hpp"
#include "landing/body/by_links.hpp"
#include "landing/run/peak_tracker.hpp"
#include "tools/bench/reference.hpp"

namespace ukemi::bench {

using System = landing::BodySystem<landing::kPlainPair, false>;
using State = System::State;
using Guards = integrate::Guards<System::kGuards>;

using Case = landing::ReferenceCase;

/// Where the robot is at the end: x_0, y_0 [m], phi_0, phi_1, phi_m [rad].
using Place = std::array<double, 5>;
inline Place place_of(const System& system, const State& y) {
  using namespace landing;
  const Vec2<double> r = position(system.body.peak, system.pose(y), system.body.bodies);
  return {r.x(), r.y(), y[System::kTheta], y[System::kTheta + 1] - y[System::kTheta], y[System::kPhiM]};
}

/// What a peer returns of a landing.
struct Result {
  double peak = 0;
  Place place{};
  long derivatives = 0;  ///< by the integrator, without those that look for the peak
  long events = 0;
  bool failed = false;
  std::array<char, 64> touchdowns{};  ///< the first ones, a letter each; fixed in size, so that no run allocates
  int touched = 0;
  std::string order() const { return {touchdowns.data(), std::size_t(std::min<int>(touched, touchdowns.size()))}; }
};

inline constexpr double kMaxStep = 0.1;        ///< as in landing/body/body_follow.hpp [s]
inline constexpr double kSameInstant = 1e-14;  ///< times nearer than this are one [s]
inline constexpr long kMaxSteps = 200'000;
inline constexpr int kMaxAtOnce = 64;     ///< events at one instant
inline constexpr long kMaxEvents = 1000;  ///< a landing has tens; a run that is too coarse may chatter without end

/// A landing from its first touchdown on, as far as no integrator is concerned.
class Course {
 public:
  explicit Course(const Case& c)
      : motion(c.motion),
        system(landing::TwoLinkLanding(c.scene, c.sea, c.motion).scene.robot, 0),
        limit_(*c.scene.t_end) {
    using namespace landing;
    const Drop& drop = c.scene.drop;
    system.piece[0] = constant_reference(c.motion.phi_i);
    y.setZero();
    y[System::kTheta] = drop.pitch, y[System::kTheta + 1] = drop.pitch + c.motion.phi_i;
    y[System::kPhiM] = c.motion.phi_i;
    const System::Pose p = system.pose(y);
    double lowest = std::numeric_limits<double>::infinity();
    for (int j = 0; j < kPoints; ++j) lowest = std::min(lowest, system.point_at(j, p).y);
    // In flight nothing moves relative to anything else, so the fall is a parabola and its acceleration is g.
    const double g = c.scene.robot.gravity;
    t = std::sqrt(2 * drop.height / g);
    y[System::kX] = -position(system.body.peak, p, system.body.bodies).x() + drop.forward_speed * t;
    y[System::kY] = -lowest;
    y[System::kVx] = drop.forward_speed, y[System::kVy] = -g * t;
    peak.consider(g * g, 0);
  }

  landing::Motion motion;
  System system;
  double t;
  State y, dy;   ///< dy: right limit of the field at (t, y), kept by the peer
  Guards start;  ///< guards there
  landing::PeakTracker peak;
  Result result;

  /// Where the integrator must stop next [s].
  double stop() const { return std::min(limit_, motion_end_); }
  /// The stop time is reached: the end of the motion, or true at the end of the run.
  bool ended() {
    if (t >= motion_end_ - kSameInstant) {
      system.joint[0].phase = landing::Phase::kAfter;
      motion_end_ = std::numeric_limits<double>::infinity();
    }
    return t >= limit_ - kSameInstant;
  }

  /// Evaluates the field and the guards at (t, y) and goes through every event that is due there, after that of `guard`
  /// if it is one. False if there is no end of them.
  bool settle(int guard) {
    for (int n = 0; n < kMaxAtOnce && result.events < kMaxEvents; ++n) {
      if (guard >= 0) cross(guard);
      dy = system.derivative(t, y);
      ++result.derivatives;
      system.guards(t, y, dy, start);
      peak.consider(square(), t);
      if ((guard = due()) < 0) return true;
    }
    return false;
  }

  /// |ddr_0|^2 at (t, y) and at another state with its field.
  double square() const { return square(y, dy); }
  double square(const State& at, const State& slope) const { return system.peak_square(at, slope); }

  Result finish(bool failed) {
    result.peak = std::sqrt(peak.square);
    result.failed = failed || !y.allFinite();
    result.place = place_of(system, y);
    return result;
  }

 private:
  double limit_, motion_end_ = std::numeric_limits<double>::infinity();

  int due() const {
    for (int i = 0; i < System::kGuards; ++i)
      if (start.value[i] <= kSameInstant && start.rate[i] < 0) return i;
    return -1;
  }
  void cross(int guard) {
    ++result.events;
    const int touched = system.cross(guard, y);
    if (touched < 0) return;
    if (result.touched == 0) {
      system.piece[0] = landing::piece_after(landing::ReferenceChange::kLand, motion, system.piece[0], t);
      system.joint[0].phase = landing::Phase::kMoving;
      motion_end_ = t + motion.duration;
    }
    if (result.touched < int(result.touchdowns.size())) result.touchdowns[result.touched] = "HKF"[touched];
    ++result.touched;
  }
};

/// The first guard to fall through zero inside a step, and where (0..1); guard -1: none.
struct Crossing {
  int guard = -1;
  double s = 1;
};

/// Zero of f between a, where it is positive, and b, where it is not: false position with halving (Illinois).
template <class F>
double falling_zero(double a, double fa, double b, double fb, F&& f) {
  for (int n = 0, kept = 0; n < 100 && fb < 0 && b - a > 1e-14; ++n) {
    double m = a + (b - a) * fa / (fa - fb);
    if (n > 30 || !(m > a && m < b)) m = 0.5 * (a + b);
    const double fm = f(m);
    if (std::abs(m - (fm > 0 ? a : b)) < 1e-14) return m;
    if (fm > 0) {
      a = m, fa = fm;
      if (kept == 1) fb *= 0.5;
      kept = 1;
    } else {
      b = m, fb = fm;
      if (kept == -1) fa *= 0.5;
      kept = -1;
    }
  }
  return b;
}

/// `at(s, guards)` gives the guards' values inside the step of length h, on its dense output. The cubic through values
/// and rates at both ends, bounded by its Bezier points, tells whether the inside must be looked at.
template <class At>
Crossing first_crossing(const Guards& start, const Guards& end, double h, At&& at) {
  unsigned falls = 0, dips = 0;
  for (int i = 0; i < System::kGuards; ++i) {
    const double a = start.value[i], b = end.value[i], da = start.rate[i] * h / 3, db = end.rate[i] * h / 3;
    if (b > 0 && a + da > 0 && b - db > 0) continue;
    (a > 0 && b <= 0 && da < 0 && db < 0 ? falls : dips) |= 1u << i;
  }
  Crossing first;
  if ((falls | dips) == 0) return first;
  Guards g;
  const auto locate = [&](int i, double a, double fa, double b, double fb) {
    const double s = falling_zero(a, fa, b, fb, [&](double x) {
      at(x, g);
      return g.value[i];
    });
    if (first.guard < 0 || s < first.s) first = {i, s};
  };
  for (int i = 0; i < System::kGuards; ++i)
    if (falls >> i & 1u) {
      double upper = 1, value = end.value[i];
      if (first.guard >= 0) {  // only an earlier one is of interest
        at(upper = first.s, g);
        if ((value = g.value[i]) > 0) continue;
      }
      locate(i, 0, start.value[i], upper, value);
    }
  if (dips == 0) return first;
  // Three points inside, and the lowest point of the parabola through the deepest one and its neighbours.
  std::array<double, 5> place{0, 0.25, 0.5, 0.75, 1};
  std::array<Guards, 5> node;
  node[0] = start, node[4] = end;
  for (int n = 1; n < 4; ++n) at(place[n], node[n]);
  for (int i = 0; i < System::kGuards; ++i) {
    if (!(dips >> i & 1u)) continue;
    const auto value = [&](int n) { return node[n].value[i]; };
    int below = 1;
    while (below < 5 && value(below) > 0) ++below;
    if (below == 5) {
      int low = 1;
      for (int n = 2; n < 4; ++n)
        if (value(n) < value(low)) low = n;
      const double left = value(low - 1) - value(low), right = value(low + 1) - value(low);
      if (!(left > 0 && right > 0)) continue;
      const double s = place[low] + 0.125 * (left - right) / (left + right);
      at(s, g);
      if (g.value[i] > 0) continue;
      const int before = s > place[low] ? low : low - 1;
      locate(i, place[before], std::max(value(before), 0.0), s, g.value[i]);
    } else {
      double a = place[below - 1], fa = value(below - 1);
      if (below == 1) {  // it may start on the zero that it has just left: find where it has risen
        for (double s = place[1]; fa <= 0 && s > 1e-9; s *= 0.5) {
          at(s, g);
          if (g.value[i] > 0) a = s, fa = g.value[i];
        }
        if (fa <= 0) {
          first = {i, 0};
          continue;
        }
      }
      locate(i, a, fa, place[below], value(below));
    }
  }
  return first;
}

/// Looks for a top of |ddr_0|^2 inside a step with q0, q1 at its ends. `square_at(s)` evaluates it there and shows it
/// to the tracker. A step that ends far below the running peak holds none.
template <class F>
void search_peak(const landing::PeakTracker& peak, double q0, double q1, F&& square_at) {
  constexpr double kFarBelow = 16, kNear = 0.9;
  if (kFarBelow * std::max(q0, q1) < peak.square) return;
  struct Node {
    double s, q;
  };
  std::array<Node, 5> node{{{0, q0}, {0.25, 0}, {0.5, 0}, {0.75, 0}, {1, q1}}};
  for (int i = 1; i < 4; ++i) node[i].q = square_at(node[i].s);
  for (int i = 0; i + 2 < 5; ++i) {
    Node a = node[i], b = node[i + 1], c = node[i + 2];
    for (int n = 0; n < 8; ++n) {  // successive parabolas
      if (std::max({a.q, b.q, c.q}) < kNear * peak.square) break;
      const double u = (b.q - a.q) / (b.s - a.s), v = (c.q - b.q) / (c.s - b.s);
      if (!(v < u)) break;
      const double top = 0.5 * (a.s + b.s) + 0.5 * (c.s - a.s) * u / (u - v);
      if (!(top > a.s && top < c.s) || std::abs(top - b.s) < 1e-6) break;
      const Node m{top, square_at(top)};
      const bool higher = m.q > b.q, converged = std::abs(m.q - b.q) < 1e-13 * b.q;
      (m.s < b.s ? (higher ? c : a) : (higher ? a : c)) = higher ? b : m;
      if (higher) b = m;
      if (converged) break;
    }
  }
}

}  // namespace ukemi::bench
