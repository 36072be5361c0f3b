#include "tools/report/risk.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "landing/judge/answer.hpp"
#include "landing/model/scatter_file.hpp"
#include "landing/plan/body_drop_file.hpp"
#include "landing/plan/body_risk.hpp"
#include "landing/scatter/drop_file.hpp"
#include "tools/report/body.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::tools {

const Outputs kRiskOutputs{
    "risk", {"histogram.csv", "risk.csv", "sobol.csv", "set_scene.toml", "set_robot.toml"}, {"histogram", "sobol"}};

using namespace landing;

namespace {

/// What the report of a risk needs besides its numbers.
struct RiskTexts {
  std::string scene, source;  ///< name; where the floor's constants come from
  std::string motion, drops;  ///< sentences
  std::string held;           ///< the held reference: "held at -45 deg"
  std::string worst;          ///< risk.csv
  std::optional<Scatter> scatter;
  bool assumed;
  Json of_motion;
  RobotWords robot;
  std::function<std::string(int)> joint = {};  ///< names of joints of a robot of links
  std::function<Load(int)> load = {};          ///< loads of a robot of links
  bool limited = false;                        ///< there are limits: PeakRisk::kept
};

std::string with_spaces(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// An event and the number of drops in which it happens.
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

Share share_of(const RiskEvent& e, const RiskTexts& t, long of) {
  using Kind = RiskEvent::Kind;
  const std::string joint = e.joint >= 0 ? t.joint(e.joint) : "", key = joint.empty() ? "" : "_" + joint,
                    motor = joint.empty() ? "the motor" : "the motor of " + joint;
  switch (e.kind) {
    case Kind::kTouch:
      return {t.robot.point(e.point), fmt::format("the {} touches", t.robot.point(e.point)), e.drops, of};
    case Kind::kSpeed:
      return {"speed_max" + key, fmt::format("{} turns faster than {:.4g} rad/s", motor, e.limit), e.drops, of};
    case Kind::kTorque:
      return {"motor_torque_max" + key, fmt::format("{} pulls with more than {:.4g} Nm", motor, e.limit), e.drops, of};
    case Kind::kLoad: {
      const Load load = t.load(e.load);
      return {"load_" + load.name, fmt::format("the load {} {}", load.name, exceeded_words(load)), e.drops, of};
    }
    case Kind::kStops:
      return {"joint" + key, fmt::format("the joint {}leaves its stops", joint.empty() ? "" : joint + " "), e.drops,
              of};
  }
  return {};
}

Quantities<PeakContact> peak_contact_quantities(const PointName& name, long of) {
  return {{"", "contact", &PeakContact::number},
          {"", "point", [name](auto& c) { return c.point < 0 ? Json() : Json(name(c.point)); }},
          {"", "", "contact that makes the peak", "{}",
           [name](const PeakContact& c) -> Json {
             if (c.number == 0) return "none: before the first";
             return fmt::format("{}, {}", c.number, name(c.point));
           }},
          {"", "drops", "drops", {}, &PeakContact::drops},
          {"", "share", "share", percent_words, [of](auto& c) { return double(c.drops) / double(of); }}};
}

std::string interval_words(const Interval& i) {
  return std::isnan(i.value) ? "" : fmt::format("{:.3f} ({:.3f} to {:.3f})", i.value, i.low, i.high);
}
Quantities<PeakRisk::Uncertainty> index_quantities() {
  Quantities<PeakRisk::Uncertainty> out = {
      {"name", "", &PeakRisk::Uncertainty::name},
      {"", "", "uncertainty", "{}", [](const PeakRisk::Uncertainty& u) { return with_spaces(u.name); }}};
  const auto index = [&](const std::string& key, const std::string& words, Interval SobolIndex::*order) {
    const auto number = [&](const std::string& csv, const std::string& json, double Interval::*member) {
      out.push_back({csv, json, "", {}, [=](const PeakRisk::Uncertainty& u) { return u.index.*order.*member; }});
    };
    number(key, key, &Interval::value);
    number(key + "_low", key + "_ci95/0", &Interval::low);
    number(key + "_high", key + "_ci95/1", &Interval::high);
    out.push_back(
        {"", "", words, "{}", [=](const PeakRisk::Uncertainty& u) { return interval_words(u.index.*order); }});
  };
  index("first", "share of the variance alone (95 %)", &SobolIndex::first);
  index("total", "with the others (95 %)", &SobolIndex::total);
  return out;
}

/// risk.csv of the worst drops; `columns`: of their numbers, value(column, drop) in the unit of the file.
template <class Drop, class Columns, class Value>
std::string worst_csv(const std::vector<Drop>& worst, const Columns& columns, Value value, const Run& run) {
  Quantities<Drop> quantities = {{"row", [&](auto& d) { return &d - worst.data() + 1; }}, {"peak", &Drop::peak}};
  for (const auto& c : columns)
    quantities.push_back({c.name, "", [c, value](const Drop& d) { return value(c, d.drop); }});
  return Table(quantities, worst)
      .csv(run,
           "The worst drops, the worst first: `ukemi simulate --drop-from` replays a row. peak [m/s^2]; what does not "
           "stand here is as planned.");
}
/// The drops of risky ones.
template <class Drop>
auto drops_of(const std::vector<Drop>& worst) {
  std::vector<decltype(Drop::drop)> out;
  for (const Drop& d : worst) out.push_back(d.drop);
  return out;
}

Quantities<PeakBin> bin_quantities() {
  return {{"lower", "", &PeakBin::lower},
          {"upper", "", &PeakBin::upper},
          {"count", "", &PeakBin::drops},
          {"count_held", "", &PeakBin::beside}};
}

/// Sobol's indices as bars with their intervals.
Figure sobol_figure(const PeakRisk& r) {
  Figure out;
  out.name = "sobol";
  Panel p;
  p.x_label = "share of the variance of the peak";
  Series total{"with the others", {}, {}, Series::Style::kBars, 5},
      first{"alone (95 %)", {}, {}, Series::Style::kIntervals, 1};
  for (std::size_t i = 0; i < r.uncertainties.size(); ++i) {
    const PeakRisk::Uncertainty& u = r.uncertainties[i];
    const double row = double(r.uncertainties.size() - i);
    p.rows.push_back(with_spaces(u.name));
    total.x.push_back(u.index.total.value), total.y.push_back(row);
    first.x.push_back(u.index.first.value), first.y.push_back(row - 0.18);
    first.low.push_back(u.index.first.low), first.high.push_back(u.index.first.high);
  }
  Series total_interval{"with the others (95 %)", total.x, total.y, Series::Style::kIntervals, Series::kInk};
  for (double& y : total_interval.y) y += 0.18;
  for (const PeakRisk::Uncertainty& u : r.uncertainties)
    total_interval.low.push_back(u.index.total.low), total_interval.high.push_back(u.index.total.high);
  p.series = {total, total_interval, first};
  out.panels = {p}, out.panel_height = 110 + 30.0 * double(p.rows.size());
  out.caption =
      "Which uncertainty makes the peak scatter: what it brings alone and together with the others (sobol.csv).";
  return out;
}

/// The uncertainty with the largest total Sobol index, or why that is not known.
std::string index_words(const PeakRisk& r) {
  using WhyNone = PeakRisk::WhyNone;
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
  const PeakRisk::Uncertainty& u = r.uncertainties.front();
  return fmt::format("What matters most: {}, with {} of the variance alone and {} with the others.",
                     with_spaces(u.name), percent_words(u.index.first.value), percent_words(u.index.total.value));
}

std::string held_comparison(const PeakRisk& r) {
  const double cvar = r.peaks.cvar90.value, held = r.held.cvar90.value;
  if (!std::isfinite(held)) return "The held reference could not be followed.";
  return fmt::format("The worst tenth of the drops: {} on average, {:.1f} % {} holding's {:.4g}.",
                     goal_text(cvar, false), 100 * std::abs(1 - cvar / held), cvar > held ? "above" : "below", held);
}

void warn(const PeakRisk& r, const RiskTexts& t, Run& run) {
  const long n = r.peaks.samples + r.failed;
  if (t.assumed) warn_of_assumed(*t.scatter, run);
  if (r.failed > 0)
    run.warn(fmt::format("{} of {} drops could not be followed to the floor: they are left out", r.failed, n));
  if (r.held_failed > 0)
    run.warn(fmt::format("{} of {} drops could not be followed with the reference {}: they are left out of its column",
                         r.held_failed, r.held.samples + r.held_failed, t.held));
  if (r.from_floor > 0)
    run.warn(fmt::format("{} of {} drops would begin below the floor: they begin on it", r.from_floor, n));
  if (r.lost > 0)
    run.warn(fmt::format("in {} of {} drops the drive loses the joint: their peaks are those of a link that whirls",
                         r.lost, n));
  if (r.held_lost > 0)
    run.warn(fmt::format("in {} of {} drops the drive loses the joint with the reference {}", r.held_lost,
                         r.held.samples, t.held));
  if (r.index_failed > 0)
    run.warn(fmt::format("{} of the {} landings of the indices could not be followed: their base points are left out",
                         r.index_failed, r.index_landings));
  constexpr double kRounding = 1e-6;  // relative, between lanes and the scalar path
  if (r.peaks.cvar90.value > (1 + kRounding) * r.held.cvar90.value)
    run.warn(fmt::format("the worst tenth of the drops is worse than that of the reference {}: {:.4g} and {}", t.held,
                         r.peaks.cvar90.value, goal_text(r.held.cvar90.value, false)));
}

/// The motors' speeds and torques and the loads with ratings over the drops.
Check within_ratings(const PeakRisk& r, const RiskTexts& t) {
  using Kind = RiskEvent::Kind;
  Check out{Check::State::kUnknown, "within ratings", "ratings unknown"};
  std::vector<std::string> beyond;
  for (const RiskEvent& e : r.events) {
    const bool load = e.kind == Kind::kLoad && !t.load(e.load).limit;
    if (e.kind != Kind::kSpeed && e.kind != Kind::kTorque && !load) continue;
    const Share share = share_of(e, t, r.peaks.samples);
    if (e.drops > 0) beyond.push_back(fmt::format("{} in {} of the drops", share.words, percent_words(share.share())));
    out =
        check(beyond.empty(), out.what, beyond.empty() ? "in every drop" : fmt::format("{}", fmt::join(beyond, "; ")));
  }
  return out;
}

FirstScreen first_screen(const PeakRisk& r, const RiskTexts& t) {
  FirstScreen out{.sentence = held_comparison(r) + fmt::format(" The median drop: {:.4g}.", r.peaks.median.value)};
  out.checks = {under_scatter_check(r.peaks.cvar90.value, r.held.cvar90.value),
                check(r.failed == 0, "every drop was followed",
                      fmt::format("{} of {}", r.peaks.samples, r.peaks.samples + r.failed)),
                check(r.lost == 0, "the drive keeps the joint", fmt::format("lost in {} drops", r.lost)),
                within_ratings(r, t),
                {t.assumed ? Check::State::kCaution : Check::State::kGood, "the scatter is given",
                 t.assumed ? "it is assumed: --scatter says it" : ""}};
  if (t.limited) out.checks.push_back(keeps_limits_check(r.kept(), r.peaks.samples, "drops"));
  out.next = "`ukemi optimize --robust cvar` plans for the worst tenth.";
  return out;
}

/// How the drops scatter, in sentences; `whose` constants scatter if `uncertain`.
template <class Options>
std::string drops_words(const std::optional<Scatter>& scatter, bool assumed, const std::string& whose, bool uncertain,
                        const Options& options) {
  if (!scatter) return "Drops as they were measured.";
  const std::string text = text_of(*scatter);
  const std::string constants =
      !uncertain             ? "do not scatter: no file of theirs holds [uncertainty]"
      : options.inflate == 0 ? "do not scatter"
      : options.inflate == 1
          ? "scatter by the covariance of their fit"
          : fmt::format("scatter by the covariance of their fit, standard errors times {:g}", options.inflate);
  return fmt::format("Standard deviations of the drops: {}{}. The constants of the {} {}.{}",
                     text.empty() ? "none" : text, assumed ? ", assumed: nobody said" : "", whose, constants,
                     options.inexact ? " The motion is played anywhere within the execution tolerance." : "");
}

int report_risk(const PeakRisk& r, const RiskTexts& t, Run& run) {
  warn(r, t, run);
  const std::vector<NamedDistribution> distributions = {{"motion", r.peaks}, {t.held, r.held}};
  const std::string what = distributed_words(t.robot.acceleration, false);
  const Table peaks(named_quantities(what), distributions);
  std::vector<Share> touches, exceedances;
  for (const RiskEvent& e : r.events)
    (e.kind == RiskEvent::Kind::kTouch ? touches : exceedances).push_back(share_of(e, t, r.peaks.samples));
  const Table touched(share_quantities("forbidden"), touches),
      exceeded(share_quantities(t.load ? "rating, stop or load" : "rating or stop"), exceedances),
      contacts(peak_contact_quantities(t.robot.point, r.peaks.samples), r.contacts),
      indices(index_quantities(), r.uncertainties);
  const auto keyed = [](const Table& x) { return x.keyed().is_null() ? Json::object() : x.keyed(); };
  Json summary = {{"peak", peaks.object(0)},
                  {"held", peaks.object(1)},
                  {"contacts", contacts.objects()},
                  {"forbidden", keyed(touched)},
                  {"ratings", keyed(exceeded)},
                  {"sobol", keyed(indices)},
                  {"sobol_landings", r.index_landings},
                  {"scatter", t.scatter ? Json(text_of(*t.scatter)) : Json()},
                  {"scatter_assumed", t.assumed},
                  {"failed", r.failed},
                  {"held_failed", r.held_failed},
                  {"joint_lost", r.lost},
                  {"held_joint_lost", r.held_lost},
                  {"from_floor", r.from_floor},
                  {"motion", t.of_motion}};
  if (t.limited) summary["share_kept"] = number(r.kept());
  if (r.peaks.samples == 0) {
    run.warn("no drop could be followed to the floor: there is no distribution");
    return run.finish(summary, kNumbers);
  }
  Report page("Risk: " + t.scene);
  floor_source(page, t.source);
  page.paragraph(t.motion + ".");
  page.paragraph(t.drops);
  add_table(peaks, page, run);
  for (const std::string& sentence : {held_comparison(r), index_words(r)}) run.say(sentence), page.paragraph(sentence);
  if (t.limited) {
    const std::string sentence = fmt::format("All limits hold in {:.2f} % of the drops.", 100 * r.kept());
    run.say(sentence), page.paragraph(sentence);
  }
  Figure peak_figure = histogram_figure(r.histogram, "motion", r.peaks, t.held, r.held.samples, what);
  peak_figure.caption += " (histogram.csv)";
  page.figure(peak_figure);
  if (!r.uncertainties.empty()) page.figure(sobol_figure(r));
  if (!r.uncertainties.empty())
    add_table(indices, page, run, "sobol.csv",
              "Shares of the variance of the peak: first, what a number brings alone; total, with what it does "
              "together with others; low, high: 95 % intervals.");
  for (const Table* x : {&contacts, &touched, &exceeded})
    if (!x->shown().empty()) add_table(*x, page, run);
  page.answer(first_screen(r, t), run.warnings());
  page.distrust(run.warnings());
  run.add("histogram.csv", Table(bin_quantities(), r.histogram).csv(run, "Drops by their peak [m/s^2]."));
  run.add("risk.csv", t.worst);
  page.write(run);
  return run.finish(summary, kDone);
}

/// What is said alike of any robot; `drops`: how they scatter.
template <class Scene, class Motion>
RiskTexts risk_texts(const Scene& scene, const Motion& motion, const std::optional<Scatter>& scatter, bool assumed,
                     const std::string& drops) {
  return {.scene = scene.name,
          .source = source_of(scene),
          .motion = motion_words(scene.robot, motion),
          .drops = drops,
          .scatter = scatter,
          .assumed = assumed,
          .of_motion = motion_json(scene.robot, motion),
          .robot = words_of(scene.robot)};
}

}  // namespace

int report(const RiskStudy& s, Run& run) {
  const std::string drops =
      drops_words(s.scatter, s.assumed, "actuator", s.actuator.covariance.size() > 0, s.scattering);
  RiskTexts texts = risk_texts(s.scene, s.motion, s.scatter, s.assumed, drops);
  texts.held = held_words();
  texts.limited = std::any_of(s.risk.events.begin(), s.risk.events.end(), [](const RiskEvent& e) {
    return e.kind == RiskEvent::Kind::kTouch || e.kind == RiskEvent::Kind::kStops;
  });
  const SeaParameters<double>& sea = s.actuator.sea;
  const auto value = [&](const DropColumn& c, const ScatteredDrop& d) { return c.of(numbers(d, sea)) / c.unit; };
  texts.worst = worst_csv(s.risk.worst, scattered_columns(drops_of(s.risk.worst), s.scene, sea), value, run);
  return report_risk(s.risk, texts, run);
}

int report(const BodyScene& scene, const BodyMotion& motion, const BodyRisk& risk, const BodyRiskOptions& options,
           Run& run) {
  const Robot& robot = scene.robot;
  const std::string drops =
      drops_words(risk.scatter, risk.assumed, "drives", robot.fitted() || scene.identified, options.drops);
  RiskTexts texts = risk_texts(scene, motion, risk.scatter, risk.assumed, drops);
  texts.held = "held: " + motion_words(robot, held_posture(scene));
  texts.joint = [&robot](int i) { return robot.joints[std::size_t(i)].name; };
  if (!scene.loads.empty()) texts.load = [&scene](int i) { return scene.loads[std::size_t(i)]; };
  texts.limited = scene.limited();
  const auto value = [](const BodyDropColumn& c, const BodyDrop& d) { return c.get(d); };
  texts.worst = worst_csv(risk.worst, scattered_columns(drops_of(risk.worst), scene), value, run);
  return report_risk(risk, texts, run);
}

}  // namespace ukemi::tools
