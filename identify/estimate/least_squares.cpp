#include "identify/estimate/least_squares.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <mutex>
#include <optional>

#include "common/error.hpp"
#include "identify/estimate/covariance.hpp"

namespace ukemi::identify {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// r -> sign(r) sqrt(rho(r^2)) with Huber's rho, so that the sum of squares is the robust cost; scales the Jacobian's
/// rows, if any.
void robustify(double delta, Eigen::VectorXd& r, Eigen::MatrixXd& jacobian) {
  for (Eigen::Index i = 0; i < r.size(); ++i) {
    const double a = std::abs(r[i]);
    if (a <= delta) continue;
    const double robust = std::sqrt(2 * delta * a - delta * delta), slope = delta / robust;  // d robust / d a
    r[i] = std::copysign(robust, r[i]);
    if (jacobian.size() > 0) jacobian.row(i) *= slope;
  }
}

/// R of [J r] = Q R from [J r]' [J r]; a zero row where a column depends on those before it.
Eigen::MatrixXd triangle_of(Eigen::MatrixXd gram) {
  const Eigen::Index n = gram.rows();
  const Eigen::VectorXd diagonal = gram.diagonal();
  constexpr double kRounding = 1e-15;
  Eigen::MatrixXd r = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(gram(i, i) > kRounding * diagonal[i])) continue;
    r.row(i).tail(n - i) = gram.row(i).tail(n - i) / std::sqrt(gram(i, i));
    gram.noalias() -= r.row(i).transpose() * r.row(i);
  }
  return r;
}

/// A block in scaled parameters, as the solver sees it. Least squares needs only R of [J r] = Q R of n residuals by p
/// parameters: p + 1 rows instead of n, at the same cost.
class BlockCost final : public ceres::CostFunction {
 public:
  /// The globals in `held` have derivatives 0.
  BlockCost(const LeastSquaresProblem& problem, const ResidualBlock& block, const LeastSquaresOptions& options,
            const std::vector<bool>& held)
      : block_(block),
        options_(options),
        held_(held),
        globals_(int(problem.globals.size())),
        locals_(int(problem.locals.size())) {
    const int p = globals_ + locals_;
    scale_.resize(p), lower_.resize(p), upper_.resize(p);
    for (int i = 0; i < p; ++i) {
      const Parameter& own = i < globals_ ? problem.globals[std::size_t(i)] : problem.locals[std::size_t(i - globals_)];
      scale_[i] = own.scale, lower_[i] = own.lower, upper_[i] = own.upper;
    }
    set_num_residuals(globals_ + locals_ + 1);
    mutable_parameter_block_sizes()->push_back(globals_);
    if (locals_ > 0) mutable_parameter_block_sizes()->push_back(locals_);
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    // A trial step may be refused at any time; derivatives at a point that was accepted must not fail.
    if (!jacobians && options_.stop && options_.stop()) return false;
    const int p = globals_ + locals_;
    Eigen::Map<Eigen::VectorXd> r(residuals, p + 1);
    if (!jacobians) {
      const std::optional<double> square = cost(x);
      if (!square) return false;
      r.setZero(), r[p] = std::sqrt(*square);
      return true;
    }
    const Eigen::MatrixXd* products = gram(x);
    if (!products) return false;
    const Eigen::MatrixXd triangle = triangle_of(*products);
    r = triangle.col(p);
    if (jacobians[0]) {
      Eigen::Map<RowMajor> by_globals(jacobians[0], p + 1, globals_);
      by_globals = triangle.leftCols(globals_);
      for (int i = 0; i < globals_; ++i)
        if (held_[std::size_t(i)]) by_globals.col(i).setZero();
    }
    if (locals_ > 0 && jacobians[1])
      Eigen::Map<RowMajor>(jacobians[1], p + 1, locals_) = triangle.middleCols(globals_, locals_);
    return true;
  }

