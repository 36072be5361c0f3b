// ukemi calibrate.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "common/error.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/drops/drop_log.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/calibrate.hpp"
#include "tools/report/estimates.hpp"
#include "tools/report/results.hpp"
#include "tools/study/calibration.hpp"
#include "tools/verbs/body.hpp"
#include "tools/verbs/calibrate.hpp"
#include "tools/verbs/term_help.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// A term's name, and the unit of its values in an option, in SI: a pitch may be given as pitch_deg.
struct TermWithUnit {
  std::string term;
  double unit = 1;
};
TermWithUnit find_term(const std::vector<DropTerm>& table, const std::string& option, const std::string& text,
                       std::initializer_list<identify::Term::Role> roles) {
  const bool degrees = text.size() > 4 && text.compare(text.size() - 4, 4, "_deg") == 0;
  const std::string name = degrees ? text.substr(0, text.size() - 4) : text;
  std::vector<std::string> known;
  for (const DropTerm& t : table) {
    if (std::find(roles.begin(), roles.end(), t.role) == roles.end()) continue;
    if (t.is_called(text)) return {t.name};
    if (name == t.name && (!degrees || t.unit == "rad")) return {name, degrees ? 1 / kDegrees : 1};
    known.push_back(t.name);
  }
  throw InputError(option + ": " + one_of(text, known));
}

}  // namespace

std::vector<std::string> named_terms(const std::vector<DropTerm>& table, const std::string& option,
                                     const std::string& list, identify::Term::Role role) {
  std::vector<std::string> out;
  for (const std::string& item : split(list)) {
    const std::string term = find_term(table, option, item, {role}).term;
    if (std::find(out.begin(), out.end(), term) != out.end())
      throw InputError(option + ": " + quoted(item) + ": named twice");
    out.push_back(term);
  }
  return out;
}

void set_options(const CalibrateArguments& a, const CommonOptions& common, CalibrationOptions& o) {
  using enum identify::Term::Role;
  o.seed = common.seed;
  o.accuracy = a.accuracy;
  const auto terms = [&o](const std::string& option, const std::string& list, identify::Term::Role role) {
    return named_terms(*o.terms.table, option, list, role);
  };
  if (!a.free.empty()) o.terms.free = terms("--free", a.free, kConstant);
  o.terms.nuisance = terms("--nuisance", a.nuisance, kNuisance);
  o.profiles = terms("--profile", a.profile, kConstant);
  const auto bounds = [&o](const std::string& option, const std::string& list, std::map<std::string, double>& values) {
    for (const std::string& item : split(list)) {
      const auto [name, value] = assignment(option, item);
      const TermWithUnit n = find_term(*o.terms.table, option, name, {kConstant});
      set_once(option, name, n.term, to_number(option, value) * n.unit, values);
    }
  };
  bounds("--lower", a.lower, o.terms.lower);
  bounds("--upper", a.upper, o.terms.upper);
  for (const std::string& item : a.priors) {
    const NamedPrior known = named_prior("--prior", item);
    const TermWithUnit n = find_term(*o.terms.table, "--prior", known.name, {kConstant, kNuisance});
    if (!o.terms.fits(n.term))
      throw InputError("--prior: " + quoted(known.name) + ": it is not fitted, see --free and --nuisance");
    o.terms.priors.push_back({n.term, known.value * n.unit, known.std * n.unit});
  }
  for (const std::string& item : split(a.errors)) {
    const auto [name, value] = assignment("--errors", item, "NAME=SD");
    const TermWithUnit n = find_term(*o.terms.table, "--errors", name, {kConstant, kNuisance});
    o.errors.emplace_back(n.term, to_number("--errors", value) * n.unit);
  }
  o.validate();
}

