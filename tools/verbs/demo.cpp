// ukemi demo: the whole chain on the shipped data.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/terminal.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/landing.hpp"
#include "tools/verbs/runs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// The name of a set of constants, and the best motion for it.
using BestOf = std::pair<std::string, const Optimum*>;
Quantities<BestOf> best_quantities() {
  Quantities<BestOf> out = {{"", "", "constants", {}, &BestOf::first}};
  append(out, "motion/", motion_quantities({}), [](auto& b) { return b.second->motion; });
  out.push_back({"", "peak_acceleration", "peak [m/s^2]", "{:.2f}", [](auto& b) { return b.second->landing.peak; }});
  out.push_back(
      {"", "tolerant_peak", "tolerant peak [m/s^2]", "{:.2f}", [](auto& b) { return b.second->tolerant.value; }});
  return out;
}

/// A result of the paper, and ours.
struct Fact {
  std::string what, paper, ukemi, note;
};
const Quantities<Fact> kFactQuantities = {
    {"", "fact", "fact", {}, &Fact::what},
    {"", "paper", "paper", {}, &Fact::paper},
    {"", "ukemi", "ukemi (Table 2; floor and pitch calibrated, not published)", {}, &Fact::ukemi},
    {"", "note", "note", {}, &Fact::note},
};

/// Number of the contact with the largest peak, from 1.
std::string peak_contact(const Landing& l) {
  int n = 0, at = 0;
  double largest = 0;
  for (const Peak& p : l.peaks)
    if (p.point >= 0 && (++n, p.acceleration > largest)) largest = p.acceleration, at = n;
  return std::to_string(at);
}

std::vector<Fact> facts(const Scene& scene, const SeaParameters<double>& table2, const Optimum& best) {
  const SimulateOptions tight{.accuracy = 1e-12};
  const Landing held = simulate(scene, table2, kHeld, tight), played = simulate(scene, table2, best.motion, tight);
  const std::string order = contact_order(played.contacts), published = "foot, foot, knee, knee, foot";
  std::vector<Fact> out = {
      {"held at -45 deg: peak [m/s^2]", "466", fmt::format("{:.9g}", held.peak), ""},
      {"held at -45 deg: contacts", "foot, knee, hip, knee, foot", contact_order(held.contacts), ""},
      {"held at -45 deg: peak at contact", "3", peak_contact(held), ""},
      {"best motion: peak [m/s^2]", "181", fmt::format("{:.5g}", played.peak),
       "a cliff stands beside it: see the next line"},
      {"  its tolerant peak [m/s^2]", "-", fmt::format("{:.5g}", best.tolerant.value),
       fmt::format("played within {:g} deg, {:g} ms", scene.execution.phi * kDegrees, scene.execution.duration * 1e3)},
      {"best motion: contacts", published, order, order == published ? "" : "the order differs from the paper's"},
      {"best motion: peak at contact", "3", peak_contact(played), ""},
      {"reduction", "61 %", percent_words(1 - played.peak / held.peak), ""},
      {"run time of the search", "890 s (GA, MATLAB)", "see time_s of optimize/summary.json",
       "other machine, other method"}};
  for (const std::string other : {"paper_rough_a", "paper_rough_b", "paper_soft"}) {
    const Landing landing = simulate(read_scene(dataset("scenes/" + other + ".toml")), table2, kHeld, tight);
    out.push_back(
        {other + ": held at -45 deg", "466", fmt::format("{:.9g}", landing.peak), "another calibrated floor"});
  }
  return out;
}

struct DemoArguments {
  enum class Reports { kList, kOpen } reports = Reports::kList;
};

/// Lists the reports of the parts, and opens them with --open.
void list_reports(const DemoArguments& a, const std::string& folder, const CommonOptions& common, Run& run) {
  if (common.report == CommonOptions::Report::kSkip) return;
  run.say(""), run.say("Reports to open:");
  for (const char* part : {"", "/identify", "/optimize", "/compare"}) {
    const std::string file = folder + part + "/report.html";
    run.say("  " + file);
    if (a.reports == DemoArguments::Reports::kOpen && !open_for_reader(file))
      run.warn("--open: " + file + " cannot be opened: no xdg-open is installed");
  }
}

