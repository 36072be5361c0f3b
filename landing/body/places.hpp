// Sizes and names of a robot's parts.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "landing/body/robot.hpp"

namespace ukemi::landing {

/// Maximum sizes of a robot with a late drive (DriveLag); the contacts include the ends of stops.
inline constexpr int kMaxLateLinks = 5, kMaxLateJoints = 4, kMaxLateContacts = 7;
bool fits_late_kernel(const Robot& robot);  ///< whether it is within these maxima
bool has_late_drive(const Robot& robot);

/// "rail", or the name of the stop's joint.
std::string stop_name(const Robot& robot, const Stop& stop);
/// Calls f(stop, end) for every finite end of the robot's stops; end 0 is the low one, 1 the high one.
template <class F>
void for_each_stop_end(const Robot& robot, F&& f) {
  for (const Stop& s : robot.stops)
    for (const int end : {0, 1})
      if (std::isfinite(s.ends[std::size_t(end)])) f(s, end);
}
/// Index of the only driven joint; absent if none or several are driven.
std::optional<std::size_t> sole_driven_joint(const Robot& robot);
/// Number of contacts and of ends of stops, together at most kMaxContacts.
int contacts_and_stop_ends(const Robot& robot);
/// The distinct places of a link except its centre of mass: origin, joints of its children, contacts, the peak point.
std::vector<Place> places(const Robot& robot, int link);
/// Largest distance between two places of a link [m].
double extent(const Robot& robot, int link);
/// Upper bound of the distance of any place of the robot from the first link's origin, for any joint angles [m].
double reach(const Robot& robot);

}  // namespace ukemi::landing
