// ukemi atlas.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>

#include "common/error.hpp"
#include "common/files.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/atlas/atlas_reader.hpp"
#include "landing/atlas/body_atlas.hpp"
#include "landing/atlas/body_atlas_reader.hpp"
#include "landing/atlas/two_link_atlas.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/atlas.hpp"
#include "tools/report/body.hpp"
#include "tools/report/body_scene_text.hpp"
#include "tools/verbs/body.hpp"
#include "tools/verbs/freedom.hpp"
#include "tools/verbs/scattering.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr const char *kBinary = "atlas.bin", *kJournal = "atlas.part",
                     *kNeeded = "atlas: SCENE and --actuator are needed, or --merge";

struct AtlasArguments {
  std::string scene, height, speed, pitch, shard, ask;
  std::vector<std::string> actuators;
  std::vector<std::string> merge;
  Goal goal = Goal::kPeak;
  std::optional<long> evaluations;
  FreedomArguments freedom;
  std::optional<std::string> robust;  ///< a measure
  ScatterArguments scatter;
  std::optional<long> samples;
  std::vector<std::string> forbid;
  bool ratings = false;  ///< --respect-ratings
  bool limited() const { return !forbid.empty() || ratings; }
};

AtlasAxis axis_of(const std::string& option, const std::string& text, double unit) {
  if (text.empty()) throw InputError(option + ": LO:HI:N is needed");
  const NumberRange r = number_range(option, text, true);
  return {r.lower / unit, r.upper / unit, std::uint64_t(r.count)};
}

/// The robot, scene and goal of an atlas.
struct Subject {
  std::unique_ptr<AtlasRobot> robot;
  std::string name, scene_toml, actuator_toml;  ///< see AtlasResult
  RobustOptions robust;
  std::array<bool, AtlasGrid::kAxes> axes{true, true, true};  ///< those that its base has
  Drop drop;                                                  ///< of the scene; value of the other axes
  std::string unit = "m/s^2";                                 ///< of what is minimised
};

/// The options of --robust.
RobustOptions robust_of(const AtlasArguments& a, long default_samples) {
  if (!a.robust) {
    const char* given = a.samples           ? "--samples"
                        : a.scatter.scatter ? "--scatter"
                        : a.scatter.inflate ? "--inflate"
                                            : nullptr;
    if (given) throw InputError(fmt::format("{}: without --robust it has no effect", given));
    return {};
  }
  RobustOptions out{.measure = Measure::parse("--robust", *a.robust)};
  out.samples = a.samples.value_or(default_samples);
  if (!(out.samples >= 16 && out.samples <= 4096))
    throw InputError(fmt::format("--samples: {}: 16 to 4096 is needed", out.samples));
  return out;
}

Subject two_link_of(const AtlasArguments& a, Run& run) {
  if (a.actuators.empty()) throw InputError(kNeeded);
  const Scene scene = scene_of(a.scene, a.freedom, run);
  const Actuator actuator = landing_actuator_of(only_actuator(a.actuators), run);
  Subject out{.name = scene.name,
              .scene_toml = to_toml(scene, ""),
              .actuator_toml = to_toml(actuator),
              .robust = robust_of(a, RobustOptions().samples)};
  out.robot = std::make_unique<TwoLinkAtlas>(scene, actuator);
  if (!out.robust.measure) return out;
  const Scattering scattering = scattering_of(a.scatter, scene, actuator, run);
  out.robust.scatter = scattering.scatter, out.robust.inflate = scattering.inflate;
  return out;
}

/// Adds the limits of --forbid and --respect-ratings to the scene, as loads, which are saved with the atlas.
void keep_limits(BodyScene& scene, const AtlasArguments& a, Run& run) {
  const std::vector<Load> before = scene.loads;
  forbid(scene, a.forbid, "--forbid");
  if (a.ratings) keep_ratings(scene, run);
  for (std::size_t i = 0; i < before.size(); ++i)
    if (scene.loads[i].rating != before[i].rating || scene.loads[i].kind != before[i].kind)
      throw InputError("--forbid, --respect-ratings: " + ukemi::quoted(before[i].name) +
                       ": a load of the scene has this name");
}

