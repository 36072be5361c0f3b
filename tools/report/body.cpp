#include "tools/report/body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "landing/body/places.hpp"
#include "landing/plan/scene_doubts.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/landing_doubts.hpp"

namespace ukemi::tools {

const Outputs kRobotOutputs{"robot", {"robot.toml"}, {"robot"}};

using namespace landing;

namespace {

/// A joint and its index in samples.
struct NamedJoint {
  const Joint& joint;
  std::size_t index;
};
std::vector<NamedJoint> driven(const Robot& robot) {
  std::vector<NamedJoint> out;
  for (std::size_t j = 0; j < robot.joints.size(); ++j)
    if (robot.joints[j].driven()) out.push_back({robot.joints[j], j});
  return out;
}
std::string place_words(const landing::Place& p) { return fmt::format("[{:.4g}, {:.4g}]", p.along, p.across); }

/// The constants of a joint's drive on one line.
std::string drive_words(const Joint& j) {
  std::string out;
  const auto add = [&](const char* what, double value, const char* unit) {
    if (value != 0 && std::isfinite(value))
      out += fmt::format("{}{} {:.4g} {}", out.empty() ? "" : ", ", what, value, unit);
  };
  if (j.driven()) {
    add("k_p", j.sea.k_p, "Nm/rad"), add("k_d", j.sea.k_d, "Nm/(rad/s)");
    if (j.kind == DriveKind::kElastic) add("k_sea", j.sea.k_sea, "Nm/rad"), add("c_sea", j.sea.c_sea, "Nm/(rad/s)");
    add("i_motor", j.sea.i_motor, "kg m²"), add("tau_max", j.sea.tau_max, "Nm");
  } else if (j.kind == DriveKind::kPassive) {
    add("stiffness", j.stiffness, "Nm/rad"), add("damping", j.damping, "Nm/(rad/s)");
    add("friction", j.sea.friction, "Nm");
    out += fmt::format("{}rest {:.4g} deg", out.empty() ? "" : ", ", j.rest * kDegrees);
  } else {
    out = fmt::format("locked at {:.4g} deg", j.phi * kDegrees);
  }
  add("parallel_stiffness", j.parallel_stiffness, "Nm/rad");
  return out;
}
std::string base_words(const Robot& r) {
  if (r.base == Base::kFree) return "free";
  if (r.base == Base::kPinned) return fmt::format("pinned {:.4g} m above the floor", r.pin_height);
  return fmt::format("on a rail, {:.4g} deg from level", r.rail_direction * kDegrees);
}

}  // namespace

Quantities<BodyMotion> motion_quantities(const Robot& robot, const BodyMotion& like) {
  Quantities<BodyMotion> out;
  for (const auto& [joint, i] : driven(robot))
    for (const Quantity<Motion>& q : motion_quantities(like[i])) {
      const std::string unit = q.csv.ends_with("_deg") ? "_deg" : "";
      const std::string column = q.csv.substr(0, q.csv.size() - unit.size());
      out.push_back({column.empty() ? "" : column + "_" + joint.name + unit,
                     q.json.empty() ? "" : joint.name + "/" + q.json, q.words.empty() ? "" : joint.name + " " + q.words,
                     q.format, [value = q.value, k = i](const BodyMotion& m) { return value(m[k]); }});
    }
  return out;
}

Json motion_json(const Robot& robot, const BodyMotion& motion) {
  return Table::of(motion_quantities(robot, motion), motion).object();
}

std::string motion_words(const Robot& robot, const BodyMotion& motion) {
  std::string out;
  for (const auto& [joint, i] : driven(robot)) {
    const Motion& m = motion[i];
    out += (out.empty() ? "" : ", ") + joint.name + fmt::format(" {:.4g}", m.phi_i * kDegrees);
    if (moves(m))
      out += fmt::format(" to {:.4g} deg in {:.4g} s", m.phi_f * kDegrees, m.duration);
    else
      out += " deg";
  }
  return out.empty() ? "no joint is driven" : out;
}

Check within_ratings(const BodyScene& scene, const BodyMotion& motion, const BodyLanding& l) {
  const Robot& robot = scene.robot;
  constexpr const char* kWhat = "within ratings";
  if (l.demands.empty()) return {Check::State::kUnknown, kWhat, "the landing was not played"};
  std::vector<std::string> exceeded;
  for (const ExceededRating& b : exceeded_ratings(scene, motion, l))
    exceeded.push_back(fmt::format("{} {:.3g} of {:.3g} {}", b.joint->name, b.value, b.rating, b.unit));
  if (!exceeded.empty()) return {Check::State::kBad, kWhat, fmt::format("{}", fmt::join(exceeded, ", "))};
  const bool known = std::all_of(robot.joints.begin(), robot.joints.end(),
                                 [](const Joint& j) { return !j.driven() || (j.speed_max && j.motor_torque_max); });
  return {known ? Check::State::kGood : Check::State::kUnknown, kWhat, known ? "" : "rating unknown"};
}

Json joints_json(const BodyScene& scene, const BodyMotion& motion, const BodyLanding& l) {
  Json out = Json::object();
  for (std::size_t i = 0; i < l.demands.size(); ++i) {
    const Joint& joint = scene.robot.joints[i];
    const JointDemands& d = l.demands[i];
    if (joint.kind == DriveKind::kLocked) continue;
    Json& j = out[joint.name] = {
        {"kind", name(joint.kind)}, {"phi_deg", {d.phi_min * kDegrees, d.phi_max * kDegrees}}, {"torque", d.torque}};
    if (!joint.driven()) continue;
    j["peak_reference_rate"] = peak_reference_rate(motion[i], expected_start(scene, l));
    j["motor_speed"] = d.motor_speed, j["speed_max"] = number(joint.speed_max);
    j["motor_torque"] = d.motor_torque, j["motor_torque_max"] = number(joint.motor_torque_max);
    j["tau_max"] = number(joint.sea.tau_max);
  }
  return out;
}

/// "-140 to -5 deg": the ends of a stop.
std::string stop_range(const Stop& s) {
  const double unit = s.joint < 0 ? 1 : 1 / kDegrees;
  return fmt::format("{:.4g} to {:.4g} {}", s.ends[0] / unit, s.ends[1] / unit, s.joint < 0 ? "m" : "deg");
}

void robot_tables(const BodyScene& scene, Report& report) {
  const Robot& robot = scene.robot;
  report.heading("Robot");
  report.paragraph(fmt::format("{} links, {:.4g} kg, base {}. Peak of [{:.4g}, {:.4g}] of {}.", robot.links.size(),
                               robot.mass(), base_words(robot), robot.peak.along, robot.peak.across,
                               robot.links[std::size_t(robot.peak_link)].name));
  std::vector<std::vector<std::string>> links, joints, contacts;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& l = robot.links[i];
    links.push_back({l.name, l.parent < 0 ? "" : robot.links[std::size_t(l.parent)].name, place_words(l.at),
                     fmt::format("{:.4g}", l.mass), fmt::format("{:.4g}", l.inertia_com), place_words(l.com),
                     fmt::format("{:.4g}", extent(robot, int(i)))});
  }
  report.table({"link", "on", "at [m]", "mass [kg]", "inertia [kg m²]", "centre of mass [m]", "length [m]"}, links);
  const BodyMotion held = held_posture(scene);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& j = robot.joints[i];
    const auto& [low, high] = scene.search[i].phi;
    joints.push_back({j.name, name(j.kind), drive_words(j), fmt::format("{:.4g}", held[i].phi_i * kDegrees),
                      j.driven() ? fmt::format("{:.4g} to {:.4g}", low * kDegrees, high * kDegrees) : ""});
  }
  if (!joints.empty()) report.table({"joint", "drive", "constants", "released at [deg]", "plans within [deg]"}, joints);
  for (const ContactPoint& c : robot.contacts)
    contacts.push_back({c.name, robot.links[std::size_t(c.link)].name, place_words(c.at),
                        scene.floor ? fmt::format("{:.4g}", c.law.stiffness) : "",
                        scene.floor && std::isfinite(c.law.friction) ? fmt::format("{:.4g}", c.law.friction) : "",
                        c.pad ? fmt::format("{:.4g} mm", c.pad->thickness * 1e3) : ""});
  if (!contacts.empty()) report.table({"contact", "link", "at [m]", "stiffness [N/m]", "friction", "pad"}, contacts);
  std::vector<std::vector<std::string>> stops;
  for (const Stop& s : robot.stops)
    stops.push_back(
        {stop_name(robot, s), stop_range(s), fmt::format("{:.4g}", s.stiffness), fmt::format("{:.4g}", s.damping)});
  if (!stops.empty()) report.table({"stop", "at", "stiffness [Nm/rad, N/m]", "damping [Nm s/rad, N s/m]"}, stops);
  floor_source(report, scene.source);
}

