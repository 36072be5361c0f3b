// ukemi bench stability: stiff and extreme landings, and fits of stiff and extreme data, each with its map.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>

#include "common/actuator.hpp"
#include "common/parallel.hpp"
#include "common/random.hpp"
#include "common/stopwatch.hpp"
#include "identify/design/design.hpp"
#include "identify/fit/fit.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/bench/bench.hpp"
#include "tools/bench/stability.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

namespace {

struct Tally {
  int pass = 0, sensitive = 0, coarse = 0, refused = 0, wrong = 0;
  void count(landing::Verdict v) {
    ++(v == landing::Verdict::kPass        ? pass
       : v == landing::Verdict::kSensitive ? sensitive
       : v == landing::Verdict::kCoarse    ? coarse
       : v == landing::Verdict::kRefused   ? refused
                                           : wrong);
  }
  int all() const { return pass + sensitive + coarse + refused + wrong; }
  Json json() const {
    return {{"cases", all()},   {"pass", pass},       {"sensitive", sensitive},
            {"coarse", coarse}, {"refused", refused}, {"wrong", wrong}};
  }
};

Json landings(const BenchArguments& a, Run& run, Report& report) {
  using namespace landing;
  const Scene scene = read_scene(dataset("scenes/paper.toml"));
  const SeaParameters<double> sea = read_actuator(dataset("actuators/table2.toml")).sea;
  const auto grid = stability_grid(scene, sea, a.random, run.options().seed);
  std::vector<StabilityResult> results(grid.size());
  std::vector<double> seconds(grid.size());
  std::mutex mutex;
  long done = 0;
  parallel_for(int(grid.size()), run.options().threads, [&](int i) {
    results[std::size_t(i)] = judge(grid[std::size_t(i)]);
    SimulateOptions once;
    once.max_steps = StabilityLimits{}.max_steps;
    const Stopwatch watch(Stopwatch::Time::kProcessor);
    (void)peak_acceleration(grid[std::size_t(i)].scene, grid[std::size_t(i)].sea, grid[std::size_t(i)].motion, once);
    seconds[std::size_t(i)] = watch.seconds();
    const std::lock_guard lock(mutex);
    run.progress("stability", ++done, long(grid.size()));
  });

  CsvWriter csv = run.csv();
  csv.comment(
      "peak [m/s^2]; energy_residual: over the energy turned over; halving: relative change of the peak with half the "
      "tolerance; sensitivity: relative change with the scene moved by 1e-6, measured where halving fails; time_s of a "
      "landing.");
  csv.header({"factor", "setting", "verdict", "reason", "peak", "energy_residual", "halving", "sensitivity", "steps",
              "implicit_steps", "events", "time_s"});
  Tally all;
  std::vector<std::pair<std::string, Tally>> map;
  double worst_energy = 0, worst_halving = 0, longest = 0;
  long most_steps = 0;
  std::vector<std::vector<std::string>> notable;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const StabilityCase& c = grid[i];
    const StabilityResult& r = results[i];
    csv.cell(c.factor).cell("\"" + c.setting + "\"").cell(name(r.verdict)).cell("\"" + r.reason + "\"").cell(r.peak);
    csv.cell(r.energy_residual).cell(r.halving).cell(r.sensitivity).cell(r.work.steps).cell(r.work.implicit);
    csv.cell(r.work.events).cell(seconds[i]);
    csv.end_row();
    all.count(r.verdict);
    if (map.empty() || map.back().first != c.factor) map.emplace_back(c.factor, Tally{});
    map.back().second.count(r.verdict);
    if (r.verdict != Verdict::kRefused) worst_energy = std::max(worst_energy, r.energy_residual);
    if (r.verdict == Verdict::kPass) worst_halving = std::max(worst_halving, r.halving);
    longest = std::max(longest, seconds[i]), most_steps = std::max(most_steps, r.work.steps);
    if (r.verdict != Verdict::kPass)
      notable.push_back({c.factor, c.setting, name(r.verdict),
                         r.verdict == Verdict::kSensitive ? fmt::format("{:.1e} for 1e-6", r.sensitivity) : r.reason,
                         fmt::format("{:.1e}", r.halving), fmt::format("{:.1e}", r.energy_residual)});
  }
  run.add("stability.csv", csv.text());
  report.heading("Landings");
  report.paragraph(
      fmt::format("{} landings: {} pass, {} sensitive, {} refused ({:.1f} %), {} wrong. Worst energy residual of those "
                  "followed {:.1e}, "
                  "largest change by halving of those that pass {:.1e}, most steps {}, longest landing {:.2f} s.",
                  all.all(), all.pass, all.sensitive, all.refused, 100.0 * all.refused / all.all(), all.wrong,
                  worst_energy, worst_halving, most_steps, longest));
  std::vector<std::vector<std::string>> rows;
  run.say(fmt::format("{:<12} {:>6} {:>6} {:>10} {:>8} {:>6}", "landings", "cases", "pass", "sensitive", "refused",
                      "wrong"));
  map.emplace_back("all", all);
  for (const auto& [factor, t] : map) {
    rows.push_back({factor, std::to_string(t.all()), std::to_string(t.pass), std::to_string(t.sensitive),
                    std::to_string(t.refused), std::to_string(t.wrong)});
    run.say(
        fmt::format("{:<12} {:>6} {:>6} {:>10} {:>8} {:>6}", factor, t.all(), t.pass, t.sensitive, t.refused, t.wrong));
  }
  run.say(
      fmt::format("worst energy residual {:.1e}, halving {:.1e} among the passed; at most {} steps, {:.2f} s a landing",
                  worst_energy, worst_halving, most_steps, longest));
  report.table({"factor", "cases", "pass", "sensitive", "refused", "wrong"}, rows);
  report.heading("All that do not simply pass");
  report.table({"factor", "setting", "verdict", "why", "halving", "energy"}, notable);
  Json out = all.json();
  out["worst_energy_residual"] = worst_energy, out["most_steps"] = most_steps;
  return out;
}