Subject body_subject(const AtlasArguments& a, Run& run) {
  const FreedomArguments& f = a.freedom;
  if (f.bumps || f.gains || f.release_phi || f.release_rate || f.from)
    throw InputError(
        "--bumps, --landing-gains, --release-...: of a robot of links, and with limits, [motion] and [release] of its "
        "scene, which lies beside its atlas, say it");
  BodyScene scene = body_of(a.scene, a.actuators, run);
  keep_limits(scene, a, run);
  Subject out{.name = scene.name,
              .robust = robust_of(a, BodyPlanOptions().samples),
              .axes = axes_of(scene.robot),
              .drop = scene.drop,
              .unit = unit_of(scene)};
  out.robot = std::make_unique<BodyAtlas>(scene);
  if (scene.touches())
    out.scene_toml = scene_files(a.scene, scene, "", run.folder(), drives_of(a.actuators)).at("scene.toml");
  if (!out.robust.measure) return out;
  out.robust.scatter = scatter_of(a.scatter), out.robust.inflate = inflate_of(a.scatter, scene, run);
  (void)BodyDropModel(scene, scatter_for(out.robust.scatter, scene));  // throws for unsupported scatter
  return out;
}

Subject subject_of(const AtlasArguments& a, Run& run) {
  if (a.scene.empty()) throw InputError(kNeeded);
  return is_of_links(a.scene) || a.limited() ? body_subject(a, run) : two_link_of(a, run);
}

/// The grid of the options; an axis that the base does not have has the scene's value only.
AtlasGrid grid_of(const AtlasArguments& a, const Subject& subject) {
  const auto axis = [&](std::size_t k, const char* option, const std::string& text, double unit, double fixed) {
    return text.empty() && !subject.axes[k] ? AtlasAxis{fixed, fixed, 1} : axis_of(option, text, unit);
  };
  const Drop& d = subject.drop;
  return {{axis(0, "--height", a.height, 1, d.height), axis(1, "--speed", a.speed, 1, d.forward_speed),
           axis(2, "--pitch-deg", a.pitch, kDegrees, d.pitch)}};
}

AtlasOptions options_of(const AtlasArguments& a, const CommonOptions& common, const Subject& subject) {
  AtlasOptions out;
  out.grid = grid_of(a, subject);
  if (!a.shard.empty()) {
    const auto [part, parts] = part_of("--shard", a.shard);
    out.shard = {part, parts};
  }
  out.search.goal = a.goal, out.search.evaluations = a.evaluations;
  out.search.seed = common.seed, out.search.threads = common.threads;
  out.robust = subject.robust;
  out.validate(), subject.robot->validate(out.grid);
  return out;
}

/// Copies the shard's drops from a finished atlas with this identity in the folder, if any.
void restore_finished(const std::string& path, const std::string& identity, const std::vector<std::size_t>& drops,
                      std::vector<AtlasCell>& cells) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) return;
  try {
    const MappedAtlas old(path);
    if (std::string_view(old.header().identity, sizeof old.header().identity) != identity) return;
    for (const std::size_t i : drops) cells[i] = old.cells()[i];
  } catch (const InputError&) {  // a file that is not an atlas is replaced like every earlier result
  }
}

/// Finds the safest motion of an atlas, once all its drops are planned.
void find_safest(AtlasResult& r, const AtlasRobot& robot, const CommonOptions& common, const Run& run) {
  r.atlas.header.safest = {};
  if (r.atlas.open() == 0)
    r.atlas.header.safest = safest_motion(robot, r.atlas.header.grid, r.atlas.cells, common.threads,
                                          run.monitor("atlas: the safest motion", "drops"));
}

