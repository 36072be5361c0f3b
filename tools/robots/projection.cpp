#include "tools/robots/projection.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/actuator.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"
#include "landing/body/robot_file.hpp"

namespace ukemi::tools {

using landing::Base;
using landing::Place;

namespace {

constexpr double kParallel = 1e-3;   ///< largest angle between an axis and the normal that counts as parallel [rad]
constexpr double kRounding = 1e-12;  ///< of a coordinate [m]

struct Plane {
  Eigen::Vector3d normal, forward, up;
  std::string description;

  explicit Plane(const std::string& name) {
    const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    if (name != "x" && name != "y" && name != "z")
      throw InputError("--normal: " + quoted(name) +
                       ": x, y or z is needed, the axis of the root's frame across the plane");
    const int n = name[0] - 'x', f = n == 0 ? 1 : 0, u = n == 2 ? 1 : 2;
    normal = axes.col(n), forward = axes.col(f), up = axes.col(u);
    description = fmt::format("forward is {}, up is {}; angles count from {} to {}", "xyz"[f], "xyz"[u],
                              std::string("-") + "xyz"[u], "xyz"[f]);
  }
  /// Axis of positive angles.
  Eigen::Vector3d positive_axis() const { return forward.cross(up); }
  Place place(const Eigen::Vector3d& d) const {
    const auto clean = [](double x) { return std::abs(x) < kRounding ? 0.0 : x; };
    return {clean(-d.dot(up)), clean(d.dot(forward))};
  }
};

/// The name reduced to letters, digits and _, made unique among `known`.
std::string plain_name(const std::string& name, std::set<std::string>& known) {
  std::string out;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    out += plain ? c : '_';
  }
  if (out.empty()) out = "_";
  for (int i = 2; !known.insert(out).second; ++i) {
    const std::size_t cut = out.rfind("__");
    out = (i > 2 && cut != std::string::npos ? out.substr(0, cut) : out) + fmt::format("__{}", i);
  }
  return out;
}

/// A future link: the bodies that move as one.
struct Part {
  std::vector<int> bodies;
  int parent = -1;  ///< part
  SpatialInertia inertia;
  Eigen::Vector3d origin;  ///< in the root's frame
};

class Projector {
 public:
  Projector(const SpatialRobot& robot, const ProjectionOptions& options)
      : robot_(robot), options_(options), plane_(options.normal) {}

  Projection run() {
    note("plane", "normal " + options_.normal, plane_.description);
    place_bodies(), select_joints(), find_base(), make_parts(), weigh_parts();
    add_links(), add_contacts(), set_base();
    report_offsets(), set_gravity();
    note("left out", "", fmt::format("{}", fmt::join(robot_.left_out, ", ")));
    out_.robot.validate();
    return std::move(out_);
  }

 private:
  using Motion = SpatialJoint::Motion;

  [[noreturn]] void fail(const std::string& text) const { throw InputError({robot_.file}, text); }
  void note(const std::string& what, const std::string& name, const std::string& text) {
    out_.notes.push_back({what, name, text});
  }
  const SpatialBody& body(int i) const { return robot_.bodies[std::size_t(i)]; }
  int count() const { return int(robot_.bodies.size()); }
  static std::string vector_words(const Eigen::Vector3d& v) {
    const auto clean = [](double x) { return std::abs(x) < 5e-5 ? 0.0 : x; };
    return fmt::format("[{:.4g}, {:.4g}, {:.4g}]", clean(v[0]), clean(v[1]), clean(v[2]));
  }

  void place_bodies() {
    for (int i = 0; i < count(); ++i)
      pose_.push_back(i == 0 ? body(0).in_parent : pose_[std::size_t(body(i).parent)] * body(i).in_parent);
  }
  Eigen::Vector3d axis(int i) const { return pose_[std::size_t(i)].linear() * body(i).joint.axis; }
  Eigen::Vector3d anchor(int i) const { return pose_[std::size_t(i)] * body(i).joint.anchor; }
  /// Angle between the axis of a joint and the normal [rad].
  double off_normal(int i) const {
    return std::atan2(axis(i).cross(plane_.normal).norm(), std::abs(axis(i).dot(plane_.normal)));
  }
  bool about_normal(int i) const { return body(i).joint.motion == Motion::kTurns && off_normal(i) < kParallel; }

  /// Sets which joints are kept: those about the normal that --lock does not name.
  void select_joints() {
    std::vector<std::string> turning;
    for (int i = 1; i < count(); ++i)
      if (about_normal(i)) turning.push_back(body(i).joint.name);
    for (const std::string& name : options_.locked)
      if (std::find(turning.begin(), turning.end(), name) == turning.end())
        fail("--lock: " +
             (turning.empty() ? quoted(name) + ": no joint turns about the normal" : one_of(name, turning)));
    kept_.assign(std::size_t(count()), false);
    for (int i = 1; i < count(); ++i) {
      const SpatialJoint& j = body(i).joint;
      kept_[std::size_t(i)] = about_normal(i) && !named(options_.locked, j.name);
      if (kept_[std::size_t(i)] && !j.follows.empty())
        fail(fmt::format("joint {}: it follows {} (mimic): a joint of its own is needed, or --lock {} to hold it at 0",
                         quoted(j.name), quoted(j.follows), j.name));
    }
  }
  static bool named(const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  }
  std::vector<int> children(int i) const {
    std::vector<int> out;
    for (int k = i + 1; k < count(); ++k)
      if (body(k).parent == i) out.push_back(k);
    return out;
  }

  /// The base: the first body with mass, or with more than one child. What joins it to a massless root, such as a
  /// world, is no joint of the robot but the motion of the base, which --base overrides.
  void find_base() {
    for (std::vector<int> next; body(base_).inertia.mass == 0; base_ = next[0]) {
      next = children(base_);
      const auto floats = [&](int i) { return body(i).joint.motion == Motion::kFloats; };
      const auto floating = std::count_if(next.begin(), next.end(), floats);
      if (next.size() > 1 && floating > 0)
        fail(fmt::format("{} bodies hang on {}, which has no mass, {} of them floating: one robot is needed",
                         next.size(), quoted(body(base_).name), floating));
      if (next.size() != 1) break;
      const int c = next[0];
      const SpatialJoint& j = body(c).joint;
      warn_of_base(c);
      pin_ = kept_[std::size_t(c)] ? c : -1;
      if (j.motion != Motion::kFixed) rigid_.clear();
      if (j.motion == Motion::kFixed) rigid_.push_back(base_);
      if (j.motion == Motion::kFixed)
        note("base", body(c).name, fmt::format("fixed on {}, which has no mass", body(base_).name));
      else if (pin_ < 0 || base() != Base::kPinned)
        note("base", body(c).name,
             fmt::format("joint {} ({}) on {}, which has no mass, is the base's: --base says how it moves{}", j.name,
                         j.type, body(base_).name, travel_words(j)));
      kept_[std::size_t(c)] = false;
    }
    if (base() != Base::kPinned) pin_ = -1;
  }

  /// What becomes of the limits of a joint that slides.
  static std::string travel_words(const SpatialJoint& j) {
    if (!j.travel) return "";
    return fmt::format("; its limits, {:.4g} to {:.4g} m, are left out: of a robot on a rail [stop.rail] has them",
                       (*j.travel)[0], (*j.travel)[1]);
  }
  /// Warns unless the base is free: a fixed joint on a massless body other than "world" often just names a frame.
  void warn_of_base(int child) {
    const SpatialJoint& j = body(child).joint;
    const std::string& on = body(base_).name;
    if (options_.base || j.motion == Motion::kFloats || (j.motion == Motion::kFixed && on != "world")) return;
    out_.warnings.push_back(
        fmt::format("{} holds the base {} on {}: here it falls freely; --base rail, pinned or free "
                    "says how it moves",
                    j.name.empty() ? "a joint" : "joint " + quoted(j.name) + " (" + j.type + ")",
                    quoted(body(child).name), quoted(on)));
  }
  Base base() const { return options_.base.value_or(Base::kFree); }

