#include "identify/fit/fit_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

/// Samples and segments of all trials: the scale of the work of their rollouts.
double rollout_size(const std::vector<PreparedTrial>& trials) {
  double size = 0;
  for (const PreparedTrial& t : trials) size += double(t.trial->samples() + t.segments.size());
  return size;
}

/// Number of measurements of all trials, > 0; throws InputError where there is none.
double count_measurements(const std::vector<Trial>& trials) {
  const double n = double(measurements(trials));
  if (n == 0) throw InputError("no measured angle in any trial: phi is needed");
  return n;
}

/// Throws InputError where a fitted term applies to no trial.
void require_columns(const FitOptions& options, const std::vector<Trial>& trials) {
  for (const std::string& name : options.terms.nuisance)
    if (const RigTerm& t = options.terms[name]; !t.applies_to(trials))
      throw InputError(fmt::format("{}: no trial has the column '{}' that it is about", name, t.needs->name));
}

/// The starts that differ from all kept before them by at least `factor` in some constant.
std::vector<SeaParameters<double>> distinct(const std::vector<SeaParameters<double>>& list, double factor) {
  std::vector<SeaParameters<double>> kept;
  for (const SeaParameters<double>& p : list) {
    const bool duplicate = std::any_of(kept.begin(), kept.end(), [&](const SeaParameters<double>& c) {
      const auto a = ukemi::constants(c), b = ukemi::constants(p);
      double farthest = 0;
      for (std::size_t k = 0; k < kConstants; ++k)
        if (a[k] > 0 && b[k] > 0) farthest = std::max(farthest, std::abs(std::log(a[k] / b[k])));
      return farthest < std::log(factor);
    });
    if (!duplicate) kept.push_back(p);
  }
  return kept;
}

}  // namespace

FitSearch::FitSearch(const Rig& rig, const std::vector<Trial>& trials, const std::optional<Sea>& start, const Sea& base,
                     const FitOptions& options)
    : measurements_(count_measurements(trials)),
      rig_(rig),
      start_(start),
      base_(base),
      options_(options),
      layout_(options.terms),
      solver_{.max_iterations = options.max_iterations, .huber = options.huber},
      suggestion_(suggest(rig, trials)),
      prepared_(trials.begin(), trials.end()),
      weights_(trials.size()),
      noise_(noise_level(trials)),
      work_per_start_(options.starts.fit_steps + options.starts.fit_sample_steps * rollout_size(prepared_)),
      multi_start_({.believed = [threshold = kFarAboveNoise * kFarAboveNoise * noise_ * noise_ * measurements_](
                                    const LeastSquaresSolution& s) { return s.converged && s.cost <= threshold; },
                    .work = options.starts.fit_starts * work_per_start_,
                    .most = options.explore > 0 ? options.explore + (start ? 1 : 0) : options.restarts + 1,
                    .threads = options.threads,
                    .monitor = options.monitor}) {
  require_columns(options, trials);
}

void FitSearch::run() {
  if (start_) {
    Sea from = base_;
    set_constants(from, ukemi::constants(*start_));
    copy_optional_terms(*start_, from);
    start_points_ = {from};
    multi_start_.search_all(1, search(0));
  }
  const std::size_t first = start_points_.size();
  if (options_.explore > 0) {
    const double spread = options_.starts.spread;
    for (const Sea& drawn : draw_starts(
             start_ ? Suggestion{.centre = *start_, .spread_gains = spread, .spread_rest = spread} : suggestion_,
             options_.explore, options_.seed))
      start_points_.push_back(clamped(drawn));
    multi_start_.search_all(options_.explore, search(first));
  } else if (options_.restarts > 0 && !multi_start_.believed()) {
    for (const Sea& candidate : candidates()) start_points_.push_back(candidate);
    multi_start_.search_until_believed(std::min(options_.restarts, int(start_points_.size() - first)), search(first));
  }
}

void FitSearch::restart(const Sea& from) {
  multi_start_.forget();
  start_points_.resize(std::size_t(multi_start_.starts()), base_);
  start_points_.push_back(from);
  multi_start_.search_all(1, search(start_points_.size() - 1));
}

