// The landing motion (landing/model/motion.hpp) and the box of motions of the tolerant peak
// (landing/search/tolerant_peak.hpp).
#include "landing/model/motion.hpp"
#include "common/jet.hpp"

#include <catch2/catch.hpp>
#include <set>
#include <tuple>

#include "landing/model/motion_space.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {
const Motion kMotion{-0.3, -1.1, 0.4};
Reference<double> at(double t) { return quintic(kMotion.phi_i, kMotion.phi_f, kMotion.duration, t); }
}  // namespace

TEST_CASE("motion: the quintic starts and ends at rest") {
  CHECK(at(0).phi == -0.3);
  CHECK(at(0.4).phi == Approx(-1.1).epsilon(1e-15));
  CHECK(at(0).dphi == 0);
  CHECK(at(0.4).dphi == 0);
  // No acceleration at either end: the rate begins with the square of the time, 30 range t^2 / duration^3.
  for (double t : {1e-3, 1e-4}) {
    CHECK(at(t).dphi == Approx(30 * -0.8 * t * t / (0.4 * 0.4 * 0.4)).epsilon(2.1 * t / 0.4));
    CHECK(at(0.4 - t).dphi == Approx(at(t).dphi).epsilon(1e-9));
  }
}

TEST_CASE("motion: the quintic is odd about its middle and its rate is its derivative") {
  CHECK(at(0.2).phi == Approx(-0.7));
  constexpr double kH = 1e-5;
  for (double t = 0.01; t < 0.4; t += 0.01) {
    CHECK(at(t).phi + at(0.4 - t).phi == Approx(-1.4));
    CHECK(at(t).dphi == Approx((at(t + kH).phi - at(t - kH).phi) / (2 * kH)).epsilon(1e-6).margin(1e-9));
    CHECK(at(t).dphi < 0);  // monotone
  }
}

TEST_CASE("motion: the largest rate is the middle's") {
  CHECK(peak_reference_rate(kMotion) == Approx(1.875 * 0.8 / 0.4));
  CHECK(peak_reference_rate(kMotion) == Approx(std::abs(at(0.2).dphi)));
  for (double t = 0; t <= 0.4; t += 0.001) CHECK(std::abs(at(t).dphi) <= peak_reference_rate(kMotion) * (1 + 1e-15));
  CHECK(peak_reference_rate({-1.1, -0.3, 0.4}) == peak_reference_rate(kMotion));
  CHECK(peak_reference_rate({-0.5, -0.5, 0.1}) == 0);
}

TEST_CASE("motion: Jet derivatives of the quintic are its central differences") {
  using Jet = ceres::Jet<double, 4>;
  const std::array<double, 4> x{-0.3, -1.1, 0.4, 0.13};
  const Reference<Jet> jet = quintic(Jet(x[0], 0), Jet(x[1], 1), Jet(x[2], 2), Jet(x[3], 3));
  for (std::size_t k = 0; k < 4; ++k) {
    constexpr double kH = 1e-5;
    std::array<double, 4> u = x, d = x;
    u[k] += kH, d[k] -= kH;
    const Reference<double> up = quintic(u[0], u[1], u[2], u[3]), down = quintic(d[0], d[1], d[2], d[3]);
    CHECK(jet.phi.v[Eigen::Index(k)] == Approx((up.phi - down.phi) / (2 * kH)).epsilon(1e-7));
    CHECK(jet.dphi.v[Eigen::Index(k)] == Approx((up.dphi - down.dphi) / (2 * kH)).epsilon(1e-7));
  }
}

TEST_CASE("motion: the execution box is the motion, six face centres and eight corners") {
  const ExecutionTolerance tolerance{.phi = 0.01, .duration = 0.002};
  std::vector<Motion> box;
  for (int k = 0; k < kExecutionPoints; ++k) box.push_back(deviated(kMotion, tolerance, execution_deviation(k)));
  REQUIRE(box.size() == 15);
  CHECK((box[0].phi_i == kMotion.phi_i && box[0].phi_f == kMotion.phi_f && box[0].duration == kMotion.duration));
  std::set<std::tuple<long, long, long>> seen;
  std::array<int, 4> moved{};  // how many points have 0, 1, 2, 3 coordinates moved
  for (const Motion& m : box) {
    const double i = (m.phi_i - kMotion.phi_i) / 0.01, j = (m.phi_f - kMotion.phi_f) / 0.01,
                 k = (m.duration - kMotion.duration) / 0.002;
    for (double c : {i, j, k}) CHECK(std::abs(c - std::round(c)) < 1e-9);
    seen.insert({std::lround(i), std::lround(j), std::lround(k)});
    ++moved[std::size_t(std::lround(std::abs(i) + std::abs(j) + std::abs(k)))];
  }
  CHECK(seen.size() == 15);
  CHECK(moved == std::array{1, 6, 0, 8});
  // A box wider than the motion is long keeps a positive duration.
  for (int k = 0; k < kExecutionPoints; ++k)
    CHECK(deviated({0, 0, 0.001}, tolerance, execution_deviation(k)).duration > 0);
}

