// ukemi optimize.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "common/error.hpp"
#include "landing/scene_file.hpp"
#include "landing/solvers.hpp"
#include "tools/arguments.hpp"
#include "tools/report.hpp"
#include "tools/verbs.hpp"

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

}  // namespace

namespace {

/// The options as the command line gives them.
OptimizeOptions options_of(const OptimizeArguments& a, const CommonOptions& common, const Actuator& actuator) {
  OptimizeOptions o;
  o.solver = a.solver;
  o.goal = a.goal;
  o.evaluations = a.evaluations;
  o.deadline = a.deadline;
  o.tolerance = a.tolerance;
  o.seed = common.seed;
  o.threads = common.threads;
  for (const std::string& point : a.forbid)
    o.limits.forbidden[choice_index("--forbid", point, {kPointNames.begin(), kPointNames.end()})] = true;
  if (a.ratings == OptimizeArguments::Ratings::kRespect) {
    if (!actuator.speed_max && !std::isfinite(actuator.sea.tau_max))
      throw InputError("--respect-ratings: " + a.actuator + " gives neither speed_max nor tau_max");
    if (actuator.speed_max) o.limits.motor_speed = o.reference_rate = *actuator.speed_max;
    o.limits.motor_torque = actuator.sea.tau_max;
  }
  return o;
}

/// What a search came to, and how: the moments at which its best became better, in the search's own accuracy.
struct SolverTables {
  CsvWriter &results, &progress;
  void add(const std::string& solver, const Optimum& o) {
    for (const Progress& p : o.progress)
      progress.cell(solver).cell(p.motions).cell(p.landings).cell(p.seconds).cell(p.best.value).end_row();
    results.cell(solver).cell(o.evaluations).cell(o.seconds).cell(o.found ? o.value : kNoMotion).end_row();
  }
};

/// Every solver with the same budget; the best of them, and a table of all.
Optimum compare_solvers(const Scene& scene, const Actuator& actuator, OptimizeOptions options, const Run& run,
                        SolverTables tables, Json& table) {
  Optimum best;
  const auto names = solver_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    run.progress("solvers", long(i), long(names.size()));
    options.solver = names[i];
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

}  // namespace

int run_optimize(const OptimizeArguments& a, const CommonOptions& common, Optimum* best) {
  Run run("optimize", common);
  const Scene scene = read_scene(a.scene);
  const Actuator actuator = read_actuator(a.actuator);
  run.input(a.scene), run.input(a.actuator);
  if (!(a.rate > 0 && a.rate <= 1e6)) throw InputError(fmt::format("--rate: {}: above 0 to 1e6 Hz is needed", a.rate));
  OptimizeOptions options = options_of(a, common, actuator);
  const bool compare = a.solver == "compare";
  if (compare) options.solver = "auto";
  options.validate();
  const char* goal = options.goal == Goal::kPeak ? "peak" : "tolerant";
  options.progress = [&](long done, long total) {
    if (total < std::numeric_limits<long>::max()) run.progress("optimize", done, total);
  };
  run.info(fmt::format("optimising the {} of {} with {}: {}, seed {}", goal, scene.name, a.solver,
                       options.deadline
                           ? fmt::format("{:g} s", *options.deadline)
                           : fmt::format("{} motions", options.evaluations.value_or(default_evaluations(options.goal))),
                       options.seed));

  CsvWriter solvers = run.csv();
  solvers.header({"solver", "evaluations", "time_s", "best"});
  CsvWriter progress = run.csv();
  progress.header({"solver", "evaluations", "landings", "time_s", "best"});
  SolverTables tables{solvers, progress};
  Json comparison = Json::array();
  Optimum o;
  if (compare) {
    options.progress = nullptr;
    o = compare_solvers(scene, actuator, options, run, tables, comparison);
  } else {
    o = optimize(scene, actuator.sea, options);
    o.solver = options.solver;
    tables.add(options.solver, o);
  }
  const double search_seconds = o.seconds;
  if (best) *best = o;
  if (!o.found) {
    run.warn(o.message);
    return run.finish({{"motion", nullptr},
                       {"objective", goal},
                       {"evaluations", o.evaluations},
                       {"solver", a.solver},
                       {"seed", options.seed}},
                      kNumbers);
  }
  warn_if_unstable(scene, actuator, o.motion, run);
  const Landing l = simulate(scene, actuator.sea, o.motion, {.accuracy = options.accuracy}, 1000);
  const Motion hold{-45 / kDegrees, -45 / kDegrees, 1};
  const LandingPeak held = peak_acceleration(scene, actuator.sea, hold, {.accuracy = options.accuracy});
  if (o.tolerant.sampled > o.tolerant.value)
    run.warn(fmt::format(
        "inside the execution tolerance a peak of {:.5g} was found, above the tolerant peak {:.5g} of its 15 points",
        o.tolerant.sampled, o.tolerant.value));
  if (o.tolerant.value > 1.05 * o.tolerant.peak)
    run.warn(
        fmt::format("the motion stands on a cliff: played within {:g} deg and {:g} ms its peak may reach {:.4g} m/s^2",
                    scene.execution.phi * kDegrees, scene.execution.duration * 1e3, o.tolerant.value));

  Json summary;
  summary["motion"] = motion_json(o.motion);
  summary["peak_acceleration"] = number(l.peak);
  summary["peak_time"] = number(l.t_peak);
  summary["tolerant_peak"] = number(o.tolerant.value);
  summary["tolerant_sampled"] = {{"samples", o.tolerant.samples}, {"worst", number(o.tolerant.sampled)}};
  summary["execution"] = {{"phi_deg", scene.execution.phi * kDegrees}, {"duration", scene.execution.duration}};
  summary["contacts"] = contacts_json(l);
  summary["peaks"] = peaks_json(l);
  summary["hold"] = {{"phi_deg", -45}, {"peak_acceleration", number(held.peak)}};
  summary["reduction"] = number(1 - l.peak / held.peak);
  const Evidence e = evidence(scene, actuator.sea, o.motion, options.accuracy, 0, options.seed, options.threads);
  summary["evidence"] = evidence_json(e);
  summary["ratings"] = ratings(o.motion, l, actuator, run);
  summary["objective"] = goal;
  summary["evaluations"] = o.evaluations;
  summary["landings"] = o.landings;
  summary["solver"] = o.solver;
  if (compare) summary["solvers"] = comparison;
  summary["seed"] = options.seed;

  run.say(fmt::format("motion: {:.6g} deg to {:.6g} deg in {:.6g} s", o.motion.phi_i * kDegrees,
                      o.motion.phi_f * kDegrees, o.motion.duration));
  run.say(fmt::format(
      "peak {:.6g} m/s^2; tolerant peak {:.6g} (within {:g} deg, {:g} ms); held at -45 deg {:.6g}; reduction {:.1f} %",
      l.peak, o.tolerant.value, scene.execution.phi * kDegrees, scene.execution.duration * 1e3, held.peak,
      100 * (1 - l.peak / held.peak)));
  run.say(fmt::format("contacts: {}; {} motions in {:.2f} s", order_of(l), o.evaluations, search_seconds));

  run.add("motion.toml", to_toml(o.motion, run.provenance_text()));
  run.add("motion.csv", motion_csv(run, o.motion, a.rate));
  run.add("solvers.csv", solvers.text());
  run.add("progress.csv", progress.text());
  Report report("Best landing: " + scene.name);
  if (!scene.floor_source.empty()) report.paragraph("Floor constants: " + scene.floor_source + ".");
  report.table({"", "value"}, {{"phi_I [deg]", fmt::format("{:.6g}", o.motion.phi_i * kDegrees)},
                               {"phi_F [deg]", fmt::format("{:.6g}", o.motion.phi_f * kDegrees)},
                               {"duration [s]", fmt::format("{:.6g}", o.motion.duration)},
                               {"peak |ddr_0| [m/s²]", fmt::format("{:.6g}", l.peak)},
                               {"tolerant peak [m/s²]", fmt::format("{:.6g}", o.tolerant.value)},
                               {"held at -45 deg [m/s²]", fmt::format("{:.6g}", held.peak)},
                               {"reduction", fmt::format("{:.1f} %", 100 * (1 - l.peak / held.peak))},
                               {"with the angles off by 1 deg [m/s²]", fmt::format("{:.4g}", e.one_degree)},
                               {"with the duration off by 10 ms", fmt::format("{:.4g}", e.ten_milliseconds)},
                               {"with the height off by 1 cm", fmt::format("{:.4g}", e.one_centimetre)},
                               {"contacts", order_of(l)},
                               {"motions evaluated", std::to_string(o.evaluations)}});
  report.list(run.warnings());
  Series acc{"|ddr_0|", {}, {}}, phi{"phi_1", {}, {}}, ref{"phi_ref", {}, {}};
  for (const Sample& s : l.trajectory) {
    for (Series* p : {&acc, &phi, &ref}) p->x.push_back(s.t);
    acc.y.push_back(s.acc), phi.y.push_back(s.phi1 * kDegrees), ref.y.push_back(s.phi_ref * kDegrees);
  }
  report.plot("t [s] after release", "|ddr_0| [m/s²]", {acc});
  report.plot("t [s] after release", "joint [deg]", {phi, ref});
  run.add("report.html", report.html(run.provenance()));
  return run.finish(summary, kDone);
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
  verb->add_option("--deadline", args->deadline, "answer within this time [s], whatever has been found");
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
