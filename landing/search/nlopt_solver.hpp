// The only user of NLopt: minimisation in a box without derivatives, and SLSQP on the epigraph of a minimax.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace ukemi::landing {

/// NLopt's algorithms by the names of the command line: crs2, direct_l, isres, esch, mlsl, sbplx, nelder_mead, cobyla,
/// bobyqa.
const std::vector<std::string>& nlopt_names();
bool is_global(const std::string& name);

struct NloptProblem {
  std::function<double(const double* x)> f;       ///< may throw; the exception is rethrown by minimize
  std::vector<double> lower, upper, start, step;  ///< step: initial step of local methods
};
struct NloptStop {
  long evaluations = 1000;
  double x_tolerance = 0;      ///< relative, of local methods
  std::function<bool()> over;  ///< called after every evaluation, true stops; absent: never
};
struct NloptResult {
  std::vector<double> x;  ///< the best point seen, whatever ended the run
  double value;
  long evaluations = 0;
  int code = 0;         ///< nlopt_result
  std::string message;  ///< its name
};

/// The epigraph form of a minimax: min s subject to a_k(x) <= s, k < count, x in a box; NLopt's SLSQP.
struct EpigraphProblem {
  int count;
  /// a_k and their gradients with respect to x, a row each; false stops the run.
  std::function<bool(const double* x, double* a, double* gradient)> peaks;
  std::vector<double> lower, upper, start;
  double start_value;  ///< of s
};
/// Runs until x_tolerance (relative) or a stop; the caller records the best in `peaks`. Returns the nlopt_result.
int minimize_epigraph(const EpigraphProblem& problem, double x_tolerance);

/// Deterministic for a seed. Keeps the best point seen itself, as NLopt may stop on roundoff.
NloptResult minimize(const std::string& algorithm, const NloptProblem& problem, const NloptStop& stop,
                     std::uint64_t seed);

}  // namespace ukemi::landing
