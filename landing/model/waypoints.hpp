// A piece of the reference as a few points that a quintic spline goes through, as trajectory controllers take it.
#pragma once

#include <vector>

#include "landing/model/motion.hpp"

namespace ukemi::landing {

/// The reference at a time.
struct Waypoint {
  double t;      ///< from the start of the piece [s], a whole number of nanoseconds
  double phi;    ///< [rad]
  double dphi;   ///< [rad/s]
  double ddphi;  ///< [rad/s^2]
};

/// A spline of waypoints is the reference within this [rad].
inline constexpr double kSplineMisfit = 1e-4;

/// Angle of the quintic that has the angles, rates and accelerations of both points, at a time between them [rad].
double spline_between(const Waypoint& a, const Waypoint& b, double t);

/// A piece of the reference as waypoints, the first at its start, the last at its end, as many equal steps as a quintic
/// spline needs to keep kSplineMisfit: looked for from one step on, by trial at 64 places of each. One step is exact
/// where there are no shape terms, but for the nanosecond to which the duration is rounded.
/// Tests: test/unit/waypoints.cpp.
std::vector<Waypoint> waypoints(const ReferencePiece<double>& piece);
/// Several pieces from t = 0 on, each from its own start (>= 0): the waypoints of each piece at the times of all, the
/// same number for each. A piece is constant before its start and after its end.
std::vector<std::vector<Waypoint>> waypoints(const std::vector<ReferencePiece<double>>& pieces);

}  // namespace ukemi::landing
