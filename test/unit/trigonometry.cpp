// Sine and cosine against the standard library, over every quadrant, near their zeros, and beyond the reduction.
#include "common/trigonometry.hpp"
#include "common/jet.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <numbers>

#include "common/random.hpp"

using namespace ukemi;

namespace {

/// Within 1.2e-16 + 1 ulp of the library's.
void check(double x, double y) {
  CAPTURE(x, y);
  const auto near = [](double value, double exact) {
    CHECK(std::abs(value - exact) <= 1.2e-16 + std::abs(exact) * std::numeric_limits<double>::epsilon());
  };
  const auto [a, b] = sin_cos(x, y);
  near(a.sin, std::sin(x)), near(a.cos, std::cos(x)), near(b.sin, std::sin(y)), near(b.cos, std::cos(y));
}

}  // namespace

TEST_CASE("trigonometry: both lanes meet the library's sine and cosine") {
  Random random(1, 0);
  for (int i = 0; i < 20000; ++i) check(random.uniform(-7, 7), random.uniform(-5e5, 5e5));
  for (int quarter = -20; quarter <= 20; ++quarter)
    for (const double off : {0.0, 1e-300, 1e-9, -1e-9, 0.785398163397448, 0.785398163397449})
      check(quarter * std::numbers::pi / 2 + off, -quarter * std::numbers::pi / 2 - off);
}

TEST_CASE("trigonometry: angles beyond the reduction, and what is no angle") {
  check(1e6, 0.3);
  check(-1e15, 1e300);
  const double infinite = std::numeric_limits<double>::infinity();
  const auto [a, b] = sin_cos(infinite, 0.5);
  CHECK(std::isnan(a.sin));
  CHECK(std::isnan(a.cos));
  CHECK(b.sin == std::sin(0.5));
}

TEST_CASE("trigonometry: a Jet carries the derivatives") {
  using Dual = ceres::Jet<double, 2>;
  const auto [a, b] = sin_cos(Dual(0.4, 0), Dual(-2.1, 1));
  CHECK(a.sin.v[0] == Approx(std::cos(0.4)).epsilon(1e-15));
  CHECK(a.cos.v[0] == Approx(-std::sin(0.4)).epsilon(1e-15));
  CHECK(b.sin.v[1] == Approx(std::cos(-2.1)).epsilon(1e-15));
  CHECK(b.cos.v[0] == 0);
}
