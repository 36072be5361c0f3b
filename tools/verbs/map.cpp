// ukemi map.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "landing/judge/survey.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct MapArguments {
  std::string scene, actuator;
  std::vector<int> grid{64, 64, 32};
  int polish = MapOptions().polished;
};

int run_map(const MapArguments& a, const CommonOptions& common) {
  Run run("map", common);
  const Scene scene = read_scene(a.scene);
  run.input(a.scene);
  const Actuator actuator = actuator_of(a.actuator, run);
  if (a.grid.size() != 3) throw InputError("--grid: three numbers are needed, as in 64,64,32");
  for (const int n : a.grid)
    if (n < 2) throw InputError(fmt::format("--grid: {}: at least 2 points along each variable are needed", n));
  SurveyOptions options{.basins = run.monitor("map: basins"), .evidence = run.monitor("map: evidence")};
  MapOptions& map = options.map;
  map.cells = a.grid;
  map.polished = a.polish, map.seed = common.seed, map.threads = common.threads;
  map.monitor = run.monitor("map: rows");
  return report(survey(scene, QuinticSpace(scene.search, actuator.sea), options), run);
}

}  // namespace

void add_map(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<MapArguments>();
  CLI::App* verb = app.add_subcommand("map", "the whole box of motions on a grid, and its basins");
  verb->add_option("SCENE", args->scene, "scene file (TOML)")->required();
  verb->add_option("--actuator", args->actuator, "actuator file (TOML)")->required();
  verb->add_option("--grid", args->grid, "points of phi_I, phi_F and duration [64,64,32]")->delimiter(',');
  verb->add_option("--polish", args->polish, "how many of the grid's local minima are searched from close by [24]");
  add_action<MapArguments>(*verb, args, "ukemi map scene.toml --actuator actuator.toml --grid 64,64,32 -o out", chosen,
                           run_map);
}

}  // namespace ukemi::tools
