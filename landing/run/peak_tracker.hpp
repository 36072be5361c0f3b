// Finds the largest |ddr_0| of a run: at both ends of every step, and inside steps that could hold a larger value.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace ukemi::landing {

/// The largest |ddr_0|^2 of the steps so far, and its time.
class PeakTracker {
 public:
  double square = 0, t = 0;

  void consider(double q, double time) {
    if (q > square) square = q, t = time;
  }
  void reset() { square = 0; }
  /// The field has jumped: the next step's start is not the last one's end.
  void jump() { has_last_ = false; }

  /// Checks both ends of the step (their limits from inside) and, if it could hold a larger value, its interior. False
  /// if the interior is so far above the ends that the step does not resolve the forces.
  template <class System, class Integrator>
  [[nodiscard]] bool step(const System& system, Integrator& integrator) {
    const auto& step = integrator.step();
    const double q1 = system.peak_square(step.y_end, step.slope_end),
                 q0 = has_last_ ? last_ : system.peak_square(step.y, step.slope);
    has_last_ = true, last_ = q1;
    const double before = square;
    consider(q0, step.t);
    consider(q1, step.t + step.h);
    if (kMaxGrowth * kMaxGrowth * std::max(q0, q1) < square || step.h <= 0) return true;
    const auto f = [&](double s) {
      const auto y = integrator.dense().at(s);
      const double time = step.t + s * step.h;
      const double q = system.peak_square(y, system.derivative(time, y));
      consider(q, time);
      return q;
    };
    std::array<Node, 6> node{{{0, q0}, {0.125, 0}, {0.25, 0}, {0.5, 0}, {0.75, 0}, {1, q1}}};
    for (int i = 1; i < 5; ++i) node[i].q = f(node[i].s);
    for (int i = 0; i + 2 < 6; ++i) {
      const double top = vertex(node[i], node[i + 1], node[i + 2]);
      if (top > node[i].s && top < node[i + 2].s &&
          std::max({node[i].q, node[i + 1].q, node[i + 2].q}) > kCandidate * square)
        refine(node[i], node[i + 1], node[i + 2], f);
    }
    return square <= before || square <= kUnresolved * kUnresolved * std::max({q0, q1, kSmall * kSmall});
  }

 private:
  bool has_last_ = false;
  double last_ = 0;                           ///< at the end of the last step
  static constexpr double kMaxGrowth = 4;     ///< a resolved step with a new peak ends above a quarter of the old one
  static constexpr double kUnresolved = 100;  ///< times the larger end: not resolved
  static constexpr double kSmall = 10;        ///< below it |ddr_0| counts as resolved [m/s^2]
  static constexpr double kCandidate = 0.9;   ///< of the peak, as squares: lower nodes are not refined

  struct Node {
    double s, q;
  };
  /// Vertex of the parabola through three nodes; NaN or outside if there is no maximum.
  static double vertex(const Node& a, const Node& b, const Node& c) {
    const double u = (b.q - a.q) / (b.s - a.s), v = (c.q - b.q) / (c.s - b.s), bend = (v - u) / (c.s - a.s);
    return bend < 0 ? 0.5 * (a.s + b.s - u / bend) : -1;
  }
  /// Successive parabolic interpolation: the error of the maximum is of second order in the last step.
  template <class F>
  static void refine(Node a, Node b, Node c, F&& f) {
    for (int i = 0; i < 8; ++i) {
      const double s = vertex(a, b, c);
      if (!(s > a.s && s < c.s) || std::abs(s - b.s) < 1e-6) return;
      const Node n{s, f(s)};
      if (std::abs(n.q - b.q) < 1e-13 * b.q) return;
      if (s < b.s) {
        if (n.q > b.q)
          c = b, b = n;
        else
          a = n;
      } else {
        if (n.q > b.q)
          a = b, b = n;
        else
          c = n;
      }
    }
  }
};

}  // namespace ukemi::landing
