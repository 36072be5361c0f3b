#include "landing/body/robot_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>

#include "common/actuator.hpp"
#include "common/actuator_constants.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/sea.hpp"
#include "landing/body/by_links.hpp"
#include "landing/body/floor_constants.hpp"
#include "landing/body/places.hpp"

namespace ukemi::landing {

namespace {

using Indices = std::map<std::string, int>;

Place read_place(TomlSection& s, const std::string& key) {
  const auto v = s.optional_numbers(key, 2, Range::any());
  return v ? Place{(*v)[0], (*v)[1]} : Place{};
}

/// Reads a name that is unique among `known` and valid in keys and column names.
std::string unique_name(TomlSection& s, const Indices& known, const std::string& key = "name") {
  const std::string name = s.text(key);
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  if (name.empty() || !std::all_of(name.begin(), name.end(), plain))
    s.fail(key, ukemi::quoted(name) + ": letters, digits and _ are needed");
  if (known.count(name)) s.fail(key, ukemi::quoted(name) + ": the name is given twice");
  return name;
}

int read_index(TomlSection& s, const std::string& key, const Indices& known) {
  const std::string name = s.text(key);
  const auto it = known.find(name);
  std::vector<std::string> names;
  for (const auto& [n, i] : known) names.push_back(n);
  if (it == known.end()) s.fail(key, one_of(name, names));
  return it->second;
}

/// q = { name = "l-hip", sign = -1, zero_deg = 10 }
void read_angle_convention(TomlSection& link, Joint& joint) {
  auto s = link.optional_section("q");
  if (!s) return;
  joint.q_name = s->optional_text("name").value_or("");
  joint.q_zero = s->optional_angle("zero").value_or(0);
  joint.q_sign = s->optional_number("sign", Range{-1, 1, false, "1 or -1"}).value_or(1);
  if (std::abs(joint.q_sign) != 1) s->fail("sign", shortest(joint.q_sign) + ": 1 or -1 is needed");
}

/// Reads the links of a file, parents before children, and their joints.
struct LinkReader {
  Robot& out;
  std::vector<TomlSection> sections;
  Indices link_index{};               ///< links by name
  std::vector<TomlSection> joints{};  ///< table of each joint's child link

  void read(TomlSection& robot) {
    if (sections.empty()) robot.fail("link", "links [[robot.link]] are needed");
    if (int(sections.size()) > kMaxLinks)
      robot.fail("link", fmt::format("{} links: at most {} are needed", sections.size(), kMaxLinks));
    std::vector<std::string> parents;
    std::vector<std::size_t> pending = root_first(parents);
    Indices known;
    while (!pending.empty()) {
      const auto next = std::find_if(pending.begin(), pending.end(),
                                     [&](std::size_t i) { return parents[i].empty() || link_index.count(parents[i]); });
      if (next == pending.end())
        sections[pending[0]].fail(
            "parent", ukemi::quoted(parents[pending[0]]) + ": these links hang in a circle: a tree is needed");
      add(sections[*next], parents[*next], known);
      pending.erase(next);
    }
  }

