// ukemi optimize.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>

#include "common/error.hpp"
#include "common/files.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/solvers.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/report/report.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// What a robot plays: t = 0 at the detected first touchdown.
std::string motion_csv(const Run& run, const Motion& m, double rate) {
  CsvWriter csv = run.csv();
  csv.comment("t = 0 at the detected first touchdown; before it hold phi_ref of the first row. Units: s, rad, rad/s.");
  csv.header({"t", "phi_ref", "dphi_ref"});
  const long rows = long(std::ceil(m.duration * rate - 1e-9));
  for (long i = 0; i <= rows; ++i) {
    const double t = std::min(double(i) / rate, m.duration);
    const Reference<double> r = quintic(m.phi_i, m.phi_f, m.duration, t);
    csv.row({t, r.phi, r.dphi});
  }
  return csv.text();
}

/// The options as the command line gives them.
OptimizeOptions options_of(const OptimizeArguments& a, const CommonOptions& common, const Actuator& actuator) {
  OptimizeOptions o;
  o.solver = a.solver == "compare" ? "auto" : a.solver;
  o.goal = a.goal;
  o.evaluations = a.evaluations;
  o.deadline = a.deadline;
  o.tolerance = a.tolerance;
  o.seed = common.seed;
  o.threads = common.threads;
  for (const std::string& point : a.forbid)
    o.limits.forbidden[choice_index("--forbid", point, {kPointNames.begin(), kPointNames.end()})] = true;
  if (a.ratings == OptimizeArguments::Ratings::kRespect) {
    const bool speed = actuator.speed_max.has_value(), torque = std::isfinite(actuator.sea.tau_max);
    if (!speed || !torque)
      throw InputError(fmt::format("--respect-ratings: {} gives no {}: both speed_max and tau_max are needed",
                                   a.actuator,
                                   speed    ? "tau_max"
                                   : torque ? "speed_max"
                                            : "speed_max and no tau_max"));
    o.limits.motor_speed = o.reference_rate = *actuator.speed_max;
    o.limits.motor_torque = actuator.sea.tau_max;
  }
  o.validate();
  return o;
}

/// Time since the program's start: what the processor has spent on it says when that was.
class Clock {
 public:
  Clock() : before_(double(std::clock()) / CLOCKS_PER_SEC) {}
  double seconds() const { return before_ + watch_.seconds(); }

 private:
  double before_;
  Stopwatch watch_{Stopwatch::Time::kWall};
};

/// What a search came to, and how: the moments at which its best became better, in the search's own accuracy.
struct SolverTables {
  CsvWriter solvers, progress;
  explicit SolverTables(const Run& run) : solvers(run.csv()), progress(run.csv()) {
    solvers.header({"solver", "evaluations", "time_s", "best"});
    progress.header({"solver", "evaluations", "landings", "time_s", "best"});
  }
  void add(const std::string& solver, const Optimum& o) {
    for (const Progress& p : o.progress)
      progress.cell(solver).cell(p.motions).cell(p.landings).cell(p.seconds).cell(p.best.value).end_row();
    solvers.cell(solver).cell(o.evaluations).cell(o.seconds).cell(o.found ? o.value : kNoMotion).end_row();
  }
};

/// Every solver with the same budget, until it is interrupted; the best of them, and a table of all.
Optimum compare_solvers(const Scene& scene, const Actuator& actuator, OptimizeOptions options, const Run& run,
                        SolverTables& tables, Json& table) {
  Optimum best;
  const auto names = solver_names();
  const Monitor whole = run.monitor("solvers");
  for (std::size_t i = 0; i < names.size() && !whole.stopped(); ++i) {
    options.solver = names[i];
    options.monitor = {
        [&](long done, long total) { whole.progress(long(i) * total + done, long(names.size()) * total); }, whole.stop};
    const Optimum o = optimize(scene, actuator.sea, options);
    tables.add(names[i], o);
    table.push_back({{"solver", names[i]},
                     {"value", o.found ? number(o.value) : Json()},
                     {"evaluations", o.evaluations},
                     {"landings", o.landings},
                     {"time_s", o.seconds}});
    if (o.value < best.value || i == 0) best = o, best.solver = names[i];
  }
  return best;
}

