#include "landing/body/robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/sea.hpp"
#include "landing/body/places.hpp"

namespace ukemi::landing {

const char* name(DriveKind kind) {
  switch (kind) {
    case DriveKind::kElastic:
      return "elastic";
    case DriveKind::kGeared:
      return "geared";
    case DriveKind::kPassive:
      return "passive";
    case DriveKind::kLocked:
      return "locked";
  }
  return "?";
}

double Robot::mass() const {
  double out = 0;
  for (const Link& l : links) out += l.mass;
  return out;
}

namespace {

void check(const std::string& what, const Place& p) {
  check_finite(what + ".along", p.along), check_finite(what + ".across", p.across);
}
void check(const std::string& what, const ContactLaw& law) {
  check_positive(what + ".stiffness", law.stiffness);
  check_not_negative(what + ".damping_normal", law.damping_normal);
  check_not_negative(what + ".stiffness_tangential", law.stiffness_tangential);
  check_not_negative(what + ".dissipation", law.dissipation);
  if (!(law.friction >= 0))
    throw InputError(fmt::format("{}.friction: {}: at least 0 is needed", what, shortest(law.friction)));
  if (std::isfinite(law.friction))
    check_positive(what + ".damping_tangential", law.damping_tangential);
  else
    check_not_negative(what + ".damping_tangential", law.damping_tangential);
  if (!(law.exponent >= 1 && law.exponent <= 10))
    throw InputError(fmt::format("{}.exponent: {}: from 1 to 10 is needed", what, shortest(law.exponent)));
}
void check(const Joint& j) {
  const std::string what = "joint " + quoted(j.name);
  if (j.driven()) {
    ukemi::validate(j.sea);
    if (j.sea.k_t != 0) throw InputError(what + ": k_t: the drives of such a robot follow Eq. 3");
    if (is_late(j.sea) && j.kind != DriveKind::kElastic)
      throw InputError(what + ": control_delay, velocity_filter: of an elastic drive alone");
  }
  for (const double x : {j.stiffness, j.damping, j.parallel_stiffness}) check_not_negative(what + ": spring", x);
  for (const double x : {j.rest, j.parallel_rest, j.phi}) check_finite(what + ": angle", x);
  if (j.speed_max) check_positive(what + ": speed_max", *j.speed_max);
  if (j.motor_torque_max) check_positive(what + ": motor_torque_max", *j.motor_torque_max);
}

}  // namespace

std::string stop_name(const Robot& robot, const Stop& stop) {
  return stop.joint < 0 ? "rail" : robot.joints.at(std::size_t(stop.joint)).name;
}

bool fits_late_kernel(const Robot& robot) {
  return int(robot.links.size()) <= kMaxLateLinks && int(robot.joints.size()) <= kMaxLateJoints &&
         contacts_and_stop_ends(robot) <= kMaxLateContacts;
}
bool has_late_drive(const Robot& robot) {
  return std::any_of(robot.joints.begin(), robot.joints.end(),
                     [](const Joint& j) { return j.kind == DriveKind::kElastic && is_late(j.sea); });
}

std::optional<std::size_t> sole_driven_joint(const Robot& robot) {
  std::optional<std::size_t> out;
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].driven()) {
      if (out) return std::nullopt;
      out = i;
    }
  return out;
}

int contacts_and_stop_ends(const Robot& robot) {
  int out = int(robot.contacts.size());
  for_each_stop_end(robot, [&](auto&, int) { ++out; });
  return out;
}

void Robot::validate() const {
  check_count("links", long(links.size()), 1, kMaxLinks);
  check_count("joints", long(joints.size()), long(links.size()) - 1, long(links.size()) - (base != Base::kPinned));
  check_count("contacts", long(contacts.size()), 0, kMaxContacts);
  check_count("contacts and ends of stops", contacts_and_stop_ends(*this), 0, kMaxContacts);
  check_not_negative("gravity", gravity), check_not_negative("rail_viscous", rail_viscous);
  check_not_negative("rail_friction", rail_friction), check_not_negative("rail_load_friction", rail_load_friction);
  if (rail_load_friction > 1) throw InputError("rail_load_friction: at most 1 is needed");
  check_finite("rail_direction", rail_direction), check_finite("pin_height", pin_height);
  const auto link_index = [&](const std::string& what, int i) { check_count(what, i, 0, long(links.size()) - 1); };
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Link& l = links[i];
    const std::string what = "link " + quoted(l.name);
    if (i == 0 ? l.parent != -1 : l.parent < 0 || l.parent >= int(i))
      throw InputError(what + ": its parent is not an earlier link");
    check_positive(what + ": mass", l.mass), check_positive(what + ": inertia_com", l.inertia_com);
    check(what + ": at", l.at), check(what + ": com", l.com);
    if (i > 0 && !joint_of(int(i))) throw InputError(what + ": it has no joint");
  }
  int previous = -1;
  for (const Joint& j : joints) {
    link_index("joint " + quoted(j.name) + ": child", j.child);
    if (j.child <= previous) throw InputError("joint " + quoted(j.name) + ": joints stand in the order of their links");
    previous = j.child;
    check(j);
  }
  for (const ContactPoint& c : contacts) {
    const std::string what = "contact " + quoted(c.name);
    link_index(what + ": link", c.link), check(what + ": at", c.at), check(what, c.law);
    if (!c.pad) continue;
    check_positive(what + ": pad.thickness", c.pad->thickness);
    check_positive(what + ": pad.stiffness", c.pad->stiffness);
    check_not_negative(what + ": pad.damping", c.pad->damping);
  }
  for (const PushPoint& p : pushes) {
    const std::string what = "push " + quoted(p.name);
    link_index(what + ": link", p.link), check(what + ": at", p.at);
  }
  for (const Stop& s : stops) {
    const std::string what = "stop " + quoted(stop_name(*this, s));
    if (s.joint < 0 && base != Base::kRail) throw InputError(what + ": base = \"rail\" is needed with it");
    if (s.joint >= 0 && joints.at(std::size_t(s.joint)).kind == DriveKind::kLocked)
      throw InputError(what + ": the joint is locked: it never gets there");
    if (!(s.ends[0] < s.ends[1])) throw InputError(what + ": two ends are needed, the lower first");
    check_positive(what + ": stiffness", s.stiffness), check_not_negative(what + ": damping", s.damping);
  }
  link_index("peak_link", peak_link), check("peak", peak);
  if (has_late_drive(*this) && !fits_late_kernel(*this))
    throw InputError(
        fmt::format("control_delay, velocity_filter: with a drive that is late a robot has at most {} links, {} "
                    "joints, {} contacts and ends of stops",
                    kMaxLateLinks, kMaxLateJoints, kMaxLateContacts));
}