std::vector<Minimum> FitSearch::minima() const {
  std::vector<Minimum> out;
  for (const MultiStart::Minimum& m : multi_start_.minima())
    out.push_back({sea_of(m.solution, start_points_[std::size_t(m.start)]), m.solution.cost, m.found});
  return out;
}

FitSearch::Sea FitSearch::sea_of(const LeastSquaresSolution& s, const Sea& from) const {
  const Eigen::VectorXd locals = s.locals.row(0);  // any trial's: no local term is the actuator's
  return RigPoint(layout_, s.globals.data(), locals.data()).inputs(from).sea;
}

std::string FitSearch::stop_reason() const {
  return budget_spent_ ? fmt::format("a start was ended after {:.3g} integrated steps", work_per_start_) : "";
}

LeastSquaresProblem FitSearch::problem(const Sea& from, Budget* budget) const {
  RolloutOptions o = options_.rollout();
  o.budget = budget;
  return make_problem(rig_, prepared_, weights_, from, suggestion_, layout_, options_, o);
}

MultiStart::Search FitSearch::search(std::size_t first) {
  return [this, first](int i) {
    Budget budget{work_per_start_, work_per_start_};
    LeastSquaresOptions bounded = solver_;
    bounded.stop = [&] { return budget.spent() || options_.monitor.stopped(); };
    LeastSquaresSolution s = solve(problem(start_points_[first + std::size_t(i)], &budget), bounded);
    s.work = work_per_start_ - budget.left;
    if (budget.spent()) budget_spent_ = true;
    return s;
  };
}

void FitSearch::copy_optional_terms(const Sea& from, Sea& to) const {
  for (const RigTerm* t : layout_.shared)
    if (!t->is_constant() && !t->key.empty() && t->value_in(from) != t->absent) t->set_in(to, t->value_in(from));
}

FitSearch::Sea FitSearch::clamped(const Sea& drawn) const {
  Sea out = base_;
  const Choice& c = options_.terms;
  for (const RigTerm& t : *options_.terms.table)
    if (t.is_constant())
      t.set_in(out, c.fits(t.name) ? std::clamp(t.value_in(drawn), c.lower_of(t), c.upper_of(t))
                                   : t.value_in(start_ ? *start_ : base_));
  copy_optional_terms(drawn, out);
  return out;
}

std::vector<FitSearch::Sea> FitSearch::candidates() const {
  const StartOptions& o = options_.starts;
  const int draws = suggestion_.spread_gains < 2 ? o.draws_near : o.draws;
  std::vector<Sea> drawn = draw_starts(suggestion_, draws, options_.seed);
  if (start_) {  // half of them about the given start instead
    const auto around_start = draw_starts({.centre = *start_, .spread_gains = o.spread, .spread_rest = o.spread},
                                          draws / 2, options_.seed + 1);
    std::copy(around_start.begin(), around_start.end(), drawn.begin());
  }
  std::vector<PreparedTrial> trials;
  for (std::size_t m = 0; m < prepared_.size() && trials.size() < 2;
       m += std::max<std::size_t>(1, prepared_.size() / 2))
    trials.push_back(prepared_[m]);
  const std::vector<Weighting> equal(trials.size());
  RolloutOptions coarse{.accuracy = o.accuracy, .escape = options_.escape, .max_steps = o.steps};
  std::vector<std::pair<double, std::size_t>> by_cost;
  for (std::size_t i = 0; i < drawn.size() && !options_.monitor.stopped(); ++i) {
    drawn[i] = clamped(drawn[i]);
    Budget budget{o.sample_steps * rollout_size(trials)};
    coarse.budget = &budget;
    const LeastSquaresProblem p = make_problem(rig_, trials, equal, drawn[i], suggestion_, layout_, options_, coarse);
    Eigen::VectorXd globals(long(p.globals.size()));
    for (long g = 0; g < globals.size(); ++g) globals[g] = p.globals[std::size_t(g)].start;
    by_cost.emplace_back(cost_at(p, solver_, globals), i);
  }
  std::sort(by_cost.begin(), by_cost.end());
  std::vector<Sea> ordered;
  for (const auto& [cost, i] : by_cost)
    if (std::isfinite(cost)) ordered.push_back(drawn[i]);
  return distinct(ordered, o.apart);
}

}  // namespace ukemi::identify
