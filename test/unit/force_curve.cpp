// The force between its samples.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "identify/logs/force_curve.hpp"

using namespace ukemi::identify;
using Catch::Matchers::WithinAbs;

namespace {

constexpr double kNewton = 100, kMillisecond = 1e-3;

/// A half-sine hit at 1 kHz that begins between two samples.
struct HalfSine {
  double onset, seconds;
  double operator()(double t) const {
    const double s = (t - onset) / seconds;
    return s > 0 && s < 1 ? kNewton * std::sin(std::numbers::pi * s) : 0;
  }
  double impulse() const { return 2 * kNewton * seconds / std::numbers::pi; }
};

template <class Force>
Trial sampled(const Force& force, double smooth, double rest = 0) {
  Trial out;
  for (int i = 0; i <= 60; ++i) out.t.push_back(i * kMillisecond), out.force.push_back(rest + force(out.t.back()));
  out.force_smooth = smooth, out.force_rest = rest;
  return out;
}

double at(const ForceCurve& curve, double t) {
  std::size_t k = 0;
  while (k + 1 < curve.pieces() && curve.begin(k + 1) <= t) ++k;
  return moved(curve.piece(k), t - curve.begin(k))[0];
}
double impulse(const ForceCurve& curve) {
  double out = 0;
  for (std::size_t k = 0; k < curve.pieces(); ++k) {
    const double h = curve.begin(k + 1) - curve.begin(k);
    const Cubic c = curve.piece(k);
    out += h * (c[0] + h * (c[1] / 2 + h * (c[2] / 3 + h * c[3] / 4)));
  }
  return out;
}

}  // namespace

TEST_CASE("force curve: linear through the samples unless it is asked to be smooth") {
  const Trial log = sampled(HalfSine{0.0103, 0.010}, 0);
  const ForceCurve curve(log);
  REQUIRE(curve.pieces() == log.t.size() - 1);
  for (std::size_t i = 0; i + 1 < log.t.size(); ++i) {
    CHECK(curve.begin(i) == log.t[i]);
    CHECK_THAT(at(curve, log.t[i] + 0.25 * kMillisecond),
               WithinAbs(0.75 * log.force[i] + 0.25 * log.force[i + 1], 1e-9));
  }
  CHECK(ForceCurve(Trial{}).pieces() == 0);
}

TEST_CASE("force curve: a smooth pulse keeps its impulse, wherever it begins between two samples") {
  for (const double seconds : {0.008, 0.013, 0.020}) {
    double worst_smooth = 0, worst_linear = 0;
    for (double onset = 0.0100; onset < 0.011; onset += 0.00007) {
      const HalfSine hit{onset, seconds};
      const Trial smooth = sampled(hit, 1), linear = sampled(hit, 0);
      worst_smooth = std::max(worst_smooth, std::abs(impulse(ForceCurve(smooth)) / hit.impulse() - 1));
      worst_linear = std::max(worst_linear, std::abs(impulse(ForceCurve(linear)) / hit.impulse() - 1));
      for (std::size_t i = 0; i < smooth.t.size(); ++i)
        CHECK_THAT(at(ForceCurve(smooth), smooth.t[i]), WithinAbs(smooth.force[i], 1e-9));
    }
    INFO(seconds << " s, relative error of the impulse: smooth " << worst_smooth << ", linear " << worst_linear);
    CHECK(worst_smooth < (seconds < 0.01 ? 2e-3 : 1e-4));
    CHECK(worst_linear > 8 * worst_smooth);
  }
}

TEST_CASE("force curve: pieces join, at rest and with an offset") {
  for (const double rest : {0.0, -3.0}) {
    const Trial log = sampled(HalfSine{0.0106, 0.009}, 1, rest);
    const ForceCurve curve(log);
    for (std::size_t k = 0; k + 1 < curve.pieces(); ++k) {
      const double h = curve.begin(k + 1) - curve.begin(k);
      REQUIRE(h > 0);
      CHECK_THAT(moved(curve.piece(k), h)[0], WithinAbs(curve.piece(k + 1)[0], 1e-9));
    }
    CHECK(curve.piece(0) == Cubic{rest, 0, 0, 0});
    CHECK_THAT(curve.begin(1), WithinAbs(0.0106, 2e-5));  // the onset
  }
}

TEST_CASE("force curve: a pulse that leaves rest smoothly, one that is too short, one that a log cuts") {
  const auto hann = [](double t) {
    const double s = (t - 0.0104) / 0.012;
    return s > 0 && s < 1 ? kNewton * std::pow(std::sin(std::numbers::pi * s), 2) : 0;
  };
  const Trial log = sampled(hann, 1);
  double worst = 0;
  for (double t = 0.005; t < 0.03; t += 0.00003) worst = std::max(worst, std::abs(at(ForceCurve(log), t) - hann(t)));
  CHECK(worst < 0.01 * kNewton);

  Trial brief = sampled([](double t) { return t > 0.0095 && t < 0.0125 ? kNewton : 0.0; }, 1);  // three samples
  CHECK_THAT(at(ForceCurve(brief), 0.0095), WithinAbs(kNewton / 2, 1e-9));
  const Trial cut = sampled([](double t) { return kNewton * (t + 0.01); }, 1);
  CHECK_THAT(at(ForceCurve(cut), 0.0334), WithinAbs(kNewton * 0.0434, 1e-9));
}

TEST_CASE("force curve: between linear and smooth it is the blend") {
  const HalfSine hit{0.0103, 0.009};
  const Trial half = sampled(hit, 0.5), linear = sampled(hit, 0), smooth = sampled(hit, 1);
  for (double t = 0.0001; t < 0.03; t += 0.00017)
    CHECK_THAT(at(ForceCurve(half), t), WithinAbs(0.5 * (at(ForceCurve(linear), t) + at(ForceCurve(smooth), t)), 1e-9));
}
