// Derivatives through an event. A guard g(t, y) falls through zero at a time t* that depends on the parameters p:
//
//     dt*/dp = -(dg/dp) / (dg/dt),      y_p(+) = y_p(-) + (f(-) - f(+)) dt*/dp                           (saltation)
//
// with y_p the derivatives of the state at a fixed time and f the field before and after the event.
// Source: Hiskens, Pai, "Trajectory sensitivity analysis of hybrid systems", IEEE Trans. Circuits Syst. I 47 (2000).
// Tests: test/property/gradient.cpp.
#pragma once

#include <Eigen/Core>

#include "common/jet.hpp"
#include "common/scalar.hpp"

namespace ukemi::integrate {

/// dt*/dp of the event of a guard that falls at `rate` [1/s] there; not finite where `rate` is 0.
template <int P>
Eigen::Matrix<double, P, 1> event_shift(const ceres::Jet<double, P>& guard, double rate) {
  return guard.v / -rate;
}

/// y_p(-) to y_p(+) where the state does not jump; `before`, `after`: the values of the field before and after the
/// event; `shift`: dt*/dp.
template <class State, class Values, class Shift>
void saltate(State& y, const Values& before, const Values& after, const Shift& shift) {
  for (int k = 0; k < y.size(); ++k) y[k].v += (before[k] - after[k]) * shift;
}
/// Where the state jumps: from derivatives at a fixed time to those at the event's time, which moves by `shift`;
/// `slope`: dy/dt there. Apply the jump to the state, then move back by -shift.
template <class State, class Values, class Shift>
void move_along(State& y, const Values& slope, const Shift& shift) {
  for (int k = 0; k < y.size(); ++k) y[k].v += slope[k] * shift;
}

}  // namespace ukemi::integrate
