#include "tools/report/atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

std::string goal_of(const AtlasHeader& h) {
  if (Goal(h.goal) == Goal::kRobust) return Measure{Measure::Kind(h.measure), h.level}.name();
  return Goal(h.goal) == Goal::kPeak ? "peak" : "tolerant peak";
}

std::string atlas_csv(const AtlasResult& r, const Run& run) {
  const AtlasHeader& h = r.atlas.header;
  CsvWriter csv = run.csv();
  csv.comment("goal: " + goal_of(h) + " [m/s^2]; a drop without a motion: none was found that can be followed.");
  std::vector<std::string> header = {"height", "forward_speed", "pitch_deg"};
  const std::vector<Variable> variables = ReferenceSpace(r.scene, r.actuator.sea).variables();
  std::vector<double> factor;
  for (const Variable& v : variables) {
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

/// The goal over speed and pitch at one height.
Heatmap at_height(const Atlas& atlas, std::size_t height) {
  const AtlasGrid& grid = atlas.header.grid;
  Heatmap out{.x_label = "pitch [deg]", .y_label = "forward speed [m/s]"};
  for (std::size_t k = 0; k < grid.axes[2].count; ++k) out.x.push_back(grid.axes[2].at(k) * kDegrees);
  for (std::size_t j = 0; j < grid.axes[1].count; ++j) {
    out.y.push_back(grid.axes[1].at(j));
    for (std::size_t k = 0; k < grid.axes[2].count; ++k) {
      const AtlasCell& c = atlas.cells[grid.index({height, j, k})];
      out.values.push_back(c.planned() ? c.value : std::nan(""));
    }
  }
  return out;
}

/// The best, the middle and the worst of the drops with a motion.
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

void picture(Report& page, const Atlas& atlas) {
  constexpr std::size_t kPictures = 6;
  const AtlasAxis& heights = atlas.header.grid.axes[0];
  const std::size_t n = std::min<std::size_t>(kPictures, heights.count);
  for (std::size_t p = 0; p < n; ++p) {
    const std::size_t i = p * (heights.count - 1) / (n - 1);
    page.heading(fmt::format("Dropped from {:.3g} m: {} [m/s²]", heights.at(i), goal_of(atlas.header)));
    page.heatmap(at_height(atlas, i));
  }
}

}  // namespace

int report(const AtlasResult& r, Run& run) {
  const Atlas& atlas = r.atlas;
  const AtlasHeader& h = atlas.header;
  const bool finished = r.journal.empty();
  const std::string said = fmt::format("{} drops: {} planned, {} without a motion; {} were planned before",
                                       r.drops.size(), atlas.planned(), atlas.none(), r.resumed);
  run.say(said);
  if (atlas.none() > 0)
    run.warn(fmt::format("{} drops: no motion was found that can be followed with the joint held", atlas.none()));
  Json summary = {{"goal", goal_of(h)},         {"drops", r.drops.size()},
                  {"planned", atlas.planned()}, {"without_motion", atlas.none()},
                  {"resumed", r.resumed},       {"blocks", h.grid.blocks()},
                  {"range", range_json(r)}};
  if (!r.shard.empty()) summary["shard"] = r.shard;
  const bool safe = finished && h.safest.drop != SafestMotion::kNoDrop && atlas.open() == 0;
  if (safe) {
    summary["safest"] = drop_json(h.grid.drop(h.safest.drop));
    summary["safest"]["worst_peak"] = h.safest.worst;
    run.say(fmt::format("the safest motion over all drops: worst peak {:.1f} m/s^2", h.safest.worst));
  }
  run.add("atlas.csv", atlas_csv(r, run));
  run.add("scene.toml", r.scene_toml);
  run.add("actuator.toml", r.actuator_toml);
  if (finished)
    run.add("atlas.bin", atlas_bytes(atlas));
  else
    run.add("atlas.part", r.journal);

  Report page("Atlas of landings: " + r.scene.name);
  page.paragraph(said + ". White: no motion, or not planned here.");
  if (safe)
    page.paragraph(fmt::format("The safest motion over all drops has a worst peak of {:.1f} m/s².", h.safest.worst));
  picture(page, atlas);
  page.answer({fmt::format("{} of {} drops have a planned landing{}", atlas.planned(), r.drops.size(),
                           safe ? fmt::format("; the safest motion over all of them has a worst peak of {:.4g} m/s².",
                                              h.safest.worst)
                                : "."),
               {check(finished, "finished", finished ? "" : "the same command goes on with it"),
                check(atlas.none() == 0, "every drop has a motion", fmt::format("{} without", atlas.none()))},
               "atlas.bin is what a robot looks its motions up in."},
              run.warnings());
  page.distrust(run.warnings());
  page.write(run);
  return run.finish(summary, atlas.planned() > 0 ? kDone : kNumbers);
}

}  // namespace ukemi::tools