TEST_CASE("motion: shape terms start and end at rest, 64 makes b_0 a height, and the rate is the derivative") {
  Motion m{-0.3, -0.3, 0.4};
  m.bumps[0] = 0.7;
  CHECK(reference_of(m, 0.2).phi == Approx(-0.3 + 0.7));
  m = {-0.3, -1.1, 0.4, {0.5, -1.2, 0.8, -0.4}};
  constexpr double kH = 1e-6;
  for (const double end : {0.0, 0.4}) CHECK(reference_of(m, end).dphi == 0);
  // It stands before its start and behind its end: 0.5 s after the start of 0.175 s it was -376 rad.
  const Motion quick{-0.3, -1.1, 0.175};
  for (const Motion& x : {m, quick}) {
    for (const double before : {0.0, -1e-9, -10.0}) CHECK(reference_of(x, before).phi == x.phi_i);
    for (const double behind : {x.duration, 0.5, 1e9}) CHECK(reference_of(x, behind).phi == x.phi_f);
    for (const double outside : {-1e-9, 0.5}) CHECK(reference_of(x, outside).dphi == 0);
  }
  for (const double t : {1e-3, 1e-4})  // no acceleration either
    CHECK(std::abs(reference_of(m, t).dphi) < 20'000 * t * t);
  double fastest = 0;
  for (double t = 0.002; t < 0.4; t += 0.002) {
    CHECK(reference_of(m, t).dphi ==
          Approx((reference_of(m, t + kH).phi - reference_of(m, t - kH).phi) / (2 * kH)).epsilon(1e-6).margin(1e-7));
    fastest = std::max(fastest, std::abs(reference_of(m, t).dphi));
  }
  CHECK(peak_reference_rate(m) >= fastest);
  CHECK(peak_reference_rate(m) == Approx(fastest).epsilon(1e-3));
  // Legendre's polynomials are orthogonal: b_1 alone is odd about the middle.
  m.bumps = {0, 0.6, 0, 0};
  m.phi_f = m.phi_i;
  for (double t = 0; t < 0.2; t += 0.01) CHECK(reference_of(m, t).phi + reference_of(m, 0.4 - t).phi == Approx(-0.6));
}

TEST_CASE("motion: the space has what the scene lets a motion have, and finds its own values again") {
  Scene scene;
  scene.robot.gravity = 9.81;
  scene.contacts = {true, true, true}, scene.floor = Floor<double>{1e4, 10, 1}, scene.drop.height = 0.4;
  CHECK(ReferenceSpace(scene, {}).dimension() == 3);
  scene.freedom = {.bumps = 3, .gains = std::array{0.25, 4.0}};
  scene.release = Release{-0.8, 0.5, 0.1};
  const ReferenceSpace space(scene, {.k_p = 50});
  REQUIRE(space.dimension() == 9);
  CHECK(space.variables()[8].lower > 0.1);
  const Coordinates x = space.values(Coordinates::Constant(9, 0.3));
  const Motion m = space.play(x).motion;
  CHECK(m.bumps[2] == x[5]);
  CHECK(m.bumps[3] == 0);
  CHECK(m.gain_d == x[7]);
  REQUIRE(m.reposition);
  CHECK(m.reposition->to == x[8]);
  CHECK(m.reposition->phi == -0.8);
  CHECK(space.values_of(m) == x);
  const Eigen::MatrixXd j = space.jacobian(x), by_differences = space.MotionSpace::jacobian(x);
  CHECK((j - by_differences).cwiseAbs().maxCoeff() < 1e-9);
}
