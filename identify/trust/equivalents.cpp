#include "identify/trust/equivalents.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "identify/trust/diagnostics.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Cost of an explanation by its size in the error that the rig states: -2 log of a Cauchy density, whose tails allow
/// for the stated error being a guess: five of them are no proof.
double prior_cost(const RigTerm& t, double size, const Rig& rig) {
  const double error = t.error ? rig.errors.*t.error->at : 0;
  return error > 0 ? 2 * std::log1p(size * size / (error * error)) : 0;
}

/// A term at `size` beyond its absent value, with its column of the Gram matrix, and the columns `rest` of the
/// parameters that readjust.
struct Explanation {
  const RigTerm& term;
  int column;
  double size;
  std::vector<int> rest;
};

/// To first order: all terms that explain at least the part `share` of what `explained` does, or all of it within
/// kToldApart. With share < 1, one whose linear estimate is beyond its upper bound is included at its absent value, as
/// distinguished: the effect of a large lag is not linear.
std::vector<Rival> rivals(const Explanation& explained, const Experiment& experiment, const Fit& fit,
                          const Sensitivity& s, double share = 1) {
  const MatrixXd gram = s.gram();
  const ScaledSolver solve(s.information(explained.rest, explained.rest));
  const auto response = [&](int column) -> VectorXd { return -solve(gram(explained.rest, std::vector{column})); };
  const VectorXd own_response = response(explained.column);
  // Product of two columns with the rest eliminated.
  const auto remainder = [&](int column, const VectorXd& other, int other_column) {
    return gram(column, other_column) + gram(explained.rest, std::vector{column}).col(0).dot(other);
  };
  const double self = remainder(explained.column, own_response, explained.column), size = explained.size,
               variance = s.variance;
  std::vector<Rival> out;
  if (!(size * size * self > kToldApart * variance)) return out;  // the logs hardly need it
  for (std::size_t a = 0; a < s.shared.size(); ++a) {
    const RigTerm& other = s.shared[a];
    const int column = s.parameters() + int(a);
    if (column == explained.column) continue;
    const VectorXd other_response = response(column);
    const double cross = remainder(explained.column, other_response, column),
                 other_self = remainder(column, other_response, column);
    if (!(other_self > 1e-12 * gram(column, column))) continue;  // the rest has the same effect
    const double other_size = size * cross / other_self;
    const double bic = size * size * (self - cross * cross / other_self) / variance +
                       prior_cost(other, other_size, experiment.rig) - prior_cost(explained.term, size, experiment.rig);
    const double value = other.value_in(fit.sea) + other_size;
    if (!(bic < std::max(kToldApart, (1 - share) * size * size * self / variance))) continue;
    const bool beyond = value > other.upper;
    if (value < other.lower || (beyond && share == 1)) continue;
    Rival r{explained.term.name, other.name, beyond ? other.absent : value, beyond ? std::max(bic, kToldApart) : bic,
            std::vector<double>(fit.fitted.size(), 0.0)};
    for (std::size_t i = 0; i < explained.rest.size(); ++i)
      r.shift[std::size_t(s.free[std::size_t(explained.rest[i])])] =
          other_response[long(i)] * other_size - own_response[long(i)] * size;
    out.push_back(std::move(r));
  }
  return out;
}

/// The rival by a fit in which it replaces the term, from its linear estimate; none where that fails, or the logs
/// distinguish the two.
std::optional<Rival> refitted(const Rival& r, const Experiment& experiment, const Fit& fit) {
  FitOptions options = experiment.options;
  std::replace(options.terms.nuisance.begin(), options.terms.nuisance.end(), r.term, r.other);
  std::erase_if(options.terms.priors, [&](const Prior& p) { return p.term == r.term; });
  SeaParameters<double> from = fit.sea;
  options.terms[r.term].set_in(from, options.terms[r.term].absent);
  options.terms[r.other].set_in(from, r.value);
  Rig exact_rig = experiment.rig;  // its errors are no priors here but enter prior_cost
  exact_rig.errors = RigErrors::exact();
  const Fit with = refit(exact_rig, experiment.trials, from, options);
  if (!with.converged) return std::nullopt;
  const auto value_in = [](const Fit& f, const std::string& name) {
    for (const Estimate* e : f.globals())
      if (e->name == name) return e->value;
    return std::numeric_limits<double>::quiet_NaN();
  };
  Rival out{r.term, r.other, value_in(with, r.other), 0, {}};
  const RigTerm &term = options.terms[r.term], &other = options.terms[r.other];
  out.bic = deviance(with, experiment.trials, options) - deviance(fit, experiment.trials, options) +
            prior_cost(other, out.value - other.absent, experiment.rig) -
            prior_cost(term, value_in(fit, r.term) - term.absent, experiment.rig);
  if (!(out.bic < kToldApart)) return std::nullopt;
  for (const std::string& name : fit.fitted) {
    const double moved = value_in(with, name) - value_in(fit, name);
    out.shift.push_back(std::isfinite(moved) ? moved : 0);  // 0: the term itself, which was replaced
  }
  return out;
}

}  // namespace

std::vector<Rival> rivals_of(const Experiment& experiment, const Fit& fit, const Sensitivity& s,
                             const std::string& lacking, double size) {
  std::vector<int> rest;
  for (int f = 0; f < s.parameters(); ++f) rest.push_back(f);
  for (std::size_t a = 0; a < s.shared.size(); ++a)
    if (s.shared[a].name == lacking)
      return rivals({s.shared[a], s.parameters() + int(a), size, rest}, experiment, fit, s);
  return {};
}

std::vector<Rival> rivals_of_fitted(const Experiment& experiment, const Fit& fit, const Sensitivity& s) {
  constexpr double kMinShare = 0.5;
  constexpr std::size_t kMaxFits = 4;
  const bool doubt = std::any_of(fit.parameters.begin(), fit.parameters.end(),
                                 [](const Estimate& e) { return e.verdict == Identifiability::kTrusted; });
  const std::vector<const Estimate*> globals = fit.globals();
  std::vector<Rival> out;
  for (int f = 0; f < s.parameters(); ++f) {
    const Estimate& e = *globals[std::size_t(s.free[std::size_t(f)])];
    const RigTerm& term = experiment.options.terms[e.name];
    if (term.is_constant() || !std::isfinite(term.absent)) continue;
    std::vector<int> rest;
    for (int g = 0; g < s.parameters(); ++g)
      if (g != f) rest.push_back(g);
    std::vector<Rival> found = rivals({term, f, e.value - term.absent, rest}, experiment, fit, s, kMinShare);
    std::sort(found.begin(), found.end(), [](const Rival& a, const Rival& b) { return a.bic < b.bic; });
    std::size_t fits = 0;
    for (Rival& r : found) {
      if (r.bic < kToldApart)
        out.push_back(std::move(r));
      else if (doubt && fits++ < kMaxFits)
        if (auto again = refitted(r, noise_only(experiment), fit)) out.push_back(std::move(*again));
    }
  }
  return out;
}

void distrust_moved(const std::vector<Rival>& rivals, Fit& fit) {
  for (const Rival& r : rivals)
    for (std::size_t g = 0; g < fit.fitted.size(); ++g)
      for (Estimate& e : fit.parameters)
        if (e.name == fit.fitted[g] && e.verdict == Identifiability::kTrusted && std::abs(r.shift[g]) > e.half_width())
          e.verdict = Identifiability::kWeak;
}

}  // namespace ukemi::identify
