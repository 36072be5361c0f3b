// ukemi demo: the whole chain on the shipped data.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "common/error.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

int run_demo(CommonOptions common) {
  Run run("demo", common);
  const std::string folder = run.options().folder;
  const auto part = [&](const char* name) {
    CommonOptions o = common;
    o.folder = folder + "/" + name;
    o.out = CommonOptions::Stdout::kText;
    return o;
  };
  const auto heading = [&](const std::string& s) { run.say(""), run.say("== " + s); };
  // With --json the parts' own lines must not reach stdout.
  const auto quieted = [&](CommonOptions o) {
    if (common.out == CommonOptions::Stdout::kJson) o.out = CommonOptions::Stdout::kSilent;
    return o;
  };

  heading("identify: eight simulated impact trials (truth: Table 2)");
  IdentifyArguments identify_arguments;
  for (int i = 1; i <= 8; ++i) identify_arguments.trials.push_back(dataset(fmt::format("impact/trial_{}.csv", i)));
  identify_arguments.rig = dataset("rigs/paper.toml");
  Actuator identified;
  run.withdraw_summary();
  int code = run_identify(identify_arguments, quieted(part("identify")), &identified);
  if (code != kDone) return code;
  const std::string identified_file = folder + "/identify/actuator.toml";

  heading("optimize: the paper's landing, with the constants just identified");
  OptimizeArguments optimize_arguments;
  optimize_arguments.scene = dataset("scenes/paper.toml");
  optimize_arguments.actuator = identified_file;
  Optimum best;
  code = run_optimize(optimize_arguments, quieted(part("optimize")), &best);
  if (code != kDone) return code;

  heading("compare: identified against nominal (x8-9_nominal.toml)");
  CompareArguments compare_arguments;
  compare_arguments.nominal = dataset("actuators/x8-9_nominal.toml");
  compare_arguments.identified = identified_file;
  compare_arguments.scene = optimize_arguments.scene;
  compare_arguments.trials = identify_arguments.trials;
  compare_arguments.rig = identify_arguments.rig;
  compare_arguments.identified_best = best;
  Json comparison;
  code = run_compare(compare_arguments, quieted(part("compare")), &comparison);
  if (code != kDone) return code;

  // Table 2 itself, and the paper's facts.
  const Scene scene = read_scene(optimize_arguments.scene);
  const Actuator table2 = read_actuator(dataset("actuators/table2.toml"));
  OptimizeOptions options;
  options.seed = common.seed, options.threads = common.threads;
  options.monitor = run.monitor("optimize, Table 2");
  const Optimum of_table2 = optimize(scene, table2.sea, options);
  if (options.monitor.stopped() || !of_table2.found) {
    if (!of_table2.found) run.warn("Table 2: " + of_table2.message);
    return run.finish({{"identified", motion_json(best.motion)}}, kNumbers);
  }
  const SimulateOptions tight{.accuracy = 1e-12};
  const auto constant = [&](const Scene& s) {
    return simulate(s, table2.sea, {-45 / kDegrees, -45 / kDegrees, 1}, tight);
  };
  const Landing held = constant(scene), played = simulate(scene, table2.sea, of_table2.motion, tight);
  const auto nth = [](const Landing& l) {  // which interval holds the peak
    int n = 0, at = 0;
    double largest = 0;
    for (const Peak& p : l.peaks)
      if (p.point >= 0 && (++n, p.acceleration > largest)) largest = p.acceleration, at = n;
    return at;
  };

  heading("how the best motion moves with the constants (scene paper.toml)");
  const auto line = [&](const std::string& name, const Motion& m, double peak, double tolerant) {
    run.say(fmt::format("{:22} {:8.3f} to {:8.3f} deg in {:.4f} s   peak {:7.2f}   tolerant peak {:7.2f} m/s^2", name,
                        m.phi_i * kDegrees, m.phi_f * kDegrees, m.duration, peak, tolerant));
  };
  line("identified", best.motion, best.landing.peak, best.tolerant.value);
  line("Table 2", of_table2.motion, of_table2.landing.peak, of_table2.tolerant.value);
  const Json& nominal = comparison["motions"]["nominal"];
  line("nominal",
       {nominal["phi_i_deg"].get<double>() / kDegrees, nominal["phi_f_deg"].get<double>() / kDegrees,
        nominal["duration"].get<double>()},
       comparison["peaks"]["nominal_motion"]["nominal"], comparison["tolerant_peaks"]["nominal"]);

  heading("paper | ukemi (Table 2; floor and pitch calibrated, not published)");
  Json table = Json::array();
  const auto row = [&](const std::string& what, const std::string& paper, const std::string& ukemi,
                       const std::string& note) {
    run.say(fmt::format("{:34} | {:30} | {:30} | {}", what, paper, ukemi, note));
    table.push_back({{"fact", what}, {"paper", paper}, {"ukemi", ukemi}, {"note", note}});
  };
  row("held at -45 deg: peak [m/s^2]", "466", fmt::format("{:.9g}", held.peak), "");
  row("held at -45 deg: contacts", "foot, knee, hip, knee, foot", order_of(held), "");
  row("held at -45 deg: peak at contact", "3", std::to_string(nth(held)), "");
  row("best motion: peak [m/s^2]", "181", fmt::format("{:.5g}", played.peak),
      "a cliff stands beside it: see the next line");
  row("  its tolerant peak [m/s^2]", "-", fmt::format("{:.5g}", of_table2.tolerant.value),
      fmt::format("played within {:g} deg, {:g} ms", scene.execution.phi * kDegrees, scene.execution.duration * 1e3));
  const std::string order = order_of(played);
  row("best motion: contacts", "foot, foot, knee, knee, foot", order,
      order == "foot, foot, knee, knee, foot" ? "" : "the order differs from the paper's");
  row("best motion: peak at contact", "3", std::to_string(nth(played)), "");
  row("reduction", "61 %", fmt::format("{:.1f} %", 100 * (1 - played.peak / held.peak)), "");
  row("run time of the search", "890 s (GA, MATLAB)", "see time_s of optimize/summary.json",
      "other machine, other method");
  for (const char* other : {"paper_rough_a", "paper_rough_b", "paper_soft"})
    row(fmt::format("{}: held at -45 deg", other), "466",
        fmt::format("{:.9g}", constant(read_scene(dataset(fmt::format("scenes/{}.toml", other)))).peak),
        "another calibrated floor");

  Json summary;
  summary["identified"] = {{"motion", motion_json(best.motion)},
                           {"peak_acceleration", best.landing.peak},
                           {"tolerant_peak", best.tolerant.value}};
  summary["table2"] = {{"motion", motion_json(of_table2.motion)},
                       {"peak_acceleration", of_table2.landing.peak},
                       {"tolerant_peak", of_table2.tolerant.value}};
  summary["nominal"] = {{"motion", nominal},
                        {"peak_acceleration", comparison["peaks"]["nominal_motion"]["nominal"]},
                        {"tolerant_peak", comparison["tolerant_peaks"]["nominal"]}};
  summary["paper"] = table;
  run.say("");
  return run.finish(summary, kDone);
}

}  // namespace

void add_demo(CLI::App& app, Action& chosen) {
  auto common = std::make_shared<CommonOptions>();
  CLI::App* verb = app.add_subcommand("demo", "the whole chain on the shipped data: identify, optimize, compare");
  add_common(*verb, *common);
  verb->footer("Example: ukemi demo -o out");
  verb->callback([common, &chosen] { chosen = [common] { return run_demo(*common); }; });
}

}  // namespace ukemi::tools
