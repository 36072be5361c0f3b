#include "tools/robots/spatial_robot.hpp"

#include <fmt/format.h>
#include <Eigen/Core>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/files.hpp"
#include "common/text.hpp"

namespace ukemi::tools {

namespace {

constexpr std::size_t kLargestDescription = std::size_t(16) << 20;  ///< [bytes]
constexpr int kMaxDepth = 256;                                      ///< of nested elements
constexpr int kMaxBodies = 1000;                                    ///< the parsers may nest one within another

std::string extension_of(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

/// Throws InputError where elements nest too deeply, by counting '<' outside of comments and declarations: XML parsers
/// recurse for each nested element and would overflow the stack.
void check_depth(const std::string& path, const std::string& text) {
  int depth = 0;
  for (std::size_t i = text.find('<'); i != std::string::npos && i + 1 < text.size(); i = text.find('<', i + 1)) {
    if (text.compare(i, 4, "<!--") == 0) {
      i = text.find("-->", i);
      if (i == std::string::npos) return;
      continue;
    }
    if (text[i + 1] == '!' || text[i + 1] == '?') continue;
    if (text[i + 1] == '/') {
      --depth;
      continue;
    }
    const std::size_t end = text.find('>', i);
    if (end == std::string::npos || text[end - 1] != '/') ++depth;
    if (depth > kMaxDepth)
      throw InputError(Location{path, 1 + std::count(text.begin(), text.begin() + long(i), '\n')},
                       fmt::format("elements nest deeper than {}", kMaxDepth));
  }
}

void check_body_count(const std::string& path, const std::string& text) {
  int bodies = 0;
  for (const char* element : {"<link", "<body"})
    for (std::size_t i = text.find(element); i != std::string::npos; i = text.find(element, i + 1)) ++bodies;
  if (bodies > kMaxBodies) throw InputError({path}, fmt::format("{} links: at most {} are read", bodies, kMaxBodies));
}

void check_inertia(const SpatialRobot& robot, const SpatialBody& body) {
  const SpatialInertia& i = body.inertia;
  const auto fail = [&](const std::string& text) {
    throw InputError({robot.file}, "link " + quoted(body.name) + ": " + text);
  };
  if (!std::isfinite(i.mass) || !i.com.allFinite() || !i.tensor.allFinite()) fail("its inertia is not finite");
  if (i.mass < 0) fail(fmt::format("mass {} kg: at least 0 is needed", shortest(i.mass)));
  if (i.mass == 0) {
    if (!i.tensor.isZero(0)) fail("mass 0 with an inertia: a body has both or neither");
    return;
  }
  const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(i.tensor).eigenvalues();
  constexpr double kRounding = 1e-6;  // of numbers printed with few digits
  const double sum = moments[0] + moments[1];
  if (moments[0] < -kRounding * moments[2] || moments[2] > (1 + kRounding) * sum)
    fail(
        fmt::format("principal moments of inertia {:.6g}, {:.6g}, {:.6g} kg m^2: each at least 0 and at most the sum "
                    "of the two others is needed (triangle rule)",
                    moments[0], moments[1], moments[2]));
}

void check_joint(const SpatialRobot& robot, const SpatialBody& body) {
  const SpatialJoint& j = body.joint;
  const auto check = [&](const char* what, double value, bool from_zero) {
    if (!std::isfinite(value) || (from_zero && value < 0))
      throw InputError({robot.file}, fmt::format("joint {}: {} {}: {} is needed", quoted(j.name), what, shortest(value),
                                                 from_zero ? "at least 0" : "a finite number"));
  };
  check("damping", j.damping, true), check("friction", j.friction, true), check("armature", j.armature, true);
  check("stiffness", j.stiffness, true), check("rest", j.rest, false);
  for (const auto& limit : {j.lower, j.upper}) check("limit", limit.value_or(0), false);
  if (j.lower && j.upper && !(*j.lower <= *j.upper))
    throw InputError({robot.file}, fmt::format("joint {}: limits from {} to {}: lower <= upper is needed",
                                               quoted(j.name), shortest(*j.lower), shortest(*j.upper)));
  if (!body.in_parent.matrix().allFinite() || !j.anchor.allFinite())
    throw InputError({robot.file}, "joint " + quoted(j.name) + ": its origin is not finite");
  if (j.motion == SpatialJoint::Motion::kTurns && !(std::abs(j.axis.norm() - 1) < 1e-9))
    throw InputError({robot.file}, "joint " + quoted(j.name) + ": its axis has no direction");
}

}  // namespace

SpatialInertia in_frame(const SpatialInertia& i, const Eigen::Isometry3d& frame) {
  const Eigen::Matrix3d r = frame.linear();
  return {i.mass, frame * i.com, r * i.tensor * r.transpose()};
}

SpatialInertia merged(const SpatialInertia& a, const SpatialInertia& b) {
  SpatialInertia out;
  out.mass = a.mass + b.mass;
  if (out.mass == 0) return out;
  out.com = (a.mass * a.com + b.mass * b.com) / out.mass;
  for (const SpatialInertia* part : {&a, &b}) {
    const Eigen::Vector3d d = part->com - out.com;
    out.tensor += part->tensor + part->mass * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  }
  return out;
}

void SpatialRobot::validate() const {
  for (const SpatialBody& body : bodies) check_inertia(*this, body), check_joint(*this, body);
}

bool is_description(const std::string& path) {
  const std::string end = extension_of(path);
  return end == ".urdf" || end == ".xml" || end == ".mjcf" || end == ".xacro";
}

SpatialRobot read_description(const std::string& path) {
  if (extension_of(path) == ".xacro")
    throw InputError({path}, "a file of macros: URDF is needed, as `xacro FILE > robot.urdf` writes it");
  const std::string text = read_text_file(path, kLargestDescription, kLargestDescription + 1);
  if (text.size() > kLargestDescription)
    throw InputError({path}, fmt::format("a description of at most {} bytes is read", kLargestDescription));
  check_depth(path, text), check_body_count(path, text);
  const std::size_t urdf = text.find("<robot"), mjcf = text.find("<mujoco");
  if (urdf == std::string::npos && mjcf == std::string::npos)
    throw InputError({path}, "neither <robot> nor <mujoco>: a description in URDF or MJCF is needed");
  SpatialRobot out = urdf < mjcf ? read_urdf(path) : read_mjcf(path);
  out.file = path;
  out.validate();
  return out;
}

}  // namespace ukemi::tools
