// A piece of the reference as waypoints of a quintic spline, as trajectory controllers need it.
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

/// Maximum error of a spline of waypoints [rad].
inline constexpr double kSplineMisfit = 1e-4;

/// Angle of the quintic that has the angles, rates and accelerations of both points, at a time between them [rad].
double spline_between(const Waypoint& a, const Waypoint& b, double t);

/// A piece of the reference as waypoints, the first at its start, the last at its end, with the fewest equal steps
/// that keep kSplineMisfit at 64 samples of each. Without shape terms one step is exact, but for the rounding of the
/// duration to nanoseconds.
/// Tests: test/unit/waypoints.cpp.
std::vector<Waypoint> waypoints(const ReferencePiece<double>& piece);
/// Waypoints of several pieces with starts >= 0 at the union of their times; before and after it a piece is constant.
std::vector<std::vector<Waypoint>> waypoints(const std::vector<ReferencePiece<double>>& pieces);

}  // namespace ukemi::landing