  /// The Gram matrix [J r]' [J r]: globals, locals, residual; null where the block cannot be evaluated. Those of the
  /// last two points are cached: the solver evaluates cost, then derivatives of a point, and the covariance the former.
  const Eigen::MatrixXd* gram(double const* const* x) const {
    const Eigen::VectorXd at = point(x);
    if (const Eigen::MatrixXd* known = cached(at)) return known;
    const int p = globals_ + locals_;
    thread_local Eigen::MatrixXd jacobian;
    jacobian.resize(block_.size, p);
    const Eigen::VectorXd* r = residuals_at(at, jacobian);
    if (!r) return nullptr;
    std::swap(cache_[0], cache_[1]);
    cache_[0].at = at;
    Eigen::MatrixXd& out = cache_[0].gram;
    out.resize(p + 1, p + 1);
    const auto column = [&](int i) {
      return Eigen::Map<const Eigen::VectorXd>(i < p ? jacobian.col(i).data() : r->data(), block_.size);
    };
    for (int i = 0; i <= p; ++i)  // faster than a matrix product for so few columns
      for (int j = 0; j <= i; ++j)
        out(i, j) = out(j, i) = (i < p ? scale_[i] : 1) * (j < p ? scale_[j] : 1) * column(i).dot(column(j));
    return &out;
  }

 private:
  struct CachedGram {
    Eigen::VectorXd at;
    Eigen::MatrixXd gram;
  };
  const Eigen::MatrixXd* cached(const Eigen::VectorXd& at) const {
    for (const CachedGram& k : cache_)
      if (k.at.size() == at.size() && k.at == at) return &k.gram;
    return nullptr;
  }
  std::optional<double> cost(double const* const* x) const {
    const Eigen::VectorXd at = point(x);
    if (const Eigen::MatrixXd* known = cached(at)) return (*known)(globals_ + locals_, globals_ + locals_);
    Eigen::MatrixXd none;
    const Eigen::VectorXd* r = residuals_at(at, none);
    return r ? std::optional(r->squaredNorm()) : std::nullopt;
  }
  /// The parameters in their own units, globals, then locals; clamped to their bounds, which scaling may miss by a
  /// rounding.
  Eigen::VectorXd point(double const* const* x) const {
    Eigen::VectorXd out(globals_ + locals_);
    out.head(globals_) = Eigen::Map<const Eigen::VectorXd>(x[0], globals_);
    if (locals_ > 0) out.tail(locals_) = Eigen::Map<const Eigen::VectorXd>(x[1], locals_);
    return out.cwiseProduct(scale_).cwiseMax(lower_).cwiseMin(upper_);
  }
  /// The block's residuals and, unless it is empty, the Jacobian; null where it cannot be evaluated.
  const Eigen::VectorXd* residuals_at(const Eigen::VectorXd& at, Eigen::MatrixXd& jacobian) const {
    thread_local Eigen::VectorXd r;
    r.resize(block_.size);
    if (!block_.evaluate(at.data(), at.data() + globals_, r.data(), jacobian.size() > 0 ? jacobian.data() : nullptr))
      return nullptr;
    if (!r.allFinite()) return nullptr;
    if (options_.huber > 0) robustify(options_.huber, r, jacobian);
    return &r;
  }

  const ResidualBlock& block_;
  const LeastSquaresOptions& options_;
  const std::vector<bool>& held_;
  int globals_, locals_;
  Eigen::VectorXd scale_, lower_, upper_;
  mutable std::array<CachedGram, 2> cache_;  ///< the latest first
};

/// A prior in scaled parameters.
class PriorCost final : public ceres::CostFunction {
 public:
  PriorCost(const LeastSquaresProblem& problem, const PriorResidual& prior)
      : prior_(prior), scale_(problem.globals[std::size_t(prior.global)].scale), globals_(int(problem.globals.size())) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(globals_);
  }
  bool Evaluate(double const* const* x, double* residual, double** jacobians) const override {
    *residual = (x[0][prior_.global] * scale_ - prior_.value) * prior_.weight;
    if (jacobians && jacobians[0]) {
      std::fill_n(jacobians[0], globals_, 0.0);
      jacobians[0][prior_.global] = scale_ * prior_.weight;
    }
    return true;
  }

 private:
  PriorResidual prior_;
  double scale_;
  int globals_;
};

/// Whether a scaled value is at a bound: -1 the lower, +1 the upper, 0 neither.
int bound_of(const Parameter& p, double x) { return x <= p.lower / p.scale ? -1 : x >= p.upper / p.scale ? 1 : 0; }

