// The terms of driven robots.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/fit/rig_terms.hpp"
#include "landing/body/places.hpp"
#include "landing/plan/design_numbers.hpp"
#include "tools/study/robot_trials.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::Term;

namespace {

constexpr double kInfinity = Term::kInfinity;

/// Properties of a kind of number; `size`: typical magnitude, for values of 0; `judged`: see Term::judged_size.
struct Kind {
  const char *key, *unit, *words;
  double lower, upper, size;
  double judged = 0;
};
/// Constants of a drive by their keys in its file, defined in identify's table.
constexpr const char* kGeared[] = {"i_motor",   "friction",       "viscous_friction", "friction_asymmetry",
                                   "breakaway", "stribeck_speed", "spring_loss"};
constexpr const char *kProportional[] = {"k_p"}, *kDerivative[] = {"k_d"};
constexpr const char *kElastic[] = {"k_sea",           "c_sea",          "k_sea_cubic",
                                    "output_friction", "output_viscous", "output_friction_asymmetry"},
                     *kLimited[] = {"tau_max"}, *kLate[] = {"control_delay", "velocity_filter"};
constexpr Kind kPassive[] = {{"stiffness", "Nm/rad", "stiffness of the joint", 0, kInfinity, 1},
                             {"damping", "Nm/(rad/s)", "damping of the joint", 0, kInfinity, 0.01},
                             {"friction", "Nm", "dry friction of the joint", 0, kInfinity, 0.1},
                             {"rest_deg", "deg", "where its spring rests", -180, 180, 5, 10}};
constexpr Kind kParallelSpring[] = {
    {"parallel_stiffness", "Nm/rad", "stiffness of a spring beside the drive", 0, kInfinity, 0.1}};
constexpr Kind kParallelRest[] = {{"parallel_rest_deg", "deg", "where that spring rests", -180, 180, 5, 10}};
constexpr Kind kOfCommand[] = {
    {"torque_gain", "1", "motor torque over commanded torque", 1e-3, kInfinity, 1},
    {"offset", "rad", "what the encoder reads beyond the angle", -kInfinity, kInfinity, 0.01, 0.1}};
constexpr Kind kLevels[] = {{"torque_low", "Nm", "least torque that is asked", -kInfinity, 0, 1},
                            {"torque_high", "Nm", "largest torque that is asked", 0, kInfinity, 1}};

/// Bounds of a link's centre of mass: along the link between its outermost places, across it up to a quarter of its
/// length beyond them, since a link is at most half as wide as long. Pushes are places too; the point that counts is
/// not, where it is the centre of mass itself. Within 1 m for a link without such places, whose length is unknown.
struct ComBounds {
  Place low, high;
  double length;
};
ComBounds com_bounds(const Robot& robot, int link) {
  constexpr double kMinLength = 0.02, kDefault = 1, kMargin = 0.25;  // [m], [m], of the length
  const Place com = robot.links[std::size_t(link)].com;
  std::vector<Place> all = places(robot, link);
  if (robot.peak_link == link && robot.peak.along == com.along && robot.peak.across == com.across)
    std::erase_if(all, [&](const Place& p) { return p.along == com.along && p.across == com.across; });
  for (const PushPoint& p : robot.pushes)
    if (p.link == link) all.push_back(p.at);
  ComBounds out{{}, {}, 0};
  for (const Place& p : all) {
    out.low = {std::min(out.low.along, p.along), std::min(out.low.across, p.across)};
    out.high = {std::max(out.high.along, p.along), std::max(out.high.across, p.across)};
  }
  out.length = std::hypot(out.high.along - out.low.along, out.high.across - out.low.across);
  if (out.length <= kMinLength) return {{-kDefault, -kDefault}, {kDefault, kDefault}, kDefault};
  out.low.across -= kMargin * out.length, out.high.across += kMargin * out.length;
  return out;
}

class TermTable {
 public:
  explicit TermTable(const DrivenRobot& robot) : robot_(robot) {}

