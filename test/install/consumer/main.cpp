// Twenty lines of a user: one fit and one landing with the library alone.
#include <cstdio>

#include <ukemi/identify/fit.hpp>
#include <ukemi/landing/simulate.hpp>

int main() {
  using namespace ukemi;
  SeaParameters<double> sea{.k_p = 50, .k_d = 1, .k_sea = 65, .c_sea = 1.6, .i_motor = 0.085, .tau_max = 20};
  identify::Trial hit;
  for (int i = 0; i <= 500; ++i) hit.t.push_back(i * 1e-3), hit.force.push_back(i > 20 && i < 35 ? 80 : 0);
  const identify::Rig rig{.length = 0.3, .inertia = 0.024225, .tau_max = {}, .gear_ratio = {}, .feedback = {}};
  hit.phi = identify::predict(rig, {hit}, sea).trials[0].phi;
  const identify::Fit fit = identify::fit(rig, {hit}, sea, sea);
  landing::Scene scene;
  scene.robot = {{0.806, 0.806}, {6.09e-3, 6.09e-3}, 0.3, 9.81};
  scene.contacts = {true, true, true};
  scene.floor = landing::Floor<double>{6880, 123, 0.19};
  scene.drop = {.height = 0.4, .forward_speed = 0.63, .pitch = 0.3141592653589793};
  const auto peak = landing::peak_acceleration(scene, fit.sea, {-0.7853981633974483, -0.7853981633974483, 1}).peak;
  std::printf("k_sea %.6g peak %.6g\n", fit.sea.k_sea, peak);
  return peak > 466.17 && peak < 466.18 ? 0 : 1;
}
