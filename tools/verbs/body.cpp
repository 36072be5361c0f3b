// Reading of robots of links and of options for them; ukemi robot.
#include "tools/verbs/body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/body/places.hpp"
#include "landing/model/scatter_file.hpp"
#include "landing/plan/body_drop_file.hpp"
#include "landing/plan/body_goal.hpp"
#include "landing/plan/body_space.hpp"
#include "landing/plan/scene_doubts.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/body.hpp"
#include "tools/report/scene_edit.hpp"
#include "tools/robots/projection.hpp"

namespace ukemi::tools {

using namespace landing;

std::vector<GivenDrive> drives_of(const std::vector<std::string>& given, const std::string& option) {
  std::vector<GivenDrive> out;
  for (const std::string& text : given) {
    const std::size_t equal = text.find('=');
    const bool named = equal != std::string::npos && text.find_first_of("/.\\") > equal;
    out.push_back(named ? GivenDrive{text.substr(0, equal), text.substr(equal + 1), option}
                        : GivenDrive{"", text, option});
    if (out.back().file.empty())
      throw InputError(fmt::format("{}: {}: a file is needed, as FILE or JOINT=FILE", option, ukemi::quoted(text)));
    const auto same = [&](const GivenDrive& g) { return g.joint == out.back().joint; };
    if (std::count_if(out.begin(), out.end(), same) > 1)
      throw InputError(fmt::format("{}: {}: given twice", option,
                                   out.back().joint.empty() ? ukemi::quoted(text) : ukemi::quoted(out.back().joint)));
  }
  return out;
}

namespace {

/// Makes the files of a scene inputs of the run; warns of constants of drives that their fits did not trust, and of
/// unknown ratings.
void note_files(const BodyScene& scene, const std::string& path, Run& run) {
  run.input(path);
  if (!scene.robot_file.empty()) run.input(scene.robot_file);
  for (const std::string& drive : scene.drive_files) warn_of_unknown_ratings(actuator_of(drive, run), drive, run);
}

}  // namespace

std::optional<double> checked_height(const std::optional<double>& height) {
  if (height && !(*height >= 0 && *height <= 1e4))
    throw InputError(fmt::format("--height: {}: 0 to 1e4 m is needed", *height));
  return height;
}

void add_scene(CLI::App& verb, SceneArguments& a) {
  verb.add_option("SCENE", a.scene, "scene file (TOML)")->required();
  add_actuators(verb, a.actuators), add_set(verb, a.set);
}
void add_actuators(CLI::App& verb, std::vector<std::string>& actuators) {
  verb.add_option("--actuator", actuators,
                  "actuator file (TOML); of a robot of links JOINT=FILE, once for each joint that its file leaves open")
      ->allow_extra_args(false);
}
void add_set(CLI::App& verb, std::vector<std::string>& set) {
  verb.add_option("--set", set,
                  "KEY=VALUE, of a robot of links: a number of its files, as of `trade --vary`; also "
                  "search.JOINT.phi_deg=LO:HI, search.JOINT.hold_deg, search.duration=LO:HI, "
                  "joint.JOINT.phi_deg=LO:HI, stop.JOINT.phi_deg=LO:HI; "
                  "once for each")
      ->allow_extra_args(false);
}
void refuse_set(const std::vector<std::string>& set) {
  if (!set.empty()) throw InputError("--set: of robots of links; numbers of the paper's robot are changed in its file");
}

namespace {

SceneEdit edited(const std::string& path, const BodyScene& scene, const std::vector<std::string>& set) {
  SceneEdit out(path, scene);
  for (const std::string& text : set) out.set(text);
  return out;
}

}  // namespace

Texts edited_texts(const SceneArguments& a) {
  if (a.set.empty()) return {};
  return edited(a.scene, read_edited(a.scene, drives_of(a.actuators), a.height, {}), a.set).texts();
}

namespace {

/// The first touchdown of a robot whose references never move; infinite without one [s].
double touchdown_of_held(const BodyScene& scene) {
  const std::vector<BodyRelease::Joint>& joints = scene.release->joints;
  const bool turns = scene.drop.pitch_rate != 0 ||
                     std::any_of(joints.begin(), joints.end(), [](const BodyRelease::Joint& j) { return j.rate != 0; });
  return turns ? peak_acceleration(scene, held_posture(scene)).contacts.first() : fall_time(scene);
}

/// Throws InputError where the references may move from the first touchdown on alone.
void check_release(const BodyScene& scene, const std::string& key) {
  if (!scene.release) return;
  if (const double fall = touchdown_of_held(scene); !(scene.release->from < fall))
    throw InputError(fmt::format("{}: {} s: a time before the first touchdown, at {:.6g} s, is needed", key,
                                 shortest(scene.release->from), fall));
}

}  // namespace

BodyScene body_of(const std::string& path, const std::vector<std::string>& actuators, Run& run,
                  const std::string& option, const std::optional<double>& height, const std::vector<std::string>& set) {
  const std::vector<GivenDrive> drives = drives_of(actuators, option);
  BodyScene scene = read_edited(path, drives, checked_height(height), {});
  std::optional<SceneEdit> edit;
  if (!set.empty()) try {
      edit = edited(path, scene, set);
      scene = read_edited(path, drives, height, edit->texts());
    } catch (const InputError& e) {
      const std::string what = e.what();
      throw InputError(what.starts_with("--set") ? what : "--set: " + what);
    }
  note_files(scene, path, run);
  if (edit)
    for (auto& [name, text] : edit->kept(height, run.provenance_text(), run.folder(), drives)) run.add(name, text);
  check_release(scene, path + ": release.from");
  for (const std::string& doubt : doubts(scene)) run.warn(doubt);
  if (!scene.floor) run.warn("the scene has no [floor]: nothing can touch");
  warn_of_doubts(path, scene.verdicts, run);
  warn_of_doubts(scene.robot_file.empty() ? path : scene.robot_file, scene.robot_verdicts, run);
  return scene;
}

namespace {

/// Applies --release-phi, -rate and -from to the scene's [release]; with several driven joints only -from.
void apply_release(const FreedomArguments& a, BodyScene& scene) {
  const std::optional<std::size_t> only = sole_driven_joint(scene.robot);
  if (!only && (a.release_phi || a.release_rate))
    throw InputError("--release-phi, --release-rate: of several driven joints the scene's [release.JOINT] says it");
  if (!only && a.from && !scene.release)
    throw InputError("--release-from: the scene has no [release] with a table for each driven joint");
  std::optional<Release> before;
  if (scene.release) {
    const BodyRelease::Joint joint = only ? scene.release->joints[*only] : BodyRelease::Joint{};
    before = Release{joint.phi, joint.rate, scene.release->from};
  }
  const std::optional<Release> after = release_of(a, before);
  if (!after) return;
  if (!scene.release) scene.release = BodyRelease{.joints = std::vector<BodyRelease::Joint>(scene.robot.joints.size())};
  scene.release->from = after->from;
  if (only) scene.release->joints[*only] = {after->phi, after->rate};
}

}  // namespace

void keep_ratings(BodyScene& scene, Run& run) {
  for (const std::string& joint : respect_ratings(scene, "--respect-ratings"))
    run.warn(fmt::format("--respect-ratings: the drive of {} has neither speed_max nor motor_torque_max", joint));
}

void apply_freedom(const FreedomArguments& a, BodyScene& scene, Run& run) {
  apply(a, scene.freedom), apply_release(a, scene);
  if (a.from) check_release(scene, "--release-from");
  warn_of_radians(a, run);
}

std::optional<Scatter> scatter_of(const ScatterArguments& a) {
  return a.scatter ? std::optional(parse_scatter("--scatter", *a.scatter)) : std::nullopt;
}
double inflate_of(const ScatterArguments& a, const BodyScene& scene, Run& run) {
  const double out = checked_inflate(a);
  if (a.inflate && !scene.robot.fitted() && !scene.identified)
    run.warn(
        "--inflate makes no difference: no drive's file holds [uncertainty] and no robot's [identified], so their "
        "constants do not scatter");
  return out;
}

namespace {

struct RobotArguments {
  std::string file;
  std::vector<std::string> actuators;
  std::string normal;
  std::vector<std::string> contacts, locked;
  std::optional<Base> base;
  std::optional<double> pin_height;
};
std::vector<std::string> names_of(const std::vector<std::string>& lists) {
  std::vector<std::string> out;
  for (const std::string& list : lists)
    for (const std::string& name : split(list)) out.push_back(name);
  return out;
}

/// Projects a URDF or MJCF file onto a plane: writes robot.toml, and reports what happened to every part.
int run_description(const RobotArguments& a, Run& run) {
  if (a.normal.empty())
    throw InputError("--normal: x, y or z is needed: the axis of the root's frame across the plane");
  if (a.pin_height && !std::isfinite(*a.pin_height)) throw InputError("--pin-height: a finite number is needed");
  ProjectionOptions options;
  options.normal = a.normal, options.contacts = names_of(a.contacts), options.locked = names_of(a.locked);
  options.base = a.base, options.pin_height = a.pin_height;
  options.drives = drives_of(a.actuators);
  run.input(a.file);
  const SpatialRobot spatial = read_description(a.file);
  for (const std::string& warning : spatial.warnings) run.warn(a.file + ": " + warning);
  const Projection projected = project(spatial, options);
  for (const std::string& warning : projected.warnings) run.warn(a.file + ": " + warning);
  BodyScene scene;
  scene.name = std::filesystem::path(a.file).stem().string(), scene.robot = projected.robot;
  scene.search.resize(projected.robot.joints.size());
  for (const std::string& file : projected.drive_files)
    if (!file.empty()) (void)actuator_of(file, run);
  for (std::size_t i = 0; i < projected.joints.size(); ++i)
    if (const SpatialJoint& j = projected.joints[i]; j.lower && j.upper && *j.lower < *j.upper)
      scene.search[i].phi = {*j.lower, *j.upper};
  run.add("robot.toml", robot_toml(projected, spatial, run.options().folder, run.provenance_text()));
  std::vector<DescriptionNote> notes;
  for (const Note& n : projected.notes) notes.push_back({n.what, n.name, n.text});
  return report_robot(scene, notes, run);
}

int run_robot(const RobotArguments& a, const CommonOptions& common) {
  Run run(kRobotOutputs, common);
  if (is_description(a.file)) return run_description(a, run);
  if (!a.normal.empty() || !a.contacts.empty() || !a.locked.empty() || a.base || a.pin_height)
    throw InputError("--normal, --contacts, --lock, --base, --pin-height: of URDF and MJCF alone; " +
                     ukemi::quoted(a.file) + " has its own");
  const BodyScene scene = read_robot(a.file, drives_of(a.actuators));
  note_files(scene, a.file, run);
  return report_robot(scene, {}, run);
}

}  // namespace

std::string only_actuator(const std::vector<std::string>& given, const std::string& option) {
  if (given.empty())
    throw InputError(option + " is required (of a robot of links the scene says robot = \"FILE\" above all tables)");
  if (given.size() > 1) throw InputError(option + ": the paper's robot has one joint: one file is needed");
  return given[0];
}

std::shared_ptr<const std::vector<BodyDrop>> measured_drops(const ScatterArguments& a, const BodyScene& scene,
                                                            Run& run) {
  if (a.drops.empty()) return nullptr;
  a.check_measured();
  run.input(a.drops);
  return std::make_shared<const std::vector<BodyDrop>>(read_drops(a.drops, scene));
}

std::optional<long> scattered_samples(const OptimizeArguments& a) {
  if (a.samples && !a.robust) throw InputError("--samples: of drops that scatter: --robust is needed");
  if (a.samples && !(*a.samples >= 16 && *a.samples <= 4096))
    throw InputError(fmt::format("--samples: {}: 16 to 4096 is needed", *a.samples));
  return a.samples;
}

BodyScene scene_to_plan(const OptimizeArguments& a, Run& run) {
  const auto refuse = [](bool given, const char* option) {
    if (given)
      throw InputError(fmt::format("{}: of the paper's robot alone; robots of links are planned without it", option));
  };
  refuse(a.solver == "compare", "--solver compare"), refuse(a.tolerance != 0, "--tolerance");
  refuse(a.evidence == AnswerOptions::Extras::kAlways, "--evidence");
  BodyScene scene = body_of(a, run);
  apply_freedom(a.freedom, scene, run);
  forbid(scene, a.forbid, "--forbid");
  return scene;
}

BodyPlanOptions plan_options(const OptimizeArguments& a, const CommonOptions& common, const BodyScene& scene,
                             Run& run) {
  BodyPlanOptions out;
  out.solver = a.solver, out.goal = a.goal, out.evaluations = a.evaluations;
  if (a.robust) out.measure = Measure::parse("--robust", *a.robust);
  out.samples = scattered_samples(a).value_or(out.samples);
  if (a.penalty) throw InputError("--penalty: of the paper's robot; of robots of links --share says what is kept");
  if (a.share && !a.robust) throw InputError("--share: of drops that scatter: --robust is needed");
  if (a.share && !(*a.share > 0 && *a.share <= 1))
    throw InputError(fmt::format("--share: {}: above 0 to 1 is needed", *a.share));
  out.share = a.share;
  out.measured = measured_drops(a.scatter, scene, run);
  out.scatter = scatter_of(a.scatter), out.inflate = inflate_of(a.scatter, scene, run);
  out.seed = common.seed, out.threads = common.threads;
  out.validate();
  if (out.scatter) (void)BodyDropModel(scene, *out.scatter);  // refuses numbers that this base does not have
  return out;
}

namespace {

void add_robot(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<RobotArguments>();
  verb->add_option("FILE", args->file, "robot file or scene file (TOML); URDF or MJCF, which becomes robot.toml")
      ->required();
  verb->add_option("--actuator", args->actuators, "JOINT=FILE: the drive of a joint; once for each")
      ->allow_extra_args(false);
  verb->add_option("--normal", args->normal,
                   "of URDF, MJCF: x, y or z, the axis of the root's frame across the plane; joints about it stay");
  verb->add_option("--contacts", args->contacts, "of URDF, MJCF: links (MJCF: sites, bodies, geoms) that may touch")
      ->allow_extra_args(false);
  verb->add_option("--lock", args->locked, "of URDF, MJCF: joints about the normal to hold at 0")
      ->allow_extra_args(false);
  add_choice<std::optional<Base>>(*verb, "--base", args->base,
                                  {{"free", Base::kFree}, {"rail", Base::kRail}, {"pinned", Base::kPinned}},
                                  "of URDF, MJCF: free, rail (upright) or pinned [free]");
  verb->add_option("--pin-height", args->pin_height, "of a pinned base: its origin above the floor [m]");
  add_action<RobotArguments>(*verb, args,
                             "ukemi robot leg.toml -o out\n"
                             "         ukemi robot leg.urdf --normal y --contacts foot,heel -o out",
                             chosen, run_robot);
}

const Verb robot_verb(VerbGroup::kLandings, "robot", "draws and checks a robot of links, before anything falls",
                      add_robot);

}  // namespace

}  // namespace ukemi::tools