  template <std::size_t N>
  void add(const std::string& prefix, const Kind (&kinds)[N]) {
    for (const Kind& k : kinds) add(prefix, k);
  }
  void add(const std::string& prefix, const Kind& k) {
    Term t{.name = prefix + k.key, .unit = k.unit, .words = k.words};
    t.lower = k.lower, t.upper = k.upper, t.size = k.size, t.judged_size = k.judged;
    add(std::move(t));
  }
  template <std::size_t N>
  void add(const std::string& prefix, const char* const (&keys)[N]) {
    for (const std::string key : keys)
      for (const identify::RigTerm& of_rig : identify::rig_terms())
        if (of_rig.key == key) {
          Term t = of_rig;
          t.name = prefix + key;
          add(std::move(t));
        }
  }
  void add(Term term) {
    DropTerm t{std::move(term)};
    t.role = Term::Role::kConstant, t.absent = 0, t.alias = "";
    t.moves = {t.name};
    if (t.name.rfind("robot.link.", 0) == 0) t.alias = t.name.substr(6);
    t.spread = t.lower >= 0 ? 2 : t.size;
    if (const double given = number_of(robot_, t.name); std::isfinite(given) && given != 0 && t.lower >= 0)
      t.size = std::abs(given);
    out.push_back(std::move(t));
  }
  void add_link(std::size_t i) {
    const Robot& robot = robot_.scene.robot;
    const Link& link = robot.links[i];
    const std::string to = "robot.link." + link.name + ".";
    const ComBounds com = com_bounds(robot, int(i));
    // smallest_part keeps masses and inertias above 0.
    add(to, {"mass", "kg", "mass of the link", 0, kInfinity, link.mass});
    out.back().smallest_part = 1e-3;
    add(to, {"inertia_com", "kg m^2", "inertia of the link about its centre of mass", 0, kInfinity, link.inertia_com});
    out.back().smallest_part = 1e-3;
    const double size = 0.1 * com.length;
    add(to, {"com.along", "m", "centre of mass along the link", com.low.along, com.high.along, size});
    add(to, {"com.across", "m", "centre of mass beside the link", com.low.across, com.high.across, size, size});
  }
  /// A nuisance term of each trial's start.
  void add_start(const std::string& key, const char* unit, const char* words, double size) {
    DropTerm t;
    t.name = "start." + key, t.unit = unit, t.words = words;
    t.scope = identify::Scope::kEach, t.size = size, t.moves = {t.name};
    out.push_back(std::move(t));
  }
  void add_start(const Joint& j) {
    add_start(j.name + ".phi", "rad", "added to the angle that the log starts with", 0.01);
    add_start(j.name + ".dphi", "rad/s", "added to the rate that the log starts with", 0.1);
    if (j.kind == DriveKind::kElastic)
      add_start(j.name + ".spring", "rad", "the motor's angle less the joint's at the start", 0.01);
  }
  void add_base_start() {
    add_start("height", "m", "of the lowest contact over its surface at the start", 0.01);
    add_start("speed", "m/s", "at which it rises there", 0.1);
  }
  void add_free_start() {
    add_start("pitch", "rad", "added to the first link's angle that the log starts with", 0.01);
    add_start("pitch_rate", "rad/s", "added to its rate", 0.1);
    add_start("forward_speed", "m/s", "added to its speed", 0.1);
    add_start("x", "m", "added to its place along the floor", 0.01);
  }
  void add_contact(const ContactPoint& c) {
    const std::string to = "robot.contact." + c.name + ".";
    const bool hunt = c.law.hunt_crossley;
    add(to, {"stiffness", hunt ? "N/m^p" : "N/m", "stiffness of the contact", 1, kInfinity, 1e4});
    if (hunt)
      add(to, {"dissipation", "s/m", "dissipation of the contact", 0, kInfinity, 0.1});
    else
      add(to, {"damping_normal", "N/(m/s)", "damping of the contact", 0, kInfinity, 10});
    add(to, {"damping_tangential", "N/(m/s)", "damping along the floor", 1e-3, kInfinity, 10});
    if (c.law.stiffness_tangential > 0)
      add(to, {"stiffness_tangential", "N/m", "stiffness along the floor", 0, kInfinity, 1e4});
    if (std::isfinite(c.law.friction)) add(to, {"friction", "1", "friction of the contact", 0, kInfinity, 0.5});
    if (hunt) add(to, {"exponent", "1", "exponent of the contact", 1, 10, 1});
    if (!c.pad) return;
    add(to, {"pad.stiffness", "N/m", "stiffness of the pad", 1, kInfinity, 1e3});
    add(to, {"pad.damping", "N/(m/s)", "damping of the pad", 0, kInfinity, 10});
    add(to, {"pad.thickness", "m", "thickness of the pad", 1e-4, 1, 0.01});
  }
  void add_stop(const Stop& s) {
    const bool rail = s.joint < 0;
    const std::string to = "stop." + stop_name(robot_.scene.robot, s) + ".";
    add(to, {"stiffness", rail ? "N/m" : "Nm/rad", "stiffness of the stop", 1e-3, kInfinity, 1e3});
    add(to, {"damping", rail ? "N/(m/s)" : "Nm/(rad/s)", "damping of the stop", 0, kInfinity, 1});
    constexpr Kind kEnds[] = {{"low_deg", "deg", "where the lower stop is", -360, 360, 5, 10},
                              {"high_deg", "deg", "where the upper stop is", -360, 360, 5, 10},
                              {"low", "m", "where the lower stop is", -kInfinity, kInfinity, 0.01, 0.1},
                              {"high", "m", "where the upper stop is", -kInfinity, kInfinity, 0.01, 0.1}};
    for (const int end : {0, 1})
      if (std::isfinite(s.ends[std::size_t(end)])) add(to, kEnds[2 * rail + end]);
  }
  std::vector<DropTerm> out;