/// Writes the summary page of the chain, with a link to each part's report.
void report_chain(const Comparison& c, const Table& best, const Table& published, Run& run) {
  const Optimum& plan = c.motions[1].best;
  Report page("From trials to a soft landing");
  const bool landed = plan.found && c.motions[1].landings[1] && c.motions[0].landings[1];
  FirstScreen first{.sentence = "Eight impact trials give the actuator's constants, and these a landing."};
  if (landed)
    first.sentence += fmt::format(" It hits with {:.4g} m/s^2; planned with the data sheet's constants, {:.4g}.",
                                  c.motions[1].landings[1]->peak, c.motions[0].landings[1]->peak);
  first.checks = {check(plan.found, "a landing was found", ""), check(c.complete, "the comparison is complete", "")};
  first.next = "Open the three reports below in their order.";
  page.answer(first, run.warnings());
  page.heading("The chain");
  page.link("identify/report.html", "1. Identify", "what the actuator is: its constants from eight impact trials.");
  page.link("optimize/report.html", "2. Optimize", "how to land with it: a motion for drops that scatter.");
  page.link("compare/report.html", "3. Compare", "what it was good for: the same with the data sheet's constants.");
  page.heading("How the best motion moves with the constants");
  page.table(best);
  page.heading("Beside the paper");
  page.table(published);
  page.distrust(run.warnings());
  page.write(run);
}

/// Runs the verbs one after another, each into a folder of its own; kDone, or the code of the first that fails.
int run_chain(const CommonOptions& common, Run& run, Comparison& comparison) {
  const std::string folder = run.options().folder, paper = dataset("scenes/paper.toml");
  const auto begin = [&](const char* part, const std::string& heading) {
    run.say(""), run.say("== " + heading);
    CommonOptions o = common;
    o.folder = folder + "/" + part;
    // With --json the parts' own lines must not reach stdout.
    if (o.out == CommonOptions::Stdout::kJson) o.out = CommonOptions::Stdout::kSilent;
    return o;
  };
  IdentifyArguments identify_arguments;
  for (int i = 1; i <= 8; ++i) identify_arguments.trials.push_back(dataset(fmt::format("impact/trial_{}.csv", i)));
  identify_arguments.rig = dataset("rigs/paper.toml");
  int code =
      run_identify(identify_arguments, begin("identify", "identify: eight simulated impact trials (truth: Table 2)"));
  if (code != kDone) return code;
  const std::string identified = folder + "/identify/actuator.toml";
  OptimizeArguments optimize_arguments;
  optimize_arguments.scene = paper, optimize_arguments.actuators = {identified}, optimize_arguments.robust = "mean";
  code = run_optimize(
      optimize_arguments,
      begin("optimize", "optimize: the paper's landing for drops that scatter, with the constants just identified"));
  if (code != kDone) return code;
  return run_compare({.nominal = {dataset("actuators/x8-9_nominal.toml")},
                      .identified = {identified},
                      .scene = paper,
                      .rig = identify_arguments.rig,
                      .trials = identify_arguments.trials},
                     begin("compare", "compare: identified against nominal (x8-9_nominal.toml)"), &comparison);
}

int run_demo(const DemoArguments& a, const CommonOptions& common) {
  Run run(Outputs{"demo", {}}, common);
  run.withdraw_results();
  Comparison comparison;
  if (const int code = run_chain(common, run, comparison); code != kDone) return code;

  // Table 2 itself, and the paper's numbers.
  const Scene scene = read_scene(dataset("scenes/paper.toml"));
  const SeaParameters<double> table2 = read_actuator(dataset("actuators/table2.toml")).sea;
  OptimizeOptions options;
  options.seed = common.seed, options.threads = common.threads;
  options.monitor = run.monitor("optimize, Table 2", "motions");
  const Optimum of_table2 = optimize(scene, table2, options);
  if (options.monitor.stopped() || !of_table2.found) {
    if (!of_table2.found) run.warn("Table 2: " + of_table2.message);
    return run.finish({{"identified", motion_json(comparison.motions[1].best.motion)}}, kNumbers);
  }
  const Table best(
      best_quantities(),
      {{"identified", &comparison.motions[1].best}, {"Table 2", &of_table2}, {"nominal", &comparison.motions[0].best}});
  const Table published(kFactQuantities, facts(scene, table2, of_table2));
  run.say(""), run.say("== how the best motion moves with the constants (scene paper.toml)");
  say(best, run);
  run.say(""), run.say("== beside the paper");
  say(published, run);
  report_chain(comparison, best, published, run);
  list_reports(a, run.options().folder, common, run);
  return run.finish({{"identified", best.object(0)},
                     {"table2", best.object(1)},
                     {"nominal", best.object(2)},
                     {"paper", published.objects()}},
                    kDone);
}

void add_demo(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<DemoArguments>();
  verb->add_flag_callback(
      "--open", [args] { args->reports = DemoArguments::Reports::kOpen; }, "open the reports in the browser");
  add_action<DemoArguments>(*verb, args, "ukemi demo -o out", chosen, run_demo);
}

const Verb demo_verb(VerbGroup::kProgram, "demo", "the whole chain on the shipped data: identify, optimize, compare",
                     add_demo);

}  // namespace

}  // namespace ukemi::tools
