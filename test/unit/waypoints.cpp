// A motion as the waypoints of a quintic spline (landing/model/waypoints.hpp). The spline here is another than the
// library's: it solves for its coefficients.
#include "landing/model/waypoints.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

using namespace ukemi;
using namespace ukemi::landing;

namespace {

/// The quintic through both points by its six conditions, in powers of the time since the first.
double interpolated(const Waypoint& a, const Waypoint& b, double t) {
  const double h = b.t - a.t, u = t - a.t;
  Eigen::Matrix<double, 6, 6> conditions = Eigen::Matrix<double, 6, 6>::Zero();
  conditions(0, 0) = conditions(1, 1) = 1, conditions(2, 2) = 2;
  for (int k = 0; k < 6; ++k) {
    conditions(3, k) = std::pow(h, k);
    if (k > 0) conditions(4, k) = k * std::pow(h, k - 1);
    if (k > 1) conditions(5, k) = k * (k - 1) * std::pow(h, k - 2);
  }
  Eigen::Matrix<double, 6, 1> values;
  values << a.phi, a.dphi, a.ddphi, b.phi, b.dphi, b.ddphi;
  const Eigen::Matrix<double, 6, 1> c = conditions.fullPivLu().solve(values);
  double out = 0;
  for (int k = 5; k >= 0; --k) out = out * u + c[k];
  return out;
}

/// How far the spline of the points is from the motion at most.
double misfit(const Motion& m, const std::vector<Waypoint>& points) {
  double worst = 0;
  for (std::size_t k = 1; k < points.size(); ++k)
    for (int i = 0; i <= 997; ++i) {
      const double t = points[k - 1].t + (points[k].t - points[k - 1].t) * i / 997;
      worst = std::max(
          worst, std::abs(interpolated(points[k - 1], points[k], t) - reference_of(m, std::min(t, m.duration)).phi));
    }
  return worst;
}

std::vector<Waypoint> of(const Motion& m) { return waypoints(landing_of(m, m.phi_i, 0.0)); }

}  // namespace

TEST_CASE("waypoints: two are the quintic itself") {
  const Motion m{-0.47, -1.44, 0.169};
  const std::vector<Waypoint> points = of(m);
  REQUIRE(points.size() == 2);
  CHECK(points[1].t == Approx(0.169).epsilon(1e-15));
  CHECK(misfit(m, points) < 1e-12);
  const Motion odd{-0.47, -1.44, 0.1693456784};  // 0.4 ns beside a whole nanosecond
  CHECK(misfit(odd, of(odd)) < 1e-8);
}

TEST_CASE("waypoints: with shape terms there are as few as keep a ten-thousandth of a radian") {
  for (const BumpsOf<double>& bumps :
       {BumpsOf<double>{0.05, 0, 0, 0}, {0.3, -0.2, 0, 0}, {0.2, 0.1, -0.3, 0}, {-0.5, 0.4, 0.3, -0.6}}) {
    const Motion m{-0.47, -1.44, 0.1693456789, bumps};
    const std::vector<Waypoint> points = of(m);
    INFO(points.size());
    CHECK(misfit(m, points) < 1.001 * kSplineMisfit);
    REQUIRE(points.size() > 2);
    CHECK(points.size() < 15);
    CHECK(points.front().phi == m.phi_i);
    CHECK(points.back().phi == m.phi_f);
    // One step fewer does not keep it.
    std::vector<Waypoint> fewer = {points.front()};
    const int steps = int(points.size()) - 2;
    for (int k = 1; k <= steps; ++k) {
      const double t = m.duration * k / steps, h = 1e-6;
      const Reference<double> r = reference_of(m, t), before = reference_of(m, t - h),
                              after = k < steps ? reference_of(m, t + h) : r;
      fewer.push_back({t, r.phi, r.dphi, k < steps ? (after.dphi - before.dphi) / (2 * h) : 0});
    }
    CHECK(misfit(m, fewer) > kSplineMisfit);
  }
}

TEST_CASE("waypoints: a reference that stands is two equal points") {
  const std::vector<Waypoint> points = of({-0.5, -0.5, 1});
  REQUIRE(points.size() == 2);
  CHECK(points[0].phi == points[1].phi);
  CHECK(points[1].dphi == 0);
}
