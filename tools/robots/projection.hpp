// Projection of a spatial robot onto a plane: the robot of links that `landing` simulates. Our own method.
//
// The plane is spanned by forward and up, two axes of the root's frame, in the posture in which every joint is at 0:
//
//     normal   forward  up      positive angles of ukemi turn from up's opposite to forward: about forward x up
//     x        y        z       +x
//     y        x        z       -y
//     z        x        y       +z
//
// A joint that turns about the normal stays: phi = q where its axis points along forward x up, else phi = -q. Every
// link hangs at theta = 0 in that posture, so a place with the offset d from its link's origin is [along, across] = [-d
// . up, d . forward]; what d has along the normal is dropped. All other joints are held at 0, and the bodies that they
// join are one: masses add, inertia tensors turn and move whole (Steiner), and of the sum about its centre of mass the
// component along the normal is the link's inertia.
#pragma once

#include "landing/body/body_scene.hpp"
#include "tools/robots/spatial_robot.hpp"

namespace ukemi::tools {

struct ProjectionOptions {
  std::string normal;                       ///< "x", "y", "z" of the root's frame
  std::vector<std::string> contacts;        ///< names of points
  std::vector<std::string> locked;          ///< joints about the normal to hold at 0
  std::optional<landing::Base> base;        ///< absent: free, with a warning where the description fixes it
  std::optional<double> pin_height;         ///< of a pinned origin above the floor [m]; needed with contacts
  std::vector<landing::GivenDrive> drives;  ///< actuator files of joints, by their names in robot.toml
};

/// A report line on one part of the description.
struct Note {
  std::string what, name, text;  ///< "locked", "hip_roll", "revolute, its axis ..."
};

struct Projection {
  landing::Robot robot;                  ///< joints without a given drive are passive
  std::vector<SpatialJoint> joints;      ///< parallel to robot.joints; angles are phi
  std::vector<std::string> drive_files;  ///< parallel to robot.joints; empty: not given
  std::vector<Note> notes;
  std::vector<std::string> warnings;
};

/// Throws InputError "FILE: ...": an unknown name, no joint about the normal, a joint that follows another, a moving
/// part without mass, more links, joints or contacts than a robot of links has. Tests: test/cli/descriptions.cpp.
Projection project(const SpatialRobot& robot, const ProjectionOptions& options);

/// The text of robot.toml that `read_robot` reads back to `projection.robot`; `comments` precedes it, each line
/// after "# ". Actuator files are named relative to `folder`. Values that the description lacks are commented as such.
std::string robot_toml(const Projection& projection, const SpatialRobot& from, const std::string& folder,
                       const std::string& comments);

}  // namespace ukemi::tools
