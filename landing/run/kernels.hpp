// The small set of kernels, and which one a scene runs. Included by the files that compile them (peak.cpp,
// simulate.cpp).
// Private: not installed.
#pragma once

#include "common/integrate/automatic.hpp"
#include "landing/run/follow.hpp"

namespace ukemi::landing {

using integrate::Automatic, integrate::DormandPrince54, integrate::DormandPrince853, integrate::Rodas5P;
using LowOrder = Automatic<DormandPrince54, Rodas5P>;
using HighOrder = Automatic<DormandPrince853, Rodas5P>;
/// From this accuracy up the lower order takes less time; see the work-precision table of tools/docs/benchmarks.md.
constexpr double kLowOrder = 1e-7;

/// The kernels that are compiled, by the terms they hold. A scene runs the first that holds all of its own.
inline constexpr LandingTerms kFlight{SeaTerms{true, true}, false};  ///< nothing to touch
inline constexpr LandingTerms kPlain{SeaTerms{false, false}};        ///< no torque limit
inline constexpr LandingTerms kLimited{SeaTerms{true, false}};       ///< the paper's scene
inline constexpr LandingTerms kExtended{SeaTerms{true, true}};       ///< friction, stiffening or motor-side feedback
inline constexpr LandingTerms kLate{SeaTerms{true, true, true}};     ///< and a drive that is late

template <bool kReport>
void dispatch(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
              const SimulateOptions& options, LandingPeak& out, Landing* landing, double rate) {
  const auto with = [&]<LandingTerms kTerms>() {
    if (options.accuracy >= kLowOrder)
      Follower<LowOrder, kTerms, kReport>(scene, sea, motion, options, out, landing, rate).follow();
    else
      Follower<HighOrder, kTerms, kReport>(scene, sea, motion, options, out, landing, rate).follow();
  };
  if (is_late(sea))
    with.template operator()<kLate>();
  else if (!scene.touches())
    with.template operator()<kFlight>();
  else if (is_extended(sea))
    with.template operator()<kExtended>();
  else if (std::isfinite(sea.tau_max))
    with.template operator()<kLimited>();
  else
    with.template operator()<kPlain>();
}

}  // namespace ukemi::landing
