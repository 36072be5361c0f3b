#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "common/actuator.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/toml.hpp"
#include "test/legs/leg_scene.hpp"

namespace ukemi::landing {

namespace {

Place place_in(TomlSection& s, const std::string& key) {
  const auto v = s.optional_numbers(key, 2, Range::any());
  return v ? Place{(*v)[0], (*v)[1]} : Place{};
}

/// A name that no earlier one of its kind has.
std::string new_name(TomlSection& s, const std::map<std::string, int>& known, const std::string& key = "name") {
  const std::string name = s.text(key);
  if (name.empty()) s.fail(key, "a name is needed");
  if (known.count(name)) s.fail(key, quoted(name) + ": the name is given twice");
  return name;
}

int index_in(TomlSection& s, const std::string& key, const std::map<std::string, int>& known) {
  const std::string name = s.text(key);
  const auto it = known.find(name);
  std::vector<std::string> names;
  for (const auto& [n, i] : known) names.push_back(n);
  if (it == known.end()) s.fail(key, one_of(name, names));
  return it->second;
}

/// The links, parents before their children, and their joints; by name their indices.
std::map<std::string, int> read_links(TomlSection& robot, Robot& out) {
  std::vector<TomlSection> sections = robot.sections("link");
  if (sections.empty()) robot.fail("link", "links [[robot.link]] are needed");
  if (int(sections.size()) > kMostLinks)
    robot.fail("link", fmt::format("{} links: at most {} are needed", sections.size(), kMostLinks));
  std::map<std::string, int> all;
  std::vector<std::string> parents;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    all[new_name(sections[i], all)] = int(i);
    parents.push_back(sections[i].optional_text("parent").value_or(""));
  }
  int root = -1;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    if (!parents[i].empty()) {
      (void)index_in(sections[i], "parent", all);
    } else if (root >= 0) {
      sections[i].fail("parent", "two links without a parent: one is needed, the base");
    } else {
      root = int(i);
    }
  }
  if (root < 0) sections[0].fail("parent", "every link has a parent: one without is needed, the base");
  std::map<std::string, int> placed, joints;
  std::vector<std::size_t> left{std::size_t(root)};
  for (std::size_t i = 0; i < sections.size(); ++i)
    if (int(i) != root) left.push_back(i);
  while (!left.empty()) {
    const auto next = std::find_if(left.begin(), left.end(),
                                   [&](std::size_t i) { return parents[i].empty() || placed.count(parents[i]); });
    if (next == left.end()) sections[left[0]].fail("parent", "these links hang in a circle: a tree is needed");
    TomlSection& s = sections[*next];
    const bool base = parents[*next].empty();
    Link link{s.text("name"),
              base ? -1 : placed.at(parents[*next]),
              base ? Place{} : place_in(s, "at"),
              s.number("mass", Range::positive()),
              s.number("inertia_com", Range::positive()),
              place_in(s, "com")};
    const int index = int(out.links.size());
    if (!base || s.has("joint")) {
      if (base && out.base != Base::kPinned) s.fail("joint", "the base of a robot that is not pinned has no joint");
      Joint joint;
      joint.name = new_name(s, joints, "joint"), joint.child = index;
      joints[joint.name] = int(out.joints.size());
      out.joints.push_back(joint);
    }
    placed[link.name] = index;
    out.links.push_back(std::move(link));
    left.erase(next);
  }
  return placed;
}

