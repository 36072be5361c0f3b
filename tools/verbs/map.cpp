// ukemi map.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/judge/survey.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_map.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/body.hpp"
#include "tools/verbs/freedom.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct MapArguments : SceneArguments {
  std::string slice, vary;
  std::vector<int> grid;  ///< paper's robot only; empty: default
  FreedomArguments freedom;
  int polish = MapOptions().polished;
};

/// Sets what maps of both kinds of robot share; `of`: what the map's progress counts.
void set_options(const MapArguments& a, const CommonOptions& common, const char* of, const Run& run, MapOptions& map) {
  map.polished = a.polish, map.seed = common.seed, map.threads = common.threads;
  map.monitor = run.monitor("map", of);
}

/// The variables of a motion file. Throws InputError where one is outside its range.
Coordinates slice_of(const std::string& path, const ReferenceSpace& space) {
  const Coordinates x = space.values_of(read_motion(path));
  for (int k = 0; k < space.dimension(); ++k)
    if (const Variable& v = space.variables()[std::size_t(k)]; !(x[k] >= v.lower && x[k] <= v.upper))
      throw InputError({path}, fmt::format("--slice: {} = {:.6g} {}: {:.6g} to {:.6g} is needed", v.name, x[k], v.unit,
                                           v.lower, v.upper));
  return x;
}

/// Parses NAME[:N],...
std::vector<GridAxis> grid_of(const std::string& text) {
  std::vector<GridAxis> out;
  for (const std::string& item : split(text)) {
    const std::size_t colon = item.find(':');
    out.push_back({item.substr(0, colon), {}});
    if (colon != std::string::npos) out.back().points = to_number("--vary", item.substr(colon + 1));
  }
  return out;
}

int map_body(const MapArguments& a, const CommonOptions& common) {
  Run run(kMapOutputs, common);
  if (!a.grid.empty()) throw InputError("--grid: of a robot of links --vary NAME[:N],... says what goes over the grid");
  BodyScene scene = body_of(a, run);
  apply_freedom(a.freedom, scene, run);
  const BodySpace space(scene);
  SurveyOptions options{.basins = run.monitor("map: basins", "searches")};
  MapOptions& map = options.map;
  map.cells = cells_of(space, grid_of(a.vary), "--vary");
  map.slice = held_slice(space, scene);
  if (!a.slice.empty()) {
    run.input(a.slice);
    map.slice = slice_of(space, scene, read_body_motion(a.slice, scene.robot), {a.slice});
  }
  set_options(a, common, "landings", run, map);
  return report(survey(scene, options), run);
}

int run_map(const MapArguments& a, const CommonOptions& common) {
  if (is_of_links(a.scene)) return map_body(a, common);
  refuse_set(a.set);
  if (!a.vary.empty())
    throw InputError("--vary: the variables of a robot of links are named so; of the paper's robot --grid is needed");
  const std::string file = only_actuator(a.actuators);
  Run run(kMapOutputs, common);
  const Scene scene = scene_of(a.scene, a.freedom, run);
  const Actuator actuator = landing_actuator_of(file, run);
  const ReferenceSpace space(scene, actuator.sea);
  const bool slice = space.dimension() > kPaperVariables;
  SurveyOptions options{.basins = run.monitor("map: basins", "searches"),
                        .evidence = run.monitor("map: evidence", "basins")};
  MapOptions& map = options.map;
  if (!a.grid.empty()) map.cells = a.grid;
  if (slice ? map.cells.size() < kPaperVariables : map.cells.size() != kPaperVariables)
    throw InputError("--grid: three numbers are needed, as in 64,64,32");
  for (const int n : map.cells)
    if (n < (slice ? 1 : 2))
      throw InputError(fmt::format("--grid: {}: at least {} needed", n,
                                   slice ? "1 point along each variable is" : "2 points along each variable are"));
  if (!a.slice.empty()) {
    map.slice = slice_of(a.slice, space);
    run.input(a.slice);
  }
  set_options(a, common, "rows", run, map);
  return report(survey(scene, space, options), run);
}

void add_map(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<MapArguments>();
  add_scene(*verb, *args);
  verb->add_option("--grid", args->grid,
                   "points of phi_I, phi_F, duration and, if the motion has more, those; 1: held fixed [64,64,32]")
      ->delimiter(',');
  verb->add_option("--vary", args->vary,
                   "of a robot of links NAME[:N],...: one to three variables, as phi_i_hip, and points of each [64; of "
                   "three 24]");
  verb->add_option(
      "--slice", args->slice,
      "motion file: where variables without a grid stand [the middle of their ranges; of a robot of links the "
      "held posture]");
  add_freedom(*verb, args->freedom);
  verb->add_option("--polish", args->polish, "how many of the grid's local minima a search refines [24]");
  add_action<MapArguments>(*verb, args, "ukemi map scene.toml --actuator actuator.toml --grid 64,64,32 -o out", chosen,
                           run_map);
}

const Verb map_verb(VerbGroup::kLandings, "map", "the whole box of motions on a grid, and its basins", add_map);

}  // namespace

}  // namespace ukemi::tools
