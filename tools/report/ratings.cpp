#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "landing/judge/speed.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"

namespace ukemi::tools {

const Outputs kRatingsOutputs{"ratings", {"ratings.csv"}, {"ratings"}};

using namespace landing;

namespace {

Json peak_of(const Optimum& o) { return o.found ? Json(o.value) : Json(); }

Quantities<RatedPlan> rating_quantities(const std::vector<RatedPlan>& plans) {
  Quantities<RatedPlan> out = {
      {"motor_speed", "motor_speed", "motor speed [rad/s]", "{:.4g}", &RatedPlan::speed},
      {"motor_torque", "motor_torque", "motor torque [Nm]", "{:.4g}",
       [](auto& p) { return std::isfinite(p.torque) ? Json(p.torque) : Json(); }},
      {"peak", "peak_acceleration", "best peak [m/s^2]", "{:.1f}", [](auto& p) { return peak_of(p.lowest); }},
      {"tolerant_peak", "tolerant_peak", "best tolerant peak [m/s^2]", "{:.1f}",
       [](auto& p) { return peak_of(p.tolerant); }}};
  const auto found = std::find_if(plans.begin(), plans.end(), [](auto& p) { return p.tolerant.found; });
  if (found != plans.end())
    append(
        out, "motion/", motion_quantities(found->tolerant.motion), [](const RatedPlan& p) { return p.tolerant.motion; },
        [](const RatedPlan& p) { return p.tolerant.found; });
  return out;
}

/// A curve over motor speed for each motor torque.
std::vector<Series> curves(const std::vector<RatedPlan>& plans, const char* what, Optimum RatedPlan::*best) {
  std::map<double, Series> by_torque;
  for (const RatedPlan& p : plans) {
    Series& s = by_torque[p.torque];
    s.name = std::isfinite(p.torque) ? fmt::format("{}, {:.3g} Nm", what, p.torque) : what;
    if ((p.*best).found) s.x.push_back(p.speed), s.y.push_back((p.*best).value);
  }
  std::vector<Series> out;
  for (auto& [torque, s] : by_torque) out.push_back(s);
  return out;
}

}  // namespace

int report(const Scene& scene, const std::vector<RatedPlan>& plans, Run& run) {
  const Table table(rating_quantities(plans), plans);
  long missing = 0;
  for (const RatedPlan& p : plans) missing += !p.lowest.found || !p.tolerant.found;
  if (missing > 0)
    run.warn(fmt::format("{} of {} ratings: no motion was found that keeps them in the whole execution box", missing,
                         plans.size()));
  Report page("What speed buys: " + scene.name);
  page.paragraph(
      "The best motions of a motor with these ratings, which hold wherever the motion may end within the scene's "
      "execution tolerance. The motion beside them is that of the tolerant peak.");
  Json summary = {{"ratings", add_table(table, page, run, "ratings.csv",
                                        "The motion is that of the tolerant peak. Units: rad/s, Nm, m/s^2, deg, s.")}};
  std::vector<Series> series = curves(plans, "peak", &RatedPlan::lowest);
  for (Series& s : curves(plans, "tolerant peak", &RatedPlan::tolerant)) series.push_back(std::move(s));
  page.plot("ratings", "motor speed [rad/s]", "peak of |ddr_0| [m/s^2]", series);
  FirstScreen first{.sentence = "No motor of these keeps its ratings."};
  const auto lowest = std::min_element(plans.begin(), plans.end(), [](const RatedPlan& a, const RatedPlan& b) {
    return a.tolerant.found && (!b.tolerant.found || a.tolerant.value < b.tolerant.value);
  });
  if (lowest != plans.end() && lowest->tolerant.found)
    first.sentence = fmt::format("The softest of {} motors lands with at most {:.4g} m/s^2: {:.4g} rad/s.",
                                 plans.size(), lowest->tolerant.value, lowest->speed);
  first.checks = {check(missing == 0, "every motor has a motion",
                        fmt::format("{} of {}", long(plans.size()) - missing, plans.size()))};
  first.next = "`ukemi optimize` with the chosen ratings in the actuator's file plans the landing.";
  page.answer(first, run.warnings());
  page.distrust(run.warnings());
  page.write(run);
  return run.finish(summary, missing == long(plans.size()) ? kNumbers : kDone);
}

}  // namespace ukemi::tools
