// Many landings at once, in SIMD lanes and on all cores: the peak of every motion of a grid.
//
//     batch SCENE.toml ACTUATOR.toml
#include <algorithm>
#include <cstdio>
#include <exception>
#include <vector>

#include <ukemi/actuator.hpp>
#include <ukemi/landing/batch.hpp>
#include <ukemi/landing/scene_file.hpp>

int main(int argc, char** argv) {
  using namespace ukemi;
  using namespace ukemi::landing;
  if (argc != 3) {
    std::fprintf(stderr, "batch SCENE.toml ACTUATOR.toml\n");
    return 2;
  }
  try {
    const Scene scene = read_scene(argv[1]);
    const Actuator actuator = read_actuator(argv[2]);
    const auto [low, high] = scene.search.phi;
    const auto [shortest, longest] = scene.search.duration;
    constexpr int kSide = 10;
    std::vector<BatchCase> cases;
    for (int i = 0; i < kSide; ++i)
      for (int j = 0; j < kSide; ++j)
        for (int k = 0; k < kSide; ++k) {
          const auto at = [](double a, double b, int n) { return a + (b - a) * n / (kSide - 1); };
          cases.push_back({&scene, &actuator.sea, {at(low, high, i), at(low, high, j), at(shortest, longest, k)}});
        }
    std::vector<LandingPeak> peaks(cases.size());
    batch_peaks(cases, peaks, {}, 0);
    const auto followed = [](const LandingPeak& p) { return !no_landing(p.end); };
    const auto best = std::min_element(peaks.begin(), peaks.end(), [&](auto& a, auto& b) {
      return followed(a) > followed(b) || (followed(a) == followed(b) && a.peak < b.peak);
    });
    const Motion& m = cases[std::size_t(best - peaks.begin())].motion;
    std::printf("%zu landings; the softest: %.1f m/s^2 by %.3f rad to %.3f rad in %.3f s\n", peaks.size(), best->peak,
                m.phi_i, m.phi_f, m.duration);
    return followed(*best) ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "batch: %s\n", e.what());
    return 2;
  }
}
