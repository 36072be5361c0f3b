#include "landing/search/solvers.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "common/random.hpp"
#include "landing/search/nlopt_solver.hpp"
#include "landing/search/population.hpp"

namespace ukemi::landing {

const std::vector<std::string>& solver_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> n = {"auto", "sqp", "pattern", "ga", "de", "cma"};
    n.insert(n.end(), nlopt_names().begin(), nlopt_names().end());
    n.push_back("random");
    return n;
  }();
  return names;
}

void check_solver(const std::string& name) {
  const auto& names = solver_names();
  if (std::find(names.begin(), names.end(), name) == names.end()) throw InputError("solver: " + one_of(name, names));
}

void run_solver(const std::string& name, Search& search) {
  check_solver(name);
  if (name == "auto") return auto_search(search);
  if (name == "sqp") return sequential_quadratic(search);
  if (name == "pattern") return pattern_search(search);
  if (name == "ga") return genetic_algorithm(search);
  if (name == "de") return differential_evolution(search);
  if (name == "cma") return covariance_adaptation(search);
  if (name == "random") return random_search(search);
  nlopt_search(name, search);
}

void nlopt_search(const std::string& name, Search& search) {
  for (std::uint64_t restart = 0; !search.over(); ++restart) {
    Random random(search.seed, restart);
    const Candidate start = restart == 0 ? search.centre() : random_point(random, search.dimension());
    const auto n = std::size_t(search.dimension());
    NloptProblem problem{[&](const double* u) {
                           Candidate p = search.centre();
                           std::copy_n(u, n, p.u.begin());
                           search.evaluate({&p, 1});
                           return p.value;
                         },
                         std::vector<double>(n, 0),
                         std::vector<double>(n, 1),
                         {start.u.begin(), start.u.end()},
                         std::vector<double>(n, 0.1)};
    const long left = std::min<long>(search.budget().motions - search.spent(), 1'000'000'000);
    const long before = search.motions();
    minimize(name, problem, {.evaluations = left, .x_tolerance = 1e-6, .over = [&] { return search.over(); }},
             search.seed + restart);
    if (search.motions() == before) return random_search(search);  // NLopt refuses this box
  }
}

}  // namespace ukemi::landing
