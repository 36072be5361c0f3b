#include "tools/report/scatter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/degrees.hpp"
#include "common/uncertainty.hpp"
#include "landing/model/scatter_file.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::tools {

using namespace landing;

Quantities<Distribution> distribution_quantities() {
  Quantities<Distribution> out;
  const auto measure = [&](const std::string& key, const std::string& words, Estimated Distribution::*value) {
    out.push_back({"", key, [value](auto& d) { return number((d.*value).value); }});
    out.push_back({"", key + "_std", [value](auto& d) { return number((d.*value).standard_error); }});
    out.push_back({"", "", words, "{}", [value](const Distribution& d) {
                     const auto [x, error] = d.*value;
                     return std::isnan(error) ? fmt::format("{:.4g}", x) : with_error(x, error);
                   }});
  };
  measure("mean", "mean", &Distribution::mean);
  measure("median", "median", &Distribution::median);
  measure("q90", "90 % below", &Distribution::q90);
  measure("q99", "99 % below", &Distribution::q99);
  measure("cvar90", "mean of the worst tenth", &Distribution::cvar90);
  out.push_back({"", "max", "largest", "{:.4g}", &Distribution::max});
  out.push_back({"", "samples", "drops", {}, &Distribution::samples});
  return out;
}

std::string distributed_words(const std::string& acceleration, bool rated) {
  return fmt::format("{} [{}]", rated ? goal_name(rated) : "peak " + acceleration, goal_unit(rated));
}

Quantities<NamedDistribution> named_quantities(const std::string& what) {
  Quantities<NamedDistribution> out = {{"", "", what, "{}", &NamedDistribution::name}};
  append(out, "", distribution_quantities(), &NamedDistribution::of);
  return out;
}

std::string goal_words(Goal goal, const std::optional<Measure>& measure) {
  const std::string plain = goal == Goal::kTolerant ? "tolerant peak" : "peak";
  return measure ? fmt::format("{} under scatter ({})", plain, measure->name()) : plain;
}
std::string goal_words(const AnswerOptions& options) {
  // A search under scatter with inexactly played drops has Goal::kTolerant.
  return goal_words(options.search.goal == Goal::kPeak ? Goal::kPeak : Goal::kTolerant, options.robust.measure);
}

std::string held_words() { return fmt::format("held at {:.0f} deg", kHeld.phi_i * kDegrees); }

std::string distribution_words(const Distribution& d) {
  return fmt::format("mean {}, worst tenth {}, 99 % below {}", short_peak_words(d.mean.value),
                     short_peak_words(d.cvar90.value), short_peak_words(d.q99.value));
}

void warn_of_assumed(const Scatter& scatter, Run& run) {
  run.warn(fmt::format("the scene has no [scatter]: {} is assumed; --scatter says it", text_of(scatter)));
}

void warn_of_floor(long drops, long of, Run& run) {
  if (drops > 0)
    run.warn(fmt::format("{} of {} scattered drops would begin below the floor: they begin on it", drops, of));
}

std::string band_words(const Estimated& e) {
  return std::isfinite(e.standard_error) ? fmt::format(" +- {:.2g}", kNormal975 * e.standard_error) : "";
}

std::string scatter_words(const std::optional<Scatter>& scatter, bool assumed) {
  return scatter ? text_of(*scatter) + (assumed ? "; assumed" : "") : "measured drops";
}

namespace {

/// Outline of a histogram [% of all drops].
Series histogram_outline(const std::string& name, const std::vector<PeakBin>& bins, long PeakBin::*count, long total) {
  Series out{name, {}, {}};
  const auto add = [&](double x, long n) { out.x.push_back(x), out.y.push_back(100.0 * double(n) / double(total)); };
  if (bins.empty() || total == 0) return out;
  add(bins.front().lower, 0);
  for (const PeakBin& b : bins) add(b.lower, b.*count), add(b.upper, b.*count);
  add(bins.back().upper, 0);
  return out;
}

}  // namespace

Json distribution_json(const Distribution& d) { return Table::of(distribution_quantities(), d).object(); }

Figure histogram_figure(const std::vector<PeakBin>& bins, const std::string& name, const Distribution& of,
                        const std::string& reference, long reference_samples, const std::string& what) {
  Figure out;
  out.name = "histogram";
  Panel p;
  p.x_label = what, p.y_label = "% of the drops";
  p.series = {histogram_outline(name, bins, &PeakBin::drops, of.samples),
              histogram_outline(reference, bins, &PeakBin::beside, reference_samples)};
  p.series[1].style = Series::Style::kDashed;
  double top = 0;
  for (const Series& s : p.series)
    for (const double y : s.y) top = std::max(top, y);
  for (const auto& [words, at] : {std::pair("50 %", of.median.value), {"90 %", of.q90.value}, {"99 %", of.q99.value}}) {
    if (!std::isfinite(at)) continue;
    p.series.push_back({"", {at, at}, {0, 0.85 * top}, Series::Style::kDashed, Series::kInk});
    p.marks.push_back({at, 0.85 * top, words});
  }
  out.panels = {p}, out.width = Figure::Width::kWhole, out.panel_height = 300;
  out.caption = "How the peak is distributed over the drops; so many of \"" + name + "\" are below each line";
  return out;
}