/// Ends a search where the caller stops it, where it crawls along an edge of the cost (LeastSquaresOptions), and where
/// a step failed with a free parameter at a bound: Ceres solves for all of them and then cuts the step off at the
/// bounds, which turns it away from the minimum along them.
struct StopCriteria final : ceres::IterationCallback {
  StopCriteria(const std::vector<Parameter>& parameters, const std::vector<double>& scaled,
               const std::vector<bool>& is_held, const LeastSquaresOptions& options)
      : list(parameters), x(scaled), held(is_held), stop(options.stop), tolerance(options.cost_tolerance) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& s) override {
    cut_off = !s.step_is_successful && s.iteration > 0 && at_free_bound();
    crawling = is_crawling(s);
    return cut_off || crawling || (stop && stop()) ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
  bool is_crawling(const ceres::IterationSummary& s) {
    constexpr std::size_t kSteps = 10;
    constexpr double kSlow = 3;  // times the tolerance, each step
    if (s.iteration == 0) costs.clear();
    if (s.step_is_successful || s.iteration == 0) costs.push_back(s.cost);
    if (costs.size() > kSteps + 1) costs.pop_front();
    return costs.size() == kSteps + 1 && costs.front() - costs.back() < kSteps * kSlow * tolerance * costs.back();
  }
  bool at_free_bound() const {
    for (std::size_t i = 0; check_bounds && i < x.size(); ++i)
      if (!held[i] && bound_of(list[i], x[i]) != 0) return true;
    return false;
  }
  const std::vector<Parameter>& list;
  const std::vector<double>& x;  ///< scaled, of the last iteration
  const std::vector<bool>& held;
  const std::function<bool()>& stop;
  double tolerance;
  std::deque<double> costs = {};  ///< of the last steps that were taken
  bool check_bounds = true, cut_off = false, crawling = false;
};

/// Scaled starting point: `start` or, where that is empty, each parameter's own.
std::vector<double> scaled_start(const std::vector<Parameter>& list, const std::vector<double>& start = {}) {
  std::vector<double> x;
  for (std::size_t i = 0; i < list.size(); ++i)
    x.push_back(std::clamp(start.empty() ? list[i].start : start[i], list[i].lower, list[i].upper) / list[i].scale);
  return x;
}

void set_bounds(ceres::Problem& problem, double* x, const std::vector<Parameter>& list) {
  for (int i = 0; i < int(list.size()); ++i) {
    const Parameter& p = list[std::size_t(i)];
    if (std::isfinite(p.lower)) problem.SetParameterLowerBound(x, i, p.lower / p.scale);
    if (std::isfinite(p.upper)) problem.SetParameterUpperBound(x, i, p.upper / p.scale);
  }
}

ceres::Solver::Options ceres_options(const LeastSquaresOptions& options) {
  ceres::Solver::Options o;
  o.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;  // thousands of residuals for each parameter
  o.max_num_iterations = options.max_iterations;
  o.function_tolerance = options.cost_tolerance;
  o.parameter_tolerance = options.step_tolerance;
  o.gradient_tolerance = 1e-15;  // never reached: the two above end the search
  o.max_num_consecutive_invalid_steps = options.rejected_steps;
  o.initial_trust_region_radius = options.first_radius;
  o.logging_type = ceres::SILENT;
  o.num_threads = 1;  // the sum over blocks must not depend on the number of threads
  return o;
}

/// The solver's point in the parameters' own units, and which globals are at a bound.
void set_point(const LeastSquaresProblem& problem, const std::vector<double>& x,
               const std::vector<std::vector<double>>& locals, LeastSquaresSolution& out) {
  const int G = int(problem.globals.size());
  out.globals.resize(G);
  for (int i = 0; i < G; ++i) {
    const Parameter& p = problem.globals[std::size_t(i)];
    out.globals[i] = x[std::size_t(i)] * p.scale;
    const int bound = bound_of(p, x[std::size_t(i)]);
    if (bound != 0) out.globals[i] = bound < 0 ? p.lower : p.upper;
    out.at_bound.push_back(bound != 0 || p.held);
  }
  out.locals.resize(long(problem.blocks.size()), long(problem.locals.size()));
  for (std::size_t b = 0; b < locals.size(); ++b)
    for (std::size_t l = 0; l < problem.locals.size(); ++l)
      out.locals(long(b), long(l)) = locals[b][l] * problem.locals[l].scale;
  out.global_covariance.setConstant(G, G, std::numeric_limits<double>::quiet_NaN());
  out.local_variance.setConstant(out.locals.rows(), out.locals.cols(), std::numeric_limits<double>::quiet_NaN());
}

