// A landing with Boost.odeint: Dormand-Prince 5(4) with dense output, events located on it.
#pragma once

#include <boost/numeric/odeint.hpp>
#include <functional>

#include "test/bench/peer.hpp"

namespace ukemi::bench {

class OdeintLanding {
 public:
  Result operator()(const Case& c, double accuracy) const {
    namespace odeint = boost::numeric::odeint;
    Course course(c);
    Field field{&course.system};
    auto stepper = odeint::make_dense_output(accuracy, accuracy, kMaxStep, odeint::runge_kutta_dopri5<Vector>());
    bool failed = !course.settle(-1);
    try {
      stepper.initialize(vector(course.y), course.t, 1e-3);
      failed = failed || !run(course, stepper, field);
    } catch (const std::runtime_error&) {  // no step is small enough
      failed = true;
    }
    course.result.derivatives += field.calls;
    return course.finish(failed);
  }

 private:
  using Vector = std::array<double, System::kStates>;

  static State state(const Vector& x) { return Eigen::Map<const State>(x.data()); }
  static Vector vector(const State& y) {
    Vector x;
    Eigen::Map<State>(x.data()) = y;
    return x;
  }

  /// Keeps its last value: after a step that is the slope at the step's end, which the stepper does not show.
  struct Field {
    const System* system;
    State last{};
    long calls = 0;
    void operator()(const Vector& x, Vector& dxdt, double t) {
      last = system->derivative(t, state(x));
      Eigen::Map<State>(dxdt.data()) = last;
      ++calls;
    }
  };

  template <class Stepper>
  static bool run(Course& course, Stepper& stepper, Field& field) {
    const System& system = course.system;
    Guards end;
    Vector x;
    double q0 = course.square();
    for (long n = 0; n < kMaxSteps; ++n) {
      stepper.do_step(std::ref(field));
      const double t0 = course.t;
      double h = stepper.current_time() - t0;
      const auto at = [&](double s) {
        stepper.calc_state(t0 + s * h, x);
        return state(x);
      };
      State y = state(stepper.current_state()), dy = field.last;
      if (!y.allFinite()) return false;
      const bool stops = stepper.current_time() >= course.stop();
      const auto cut = [&](double s) {
        y = at(s), h *= s;
        dy = system.derivative(t0 + h, y);
        ++field.calls;
      };
      if (stops) cut((course.stop() - t0) / h);
      system.guards(t0 + h, y, dy, end);
      const Crossing crossing = first_crossing(course.start, end, h, [&](double s, Guards& g) {
        system.guards(t0 + s * h, at(s), dy, g);  // only the values are used
      });
      if (crossing.guard >= 0) cut(crossing.s);

      const double q1 = course.square(y, dy);
      course.peak.consider(q1, t0 + h);
      search_peak(course.peak, q0, q1, [&](double s) {
        const State inside = at(s);
        const double q = course.square(inside, system.derivative(t0 + s * h, inside));
        course.peak.consider(q, t0 + s * h);
        return q;
      });

      course.t = t0 + h, course.y = y, course.dy = dy;
      if (crossing.guard >= 0) {
        if (!course.settle(crossing.guard)) return false;
      } else if (stops) {
        course.t = course.stop();
      } else {
        course.start = end, q0 = q1;
        continue;
      }
      if (course.t >= course.stop() - kSameInstant && course.ended()) return true;
      if (crossing.guard < 0 && !course.settle(-1)) return false;
      q0 = course.square();
      stepper.initialize(vector(course.y), course.t, stepper.current_time_step());
    }
    return false;
  }
};

}  // namespace ukemi::bench
