// ukemi optimize.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "common/error.hpp"
#include "landing/scene_file.hpp"
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

int run_optimize(const OptimizeArguments& a, const CommonOptions& common, Optimum* best) {
  Run run("optimize", common);
  const Scene scene = read_scene(a.scene);
  const Actuator actuator = read_actuator(a.actuator);
  run.input(a.scene), run.input(a.actuator);
  if (!(a.rate > 0 && a.rate <= 1e6)) throw InputError(fmt::format("--rate: {}: above 0 to 1e6 Hz is needed", a.rate));
  OptimizeOptions options;
  options.solver = a.solver;
  options.evaluations = a.evaluations.value_or(options.evaluations);
  options.seed = common.seed;
  options.threads = common.threads;
  options.validate();
  options.progress = [&](long done, long total) { run.progress("optimize", done, total); };
  run.info(fmt::format("optimising {} with {}: {} landings, seed {}", scene.name, options.solver, options.evaluations,
                       options.seed));

  const Optimum o = optimize(scene, actuator.sea, options);
  const double search_seconds = run.seconds();
  if (best) *best = o;
  if (!o.found) {
    run.warn(o.message);
    return run.finish(
        {{"motion", nullptr}, {"evaluations", o.evaluations}, {"solver", options.solver}, {"seed", options.seed}},
        kNumbers);
  }
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
  summary["ratings"] = ratings(o.motion, l, actuator, run);
  summary["evaluations"] = o.evaluations;
  summary["solver"] = options.solver;
  summary["seed"] = options.seed;

  run.say(fmt::format("motion: {:.6g} deg to {:.6g} deg in {:.6g} s", o.motion.phi_i * kDegrees,
                      o.motion.phi_f * kDegrees, o.motion.duration));
  run.say(fmt::format(
      "peak {:.6g} m/s^2; tolerant peak {:.6g} (within {:g} deg, {:g} ms); held at -45 deg {:.6g}; reduction {:.1f} %",
      l.peak, o.tolerant.value, scene.execution.phi * kDegrees, scene.execution.duration * 1e3, held.peak,
      100 * (1 - l.peak / held.peak)));
  run.say(fmt::format("contacts: {}; {} landings in {:.2f} s", order_of(l), o.evaluations, search_seconds));

  run.add("motion.toml", to_toml(o.motion, run.provenance_text()));
  run.add("motion.csv", motion_csv(run, o.motion, a.rate));
  CsvWriter solvers = run.csv();
  solvers.header({"solver", "evaluations", "time_s", "best"});
  solvers.cell(options.solver).cell(o.evaluations).cell(search_seconds).cell(l.peak).end_row();
  run.add("solvers.csv", solvers.text());
  Report report("Best landing: " + scene.name);
  if (!scene.floor_source.empty()) report.paragraph("Floor constants: " + scene.floor_source + ".");
  report.table({"", "value"}, {{"phi_I [deg]", fmt::format("{:.6g}", o.motion.phi_i * kDegrees)},
                               {"phi_F [deg]", fmt::format("{:.6g}", o.motion.phi_f * kDegrees)},
                               {"duration [s]", fmt::format("{:.6g}", o.motion.duration)},
                               {"peak |ddr_0| [m/s²]", fmt::format("{:.6g}", l.peak)},
                               {"tolerant peak [m/s²]", fmt::format("{:.6g}", o.tolerant.value)},
                               {"held at -45 deg [m/s²]", fmt::format("{:.6g}", held.peak)},
                               {"reduction", fmt::format("{:.1f} %", 100 * (1 - l.peak / held.peak))},
                               {"contacts", order_of(l)},
                               {"landings simulated", std::to_string(o.evaluations)}});
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
  const auto later = [](const std::string& what) { throw InputError(what + ": not in this version"); };
  verb->add_option("SCENE", args->scene, "scene file (TOML)")->required();
  verb->add_option("--actuator", args->actuator, "actuator file (TOML)")->required();
  verb->add_option_function<std::string>(
      "--solver",
      [args, later](const std::string& s) {
        if (s == "compare") later("--solver compare");
        args->solver = s;
      },
      "auto, crs2, direct_l, isres, esch, mlsl, sbplx, nelder_mead, cobyla, bobyqa [auto]");
  verb->add_option_function<std::string>(
      "--objective",
      [later](const std::string& s) {
        if (s == "tolerant") later("--objective tolerant");
        if (s != "peak")
          throw InputError("--objective: " + quoted(s) + ": peak is needed" + hint(s, {"peak", "tolerant"}));
      },
      "peak [peak]");
  verb->add_option("--evaluations", args->evaluations, "landings in all: the stopping rule [12000]");
  verb->add_option("--rate", args->rate, "rows of motion.csv a second [1000 Hz]");
  verb->add_option_function<std::string>(
      "--deadline", [later](const std::string&) { later("--deadline"); }, "not in this version");
  verb->add_option_function<std::string>(
      "--forbid", [later](const std::string&) { later("--forbid"); }, "not in this version");
  verb->add_flag_callback(
      "--respect-ratings", [later] { later("--respect-ratings"); }, "not in this version");
  add_common(*verb, *common);
  verb->footer("Example: ukemi optimize scene.toml --actuator actuator.toml -o out");
  verb->callback([args, common, &chosen] { chosen = [args, common] { return run_optimize(*args, *common); }; });
}

}  // namespace ukemi::tools
