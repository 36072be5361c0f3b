// ukemi calibrate.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "common/error.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/calibrate.hpp"
#include "tools/verbs/term_help.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct CalibrateArguments {
  std::vector<std::string> drops, validate, motion_of, height_of, speed_of, priors;
  std::string scene, actuator, motion, free, nuisance, lower, upper;
  double accuracy = 1e-9;
  Doubt doubt = Doubt::kReport;
};

/// A term's name, and its unit in the option: a pitch may be given as pitch_deg.
struct Named {
  std::string term;
  double unit = 1;
};
Named named(const std::string& option, const std::string& text, std::initializer_list<identify::Term::Role> roles) {
  const bool degrees = text.size() > 4 && text.compare(text.size() - 4, 4, "_deg") == 0;
  const std::string name = degrees ? text.substr(0, text.size() - 4) : text;
  std::vector<std::string> known;
  for (const DropTerm& t : drop_terms()) {
    if (std::find(roles.begin(), roles.end(), t.role) == roles.end()) continue;
    if (name == t.name && (!degrees || t.unit == "rad")) return {name, degrees ? 1 / kDegrees : 1};
    known.push_back(t.name);
  }
  throw InputError(option + ": " + one_of(text, known));
}

CalibrationOptions calibration_options(const CalibrateArguments& a, const CommonOptions& common) {
  using enum identify::Term::Role;
  CalibrationOptions o;
  o.seed = common.seed;
  o.accuracy = a.accuracy;
  const auto terms = [](const std::string& option, const std::string& list, identify::Term::Role role) {
    std::vector<std::string> out;
    for (const std::string& item : split(list)) {
      const std::string term = named(option, item, {role}).term;
      if (std::find(out.begin(), out.end(), term) != out.end())
        throw InputError(option + ": " + quoted(item) + ": named twice");
      out.push_back(term);
    }
    return out;
  };
  if (!a.free.empty()) o.terms.free = terms("--free", a.free, kConstant);
  o.terms.nuisance = terms("--nuisance", a.nuisance, kNuisance);
  const auto bounds = [](const std::string& option, const std::string& list, std::map<std::string, double>& to) {
    for (const std::string& item : split(list)) {
      const auto [name, value] = assignment(option, item);
      const Named n = named(option, name, {kConstant});
      to[n.term] = to_number(option, value) * n.unit;
    }
  };
  bounds("--lower", a.lower, o.terms.lower);
  bounds("--upper", a.upper, o.terms.upper);
  for (const std::string& item : a.priors) {
    const NamedPrior known = named_prior("--prior", item);
    const Named n = named("--prior", known.name, {kConstant, kNuisance});
    if (!o.terms.fits(n.term))
      throw InputError("--prior: " + quoted(known.name) + ": it is not fitted, see --free and --nuisance");
    o.terms.priors.push_back({n.term, known.value * n.unit, known.std * n.unit});
  }
  o.validate();
  return o;
}

/// The logs with how each was played and thrown. Options that name a drop do so by its path, file name or stem.
class Throws {
 public:
  Throws(const CalibrateArguments& a, const Scene& scene, Run& run) : arguments_(a), scene_(scene), run_(run) {
    if (!a.motion.empty()) {
      motion_ = read_motion(a.motion);
      run.input(a.motion);
    }
    const auto collect = [&](const std::string& option, const std::vector<std::string>& items,
                             std::vector<Assignment>& to) {
      for (const std::string& item : items) {
        to.push_back(assignment(option, item));
        const std::string& drop = to.back().name;
        const auto any = [&](const std::vector<std::string>& paths) {
          return std::any_of(paths.begin(), paths.end(), [&](const std::string& p) { return names(drop, p); });
        };
        if (!any(a.drops) && !any(a.validate))
          throw InputError(option + ": " + quoted(drop) + ": no such drop is given");
      }
    };
    collect("--motion-of", a.motion_of, motions_);
    collect("--height-of", a.height_of, heights_);
    collect("--speed-of", a.speed_of, speeds_);
  }

  std::vector<LoggedDrop> read(const std::vector<std::string>& paths) const {
    std::vector<LoggedDrop> out;
    for (const std::string& path : paths) {
      run_.input(path);
      LoggedDrop d{.log = read_drop(path), .motion = {}, .thrown = scene_.drop};
      if (const std::string* file = given(motions_, path)) {
        d.motion = read_motion(*file);
        run_.input(*file);
      } else if (motion_) {
        d.motion = *motion_;
      } else {
        throw InputError(quoted(path) + ": no motion: give --motion, or --motion-of for this drop");
      }
      if (const std::string* h = given(heights_, path)) {
        d.thrown.height = to_number("--height-of", *h);
        if (!(d.thrown.height >= 0)) throw InputError("--height-of: " + quoted(*h) + ": at least 0 m is needed");
      }
      if (const std::string* v = given(speeds_, path)) d.thrown.forward_speed = to_number("--speed-of", *v);
      if (d.log.before_release > 0)
        run_.warn(fmt::format("{}: {} rows before the release (t < 0) are left out", path, d.log.before_release));
      out.push_back(std::move(d));
    }
    return out;
  }

