#include "tools/report/risk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "landing/judge/answer.hpp"
#include "landing/model/scatter_file.hpp"
#include "landing/scatter/drop_file.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// Something that happens in some of the drops.
struct Share {
  std::string key, words;
  long drops, of;
  double share() const { return double(drops) / double(of); }
};
Quantities<Share> share_quantities(const std::string& heading) {
  return {{"", "", &Share::key},
          {"", "", heading, "{}", &Share::words},
          {"", "drops", "drops", {}, &Share::drops},
          {"", "share", "share", percent_words, [](auto& s) { return s.share(); }}};
}

Share share_of(const RiskEvent& e, long of) {
  using Kind = RiskEvent::Kind;
  switch (e.kind) {
    case Kind::kTouch:
      return {kPointNames[std::size_t(e.point)], fmt::format("the {} touches", kPointNames[std::size_t(e.point)]),
              e.drops, of};
    case Kind::kSpeed:
      return {"speed_max", fmt::format("the motor turns faster than {:.4g} rad/s", e.limit), e.drops, of};
    case Kind::kTorque:
      return {"motor_torque_max", fmt::format("the motor pulls with more than {:.4g} Nm", e.limit), e.drops, of};
    case Kind::kStops:
      return {"joint", "the joint leaves its stops", e.drops, of};
  }
  return {};
}

Quantities<PeakContact> peak_contact_quantities(long of) {
  return {{"", "contact", &PeakContact::number},
          {"", "point", [](auto& c) { return c.point < 0 ? Json() : Json(kPointNames[std::size_t(c.point)]); }},
          {"", "", "contact that makes the peak", "{}",
           [](const PeakContact& c) -> Json {
             if (c.number == 0) return "none: before the first";
             return fmt::format("{}, {}", c.number, kPointNames[std::size_t(c.point)]);
           }},
          {"", "drops", "drops", {}, &PeakContact::drops},
          {"", "share", "share", percent_words, [of](auto& c) { return double(c.drops) / double(of); }}};
}

std::string interval_words(const Interval& i) {
  return std::isnan(i.value) ? "" : fmt::format("{:.3f} ({:.3f} to {:.3f})", i.value, i.low, i.high);
}
Quantities<Risk::Uncertainty> index_quantities() {
  Quantities<Risk::Uncertainty> out = {
      {"name", "", &Risk::Uncertainty::name},
      {"", "", "uncertainty", "{}", [](const Risk::Uncertainty& u) { return spaced(u.name); }}};
  const auto index = [&](const std::string& key, const std::string& words, Interval SobolIndex::*which) {
    const auto number = [&](const std::string& csv, const std::string& json, double Interval::*of) {
      out.push_back({csv, json, "", {}, [=](const Risk::Uncertainty& u) { return u.index.*which.*of; }});
    };
    number(key, key, &Interval::value);
    number(key + "_low", key + "_ci95/0", &Interval::low);
    number(key + "_high", key + "_ci95/1", &Interval::high);
    out.push_back({"", "", words, "{}", [=](const Risk::Uncertainty& u) { return interval_words(u.index.*which); }});
  };
  index("first", "share of the variance alone (95 %)", &SobolIndex::first);
  index("total", "with the others (95 %)", &SobolIndex::total);
  return out;
}

struct NumberedDrop {
  long row;
  RiskyDrop of;
};
Table worst_drops(const RiskStudy& s) {
  std::vector<NumberedDrop> rows;
  std::vector<ScatteredDrop> drops;
  for (const RiskyDrop& d : s.risk.worst) rows.push_back({long(rows.size()) + 1, d}), drops.push_back(d.drop);
  Quantities<NumberedDrop> columns = {{"row", &NumberedDrop::row}, {"peak", [](auto& d) { return d.of.peak; }}};
  for (const DropColumn& c : scattered_columns(drops, s.scene, s.actuator.sea))
    columns.push_back({c.name, "", [c, sea = s.actuator.sea](const NumberedDrop& d) {
                         return numbers(d.of.drop, sea).*c.number / c.unit;
                       }});
  return Table(columns, rows);
}

Quantities<PeakBin> bin_quantities() {
  return {{"lower", "", &PeakBin::lower},
          {"upper", "", &PeakBin::upper},
          {"count", "", &PeakBin::drops},
          {"count_held", "", &PeakBin::beside}};
}