namespace {

/// Whether `drop` is the path, file name or stem of a log.
bool refers_to(const std::string& drop, const std::string& path) {
  const std::filesystem::path p(path);
  return drop == path || drop == p.filename().string() || drop == p.stem().string();
}

/// The VALUE for a drop among an option's items DROP=VALUE.
std::optional<std::string> value_of(const std::string& option, const std::vector<std::string>& items,
                                    const std::string& path) {
  for (const std::string& item : items)
    if (const Assignment a = assignment(option, item); refers_to(a.name, path)) return a.value;
  return {};
}

/// Throws InputError where an item names a drop that is not given, or one that an item before it has named.
void check_items(const std::string& option, const std::vector<std::string>& items, const CalibrateArguments& a) {
  std::vector<std::string> drops = a.drops, named;
  drops.insert(drops.end(), a.validate.begin(), a.validate.end());
  for (const std::string& item : items) {
    const std::string drop = assignment(option, item).name;
    const auto path = std::find_if(drops.begin(), drops.end(), [&](const auto& p) { return refers_to(drop, p); });
    if (path == drops.end()) throw InputError(option + ": " + quoted(drop) + ": no such drop is given");
    if (std::find(named.begin(), named.end(), *path) != named.end())
      throw InputError(option + ": " + quoted(drop) + ": given twice");
    named.push_back(*path);
  }
}

/// Applies --height-of and --speed-of.
void set_drop(const CalibrateArguments& a, const std::string& path, Drop& drop) {
  if (const auto height = value_of("--height-of", a.height_of, path)) {
    drop.height = to_number("--height-of", *height);
    if (!(drop.height >= 0)) throw InputError("--height-of: " + quoted(*height) + ": at least 0 m is needed");
  }
  if (const auto speed = value_of("--speed-of", a.speed_of, path)) drop.forward_speed = to_number("--speed-of", *speed);
}

void warn_of_log(const DropLog& log, Run& run) {
  for (const std::string& note : log.notes) run.warn(log.file + ": " + note);
  if (log.before_release > 0)
    run.warn(fmt::format("{}: {} rows before the release (t < 0) are left out", log.file, log.before_release));
}

template <class LoggedDrop>
struct GivenDrops {
  std::vector<LoggedDrop> fitted, unseen;
};
/// The drops that the arguments name, checked: each log is `read(path)`; it is thrown as the scene says, unless the
/// arguments do; its motion is `played(path, own)`, `own` the file of --motion-of.
template <class LoggedDrop, class Scene, class Read, class Played>
GivenDrops<LoggedDrop> given_drops(const CalibrateArguments& a, const Scene& scene, Run& run, Read&& read,
                                   Played&& played) {
  check_items("--motion-of", a.motion_of, a), check_items("--height-of", a.height_of, a);
  check_items("--speed-of", a.speed_of, a);
  for (const std::string& twice : duplicate_warnings(a.drops)) run.warn(twice);
  GivenDrops<LoggedDrop> out;
  for (const auto& [paths, drops] : {std::pair(&a.drops, &out.fitted), {&a.validate, &out.unseen}}) {
    for (const std::string& path : *paths) {
      run.input(path);
      const auto own = value_of("--motion-of", a.motion_of, path);
      LoggedDrop d{.log = read(path), .motion = played(path, own), .thrown = scene.drop};
      set_drop(a, path, d.thrown);
      warn_of_log(d.log, run);
      drops->push_back(std::move(d));
    }
  }
  check_drops(scene, out.fitted);
  if (!out.unseen.empty()) check_drops(scene, out.unseen);
  for (const std::string& known : overlap_warnings(a.drops, a.validate)) run.warn(known);
  run.info(fmt::format("fitting {} drops", out.fitted.size()));
  return out;
}

Motion motion_of(const std::string& path, Run& run) {
  run.input(path);
  return read_motion(path);
}

BodyMotion motion_of(const std::string& path, const BodyScene& scene, Run& run) {
  run.input(path);
  return read_body_motion(path, scene.robot);
}

int calibrate_body(const CalibrateArguments& a, const CommonOptions& common) {
  Run run(kCalibrateOutputs, common);
  const BodyScene scene = body_of(a.scene, a.actuators, run);
  check_drop_arguments(scene.robot, a.height_of.empty() ? nullptr : "--height-of",
                       a.speed_of.empty() ? nullptr : "--speed-of");
  BodyCalibrationOptions options;
  options.terms = drop_choice(scene);
  if (options.terms.free.empty()) throw InputError(Location{a.scene}, "no contact: there is nothing to fit");
  set_options(a, common, options);
  options.threads = common.threads;
  if (a.law == CalibrateArguments::Law::kOnly) options.rivals = BodyCalibrationOptions::Rivals::kNone;
  options.monitor = run.monitor("calibrate", "parts");
  const auto motion = a.motion.empty() ? std::nullopt : std::optional(motion_of(a.motion, scene, run));
  const auto read = [channels = body_channels(scene.robot)](const std::string& path) {
    return read_drop(path, channels);
  };
  const auto played = [&](const std::string&, const std::optional<std::string>& own) {
    return own ? motion_of(*own, scene, run) : motion ? *motion : held_posture(scene);
  };
  auto [drops, unseen] = given_drops<BodyLoggedDrop>(a, scene, run, read, played);
  BodyCalibratedDrops fitted{std::move(drops), {}};
  fitted.result = calibrate(scene, fitted.drops, options);
  if (a.law == CalibrateArguments::Law::kAsked) adopt_best_law(fitted.result, fitted.drops, options);
  std::optional<BodyCalibratedDrops> validation;
  if (!unseen.empty() && !options.monitor.stopped())
    validation = {unseen, validate(fitted.result.scene, unseen, options)};
  return report(a.scene, fitted, validation, a.doubt, run);
}

int run_calibrate(const CalibrateArguments& a, const CommonOptions& common) {
  if (is_of_links(a.scene)) return calibrate_body(a, common);
  Run run(kCalibrateOutputs, common);
  const std::string file = only_actuator(a.actuators);
  if (a.law) throw InputError("--law: the paper's robot has one: a robot of links is needed");
  CalibrationOptions options;
  set_options(a, common, options);
  options.monitor = run.monitor("calibrate", "parts");
  const Scene scene = read_scene(a.scene);
  run.input(a.scene);
  const Actuator actuator = landing_actuator_of(file, run);
  const auto motion = a.motion.empty() ? std::nullopt : std::optional(motion_of(a.motion, run));
  const auto played = [&](const std::string& drop, const std::optional<std::string>& own) {
    if (!own && !motion) throw InputError(quoted(drop) + ": no motion: give --motion, or --motion-of for this drop");
    return own ? motion_of(*own, run) : *motion;
  };
  const auto [drops, unseen] = given_drops<LoggedDrop>(
      a, scene, run, [](const std::string& path) { return read_drop(path); }, played);
  Calibration c = calibrate(scene, actuator.sea, drops, options);
  c.scene.floor_source = "calibrated from drop logs by ukemi";
  std::optional<CalibratedDrops> validation;
  if (!unseen.empty() && !options.monitor.stopped())
    validation = {unseen, validate(c.scene, actuator.sea, unseen, options)};
  return report({drops, c}, validation, a.doubt, run);
}

void add_calibrate(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<CalibrateArguments>();
  const auto repeated = [verb](const std::string& option, std::vector<std::string>& items, const std::string& help) {
    verb->add_option(option, items, help)->expected(1)->take_all();
  };
  verb->add_option("DROP", args->drops,
                   "drop logs (CSV: t [s] from release; any of acc, ax, ay [m/s^2], x_0, y_0 [m], phi_0 [rad] of the "
                   "thigh's centre of mass; _ms, _g, _mm, _deg convert)")
      ->required();
  verb->add_option("--scene", args->scene, "scene file (TOML): the robot, the drop, the constants to start from")
      ->required();
  verb->add_option("--actuator", args->actuators,
                   "actuator file (TOML); of a robot of links JOINT=FILE, once for each, where the scene has none")
      ->allow_extra_args(false);
  verb->add_option("--motion", args->motion, "motion file (TOML, CSV) that every drop played");
  repeated("--motion-of", args->motion_of, "DROP=MOTION.toml: another motion for one drop");
  repeated("--height-of", args->height_of, "DROP=H: another height for one drop [m]");
  repeated("--speed-of", args->speed_of, "DROP=V: another forward speed for one drop [m/s]");
  verb->add_option("--free", args->free,
                   "constants that are fitted [stiffness,damping_normal,damping_tangential,pitch; of a robot of links "
                   "every constant of the scene's contact laws, CONTACT.NAME where a contact has its own]");
  verb->add_option("--nuisance", args->nuisance, nuisance_help(drop_terms(), "A drop each"));
  repeated("--prior", args->priors, "NAME=VALUE:STD: what is known of a fitted term beforehand");
  verb->add_option(
      "--errors", args->errors,
      "stiffness=500,height_offset=0.005,...: standard deviations of terms that are not fitted, of an offset in each "
      "drop by itself: all errors include theirs");
  verb->add_option("--lower", args->lower, "stiffness=1000,pitch_deg=-20,...: lower bounds [0; pitch: -180 deg]");
  verb->add_option("--upper", args->upper, "upper bounds [none; pitch: 180 deg]");
  verb->add_option("--profile", args->profile,
                   "stiffness,...: profile likelihood of these constants: profile.csv and unsymmetric 95 % intervals");
  verb->add_option("--validate", args->validate, "drop logs that are not fitted: measured against simulated");
  verb->add_option("--accuracy", args->accuracy, "relative tolerance of the rollout [1e-9]");
  verb->add_flag_callback(
      "--strict", [args] { args->doubt = Doubt::kFail; },
      "exit 1 unless every fitted constant is trusted (95 % interval within 10 % of its value)");
  add_choice<std::optional<CalibrateArguments::Law>>(
      *verb, "--law", args->law,
      {{"scene", CalibrateArguments::Law::kScene},
       {"asked", CalibrateArguments::Law::kAsked},
       {"only", CalibrateArguments::Law::kOnly}},
      "of a robot of links: which contact law is fitted and written: the scene's, others being tried; the one that the "
      "drops ask for; only the scene's, none tried [scene]");
  add_action<CalibrateArguments>(
      *verb, args,
      "ukemi calibrate drop_1.csv drop_2.csv --scene scene.toml --actuator actuator.toml --motion motion.toml "
      "--height-of drop_2=0.25 --validate drop_3.csv -o out",
      chosen, run_calibrate);
}

const Verb calibrate_verb(VerbGroup::kConstants, "calibrate",
                          "fit the floor's constants and the pitch to logs of drops", add_calibrate);

}  // namespace

}  // namespace ukemi::tools
