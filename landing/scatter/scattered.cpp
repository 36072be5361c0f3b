#include "landing/scatter/scattered.hpp"

namespace ukemi::landing {

const std::vector<LandingPeak>& ScatteredLandings::play(std::span<const DrivenMotion> planned,
                                                        std::span<const ScatteredDrop> drops,
                                                        const ScatteredOptions& options, const MotionSpace* space) {
  const std::size_t n = planned.size() * drops.size();
  motions_.clear(), cases_.clear();
  motions_.reserve(n), cases_.reserve(n);
  peaks_.resize(n);
  for (const DrivenMotion& p : planned)
    for (const ScatteredDrop& d : drops) {
      motions_.push_back(space ? d.played(*space, p) : d.played(p));
      cases_.push_back({&d.scene, &motions_.back().sea, motions_.back().motion});
    }
  batch_peaks(cases_, peaks_,
              {.accuracy = options.accuracy,
               .limits = options.limits,
               .on_max_steps = options.on_max_steps,
               .max_steps = options.max_steps,
               .over = options.over},
              options.threads);
  return peaks_;
}

double counted(const LandingPeak& landing, double penalty) {
  if (landing.end == End::kBroken) return penalty;
  return no_landing(landing.end) || landing.end == End::kStopped ? std::numeric_limits<double>::infinity()
                                                                 : landing.peak;
}

}  // namespace ukemi::landing