/// Sobol's indices as bars with their intervals.
Figure sobol_figure(const Risk& r) {
  Figure out;
  out.name = "sobol";
  Panel p;
  p.x_label = "share of the variance of the peak";
  Series total{"with the others", {}, {}, Series::Look::kBars, 5},
      first{"alone (95 %)", {}, {}, Series::Look::kIntervals, 1};
  for (std::size_t i = 0; i < r.uncertainties.size(); ++i) {
    const Risk::Uncertainty& u = r.uncertainties[i];
    const double row = double(r.uncertainties.size() - i);
    p.rows.push_back(spaced(u.name));
    total.x.push_back(u.index.total.value), total.y.push_back(row);
    first.x.push_back(u.index.first.value), first.y.push_back(row - 0.18);
    first.low.push_back(u.index.first.low), first.high.push_back(u.index.first.high);
  }
  Series spread{"with the others (95 %)", total.x, total.y, Series::Look::kIntervals, Series::kInk};
  for (double& y : spread.y) y += 0.18;
  for (const Risk::Uncertainty& u : r.uncertainties)
    spread.low.push_back(u.index.total.low), spread.high.push_back(u.index.total.high);
  p.series = {total, spread, first};
  out.panels = {p}, out.panel_height = 110 + 30.0 * double(p.rows.size());
  out.caption =
      "Which uncertainty makes the peak scatter: what it brings alone and together with the others (sobol.csv).";
  return out;
}

/// Where the drops come from.
std::string scatter_words(const RiskStudy& s) {
  if (!s.scatter) return "Drops as they were measured.";
  const std::string text = text_of(*s.scatter);
  const std::string constants =
      s.actuator.covariance.size() == 0 ? "do not scatter: their file holds no [uncertainty]"
      : s.scattering.inflate == 0       ? "do not scatter"
      : s.scattering.inflate == 1
          ? "scatter by the covariance of their fit"
          : fmt::format("scatter by the covariance of their fit, standard errors times {:g}", s.scattering.inflate);
  return fmt::format("Standard deviations of the drops: {}{}. The actuator's constants {}.{}",
                     text.empty() ? "none" : text, s.assumed ? ", assumed: nobody said" : "", constants,
                     s.scattering.inexact ? " The motion is played anywhere within the execution tolerance." : "");
}

/// Which uncertainty matters most, or why that is not known.
std::string index_words(const Risk& r) {
  using WhyNone = Risk::WhyNone;
  switch (r.why_none) {
    case WhyNone::kMeasured:
      return "Which uncertainty matters most is not asked of measured drops: they say nothing of what else could come.";
    case WhyNone::kNothingScatters:
      return "Nothing scatters: every drop is the one that is planned.";
    case WhyNone::kOneGroup:
      return "Only one thing scatters: all of the variance is its.";
    case WhyNone::kStopped:
      return "Which uncertainty matters most is not known: the run was interrupted.";
    case WhyNone::kThere:
      break;
  }
  if (r.uncertainties.empty() || !std::isfinite(r.uncertainties.front().index.total.value))
    return "The peak does not depend on what scatters.";
  const Risk::Uncertainty& u = r.uncertainties.front();
  return fmt::format("What matters most: {}, with {} of the variance alone and {} with the others.", spaced(u.name),
                     percent_words(u.index.first.value), percent_words(u.index.total.value));
}

std::string held_comparison(const Risk& r) {
  const double own = r.peaks.cvar90.value, held = r.held.cvar90.value;
  if (!std::isfinite(held)) return "The held reference could not be followed.";
  return fmt::format("The worst tenth of the drops: {:.4g} m/s^2 on average, {:.1f} % {} holding's {:.4g}.", own,
                     100 * std::abs(1 - own / held), own > held ? "above" : "below", held);
}