AtlasResult result_of(const Subject& s) {
  return {.scene = s.name,
          .variables = s.robot->variables(),
          .scene_toml = s.scene_toml,
          .actuator_toml = s.actuator_toml,
          .unit = s.unit};
}

int run_plan(const AtlasArguments& a, const CommonOptions& common) {
  Run run(kAtlasOutputs, common);
  const Subject subject = subject_of(a, run);
  const AtlasRobot& robot = *subject.robot;
  AtlasOptions options = options_of(a, common, subject);
  AtlasResult r = result_of(subject);
  r.shard = a.shard;
  r.drops = options.shard.drops(options.grid);
  r.atlas.header = atlas_header(robot, options);
  r.atlas.cells.resize(options.grid.size());
  const std::string identity = atlas_identity(robot, options), folder = run.options().folder;
  restore_finished(in(folder, kBinary), identity, r.drops, r.atlas.cells);
  AtlasJournal journal(in(folder, kJournal), identity, r.atlas.cells);
  r.resumed = r.atlas.planned() + r.atlas.none();
  run.info(fmt::format("planning {} drops of {} in {} blocks, {} of them planned before", r.drops.size(),
                       options.grid.size(), options.grid.blocks(), r.resumed));
  options.done = [&](std::size_t drop, const AtlasCell& cell) { journal.add(drop, cell); };
  options.monitor = run.monitor("atlas", "drops");
  plan_atlas(robot, options, r.atlas.cells);
  find_safest(r, robot, common, run);
  if (interrupted()) r.journal = journal.bytes();
  return report(r, run);
}

/// Copies the planned drops of a part. Throws InputError where another part has different motions for them.
void merge_part(const Atlas& part, const std::string& path, Atlas& whole) {
  if (std::memcmp(part.header.identity, whole.header.identity, sizeof part.header.identity) != 0)
    throw InputError({path}, "a part of another atlas: scene, actuator, grid, goal, effort or seed differ");
  for (std::size_t i = 0; i < whole.cells.size(); ++i) {
    if (part.cells[i].state == AtlasCell::State::kOpen) continue;
    AtlasCell& cell = whole.cells[i];
    if (cell.state != AtlasCell::State::kOpen && std::memcmp(&cell, &part.cells[i], sizeof cell) != 0)
      throw InputError({path}, fmt::format("drop {} of the grid is planned otherwise than by a part before it", i + 1));
    cell = part.cells[i];
  }
}

/// The subject of the files in the folder of an atlas.
Subject subject_in(const std::string& folder, const AtlasHeader& header, Run& run) {
  AtlasArguments files;
  files.scene = in(folder, "scene.toml");
  run.input(files.scene);
  Subject out;
  if (is_of_links(files.scene)) {
    out = subject_of(files, run);
  } else {
    files.actuators = {in(folder, "actuator.toml")};
    run.input(files.actuators[0]);
    const Scene scene = read_scene(files.scene);
    out.name = scene.name;
    out.scene_toml = read_text_file(files.scene), out.actuator_toml = read_text_file(files.actuators[0]);
    out.robot = std::make_unique<TwoLinkAtlas>(scene, read_actuator(files.actuators[0]));
  }
  if (out.robot->checksum() != std::string_view(header.robot, sizeof header.robot))
    throw InputError({files.scene}, "scene.toml or actuator.toml beside it are not those of the atlas");
  return out;
}