/// Constants of the floor's law, the same keys in [floor] and in a contact. `law` holds what stands where one is
/// omitted.
ContactLaw read_law(TomlSection& s, ContactLaw law) {
  const bool floor_wide = law.stiffness == 0;
  const auto set = [&](const char* key, double& to, const Range& range) {
    if (const auto v = s.optional_number(key, range)) to = *v;
    return s.has(key);
  };
  if (floor_wide) law.stiffness = s.number("stiffness", Range::positive());
  const bool own = !floor_wide && set("stiffness", law.stiffness, Range::positive());
  if (const auto kind = s.optional_choice("law", {"linear", "hunt_crossley"})) law.hunt_crossley = *kind != "linear";
  if (law.hunt_crossley) {
    if (s.has("damping_normal"))
      s.fail("damping_normal", "with law = \"hunt_crossley\" it has no say: dissipation is its damping");
    set("exponent", law.exponent, Range{1, 10, false, "from 1 to 10"});
    set("dissipation", law.dissipation, Range::non_negative());
    law.damping_normal = 0;
  } else if (floor_wide) {
    law.damping_normal = s.number("damping_normal", Range::non_negative());
  } else {
    set("damping_normal", law.damping_normal, Range::non_negative());
  }
  set("damping_tangential", law.damping_tangential, Range::non_negative());
  const bool rubs = set("friction", law.friction, Range::non_negative()) || std::isfinite(law.friction);
  const bool given = set("stiffness_tangential", law.stiffness_tangential, Range::non_negative());
  if (!given && rubs && (floor_wide || own)) law.stiffness_tangential = law.stiffness;
  if (rubs && !(law.damping_tangential > 0)) s.fail("damping_tangential", "with friction it must be above 0");
  return law;
}

void read_contacts(TomlSection& robot, const std::map<std::string, int>& links, const std::optional<ContactLaw>& floor,
                   Robot& out) {
  std::vector<TomlSection> sections = robot.sections("contact");
  if (int(sections.size()) > kMostContacts)
    robot.fail("contact", fmt::format("{} contacts: at most {} are needed", sections.size(), kMostContacts));
  std::map<std::string, int> known;
  for (TomlSection& s : sections) {
    ContactPoint c;
    c.name = new_name(s, known);
    known[c.name] = int(out.contacts.size());
    c.link = index_in(s, "link", links), c.at = place_in(s, "at");
    c.law = read_law(s, floor.value_or(ContactLaw{.stiffness = 1}));
    if (auto pad = s.optional_section("pad"))
      c.pad = Pad{pad->number("thickness", Range::positive()), pad->number("stiffness", Range::positive()),
                  pad->optional_number("damping", Range::non_negative()).value_or(0)};
    out.contacts.push_back(std::move(c));
  }
}

void read_drive(TomlSection& s, Joint& joint) {
  using enum DriveKind;
  const std::string kind = s.optional_choice("kind", {"elastic", "geared", "passive", "locked"}).value_or("elastic");
  joint.kind = kind == "elastic" ? kElastic : kind == "geared" ? kGeared : kind == "passive" ? kPassive : kLocked;
  if (joint.driven()) {
    SeaParameters<double>& sea = joint.sea;
    sea.k_p = s.number("k_p", Range::non_negative()), sea.k_d = s.number("k_d", Range::non_negative());
    sea.i_motor = s.number("i_motor", Range::positive());
    if (const auto v = s.optional_number("tau_max", Range::non_negative())) sea.tau_max = *v;
    if (joint.kind == kElastic) {
      sea.k_sea = s.number("k_sea", Range::non_negative()), sea.c_sea = s.number("c_sea", Range::non_negative());
      sea.feedback = read_feedback(s).value_or(Feedback::kOutput);
      for (const OptionalConstant& c : optional_constants())
        sea.*c.at = s.optional_number(c.key, c.range).value_or(c.absent);
    } else {
      sea.viscous = s.optional_number("viscous_friction", Range::non_negative()).value_or(0);
    }
    (void)s.optional_number("speed_max", Range::positive());
    (void)s.optional_text("name");
  } else {
    joint.phi = s.optional_angle("phi").value_or(0);
  }
  if (joint.kind == kPassive) {
    joint.stiffness = s.optional_number("stiffness", Range::non_negative()).value_or(0);
    joint.damping = s.optional_number("damping", Range::non_negative()).value_or(0);
    joint.rest = s.optional_angle("rest").value_or(joint.phi);
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
  }
  if (const auto height = s.optional_number("pin_height", Range::any())) {
    if (out.base != Base::kPinned) s.fail("pin_height", "base = \"pinned\" is needed with it");
    out.pin_height = *height;
  }
}

}  // namespace