void show_scatter(const Answer& a, Report& report) {
  if (!a.scattered || !a.under_scatter || !a.nominal) return;
  const UnderScatter& u = *a.under_scatter;
  const std::string robust = "planned for scatter", nominal = "planned for the scene's own drop";
  report.heading("Under scatter");
  report.paragraph(
      fmt::format("Drops: {}. The same {} for each plan; they are others than those that were searched on.",
                  scatter_words(a.scatter, a.scatter_assumed), u.planned.samples));
  report.table(Table(named_quantities(),
                     {{robust, u.planned},
                      {nominal, *u.nominal},
                      {held_words(), u.held},
                      {fmt::format("best posture to hold, {:.1f} deg", u.posture_phi * kDegrees), u.posture}}));
  Figure figure = histogram_figure(u.histogram, robust, u.planned, nominal, u.nominal->samples);
  figure.caption += u.broken == 0 ? "."
                                  : fmt::format(". In {} drops the motion breaks a limit: they stand at {:g} m/s^2.",
                                                u.broken, a.options.robust.penalty);
  report.figure(figure);
}

Json scatter_json(const Answer& a) {
  Json out = Json::object();
  if (a.scattered) {
    Json& robust = out["robust"];
    robust = {{"measure", a.options.robust.measure->name()},
              {"promised", a.best.value},
              {"samples", a.options.robust.samples},
              {"penalty", a.options.robust.penalty}};
    if (a.promised) robust["promised_std"] = number(a.promised->standard_error);
    if (a.under_scatter) {
      const Estimated& u = a.under_scatter->measured;
      robust["fresh"] = distribution_json(a.under_scatter->planned);
      robust["fresh"]["measured"] = number(u.value), robust["fresh"]["measured_std"] = number(u.standard_error);
      robust["optimism"] = u.value / a.best.value - 1;
    }
  }
  if (const auto& u = a.under_scatter) {
    Json& scatter = out["scatter"];
    scatter = {{"deviations", a.scatter ? Json(text_of(*a.scatter)) : Json()},
               {"assumed", a.scatter_assumed},
               {"planned", distribution_json(u->planned)},
               {"held", distribution_json(u->held)},
               {"best_posture", distribution_json(u->posture)},
               {"broken", u->broken},
               {"joint_lost", u->lost},
               {"from_floor", u->from_floor}};
    if (u->nominal) {
      scatter["nominal"] = distribution_json(*u->nominal);
      scatter["nominal"]["motion"] = motion_json(a.nominal->motion);
    }
    scatter["best_posture"]["phi_deg"] = u->posture_phi * kDegrees;
  }
  return out;
}

void report_scatter(const Answer& a, Run& run) {
  if (a.options.robust.measure && !a.scattered) run.say("nothing scatters: this is the plan for the scene's own drop");
  if (!a.under_scatter) return;
  const UnderScatter& u = *a.under_scatter;
  const double posture = u.posture_phi * kDegrees;
  run.say(fmt::format("under scatter ({}; {} {} drops): {}; {}: {}; best posture to hold, {:.1f} deg: {}",
                      scatter_words(a.scatter, a.scatter_assumed), u.planned.samples, a.scatter ? "fresh" : "measured",
                      distribution_words(u.planned), held_words(), distribution_words(u.held), posture,
                      distribution_words(u.posture)));
  if (a.scattered)
    run.say(fmt::format("promised {}{}, fresh {} ({:+.1f} %)", short_peak_words(a.best.value),
                        a.promised ? band_words(*a.promised) : "", short_peak_words(u.measured.value),
                        100 * (u.measured.value / a.best.value - 1)));
  if (u.nominal)
    run.say(fmt::format("the plan for the scene's own drop, over the same drops: {}", distribution_words(*u.nominal)));
  if (u.broken > 0)
    run.warn(fmt::format("in {} of {} drops the motion breaks a limit; each counts as {:g} m/s^2", u.broken,
                         u.planned.samples, a.options.robust.penalty));
  warn_of_floor(u.from_floor, u.planned.samples, run);
  if (u.lost > 0)
    run.warn(fmt::format(
        "in {} of {} scattered drops the drive loses the joint: their peaks are those of a link that whirls", u.lost,
        u.planned.samples));
  const double worst = u.planned.cvar90.value;
  const bool tail = a.scattered && a.options.robust.measure->kind != Measure::Kind::kMean;
  if (!(worst <= u.held.cvar90.value) || !(worst <= u.posture.cvar90.value))
    run.warn(
        fmt::format("in the worst tenth of scattered drops the motion's peak is {} m/s^2; {} it is {}, held at {:.1f} "
                    "deg {}: doing nothing is safer{}",
                    short_peak_words(worst), held_words(), short_peak_words(u.held.cvar90.value), posture,
                    short_peak_words(u.posture.cvar90.value), tail ? "" : "; --robust cvar plans for that"));
  if (a.scattered && u.measured.value > u.posture_value)
    run.warn(fmt::format(
        "over the scattered drops holding at {:.1f} deg is better by what was asked for: {} m/s^2, the motion {}",
        posture, short_peak_words(u.posture_value), short_peak_words(u.measured.value)));
}

}  // namespace ukemi::tools
