// ukemi map of a robot of links.
#include <fmt/format.h>

#include <algorithm>

#include "common/error.hpp"
#include "landing/plan/body_map.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/body.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// Points along each variable: those of NAME[:N],...; 1 where a variable is fixed.
std::vector<int> cells_of(const std::string& text, const BodySpace& space) {
  std::vector<std::string> names;
  for (const Variable& v : space.variables()) names.push_back(v.name);
  if (text.empty())
    throw InputError(fmt::format("map: --vary NAME[:N],... is needed: one to three of {}", fmt::join(names, ", ")));
  const std::vector<std::string> items = split(text);
  if (items.size() > 3)
    throw InputError(fmt::format("--vary: {} variables: one to three are needed, the others stand", items.size()));
  std::vector<int> out(names.size(), 1);
  for (const std::string& item : items) {
    const std::size_t colon = item.find(':');
    int& points = out[choice_index("--vary", item.substr(0, colon), names)];
    if (points > 1) throw InputError("--vary: " + quoted(item) + ": the variable is given twice");
    const double n =
        colon == std::string::npos ? (items.size() < 3 ? 64 : 24) : to_number("--vary", item.substr(colon + 1));
    if (!(n >= 2 && n <= 4096 && n == std::floor(n)))
      throw InputError("--vary: " + quoted(item) + ": a whole number of points from 2 to 4096 is needed");
    points = int(n);
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
  map.cells = cells_of(a.vary, space);
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