 private:
  /// Indices of all sections, the root first; checks that there is one root and that every parent is a link.
  std::vector<std::size_t> root_first(std::vector<std::string>& parents) {
    Indices all;
    std::optional<std::size_t> root;
    for (std::size_t i = 0; i < sections.size(); ++i) {
      all[unique_name(sections[i], all)] = int(i);
      parents.push_back(sections[i].optional_text("parent").value_or(""));
    }
    for (std::size_t i = 0; i < sections.size(); ++i) {
      if (!parents[i].empty())
        (void)read_index(sections[i], "parent", all);
      else if (root)
        sections[i].fail("parent", ukemi::quoted(sections[i].text("name")) + " has none, and " +
                                       ukemi::quoted(sections[*root].text("name")) +
                                       " neither: one link without a parent is needed, the base");
      else
        root = i;
    }
    if (!root) sections[0].fail("parent", "every link has a parent: one without is needed, the base");
    std::vector<std::size_t> pending{*root};
    for (std::size_t i = 0; i < sections.size(); ++i)
      if (i != *root) pending.push_back(i);
    return pending;
  }
  void add(TomlSection& s, const std::string& parent, Indices& known) {
    const bool base = parent.empty();
    const int index = int(out.links.size());
    if (base && s.has("at")) s.fail("at", "the base has no joint: its origin is where it begins");
    out.links.push_back({s.text("name"), base ? -1 : link_index.at(parent), base ? Place{} : read_place(s, "at"),
                         s.number("mass", Range::positive()), s.number("inertia_com", Range::positive()),
                         read_place(s, "com")});
    link_index[out.links.back().name] = index;
    if (base && !s.has("joint")) return;
    if (base && out.base != Base::kPinned) s.fail("joint", "the base of a robot that is not pinned has no joint");
    Joint joint;
    joint.name = unique_name(s, known, "joint"), joint.child = index;
    read_angle_convention(s, joint);
    known[joint.name] = int(out.joints.size());
    out.joints.push_back(std::move(joint));
    joints.push_back(s);
  }
};

void read_contacts(TomlSection& robot, const Indices& links, const ContactLaw& floor, Robot& out) {
  std::vector<TomlSection> sections = robot.sections("contact");
  if (int(sections.size()) > kMaxContacts)
    robot.fail("contact", fmt::format("{} contacts: at most {} are needed", sections.size(), kMaxContacts));
  Indices known;
  for (TomlSection& s : sections) {
    ContactPoint c;
    c.name = unique_name(s, known);
    known[c.name] = int(out.contacts.size());
    c.link = read_index(s, "link", links), c.at = read_place(s, "at");
    c.law = read_law(s, floor);
    for (const LawConstant& constant : kLawConstants)
      if (s.has(constant.key)) c.own_keys.push_back(constant.key);
    if (auto pad = s.optional_section("pad"))
      c.pad = Pad{pad->number("thickness", Range::positive()), pad->number("stiffness", Range::positive()),
                  pad->optional_number("damping", Range::non_negative()).value_or(0)};
    out.contacts.push_back(std::move(c));
  }
}

void read_pushes(TomlSection& robot, const Indices& links, Robot& out) {
  Indices known;
  for (TomlSection& s : robot.sections("push")) {
    const std::string name = unique_name(s, known);
    known[name] = int(out.pushes.size());
    out.pushes.push_back({name, read_index(s, "link", links), read_place(s, "at")});
  }
}

/// Reads a geared drive: all friction is the motor's.
void read_geared(TomlSection& s, Joint& joint) {
  SeaParameters<double>& sea = joint.sea;
  sea.k_p = s.number("k_p", Range::non_negative()), sea.k_d = s.number("k_d", Range::non_negative());
  sea.i_motor = s.number("i_motor", Range::positive());
  if (const auto v = s.optional_number("tau_max", Range::non_negative())) sea.tau_max = *v;
  for (const ActuatorConstant& c : optional_constants())
    if (is_geared_constant(c.key) && c.key != std::string("tau_max"))
      sea.*c.at = s.optional_number(c.key, c.range).value_or(c.absent);
  joint.speed_max = s.optional_number("speed_max", Range::positive());
  joint.motor_torque_max = s.optional_number("motor_torque_max", Range::positive());
}

void read_drive(TomlSection& s, Joint& joint, const std::string& folder, std::vector<std::string>& files) {
  using enum DriveKind;
  const std::string kind = s.optional_choice("kind", {"elastic", "geared", "passive", "locked"}).value_or("elastic");
  joint.kind = kind == "elastic" ? kElastic : kind == "geared" ? kGeared : kind == "passive" ? kPassive : kLocked;
  if (joint.kind == kElastic) {
    const auto file = s.optional_text("file");
    Actuator a;
    if (file)
      files.push_back((std::filesystem::path(folder) / *file).string()), a = read_actuator(files.back());
    else
      read_constants(s, a);
    (void)s.optional_text("name");
    set_elastic(a, joint, s.where("file"));
  } else if (joint.kind == kGeared) {
    read_geared(s, joint);
  } else {
    joint.phi = s.optional_angle("phi").value_or(0);
  }
  if (joint.kind == kPassive) {
    joint.stiffness = s.optional_number("stiffness", Range::non_negative()).value_or(0);
    joint.damping = s.optional_number("damping", Range::non_negative()).value_or(0);
    joint.rest = s.optional_angle("rest").value_or(joint.phi);
    joint.sea.friction = s.optional_number("friction", Range::non_negative()).value_or(0);
  }
  if (joint.kind == kLocked) return;
  joint.parallel_stiffness = s.optional_number("parallel_stiffness", Range::non_negative()).value_or(0);
  joint.parallel_rest = s.optional_angle("parallel_rest").value_or(0);
}

void read_base(TomlSection& s, Robot& out) {
  const std::string base = s.optional_choice("base", {"free", "rail", "pinned"}).value_or("free");
  out.base = base == "free" ? Base::kFree : base == "rail" ? Base::kRail : Base::kPinned;
  if (auto rail = s.optional_section("rail")) {
    if (out.base != Base::kRail) s.fail("rail", "base = \"rail\" is needed with it");
    out.rail_direction = rail->optional_angle("direction").value_or(out.rail_direction);
    out.rail_viscous = rail->optional_number("viscous", Range::non_negative()).value_or(0);
    out.rail_friction = rail->optional_number("friction", Range::non_negative()).value_or(0);
    out.rail_load_friction = rail->optional_number("load_friction", Range{0, 1, false, "0 to 1"}).value_or(0);
  }
  if (const auto height = s.optional_number("pin_height", Range::any())) {
    if (out.base != Base::kPinned) s.fail("pin_height", "base = \"pinned\" is needed with it");
    out.pin_height = *height;
  } else if (out.base == Base::kPinned && s.has("contact")) {
    s.fail("base", "\"pinned\": with contacts its pin_height above the floor is needed");
  }
}

/// Reads [stop.JOINT] and [stop.rail].
void read_stops(TomlFile& file, Robot& out) {
  auto all = file.optional("stop");
  if (!all) return;
  for (int joint = -1; joint < int(out.joints.size()); ++joint) {
    Stop stop{.joint = joint};
    auto s = all->optional_section(stop_name(out, stop));
    if (!s) continue;
    const char* key = joint < 0 ? "s" : "phi";
    if (joint >= 0) {
      const auto ends = s->optional_angle_pair(key);
      if (!ends) s->fail(key, "phi_deg = [LOW, HIGH] is needed");
      stop.ends = *ends;
    } else {
      const auto ends = s->numbers(key, 2, Range::any());
      stop.ends = {ends[0], ends[1]};
    }
    if (!(stop.ends[0] < stop.ends[1])) {
      const bool degrees = s->has("phi_deg");
      const double unit = degrees ? kDegree : 1;
      s->fail(degrees ? "phi_deg" : key, fmt::format("[{}, {}]: two ends are needed, the lower first",
                                                     shortest(stop.ends[0] / unit), shortest(stop.ends[1] / unit)));
    }
    constexpr double kTurn = 2 * std::numbers::pi, kOutOfReach = 100;  // [m]
    for (double& end : stop.ends)
      if (std::abs(end) >= (joint < 0 ? kOutOfReach : kTurn * (1 - 1e-12)))
        end = std::copysign(std::numeric_limits<double>::infinity(), end);
    if (joint < 0 && out.base != Base::kRail) s->fail("", "base = \"rail\" is needed with it");
    if (joint >= 0 && out.joints[std::size_t(joint)].kind == DriveKind::kLocked)
      s->fail("", "the joint is locked: it never gets there");
    stop.stiffness = s->number("stiffness", Range::positive());
    stop.damping = s->optional_number("damping", Range::non_negative()).value_or(0);
    out.stops.push_back(stop);
  }
  if (const int count = contacts_and_stop_ends(out); count > kMaxContacts)
    all->fail("", fmt::format("{} contacts and ends of stops: at most {} are needed", count, kMaxContacts));
}

/// The drive given for a joint on the command line or null; `only`: drives without a joint name are for this joint.
const GivenDrive* given_for(const Joint& joint, bool only, const std::vector<GivenDrive>& given) {
  for (const GivenDrive& g : given)
    if (g.joint == joint.name || (g.joint.empty() && only)) return &g;
  return nullptr;
}

void read_drives(LinkReader& reader, TomlFile& file, TomlFile* scene, const std::vector<GivenDrive>& given,
                 std::vector<std::string>& files) {
  std::vector<Joint>& joints = reader.out.joints;
  const auto folder = [](const TomlFile& f) { return std::filesystem::path(f.path()).parent_path().string(); };
  std::optional<TomlSection> in_robot = file.optional("drive"),
                             in_scene = scene ? scene->optional("drive") : std::nullopt;
  std::vector<std::string> names;
  std::vector<bool> undriven;  // without a drive in the files
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Joint& joint = joints[i];
    names.push_back(joint.name);
    auto a = in_robot ? in_robot->optional_section(joint.name) : std::nullopt;
    auto b = in_scene ? in_scene->optional_section(joint.name) : std::nullopt;
    if (a && b)
      in_scene->fail(joint.name,
                     "the robot's file " + ukemi::quoted(file.path()) + " has this drive too: one is needed");
    if (a) read_drive(*a, joint, folder(file), files);
    if (b) read_drive(*b, joint, folder(*scene), files);
    undriven.push_back(!a && !b);
  }
  for (const GivenDrive& g : given)
    if (!g.joint.empty() && std::find(names.begin(), names.end(), g.joint) == names.end())
      throw InputError(g.option + ": " + one_of(g.joint, names));
  const auto undriven_count = std::count(undriven.begin(), undriven.end(), true);
  const auto driven = std::count_if(joints.begin(), joints.end(), [](auto& j) { return j.driven(); });
  for (const GivenDrive& g : given)
    if (g.joint.empty() && (undriven_count > 0 ? undriven_count != 1 : driven != 1))
      throw InputError(fmt::format("{}: {}: JOINT=FILE is needed, JOINT one of {}", g.option, ukemi::quoted(g.file),
                                   fmt::join(names, ", ")));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const bool only = undriven_count > 0 ? undriven_count == 1 && undriven[i] : driven == 1 && joints[i].driven();
    if (const GivenDrive* g = given_for(joints[i], only, given)) {
      if (!joints[i].driven())
        throw InputError(g->option + ": joint " + ukemi::quoted(joints[i].name) + " is " + name(joints[i].kind) +
                         ": a joint that is driven is needed");
      files.push_back(g->file), set_elastic(read_actuator(g->file), joints[i], {g->file});
    } else if (undriven[i]) {
      reader.joints[i].fail(
          "joint",
          fmt::format("{}: its drive is needed: a table [drive.{}], or {} {}=FILE", ukemi::quoted(joints[i].name),
                      joints[i].name, given.empty() ? GivenDrive().option : given[0].option, joints[i].name));
    }
  }
}

}  // namespace