/// The best motion, and what is said of it.
struct Answer {
  const Scene& scene;
  const Actuator& actuator;
  const OptimizeOptions& options;
  Optimum best;
  Landing landing, held;  ///< End::kStopped where there was no time to play it
  std::optional<Evidence> evidence;
  double evidence_time = 0;  ///< [s]

  bool played() const { return landing.end != End::kStopped; }
  double peak() const { return played() ? landing.peak : best.landing.peak; }
  /// The reference that others are compared with; NaN where it is not known.
  double held_peak() const { return held.end == End::kStopped ? NAN : held.peak; }
  double reduction() const { return 1 - peak() / held_peak(); }
  bool tolerant_known() const { return best.tolerant.complete || options.goal == Goal::kTolerant; }
};

/// A peak for a reader.
std::string words(double peak, int digits = 4) {
  return std::isnan(peak)   ? "not played"
         : std::isinf(peak) ? "not to be followed"
                            : fmt::format("{:.{}g}", peak, digits);
}

/// What may not be as planned, and the worst peak that it brings.
std::vector<std::pair<std::string, double>> deviations(const Evidence& e) {
  return {{"the angles off by 1 deg", e.one_degree},
          {"the duration off by 10 ms", e.ten_milliseconds},
          {"the height off by 1 cm", e.one_centimetre},
          {"the pitch off by 1 deg", e.pitch_one_degree},
          {"the floor's damping off by 10 %", e.damping_ten_percent}};
}

/// Where forbidden points touch after all when the motion is played inexactly.
Json forbidden_touches(const Answer& a, Run& run) {
  const TolerantPeak& t = a.best.tolerant;
  Json out;
  for (std::size_t j = 0; j < std::size_t(kPoints); ++j) {
    if (!a.options.limits.forbidden[j]) continue;
    const int box = t.touching[j], inside = t.samples_touching[j];
    out[kPointNames[j]] = {{"box", t.complete ? Json(box) : Json()},
                           {"of", kExecutionPoints},
                           {"sampled", inside},
                           {"samples", t.samples}};
    if (box + inside > 0)
      run.warn(
          fmt::format("the {} touches in {} of the {} motions of the execution box and in {} of {} random ones "
                      "inside: --forbid holds for {}",
                      kPointNames[j], box, kExecutionPoints, inside, t.samples,
                      a.options.goal == Goal::kPeak ? "the exact motion alone" : "those fifteen alone"));
    else if (!t.complete && a.options.goal == Goal::kPeak)
      run.warn(fmt::format("--forbid holds for the exact motion: there was no time to play its execution box"));
  }
  return out;
}

/// The warnings that are the verb's own.
void warn(const Answer& a, Run& run) {
  const TolerantPeak& t = a.best.tolerant;
  warn_if_unstable(a.scene, a.actuator, a.best.motion, run);
  if (!a.best.message.empty()) run.warn(a.best.message);
  if (!a.best.verified) run.warn("there was no time to judge the motion at a tight accuracy: its peak is the search's");
  if (t.sampled > t.value)
    run.warn(fmt::format(
        "inside the execution tolerance a peak of {:.5g} was found, above the tolerant peak {:.5g} of its 15 points",
        t.sampled, t.value));
  if (a.tolerant_known() && t.value > 1.05 * a.peak())
    run.warn(
        fmt::format("the motion stands on a cliff: played within {:g} deg and {:g} ms its peak may reach {:.4g} "
                    "m/s^2",
                    a.scene.execution.phi * kDegrees, a.scene.execution.duration * 1e3, t.value));
  if (!a.evidence) return;
  std::string lost;
  for (const auto& [what, peak] : deviations(*a.evidence))
    if (peak > 1.05 * a.peak() && !(peak - a.peak() < 0.5 * (a.held_peak() - a.peak())))
      lost += fmt::format("{}{} with {}", lost.empty() ? "" : ", ", words(peak), what);
  if (!lost.empty())
    run.warn(
        fmt::format("the peak of {:.4g} m/s^2 becomes {}; held at -45 deg it is {}: half of what the motion saves, "
                    "or more, is lost",
                    a.peak(), lost, words(a.held_peak())));
  if (!a.evidence->complete && a.evidence->work > kCheckWork && !interrupted())
    run.warn(
        fmt::format("the landings of this scene are long ({} of them take {:.2g} steps or more): evidence is left out; "
                    "--evidence plays it",
                    Evidence::kLandings, double(a.evidence->work)));
}