namespace {

double distance(const Place& a, const Place& b) { return std::hypot(a.along - b.along, a.across - b.across); }

/// Appends warnings about one link: bounds that no material exceeds.
void check_link(const Robot& robot, int i, std::vector<std::string>& out) {
  const Link& l = robot.links[std::size_t(i)];
  const double length = extent(robot, i);
  constexpr double kMinLength = 0.02;   // shorter links are bodies of unknown size [m]
  constexpr double kSteel = 8000;       // a cube of steel of that side [kg/m^3]
  constexpr double kThread = 0.01;      // a carbon tube of 3 mm [kg/m]
  constexpr double kBeside = 0.25;      // allowed distance of a centre of mass beyond the places, in lengths
  constexpr double kNarrow = 1.0 / 10;  // of a rod's inertia m L^2 / 12
  if (length < kMinLength) return;
  const auto add = [&](const std::string& what) { out.push_back("link " + quoted(l.name) + ": " + what); };
  if (l.mass > kSteel * length * length * length)
    add(fmt::format("{:.4g} kg in {:.3g} m: a cube of steel of that side weighs {:.3g} kg", l.mass, length,
                    kSteel * length * length * length));
  if (l.mass < kThread * length)
    add(fmt::format("{:.4g} kg in {:.3g} m: a carbon tube of 3 mm weighs {:.2g} kg", l.mass, length, kThread * length));
  double far = 0;
  for (const Place& p : places(robot, i)) far = std::max(far, distance(p, l.com));
  if (far > (1 + kBeside) * length)
    add(fmt::format("its centre of mass lies {:.3g} m from one of its ends, the link is {:.3g} m long", far, length));
  // Half the mass at each end gives the largest inertia of a rod; a body as wide as long has a third more.
  const double upper = 1.35 * l.mass * length * length / 4, rod = l.mass * length * length / 12;
  if (l.inertia_com > upper)
    add(fmt::format("inertia_com {:.4g} kg m^2: all its mass at both ends gives {:.3g}", l.inertia_com, upper));
  if (l.inertia_com < kNarrow * rod)
    add(fmt::format("inertia_com {:.4g} kg m^2: a rod of its length and mass has {:.3g}; all of it is about one place",
                    l.inertia_com, rod));
}

/// Upper bound of the distance of a place of link i from the first link's origin [m].
double max_distance(const Robot& robot, int i, const Place& p) {
  double out = std::hypot(p.along, p.across);
  for (; robot.links[std::size_t(i)].parent >= 0; i = robot.links[std::size_t(i)].parent)
    out += std::hypot(robot.links[std::size_t(i)].at.along, robot.links[std::size_t(i)].at.across);
  return out;
}

}  // namespace

std::vector<Place> places(const Robot& robot, int link) {
  std::vector<Place> out;
  const auto add = [&](const Place& p) {
    if (std::none_of(out.begin(), out.end(), [&](const Place& q) { return distance(p, q) == 0; })) out.push_back(p);
  };
  add({});
  for (const Link& l : robot.links)
    if (l.parent == link) add(l.at);
  for (const ContactPoint& c : robot.contacts)
    if (c.link == link) add(c.at);
  if (robot.peak_link == link) add(robot.peak);
  return out;
}

double extent(const Robot& robot, int link) {
  const std::vector<Place> all = places(robot, link);
  double out = 0;
  for (const Place& a : all)
    for (const Place& b : all) out = std::max(out, distance(a, b));
  return out;
}

double reach(const Robot& robot) {
  double out = max_distance(robot, robot.peak_link, robot.peak);
  for (int i = 0; i < int(robot.links.size()); ++i) out = std::max(out, max_distance(robot, i, {}));
  for (const ContactPoint& c : robot.contacts) out = std::max(out, max_distance(robot, c.link, c.at));
  return out;
}

std::vector<std::string> doubts(const Robot& robot) {
  std::vector<std::string> out;
  for (int i = 0; i < int(robot.links.size()); ++i) check_link(robot, i, out);
  std::set<std::tuple<int, double, double>> known;
  for (const ContactPoint& c : robot.contacts) {
    const std::string what = "contact " + quoted(c.name) + ": ";
    const double thickness = c.pad ? c.pad->thickness : 0;
    if (const double far = max_distance(robot, c.link, c.at);
        robot.base == Base::kPinned && far + thickness < robot.pin_height)
      out.push_back(fmt::format("{}it never touches: it reaches {:.3g} m from a pin {:.3g} m above the floor", what,
                                far, robot.pin_height));
    if (!known.insert({c.link, c.at.along, c.at.across}).second)
      out.push_back(what + "another contact has its place: both push");
  }
  if (robot.contacts.empty()) out.push_back("no contact: it never touches the floor");
  return out;
}

}  // namespace ukemi::landing
