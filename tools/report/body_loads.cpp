// Report of the loads of a robot's parts.
#include <fmt/format.h>

#include "landing/body/load.hpp"
#include "tools/report/body.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct LoadRow {
  const Robot* robot;
  Load load;
  LoadPeak peak;
  bool binds;
};

const Quantities<LoadRow> kLoadQuantities = {
    {"", "load", "load", "{}", [](auto& r) { return r.load.name; }},
    {"", "kind", "kind", "{}", [](auto& r) { return name(r.load.kind); }},
    {"", "of", "of", "{}", [](auto& r) { return place_of(r.load, *r.robot); }},
    {"", "value", "value", "{:.6g}", [](auto& r) { return r.peak.value; }},
    {"", "rating", "rating", "{:.6g}", [](auto& r) { return r.load.rating; }},
    {"", "unit", "unit", "{}", [](auto& r) { return unit(r.load.kind); }},
    {"", "ratio", "value / rating", "{:.4g}",
     [](auto& r) { return r.load.rating > 0 ? Json(r.peak.value / r.load.rating) : Json(); }},
    {"", "time", "time [s]", "{:.6g}", [](auto& r) { return r.peak.t; }},
    {"", "limit", [](auto& r) { return r.load.limit; }},
    {"", "binds", [](auto& r) { return r.binds; }},
    {"", "", "state", "{}",
     [](auto& r) {
       const bool holds = r.peak.value <= r.load.rating;
       return r.load.limit ? holds ? "limit, holds" : "limit, broken" : r.binds ? "binds" : holds ? "" : "beyond";
     }},
};

/// By how much a load exceeds its limit.
std::string violation_words(const Load& l, double value, const Robot& robot) {
  if (l.kind == Load::Kind::kTouch) return place_of(l, robot) + " touches";
  const std::string amount = fmt::format("{:.4g} {}", value, unit(l.kind));
  if (l.kind == Load::Kind::kAngle && l.rating == 0) return amount + " outside of its range";
  return fmt::format("{}, rated {:.4g}", amount, l.rating);
}

}  // namespace

std::string exceeded_words(const Load& l) {
  if (l.kind == Load::Kind::kTouch) return "touches";
  if (l.kind == Load::Kind::kAngle && l.rating == 0) return "leaves its range";
  return fmt::format("is beyond {:.4g} {}", l.rating, unit(l.kind));
}

Json report_loads(const BodyScene& scene, const BodyLanding& landing, const std::string& whose, Report* report,
                  Run& run) {
  const std::vector<LoadPeak> peaks = loads_of(scene, landing);
  const int binds = binding(scene, landing);
  std::vector<LoadRow> rows;
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    rows.push_back({&scene.robot, scene.loads[i], peaks[i], int(i) == binds});
    if (report && scene.loads[i].limit && peaks[i].value > rating_limit(scene.loads[i], scene.robot))
      run.warn(fmt::format("the load {} is beyond its limit: {}", scene.loads[i].name,
                           violation_words(scene.loads[i], peaks[i].value, scene.robot)));
  }
  const Table table(kLoadQuantities, rows);
  if (report) {
    run.say("loads" + whose + ":");
    say(table, run);
    report->heading("Loads" + whose);
    report->table(table);
  }
  return table.objects();
}

}  // namespace ukemi::tools
