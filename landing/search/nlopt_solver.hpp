// The one place that knows NLopt: minimisation of a function in a box without derivatives.
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
  std::function<bool()> over;  ///< asked after every evaluation; absent: never
};
struct NloptResult {
  std::vector<double> x;  ///< the best point seen, on whatever stop
  double value;
  long evaluations = 0;
  int code = 0;         ///< NLopt's raw result
  std::string message;  ///< its name
};

/// The epigraph form of a minimax: min s subject to a_k(x) <= s, k < count, x in a box; NLopt's SLSQP.
struct EpigraphProblem {
  int count;
  /// a_k and their gradients by x, row by row; false ends the run.
  std::function<bool(const double* x, double* a, double* gradient)> peaks;
  std::vector<double> lower, upper, start;
  double start_value;  ///< of s
};
/// Runs until a stop; what was best is the caller's to keep, as `peaks` sees every x. Returns NLopt's raw result.
int minimize_epigraph(const EpigraphProblem& problem, double x_tolerance);

/// Minimises; deterministic for a seed. The best point seen is kept by us, also where NLopt stops on roundoff.
NloptResult minimize(const std::string& algorithm, const NloptProblem& problem, const NloptStop& stop,
                     std::uint64_t seed);

}  // namespace ukemi::landing