int run_merge(const AtlasArguments& a, const CommonOptions& common) {
  Run run(kAtlasOutputs, common);
  for (const auto& [option, text] : {std::pair{"SCENE", a.scene},
                                     {"--actuator", a.actuators.empty() ? "" : a.actuators[0]},
                                     {"--shard", a.shard},
                                     {"--forbid", a.forbid.empty() ? "" : a.forbid[0]},
                                     {"--respect-ratings", a.ratings ? "given" : ""},
                                     {"--height", a.height},
                                     {"--speed", a.speed},
                                     {"--pitch-deg", a.pitch}})
    if (!text.empty()) throw InputError(std::string("--merge: ") + option + " has no effect: the parts decide it");
  Atlas whole;
  for (const std::string& folder : a.merge) {
    const std::string path = in(folder, kBinary);
    run.input(path);
    const std::string bytes = read_binary_file(path);
    Atlas part = atlas_of(std::as_bytes(std::span(bytes)), path);
    if (whole.cells.empty())
      whole = std::move(part);
    else
      merge_part(part, path, whole);
  }
  if (const std::size_t open = whole.open(); open > 0)
    throw InputError(fmt::format("--merge: {} of {} drops are in none of the folders: a shard is missing", open,
                                 whole.cells.size()));
  const Subject subject = subject_in(a.merge[0], whole.header, run);
  AtlasResult r = result_of(subject);
  r.atlas = std::move(whole);
  r.drops = AtlasShard().drops(r.atlas.header.grid);  // all
  r.resumed = r.atlas.cells.size();
  find_safest(r, *subject.robot, common, run);
  return report(r, run);
}

/// The value of --height, --speed or --pitch-deg with --ask.
double single_value(const char* option, const std::string& text, double unit, double fallback) {
  const double value = text.empty() ? fallback : to_number(option, text) / unit;
  if (!std::isfinite(value)) throw InputError(std::string(option) + ": a finite number is needed");
  return value;
}

/// The drop of --ask; `fallback`: that of the scene.
Drop drop_of(const AtlasArguments& a, const Drop& fallback) {
  return {.height = single_value("--height", a.height, 1, fallback.height),
          .forward_speed = single_value("--speed", a.speed, 1, fallback.forward_speed),
          .pitch = single_value("--pitch-deg", a.pitch, kDegrees, fallback.pitch)};
}

AtlasReaderOptions reading_of(Goal goal) {
  return {.goal = goal, .accuracy = 1e-7, .deadline = 600};  // long: no robot is falling
}

/// What an atlas says of the scene's drop, without peaks and motion.toml.
template <class Scene, class Entry>
AtlasLookup lookup_of(const Scene& scene, const Entry& entry, const AtlasArguments& a) {
  AtlasLookup out{
      .scene = scene.name, .drop = scene.drop, .inside = entry.inside, .found = entry.found, .holds = entry.holds};
  out.goal = a.goal == Goal::kPeak ? "peak" : "tolerant peak", out.value = entry.value;
  if (!entry.found) return out;
  if (!entry.holds) out.planned = MappedAtlas(in(a.ask, kBinary)).header().grid.drop(entry.drop);
  out.motion = motion_json(scene.robot, entry.motion), out.motion_words = motion_words(scene.robot, entry.motion);
  return out;
}

AtlasLookup ask_body(const AtlasArguments& a, Run& run) {
  BodyScene scene = body_of(in(a.ask, "scene.toml"), {}, run);
  BodyAtlasReader reader(in(a.ask, kBinary), scene, reading_of(a.goal));
  const Drop drop = drop_of(a, scene.drop);
  const auto single = [](double x) { return AtlasAxis{x, x, 1}; };
  BodyAtlas(scene).validate({{single(drop.height), single(drop.forward_speed), single(drop.pitch)}});
  scene.drop = drop;
  const BodyAtlasEntry entry = reader.at(scene.drop);
  if (!entry.wrong.empty()) throw InputError("--ask: " + entry.wrong);
  AtlasLookup out = lookup_of(scene, entry, a);
  out.unit = unit_of(scene);
  if (!entry.found) return out;
  out.peak = simulate(scene, entry.motion).peak, out.held = simulate(scene, held_posture(scene)).peak;
  out.motion_toml = body_motion_toml(entry.motion, scene.robot, run.provenance_text());
  return out;
}

AtlasLookup ask_two_link(const AtlasArguments& a, Run& run) {
  const std::string file = in(a.ask, "actuator.toml");
  run.input(file);
  Scene scene = scene_of(in(a.ask, "scene.toml"), run);
  const SeaParameters<double> sea = read_actuator(file).sea;
  AtlasReader reader(in(a.ask, kBinary), scene, sea, reading_of(a.goal));
  scene.drop = drop_of(a, scene.drop);
  scene.validate();
  const AtlasEntry entry = reader.at(scene.drop);
  AtlasLookup out = lookup_of(scene, entry, a);
  if (!entry.found) return out;
  out.peak = simulate(scene, entry.sea, entry.motion).peak;
  out.held = entry.holds ? out.peak : simulate(scene, sea, kHeld).peak;
  out.motion_toml = to_toml(entry.motion, run.provenance_text());
  return out;
}

int run_ask(const AtlasArguments& a, const CommonOptions& common) {
  if (!a.merge.empty() || !a.scene.empty() || !a.actuators.empty() || !a.shard.empty() || a.robust || a.evaluations ||
      a.limited())
    throw InputError(
        "--ask: SCENE, --actuator, --merge, --shard, --robust, --evaluations, --forbid, --respect-ratings have no "
        "effect: "
        "the atlas has");
  Run run(kAtlasOutputs, common);
  run.input(in(a.ask, kBinary));
  return report(is_of_links(in(a.ask, "scene.toml")) ? ask_body(a, run) : ask_two_link(a, run), run);
}

int run_atlas(const AtlasArguments& a, const CommonOptions& common) {
  if (!a.ask.empty()) return run_ask(a, common);
  return a.merge.empty() ? run_plan(a, common) : run_merge(a, common);
}

void add_atlas(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<AtlasArguments>();
  verb->add_option("SCENE", args->scene, "scene file (TOML); its drop has no effect");
  add_actuators(*verb, args->actuators);
  verb->add_option("--height", args->height, "LO:HI:N, heights of the drops [m]");
  verb->add_option("--speed", args->speed, "LO:HI:N, forward speeds [m/s]; not of a robot on a rail");
  verb->add_option("--pitch-deg", args->pitch,
                   "LO:HI:N, pitches of the thigh, of a robot of links of its first link [deg]; not on a rail");
  add_objective(*verb, args->goal);
  verb->add_option("--evaluations", args->evaluations,
                   "motions tried for each drop [3000; tolerant 1000]; with --robust landings [12000]; of a robot of "
                   "links in proportion to the variables of its motions, of which the paper's has 3");
  add_freedom(*verb, args->freedom);
  verb->add_option("--robust", args->robust,
                   "plan for drops that scatter about each of the grid: mean, cvar, quantile:Q or worst");
  add_scatter(*verb, args->scatter);
  add_samples(*verb, args->samples);
  verb->add_option("--forbid", args->forbid,
                   "contacts that must never touch; the paper's robot is then one of links, as with [[load]]")
      ->delimiter(',');
  verb->add_flag("--respect-ratings", args->ratings,
                 "keep the references' rates, the motors' speeds and torques within the drives' ratings; likewise");
  verb->add_option("--shard", args->shard, "K/N: only part K of N of the grid's blocks");
  verb->add_option("--merge", args->merge, "folders of all shards of an atlas: puts them together");
  verb->add_option("--ask", args->ask,
                   "folder of an atlas: its motion for the drop of --height, --speed and --pitch-deg, a number each "
                   "[the scene's]");
  add_action<AtlasArguments>(*verb, args,
                             "ukemi atlas scene.toml --actuator actuator.toml --height 0.1:1:10 --speed -1:2:13 "
                             "--pitch-deg -40:40:17 -o out",
                             chosen, run_atlas);
}

const Verb atlas_verb(VerbGroup::kLandings, "atlas",
                      "the best motion for every drop of a grid: the table a robot carries", add_atlas);

}  // namespace

}  // namespace ukemi::tools
