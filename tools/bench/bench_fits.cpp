#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/random.hpp"
#include "common/stopwatch.hpp"
#include "identify/design/design.hpp"
#include "identify/fit/fit.hpp"
#include "tools/bench/bench.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

namespace {

/// Stiff and extreme data for the fit.
struct FitCase {
  std::string what;
  SeaParameters<double> truth;
  double rate = 1000;                             ///< [Hz]
  std::vector<double> peaks{60, -120, 220, 300};  ///< one half-sine hit for each [N]
  double pulse = 0.015;                           ///< of a hit [s]
  double duration = 0.6;                          ///< of a log [s]
};

identify::Trial simulated(const identify::Rig& rig, const FitCase& c, double peak, std::uint64_t seed,
                          std::uint64_t index) {
  constexpr double kNoise = 2e-4;  // [rad]
  identify::Trial t = identify::blank_log({peak, c.pulse}, {.rate = c.rate, .duration = c.duration, .start = 0.02});
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

std::vector<FitCase> fit_cases() {
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
    c.truth.tau_max = 0.05, c.peaks = {5, -8}, c.duration = 0.1;
  });
  add("a hit that makes the rig escape", [](FitCase& c) { c.peaks = {60, -120, 3000}; });
  add("no hit at all", [](FitCase& c) { c.peaks = {0, 0}; });
  add("one trial", [](FitCase& c) { c.peaks = {220}; });
  add("a thousand trials", [](FitCase& c) {
    c.duration = 0.25, c.peaks.clear();
    for (int i = 0; i < 1000; ++i) c.peaks.push_back((i % 2 ? -1 : 1) * (30 + 0.25 * i));
  });
  return cases;
}

struct FitResult {
  std::string what, verdict, said;
  double z = 0, rms = 0, seconds = 0;
};
const Quantities<FitResult> kFitQuantities = {
    {"case", "", "fits (simulated)", {}, [](auto& r) { return in_quotes(r.what); }},
    {"verdict", "", "verdict", {}, &FitResult::verdict},
    {"largest_z", "", "largest z", "{:.1f}", &FitResult::z},
    {"rms", "", "rms [rad]", "{:.2e}", &FitResult::rms},
    {"time_s", "", "time [s]", "{:.2f}", &FitResult::seconds},
    {"said", "", "said", {}, [](auto& r) { return in_quotes(r.said); }},
};

FitResult run_fit(const FitCase& c, std::uint64_t seed) {
  identify::Rig rig = identify::read_rig(dataset("rigs/paper.toml"));
  rig.tau_max = c.truth.tau_max;
  std::vector<identify::Trial> trials;
  for (std::size_t i = 0; i < c.peaks.size(); ++i) trials.push_back(simulated(rig, c, c.peaks[i], seed, i));
  const Stopwatch watch(Stopwatch::Time::kProcess);
  const identify::Fit fit = identify::fit(rig, trials, std::nullopt, {.tau_max = c.truth.tau_max}, {});
  FitResult out{c.what, "", fit.message, 0, fit.rms, watch.seconds()};
  const auto truth = constants(c.truth);
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    if (const identify::Estimate& e = fit.parameters[i]; e.std)
      out.z = std::max(out.z, std::abs(e.value - truth[i]) / *e.std);
  for (const std::string& w : fit.warnings) out.said += (out.said.empty() ? "" : "; ") + w;
  const bool converged = fit.converged && fit.identifiable && out.z < 5;
  out.verdict = converged ? "converged" : !out.said.empty() ? "said" : "wrong";
  return out;
}

}  // namespace

Json stability_of_fits(Run& run, Report& report) {
  std::vector<FitResult> results;
  for (const FitCase& c : fit_cases()) results.push_back(run_fit(c, run.options().seed));
  report.heading("Fits of stiff and extreme data (simulated, 0.2 mrad of noise, no start given)");
  run.say("");
  (void)add_table(
      Table(kFitQuantities, results), report, run, "stability_identify.csv",
      "verdict: converged (within 5 standard errors of the truth), said (the fit says what is wrong), wrong.");
  const auto wrong = std::count_if(results.begin(), results.end(), [](auto& r) { return r.verdict == "wrong"; });
  return {{"cases", results.size()}, {"wrong", wrong}};
}

}  // namespace ukemi::tools
