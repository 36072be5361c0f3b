// The force between the samples of its log: true pulses are smooth and begin anywhere between two samples. Random
// actuators of an independent simulator (test/joint_simulator.hpp), eight hits of 8 to 20 ms each, 1 kHz.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "identify/logs/hits.hpp"
#include "identify/trust/identification.hpp"
#include "test/joint_simulator.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;

namespace {

enum class Shape { kHalfSine, kHann, kAsLogged };

/// Table 2, each constant times or over up to 2.
std::array<double, kConstants> drawn_constants(Random& random) {
  std::array<double, kConstants> out = kTruth;
  for (double& c : out) c *= std::exp2(2 * random.uniform() - 1);
  return out;
}

std::vector<Trial> drawn_hits(Shape shape, double noise, const std::array<double, kConstants>& constants,
                              Random& random, const Effects& effects = {}) {
  std::vector<Trial> out;
  for (int m = 0; m < 8; ++m) {
    const double newton = (random.uniform() < 0.5 ? -1 : 1) * (60 + 120 * random.uniform()),
                 seconds = 0.008 + 0.012 * random.uniform(), onset = 0.05 + 0.001 * random.uniform();
    const auto force = [=](double t) {
      const double s = (t - onset) / seconds;
      if (!(s > 0 && s < 1)) return 0.0;
      const double sine = std::sin(std::numbers::pi * s);
      return shape == Shape::kHann ? newton * sine * sine : newton * sine;
    };
    Trial log;
    log.file = "hit_" + std::to_string(m + 1);
    for (int i = 0; i <= 800; ++i) log.t.push_back(i / 1000.0), log.force.push_back(force(log.t.back()));
    const auto linear = [&](double t) {
      const auto i = std::min(std::size_t(t * 1000), log.t.size() - 2);
      return log.force[i] + (log.force[i + 1] - log.force[i]) * (t - log.t[i]) / (log.t[i + 1] - log.t[i]);
    };
    log.phi = shape == Shape::kAsLogged ? joint_angle(log.t, std::function<double(double)>(linear), effects, constants)
                                        : joint_angle(log.t, std::function<double(double)>(force), effects, constants);
    for (double& x : log.phi) x += noise * random.normal();
    out.push_back(log);
  }
  return out;
}

/// Over random actuators: errors in their own standard errors, and what was decided.
struct Tally {
  double square = 0, count = 0, off = 0;
  int trusted = 0, smooth = 0;
  double rms_z() const { return std::sqrt(square / count); }
};

/// `load_cell` [N]: noise of the force, which is read as a log's is.
Tally tally(Shape shape, double noise, TrustOptions::Force force, int actuators, double load_cell = 0) {
  Tally out;
  for (int d = 0; d < actuators; ++d) {
    Random random(17, std::uint64_t(d));
    const auto constants = drawn_constants(random);
    std::vector<Trial> logs = drawn_hits(shape, noise, constants, random);
    for (Trial& t : logs) {
      for (double& f : t.force) f += load_cell * random.normal();
      flatten_force_between_hits(t);
    }
    const Identification found = identify::identify({rig(), logs, {}}, limited(constants), limited(), {.force = force});
    out.trusted += found.fit.trusted(), out.smooth += found.force_smooth > 0;
    for (std::size_t k = 0; k < kConstants; ++k) {
      const Estimate& e = found.fit.parameters[k];
      REQUIRE(e.std);
      const double z = (e.value - constants[k]) / *e.std;
      out.square += z * z, ++out.count, out.off += std::abs(z) > 3.5;
    }
  }
  return out;
}

}  // namespace