Json summary_of(const Answer& a, Run& run) {
  const Scene& scene = a.scene;
  const Optimum& o = a.best;
  Json s;
  s["motion"] = motion_json(o.motion);
  s["peak_acceleration"] = number(a.peak());
  s["verified"] = o.verified;
  if (a.played()) s["peak_time"] = number(a.landing.t_peak);
  s["tolerant_peak"] = a.tolerant_known() ? number(o.tolerant.value) : Json();
  s["tolerant_sampled"] = {{"samples", o.tolerant.samples},
                           {"worst", o.tolerant.samples > 0 ? number(o.tolerant.sampled) : Json()}};
  s["execution"] = {{"phi_deg", scene.execution.phi * kDegrees}, {"duration", scene.execution.duration}};
  if (a.options.limits.any_forbidden()) s["forbidden"] = forbidden_touches(a, run);
  s["contacts"] = a.played() ? contacts_json(a.landing) : Json();
  s["peaks"] = a.played() ? peaks_json(a.landing) : Json();
  s["hold"] = {{"phi_deg", -45}, {"peak_acceleration", number(a.held_peak())}};
  s["reduction"] = number(a.reduction());
  if (a.evidence) {
    s["evidence"] = evidence_json(*a.evidence);
    s["evidence"]["time_s"] = a.evidence_time;
  }
  s["ratings"] = a.played() ? ratings(o.motion, a.landing, a.actuator, run) : Json();
  s["evaluations"] = o.evaluations;
  s["landings"] = o.landings;
  s["solver"] = o.solver;
  return s;
}

void say(const Answer& a, const Run& run) {
  const Optimum& o = a.best;
  run.say(fmt::format("motion: {:.6g} deg to {:.6g} deg in {:.6g} s", o.motion.phi_i * kDegrees,
                      o.motion.phi_f * kDegrees, o.motion.duration));
  run.say(
      fmt::format("peak {} m/s^2; tolerant peak {} (within {:g} deg, {:g} ms); held at -45 deg {}; reduction {:.1f} %",
                  words(a.peak(), 6), a.tolerant_known() ? words(o.tolerant.value, 6) : "not played",
                  a.scene.execution.phi * kDegrees, a.scene.execution.duration * 1e3, words(a.held_peak(), 6),
                  100 * a.reduction()));
  if (a.evidence && a.evidence->complete) {
    std::string line;
    for (const auto& [what, peak] : deviations(*a.evidence))
      line += fmt::format("{}{} {}", line.empty() ? "peak with " : ", ", what, words(peak));
    run.say(line);
  }
  run.say(fmt::format("contacts: {}; {} motions in {:.2f} s", a.played() ? order_of(a.landing) : "not played",
                      o.evaluations, o.seconds));
}

std::string report_html(const Answer& a, const Run& run) {
  const Optimum& o = a.best;
  Report report("Best landing: " + a.scene.name);
  if (!a.scene.floor_source.empty()) report.paragraph("Floor constants: " + a.scene.floor_source + ".");
  std::vector<std::vector<std::string>> rows = {
      {"phi_I [deg]", fmt::format("{:.6g}", o.motion.phi_i * kDegrees)},
      {"phi_F [deg]", fmt::format("{:.6g}", o.motion.phi_f * kDegrees)},
      {"duration [s]", fmt::format("{:.6g}", o.motion.duration)},
      {"peak |ddr_0| [m/s²]", words(a.peak(), 6)},
      {"tolerant peak [m/s²]", a.tolerant_known() ? words(o.tolerant.value, 6) : "not played"},
      {"held at -45 deg [m/s²]", words(a.held_peak(), 6)},
      {"reduction", fmt::format("{:.1f} %", 100 * a.reduction())}};
  if (a.evidence)
    for (const auto& [what, peak] : deviations(*a.evidence)) rows.push_back({"with " + what + " [m/s²]", words(peak)});
  rows.push_back({"contacts", order_of(a.landing)});
  rows.push_back({"motions evaluated", std::to_string(o.evaluations)});
  report.table({"", "value"}, rows);
  report.list(run.warnings());
  Series acc{"|ddr_0|", {}, {}}, phi{"phi_1", {}, {}}, ref{"phi_ref", {}, {}};
  for (const Sample& s : a.landing.trajectory) {
    for (Series* p : {&acc, &phi, &ref}) p->x.push_back(s.t);
    acc.y.push_back(s.acc), phi.y.push_back(s.phi1 * kDegrees), ref.y.push_back(s.phi_ref * kDegrees);
  }
  report.plot("t [s] after release", "|ddr_0| [m/s²]", {acc});
  report.plot("t [s] after release", "joint [deg]", {phi, ref});
  return report.html(run.provenance());
}