/// Why the search ended.
std::string reason(const ceres::Solver::Summary& s, const StopCriteria& criteria, int max_iterations) {
  if (criteria.crawling) return "the cost falls too slowly: its minimum is at an edge";
  if (s.termination_type == ceres::NO_CONVERGENCE) return fmt::format("{} iterations were done", max_iterations);
  if (s.termination_type == ceres::USER_SUCCESS) return "it was stopped, or its work was spent";
  if (!s.IsSolutionUsable()) return "the model cannot be followed at the start";
  return s.message;
}

/// The problem as Ceres sees it: its point in scaled parameters, and a cost of each block and prior.
struct ScaledProblem {
  std::vector<double> x;
  std::vector<std::vector<double>> locals;
  std::vector<bool> held;  ///< as requested, or at an active bound
  bool all_held;           ///< as requested: only the locals are free
  std::deque<BlockCost> costs;
  std::deque<PriorCost> priors;
  long residuals = 0;
  ceres::Problem ceres_problem;

  ScaledProblem(const LeastSquaresProblem& problem, const LeastSquaresOptions& options)
      : x(scaled_start(problem.globals)), ceres_problem(non_owning()) {
    for (const ResidualBlock& b : problem.blocks) locals.push_back(scaled_start(problem.locals, b.local_start));
    for (const Parameter& p : problem.globals) held.push_back(p.held);
    all_held = !held.empty() && std::find(held.begin(), held.end(), false) == held.end();
    for (std::size_t b = 0; b < problem.blocks.size(); ++b) {
      std::vector<double*> blocks{x.data()};
      if (!problem.locals.empty()) blocks.push_back(locals[b].data());
      costs.emplace_back(problem, problem.blocks[b], options, held);
      ceres_problem.AddResidualBlock(&costs.back(), nullptr, blocks);
      residuals += problem.blocks[b].size;
    }
    for (const PriorResidual& p : problem.priors) {
      priors.emplace_back(problem, p);
      ceres_problem.AddResidualBlock(&priors.back(), nullptr, x.data());
      ++residuals;
    }
    if (all_held)
      ceres_problem.SetParameterBlockConstant(x.data());
    else
      set_bounds(ceres_problem, x.data(), problem.globals);
    if (!problem.locals.empty())
      for (auto& l : locals) set_bounds(ceres_problem, l.data(), problem.locals);
  }
  ScaledProblem(const ScaledProblem&) = delete;
  ScaledProblem& operator=(const ScaledProblem&) = delete;

  /// The Gram matrix of each block; none where one cannot be evaluated.
  std::optional<std::vector<const Eigen::MatrixXd*>> grams() const {
    std::vector<const Eigen::MatrixXd*> out;
    for (std::size_t b = 0; b < costs.size(); ++b) {
      const double* at[2] = {x.data(), locals[b].data()};
      out.push_back(costs[b].gram(at));
      if (!out.back()) return std::nullopt;
    }
    return out;
  }
  /// Active set: the globals at a bound that the cost pushes against it; `held` where a block has no derivatives.
  std::vector<bool> active_set(const LeastSquaresProblem& problem) const {
    const auto at = grams();
    if (!at) return held;
    const Eigen::VectorXd gradient = gradient_at(problem, *at, x);
    std::vector<bool> out;
    for (std::size_t i = 0; i < problem.globals.size(); ++i) {
      const int bound = bound_of(problem.globals[i], x[i]);
      out.push_back(problem.globals[i].held || (bound != 0 && bound * gradient[long(i)] < 0));
    }
    return out;
  }

 private:
  static ceres::Problem::Options non_owning() {
    ceres::Problem::Options out;
    out.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return out;
  }
};