TEST_CASE("force between samples: the errors hold where pulses are smooth and where they are linear") {
  const int n = draws(30);
  const double noise = GENERATE(1e-3, 1e-4);  // [rad]
  for (const Shape shape : {Shape::kHalfSine, Shape::kHann, Shape::kAsLogged}) {
    const Tally t = tally(shape, noise, TrustOptions::Force::kByResiduals, n);
    INFO("noise " << noise << ", shape " << int(shape) << ": rms z " << t.rms_z() << ", " << t.off << " of " << t.count
                  << " beyond 3.5, " << t.trusted << " trusted, " << t.smooth << " smooth");
    CHECK(t.rms_z() <= 1.2);
    CHECK(t.off <= 0.01 * t.count);
    CHECK(t.trusted >= 0.85 * n);
    if (shape == Shape::kHalfSine) CHECK(t.smooth == n);
    if (shape == Shape::kAsLogged) CHECK(t.smooth <= 0.1 * n);
  }
}

TEST_CASE("force between samples: the errors hold under the noise of a load cell, where pulses are smooth") {
  const struct {
    double load_cell;  // [N], of hits from 60 to 180 N
    Shape shape;
    double rms_z;
  } cases[] = {{0.3, Shape::kHalfSine, 1.2},
               {0.3, Shape::kHann, 1.2},
               {2, Shape::kHalfSine, 1.25},
               {2, Shape::kHann, 1.4}};  // its ends are lost in the noise: too narrow by that, see limits.md
  const int n = draws(30);
  for (const auto& c : cases) {
    const Tally t = tally(c.shape, 2e-4, TrustOptions::Force::kByResiduals, n, c.load_cell);
    INFO(c.load_cell << " N, shape " << int(c.shape) << ": rms z " << t.rms_z() << ", " << t.off << " of " << t.count
                     << " beyond 3.5, " << t.trusted << " trusted, " << t.smooth << " smooth");
    CHECK(t.rms_z() <= c.rms_z);
    CHECK(t.off <= (c.rms_z > 1.3 ? 0.03 : 0.01) * t.count);
    CHECK(t.trusted >= 0.9 * n);
  }
}

TEST_CASE("force between samples: taken as linear, true pulses cost several standard errors, and are not trusted") {
  const Tally t = tally(Shape::kHalfSine, 1e-3, TrustOptions::Force::kAsSet, draws(30));
  INFO("rms z " << t.rms_z() << ", " << t.off << " of " << t.count << " beyond 3.5, " << t.trusted << " trusted");
  CHECK(t.rms_z() <= 1.5);
  CHECK(t.trusted <= 0.3 * draws(30));
}

TEST_CASE("force between samples: constants that are given choose it by what they leave") {
  const auto constants = kTruth;
  for (const Shape shape : {Shape::kHalfSine, Shape::kAsLogged}) {
    Random random(18);
    const std::vector<Trial> logs = drawn_hits(shape, 1e-4, constants, random);
    const std::vector<Trial> nearer = with_nearer_force(rig(), logs, limited(constants));
    const bool smooth = shape == Shape::kHalfSine;
    for (const Trial& t : nearer) CHECK(t.force_smooth == (smooth ? 1 : 0));
    CHECK(predict(rig(), nearer, limited(constants)).rms < 1.2e-4);
    CHECK((predict(rig(), logs, limited(constants)).rms > 1.2e-4) == smooth);
  }
}

TEST_CASE("force between samples: what a second look found is said, also where the smooth force is then taken") {
  Random random(18);
  const std::vector<Trial> logs = drawn_hits(Shape::kHalfSine, 1e-3, kTruth, random, {.dry = 0.3});
  FitOptions options;
  options.terms.nuisance = {"viscous_friction"};  // no friction of that kind explains one that sticks
  const Identification found = identify::identify({rig(), logs, options}, std::nullopt, limited());
  CHECK(found.force_smooth == 1);
  CHECK(found.trust->tests.model_rejected());
  const auto& said = found.fit.warnings;
  CHECK(std::any_of(said.begin(), said.end(), [](const std::string& w) {
    return w.find("viscous_friction: where its score test points") == 0 &&
           w.find("the model lacks something else") != std::string::npos;
  }));
}
