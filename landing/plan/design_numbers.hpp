// The design numbers of a robot of links, its floor and its drop, named by their paths in the files.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "landing/body/body_scene.hpp"

namespace ukemi::landing {

/// Every name there is for a scene: drive.JOINT.KEY and drive.*.KEY (all driven joints), robot.link.LINK.KEY,
/// robot.contact.CONTACT.KEY and robot.contact.*.KEY (all contacts that have it), robot.gravity, robot.pin_height,
/// robot.rail.KEY, stop.JOINT.KEY, floor.KEY (all contacts that have no KEY of their own), drop.KEY, detection.delay,
/// load.NAME.rating. Keys and units are those of the files, as k_sea, speed_max, mass, at.along, pad.thickness,
/// friction, pitch_deg; and robot.link.LINK.length, which stretches a link with all that is on it, mass kept.
std::vector<std::string> design_names(const BodyScene& scene);

/// Whether it is a drive's rating, which matters only to plans that respect ratings.
bool is_rating(const std::string& name);

/// Sets a number of scenes like this one without checking its range; throws InputError as design_number. For repeated
/// use; BodyScene::validate checks the result.
std::function<void(BodyScene&, double)> design_setter(const BodyScene& scene, const std::string& name);

/// Reads a number of scenes like this one, as design_number. For repeated use.
std::function<double(const BodyScene&)> design_getter(const BodyScene& scene, const std::string& name);

/// Its value; of several contacts the first's. NaN where it is absent, as a rating that is not given or the number of a
/// missing pad. Throws InputError for a name that is not in design_names.
double design_number(const BodyScene& scene, const std::string& name);

/// Sets it; thickness 0 removes a pad. Throws InputError for a name that is not in design_names, a pad's
/// number where there is no pad, or a value outside of the range of its key.
void set_design_number(BodyScene& scene, const std::string& name, double value);

}  // namespace ukemi::landing
