// Landings as the page's script draws them (page/fall.js): columns over time, to as many digits as an eye can see.
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
std::string point_name(int point);  ///< of the paper's robot
/// Of the robot's contacts; it must outlive the names.
PointName contact_name(const landing::Robot& robot);

/// The peaks that a touchdown began.
std::vector<landing::Peak> numbered(const std::vector<landing::Peak>& peaks);
Json peaks_json(const std::vector<landing::Peak>& peaks, const PointName& name = point_name);

/// A link as it is drawn: through its places, closed where they are not in a line; a body of no length as a small
/// square.
std::vector<landing::Place> outline(const landing::Robot& robot, int link);

/// A landing with its trajectory; thin beside it the same motion in other drops. `length`: of each link [m].
Json animation(const std::string& name, const landing::Landing& landing, const std::vector<landing::Landing>& ghosts,
               double length);
Json animation(const std::string& name, const landing::BodyScene& scene, const landing::BodyLanding& landing);

}  // namespace ukemi::tools