void warn(const RiskStudy& s, Run& run) {
  const Risk& r = s.risk;
  const long n = r.peaks.samples + r.failed;
  if (s.assumed)
    run.warn(fmt::format("the scene has no [scatter]: {} is assumed; --scatter says it", text_of(*s.scatter)));
  if (r.failed > 0)
    run.warn(fmt::format("{} of {} drops could not be followed to the floor: they are left out", r.failed, n));
  if (r.held_failed > 0)
    run.warn(fmt::format("{} of {} drops could not be followed with the reference {}: they are left out of its column",
                         r.held_failed, r.held.samples + r.held_failed, held_words()));
  if (r.from_floor > 0)
    run.warn(fmt::format("{} of {} drops would begin below the floor: they begin on it", r.from_floor, n));
  if (r.lost > 0)
    run.warn(fmt::format("in {} of {} drops the drive loses the joint: their peaks are those of a link that whirls",
                         r.lost, n));
  if (r.held_lost > 0)
    run.warn(fmt::format("in {} of {} drops the drive loses the joint with the reference {}", r.held_lost,
                         r.held.samples, held_words()));
  if (r.index_failed > 0)
    run.warn(fmt::format("{} of the {} landings of the indices could not be followed: their base points are left out",
                         r.index_failed, r.index_landings));
  if (r.peaks.cvar90.value > r.held.cvar90.value)
    run.warn(fmt::format("the worst tenth of the drops is worse than that of the reference {}: {:.4g} and {:.4g} m/s^2",
                         held_words(), r.peaks.cvar90.value, r.held.cvar90.value));
}

}  // namespace

int report(const RiskStudy& s, Run& run) {
  const Risk& r = s.risk;
  warn(s, run);
  const std::vector<NamedDistribution> both = {{"motion", r.peaks}, {held_words(), r.held}};
  const Table peaks(named_quantities(), both);
  std::vector<Share> touches, passings;
  for (const RiskEvent& e : r.events)
    (e.kind == RiskEvent::Kind::kTouch ? touches : passings).push_back(share_of(e, r.peaks.samples));
  const Table touched(share_quantities("forbidden"), touches), passed(share_quantities("rating or stop"), passings),
      contacts(peak_contact_quantities(r.peaks.samples), r.contacts), indices(index_quantities(), r.uncertainties);
  const auto keyed = [](const Table& t) { return t.keyed().is_null() ? Json::object() : t.keyed(); };
  Json summary = {{"peak", peaks.object(0)},
                  {"held", peaks.object(1)},
                  {"contacts", contacts.objects()},
                  {"forbidden", keyed(touched)},
                  {"ratings", keyed(passed)},
                  {"sobol", keyed(indices)},
                  {"sobol_landings", r.index_landings},
                  {"scatter", s.scatter ? Json(text_of(*s.scatter)) : Json()},
                  {"scatter_assumed", s.assumed},
                  {"failed", r.failed},
                  {"held_failed", r.held_failed},
                  {"joint_lost", r.lost},
                  {"held_joint_lost", r.held_lost},
                  {"from_floor", r.from_floor},
                  {"motion", motion_json(s.motion)}};
  if (r.peaks.samples == 0) {
    run.warn("no drop could be followed to the floor: there is no distribution");
    return run.finish(summary, kNumbers);
  }
  Report page("Risk: " + s.scene.name);
  floor_source(page, s.scene);
  page.paragraph(motion_words(s.motion) + ".");
  page.paragraph(scatter_words(s));
  tell(peaks, page, run);
  for (const std::string& sentence : {held_comparison(r), index_words(r)}) run.say(sentence), page.paragraph(sentence);
  Figure peak_figure = histogram_figure(r.histogram, "motion", r.peaks, held_words(), r.held.samples);
  peak_figure.caption += " (histogram.csv)";
  page.figure(peak_figure);
  if (!r.uncertainties.empty()) page.figure(sobol_figure(r));
  if (!r.uncertainties.empty())
    tell(indices, page, run, "sobol.csv",
         "Shares of the variance of the peak: first, what a number brings alone; total, with what it does together "
         "with others; low, high: 95 % intervals.");
  for (const Table* t : {&contacts, &touched, &passed})
    if (!t->shown().empty()) tell(*t, page, run);
  page.distrust(run.warnings());
  run.add("histogram.csv", Table(bin_quantities(), r.histogram).csv(run, "Drops by their peak [m/s^2]."));
  run.add("risk.csv", worst_drops(s).csv(run,
                                         "The worst drops, the worst first: `ukemi simulate --drop-from` replays a "
                                         "row. peak [m/s^2]; what does not stand here is as planned."));
  page.write(run);
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools
