// The kernels, and the choice of one for a scene. Included by the files that compile them (peak.cpp, simulate.cpp).
#pragma once

#include "common/integrate/automatic.hpp"
#include "landing/run/follow.hpp"

namespace ukemi::landing {

template <bool kReport>
void dispatch(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
              const SimulateOptions& options, LandingPeak& out, Landing* landing, double rate) {
  const auto with = [&]<LandingTerms kTerms>() {
    if (step_accuracy(options.accuracy, sea) >= kLowOrder)
      Follower<integrate::LowOrder, kTerms, kReport>(scene, sea, motion, options, out, landing, rate).follow();
    else
      Follower<integrate::HighOrder, kTerms, kReport>(scene, sea, motion, options, out, landing, rate).follow();
  };
  if (is_late(sea))
    with.template operator()<kLateTerms>();
  else if (!scene.touches())
    with.template operator()<kFlightTerms>();
  else if (is_extended(sea))
    with.template operator()<kExtendedTerms>();
  else if (std::isfinite(sea.tau_max))
    with.template operator()<kLimitedTerms>();
  else
    with.template operator()<kPlainTerms>();
}

}  // namespace ukemi::landing
