// What a term that ended at a bound may still be off by counts in the errors of the others.
#include <catch2/catch.hpp>
#include <cmath>

#include "common/eigen.hpp"
#include "identify/estimate/estimates.hpp"
#include "identify/estimate/statistics.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using Catch::Detail::Approx;

namespace {

/// y = a t + c (t + 1/2), c >= 0, on t = 0 .. 1, with residuals of root mean square 0.1 that neither a nor c can take
/// away; the least squares have a = 1, c = `mode`.
LeastSquaresProblem line(double mode, double upper = INFINITY) {
  constexpr int kRows = 40;
  LeastSquaresProblem out;
  out.globals = {{"a", "", 0.5, -INFINITY, INFINITY, 1}, {"c", "", 0.5, 0, upper, 1}};
  out.blocks.push_back({.size = kRows, .evaluate = [mode](const double* g, const double*, double* r, double* jacobian) {
                          for (int i = 0; i < kRows; ++i) {
                            const double t = (i / 4 + 0.5) / (kRows / 4), by_a = t, by_c = t + 0.5;
                            const double scatter = 0.1 * (i % 4 == 0 || i % 4 == 3 ? 1 : -1);
                            r[i] = (g[0] - 1) * by_a + (g[1] - mode) * by_c + scatter;
                            if (jacobian) jacobian[i] = by_a, jacobian[kRows + i] = by_c;
                          }
                          return true;
                        }});
  return out;
}

Estimates estimates(const LeastSquaresProblem& problem) {
  Term a{.name = "a"}, c{.name = "c"};
  a.role = c.role = Term::Role::kConstant;
  Estimates out;
  for (const char* name : {"a", "c"}) out.parameters.push_back({.name = name, .value = 0, .std = {}});
  set_estimates(solve(problem, {}), problem, {&a, &c}, {.data = "rows"}, out);
  return out;
}

}  // namespace

TEST_CASE("the spread from a bound is the root mean square of a normal distribution that is cut off there") {
  for (const double beyond : {0.0, 0.3, 1.0, 3.0, 10.0, 29.0}) {
    double sum = 0, square = 0;
    const double step = 1e-4 / (1 + beyond);
    for (double x = step / 2; x < 40 / (1 + beyond); x += step) {
      const double density = std::exp(-x * (x / 2 + beyond));
      sum += density, square += x * x * density;
    }
    CHECK(spread_from_bound(beyond) == Approx(std::sqrt(square / sum)).epsilon(1e-4));
  }
  CHECK(spread_from_bound(30.001) == Approx(spread_from_bound(29.999)).epsilon(5e-3));
}

TEST_CASE("a term that ended at its bound counts in the errors of the others, as far as it may be off") {
  const Estimates within = estimates(line(0.5));
  REQUIRE(within.considered.empty());
  REQUIRE((within.parameters[0].std && within.parameters[1].std));
  // With its minimum at the bound it may be off by its whole error, which is then that of a as if it were free.
  const double whole = *within.parameters[0].std, free = *within.parameters[1].std;
  const Estimates at = estimates(line(-0.01 * free));
  REQUIRE(at.parameters[1].at_bound);
  CHECK_FALSE(at.parameters[1].std);
  REQUIRE(at.considered.size() == 1);
  CHECK(at.considered[0].std == Approx(free).epsilon(0.03));
  CHECK(*at.parameters[0].std == Approx(whole).epsilon(0.03));
  CHECK(*at.parameters[0].std_noise < 0.5 * whole);
  // With its minimum well beyond, by less.
  double last = whole / *at.parameters[0].std_noise;
  for (const double beyond : {1.0, 3.0, 10.0}) {
    const Estimates far = estimates(line(-beyond * free));
    INFO(beyond << ": " << *far.parameters[0].std << ", " << *far.parameters[0].std_noise);
    const double widened = *far.parameters[0].std / *far.parameters[0].std_noise;
    CHECK(widened < last);
    CHECK(widened > 1);
    last = widened;
  }
  // Bounds that are near leave it no way to be off.
  const Estimates narrow = estimates(line(-free, 0.01 * free));
  CHECK(narrow.considered[0].std == Approx(0.01 * free / std::sqrt(3.0)));
}