 private:
  const DrivenRobot& robot_;
};

/// Whether any trial has this command of a joint.
bool has_column(const std::vector<RobotTrial>& trials, std::size_t joint, CommandColumn what) {
  return std::any_of(trials.begin(), trials.end(), [&](auto& t) { return !t.commands->joint[joint][what].empty(); });
}

/// Whether the position of a free base along the floor is measured; nothing else depends on it.
bool measures_x(const Robot& robot, const std::vector<RobotTrial>& trials) {
  const std::size_t x = base_channel(robot) + kOriginX;
  return std::any_of(trials.begin(), trials.end(), [&](auto& t) { return !t.log.output[x].empty(); });
}

void add_sensors(TermTable& table, const Robot& robot, const std::vector<RobotTrial>& trials) {
  // Typical size of a bias, by its column's unit.
  static const std::map<std::string, double> sizes = {{"rad", 0.01}, {"rad/s", 0.1}, {"Nm", 0.1},
                                                      {"m", 0.01},   {"N", 1},       {"m/s^2", 0.1}};
  const auto add = [&](const MeasuredColumn& c) {
    const std::string to = "sensor." + c.name + ".";
    const double size = sizes.at(c.unit);
    table.add(to, {"gain", "1", "reading over true value", 0.01, 100, 1});
    table.add(to, {"bias", c.unit.c_str(), "reading at zero", -kInfinity, kInfinity, size, 10 * size});
  };
  const auto any = [&](auto&& has) { return std::any_of(trials.begin(), trials.end(), has); };
  const std::vector<MeasuredColumn> measured = measured_columns(robot), pushed = push_columns(robot);
  for (std::size_t c = 0; c < measured.size(); ++c)
    if (any([&](const RobotTrial& t) { return !t.log.output[c].empty(); })) add(measured[c]);
  for (std::size_t c = 0; c < pushed.size(); ++c)
    if (any([&](const RobotTrial& t) { return !t.commands->push[c / 2][c % 2].empty(); })) add(pushed[c]);
  if (pushed.empty()) return;
  table.add("sensor.", {"time_shift", "s", "by which the pushes came later than logged", -kMaxTimeShift, kMaxTimeShift,
                        1e-3, 1e-2});
  table.add("sensor.", {"push_smooth", "1", "the pushes between their rows: 0 linear, 1 smooth", 0, 1, 1, 1});
}

void add_joint(TermTable& table, const DrivenRobot& robot, std::size_t i, const std::vector<RobotTrial>& trials) {
  const Joint& j = robot.scene.robot.joints[i];
  const std::string drive = "drive." + j.name + ".", command = "command." + j.name + ".";
  if (j.kind == DriveKind::kPassive) table.add(drive, kPassive);
  if (j.driven()) {
    const bool has_ref = has_column(trials, i, kPhiRef), fed_back = has_ref || has_column(trials, i, kDphiRef);
    if (has_ref && !has_column(trials, i, kKp)) table.add(drive, kProportional);
    if (fed_back && !has_column(trials, i, kKd)) table.add(drive, kDerivative);
    table.add(drive, kGeared), table.add(command, kOfCommand);
    if (j.kind == DriveKind::kElastic) table.add(drive, kElastic);
    if (j.kind == DriveKind::kElastic && std::isfinite(j.sea.tau_max)) table.add(drive, kLimited);
    if (j.kind == DriveKind::kElastic && fed_back && fits_late_kernel(robot.scene.robot)) table.add(drive, kLate);
    if (std::isfinite(robot.path.joints[i].torque_high)) table.add(command, kLevels[1]);
    if (std::isfinite(robot.path.joints[i].torque_low)) table.add(command, kLevels[0]);
  }
  table.add(drive, kParallelSpring);
  if (j.parallel_stiffness > 0) table.add(drive, kParallelRest);
}

}  // namespace

