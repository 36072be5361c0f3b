// A user of identify alone, who builds only what that needs.
#include <cmath>
#include <cstdio>

#include <ukemi/identify/fit.hpp>

int main() {
  using namespace ukemi;
  const SeaParameters<double> sea{.k_p = 50, .k_d = 1, .k_sea = 65, .c_sea = 1.6, .i_motor = 0.085, .tau_max = 20};
  identify::Trial hit;
  for (int i = 0; i <= 500; ++i) hit.t.push_back(i * 1e-3), hit.force.push_back(i > 20 && i < 35 ? 80 : 0);
  const identify::Rig rig{.length = 0.3, .inertia = 0.024225, .tau_max = {}, .gear_ratio = {}, .feedback = {}};
  hit.phi = identify::predict(rig, {hit}, sea).trials[0].phi;
  auto start = sea;
  start.k_sea *= 1.2;
  const identify::Fit fit = identify::fit(rig, {hit}, start, sea);
  std::printf("k_sea %.6g\n", fit.sea.k_sea);
  return std::abs(fit.sea.k_sea / sea.k_sea - 1) < 1e-6 ? 0 : 1;
}
