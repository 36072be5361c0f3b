// Searches from many starts on plain functions whose minima are known.
#include "identify/estimate/multi_start.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace ukemi::identify;

namespace {

/// min sum_k f_k(x)^2 from a start.
template <class F, class Slope>
LeastSquaresSolution least_squares(double start, double lower, double upper, F f, Slope slope) {
  LeastSquaresProblem p;
  p.globals = {{"x", "1", start, lower, upper, 1}};
  p.blocks = {{2, [=](const double* x, const double*, double* r, double* jacobian) {
                 for (int k : {0, 1}) {
                   r[k] = f(*x, k);
                   if (jacobian) jacobian[k] = slope(*x, k);
                 }
                 return true;
               }}};
  return solve(p, {});
}

/// (x^2 - 1)^2 + 0.01 (x - 2)^2: about 0.01 near 1, 0.09 near -1.
LeastSquaresSolution two_wells(double start, double lower = -10, double upper = 10) {
  return least_squares(
      start, lower, upper, [](double x, int k) { return k == 0 ? x * x - 1 : 0.1 * (x - 2); },
      [](double x, int k) { return k == 0 ? 2 * x : 0.1; });
}

}  // namespace

TEST_CASE("many starts: the best of two wells, each listed once with the starts that found it") {
  const std::vector<double> from = {-2, -1.5, 3, -0.8, 1.2};
  for (const int threads : {1, 3}) {
    MultiStart starts({.threads = threads});
    starts.search_all(5, [&](int i) { return two_wells(from[std::size_t(i)]); });
    CHECK(starts.starts() == 5);
    CHECK(starts.best().globals[0] == Approx(1.0025).epsilon(1e-4));
    CHECK((starts.best_start() == 2 || starts.best_start() == 4));
    const auto minima = starts.minima();
    REQUIRE(minima.size() == 2);
    CHECK(minima[0].found == 2);
    CHECK(minima[1].found == 3);
    CHECK(minima[0].solution.cost < minima[1].solution.cost);
    CHECK(minima[1].solution.globals[0] == Approx(-0.9924).epsilon(1e-3));
  }
}

TEST_CASE("many starts: within the bounds") {
  MultiStart starts({});
  const std::vector<double> from = {-3, -1.5, -0.2};
  starts.search_all(3, [&](int i) { return two_wells(from[std::size_t(i)], -10, -1.2); });
  CHECK(starts.best().globals[0] == -1.2);
  CHECK(starts.best().at_bound[0]);
}

TEST_CASE("many starts: no further one once a minimum is believed, was found often enough, or work is spent") {
  const std::vector<double> from = {-2, -1.5, -1.2, -0.9, 2, 3, 4, 5};
  const auto run = [&](MultiStartOptions o) {
    o.at_once = 1;
    MultiStart starts(o);
    starts.search_until_believed(8, [&](int i) {
      LeastSquaresSolution s = two_wells(from[std::size_t(i)]);
      s.work = 10;
      return s;
    });
    return starts.starts();
  };
  CHECK(run({.believed = [](const LeastSquaresSolution& s) { return s.cost < 0.05; }}) == 5);
  CHECK(run({.same = 3}) == 3);
  CHECK(run({.work = 35, .same = 9}) == 4);
  CHECK(run({.same = 9}) == 8);
}

TEST_CASE("many starts: the monitor is told of each and ends them, what was found is kept") {
  long told = 0;
  bool stop = false;
  MultiStart starts({.same = 9,
                     .at_once = 2,
                     .most = 8,
                     .threads = 1,
                     .monitor = {[&](long done, long total) {
                                   CHECK(total == 8);
                                   CHECK(done == ++told);
                                   stop = done == 4;
                                 },
                                 [&] { return stop; }}});
  starts.search_until_believed(8, [&](int i) { return two_wells(i + 1.0); });
  CHECK(told == 4);
  CHECK(starts.starts() == 4);
  CHECK(starts.best().usable);
}

TEST_CASE("many starts: one that cannot be evaluated is passed over, where none can, its message stands") {
  const auto nowhere = [] {
    LeastSquaresSolution s;
    s.message = "no way";
    return s;
  };
  MultiStart starts({});
  starts.search_all(1, [&](int) { return nowhere(); });
  CHECK_FALSE(starts.best().usable);
  CHECK(starts.best().message == "no way");
  starts.search_all(2, [&](int i) { return i == 0 ? nowhere() : two_wells(2); });
  CHECK(starts.best_start() == 2);
  CHECK(starts.minima().size() == 1);
  starts.forget();
  CHECK(starts.minima().empty());
  CHECK(starts.starts() == 3);
}

TEST_CASE("least squares: no residual sees a value beyond its bounds, whatever the scale rounds to") {
  for (const double scale : {1.3, 0.7, 3.0, 1e-3, 41.0}) {
    double least = 2;
    LeastSquaresProblem p;
    p.globals = {{"x", "1", 1.0, 1.0, 4.0, scale}};
    p.blocks = {{1, [&](const double* x, const double*, double* r, double* jacobian) {
                   least = std::min(least, *x);
                   r[0] = *x;  // pulls it against the lower bound
                   if (jacobian) jacobian[0] = 1;
                   return true;
                 }}};
    CHECK(solve(p, {}).globals[0] == 1.0);
    CHECK(least == 1.0);
  }
}
