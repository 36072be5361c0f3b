#include "landing/body/load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "common/checks.hpp"
#include "common/csv.hpp"

namespace ukemi::landing {

namespace {

using Kind = Load::Kind;
enum class Part { kLink, kJoint, kContact };
struct KindInfo {
  const char *name, *unit;
  Part part;
};
constexpr std::array<KindInfo, 10> kKinds = {{{"acceleration", "m/s^2", Part::kLink},
                                              {"torque", "Nm", Part::kJoint},
                                              {"deflection", "rad", Part::kJoint},
                                              {"motor_speed", "rad/s", Part::kJoint},
                                              {"motor_torque", "Nm", Part::kJoint},
                                              {"angle", "rad", Part::kJoint},
                                              {"force", "N", Part::kContact},
                                              {"impulse", "N s", Part::kContact},
                                              {"touch", "1", Part::kContact},
                                              {"reference_rate", "rad/s", Part::kJoint}}};
const KindInfo& info(Kind kind) { return kKinds[std::size_t(kind)]; }

/// Why a joint cannot have a load of this kind; empty if it can.
std::string fault(Kind kind, const Joint& j) {
  if (j.kind == DriveKind::kLocked) return "the joint is locked: it bears what is not computed";
  if (kind == Kind::kDeflection && j.kind != DriveKind::kElastic) return "a joint with an elastic drive is needed";
  if ((kind == Kind::kMotorSpeed || kind == Kind::kMotorTorque || kind == Kind::kReferenceRate) && !j.driven())
    return "a joint that is driven is needed";
  return "";
}

template <class Items>
int index_of(TomlSection& s, const char* key, const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  const std::string text = s.text(key);
  const auto at = std::find(names.begin(), names.end(), text);
  if (at == names.end()) s.fail(key, names.empty() ? "the robot has none" : one_of(text, names));
  return int(at - names.begin());
}

void read_place(TomlSection& s, const Robot& robot, const std::vector<Load>& stops, Load& out) {
  const Part part = info(out.kind).part;
  for (const auto& [key, where] :
       {std::pair("link", Part::kLink), {"at", Part::kLink}, {"joint", Part::kJoint}, {"contact", Part::kContact}})
    if (part != where && s.has(key)) s.fail(key, fmt::format("a load of the kind {} has none", name(out.kind)));
  if (part == Part::kContact) {
    out.index = index_of(s, "contact", robot.contacts);
  } else if (part == Part::kLink) {
    out.index = index_of(s, "link", robot.links);
    if (const auto at = s.optional_numbers("at", 2, Range::any()))
      out.at = {(*at)[0], (*at)[1]};
    else
      out.at = robot.links[std::size_t(out.index)].com;
  } else {
    out.index = index_of(s, "joint", robot.joints);
    if (const std::string why = fault(out.kind, robot.joints[std::size_t(out.index)]); !why.empty())
      s.fail("joint", why);
  }
  if (out.kind != Kind::kAngle) {
    if (s.has("phi_deg")) s.fail("phi_deg", "of a load of the kind angle alone");
    return;
  }
  const auto phi = s.optional_angle_pair("phi");
  const auto stop = std::find_if(stops.begin(), stops.end(), [&](const Load& l) { return l.index == out.index; });
  if (!phi && stop == stops.end()) s.fail("phi_deg", "[low, high] is needed where the joint has no stops in [joint]");
  out.phi = phi ? *phi : stop->phi;
  if (!(out.phi[0] < out.phi[1])) s.fail("phi_deg", "the range is empty: [low, high] with low < high is needed");
}

/// Whether loads of this kind can only be limits: their values are not minimised.
bool is_limit_only(Kind k) { return k == Kind::kTouch || k == Kind::kReferenceRate; }

}  // namespace

const char* name(Kind kind) { return info(kind).name; }
const char* unit(Kind kind) { return info(kind).unit; }
std::string words(Kind kind) {
  std::string out = name(kind);
  std::replace(out.begin(), out.end(), '_', ' ');
  return out;
}

std::string place_of(const Load& l, const Robot& robot) {
  const auto k = std::size_t(l.index);
  switch (info(l.kind).part) {
    case Part::kLink:
      return fmt::format("{} [{:.4g}, {:.4g}]", robot.links[k].name, l.at.along, l.at.across);
    case Part::kJoint:
      return robot.joints[k].name;
    case Part::kContact:
      return robot.contacts[k].name;
  }
  return "";
}

std::vector<Load> read_loads(TomlFile& file, const Robot& robot, const std::vector<Load>& stops) {
  std::vector<Load> out = stops;
  std::vector<std::string> kinds;
  for (const KindInfo& k : kKinds) kinds.push_back(k.name);
  for (TomlSection& s : file.sections("load")) {
    Load l;
    l.name = s.text("name");
    if (l.name.empty()) s.fail("name", "a name is needed");
    if (l.name == "peak") s.fail("name", "'peak' names the scene's own peak: another name is needed");
    for (const Load& other : out)
      if (other.name == l.name) s.fail("name", ukemi::quoted(l.name) + ": the name is given twice");
    const std::string kind = s.text("kind");
    const auto at = std::find(kinds.begin(), kinds.end(), kind);
    if (at == kinds.end()) s.fail("kind", one_of(kind, kinds));
    l.kind = Kind(at - kinds.begin());
    read_place(s, robot, stops, l);
    const bool touch = l.kind == Kind::kTouch, limit_only = is_limit_only(l.kind);
    l.limit = s.optional_flag("limit").value_or(limit_only);
    if (limit_only && !l.limit)
      s.fail("limit", fmt::format("a {} is no amount that a plan makes small: true is needed", words(l.kind)));
    const Range range = l.limit ? Range::non_negative() : Range::positive();
    l.rating = touch ? s.optional_number("rating", range).value_or(0) : s.number("rating", range);
    if (touch && l.rating != 0) s.fail("rating", "of a touch, 1 where the contact touches: 0 is needed, or no rating");
    out.push_back(l);
  }
  std::rotate(out.begin(), out.begin() + long(stops.size()), out.end());
  return out;
}

Load limit(const Robot& robot, Kind kind, std::size_t index, double rating, const std::array<double, 2>& phi) {
  Load out{.kind = kind, .index = int(index), .phi = phi, .rating = rating, .limit = true};
  out.name = place_of(out, robot) + "." + name(kind);
  return out;
}
void set_limit(BodyScene& scene, const Load& limit) {
  const auto found =
      std::find_if(scene.loads.begin(), scene.loads.end(), [&](const Load& l) { return l.name == limit.name; });
  if (found == scene.loads.end())
    scene.loads.push_back(limit);
  else
    *found = limit;
}

void check(const Load& l, const Robot& robot) {
  const std::string what = "load " + ukemi::quoted(l.name) + ": ";
  const Part part = info(l.kind).part;
  const std::size_t count = part == Part::kLink    ? robot.links.size()
                            : part == Part::kJoint ? robot.joints.size()
                                                   : robot.contacts.size();
  if (l.index < 0 || std::size_t(l.index) >= count) throw InputError(what + "it acts on nothing that the robot has");
  if (part == Part::kJoint)
    if (const std::string why = fault(l.kind, robot.joints[std::size_t(l.index)]); !why.empty())
      throw InputError(what + why);
  if (l.limit)
    check_not_negative("load.rating", l.rating);
  else
    check_positive("load.rating", l.rating);
  if (l.kind == Kind::kAngle && !(l.phi[0] < l.phi[1])) throw InputError(what + "the range is empty");
}

double torque_limit(const Joint& joint, double rating) {
  const bool clamped = joint.kind == DriveKind::kGeared && joint.sea.tau_max <= rating;
  return clamped ? std::numeric_limits<double>::infinity() : rating_limit(rating);
}
double rating_limit(const Load& load, const Robot& robot) {
  return load.kind == Kind::kMotorTorque ? torque_limit(robot.joints[std::size_t(load.index)], load.rating)
                                         : rating_limit(load.rating);
}

bool observed(const BodyScene& scene) {
  return std::any_of(scene.loads.begin(), scene.loads.end(),
                     [&](const Load& l) { return l.limit || !is_peak_acceleration(l, scene.robot); });
}
bool rated(const BodyScene& scene) {
  return std::any_of(scene.loads.begin(), scene.loads.end(), [](const Load& l) { return !l.limit; });
}
double peak_rating(const BodyScene& scene) {
  if (!rated(scene)) return 1;
  double out = std::numeric_limits<double>::infinity();
  for (const Load& l : scene.loads)
    if (!l.limit && is_peak_acceleration(l, scene.robot)) out = std::min(out, l.rating);
  return out;
}
std::vector<LoadPeak> loads_of(const BodyScene& scene, const BodyLanding& landing) {
  if (!landing.loads.empty()) return landing.loads;
  return std::vector<LoadPeak>(scene.loads.size(), {landing.peak, landing.t_peak});
}

namespace {
/// Index of the load that gives the worth, and its value / rating; -1 without loads to minimise.
std::pair<int, double> largest_load(const BodyScene& scene, const std::vector<LoadPeak>& loads) {
  std::pair<int, double> out{-1, -1};
  for (std::size_t i = 0; i < scene.loads.size(); ++i)
    if (const Load& l = scene.loads[i]; !l.limit && loads[i].value / l.rating > out.second)
      out = {int(i), loads[i].value / l.rating};
  return out;
}
}  // namespace

int binding(const BodyScene& scene, const BodyLanding& landing) {
  return largest_load(scene, loads_of(scene, landing)).first;
}
double worth(const BodyScene& scene, double peak, const std::vector<LoadPeak>& loads) {
  const auto [load, ratio] = largest_load(scene, loads);
  return load < 0 ? peak : ratio;
}
double worth(const BodyScene& scene, const BodyLanding& landing) {
  return worth(scene, landing.peak, loads_of(scene, landing));
}

}  // namespace ukemi::landing
