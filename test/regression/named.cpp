// Which term real joints have: random actuators with one term each, from an independent simulator
// (test/joint_simulator.hpp), 500 Hz, 1 mrad. The score tests name it, and a fit with it finds the constants.
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/trust/diagnostics.hpp"
#include "test/impact.hpp"
#include "test/joint_simulator.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;

namespace {

struct Kind {
  const char* term;
  double Effects::*size;
  double smallest, largest;  ///< that are drawn; it, or the friction that it is of, grows until it shows
  bool beside_friction = false;
};
constexpr Kind kKinds[] = {
    {"friction", &Effects::dry, 0.1, 0.6},
    {"viscous_friction", &Effects::viscous, 0.02, 0.3},
    {"output_friction", &Effects::out_dry, 0.05, 0.4},
    {"output_viscous", &Effects::out_viscous, 0.005, 0.1},
    {"stiffening", &Effects::cubic, 20, 200},
    {"friction_asymmetry", &Effects::asymmetry, 0.15, 0.5, true},
    {"breakaway", &Effects::breakaway, 0.3, 1, true},
    {"spring_loss", &Effects::loss, 0.04, 0.15, true},
};

double moved(const std::vector<Trial>& a, const std::vector<Trial>& b) {
  double sum = 0, n = 0;
  for (std::size_t m = 0; m < a.size(); ++m)
    for (std::size_t i = 0; i < a[m].phi.size(); ++i) sum += std::pow(a[m].phi[i] - b[m].phi[i], 2), ++n;
  return std::sqrt(sum / n);
}

SeaParameters<double> actuator_of(const std::array<double, kConstants>& c) {
  SeaParameters<double> out = truth();
  set_constants(out, c);
  return out;
}

}  // namespace

TEST_CASE("the term that a random actuator has is named, and with it the constants are found") {
  constexpr double kNoise = 1e-3;
  const int n = draws(16);
  int named = 0, constants = 0, within = 0, shown = 0;
  std::string missed;
  for (int d = 0; d < n; ++d) {
    Random random(12000, std::uint64_t(d));  // how many terms are fitted before one is named was chosen on 9000
    const Kind& kind = kKinds[std::size_t(d) % std::size(kKinds)];
    std::array<double, kConstants> c = kTruth;
    for (double& x : c) x *= random.factor(1.5);
    Effects without{.dry = kind.beside_friction ? random.uniform(0.2, 0.5) : 0, .angle_noise = 0}, with = without;
    with.*kind.size = random.uniform(kind.smallest, kind.largest);
    // What matters moves the angles by five times the noise.
    double Effects::*grows = kind.beside_friction ? &Effects::dry : kind.size;
    for (int k = 0; k < 5 && moved(eight_hits(without, 1, c), eight_hits(with, 1, c)) < 5 * kNoise; ++k) {
      with.*grows *= 1.5;
      if (kind.beside_friction) without.dry = with.dry;
    }
    with.angle_noise = kNoise;
    const std::vector<Trial> logs = eight_hits(with, 400 + std::uint64_t(d), c);
    FitOptions options;
    if (kind.beside_friction) options.terms.nuisance = {"friction"};
    SeaParameters<double> from = actuator_of(c);
    from.friction = without.dry;
    const Fit lacking = refit(rig(), logs, from, options);
    if (!lacking.converged) continue;
    ++shown;
    const ResidualTests tests = test_residuals({rig(), logs, options}, lacking);
    const bool right = tests.missing() && std::string(tests.missing()->term) == kind.term;
    named += right;
    if (!right)
      missed += std::string(kind.term) + " " + std::to_string(with.*kind.size) + " called " +
                (tests.missing() ? std::string(tests.missing()->term) : "nothing") + "; ";
    options.terms.nuisance.push_back(kind.term);
    const Fit whole = fit(rig(), logs, from, from, options);
    for (std::size_t k = 0; k < kConstants; ++k) {
      const Estimate& e = whole.parameters[k];
      const double off = e.std ? std::abs(e.value - c[k]) / *e.std : 99;
      ++constants, within += off <= 3.5;
      if (off > 3.5)
        missed += e.name + " off by " + std::to_string(off) + " with " + kind.term + " " +
                  std::to_string(with.*kind.size) + "; ";
    }
  }
  INFO("named " << named << " of " << shown << ", constants within 3.5 of their errors " << within << " of "
                << constants << ". " << missed);
  CHECK(shown >= 0.9 * n);
  // 93 of 98 with UKEMI_DRAWS=100: a loss beside friction may hide in the constants. Of few draws, one more may be
  // missed.
  CHECK(shown - named <= std::max(2.0, 0.07 * shown));
  CHECK(within >= 0.97 * constants);
}
