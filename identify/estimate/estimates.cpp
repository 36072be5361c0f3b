#include "identify/estimate/estimates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/csv.hpp"
#include "common/eigen.hpp"
#include "identify/estimate/covariance.hpp"
#include "identify/estimate/statistics.hpp"

namespace ukemi::identify {

namespace {

enum class Kind { kConstant, kNuisance };

/// f(estimate, kind) of each global, in the order of `fitted`.
template <class AnyEstimates, class F>
void for_each_global(AnyEstimates& estimates, F&& f) {
  const auto visit = [&](auto& list, const std::string& name, Kind kind) {
    for (auto& e : list)
      if (e.name == name && e.trial < 0) f(e, kind);
  };
  for (const std::string& name : estimates.fitted)
    visit(estimates.parameters, name, Kind::kConstant), visit(estimates.nuisance, name, Kind::kNuisance);
}

/// Warning that a constant with a standard error is not identifiable; empty where it is.
std::string interval_warning(const Estimate& e, Wording::Interval interval) {
  if (e.verdict != Identifiability::kNotIdentifiable || !e.std) return "";
  return fmt::format("{} is not identifiable: the 95 % interval is {} either way", e.name,
                     interval == Wording::Interval::kRelative
                         ? fmt::format("{:.0f} % of its value", 100 * e.half_width() / std::abs(e.value))
                         : fmt::format("{:.3g} {}", e.half_width(), e.unit));
}

/// Marginal information of one global, with the others off their bounds eliminated (Schur complement).
struct Marginal {
  double information = 0;  ///< for unit residual variance
  std::vector<long> others;
  Eigen::VectorXd response;  ///< derivatives of the others' minimum by the global
};
Marginal marginal_of(const LeastSquaresSolution& s, long g) {
  Marginal out{.information = s.information(g, g), .others = {}, .response = {}};
  for (long i = 0; i < s.information.rows(); ++i)
    if (i != g && !s.at_bound[std::size_t(i)]) out.others.push_back(i);
  if (out.others.empty()) return out;
  const Eigen::VectorXd cross = s.information(out.others, g);
  out.response = -ScaledSolver(s.information(out.others, out.others))(cross);
  out.information += cross.dot(out.response);
  return out;
}
constexpr double kSingular = 1e-12;  ///< of a global's information: a smaller marginal one is rounding

}  // namespace

std::vector<const Estimate*> Estimates::globals() const {
  std::vector<const Estimate*> out;
  for_each_global(*this, [&](const Estimate& e, Kind) { out.push_back(&e); });
  return out;
}

void set_errors(const Eigen::MatrixXd& noise, Estimates& out) {
  Eigen::MatrixXd covariance = noise;
  for (const Considered& c : out.considered) covariance += eigen(c.shift) * eigen(c.shift).transpose();
  out.noise_covariance = noise, out.covariance = covariance, out.correlation = correlation_of(covariance);
  long i = 0;
  for_each_global(out, [&](Estimate& e, Kind kind) {
    set_error(e, out.covariance(i, i), noise(i, i), out.half_width);
    e.verdict = kind == Kind::kConstant ? judge(e) : e.at_bound ? Identifiability::kAtBound : Identifiability::kFitted;
    ++i;
  });
}

void update_errors(const Eigen::MatrixXd& noise, double half_width, Wording::Interval interval, Estimates& out) {
  const std::vector<Estimate> before = out.parameters;
  out.half_width = half_width;
  set_errors(noise, out);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const std::string old_warning = interval_warning(before[i], interval);
    if (!old_warning.empty()) std::erase(out.warnings, old_warning);
    if (std::string new_warning = interval_warning(out.parameters[i], interval); !new_warning.empty())
      out.warnings.push_back(std::move(new_warning));
  }
}

void warn_of_priors(const Choice& choice, const LeastSquaresSolution& s, double noise, Estimates& out) {
  constexpr double kFar = 4;  // standard deviations
  const std::vector<const Estimate*> globals = out.globals();
  const double variance = s.cost / double(s.residuals - s.free_parameters);
  for (const Prior& p : choice.priors)
    for (std::size_t g = 0; g < globals.size() && s.information.size() > 0; ++g) {
      if (globals[g]->name != p.term || s.at_bound[g]) continue;
      const double total = marginal_of(s, long(g)).information, without_prior = total - std::pow(noise / p.std, 2);
      if (!(without_prior > kSingular * total)) continue;
      const double difference = (globals[g]->value - p.value) * total / without_prior,
                   std = std::sqrt(variance / without_prior), deviation = std::abs(difference) / std::hypot(std, p.std);
      if (deviation > kFar)
        out.warnings.push_back(
            fmt::format("{} is about {:.4g} ± {:.2g} by the logs alone, {:.1f} standard deviations from its prior, {} "
                        "with {}: logs and prior contradict",
                        p.term, p.value + difference, std, deviation, shortest(p.value), shortest(p.std)));
    }
}

std::vector<ErrorBudget> error_budget(const Estimates& estimates) {
  std::vector<ErrorBudget> out;
  const std::vector<const Estimate*> globals = estimates.globals();
  for (std::size_t g = 0; g < globals.size(); ++g) {
    const double variance = estimates.covariance(long(g), long(g));
    if (globals[g]->verdict == Identifiability::kFitted || !globals[g]->std || !(variance > 0)) continue;
    out.push_back({globals[g]->name, {{"noise", estimates.noise_covariance(long(g), long(g)) / variance}}});
    for (const Considered& c : estimates.considered)
      out.back().shares.emplace_back(c.name, eigen(c.shift).row(long(g)).squaredNorm() / variance);
  }
  return out;
}

