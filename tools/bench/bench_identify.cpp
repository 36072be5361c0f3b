// ukemi bench identify: what the integrator, its step and the number of trials do to the fitted constants and to the
// derivatives, against run time. The logs are simulated from Table 2, with noise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/actuator.hpp"
#include "common/median.hpp"
#include "common/random.hpp"
#include "common/stopwatch.hpp"
#include "identify/fit/fit.hpp"
#include "tools/bench/bench.hpp"
#include "tools/report/report.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace identify;

namespace {

constexpr double kNoise = 2e-4;  // of the simulated angles [rad]
using Dual = ceres::Jet<double, kSmallJet>;

SeaParameters<Dual> seeded(const SeaParameters<double>& p) {
  SeaParameters<Dual> d = p.cast<Dual>();
  d.k_p.v[0] = p.k_p, d.k_d.v[1] = p.k_d, d.k_sea.v[2] = p.k_sea, d.c_sea.v[3] = p.c_sea, d.i_motor.v[4] = p.i_motor;
  return d;
}

/// Without a method: the rollout that fits use.
RolloutOptions with(std::optional<Method> method, double setting) {
  RolloutOptions o{.method = method, .max_steps = 1'000'000};
  (method && fixed_step(*method) ? o.max_step : o.accuracy) = setting;
  return o;
}
const char* name_of(std::optional<Method> method) { return method ? name(*method) : "exact between hits"; }

/// d phi / d ln U of every sample of every trial.
std::vector<Dual> sensitivities(const Rig& rig, const SeaParameters<double>& sea,
                                const std::vector<PreparedTrial>& trials, const RolloutOptions& options) {
  std::vector<Dual> all, phi, phi_m;
  for (const PreparedTrial& t : trials) {
    const Nuisance<Dual> at_rest{Dual(0), Dual(0)};
    if (rollout(rig, seeded(sea), at_rest, t, options, phi, phi_m) != RolloutStatus::kDone) return {};
    all.insert(all.end(), phi.begin(), phi.end());
  }
  return all;
}

}  // namespace

