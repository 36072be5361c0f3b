// The least-squares solver where its derivatives are not those of the cost.
#include "identify/estimate/least_squares.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace ukemi::identify;
using Catch::Matchers::Contains;

TEST_CASE("least squares: what crawls along an edge of the cost has converged, and says so") {
  // As on an edge: every step seems to gain twice what it does, and the next one gains as much.
  constexpr double kTolerance = 1e-6;
  LeastSquaresProblem p;
  Parameter x;
  x.name = "x", x.start = 0, x.scale = 1, x.lower = -1e5, x.upper = 1e5;
  p.globals.push_back(x);
  p.blocks.push_back({2, [](const double* at, const double*, double* r, double* jacobian) {
                        r[0] = std::sqrt(1 + 2 * kTolerance * at[0]), r[1] = std::sqrt(4 * kTolerance);
                        if (jacobian) jacobian[0] = 0, jacobian[1] = r[1];
                        return true;
                      }});
  const LeastSquaresSolution s = solve(p, {.max_iterations = 1000, .cost_tolerance = kTolerance});
  CHECK(s.converged);
  CHECK_THAT(s.message, Contains("edge"));
  CHECK(s.iterations == 10);
  const LeastSquaresSolution finer = solve(p, {.max_iterations = 100, .cost_tolerance = 0.1 * kTolerance});
  CHECK_FALSE(finer.converged);
  CHECK(finer.iterations == 100);
}
