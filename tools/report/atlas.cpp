#include "tools/report/atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"

namespace ukemi::tools {

const Outputs kAtlasOutputs{"atlas",
                            {"atlas.csv", "atlas.bin", "atlas.part", "scene.toml", "actuator.toml", "motion.toml"}};

using namespace landing;

namespace {

std::string goal_of(const AtlasHeader& h) {
  if (Goal(h.goal) == Goal::kRobust) return Measure{Measure::Kind(h.measure), h.level}.name();
  return Goal(h.goal) == Goal::kPeak ? "peak" : "tolerant peak";
}

std::string atlas_csv(const AtlasResult& r, const Run& run) {
  const AtlasHeader& h = r.atlas.header;
  CsvWriter csv = run.csv();
  csv.comment("goal: " + goal_of(h) + " [" + r.unit +
              "]; a drop without a motion: none was found that can be followed.");
  std::vector<std::string> header = {"height", "forward_speed", "pitch_deg"};
  std::vector<double> factor;
  for (const Variable& v : r.variables) {
    const Display d = display(v);
    header.push_back(d.key), factor.push_back(d.factor);
  }
  header.insert(header.end(), {"goal", "peak", "tolerant_peak"});
  csv.header(header);
  for (const std::size_t i : r.drops) {
    const AtlasCell& c = r.atlas.cells[i];
    if (c.state == AtlasCell::State::kOpen) continue;
    const Drop d = h.grid.drop(i);
    csv.cell(d.height).cell(d.forward_speed).cell(d.pitch * kDegrees);
    const double none = std::nan("");
    for (std::size_t k = 0; k < factor.size(); ++k) csv.cell(c.planned() ? c.values[k] * factor[k] : none);
    for (const double v : {c.value, c.peak, c.tolerant_peak}) csv.cell(c.planned() ? v : none);
    csv.end_row();
  }
  return csv.text();
}

Json drop_json(const Drop& d) {
  return {{"height", d.height}, {"forward_speed", d.forward_speed}, {"pitch_deg", d.pitch * kDegrees}};
}

/// Values of an axis times `factor`.
std::vector<double> shown(const AtlasAxis& axis, double factor) {
  std::vector<double> out;
  for (std::size_t i = 0; i < axis.count; ++i) out.push_back(factor * axis.at(i));
  return out;
}
struct AxisWords {
  const char* label;
  double factor;
};
constexpr std::array<AxisWords, AtlasGrid::kAxes> kAxisWords = {
    {{"height [m]", 1}, {"forward speed [m/s]", 1}, {"pitch [deg]", kDegrees}}};

double goal_at(const Atlas& atlas, const AtlasGrid::Place& at) {
  const AtlasCell& c = atlas.cells[atlas.header.grid.index(at)];
  return c.planned() ? c.value : std::nan("");
}

/// Heat map of the goal over axes x and y; the third is fixed at its index in `at`.
Heatmap goal_map(const Atlas& atlas, AtlasGrid::Place at, std::size_t x, std::size_t y) {
  const auto& axes = atlas.header.grid.axes;
  Heatmap out{.x_label = kAxisWords[x].label,
              .y_label = kAxisWords[y].label,
              .x = shown(axes[x], kAxisWords[x].factor),
              .y = shown(axes[y], kAxisWords[y].factor)};
  for (at[y] = 0; at[y] < axes[y].count; ++at[y])
    for (at[x] = 0; at[x] < axes[x].count; ++at[x]) out.values.push_back(goal_at(atlas, at));
  return out;
}

/// Curve of the goal along one axis.
Series goal_line(const Atlas& atlas, std::size_t x) {
  const AtlasAxis& axis = atlas.header.grid.axes[x];
  Series out;
  out.x = shown(axis, kAxisWords[x].factor);
  AtlasGrid::Place at{};
  for (at[x] = 0; at[x] < axis.count; ++at[x]) out.y.push_back(goal_at(atlas, at));
  return out;
}

/// Best, median and worst of the drops with a motion.
Json range_json(const AtlasResult& r) {
  std::vector<std::size_t> planned;
  for (const std::size_t i : r.drops)
    if (r.atlas.cells[i].planned()) planned.push_back(i);
  if (planned.empty()) return {};
  std::stable_sort(planned.begin(), planned.end(),
                   [&](auto a, auto b) { return r.atlas.cells[a].value < r.atlas.cells[b].value; });
  Json out;
  for (const auto& [name, i] :
       {std::pair{"softest", planned.front()}, {"median", planned[planned.size() / 2]}, {"hardest", planned.back()}}) {
    out[name] = drop_json(r.atlas.header.grid.drop(i));
    out[name]["goal"] = r.atlas.cells[i].value;
  }
  return out;
}

/// Heat maps at some heights; of two varied axes one map, of one a curve.
void add_goal_figures(Report& page, const AtlasResult& r) {
  const Atlas& atlas = r.atlas;
  constexpr std::size_t kMaxMaps = 6;
  const auto& axes = atlas.header.grid.axes;
  std::vector<std::size_t> varied;
  for (std::size_t k = 0; k < axes.size(); ++k)
    if (!axes[k].stands()) varied.push_back(k);
  const std::string what = goal_of(atlas.header);
  if (varied.size() == 1) {
    page.heading(fmt::format("The {} of each drop", what));
    page.plot("goal", kAxisWords[varied[0]].label, fmt::format("{} [{}]", what, r.unit), {goal_line(atlas, varied[0])});
  } else if (varied.size() == 2) {
    page.heading(fmt::format("The {} of each drop [{}]", what, r.unit));
    page.heatmap(goal_map(atlas, {}, varied[1], varied[0]));
  } else if (varied.size() == 3) {
    const AtlasAxis& heights = axes[0];
    const std::size_t n = std::min<std::size_t>(kMaxMaps, heights.count);
    for (std::size_t p = 0; p < n; ++p) {
      const std::size_t i = p * (heights.count - 1) / (n - 1);
      page.heading(fmt::format("Dropped from {:.3g} m: {} [{}]", heights.at(i), what, r.unit));
      page.heatmap(goal_map(atlas, {i, 0, 0}, 2, 1));
    }
  }
}

}  // namespace

int report(const AtlasResult& r, Run& run) {
  const Atlas& atlas = r.atlas;
  const AtlasHeader& h = atlas.header;
  const bool finished = r.journal.empty();
  const std::string counts = fmt::format("{} drops: {} planned, {} without a motion; {} were planned before",
                                         r.drops.size(), atlas.planned(), atlas.none(), r.resumed);
  run.say(counts);
  if (atlas.none() > 0)
    run.warn(fmt::format("{} drops: no motion was found that can be followed with the joint held", atlas.none()));
  Json summary = {{"goal", goal_of(h)},         {"drops", r.drops.size()},
                  {"planned", atlas.planned()}, {"without_motion", atlas.none()},
                  {"resumed", r.resumed},       {"blocks", h.grid.blocks()},
                  {"range", range_json(r)}};
  if (!r.shard.empty()) summary["shard"] = r.shard;
  const bool safest = finished && h.safest.drop != SafestMotion::kNoDrop && atlas.open() == 0;
  if (safest) {
    summary["safest"] = drop_json(h.grid.drop(h.safest.drop));
    summary["safest"]["worst_peak"] = h.safest.worst;
    run.say(fmt::format("the safest motion over all drops: worst peak {:.4g} {}", h.safest.worst, r.unit));
  }
  run.add("atlas.csv", atlas_csv(r, run));
  if (!r.scene_toml.empty()) run.add("scene.toml", r.scene_toml);
  if (!r.actuator_toml.empty()) run.add("actuator.toml", r.actuator_toml);
  if (finished)
    run.add("atlas.bin", atlas_bytes(atlas));
  else
    run.add("atlas.part", r.journal);

  Report page("Atlas of landings: " + r.scene);
  page.paragraph(counts + ". White: no motion, or not planned here.");
  if (safest)
    page.paragraph(
        fmt::format("The safest motion over all drops has a worst peak of {:.4g} {}.", h.safest.worst, r.unit));
  add_goal_figures(page, r);
  page.answer({fmt::format("{} of {} drops have a planned landing{}", atlas.planned(), r.drops.size(),
                           safest ? fmt::format("; the safest motion over all of them has a worst peak of {:.4g} {}.",
                                                h.safest.worst, r.unit)
                                  : "."),
               {check(finished, "finished", finished ? "" : "the same command goes on with it"),
                check(atlas.none() == 0, "every drop has a motion", fmt::format("{} without", atlas.none()))},
               "atlas.bin is what a robot looks its motions up in."},
              run.warnings());
  page.distrust(run.warnings());
  page.write(run);
  return run.finish(summary, atlas.planned() > 0 ? kDone : kNumbers);
}

int report(const AtlasLookup& a, Run& run) {
  Json summary = {{"drop", drop_json(a.drop)}, {"found", a.found}, {"inside", a.inside}};
  Report page("An atlas asked: " + a.scene);
  if (!a.found) {
    const char* none = "the atlas has no motion for this drop, and none that lands all of its own";
    run.warn(none), page.paragraph(none);
  } else {
    if (!a.inside) run.warn("the grid does not reach this drop: the motion that is safest over all of its own");
    const std::string said =
        fmt::format("{}: {} {:.4g} {}{}; held {}", a.motion_words, a.goal, a.value, a.unit,
                    a.goal == "peak" ? "" : fmt::format(", peak {} m/s^2", peak_words(a.peak)), peak_words(a.held));
    run.say(said), page.paragraph(said + ".");
    if (a.holds) run.warn("no motion of the drops around lands as softly here as the held posture: that is the answer");
    if (!a.holds) summary["planned_for"] = drop_json(a.planned);
    summary["holds"] = a.holds;
    summary["motion"] = a.motion, summary["objective"] = a.goal, summary["goal"] = a.value;
    summary["peak_acceleration"] = a.peak, summary["hold"] = {{"peak_acceleration", a.held}};
    run.add("motion.toml", a.motion_toml);
  }
  page.distrust(run.warnings());
  page.write(run);
  return run.finish(summary, a.found ? kDone : kNumbers);
}

}  // namespace ukemi::tools
