#include <Eigen/Cholesky>
#include <cmath>

#include "common/checks.hpp"
#include "common/eigen.hpp"
#include "common/parallel.hpp"
#include "common/random.hpp"
#include "identify/design/design.hpp"
#include "identify/estimate/statistics.hpp"
#include "identify/fit/fit.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Relative errors of one repeat, and the half-widths that it reports.
struct Repeat {
  VectorXd error, half_width;
};

Trial with_noise(Trial log, double noise, Random& random) {
  for (std::vector<double>* angles : {&log.phi, &log.phi_motor})
    for (double& x : *angles) x += noise * random.normal();
  return log;
}

/// The probability that at most `k` of n intervals of 95 % cover the truth.
double coverage_probability(int k, int n) {
  double term = std::pow(0.95, n), sum = 0;  // all n cover it
  for (int missed = 0; missed <= n; ++missed) {
    if (n - missed <= k) sum += term;
    term *= double(n - missed) / (missed + 1) * 0.05 / 0.95;
  }
  return sum;
}

/// Whether the mean square of n normal errors over their variance is what chance allows, 0.1 % in all.
bool plausible(double mean_square, int n) {
  const double p = chi_squared_tail(n * mean_square, n);
  return p > 0.0005 && p < 0.9995;
}

/// The trial as it would be logged without noise; absent where it cannot be followed.
std::optional<Trial> without_noise(const Rig& rig, const Knowledge& k, Trial log) {
  std::vector<double> phi, phi_m;
  if (rollout(rig, k.sea, {}, PreparedTrial(log), {}, phi, phi_m) != RolloutStatus::kDone) return std::nullopt;
  if (!log.phi.empty()) log.phi = phi;
  if (!log.phi_motor.empty()) log.phi_motor = phi_m;
  return log;
}

/// Refits experiments with drawn noise.
class Refit {
 public:
  /// `known_trials`: the experiments hold the trials that `k` is from.
  Refit(const Rig& rig, const Knowledge& k, const DesignOptions& o, const std::vector<Trial>& experiments,
        bool known_trials)
      : rig_(rig),
        knowledge_(k),
        options_(o),
        experiments_(experiments),
        known_trials_(known_trials),
        value_(long(k.constants.size())),
        root_(covariance_of(k.information).value_or(MatrixXd::Zero(value_.size(), value_.size()))) {
    const auto u = ukemi::constants(k.sea);
    for (long i = 0; i < value_.size(); ++i) value_[i] = u[std::size_t(k.constants[std::size_t(i)])];
    fit_.terms.free.clear();
    for (const int c : k.constants) fit_.terms.free.push_back(kConstantNames[std::size_t(c)]);
  }

  std::optional<Repeat> operator()(std::uint64_t repeat) const {
    const long n = value_.size();
    Random random(options_.seed, repeat);
    std::vector<Trial> logs;
    for (const Trial& e : experiments_) logs.push_back(with_noise(e, options_.log.noise, random));
    const Fit f = fit(rig_, logs, knowledge_.sea, knowledge_.sea, fit_);
    if (!f.converged || !eigen(f.covariance).allFinite()) return std::nullopt;
    Repeat out{VectorXd(n), VectorXd(n)};
    const VectorXd inverse = value_.cwiseInverse();
    MatrixXd covariance = inverse.asDiagonal() * eigen(f.covariance) * inverse.asDiagonal();
    for (long i = 0; i < n; ++i)
      out.error[i] = f.parameters[std::size_t(knowledge_.constants[std::size_t(i)])].value / value_[i] - 1;
    if (!known_trials_) {  // what is known beforehand is drawn, and combined
      VectorXd z(n);
      for (double& x : z) x = random.normal();
      const VectorXd drawn = root_.matrixL() * z;
      const auto of_hits = covariance_of(covariance);  // the inverse, either way
      if (!of_hits) return std::nullopt;
      const auto combined = covariance_of(knowledge_.information + *of_hits);
      if (!combined) return std::nullopt;
      covariance = *combined;
      out.error = covariance * (knowledge_.information * drawn + *of_hits * out.error);
    }
    out.half_width = f.half_width * covariance.diagonal().cwiseSqrt();
    return out;
  }

 private:
  const Rig& rig_;
  const Knowledge& knowledge_;
  const DesignOptions& options_;
  const std::vector<Trial>& experiments_;
  const bool known_trials_;
  VectorXd value_;                   ///< of the constants
  const Eigen::LLT<MatrixXd> root_;  ///< of their covariance, relative
  FitOptions fit_{.restarts = 0, .errors = FitOptions::Errors::kNoiseOnly};
};

/// Scatter of the repeats' errors against what was predicted.
DesignCheck summary(const std::vector<std::optional<Repeat>>& repeats, const MatrixXd& information) {
  const long n = information.rows();
  DesignCheck c;
  c.constants.resize(std::size_t(n));
  const auto predicted = covariance_of(information);
  for (long i = 0; i < n && predicted; ++i) c.constants[std::size_t(i)].predicted = std::sqrt((*predicted)(i, i));
  for (const auto& r : repeats) {
    if (!r) {
      ++c.failed;
      continue;
    }
    ++c.repeats;
    for (long i = 0; i < n; ++i) {
      DesignCheck::Constant& q = c.constants[std::size_t(i)];
      q.scatter += r->error[i] * r->error[i];
      q.half_width += r->half_width[i];
      q.covered += std::abs(r->error[i]) <= r->half_width[i];
    }
  }
  c.agrees = c.failed == 0 && c.repeats > 0;
  for (DesignCheck::Constant& q : c.constants) {
    if (c.repeats == 0) break;
    q.scatter = std::sqrt(q.scatter / c.repeats), q.half_width /= c.repeats;
    const double ratio = q.scatter / q.predicted;
    c.agrees = c.agrees && plausible(ratio * ratio, c.repeats) && coverage_probability(q.covered, c.repeats) > 1e-3;
  }
  return c;
}

}  // namespace

DesignCheck check(const Rig& rig, const Knowledge& k, const std::vector<Trial>& trials, const std::vector<Hit>& hits,
                  const DesignOptions& o, int repeats) {
  rig.validate(), k.validate(), o.validate();
  for (const Trial& t : trials) t.validate();
  check_count("repeats", repeats, 0, 1'000'000);
  std::vector<Trial> experiments;
  const auto add = [&](const Trial& log) {
    if (auto e = without_noise(rig, k, log)) experiments.push_back(std::move(*e));
  };
  for (const Trial& t : trials) add(t);
  MatrixXd information = k.information;
  for (const Hit& h : hits) {
    const Trial log = blank_log(h, o.log);
    if (const auto added = information_of(rig, k.sea, k.constants, log, o.log.noise)) information += *added;
    add(log);
  }
  const Refit refit(rig, k, o, experiments, !trials.empty());
  std::vector<std::optional<Repeat>> done(std::size_t(repeats), std::nullopt);
  parallel_for(repeats, o.threads, [&](int r) { done[std::size_t(r)] = refit(std::uint64_t(r)); });
  return summary(done, information);
}

}  // namespace ukemi::identify