/// When what must be there by a deadline has to end; without one, and until Ctrl-C, never.
class Schedule {
 public:
  Schedule(const Run& run, std::optional<double> deadline) : run_(run), deadline_(deadline) {}

  /// Plays the held reference, and what follows a search with it in the place of the answer: so the time that has to be
  /// kept back is measured. Of a deadline it takes a tenth at most, or it is not known.
  void rehearse(Answer& a, double rate, double csv_rate) {
    const double start = clock_.seconds();
    if (deadline_) until_ = start + 0.1 * (*deadline_ - start);
    a.held = play(a, {-45 / kDegrees, -45 / kDegrees, 1}, rate);
    until_ = kNever;
    if (!deadline_) return;
    const double played = clock_.seconds();
    a.landing = a.held;
    (void)motion_csv(run_, {a.scene.search.phi[0], a.scene.search.phi[1], a.scene.search.duration[1]}, csv_rate);
    if (rate > 0) (void)report_html(a, run_);
    const double composed = clock_.seconds();
    require_writable_folder(run_.options().folder);
    constexpr double kTwice = 2, kFiles = 8, kExit = 2e-3;  // the program's own end takes 1 ms
    landing_ = kTwice * (played - start);
    writing_ = kTwice * (composed - played) + kFiles * (clock_.seconds() - composed) + kExit;
  }
  /// What is left for the search; at least a little, for a refusal with its reason.
  double search() const { return std::max(1e-3, *deadline_ - landing_ - writing_ - clock_.seconds()); }

  /// A landing for the report, as far as the time goes: after Ctrl-C a moment.
  Landing play(const Answer& a, const Motion& motion, double rate) {
    if (interrupted())
      until_ = std::min(until_, clock_.seconds() + kMoment);
    else if (deadline_ && writing_ > 0)
      until_ = *deadline_ - writing_;
    const bool leaving = interrupted();
    const std::function<bool()> over = [&] { return clock_.seconds() >= until_ || (!leaving && interrupted()); };
    return simulate(a.scene, a.actuator.sea, motion, {.accuracy = a.options.accuracy, .over = &over}, rate);
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity(), kMoment = 0.1;  // [s]
  const Clock clock_;
  const Run& run_;
  const std::optional<double> deadline_;
  double until_ = kNever, landing_ = 0, writing_ = 0;
};

}  // namespace