namespace {

void warn(const Wording& wording, Estimates& out) {
  for (const Estimate& e : out.parameters) {
    if (e.verdict == Identifiability::kAtBound)
      out.warnings.push_back(fmt::format("{} ended at its bound {}: no standard error", e.name, shortest(e.value)));
    if (const std::string wide = interval_warning(e, wording.interval); !wide.empty()) out.warnings.push_back(wide);
    if (e.verdict == Identifiability::kNotIdentifiable && !e.std)
      out.warnings.push_back(fmt::format("{} is not determined by these {}", e.name, wording.data));
  }
  const std::vector<const Estimate*> globals = out.globals();
  const auto trusted = [&](std::size_t g) { return globals[g]->verdict == Identifiability::kTrusted; };
  const Eigen::MatrixXd correlation = correlation_of(out.noise_covariance);  // the rig's errors correlate all
  for (std::size_t i = 0; i < globals.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double r = correlation(long(i), long(j));
      if (wording.correlated == Wording::Correlated::kUnlessTrusted && trusted(i) && trusted(j)) continue;
      if (std::abs(r) > 0.95)
        out.warnings.push_back(fmt::format("{} and {} correlate by {:.3f}: these {} hardly tell them apart",
                                           globals[j]->name, globals[i]->name, r, wording.data));
    }
}

/// One-sided errors of terms that ended at a bound. With m the distance at which the cost, as a parabola, has its
/// minimum beyond the bound, and s_0 the term's standard deviation without it, s^2 is the mean square of a normal
/// distribution of mean -m and deviation s_0 where that is above 0; at most that of one within the bounds. Ours.
std::vector<Considered> considered_at_bounds(const LeastSquaresSolution& s, const LeastSquaresProblem& problem,
                                             double variance) {
  std::vector<Considered> out;
  if (s.information.size() == 0 || !(variance > 0)) return out;
  for (std::size_t g = 0; g < problem.globals.size(); ++g) {
    const Parameter& p = problem.globals[g];
    if (!s.at_bound[g] || p.held) continue;
    const auto b = long(g);
    const Marginal marginal = marginal_of(s, b);
    if (!(marginal.information > kSingular * s.information(b, b))) continue;
    const double std = std::sqrt(variance / marginal.information),
                 beyond = std::max(s.globals[b] > p.lower ? -s.gradient[b] : s.gradient[b], 0.0) / marginal.information,
                 spread = std * spread_from_bound(beyond / std), uniform = (p.upper - p.lower) / std::sqrt(3.0);
    Considered c{p.name, std::min(spread, uniform), Eigen::MatrixXd::Zero(s.information.rows(), 1)};
    for (std::size_t i = 0; i < marginal.others.size(); ++i)
      eigen(c.shift)(marginal.others[i], 0) = c.std * marginal.response[long(i)];
    out.push_back(std::move(c));
  }
  return out;
}

}  // namespace

const Estimate* find_constant(const Estimates& fit, const std::string& name) {
  const auto at =
      std::find_if(fit.parameters.begin(), fit.parameters.end(), [&](const Estimate& e) { return e.name == name; });
  return at == fit.parameters.end() ? nullptr : &*at;
}

void set_estimates(const LeastSquaresSolution& s, const LeastSquaresProblem& problem,
                   const std::vector<const Term*>& shared, const Wording& wording, Estimates& out) {
  out.cost = s.cost, out.converged = s.converged, out.iterations = s.iterations;
  const long dof = s.residuals - s.free_parameters;
  const double variance = dof > 0 ? s.cost / double(dof) : std::numeric_limits<double>::quiet_NaN();
  out.half_width = t_quantile_975(std::max(dof, 1l));
  out.eigenvalues.assign(s.eigenvalues.begin(), s.eigenvalues.end());
  std::vector<double> sizes;  // what the constants' intervals are measured against
  for (std::size_t g = 0; g < shared.size(); ++g) {
    Estimate e = estimate_of(problem.globals[g], s.globals[long(g)], NAN, out.half_width);
    out.fitted.push_back(e.name);
    if (!shared[g]->is_constant()) {
      out.nuisance.push_back(e);
      continue;
    }
    e.judged_size = shared[g]->judged_size;
    sizes.push_back(e.size());
    *std::find_if(out.parameters.begin(), out.parameters.end(), [&](const Estimate& q) { return q.name == e.name; }) =
        e;
  }
  for (Considered& c : considered_at_bounds(s, problem, variance)) out.considered.push_back(std::move(c));
  set_errors(s.global_covariance * variance, out);
  for (std::size_t l = 0; l < problem.locals.size(); ++l)
    for (long b = 0; b < long(problem.blocks.size()); ++b)
      out.nuisance.push_back(estimate_of(problem.locals[l], s.locals(b, long(l)),
                                         s.local_variance(b, long(l)) * variance, out.half_width, int(b)));
  out.weakest = weakest_of(s, problem, sizes, variance, out.half_width);
  warn(wording, out);
}

}  // namespace ukemi::identify
