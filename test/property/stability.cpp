// A reduced grid of `ukemi bench stability`: steps are bounded, not seconds. Every case passes, is earned sensitive, or
// is refused with a reason; at most 2 % are refused.
#include "landing/stability.hpp"

#include <catch2/catch.hpp>

#include "common/actuator.hpp"
#include "landing/scene_file.hpp"

using namespace ukemi;
using namespace ukemi::landing;

TEST_CASE("stability: stiff and extreme landings pass, are sensitive, or are refused with a reason") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  constexpr long kMaxSteps = 50'000;
  int cases = 0, refused = 0, beyond = 0, sensitive = 0;
  for (const StabilityCase& c : stability_grid(scene, sea, 60, 1, 2)) {
    const StabilityResult r = judge(c, {.max_steps = kMaxSteps});
    INFO(c.factor << " " << c.setting << ": " << name(r.verdict) << " " << r.reason);
    CHECK(r.verdict != Verdict::kWrong);
    CHECK(r.work.steps <= kMaxSteps + 1);
    ++cases, sensitive += r.verdict == Verdict::kSensitive;
    if (r.verdict != Verdict::kRefused) {
      CHECK(r.energy_residual <= 1e-6);
      CHECK(std::isfinite(r.peak));
    } else {
      CHECK(!r.reason.empty());
      // Here the bound on steps is an eighth of the bench's: what runs into it is counted apart.
      ++(r.reason == "more steps than allowed" ? beyond : refused);
    }
    if (r.verdict == Verdict::kSensitive) CHECK(r.sensitivity > 1e-3);
  }
  CAPTURE(cases, refused, beyond, sensitive);
  CHECK(cases > 120);
  CHECK(refused * 50 <= cases);
  CHECK(beyond * 8 <= cases);
}

TEST_CASE("stability: a stiff landing is followed by implicit steps, a plain one by explicit ones") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Motion motion{-0.7, -1.2, 0.25};
  const LandingPeak plain = peak_acceleration(scene, sea, motion);
  CHECK(plain.work.implicit == 0);
  sea.c_sea = 1e5;  // an explicit step would be bounded by 4e-7 s
  const LandingPeak stiff = peak_acceleration(scene, sea, motion);
  CHECK(stiff.end == End::kRest);
  CHECK(stiff.work.implicit > stiff.work.steps / 2);
  CHECK(stiff.work.steps < 20'000);
}