namespace {

FirstScreen robot_screen(const BodyScene& scene) {
  const Robot& robot = scene.robot;
  const auto count = [&](auto&& test) { return std::count_if(robot.joints.begin(), robot.joints.end(), test); };
  const auto driven = count([](const Joint&j) { return j.driven(); }),
             locked = count([](const Joint&j) { return j.kind == DriveKind::kLocked; }),
             unrated = count([](const Joint&j) { return j.driven() && !j.speed_max && !j.motor_torque_max; });
  const std::size_t doubt_count = doubts(scene).size();
  FirstScreen out{.sentence = fmt::format(
                      "{} links of {:.4g} kg in all reach {:.3g} m; {} of {} joints are driven; base {}.",
                      robot.links.size(), robot.mass(), reach(robot), driven, robot.joints.size(), base_words(robot))};
  out.checks = {check(doubt_count == 0, "plausible",
                      doubt_count == 0 ? "masses, inertias and contacts are those of such links"
                                       : fmt::format("{} of its numbers look wrong", doubt_count))};
  if (robot.base != Base::kPinned)
    out.checks.push_back(
        check(!robot.contacts.empty(), "can touch", fmt::format("{} contacts", robot.contacts.size())));
  if (locked > 0)
    out.checks.push_back({Check::State::kCaution, "free to move", fmt::format("{} joints are locked", locked)});
  if (unrated > 0)
    out.checks.push_back(
        {Check::State::kUnknown, "rated", fmt::format("{} drives have no speed_max and no motor_torque_max", unrated)});
  out.next = driven > 0 ? "Plan a landing: `ukemi optimize`, of a scene that names this file, or with --height."
                        : "Give a joint a drive: without one there is nothing to plan.";
  return out;
}

}  // namespace

