#include "tools/study/drop_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ukemi::tools {

namespace {

/// Standard deviation, over a constant's size, of the prior that holds it near the start of a part.
constexpr double kPartStd = 0.3;
/// Integrated steps per drop after which a start is stopped: the drops of datasets/drops take 1.3e4 in all.
constexpr double kStepsOfStart = 2e5;

}  // namespace

std::vector<std::size_t> every_drop(const DropSimulator& s) {
  std::vector<std::size_t> out(s.drops());
  std::iota(out.begin(), out.end(), std::size_t(0));
  return out;
}

DropProblem::DropProblem(const DropSimulator& s, DropLayout l, const CalibrationOptions& o)
    : DropProblem(s, std::move(l), o, every_drop(s)) {}
DropProblem::DropProblem(const DropSimulator& s, DropLayout l, const CalibrationOptions& o,
                         std::vector<std::size_t> subset_)
    : simulator(s), layout(std::move(l)), options(o), subset(std::move(subset_)), horizons(s.horizons()) {
  for (const std::size_t m : subset) residuals.emplace_back(s, m, layout, o, steps);
}

DropProblem::Start DropProblem::given() const {
  Start out;
  for (const DropTerm* t : layout.shared) out.push_back(t->is_constant() ? simulator.value(*t) : t->absent);
  return out;
}

DropProblem::Problem DropProblem::problem(const Start& start, const std::vector<double>& sigma, double horizon) const {
  Problem p;
  for (std::size_t g = 0; g < layout.shared.size(); ++g)
    p.globals.push_back(layout.shared[g]->column(start[g], options.terms));
  for (const DropTerm* t : layout.own) p.locals.push_back(t->column(t->absent, options.terms));
  for (std::size_t m = 0; m < residuals.size(); ++m) {
    std::vector<Prior> priors;  // priors of the shared terms are in the first block only
    for (const Prior& prior : options.terms.priors)
      if (layout.holds(layout.own, prior.term) || (m == 0 && layout.holds(layout.shared, prior.term)))
        priors.push_back(prior);
    for (std::size_t k = 0; m == 0 && std::isfinite(horizon) && k < layout.shared.size(); ++k)
      priors.push_back({layout.shared[k]->name, p.globals[k].start, kPartStd * p.globals[k].scale});
    p.blocks.push_back(residuals[m].block(sigma, simulator.first_touchdown(subset[m]) + horizon, priors));
  }
  return p;
}

DropProblem::Problem DropProblem::problem_from(const Solution& s, const std::vector<double>& sigma) const {
  Problem p = problem({s.globals.data(), s.globals.data() + s.globals.size()}, sigma, kWhole);
  for (std::size_t m = 0; m < p.blocks.size(); ++m)
    for (long k = 0; k < s.locals.cols(); ++k) p.blocks[m].local_start.push_back(s.locals(long(m), k));
  return p;
}

double DropProblem::work_of_start() const {
  return kStepsOfStart * double(residuals.size()) * simulator.work_factor(layout.shared.size() + layout.own.size());
}

DropProblem::Solution DropProblem::solve(const Problem& p, int iterations, long max_steps, double tolerance) const {
  const auto stop = [&, max_steps] {
    options.monitor.progress(parts, long(horizons.size()) * (1 + options.restarts) + 1);
    return steps > max_steps || options.monitor.stopped();
  };
  return identify::solve(p, {.max_iterations = iterations, .cost_tolerance = tolerance, .stop = stop});
}

DropProblem::Solution DropProblem::solve_in_parts(Start start, const std::vector<double>& sigma) const {
  Solution done;
  const long first_step = steps, max_steps = first_step + long(work_of_start());
  for (const double horizon : horizons) {
    const bool whole = !std::isfinite(horizon);
    if (!whole && options.parts == CalibrationOptions::Parts::kWhole) continue;
    Solution s = solve(problem(start, sigma, horizon),
                       whole ? options.max_iterations : std::min(kPartIterations, options.max_iterations), max_steps);
    if (options.monitor.stopped() || (steps > max_steps && !(whole && s.usable))) {
      done.converged = false;
      if (steps > max_steps) work_exceeded = true, done.cost = std::numeric_limits<double>::infinity();
      break;
    }
    if (s.usable) start = constants_at(s, start);
    done = std::move(s);
    ++parts;
  }
  done.work = double(steps - first_step);
  return done;
}

DropProblem::Start DropProblem::constants_at(const Solution& s, Start from) const {
  for (std::size_t g = 0; g < layout.shared.size(); ++g)
    if (layout.shared[g]->is_constant()) from[g] = s.globals[long(g)];
  return from;
}

DropProblem::Start DropProblem::drawn(Random random) const {
  Start out = given();
  for (std::size_t g = 0; g < out.size(); ++g) {
    const DropTerm& t = *layout.shared[g];
    if (t.is_constant())
      out[g] = t.one_sided() ? out[g] * random.factor(t.spread) : out[g] + random.uniform(-t.spread, t.spread);
  }
  return out;
}

std::vector<DropResult> DropProblem::replay(const Solution& s) const {
  std::vector<DropResult> out;
  for (std::size_t m = 0; m < residuals.size(); ++m) {
    const Eigen::VectorXd own = s.locals.row(long(m));
    out.push_back(residuals[m].replay(s.globals.data(), own.data()));
  }
  return out;
}

}  // namespace ukemi::tools
