// Sizes and names of a robot's parts, for those who read, fit and draw it.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "landing/body/robot.hpp"

namespace ukemi::landing {

/// A robot with a drive that is late (DriveLag) has at most so many; contacts with the ends of stops.
inline constexpr int kMostLateLinks = 5, kMostLateJoints = 4, kMostLateContacts = 7;
bool may_be_late(const Robot& robot);  ///< whether it has no more
bool has_late_drive(const Robot& robot);

/// "rail", or the name of its joint.
std::string stop_name(const Robot& robot, const Stop& stop);
/// f(stop, 0: its low end, 1: its high one) of every end that a robot's stops have.
template <class F>
void for_each_end(const Robot& robot, F&& f) {
  for (const Stop& s : robot.stops)
    for (const int end : {0, 1})
      if (std::isfinite(s.ends[std::size_t(end)])) f(s, end);
}
/// The joint of Robot::joints that alone is driven; absent: none is, or several are.
std::optional<std::size_t> only_driven(const Robot& robot);
/// Contacts and ends of stops: at most kMostContacts.
int pushing_points(const Robot& robot);
/// The places of a link that are not its centre of mass: its origin, its children's joints, its contacts, the peak's
/// point; each once.
std::vector<Place> places(const Robot& robot, int link);
/// Of a link: the largest distance between two of its places [m].
double extent(const Robot& robot, int link);
/// The largest distance of a place of the robot from the first link's origin, all joints in line or not [m].
double reach(const Robot& robot);

}  // namespace ukemi::landing