int report_robot(const BodyScene& scene, const std::vector<DescriptionNote>& notes, Run& run) {
  const Robot& robot = scene.robot;
  for (const std::string& doubt : doubts(scene)) run.warn(doubt);
  Json summary = {{"mass", robot.mass()}, {"reach", reach(robot)}, {"base", base_words(robot)}};
  Json locked = Json::array();
  std::vector<std::vector<std::string>> texts;
  for (const DescriptionNote& n : notes) {
    run.say(fmt::format("  {:<10} {:<14} {}", n.what, n.name, n.text));
    summary["projection"].push_back({{"what", n.what}, {"name", n.name}, {"text", n.text}});
    texts.push_back({n.what, n.name, n.text});
  }
  run.say(fmt::format("{}: {} links, {:.4g} kg, reach {:.4g} m, base {}", scene.name, robot.links.size(), robot.mass(),
                      reach(robot), base_words(robot)));
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& l = robot.links[i];
    run.say(fmt::format("  link {:<12} {:>8.4g} kg {:>10.4g} kg m^2, centre of mass {}, length {:.4g} m", l.name,
                        l.mass, l.inertia_com, place_words(l.com), extent(robot, int(i))));
    summary["links"].push_back({{"name", l.name},
                                {"mass", l.mass},
                                {"inertia_com", l.inertia_com},
                                {"com", {l.com.along, l.com.across}},
                                {"length", extent(robot, int(i))}});
  }
  for (const Joint& j : robot.joints) {
    run.say(fmt::format("  joint {:<11} {}: {}", j.name, name(j.kind), drive_words(j)));
    summary["joints"].push_back({{"name", j.name}, {"kind", name(j.kind)}});
    if (j.kind == DriveKind::kLocked) locked.push_back(j.name);
  }
  for (const ContactPoint& c : robot.contacts) {
    run.say(fmt::format("  contact {:<9} {} of {}", c.name, place_words(c.at), robot.links[std::size_t(c.link)].name));
    summary["contacts"].push_back({{"name", c.name}, {"link", robot.links[std::size_t(c.link)].name}});
  }
  for (const Stop& s : robot.stops) {
    const std::string at = stop_name(robot, s);
    run.say(fmt::format("  stop {:<12} {}, {:.4g} {}", at, stop_range(s), s.stiffness, s.joint < 0 ? "N/m" : "Nm/rad"));
    summary["stops"].push_back({{"of", at}, {"stiffness", s.stiffness}, {"damping", s.damping}});
  }
  summary["locked"] = locked, summary["doubts"] = doubts(scene);
  Report report("Robot: " + scene.name);
  report.answer(robot_screen(scene), run.warnings());
  report.figure(drawing(scene));
  report.distrust(run.warnings());
  robot_tables(scene, report);
  if (!texts.empty()) report.heading("From its description"), report.table({"", "name", "what became of it"}, texts);
  report.write(run);
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools
