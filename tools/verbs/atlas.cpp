// ukemi atlas.
#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <memory>

#include "common/error.hpp"
#include "common/files.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/report/atlas.hpp"
#include "tools/verbs/freedom.hpp"
#include "tools/verbs/scattering.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr const char *kBinary = "atlas.bin", *kJournal = "atlas.part";

struct AtlasArguments {
  std::string scene, actuator, height, speed, pitch, shard;
  std::vector<std::string> merge;
  Goal goal = Goal::kPeak;
  std::optional<long> evaluations;
  FreedomArguments freedom;
  std::optional<std::string> robust;  ///< a measure
  ScatterArguments scatter;
  std::optional<long> samples;
};

std::string in(const std::string& folder, const char* name) { return (std::filesystem::path(folder) / name).string(); }

AtlasAxis axis_of(const std::string& option, const std::string& text, double unit) {
  if (text.empty()) throw InputError(option + ": LO:HI:N is needed");
  const NumberRange r = number_range(option, text, true);
  return {r.lower / unit, r.upper / unit, std::uint64_t(r.count)};
}

/// Shard K of N as text: "2/3".
AtlasShard shard_of(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) throw InputError("--shard: " + quoted(text) + ": K/N is needed, as in 1/3");
  return {to_seed("--shard", text.substr(0, slash)), to_seed("--shard", text.substr(slash + 1))};
}

RobustOptions robust_of(const AtlasArguments& a, const Scene& scene, const Actuator& actuator, Run& run) {
  if (!a.scatter.drops.empty())
    throw InputError("--drops: the drops of an atlas are those of its grid: --scatter says how they scatter");
  if (!a.robust) {
    const char* given = a.samples           ? "--samples"
                        : a.scatter.scatter ? "--scatter"
                        : a.scatter.inflate ? "--inflate"
                                            : nullptr;
    if (given) throw InputError(fmt::format("{}: without --robust it has no say", given));
    return {};
  }
  const Scattering scattering = scattering_of(a.scatter, scene, actuator, run);
  RobustOptions out{
      .measure = Measure::parse("--robust", *a.robust), .scatter = scattering.scatter, .inflate = scattering.inflate};
  out.samples = a.samples.value_or(out.samples);
  if (!(out.samples >= 16 && out.samples <= 4096))
    throw InputError(fmt::format("--samples: {}: 16 to 4096 is needed", out.samples));
  return out;
}

AtlasOptions options_of(const AtlasArguments& a, const CommonOptions& common, const Scene& scene,
                        const Actuator& actuator, Run& run) {
  AtlasOptions out;
  out.grid.axes = {axis_of("--height", a.height, 1), axis_of("--speed", a.speed, 1),
                   axis_of("--pitch-deg", a.pitch, kDegrees)};
  if (!a.shard.empty()) out.shard = shard_of(a.shard);
  out.search.goal = a.goal, out.search.evaluations = a.evaluations;
  out.search.seed = common.seed, out.search.threads = common.threads;
  out.robust = robust_of(a, scene, actuator, run);
  out.validate();
  return out;
}

/// What the folder has of this atlas already: a finished one, of which only the shard's drops are kept.
void take_finished(const std::string& path, const std::string& identity, const std::vector<std::size_t>& drops,
                   std::vector<AtlasCell>& cells) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) return;
  try {
    const MappedAtlas there(path);
    if (std::string_view(there.header().identity, sizeof there.header().identity) != identity) return;
    for (const std::size_t i : drops) cells[i] = there.cells()[i];
  } catch (const InputError&) {  // a file that is not an atlas is replaced like every earlier result
  }
}

/// Finds the safest motion of an atlas, once all its drops are planned.
void find_safest(AtlasResult& r, const CommonOptions& common, const Run& run) {
  r.atlas.header.safest = {};
  if (r.atlas.open() == 0)
    r.atlas.header.safest = safest_motion(r.scene, r.actuator.sea, r.atlas.header.grid, r.atlas.cells, common.threads,
                                          run.monitor("atlas: the safest motion"));
}

std::vector<std::size_t> all_drops(const AtlasGrid& grid) { return AtlasShard().drops(grid); }