int bench_identify(const BenchArguments& a, const CommonOptions& common) {
  Run run("bench-identify", common);
  const Rig rig = read_rig(dataset("rigs/paper.toml"));
  const SeaParameters<double> truth = read_actuator(dataset("actuators/table2.toml")).sea;
  std::vector<std::string> files;
  for (int i = 1; i <= 8; ++i) files.push_back(dataset(fmt::format("impact/trial_{}.csv", i)));
  const std::vector<Trial> logs = read_trials(files, {}, rig, {}, run).trials;
  std::vector<PreparedTrial> prepared(logs.begin(), logs.end());
  std::vector<std::vector<double>> exact;
  for (const PreparedTrial& t : prepared) {
    std::vector<double> phi, phi_m;
    (void)rollout(rig, truth, {}, t, {.accuracy = 1e-13, .max_steps = 1'000'000}, phi, phi_m);
    exact.push_back(phi);
  }
  const std::vector<Dual> derivatives = sensitivities(rig, truth, prepared, with(Method::kDormandPrince853, 1e-13));
  Eigen::Array<double, kConstants, 1> scale = Eigen::Array<double, kConstants, 1>::Zero();
  for (const Dual& d : derivatives) scale = scale.max(d.v.head<kConstants>().array().abs());

  struct Rung {
    std::optional<Method> method;
    std::vector<double> settings;
  };
  const std::vector<Rung> ladder = {{Method::kSemiImplicitEuler, {1e-3, 2e-4}},
                                    {Method::kRungeKutta4, {1e-3, 5e-4, 2.5e-4}},
                                    {Method::kDormandPrince54, {1e-4, 1e-6, 1e-8}},
                                    {Method::kDormandPrince853, {1e-4, 1e-6, 1e-8, 1e-9, 1e-11}},
                                    {{}, {1e-5, 1e-7, 1e-11, 1e-9}}};
  CsvWriter csv = run.csv();
  csv.comment(
      "Over noise draws (0.2 mrad): bias and scatter of the fitted constants, the largest over the five, relative; "
      "bias_z in "
      "standard errors of one fit; derivative_error: of d phi / d ln U, relative to the largest; time_ms of a fit, "
      "median.");
  csv.header({"method", "setting", "trials", "bias", "scatter", "bias_z", "derivative_error", "time_ms", "converged"});
  Report report("Identification: error against run time");
  report.paragraph(fmt::format(
      "Simulated logs (Table 2 is the truth), {} noise draws of 0.2 mrad, each fit from Table 2's constants.",
      a.draws));
  std::vector<std::vector<std::string>> rows;
  std::vector<Series> plot;
  Json summary = Json::array();
  run.say(fmt::format("{:<20} {:>8} {:>6} {:>9} {:>9} {:>7} {:>11} {:>9}", "method", "setting", "trials", "bias",
                      "scatter", "bias/se", "derivative", "time [ms]"));
  for (const Rung& rung : ladder) {
    plot.push_back({name_of(rung.method), {}, {}});
    for (const double setting : rung.settings) {
      const RolloutOptions options = with(rung.method, setting);
      double derivative_error = 0;
      const std::vector<Dual> d = sensitivities(rig, truth, prepared, options);
      for (std::size_t i = 0; i < d.size(); ++i)
        derivative_error = std::max(derivative_error,
                                    ((d[i].v - derivatives[i].v).head<kConstants>().array().abs() / scale).maxCoeff());
      if (d.empty()) derivative_error = NAN;
      for (const int count : {1, 2, 4, 8}) {
        if (count != 8 && setting != rung.settings.back()) continue;
        using Values = Eigen::Array<double, kConstants, 1>;
        Values sum = Values::Zero(), squares = Values::Zero(), error = Values::Zero();
        const Values u{truth.k_p, truth.k_d, truth.k_sea, truth.c_sea, truth.i_motor};
        std::vector<double> seconds;
        int converged = 0;
        for (int draw = 0; draw < a.draws; ++draw) {
          std::vector<Trial> noisy(logs.begin(), logs.begin() + count);
          for (int m = 0; m < count; ++m) {
            Random random(run.options().seed, std::uint64_t(draw * 8 + m));
            noisy[std::size_t(m)].phi = exact[std::size_t(m)];
            for (double& x : noisy[std::size_t(m)].phi) x += kNoise * random.normal();
          }
          FitOptions fit_options;
          fit_options.restarts = 0, fit_options.method = rung.method;
          fit_options.accuracy = options.accuracy, fit_options.max_step = options.max_step;
          const Stopwatch watch(Stopwatch::Time::kProcess);
          const Fit fit = identify::fit(rig, noisy, truth, {.tau_max = truth.tau_max}, fit_options);
          seconds.push_back(watch.seconds());
          converged += fit.converged;
          const Values v{fit.sea.k_p, fit.sea.k_d, fit.sea.k_sea, fit.sea.c_sea, fit.sea.i_motor};
          sum += v / u - 1, squares += (v / u - 1).square();
          for (int k = 0; k < kConstants; ++k)
            error[k] += fit.parameters[std::size_t(k)].std.value_or(NAN) / u[k] / a.draws;
        }
        const Values bias = (sum / a.draws).abs(),
                     scatter = (squares / a.draws - (sum / a.draws).square()).max(0.0).sqrt();
        const double ms = median(seconds) * 1e3, z = (bias / error).maxCoeff();
        csv.cell(name_of(rung.method)).cell(setting).cell(count).cell(bias.maxCoeff()).cell(scatter.maxCoeff()).cell(z);
        csv.cell(derivative_error).cell(ms).cell(converged);
        csv.end_row();
        rows.push_back({name_of(rung.method), fmt::format("{:g}", setting), std::to_string(count),
                        fmt::format("{:.1e}", bias.maxCoeff()), fmt::format("{:.1e}", scatter.maxCoeff()),
                        fmt::format("{:.2f}", z), fmt::format("{:.1e}", derivative_error), fmt::format("{:.1f}", ms)});
        const auto& r = rows.back();
        run.say(fmt::format("{:<20} {:>8} {:>6} {:>9} {:>9} {:>7} {:>11} {:>9}", r[0], r[1], r[2], r[3], r[4], r[5],
                            r[6], r[7]));
        if (count == 8) plot.back().x.push_back(ms), plot.back().y.push_back(derivative_error);
        summary.push_back({{"method", name_of(rung.method)},
                           {"setting", setting},
                           {"trials", count},
                           {"bias", number(bias.maxCoeff())},
                           {"bias_z", number(z)},
                           {"derivative_error", number(derivative_error)},
                           {"converged", converged},
                           {"time_s", ms * 1e-3}});
      }
    }
  }
  report.plot("time of a fit [ms]", "error of the derivatives", plot, Axes::kLogarithmic);
  report.table({"method", "step or accuracy", "trials", "bias", "scatter", "bias in standard errors",
                "derivative error", "time [ms]"},
               rows);
  run.add("identify.csv", csv.text());
  run.add("report.html", report.html(run.provenance()));
  return run.finish({{"rungs", summary}}, kDone);
}

}  // namespace ukemi::tools
