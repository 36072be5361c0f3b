// Our fit of the eight shipped trials against the usual one, in one run: Ceres over a rollout in Jets by RK4 with four
// steps a millisecond and a plain clamp, no events, nothing exact. Both with covariance, from the same start.
//
//   bench_identify [repetitions]
//
// Each repetition times both in turn. Then a thousand trials (the eight with fresh noise) by ours alone.
#include <ceres/ceres.h>
#include <fmt/format.h>
#include <Eigen/Core>

#include <algorithm>
#include <cstdlib>

#include "common/actuator.hpp"
#include "common/median.hpp"
#include "common/random.hpp"
#include "common/stopwatch.hpp"
#include "identify/fit/fit.hpp"

using namespace ukemi;
using namespace ukemi::identify;

namespace {

/// Residuals of one trial in units of the start.
struct UsualResidual {
  const Rig& rig;
  const Trial& trial;
  double tau_max;
  std::array<double, kConstants> start;

  template <class T>
  bool operator()(const T* x, T* residual) const {
    using std::cos;
    using State = std::array<T, 4>;
    const T k_p = x[0] * start[0], k_d = x[1] * start[1], k = x[2] * start[2], c = x[3] * start[3],
            inertia = x[4] * start[4];
    State y{T(0), T(0), T(0), T(0)};
    residual[0] = y[0] - trial.phi[0];
    for (std::size_t i = 0; i + 1 < trial.samples(); ++i) {
      const double span = trial.t[i + 1] - trial.t[i], f = trial.force[i], rate = (trial.force[i + 1] - f) / span;
      const auto field = [&](double u, const State& s) -> State {
        T tau = k * (s[1] - s[0]) + c * (s[3] - s[2]);
        if (tau > tau_max) tau = T(tau_max);
        if (tau < -tau_max) tau = T(-tau_max);
        return {s[2], s[3], (tau + rig.length * (f + rate * u) * cos(s[0])) / rig.inertia,
                (-k_p * s[0] - k_d * s[2] - tau) / inertia};
      };
      const auto moved = [](const State& s, double h, const State& d) {
        State out;
        for (std::size_t j = 0; j < 4; ++j) out[j] = s[j] + h * d[j];
        return out;
      };
      constexpr int kSteps = 4;
      const double h = span / kSteps;
      for (int n = 0; n < kSteps; ++n) {
        const State a = field(n * h, y), b = field((n + 0.5) * h, moved(y, h / 2, a)),
                    d = field((n + 0.5) * h, moved(y, h / 2, b)), e = field((n + 1) * h, moved(y, h, d));
        for (std::size_t j = 0; j < 4; ++j) y[j] += h / 6 * (a[j] + 2.0 * b[j] + 2.0 * d[j] + e[j]);
      }
      residual[i + 1] = y[0] - trial.phi[i + 1];
    }
    return true;
  }
};

struct Result {
  double cost;  ///< E(U) [rad^2]
  std::array<double, kConstants> u, std;
};

Result usual(const Rig& rig, const std::vector<Trial>& trials, const std::array<double, kConstants>& start) {
  std::array<double, kConstants> x;
  x.fill(1);
  ceres::Problem problem;
  long n = 0;
  for (const Trial& t : trials) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<UsualResidual, ceres::DYNAMIC, kConstants>(
                                 new UsualResidual{rig, t, *rig.tau_max, start}, int(t.samples())),
                             nullptr, x.data());
    n += long(t.samples());
  }
  for (int i = 0; i < kConstants; ++i) problem.SetParameterLowerBound(x.data(), i, i == 4 ? 1e-6 : 0);
  ceres::Solver::Options o;
  o.linear_solver_type = ceres::DENSE_QR;
  o.function_tolerance = 1e-12;
  o.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(o, &problem, &summary);
  ceres::Covariance covariance({});
  Eigen::Matrix<double, kConstants, kConstants, Eigen::RowMajor> c;
  c.setConstant(NAN);
  const std::vector<std::pair<const double*, const double*>> blocks{{x.data(), x.data()}};
  if (covariance.Compute(blocks, &problem)) covariance.GetCovarianceBlock(x.data(), x.data(), c.data());
  Result r{2 * summary.final_cost, {}, {}};
  for (int k = 0; k < kConstants; ++k) {
    const auto i = std::size_t(k);
    r.u[i] = x[i] * start[i];
    r.std[i] = std::sqrt(c(k, k) * r.cost / double(n - kConstants)) * start[i];
  }
  return r;
}

Result ours(const Rig& rig, const std::vector<Trial>& trials, const std::array<double, kConstants>& start) {
  SeaParameters<double> from{};
  set_constants(from, start);
  const Fit f = fit(rig, trials, from, {.tau_max = *rig.tau_max}, {.threads = 1});
  Result r{f.cost, {}, {}};
  for (std::size_t i = 0; i < kConstants; ++i)
    r.u[i] = f.parameters[i].value, r.std[i] = f.parameters[i].std.value_or(NAN);
  return r;
}

}  // namespace

int main(int argc, char** argv) {
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 15;
  const Rig rig = read_rig(UKEMI_DATASETS "/rigs/paper.toml");
  std::vector<Trial> trials;
  for (int i = 1; i <= 8; ++i)
    trials.push_back(read_trial(UKEMI_DATASETS "/impact/trial_" + std::to_string(i) + ".csv"));
  const std::array<double, kConstants> start = {60, 1.2, 78, 1.9, 0.1};  // Table 2 and a fifth
  std::vector<double> times[2], ratios;
  Result r[2];
  for (int n = 0; n < repetitions; ++n) {
    double spent[2];
    for (int k = 0; k < 2; ++k) {
      const int who = (n + k) % 2;
      const Stopwatch watch(Stopwatch::Time::kProcessor);
      r[who] = who == 0 ? ours(rig, trials, start) : usual(rig, trials, start);
      times[who].push_back(spent[who] = watch.seconds());
    }
    ratios.push_back(spent[1] / spent[0]);
  }
  fmt::print("{:22} {:>10} {:>20} {:>12} {:>12}\n", "eight trials", "time [ms]", "cost [rad^2]", "k_sea", "+-");
  for (int who = 0; who < 2; ++who)
    fmt::print("{:22} {:10.2f} {:20.15f} {:12.8f} {:12.2g}\n", who == 0 ? "ukemi" : "Ceres over Jet RK4",
               1e3 * median(times[who]), r[who].cost, r[who].u[2], r[who].std[2]);
  fmt::print("time over ours: {:.1f} (median of {} pairs); cost over ours, less one: {:.2g}\n", median(ratios),
             repetitions, r[1].cost / r[0].cost - 1);

  std::vector<Trial> many;
  for (int m = 0; m < 1000; ++m) {
    many.push_back(trials[std::size_t(m % 8)]);
    Random noise(1, std::uint64_t(m));
    for (double& x : many.back().phi) x += 5e-4 * noise.normal();
  }
  const Stopwatch watch(Stopwatch::Time::kProcessor);
  const Result all = ours(rig, many, start);
  fmt::print("a thousand trials: {:.2f} s of one core, k_sea {:.6f} +- {:.2g}\n", watch.seconds(), all.u[2],
             all.std[2]);
}
