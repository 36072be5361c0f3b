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

/// What an explanation costs beside the residuals, by its size in the errors that the rig states. These are guesses
/// themselves: Cauchy's distribution, by which five of them are no proof.
double surprise(const RigTerm& t, double size, const Rig& rig) {
  const double error = t.error ? rig.errors.*t.error->at : 0;
  return error > 0 ? 2 * std::log1p(size * size / (error * error)) : 0;
}

/// A term whose column of the squares is `column`, `size` beyond its absence, while what stands in the columns `rest`
/// follows.
struct Explanation {
  const RigTerm& term;
  int column;
  double size;
  std::vector<int> rest;
};

/// In a line. All that explain a part of what the term explains, at least `share`, or within kToldApart all of it.
/// Where only a part is asked for, one whose line leads beyond its upper bound counts too, at its absence and as told
/// apart: a large lag is no straight line.
std::vector<Rival> rivals(const Explanation& of, const Experiment& experiment, const Fit& fit, const Sensitivity& s,
                          double share = 1) {
  const MatrixXd squares = s.sum(0, 0, s.columns(), s.columns());
  const ScaledSolver solve(s.information(of.rest, of.rest));
  const auto follows = [&](int column) -> VectorXd { return -solve(squares(of.rest, std::vector{column})); };
  const VectorXd own = follows(of.column);
  // Of two columns, what the rest leaves of their product.
  const auto left = [&](int column, const VectorXd& other, int other_column) {
    return squares(column, other_column) + squares(of.rest, std::vector{column}).col(0).dot(other);
  };
  const double self = left(of.column, own, of.column), x = of.size, variance = s.variance;
  std::vector<Rival> out;
  if (!(x * x * self > kToldApart * variance)) return out;  // the logs hardly ask for it
  for (std::size_t a = 0; a < s.shared.size(); ++a) {
    const RigTerm& other = s.shared[a];
    const int column = s.parameters() + int(a);
    if (column == of.column) continue;
    const VectorXd theirs = follows(column);
    const double across = left(of.column, theirs, column), square = left(column, theirs, column);
    if (!(square > 1e-12 * squares(column, column))) continue;  // the rest does all that it does
    const double y = x * across / square;
    const double bic = x * x * (self - across * across / square) / variance + surprise(other, y, experiment.rig) -
                       surprise(of.term, x, experiment.rig);
    const double value = other.value_in(fit.sea) + y;
    if (!(bic < std::max(kToldApart, (1 - share) * x * x * self / variance))) continue;
    const bool beyond = value > other.upper;
    if (value < other.lower || (beyond && share == 1)) continue;
    Rival r{of.term.name, other.name, beyond ? other.absent : value, beyond ? std::max(bic, kToldApart) : bic,
            std::vector<double>(fit.fitted.size(), 0.0)};
    for (std::size_t i = 0; i < of.rest.size(); ++i)
      r.shift[std::size_t(s.free[std::size_t(of.rest[i])])] = theirs[long(i)] * y - own[long(i)] * x;
    out.push_back(std::move(r));
  }
  return out;
}

/// The same by a fit with the other in the term's place, which starts where the line ends; none where that finds
/// nothing, or the logs tell the two apart.
std::optional<Rival> refitted(const Rival& r, const Experiment& experiment, const Fit& fit) {
  FitOptions options = experiment.options;
  std::replace(options.terms.nuisance.begin(), options.terms.nuisance.end(), r.term, r.other);
  SeaParameters<double> from = fit.sea;
  options.terms[r.term].set_in(from, options.terms[r.term].absent);
  options.terms[r.other].set_in(from, r.value);
  Rig unstated = experiment.rig;  // its errors are no priors here: they count as `surprise`
  unstated.errors = RigErrors::exact();
  const Fit with = refit(unstated, experiment.trials, from, options);
  if (!with.converged) return std::nullopt;
  const auto value_in = [](const Fit& f, const std::string& name) {
    for (const Estimate* e : f.globals())
      if (e->name == name) return e->value;
    return std::numeric_limits<double>::quiet_NaN();
  };
  Rival out{r.term, r.other, value_in(with, r.other), 0, {}};
  const RigTerm &term = options.terms[r.term], &other = options.terms[r.other];
  out.bic = deviance(with, experiment.trials, options) - deviance(fit, experiment.trials, options) +
            surprise(other, out.value - other.absent, experiment.rig) -
            surprise(term, value_in(fit, r.term) - term.absent, experiment.rig);
  if (!(out.bic < kToldApart)) return std::nullopt;
  for (const std::string& name : fit.fitted) {
    const double moved = value_in(with, name) - value_in(fit, name);
    out.shift.push_back(std::isfinite(moved) ? moved : 0);  // the term itself is gone
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
  constexpr double kLeastShare = 0.5;
  constexpr std::size_t kMostFits = 4;
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
    std::vector<Rival> found = rivals({term, f, e.value - term.absent, rest}, experiment, fit, s, kLeastShare);
    std::sort(found.begin(), found.end(), [](const Rival& a, const Rival& b) { return a.bic < b.bic; });
    std::size_t fits = 0;
    for (Rival& r : found) {
      if (r.bic < kToldApart)
        out.push_back(std::move(r));
      else if (doubt && fits++ < kMostFits)
        if (auto again = refitted(r, of_noise(experiment), fit)) out.push_back(std::move(*again));
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