  void make_parts() {
    part_.assign(std::size_t(count()), -1);
    for (const int i : rigid_) part_[std::size_t(i)] = 0;
    for (int i = base_; i < count(); ++i) {
      const int parent = i == base_ ? -1 : body(i).parent;
      if (i != base_ && (parent < 0 || part_[std::size_t(parent)] < 0)) continue;
      const int parent_part = parent < 0 ? -1 : part_[std::size_t(parent)];
      if (i == base_ || kept_[std::size_t(i)]) {
        parts_.push_back({{}, parent_part, {}, Eigen::Vector3d::Zero()});
        part_[std::size_t(i)] = int(parts_.size()) - 1;
      } else {
        part_[std::size_t(i)] = parent_part;
        report_joined(i);
      }
      parts_[std::size_t(part_[std::size_t(i)])].bodies.push_back(i);
    }
    if (parts_.size() == 1 && pin_ < 0) fail_no_joint();
    if (int(parts_.size()) <= landing::kMaxLinks) return;
    std::vector<std::string> names;
    for (std::size_t p = 1; p < parts_.size(); ++p) names.push_back(body(parts_[p].bodies[0]).joint.name);
    fail(
        fmt::format("{} links and {} joints in this plane: at most {} and {} are possible; --lock JOINT,... holds some "
                    "of {} at 0",
                    parts_.size(), names.size(), landing::kMaxLinks, landing::kMaxLinks - 1, fmt::join(names, ", ")));
  }
  [[noreturn]] void fail_no_joint() const {
    std::string all;
    for (int i = 1; i < count(); ++i)
      if (body(i).joint.motion == Motion::kTurns && i != base_)
        all += fmt::format("{}{} {}", all.empty() ? "" : ", ", body(i).joint.name, vector_words(axis(i)));
    fail(fmt::format("--normal {}: no joint that stays turns about it; {}", options_.normal,
                     all.empty() ? "no joint turns at all" : "axes of the joints: " + all));
  }
  /// Notes a body that is merged with its parent, and why.
  void report_joined(int i) {
    const SpatialBody& b = body(i);
    const std::string mass = fmt::format("{:.4g} kg", b.inertia.mass), on = body(b.parent).name;
    if (b.joint.motion == Motion::kFixed) {
      if (b.inertia.mass > 0) note("merged", b.name, fmt::format("fixed on {}: {}", on, mass));
      return;
    }
    std::string reason = "it does not turn about one axis";
    if (about_normal(i))
      reason = "--lock names it";
    else if (b.joint.motion == Motion::kTurns)
      reason = fmt::format("its axis {} is {:.3g} deg off the normal", vector_words(axis(i)), off_normal(i) * kDegrees);
    const bool outside = b.joint.lower.value_or(0) > 0 || b.joint.upper.value_or(0) < 0;
    note("locked", b.joint.name,
         fmt::format("{} at 0{}, {} on {}: {}; {}{}", b.joint.type, outside ? ", which is outside of its limits" : "",
                     b.name, on, reason, b.inertia.mass > 0 ? mass + " merged" : "no mass", travel_words(b.joint)));
  }

  /// Sets inertia and origin of each part; checks that both mass and inertia are positive.
  void weigh_parts() {
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      Part& part = parts_[p];
      for (const int i : part.bodies)
        part.inertia = merged(part.inertia, in_frame(body(i).inertia, pose_[std::size_t(i)]));
      const int first = part.bodies[0];
      const std::string what =
          p == 0 ? "the base " + quoted(body(first).name)
                 : fmt::format("link {} on joint {}", quoted(body(first).name), quoted(body(first).joint.name));
      if (!(part.inertia.mass > 0))
        fail(what + ": mass 0, with all that is fixed on it: a link that moves needs a mass above 0");
      if (!(inertia_of(part) > 0)) fail(what + ": no inertia about the normal: a link that moves needs one above 0");
      part.origin = p > 0 || pin_ >= 0 ? anchor(p > 0 ? first : pin_) : pose_[std::size_t(massive(part))].translation();
    }
  }
  double inertia_of(const Part& part) const { return plane_.normal.dot(part.inertia.tensor * plane_.normal); }
  int massive(const Part& part) const {
    return *std::find_if(part.bodies.begin(), part.bodies.end(), [&](int i) { return body(i).inertia.mass > 0; });
  }