LegScene read_leg_scene(const std::string& path) {
  TomlFile file(path);
  LegScene out;
  out.name = std::filesystem::path(path).stem().string();
  TomlSection s = file.require("robot");
  Robot& robot = out.robot;
  robot.gravity = s.number("gravity", Range::non_negative());
  read_base(s, robot);
  std::optional<ContactLaw> law;
  if (auto floor = file.optional("floor")) {
    law = read_law(*floor, {});
    out.floor = true;
    out.slope = floor->optional_angle("slope").value_or(0);
    (void)floor->optional_text("source");
  }
  const std::map<std::string, int> links = read_links(s, robot);
  read_contacts(s, links, law, robot);
  robot.peak = robot.links[0].com;
  if (auto peak = s.optional_section("peak"))
    robot.peak_link = index_in(*peak, "link", links), robot.peak = place_in(*peak, "at");
  std::optional<TomlSection> drives = file.optional("drive");
  std::vector<std::string> names;
  for (Joint& joint : robot.joints) {
    names.push_back(joint.name);
    auto drive = drives ? drives->optional_section(joint.name) : std::nullopt;
    if (!drive)
      throw InputError({path},
                       fmt::format("joint {}: a table [drive.{}] is needed", ukemi::quoted(joint.name), joint.name));
    read_drive(*drive, joint);
  }
  TomlSection drop = file.require("drop");
  out.drop.pitch = drop.angle("pitch");
  if (robot.base == Base::kPinned) {
    for (const char* key : {"height", "forward_speed"})
      if (drop.has(key)) drop.fail(key, "a pinned robot is not dropped");
  } else {
    out.drop.height = drop.number("height", Range::non_negative());
    if (robot.base == Base::kRail && drop.has("forward_speed"))
      drop.fail("forward_speed", "a robot on a rail has none");
    out.drop.forward_speed = drop.optional_number("forward_speed", Range::any()).value_or(0);
  }
  out.drop.pitch_rate = drop.optional_number("pitch_rate", Range::any()).value_or(0);
  if (auto run = file.optional("run")) out.t_end = run->optional_number("t_end", Range::positive());
  file.finish();
  return out;
}

LegMotion read_leg_motion(const std::string& path, const Robot& robot) {
  TomlFile file(path);
  auto motions = file.optional("motion");
  auto moves = file.optional("reposition");
  LegMotion out(robot.joints.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Joint& joint = robot.joints[i];
    if (!joint.driven()) continue;
    auto s = motions ? motions->optional_section(joint.name) : std::nullopt;
    if (!s) throw InputError({path}, fmt::format("a table [motion.{}] is needed", joint.name));
    Motion& m = out[i];
    m = {s->angle("phi_i"), s->angle("phi_f"), s->number("duration", Range::positive())};
    const std::vector<double> bumps = s->optional_list("bumps_deg", kMostBumps, Range::any());
    for (std::size_t k = 0; k < bumps.size(); ++k) m.bumps[k] = bumps[k] * kDegree;
    m.gain_p = s->optional_number("gain_p", Range::non_negative()).value_or(1);
    m.gain_d = s->optional_number("gain_d", Range::non_negative()).value_or(1);
    auto r = moves ? moves->optional_section(joint.name) : std::nullopt;
    if (r)
      m.reposition = Reposition{r->angle("phi"), r->optional_rate("rate").value_or(0),
                                r->number("from", Range::non_negative()), r->number("to", Range::positive())};
  }
  file.finish();
  return out;
}

}  // namespace ukemi::landing
