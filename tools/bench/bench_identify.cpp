// ukemi bench identify: errors of the fitted constants and of the derivatives against run time, for several
// integrators, steps and numbers of trials. The logs are simulated from Table 2, with noise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/actuator.hpp"
#include "common/integrate/method.hpp"
#include "common/jet.hpp"
#include "common/median.hpp"
#include "common/random.hpp"
#include "common/stopwatch.hpp"
#include "identify/fit/fit.hpp"
#include "identify/rollout/rollout.hpp"
#include "tools/bench/bench.hpp"
#include "tools/program/trials.hpp"
#include "tools/report/report.hpp"

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

/// `setting`: step [s] or accuracy. Without a method: the rollout that fits use.
RolloutOptions options_for(std::optional<Method> method, double setting) {
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

using Values = Eigen::Array<double, kConstants, 1>;

struct Ladder {
  std::optional<Method> method;
  std::vector<double> settings;  ///< steps [s] or accuracies
};
const std::vector<Ladder> kLadders = {{Method::kSemiImplicitEuler, {1e-3, 2e-4}},
                                      {Method::kRungeKutta4, {1e-3, 5e-4, 2.5e-4}},
                                      {Method::kDormandPrince54, {1e-4, 1e-6, 1e-8}},
                                      {Method::kDormandPrince853, {1e-4, 1e-6, 1e-8, 1e-9, 1e-11}},
                                      {{}, {1e-5, 1e-7, 1e-11, 1e-9}}};

/// Fits of a number of trials, over noise draws; bias and scatter relative, the largest of the constants.
struct Entry {
  std::string method;
  double setting;
  int trials;
  double derivative_error = 0;  ///< of d phi / d ln U, relative to the largest
  double bias = 0, scatter = 0, bias_z = 0, seconds = 0;
  int converged = 0;
};
const Quantities<Entry> kEntryQuantities = {
    {"method", "method", "method", {}, &Entry::method},
    {"setting", "setting", "step or accuracy", "{:g}", &Entry::setting},
    {"trials", "trials", "trials", {}, &Entry::trials},
    {"bias", "bias", "bias", "{:.1e}", &Entry::bias},
    {"scatter", "", "scatter", "{:.1e}", &Entry::scatter},
    {"bias_z", "bias_z", "bias in standard errors", "{:.2f}", &Entry::bias_z},
    {"derivative_error", "derivative_error", "derivative error", "{:.1e}", &Entry::derivative_error},
    {"time_ms", "", "time [ms]", "{:.1f}", [](auto& e) { return 1e3 * e.seconds; }},
    {"converged", &Entry::converged},
    {"", "time_s", &Entry::seconds},
};

/// The shipped rig, its logs, and the noise-free angles under Table 2.
struct Bench {
  Rig rig;
  SeaParameters<double> truth;
  std::vector<Trial> logs;
  std::vector<PreparedTrial> prepared;
  std::vector<std::vector<double>> exact;  ///< phi of each trial without noise [rad]
  std::vector<Dual> derivatives;
  Values scale = Values::Zero();  ///< largest |derivative| by each constant

  explicit Bench(Run& run)
      : rig(read_rig(dataset("rigs/paper.toml"))), truth(read_actuator(dataset("actuators/table2.toml")).sea) {
    std::vector<std::string> files;
    for (int i = 1; i <= 8; ++i) files.push_back(dataset(fmt::format("impact/trial_{}.csv", i)));
    logs = read_trials(files, {}, rig, {}, run).trials;
    prepared = {logs.begin(), logs.end()};
    for (const PreparedTrial& t : prepared) {
      std::vector<double> phi_m;
      (void)rollout(rig, truth, {}, t, {.accuracy = 1e-13, .max_steps = 1'000'000}, exact.emplace_back(), phi_m);
    }
    derivatives = sensitivities(rig, truth, prepared, options_for(Method::kDormandPrince853, 1e-13));
    for (const Dual& d : derivatives) scale = scale.max(d.v.head<kConstants>().array().abs());
  }

  double derivative_error(const RolloutOptions& options) const {
    const std::vector<Dual> d = sensitivities(rig, truth, prepared, options);
    double worst = d.empty() ? NAN : 0;
    for (std::size_t i = 0; i < d.size(); ++i)
      worst = std::max(worst, ((d[i].v - derivatives[i].v).head<kConstants>().array().abs() / scale).maxCoeff());
    return worst;
  }

  std::vector<Trial> noisy(int count, int draw, std::uint64_t seed) const {
    std::vector<Trial> out(logs.begin(), logs.begin() + count);
    for (int m = 0; m < count; ++m) {
      Random random(seed, std::uint64_t(draw * 8 + m));
      out[std::size_t(m)].phi = exact[std::size_t(m)];
      for (double& x : out[std::size_t(m)].phi) x += kNoise * random.normal();
    }
    return out;
  }

  /// Adds bias, scatter and time to the entry.
  void fit(Entry& e, std::optional<Method> method, const RolloutOptions& rollout, int draws, std::uint64_t seed) const {
    const auto u_of = [](const SeaParameters<double>& sea) -> Values { return Values(constants(sea).data()); };
    const Values u = u_of(truth);
    Values sum = Values::Zero(), squares = Values::Zero(), sigma = Values::Zero();
    std::vector<double> seconds;
    FitOptions options;
    options.restarts = 0, options.method = method;
    options.accuracy = rollout.accuracy, options.max_step = rollout.max_step;
    for (int draw = 0; draw < draws; ++draw) {
      const std::vector<Trial> trials = noisy(e.trials, draw, seed);
      const Stopwatch watch(Stopwatch::Time::kProcess);
      const Fit fit = identify::fit(rig, trials, truth, {.tau_max = truth.tau_max}, options);
      seconds.push_back(watch.seconds());
      e.converged += fit.converged;
      const Values error_of_draw = u_of(fit.sea) / u - 1;
      sum += error_of_draw, squares += error_of_draw.square();
      for (int k = 0; k < kConstants; ++k) sigma[k] += fit.parameters[std::size_t(k)].std.value_or(NAN) / u[k] / draws;
    }
    const Values bias = (sum / draws).abs();
    e.bias = bias.maxCoeff(), e.bias_z = (bias / sigma).maxCoeff();
    e.scatter = (squares / draws - (sum / draws).square()).max(0.0).sqrt().maxCoeff();
    e.seconds = median(std::move(seconds));
  }
};

}  // namespace

