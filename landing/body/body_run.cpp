#include "landing/body/body_run.hpp"

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/body/body_kernel.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

BodyLanding simulate(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options, double rate) {
  scene.validate(), validate(scene.robot, motion), options.validate();
  constexpr double kMaxRows = 2e6, kMaxDuration = 30;  // [s]
  if (!(rate >= 0 && rate * scene.t_end.value_or(kMaxDuration) <= kMaxRows))
    throw InputError("rate: " + shortest(rate) + " Hz: at least 0 is needed, and no more than 2e6 rows in the " +
                     shortest(scene.t_end.value_or(kMaxDuration)) + " s that a run may last; [run] t_end bounds it");
  BodyLanding out = in_kernel<kPlainPair, kPair, kTriple, kMiddle, kLate, kAny>(
      scene.robot, [&]<Capacity kSize>() { return report_in_kernel<kSize>(scene, motion, options, rate); });
  if (out.end != End::kFailed && out.end != End::kBroken &&
      !(out.energy_residual <= energy_tolerance(options.accuracy)))
    out.end = End::kFailed, out.failure = Failure::kUnbalanced;
  return out;
}

}  // namespace ukemi::landing
