// The exact Jacobians that the implicit steps use, against central differences, in random states of every mode.
#include <algorithm>
#include <catch2/catch.hpp>

#include "common/random.hpp"
#include "identify/rig/one_link.hpp"

using namespace ukemi;

namespace {

constexpr std::uint64_t kSeed = 20261121;

/// Largest difference between `linearize` and central differences, over the Jacobian's largest entry in that row.
template <class System, class State>
double disagreement(const System& system, double t, const State& y, double h) {
  constexpr int n = State::RowsAtCompileTime;
  Eigen::Matrix<double, n, n> exact, difference;
  State rate, rate_difference, up, down;
  system.linearize(t, y, exact, rate);
  for (int j = 0; j < n; ++j) {
    const State e = h * State::Unit(j);
    system.derivative(t, State(y + e), up), system.derivative(t, State(y - e), down);
    difference.col(j) = (up - down) / (2 * h);
  }
  system.derivative(t + h, y, up), system.derivative(t - h, y, down);
  rate_difference = (up - down) / (2 * h);
  double worst = 0;
  for (int i = 0; i < n; ++i) {
    const double scale = 1 + exact.row(i).cwiseAbs().maxCoeff() + std::abs(rate[i]);
    worst = std::max(worst, (exact.row(i) - difference.row(i)).cwiseAbs().maxCoeff() / scale);
    worst = std::max(worst, std::abs(rate[i] - rate_difference[i]) / scale);
  }
  return worst;
}
/// The same in the step that suits better: what differences err by is rounding where it is short, else curvature.
template <class System, class State>
double disagreement(const System& system, double t, const State& y) {
  return std::min(disagreement(system, t, y, 1e-6), disagreement(system, t, y, 1e-5));
}

}  // namespace

TEMPLATE_TEST_CASE_SIG("jacobian: the rig's is exact", "", ((bool kLate), kLate), false, true) {
  using System = identify::OneLinkSystem<SeaTerms{true, true, kLate}, double>;
  for (std::uint64_t i = 0; i < 200; ++i) {
    Random r(kSeed, i);
    SeaParameters<double> sea{
        r.uniform(0, 100), r.uniform(0, 3), r.uniform(1, 200), r.uniform(0, 3), r.uniform(0.01, 0.2), 20, 0.2, 30};
    if (kLate) sea.control_delay = 1e-3, sea.velocity_filter = 2e-3;
    System system(sea, {.length = 0.3, .inertia = 0.024, .gravity = {r.uniform(0, 5), r.uniform(-1, 1)}});
    system.input = {.t = 0.1,
                    .has_force = true,
                    .curved = i % 2 == 0,
                    .force = {50, -2000, 3e4, -1e6},
                    .phi_ref = 0.1,
                    .phi_ref_rate = 0.5,
                    .dphi_ref = 0.5,
                    .dphi_ref_rate = 2};
    system.mode.saturation = int(i % 3) - 1;
    typename System::State y;
    for (int k = 0; k < y.size(); ++k) y[k] = r.uniform(-1, 1) * (k < 2 ? 1 : 5);
    CAPTURE(i);
    CHECK(disagreement(system, 0.11, y) < 1e-7);
  }
}