 private:
  static bool names(const std::string& drop, const std::string& path) {
    const std::filesystem::path p(path);
    return drop == path || drop == p.filename().string() || drop == p.stem().string();
  }
  static const std::string* given(const std::vector<Assignment>& list, const std::string& path) {
    for (const Assignment& a : list)
      if (names(a.name, path)) return &a.value;
    return nullptr;
  }

  const CalibrateArguments& arguments_;
  const Scene& scene_;
  Run& run_;
  std::optional<Motion> motion_;
  std::vector<Assignment> motions_, heights_, speeds_;
};

int run_calibrate(const CalibrateArguments& a, const CommonOptions& common) {
  Run run("calibrate", common);
  CalibrationOptions options = calibration_options(a, common);
  options.monitor = run.monitor("calibrate: parts");
  const Scene scene = read_scene(a.scene);
  run.input(a.scene);
  const Actuator actuator = actuator_of(a.actuator, run);
  const Throws throws(a, scene, run);
  const std::vector<LoggedDrop> drops = throws.read(a.drops), unseen = throws.read(a.validate);

  check_drops(scene, drops);
  if (!unseen.empty()) check_drops(scene, unseen);
  run.info(fmt::format("fitting {} drops", drops.size()));
  Calibration c = calibrate(scene, actuator.sea, drops, options);
  c.scene.floor_source = "calibrated from drop logs by ukemi";
  std::optional<CalibratedDrops> validation;
  if (!unseen.empty() && !options.monitor.stopped())
    validation = {unseen, validate(c.scene, actuator.sea, unseen, options)};
  return report({drops, c}, validation, a.doubt, run);
}

}  // namespace

void add_calibrate(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<CalibrateArguments>();
  CLI::App* verb = app.add_subcommand("calibrate", "fit the floor's constants and the pitch to logs of drops");
  verb->add_option("DROP", args->drops,
                   "drop logs (CSV: t [s] from release; any of acc, ax, ay [m/s^2], x_0, y_0 [m], phi_0 [rad] of the "
                   "thigh's centre of mass; _ms, _g, _mm, _deg convert)")
      ->required();
  verb->add_option("--scene", args->scene, "scene file (TOML): the robot, the drop, the constants to start from")
      ->required();
  verb->add_option("--actuator", args->actuator, "actuator file (TOML)")->required();
  verb->add_option("--motion", args->motion, "motion file (TOML) that every drop played");
  verb->add_option("--motion-of", args->motion_of, "DROP=MOTION.toml: another motion for one drop")
      ->expected(1)
      ->take_all();
  verb->add_option("--height-of", args->height_of, "DROP=H: another height for one drop [m]")->expected(1)->take_all();
  verb->add_option("--speed-of", args->speed_of, "DROP=V: another forward speed for one drop [m/s]")
      ->expected(1)
      ->take_all();
  verb->add_option("--free", args->free,
                   "constants that are fitted [stiffness,damping_normal,damping_tangential,pitch]");
  verb->add_option("--nuisance", args->nuisance, nuisance_help(drop_terms(), "A drop each"));
  verb->add_option("--prior", args->priors, "NAME=VALUE:STD: what is known of a fitted term beforehand")
      ->expected(1)
      ->take_all();
  verb->add_option("--lower", args->lower, "stiffness=1000,pitch_deg=-20,...: lower bounds [0; pitch: -180 deg]");
  verb->add_option("--upper", args->upper, "upper bounds [none; pitch: 180 deg]");
  verb->add_option("--validate", args->validate, "drop logs that are not fitted: measured against simulated");
  verb->add_option("--accuracy", args->accuracy, "relative tolerance of the rollout [1e-9]");
  verb->add_flag_callback(
      "--strict", [args] { args->doubt = Doubt::kFail; },
      "exit 1 unless every fitted constant is trusted (95 % interval within 10 % of its value)");
  add_action<CalibrateArguments>(
      *verb, args,
      "ukemi calibrate drop_1.csv drop_2.csv --scene scene.toml --actuator actuator.toml --motion motion.toml "
      "--height-of drop_2=0.25 --validate drop_3.csv -o out",
      chosen, run_calibrate);
}

}  // namespace ukemi::tools
