// The force between its samples.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "common/force_curve.hpp"

using namespace ukemi;
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

/// Its log.
struct Log {
  std::vector<double> t = {}, force = {};
  double rest = 0;
  std::optional<double> smooth = {};
  ForceCurve curve() const { return ForceCurve({t, force, rest, smooth}); }
};
template <class Force>
Log sampled(const Force& force, std::optional<double> smooth, double rest = 0) {
  Log out{.rest = rest, .smooth = smooth};
  for (int i = 0; i <= 60; ++i) out.t.push_back(i * kMillisecond), out.force.push_back(rest + force(out.t.back()));
  return out;
}

double at(const ForceCurve& curve, double t) { return curve.from(t)[0]; }
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
  const Log log = sampled(HalfSine{0.0103, 0.010}, std::nullopt);
  const ForceCurve curve = log.curve();
  REQUIRE(curve.pieces() == log.t.size() - 1);
  for (std::size_t i = 0; i + 1 < log.t.size(); ++i) {
    CHECK(curve.begin(i) == log.t[i]);
    CHECK_THAT(at(curve, log.t[i] + 0.25 * kMillisecond),
               WithinAbs(0.75 * log.force[i] + 0.25 * log.force[i + 1], 1e-9));
  }
  CHECK(Log{}.curve().pieces() == 0);
}

TEST_CASE("force curve: a smooth pulse keeps its impulse, wherever it begins between two samples") {
  for (const double seconds : {0.008, 0.013, 0.020}) {
    double worst_smooth = 0, worst_linear = 0;
    for (double onset = 0.0100; onset < 0.011; onset += 0.00007) {
      const HalfSine hit{onset, seconds};
      const Log smooth = sampled(hit, 1), linear = sampled(hit, 0);
      worst_smooth = std::max(worst_smooth, std::abs(impulse(smooth.curve()) / hit.impulse() - 1));
      worst_linear = std::max(worst_linear, std::abs(impulse(linear.curve()) / hit.impulse() - 1));
      for (std::size_t i = 0; i < smooth.t.size(); ++i)
        CHECK_THAT(at(smooth.curve(), smooth.t[i]), WithinAbs(smooth.force[i], 1e-9));
    }
    INFO(seconds << " s, relative error of the impulse: smooth " << worst_smooth << ", linear " << worst_linear);
    CHECK(worst_smooth < (seconds < 0.01 ? 2e-3 : 1e-4));
    CHECK(worst_linear > 8 * worst_smooth);
  }
}

TEST_CASE("force curve: pieces join, at rest and with an offset") {
  for (const double rest : {0.0, -3.0}) {
    const Log log = sampled(HalfSine{0.0106, 0.009}, 1, rest);
    const ForceCurve curve = log.curve();
    for (std::size_t k = 0; k + 1 < curve.pieces(); ++k) {
      const double h = curve.begin(k + 1) - curve.begin(k);
      REQUIRE(h > 0);
      CHECK_THAT(shifted(curve.piece(k), h)[0], WithinAbs(curve.piece(k + 1)[0], 1e-9));
    }
    for (std::size_t k : {0, 1}) CHECK(curve.piece(k) == Cubic{rest, 0, 0, 0});
    CHECK(curve.begin(1) == log.t[10]);
    CHECK_THAT(curve.begin(2), WithinAbs(0.0106, 2e-5));  // the onset
    const Log linear = sampled(HalfSine{0.0106, 0.009}, 0, rest);
    REQUIRE(linear.curve().pieces() == curve.pieces());
    for (std::size_t k = 0; k <= curve.pieces(); ++k) CHECK(linear.curve().begin(k) == curve.begin(k));
    for (const double t : {-1.0, 0.0}) CHECK(curve.from(t) == Cubic{rest, 0, 0, 0});
    for (const double t : {log.t.back(), 1.0}) CHECK(curve.from(t) == Cubic{log.force.back(), 0, 0, 0});
  }
}

TEST_CASE("force curve: a pulse that leaves rest smoothly, one that is too short, one that a log cuts") {
  const auto hann = [](double t) {
    const double s = (t - 0.0104) / 0.012;
    return s > 0 && s < 1 ? kNewton * std::pow(std::sin(std::numbers::pi * s), 2) : 0;
  };
  const Log log = sampled(hann, 1);
  double worst = 0;
  for (double t = 0.005; t < 0.03; t += 0.00003) worst = std::max(worst, std::abs(at(log.curve(), t) - hann(t)));
  CHECK(worst < 0.01 * kNewton);

  Log brief = sampled([](double t) { return t > 0.0095 && t < 0.0125 ? kNewton : 0.0; }, 1);  // three samples
  CHECK_THAT(at(brief.curve(), 0.0095), WithinAbs(kNewton / 2, 1e-9));
  const Log cut = sampled([](double t) { return kNewton * (t + 0.01); }, 1);
  CHECK_THAT(at(cut.curve(), 0.0334), WithinAbs(kNewton * 0.0434, 1e-9));
}

TEST_CASE("force curve: between linear and smooth it is the blend") {
  const HalfSine hit{0.0103, 0.009};
  const Log half = sampled(hit, 0.5), linear = sampled(hit, 0), smooth = sampled(hit, 1);
  for (double t = 0.0001; t < 0.03; t += 0.00017)
    CHECK_THAT(at(half.curve(), t), WithinAbs(0.5 * (at(linear.curve(), t) + at(smooth.curve(), t)), 1e-9));
}