/// Ordinary landings followed three ways: every difference is earned, or wrong.
Json three_ways(const BenchArguments& a, Run& run, Report& report) {
  using namespace landing;
  const SeaParameters<double> sea = read_actuator(dataset("actuators/table2.toml")).sea;
  const Scene paper = read_scene(dataset("scenes/paper.toml"));
  const std::uint64_t seed = run.options().seed;
  struct Group {
    std::string name;
    long count;
    std::function<StabilityCase(std::uint64_t)> draw;
  };
  std::vector<Group> groups;
  for (const std::string name : kShippedScenes) {
    const Scene scene = read_scene(dataset("scenes/" + name + ".toml"));
    groups.push_back({name, a.motions, [=](std::uint64_t i) { return random_motion(scene, sea, seed, i); }});
  }
  groups.push_back({"random scenes", a.scenes, [=](std::uint64_t i) { return random_landing(paper, sea, seed, i); }});
  const long total = a.motions * long(groups.size() - 1) + a.scenes;
  CsvWriter csv = run.csv();
  csv.comment(
      "Landings that do not simply agree. scalar: at 1e-9; lanes: at 1e-6; tight: at 1e-11 [m/s^2]; differences to "
      "tight, relative; sensitivity: with the scene moved by 1e-6. The case belongs to its group, index and seed.");
  csv.header({"group", "index", "verdict", "reason", "scalar", "lanes", "tight", "scalar_difference",
              "lanes_difference", "sensitivity"});
  std::vector<std::vector<std::string>> rows;
  Tally all;
  const char* line = "{:<16} {:>8} {:>8} {:>10} {:>8} {:>8} {:>6} {:>16} {:>16}";
  const auto say = [&](const auto&... cells) { run.say(fmt::format(fmt::runtime(line), cells...)); };
  run.say("");
  say("three ways", "cases", "agree", "sensitive", "coarse", "refused", "wrong", "scalar, passed", "lanes, passed");
  long done = 0;
  for (const Group& g : groups) {
    Tally tally;
    double scalar = 0, lanes = 0;
    constexpr long kPart = 1000;
    for (long from = 0; from < g.count; from += kPart) {
      std::vector<StabilityCase> cases;
      for (long i = from; i < std::min(g.count, from + kPart); ++i) cases.push_back(g.draw(std::uint64_t(i)));
      const auto results = cross_check(cases, run.options().threads);
      for (std::size_t i = 0; i < results.size(); ++i) {
        const CrossCheck& c = results[i];
        tally.count(c.verdict), all.count(c.verdict);
        if (c.verdict == Verdict::kPass) {
          scalar = std::max(scalar, c.scalar_difference), lanes = std::max(lanes, c.lanes_difference);
          continue;
        }
        csv.cell(g.name).cell(cases[i].setting).cell(name(c.verdict)).cell("\"" + c.reason + "\"").cell(c.scalar);
        csv.cell(c.lanes).cell(c.tight).cell(c.scalar_difference).cell(c.lanes_difference).cell(c.sensitivity);
        csv.end_row();
      }
      run.progress("three ways", done += long(cases.size()), total);
    }
    say(g.name, tally.all(), tally.pass, tally.sensitive, tally.coarse, tally.refused, tally.wrong,
        fmt::format("{:.1e}", scalar), fmt::format("{:.1e}", lanes));
    rows.push_back({g.name, std::to_string(tally.all()), std::to_string(tally.pass), std::to_string(tally.sensitive),
                    std::to_string(tally.coarse), std::to_string(tally.refused), std::to_string(tally.wrong),
                    fmt::format("{:.1e}", scalar), fmt::format("{:.1e}", lanes)});
  }
  run.add("three_ways.csv", csv.text());
  report.heading("Landings followed three ways");
  report.paragraph(
      "The scalar path at 1e-9 and in lanes at 1e-6 against the scalar path at 1e-11. A difference of more than 0.1 % "
      "is "
      "sensitive where moving the scene by 1e-6 makes one as well, coarse where the lanes are right at 1e-7; else "
      "wrong.");
  report.table(
      {"", "cases", "agree", "sensitive", "coarse", "refused", "wrong", "largest difference, scalar", "in lanes"},
      rows);
  return all.json();
}

