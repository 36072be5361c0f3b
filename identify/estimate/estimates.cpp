#include "identify/estimate/estimates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/csv.hpp"
#include "identify/estimate/covariance.hpp"
#include "identify/estimate/statistics.hpp"

namespace ukemi::identify {

std::vector<const Estimate*> Estimates::globals() const {
  std::vector<const Estimate*> out;
  for (const std::string& name : fitted)
    for (const auto* list : {&parameters, &nuisance})
      for (const Estimate& e : *list)
        if (e.name == name && e.trial < 0) out.push_back(&e);
  return out;
}

namespace {

void warn(const Wording& wording, Estimates& out) {
  const auto interval = [&](const Estimate& e) {
    return wording.interval == Wording::Interval::kRelative
               ? fmt::format("{:.0f} % of its value", 100 * e.half_width() / std::abs(e.value))
               : fmt::format("{:.3g} {}", e.half_width(), e.unit);
  };
  for (const Estimate& e : out.parameters) {
    if (e.verdict == Identifiability::kAtBound)
      out.warnings.push_back(fmt::format("{} ended at its bound {}: no standard error", e.name, shortest(e.value)));
    if (e.verdict == Identifiability::kNotIdentifiable)
      out.warnings.push_back(
          e.std ? fmt::format("{} is not identifiable: the 95 % interval is {} either way", e.name, interval(e))
                : fmt::format("{} is not determined by these {}", e.name, wording.data));
  }
  const std::vector<const Estimate*> globals = out.globals();
  const auto trusted = [&](std::size_t g) { return globals[g]->verdict == Identifiability::kTrusted; };
  for (std::size_t i = 0; i < globals.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double r = out.correlation(long(i), long(j));
      if (wording.correlated == Wording::Correlated::kUnlessTrusted && trusted(i) && trusted(j)) continue;
      if (std::abs(r) > 0.95)
        out.warnings.push_back(fmt::format("{} and {} correlate by {:.3f}: these {} hardly tell them apart",
                                           globals[j]->name, globals[i]->name, r, wording.data));
    }
}

}  // namespace

void set_estimates(const LeastSquaresSolution& s, const LeastSquaresProblem& problem,
                   const std::vector<const Term*>& shared, const Wording& wording, Estimates& out) {
  out.cost = s.cost, out.converged = s.converged, out.iterations = s.iterations;
  const long dof = s.residuals - s.free_parameters;
  const double variance = dof > 0 ? s.cost / double(dof) : std::numeric_limits<double>::quiet_NaN();
  out.half_width = t_quantile_975(std::max(dof, 1l));
  out.covariance = s.global_covariance * variance;
  out.correlation = correlation_of(out.covariance);
  out.eigenvalues = s.eigenvalues;
  std::vector<double> sizes;  // what the constants' intervals are measured against
  for (std::size_t g = 0; g < shared.size(); ++g) {
    const long i = long(g);
    Estimate e = estimate_of(problem.globals[g], s.globals[i], out.covariance(i, i), out.half_width);
    out.fitted.push_back(e.name);
    if (!shared[g]->is_constant()) {
      out.nuisance.push_back(e);
      continue;
    }
    e.judged_size = shared[g]->judged_size;
    sizes.push_back(std::max(std::abs(e.value), e.judged_size));
    e.verdict = judge(e, sizes.back());
    *std::find_if(out.parameters.begin(), out.parameters.end(), [&](const Estimate& q) { return q.name == e.name; }) =
        e;
  }
  for (std::size_t l = 0; l < problem.locals.size(); ++l)
    for (long b = 0; b < long(problem.blocks.size()); ++b)
      out.nuisance.push_back(estimate_of(problem.locals[l], s.locals(b, long(l)),
                                         s.local_variance(b, long(l)) * variance, out.half_width, int(b)));
  out.weakest = weakest_of(s, problem, sizes, variance, out.half_width);
  warn(wording, out);
}

}  // namespace ukemi::identify