/// Solves with the active set held until that no longer changes; returns the last summary. Counts `iterations`.
ceres::Solver::Summary solve_by_active_sets(const LeastSquaresProblem& problem, const LeastSquaresOptions& options,
                                            ScaledProblem& scaled, StopCriteria& criteria, int& iterations) {
  constexpr int kMaxActiveSets = 8;  // then Ceres handles the bounds to the end
  ceres::Solver::Options o = ceres_options(options);
  o.callbacks.push_back(&criteria);
  o.update_state_every_iteration = true;
  ceres::Solver::Summary summary;
  bool update_held = !scaled.all_held;
  for (int sets = 1;; ++sets) {
    criteria.check_bounds = update_held;
    ceres::Solve(o, &scaled.ceres_problem, &summary);
    iterations += int(summary.iterations.size()) - 1;
    if (!update_held || !summary.IsSolutionUsable() || (options.stop && options.stop())) return summary;
    std::vector<bool> active = scaled.active_set(problem);
    if (active == scaled.held && !criteria.cut_off) return summary;
    update_held = active != scaled.held && sets < kMaxActiveSets;
    scaled.held = std::move(active);
  }
}

void silence_glog() {
  static std::once_flag once;
  std::call_once(once, [] { FLAGS_minloglevel = 3; });
}

}  // namespace

void LeastSquaresProblem::validate() const {
  for (const auto* list : {&globals, &locals})
    for (const Parameter& p : *list)
      if (!(std::isfinite(p.start) && p.scale > 0 && std::isfinite(p.scale) && p.lower < p.upper))
        throw InputError(
            fmt::format("{}: start {}, scale {}, bounds {} to {}: a finite start, a scale above 0 and bounds "
                        "that rise are needed",
                        p.name, p.start, p.scale, p.lower, p.upper));
  for (const PriorResidual& p : priors)
    if (p.global < 0 || p.global >= int(globals.size()) || !std::isfinite(p.value) || !std::isfinite(p.weight))
      throw InputError(fmt::format("prior of global {}: {} with weight {}: finite, of one of {}, is needed", p.global,
                                   p.value, p.weight, globals.size()));
}

LeastSquaresSolution solve(const LeastSquaresProblem& problem, const LeastSquaresOptions& options) {
  problem.validate();
  silence_glog();
  LeastSquaresSolution out;
  ScaledProblem scaled(problem, options);
  StopCriteria criteria(problem.globals, scaled.x, scaled.held, options);
  const ceres::Solver::Summary summary = solve_by_active_sets(problem, options, scaled, criteria, out.iterations);

  out.residuals = scaled.residuals;
  out.usable = summary.IsSolutionUsable();
  out.converged = summary.termination_type == ceres::CONVERGENCE || criteria.crawling;
  out.message = reason(summary, criteria, options.max_iterations);
  out.cost = out.usable ? 2 * summary.final_cost : std::numeric_limits<double>::infinity();
  set_point(problem, scaled.x, scaled.locals, out);
  if (!out.usable) return out;
  if (scaled.all_held) out.at_bound.assign(problem.globals.size(), true);  // only the locals have errors
  const auto grams = scaled.grams();
  if (!grams) return out;
  out.gradient = gradient_at(problem, *grams, scaled.x);
  for (long i = 0; i < out.gradient.size(); ++i) out.gradient[i] /= problem.globals[std::size_t(i)].scale;
  add_covariances(problem, *grams, out);
  return out;
}

double cost_at(const LeastSquaresProblem& problem, const LeastSquaresOptions& options, const Eigen::VectorXd& globals) {
  std::vector<double> local(problem.locals.size());
  for (std::size_t i = 0; i < local.size(); ++i) local[i] = problem.locals[i].start;
  double sum = 0;
  Eigen::VectorXd r;
  Eigen::MatrixXd no_jacobian;
  for (const ResidualBlock& block : problem.blocks) {
    r.resize(block.size);
    if (!block.evaluate(globals.data(), local.data(), r.data(), nullptr))
      return std::numeric_limits<double>::infinity();
    if (options.huber > 0) robustify(options.huber, r, no_jacobian);
    sum += r.squaredNorm();
  }
  for (const PriorResidual& p : problem.priors) sum += std::pow((globals[p.global] - p.value) * p.weight, 2);
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

}  // namespace ukemi::identify