  void add_links() {
    std::set<std::string> links, joints;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const Part& part = parts_[p];
      landing::Link link;
      link.name = renamed("link", body(massive(part)).name, links);
      link.parent = part.parent;
      if (part.parent >= 0) link.at = plane_.place(part.origin - parts_[std::size_t(part.parent)].origin);
      link.mass = part.inertia.mass, link.inertia_com = inertia_of(part);
      link.com = plane_.place(part.inertia.com - part.origin);
      out_.robot.links.push_back(link);
      if (p > 0 || pin_ >= 0) add_joint(p > 0 ? part.bodies[0] : pin_, int(p), joints);
    }
    out_.robot.peak = out_.robot.links[0].com;
    for (const landing::GivenDrive& g : options_.drives)
      if (!given_.count(g.joint)) {
        std::vector<std::string> names;
        for (const landing::Joint& j : out_.robot.joints) names.push_back(j.name);
        throw InputError("--actuator: " +
                         (g.joint.empty() ? quoted(g.file) + ": JOINT=FILE is needed" : one_of(g.joint, names)));
      }
  }
  std::string renamed(const char* what, const std::string& name, std::set<std::string>& known) {
    std::string out = plain_name(name, known);
    if (out != name) note("renamed", name, fmt::format("{} {}: letters, digits and _, once each", what, out));
    return out;
  }

  std::size_t joint_count() const { return parts_.size() - (pin_ >= 0 ? 0 : 1); }
  void add_joint(int i, int link, std::set<std::string>& known) {
    SpatialJoint j = body(i).joint;
    const bool same = axis(i).dot(plane_.positive_axis()) > 0;
    if (!same) {
      std::swap(j.lower, j.upper);
      for (auto* limit : {&j.lower, &j.upper})
        if (*limit) *limit = -**limit;
      j.rest = -j.rest;
    }
    landing::Joint out;
    out.name = renamed("joint", j.name, known), out.child = link;
    out.q_name = j.name, out.q_sign = same ? 1 : -1, out.q_zero = j.zero;
    std::string file;
    for (const landing::GivenDrive& g : options_.drives)
      if (g.joint == out.name || (g.joint.empty() && joint_count() == 1)) file = g.file, given_.insert(g.joint);
    if (file.empty()) {
      out.kind = landing::DriveKind::kPassive;
      out.stiffness = j.stiffness, out.damping = j.damping, out.rest = j.stiffness > 0 ? j.rest : 0;
      out.sea.friction = j.friction;
    } else {
      landing::set_elastic(read_actuator(file), out, {file});
    }
    const double off = off_normal(i);
    note("stays", out.name,
         fmt::format("{} about {}{}: phi = {}{}", j.type, axis(i).dot(plane_.normal) > 0 ? "+" : "-", options_.normal,
                     phi_words(same, j.zero),
                     off > 1e-9 ? fmt::format("; its axis is {:.2g} deg off", off * kDegrees) : ""));
    if (file.empty()) report_drive(j, out.name);
    out_.robot.joints.push_back(out), out_.joints.push_back(j), out_.drive_files.push_back(file);
  }
  static std::string phi_words(bool same, double zero) {
    if (zero == 0) return same ? "q" : "-q";
    const std::string degrees = fmt::format("{:.4g} deg", zero * kDegrees);
    return same ? "q - " + degrees : degrees + " - q";
  }
  /// Notes what the description knows of a drive, and what it lacks.
  void report_drive(const SpatialJoint& j, const std::string& name) {
    std::string comments;
    const auto add = [&](const std::string& text) { comments += (comments.empty() ? "" : ", ") + text; };
    if (j.lower && j.upper) add(fmt::format("limits {:.4g} to {:.4g} deg", *j.lower * kDegrees, *j.upper * kDegrees));
    if (j.effort) add(fmt::format("effort {:.4g} Nm", *j.effort));
    if (j.speed) add(fmt::format("speed {:.4g} rad/s", *j.speed));
    if (j.armature > 0) add(fmt::format("armature {:.4g} kg m^2", j.armature));
    if (j.lower.value_or(0) > 0 || j.upper.value_or(0) < 0)
      note("to fill in", "drive." + name, "phi_deg: at release it stands at 0, which is outside of its limits");
    note("to fill in", "drive." + name,
         fmt::format("{}: it swings freely, damping {:.4g} Nm/(rad/s){}{}; as comments in robot.toml: {}",
                     robot_.no_drive, j.damping, j.friction > 0 ? fmt::format(", friction {:.4g} Nm", j.friction) : "",
                     j.stiffness > 0 ? fmt::format(", stiffness {:.4g} Nm/rad", j.stiffness) : "",
                     comments.empty() ? "no more" : comments));
  }

  void add_contacts() {
    if (options_.contacts.size() > std::size_t(landing::kMaxContacts))
      fail(fmt::format("--contacts: {} names: at most {} are possible", options_.contacts.size(),
                       landing::kMaxContacts));
    std::vector<std::string> names;
    for (const SpatialPoint& p : robot_.points) names.push_back(p.name);
    std::set<std::string> known;
    for (const std::string& name : options_.contacts) {
      const auto p = std::find_if(robot_.points.begin(), robot_.points.end(),
                                  [&](const SpatialPoint& q) { return q.name == name; });
      if (p == robot_.points.end()) fail("--contacts: " + one_of(name, names));
      const int part = part_[std::size_t(p->body)];
      if (part < 0)
        fail(fmt::format("--contacts: {}: it is on {}, not on the robot", quoted(name), body(p->body).name));
      landing::ContactPoint c;
      c.name = renamed("contact", name, known), c.link = part, c.law.stiffness = 1;  // set by the floor
      c.at = plane_.place(pose_[std::size_t(p->body)] * p->at - parts_[std::size_t(part)].origin);
      out_.robot.contacts.push_back(c);
      note("contact", c.name,
           fmt::format("{} of {}", p->kind == "link" || p->kind == "body" ? "origin" : p->kind, body(p->body).name));
    }
  }

  void set_base() {
    landing::Robot& r = out_.robot;
    r.base = base();
    if (options_.pin_height && r.base != Base::kPinned)
      throw InputError("--pin-height: --base pinned is needed with it");
    if (r.base == Base::kPinned && !r.contacts.empty() && !options_.pin_height)
      throw InputError("--base pinned: with contacts --pin-height, of its origin above the floor, is needed");
    r.pin_height = options_.pin_height.value_or(0);
    if (r.base == Base::kPinned)
      note("base", r.links[0].name,
           pin_ >= 0 ? "pinned to the ground by joint " + r.joints[0].name
                     : "pinned at its origin, about which it swings freely");
    if (r.base == Base::kRail) note("base", r.links[0].name, "slides along an upright rail at its origin");
  }

  /// Notes dropped offsets along the normal: they have no moment about it.
  void report_offsets() {
    double largest = 0;
    std::string at;
    const Eigen::Vector3d origin = parts_[0].origin;
    const auto update = [&](const Eigen::Vector3d& point, const std::string& name) {
      if (const double off = std::abs((point - origin).dot(plane_.normal)); off > largest + kRounding)
        largest = off, at = name;
    };
    for (std::size_t p = 0; p < parts_.size(); ++p)
      update(parts_[p].origin, "the joint of " + out_.robot.links[p].name),
          update(parts_[p].inertia.com, "the centre of mass of " + out_.robot.links[p].name);
    if (largest > 1e-9)
      note("dropped", "offsets along " + options_.normal, fmt::format("up to {:.4g} m: {}", largest, at));
  }

  void set_gravity() {
    constexpr double kEarth = 9.81;
    const double g = robot_.gravity ? robot_.gravity->norm() : kEarth;
    out_.robot.gravity = g;
    if (!robot_.gravity)
      note("to fill in", "gravity", fmt::format("{} m/s^2: {} holds none", kEarth, robot_.format));
    else if (g > 0 && !robot_.gravity->isApprox(-g * plane_.up, 1e-9))
      note("gravity", "",
           fmt::format("{} of the file is not down in this plane: its size is taken, {:.4g} m/s^2",
                       vector_words(*robot_.gravity), g));
  }

  const SpatialRobot& robot_;
  const ProjectionOptions& options_;
  Plane plane_;
  Projection out_;
  std::vector<Eigen::Isometry3d> pose_;  ///< of each body in the root's frame, every joint at 0
  std::vector<bool> kept_;               ///< whether the joint of each body is kept
  std::vector<int> part_;                ///< part of each body; -1: none
  std::vector<Part> parts_;
  std::set<std::string> given_;  ///< joints with an actuator file of the command line
  int base_ = 0, pin_ = -1;      ///< body of the base; body whose joint pins the base, -1: none
  std::vector<int> rigid_;       ///< massless ancestors of the base that are fixed to it
};

}  // namespace

Projection project(const SpatialRobot& robot, const ProjectionOptions& options) {
  return Projector(robot, options).run();
}

}  // namespace ukemi::tools
