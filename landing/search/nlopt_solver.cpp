#include "landing/search/nlopt_solver.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <memory>

#include "common/error.hpp"

namespace ukemi::landing {

namespace {

struct Entry {
  nlopt_algorithm algorithm;
  bool global;
};
const std::map<std::string, Entry>& entries() {
  static const std::map<std::string, Entry> map = {{"crs2", {NLOPT_GN_CRS2_LM, true}},
                                                   {"direct_l", {NLOPT_GN_DIRECT_L, true}},
                                                   {"isres", {NLOPT_GN_ISRES, true}},
                                                   {"esch", {NLOPT_GN_ESCH, true}},
                                                   {"mlsl", {NLOPT_G_MLSL_LDS, true}},
                                                   {"sbplx", {NLOPT_LN_SBPLX, false}},
                                                   {"nelder_mead", {NLOPT_LN_NELDERMEAD, false}},
                                                   {"cobyla", {NLOPT_LN_COBYLA, false}},
                                                   {"bobyqa", {NLOPT_LN_BOBYQA, false}}};
  return map;
}

/// State of the C callback, through which no exception may pass.
struct Run {
  const NloptProblem* problem;
  const NloptStop* stop;
  nlopt_opt opt;
  NloptResult best;
  std::exception_ptr error;
};

double objective_callback(unsigned n, const double* x, double*, void* data) {
  Run& run = *static_cast<Run*>(data);
  try {
    const double v = run.problem->f(x);
    ++run.best.evaluations;
    if (v < run.best.value) run.best.value = v, run.best.x.assign(x, x + n);
    if (run.stop->over && run.stop->over()) nlopt_force_stop(run.opt);
    return v;
  } catch (...) {
    run.error = std::current_exception();
    nlopt_force_stop(run.opt);
    return std::numeric_limits<double>::max();
  }
}

struct EpigraphRun {
  const EpigraphProblem* problem;
  nlopt_opt opt;
  std::exception_ptr error;
};

double epigraph_objective(unsigned n, const double* x, double* gradient, void*) {
  if (gradient) std::fill(gradient, gradient + n - 1, 0), gradient[n - 1] = 1;
  return x[n - 1];
}

void epigraph_constraints(unsigned m, double* result, unsigned n, const double* x, double* gradient, void* data) {
  EpigraphRun& run = *static_cast<EpigraphRun*>(data);
  try {
    std::vector<double> d(std::size_t(m) * (n - 1));
    if (!run.problem->peaks(x, result, d.data())) nlopt_force_stop(run.opt);
    for (unsigned k = 0; k < m; ++k) {
      result[k] -= x[n - 1];
      if (!gradient) continue;
      std::copy_n(&d[std::size_t(k) * (n - 1)], n - 1, gradient + k * n);
      gradient[k * n + n - 1] = -1;
    }
  } catch (...) {
    run.error = std::current_exception();
    std::fill(result, result + m, 0.0);
    nlopt_force_stop(run.opt);
  }
}

}  // namespace

const std::vector<std::string>& nlopt_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> n;
    for (const auto& [name, entry] : entries()) n.push_back(name);
    return n;
  }();
  return names;
}
bool is_global(const std::string& name) { return entries().at(name).global; }

NloptResult minimize(const std::string& algorithm, const NloptProblem& problem, const NloptStop& stop,
                     std::uint64_t seed) {
  const auto it = entries().find(algorithm);
  if (it == entries().end())
    throw InputError("solver: " + quoted(algorithm) + ": not known" + hint(algorithm, nlopt_names()));
  const auto n = unsigned(problem.lower.size());
  using Handle = std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)>;
  const Handle opt(nlopt_create(it->second.algorithm, n), &nlopt_destroy),
      local(nlopt_create(NLOPT_LN_SBPLX, n), &nlopt_destroy);
  Run run{&problem, &stop, opt.get(), {problem.start, std::numeric_limits<double>::infinity(), 0, 0, ""}, nullptr};
  nlopt_srand(static_cast<unsigned long>(seed));  // per thread in NLopt
  nlopt_set_min_objective(opt.get(), objective_callback, &run);
  nlopt_set_lower_bounds(opt.get(), problem.lower.data());
  nlopt_set_upper_bounds(opt.get(), problem.upper.data());
  nlopt_set_maxeval(opt.get(), int(stop.evaluations));
  if (!problem.step.empty()) nlopt_set_initial_step(opt.get(), problem.step.data());
  if (!it->second.global && stop.x_tolerance > 0) nlopt_set_xtol_rel(opt.get(), stop.x_tolerance);
  if (it->second.algorithm == NLOPT_G_MLSL_LDS) {
    nlopt_set_xtol_rel(local.get(), 1e-4);
    nlopt_set_local_optimizer(opt.get(), local.get());
  }
  std::vector<double> x = problem.start;
  double value = 0;
  run.best.code = nlopt_optimize(opt.get(), x.data(), &value);
  run.best.message = nlopt_result_to_string(nlopt_result(run.best.code));
  if (run.error) std::rethrow_exception(run.error);
  return run.best;
}

int minimize_epigraph(const EpigraphProblem& problem, double x_tolerance) {
  constexpr int kMaxEvaluations = 500;  // a line search on a kink may not end
  const auto n = unsigned(problem.start.size()) + 1;
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> opt(nlopt_create(NLOPT_LD_SLSQP, n), &nlopt_destroy);
  EpigraphRun run{&problem, opt.get(), nullptr};
  std::vector<double> lower = problem.lower, upper = problem.upper, x = problem.start;
  lower.push_back(0), upper.push_back(HUGE_VAL), x.push_back(problem.start_value);
  const std::vector<double> tolerance(std::size_t(problem.count), 1e-9);
  nlopt_set_min_objective(opt.get(), epigraph_objective, nullptr);
  nlopt_set_lower_bounds(opt.get(), lower.data());
  nlopt_set_upper_bounds(opt.get(), upper.data());
  nlopt_add_inequality_mconstraint(opt.get(), unsigned(problem.count), epigraph_constraints, &run, tolerance.data());
  nlopt_set_xtol_rel(opt.get(), x_tolerance);
  nlopt_set_maxeval(opt.get(), kMaxEvaluations);
  double value = 0;
  const int code = nlopt_optimize(opt.get(), x.data(), &value);
  if (run.error) std::rethrow_exception(run.error);
  return code;
}

}  // namespace ukemi::landing