/// Stiff and extreme data for the fit.
struct FitCase {
  std::string what;
  SeaParameters<double> truth;
  double rate = 1000;                             ///< [Hz]
  std::vector<double> peaks{60, -120, 220, 300};  ///< of a half-sine hit each [N]
  double pulse = 0.015;                           ///< [s]
  double until = 0.6;                             ///< [s]
};

identify::Trial simulated(const identify::Rig& rig, const FitCase& c, double peak, std::uint64_t seed,
                          std::uint64_t index) {
  constexpr double kNoise = 2e-4;
  identify::Trial t = identify::blank_log({peak, c.pulse}, {.rate = c.rate, .duration = c.until, .start = 0.02});
  t.file = fmt::format("simulated {:g} N", peak);
  std::vector<double> phi_m;
  const identify::PreparedTrial prepared(t);
  (void)identify::rollout(rig, c.truth, {}, prepared, {.method = identify::Method::kAuto, .max_steps = 2'000'000},
                          t.phi, phi_m);
  t.phi.resize(t.t.size());
  Random random(seed, index);
  for (double& x : t.phi) x = (std::isfinite(x) ? x : 0) + kNoise * random.normal();
  return t;
}

Json fits(Run& run, Report& report) {
  identify::Rig rig = identify::read_rig(dataset("rigs/paper.toml"));
  const SeaParameters<double> table2 = read_actuator(dataset("actuators/table2.toml")).sea;
  std::vector<FitCase> cases;
  const auto add = [&](const char* what, auto&& change) {
    FitCase c{what, table2};
    change(c);
    cases.push_back(c);
  };
  add("Table 2, four hits", [](FitCase&) {});
  add("K_SEA = 1e6", [](FitCase& c) { c.truth.k_sea = 1e6; });
  add("C_SEA = 0", [](FitCase& c) { c.truth.c_sea = 0; });
  add("I_motor = 1e-6", [](FitCase& c) { c.truth.i_motor = 1e-6; });
  add("logged at 100 Hz", [](FitCase& c) { c.rate = 100, c.pulse = 0.1, c.peaks = {10, -20, 30, 40}; });
  add("logged at 10 kHz", [](FitCase& c) { c.rate = 1e4; });
  add("hits that never leave the torque limit", [](FitCase& c) {
    c.truth.tau_max = 0.05, c.peaks = {5, -8}, c.until = 0.1;
  });
  add("a hit that makes the rig escape", [](FitCase& c) { c.peaks = {60, -120, 3000}; });
  add("no hit at all", [](FitCase& c) { c.peaks = {0, 0}; });
  add("one trial", [](FitCase& c) { c.peaks = {220}; });
  add("a thousand trials", [](FitCase& c) {
    c.until = 0.25, c.peaks.clear();
    for (int i = 0; i < 1000; ++i) c.peaks.push_back((i % 2 ? -1 : 1) * (30 + 0.25 * i));
  });
  CsvWriter csv = run.csv();
  csv.comment("verdict: converged (within 5 standard errors of the truth), said (the fit says what is wrong), wrong.");
  csv.header({"case", "verdict", "largest_z", "rms", "time_s", "said"});
  std::vector<std::vector<std::string>> rows;
  int wrong = 0;
  run.say("");
  run.say(fmt::format("{:<40} {:>10} {:>9} {:>9} {:>7}  {}", "fits (simulated)", "verdict", "largest z", "rms", "time",
                      "said"));
  for (const FitCase& c : cases) {
    rig.tau_max = c.truth.tau_max;
    std::vector<identify::Trial> trials;
    for (std::size_t i = 0; i < c.peaks.size(); ++i)
      trials.push_back(simulated(rig, c, c.peaks[i], run.options().seed, i));
    const Stopwatch watch(Stopwatch::Time::kProcess);
    const identify::Fit fit = identify::fit(rig, trials, std::nullopt, {.tau_max = c.truth.tau_max}, {});
    const double seconds = watch.seconds();
    const double truth[] = {c.truth.k_p, c.truth.k_d, c.truth.k_sea, c.truth.c_sea, c.truth.i_motor};
    double z = 0;
    for (std::size_t i = 0; i < fit.parameters.size(); ++i)
      if (fit.parameters[i].std) z = std::max(z, std::abs(fit.parameters[i].value - truth[i]) / *fit.parameters[i].std);
    std::string said = fit.message;
    for (const std::string& w : fit.warnings) said += (said.empty() ? "" : "; ") + w;
    const bool converged = fit.converged && fit.identifiable && z < 5;
    const char* verdict = converged ? "converged" : !said.empty() ? "said" : "wrong";
    wrong += !converged && said.empty();
    csv.cell("\"" + c.what + "\"").cell(verdict).cell(z).cell(fit.rms).cell(seconds).cell("\"" + said + "\"");
    csv.end_row();
    rows.push_back({c.what, verdict, fmt::format("{:.1f}", z), fmt::format("{:.2e}", fit.rms),
                    fmt::format("{:.2f}", seconds), said});
    run.say(fmt::format("{:<40} {:>10} {:>9.1f} {:>9.2e} {:>6.2f}s  {}", c.what, verdict, z, fit.rms, seconds,
                        said.substr(0, 90)));
  }
  run.add("stability_identify.csv", csv.text());
  report.heading("Fits of stiff and extreme data (simulated, 0.2 mrad of noise, no start given)");
  report.table({"case", "verdict", "largest z", "rms [rad]", "time [s]", "said"}, rows);
  return {{"cases", cases.size()}, {"wrong", wrong}};
}

}  // namespace

int bench_stability(const BenchArguments& a, const CommonOptions& common) {
  Run run("bench stability", common);
  Report report("Stability: stiff and extreme cases");
  const Json of_landings = landings(a, run, report), three = three_ways(a, run, report), of_fits = fits(run, report);
  const int wrong = of_landings["wrong"].get<int>() + three["wrong"].get<int>() + of_fits["wrong"].get<int>();
  if (wrong > 0) run.warn(fmt::format("{} cases are silently wrong", wrong));
  run.add("report.html", report.html(run.provenance()));
  return run.finish({{"landings", of_landings}, {"three_ways", three}, {"fits", of_fits}},
                    wrong > 0 ? kNumbers : kDone);
}

}  // namespace ukemi::tools
