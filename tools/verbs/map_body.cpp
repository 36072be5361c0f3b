// ukemi map of a robot of links.
#include "common/error.hpp"
#include "landing/plan/body_map.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/body.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

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

}  // namespace

int map_body(const MapArguments& a, const CommonOptions& common) {
  Run run(kMapOutputs, common);
  if (!a.grid.empty()) throw InputError("--grid: of a robot of links --vary NAME[:N],... says what goes over the grid");
  BodyScene scene = body_of(a.scene, a.actuators, run, "--actuator", {}, a.set);
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
  map.polished = a.polish, map.seed = common.seed, map.threads = common.threads;
  map.monitor = run.monitor("map", "landings");
  return report(survey(scene, options), run);
}

}  // namespace ukemi::tools