int bench_identify(const BenchArguments& a, const CommonOptions& common) {
  Run run(Outputs{"bench identify", {"identify.csv"}, {"precision"}}, common);
  const Bench bench(run);
  std::vector<Entry> entries;
  std::vector<Series> plot;
  for (const Ladder& ladder : kLadders) {
    plot.push_back({name_of(ladder.method), {}, {}});
    for (const double setting : ladder.settings) {
      const RolloutOptions options = options_for(ladder.method, setting);
      const double derivative_error = bench.derivative_error(options);
      for (const int count : {1, 2, 4, 8}) {
        if (count != 8 && setting != ladder.settings.back()) continue;
        Entry& e = entries.emplace_back(Entry{name_of(ladder.method), setting, count, derivative_error});
        bench.fit(e, ladder.method, options, a.draws, run.options().seed);
        if (count == 8) plot.back().x.push_back(1e3 * e.seconds), plot.back().y.push_back(e.derivative_error);
      }
    }
  }
  Report report("Identification: error against run time");
  report.paragraph(fmt::format(
      "Simulated logs (Table 2 is the truth), {} noise draws of 0.2 mrad, each fit from Table 2's constants.",
      a.draws));
  report.plot("precision", "time of a fit [ms]", "error of the derivatives", plot, Axes::kLogarithmic);
  const Json rungs = add_table(Table(kEntryQuantities, entries), report, run, "identify.csv",
                               "Over noise draws (0.2 mrad): bias and scatter of the fitted constants, the largest "
                               "over the five, relative; bias_z in standard errors of one fit; derivative_error: of d "
                               "phi / d ln U, relative to the largest; time_ms of a fit, median.");
  const Entry& best = *std::min_element(entries.begin(), entries.end(), [](const Entry& x, const Entry& y) {
    return std::pair(-x.trials, x.derivative_error) < std::pair(-y.trials, y.derivative_error);
  });
  const bool converged =
      std::all_of(entries.begin(), entries.end(), [&](const Entry& e) { return e.converged == a.draws; });
  report.answer({fmt::format("A fit of {} trials takes {:.0f} ms with {}, which has the most exact derivatives.",
                             best.trials, 1e3 * best.seconds, best.method),
                 {check(converged, "converged", converged ? "every fit of every draw" : "not every fit: the table")},
                 ""},
                run.warnings());
  report.write(run);
  return run.finish({{"rungs", rungs}}, kDone);
}

}  // namespace ukemi::tools
