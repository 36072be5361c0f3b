// A user of landing alone.
#include <cstdio>

#include <ukemi/landing/optimize.hpp>

int main() {
  using namespace ukemi;
  const SeaParameters<double> sea{.k_p = 50, .k_d = 1, .k_sea = 65, .c_sea = 1.6, .i_motor = 0.085, .tau_max = 20};
  landing::Scene scene;
  scene.robot = {{0.806, 0.806}, {6.09e-3, 6.09e-3}, 0.3, 9.81};
  scene.contacts = {true, true, true};
  scene.floor = landing::Floor<double>{6880, 123, 0.19};
  scene.drop = {.height = 0.4, .forward_speed = 0.63, .pitch = 0.3141592653589793};
  const landing::Optimum best =
      landing::optimize(scene, sea, {.solver = "bobyqa", .evaluations = 50, .tolerance_samples = 0});
  std::printf("peak %.6g\n", best.landing.peak);
  return best.found && best.landing.peak < 466 ? 0 : 1;
}