int run_optimize(const OptimizeArguments& a, const CommonOptions& common, Optimum* best) {
  Run run("optimize", common);
  Schedule schedule(run, a.deadline);
  const Scene scene = read_scene(a.scene);
  run.input(a.scene);
  const Actuator actuator = actuator_of(a.actuator, run);
  if (!(a.rate > 0 && a.rate <= 1e6)) throw InputError(fmt::format("--rate: {}: above 0 to 1e6 Hz is needed", a.rate));
  OptimizeOptions options = options_of(a, common, actuator);
  options.monitor = run.monitor("optimize");
  const char* goal = options.goal == Goal::kPeak ? "peak" : "tolerant";
  run.info(fmt::format("optimising the {} of {} with {}: {}, seed {}", goal, scene.name, a.solver,
                       options.deadline
                           ? fmt::format("{:g} s", *options.deadline)
                           : fmt::format("{} motions", options.evaluations.value_or(default_evaluations(options.goal))),
                       options.seed));

  Answer answer{.scene = scene, .actuator = actuator, .options = options};
  const double rate = common.report == CommonOptions::Report::kWrite ? 1000 : 0;
  schedule.rehearse(answer, rate, a.rate);
  if (a.deadline) options.deadline = schedule.search();
  SolverTables tables(run);
  Json comparison;
  Optimum& o = answer.best;
  if (a.solver == "compare") {
    o = compare_solvers(scene, actuator, options, run, tables, comparison);
  } else {
    o = optimize(scene, actuator.sea, options);
    tables.add(options.solver, o);
  }
  if (best) *best = o;
  Json summary;
  if (o.found) {
    answer.landing = schedule.play(answer, o.motion, rate);
    if ((!a.deadline || a.evidence == OptimizeArguments::Extras::kAlways) && !options.monitor.stopped()) {
      const bool always = a.evidence == OptimizeArguments::Extras::kAlways;
      const Stopwatch watch(Stopwatch::Time::kWall);
      answer.evidence = evidence(scene, actuator.sea, o.motion,
                                 {.accuracy = options.accuracy,
                                  .tolerance_samples = a.deadline ? options.tolerance_samples : 0,
                                  .seed = options.seed,
                                  .threads = options.threads,
                                  .work = always ? kUnbounded : kCheckWork,
                                  .monitor = run.monitor("evidence")});
      answer.evidence_time = watch.seconds();
      if (a.deadline && answer.evidence->tolerant.complete) o.tolerant = answer.evidence->tolerant;
    }
    warn(answer, run);
    summary = summary_of(answer, run);
    say(answer, run);
    run.add("motion.toml", to_toml(o.motion, run.provenance_text()));
    run.add("motion.csv", motion_csv(run, o.motion, a.rate));
    run.add("solvers.csv", tables.solvers.text());
    run.add("progress.csv", tables.progress.text());
    if (rate > 0) run.add("report.html", report_html(answer, run));
  } else {
    run.warn(o.message);
    summary = {{"motion", nullptr}, {"evaluations", o.evaluations}, {"solver", a.solver}};
  }
  summary["objective"] = goal;
  summary["seed"] = options.seed;
  if (!comparison.is_null()) summary["solvers"] = comparison;
  return run.finish(summary, o.found ? kDone : kNumbers);
}

void add_optimize(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<OptimizeArguments>();
  auto common = std::make_shared<CommonOptions>();
  CLI::App* verb =
      app.add_subcommand("optimize", "the knee motion with the smallest peak acceleration of the thigh (Eq. 6)");
  verb->add_option("SCENE", args->scene, "scene file (TOML)")->required();
  verb->add_option("--actuator", args->actuator, "actuator file (TOML)")->required();
  std::string names;
  for (const std::string& n : solver_names()) names += n + ", ";
  verb->add_option("--solver", args->solver, names + "or compare: all of them, side by side [auto]");
  verb->add_option_function<std::string>(
      "--objective",
      [args](const std::string& s) {
        args->goal = choice<Goal>("--objective", s, {{"peak", Goal::kPeak}, {"tolerant", Goal::kTolerant}});
      },
      "peak, or tolerant: the worst peak within the scene's [execution] tolerance [peak]");
  verb->add_option("--evaluations", args->evaluations,
                   "motions in all: the stopping rule [40000; tolerant 10000; none with --deadline]");
  verb->add_option("--deadline", args->deadline,
                   "when the answer is there, verified and written, from the program's start [s]");
  verb->add_flag_callback(
      "--evidence", [args] { args->evidence = OptimizeArguments::Extras::kAlways; },
      "play the deviations, the basin's widths and the points inside the execution box also with a deadline, beyond "
      "it, "
      "and however long it takes");
  verb->add_option("--tolerance", args->tolerance,
                   "stop once 5000 motions in a row better the best by less than this fraction [0: never]");
  verb->add_option("--forbid", args->forbid, "points that must never touch: hip,knee,foot")->delimiter(',');
  verb->add_flag_callback(
      "--respect-ratings", [args] { args->ratings = OptimizeArguments::Ratings::kRespect; },
      "keep the reference's rate, the motor's speed and its torque within the actuator's speed_max and tau_max");
  verb->add_option("--rate", args->rate, "rows of motion.csv a second [1000 Hz]");
  add_common(*verb, *common);
  verb->footer("Example: ukemi optimize scene.toml --actuator actuator.toml -o out");
  verb->callback([args, common, &chosen] { chosen = [args, common] { return run_optimize(*args, *common); }; });
}

}  // namespace ukemi::tools