bool is_geared_constant(const std::string& key) {
  constexpr std::array kKeys = {"k_p",
                                "k_d",
                                "i_motor",
                                "tau_max",
                                "friction",
                                "friction_asymmetry",
                                "viscous_friction",
                                "breakaway",
                                "stribeck_speed",
                                "spring_loss"};
  return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end();
}

void set_elastic(const Actuator& a, Joint& joint, const Location& where) {
  joint.kind = DriveKind::kElastic;
  joint.sea = a.sea, joint.speed_max = a.speed_max, joint.motor_torque_max = a.motor_torque_max;
  joint.uncertain = a.uncertain, joint.covariance = a.covariance;
  if (a.sea.k_t != 0) throw InputError(where, "k_t: a landing needs the gains of its controller, k_p and k_d (Eq. 3)");
}

ContactLaw read_law(TomlSection& s, const std::optional<ContactLaw>& floor) {
  ContactLaw law = floor.value_or(ContactLaw{});
  const auto set = [&](const char* key, double& to, const Range& range) {
    if (const auto v = s.optional_number(key, range)) to = *v;
    return s.has(key);
  };
  if (!floor) law.stiffness = s.number("stiffness", Range::positive());
  const bool own_stiffness = floor && set("stiffness", law.stiffness, Range::positive());
  if (const auto kind = s.optional_choice("law", {"linear", "hunt_crossley"})) law.hunt_crossley = *kind != "linear";
  if (law.hunt_crossley) {
    if (s.has("damping_normal"))
      s.fail("damping_normal", "with law = \"hunt_crossley\" it has no effect: dissipation is its damping");
    set("exponent", law.exponent, Range{1, 10, false, "from 1 to 10"});
    set("dissipation", law.dissipation, Range::non_negative());
    law.damping_normal = 0;
  } else if (!floor) {
    law.damping_normal = s.number("damping_normal", Range::non_negative());
  } else {
    set("damping_normal", law.damping_normal, Range::non_negative());
  }
  set("damping_tangential", law.damping_tangential, Range::non_negative());
  const bool has_friction = set("friction", law.friction, Range::non_negative()) || std::isfinite(law.friction);
  const bool given = set("stiffness_tangential", law.stiffness_tangential, Range::non_negative());
  if (!given && has_friction && (!floor || own_stiffness)) law.stiffness_tangential = law.stiffness;
  if (has_friction && !(law.damping_tangential > 0)) s.fail("damping_tangential", "with friction it must be above 0");
  return law;
}

namespace {

bool has_own_stiffness(const ContactPoint& c) {
  return std::find(c.own_keys.begin(), c.own_keys.end(), "stiffness") != c.own_keys.end();
}

}  // namespace

void require_contact_stiffness(const BodyScene& scene, const std::string& path) {
  for (const ContactPoint& c : scene.robot.contacts)
    if (!scene.floor && !has_own_stiffness(c))
      throw InputError(Location{path}, "contact " + c.name + " has no stiffness: its own, or [floor], is needed");
}

void enable_floor(const std::string& path, Contacts needed, BodyScene& scene) {
  const std::vector<ContactPoint>& contacts = scene.robot.contacts;
  if (needed == Contacts::kAllOrNone && std::none_of(contacts.begin(), contacts.end(), has_own_stiffness)) return;
  require_contact_stiffness(scene, path);
  scene.floor = true;
}

void read_robot_tables(TomlFile& file, TomlFile* scene, const ContactLaw& floor, const std::vector<GivenDrive>& drives,
                       BodyScene& out) {
  Robot& robot = out.robot;
  TomlSection s = file.require("robot");
  LinkReader links{robot, s.sections("link")};
  if (links.sections.empty() && s.has("link_length")) {
    const TwoLinkTable two = read_two_link(s);
    robot = by_links(two.robot, two.contacts, floor), links.joints = {s};
    out.drop_at = robot.links[0].com;
  } else {
    robot.gravity = s.number("gravity", Range::non_negative());
    read_base(s, robot);
    links.read(s);
    read_contacts(s, links.link_index, floor, robot);
    read_pushes(s, links.link_index, robot);
  }
  robot.peak = robot.links[0].com;
  if (auto peak = s.optional_section("peak"))
    robot.peak_link = read_index(*peak, "link", links.link_index), robot.peak = read_place(*peak, "at");
  read_drives(links, file, scene, drives, out.drive_files);
  read_stops(file, robot);
}

}  // namespace ukemi::landing