int run_plan(const AtlasArguments& a, const CommonOptions& common) {
  Run run("atlas", common);
  if (a.scene.empty() || a.actuator.empty()) throw InputError("atlas: SCENE and --actuator are needed, or --merge");
  AtlasResult r{.scene = scene_of(a.scene, a.freedom, run), .actuator = landing_actuator_of(a.actuator, run)};
  AtlasOptions options = options_of(a, common, r.scene, r.actuator, run);
  r.scene_toml = to_toml(r.scene, ""), r.actuator_toml = to_toml(r.actuator);
  r.shard = a.shard;
  r.drops = options.shard.drops(options.grid);
  r.atlas.header = atlas_header(r.scene, r.actuator, options);
  r.atlas.cells.resize(options.grid.size());
  const std::string identity = atlas_identity(r.scene, r.actuator, options), folder = run.options().folder;
  take_finished(in(folder, kBinary), identity, r.drops, r.atlas.cells);
  AtlasJournal journal(in(folder, kJournal), identity, r.atlas.cells);
  r.resumed = r.atlas.planned() + r.atlas.none();
  run.info(fmt::format("planning {} drops of {} in {} blocks, {} of them planned before", r.drops.size(),
                       options.grid.size(), options.grid.blocks(), r.resumed));
  options.done = [&](std::size_t drop, const AtlasCell& cell) { journal.add(drop, cell); };
  options.monitor = run.monitor("atlas");
  plan_atlas(r.scene, r.actuator, options, r.atlas.cells);
  find_safest(r, common, run);
  if (interrupted()) r.journal = journal.bytes();
  return report(r, run);
}

/// Takes the drops of a part. Throws InputError where another part has different motions for them.
void take_part(const Atlas& part, const std::string& path, Atlas& whole) {
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

int run_merge(const AtlasArguments& a, const CommonOptions& common) {
  Run run("atlas", common);
  for (const auto& [option, text] : {std::pair{"SCENE", a.scene},
                                     {"--actuator", a.actuator},
                                     {"--shard", a.shard},
                                     {"--height", a.height},
                                     {"--speed", a.speed},
                                     {"--pitch-deg", a.pitch}})
    if (!text.empty()) throw InputError(std::string("--merge: ") + option + " has no say: the parts say it");
  AtlasResult r;
  for (const std::string& folder : a.merge) {
    const std::string path = in(folder, kBinary);
    run.input(path);
    const std::string bytes = read_binary_file(path);
    Atlas part = atlas_of(std::as_bytes(std::span(bytes)), path);
    if (r.atlas.cells.empty())
      r.atlas = std::move(part);
    else
      take_part(part, path, r.atlas);
  }
  if (const std::size_t open = r.atlas.open(); open > 0)
    throw InputError(fmt::format("--merge: {} of {} drops are in none of the folders: a shard is missing", open,
                                 r.atlas.cells.size()));
  const std::string scene = in(a.merge[0], "scene.toml"), actuator = in(a.merge[0], "actuator.toml");
  run.input(scene), run.input(actuator);
  r.scene_toml = read_text_file(scene), r.actuator_toml = read_text_file(actuator);
  r.scene = read_scene(scene), r.actuator = read_actuator(actuator);
  if (robot_checksum(r.scene, r.actuator.sea) != std::string_view(r.atlas.header.robot, sizeof r.atlas.header.robot))
    throw InputError({scene}, "scene.toml or actuator.toml beside it are not those of the atlas");
  r.drops = all_drops(r.atlas.header.grid);
  r.resumed = r.atlas.cells.size();
  find_safest(r, common, run);
  return report(r, run);
}

int run_atlas(const AtlasArguments& a, const CommonOptions& common) {
  return a.merge.empty() ? run_plan(a, common) : run_merge(a, common);
}

}  // namespace

void add_atlas(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<AtlasArguments>();
  CLI::App* verb = app.add_subcommand("atlas", "the best motion for every drop of a grid: the table a robot carries");
  verb->add_option("SCENE", args->scene, "scene file (TOML); its drop has no say");
  verb->add_option("--actuator", args->actuator, "actuator file (TOML)");
  verb->add_option("--height", args->height, "LO:HI:N, heights of the drops [m]");
  verb->add_option("--speed", args->speed, "LO:HI:N, forward speeds [m/s]");
  verb->add_option("--pitch-deg", args->pitch, "LO:HI:N, pitches of the thigh [deg]");
  add_choice<Goal>(*verb, "--objective", args->goal, {{"peak", Goal::kPeak}, {"tolerant", Goal::kTolerant}},
                   "peak, or tolerant: the worst peak within the scene's [execution] tolerance [peak]");
  verb->add_option("--evaluations", args->evaluations,
                   "motions tried for each drop [3000; tolerant 1000]; with --robust landings [12000]");
  add_freedom(*verb, args->freedom);
  verb->add_option("--robust", args->robust,
                   "plan for drops that scatter about each of the grid: mean, cvar, quantile:Q or worst");
  add_scatter(*verb, args->scatter);
  verb->add_option("--samples", args->samples, "with --robust, drops that are searched on, best a power of two [256]");
  verb->add_option("--shard", args->shard, "K/N: only part K of N of the grid's blocks");
  verb->add_option("--merge", args->merge, "folders of all shards of an atlas: puts them together");
  add_action<AtlasArguments>(*verb, args,
                             "ukemi atlas scene.toml --actuator actuator.toml --height 0.1:1:10 --speed -1:2:13 "
                             "--pitch-deg -40:40:17 -o out",
                             chosen, run_atlas);
}

}  // namespace ukemi::tools
