// JSON of landings for the page's animation (page/fall.js): columns over time, rounded to what is visible.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "landing/body/body_run.hpp"
#include "landing/run/landing.hpp"
#include "tools/program/json.hpp"

namespace ukemi::tools {

/// Name of Touch::point and Peak::point.
using PointName = std::function<std::string(int)>;
std::string point_name(int point);  ///< of the paper's robot: hip, knee, foot
/// Names of the robot's contacts; `robot` must outlive the returned function.
PointName contact_name(const landing::Robot& robot);

/// The peaks that follow a touchdown: those that figures number.
std::vector<landing::Peak> contact_peaks(const std::vector<landing::Peak>& peaks);
Json peaks_json(const std::vector<landing::Peak>& peaks, const PointName& name = point_name);

/// Polyline of a link in its own frame [m]: through its places, closed unless they are collinear; a small square for a
/// link without length.
std::vector<landing::Place> outline(const landing::Robot& robot, int link);

/// A landing; `ghosts`: the same motion in other drops, drawn thin. `length`: of each link [m].
Json animation(const std::string& name, const landing::Landing& landing, const std::vector<landing::Landing>& ghosts,
               double length);
Json animation(const std::string& name, const landing::BodyScene& scene, const landing::BodyLanding& landing);

}  // namespace ukemi::tools