identify::Terms<DropTerm> robot_terms(const DrivenRobot& robot, const std::vector<RobotTrial>& trials) {
  TermTable table(robot);
  const Robot& r = robot.scene.robot;
  for (std::size_t i = 0; i < r.joints.size(); ++i)
    if (r.joints[i].kind != DriveKind::kLocked) add_joint(table, robot, i, trials);
  for (std::size_t i = 0; i < r.links.size(); ++i) table.add_link(i);
  for (const ContactPoint& c : r.contacts) table.add_contact(c);
  for (const Stop& s : r.stops) table.add_stop(s);
  if (r.base == Base::kRail) {
    table.add("robot.rail.", {"viscous", "N/(m/s)", "viscous friction of the rail", 0, kInfinity, 1});
    table.add("robot.rail.", {"friction", "N", "dry friction of the rail", 0, kInfinity, 1});
    table.add("robot.rail.", {"load_friction", "", "dry friction of the rail over the force across it", 0, 1, 0.1});
  }
  table.add("robot.", {"gravity", "m/s^2", "gravity", 0, kInfinity, 9.81});
  table.add("command.", {"delay", "s", "from a row to its command's effect", 0, kMaxCommandDelay, 1e-3});
  add_sensors(table, r, trials);
  identify::Terms<DropTerm> out;
  for (const Joint& j : r.joints)
    if (j.kind != DriveKind::kLocked) table.add_start(j);
  if (r.base != Base::kPinned) table.add_base_start();
  if (r.base == Base::kFree) table.add_free_start();
  for (const DropTerm& t : table.out)
    if (!t.is_constant() && (t.name != "start.x" || measures_x(r, trials))) out.nuisance.push_back(t.name);
  out.table = std::make_shared<const std::vector<DropTerm>>(std::move(table.out));
  return out;
}

void fit_per_run(const std::vector<std::string>& names, const std::vector<RobotTrial>& trials,
                 RobotFitOptions& options) {
  const std::size_t runs = runs_of(trials).size();
  identify::Terms<DropTerm>& terms = options.terms;
  const auto expand = [runs](auto& list, const auto& match, const auto& of_run) {
    std::remove_reference_t<decltype(list)> out;
    for (const auto& item : list)
      for (std::size_t r = 0; r < (match(item) ? runs : 1); ++r) out.push_back(match(item) ? of_run(item, r) : item);
    list = std::move(out);
  };
  for (const std::string& given : names) {
    const std::string name = terms[given].name;
    if (std::find(terms.free.begin(), terms.free.end(), name) == terms.free.end())
      throw InputError("--per-run: " + quoted(given) + ": it is not fitted, see --free");
    const auto named = [&](std::size_t run) { return fmt::format("{}@{}", name, run + 1); };
    const auto is_name = [&](const std::string& other) { return other == name; };
    const auto name_of_run = [&](const std::string&, std::size_t run) { return named(run); };
    expand(terms.free, is_name, name_of_run), expand(options.profiles, is_name, name_of_run);
    expand(
        terms.priors, [&](const identify::Prior& p) { return p.term == name; },
        [&](identify::Prior p, std::size_t run) { return p.term = named(run), p; });
    for (auto* bounds : {&terms.lower, &terms.upper})
      if (const auto bound = bounds->find(name); bound != bounds->end())
        for (std::size_t r = 0; r < runs; ++r) (*bounds)[named(r)] = bound->second;
    terms.lower.erase(name), terms.upper.erase(name);
    std::vector<DropTerm> table = *terms.table;
    expand(
        table, [&](const DropTerm& t) { return t.name == name; },
        [&](DropTerm t, std::size_t run) { return t.name = named(run), t.alias = "", t.run = int(run), t; });
    terms.table = std::make_shared<const std::vector<DropTerm>>(std::move(table));
  }
}

}  // namespace ukemi::tools
