// Landings of one motion, or of many, over scattered drops, in lanes.
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "landing/lanes/batch.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/run/simulate.hpp"
#include "landing/scatter/drop_model.hpp"

namespace ukemi::landing {

struct ScatteredOptions {
  double accuracy = 1e-6;                       ///< see BatchOptions
  Limits limits;                                ///< a landing that breaks them ends with End::kBroken
  int threads = 0;                              ///< 0: all cores; without influence on the results
  const std::function<bool()>* over = nullptr;  ///< see SimulateOptions: what it cuts off is End::kStopped
  BatchOptions::Long too_long = BatchOptions::Long::kScalar;  ///< see BatchOptions
  long max_steps = BatchOptions().max_steps;                  ///< the same
};

/// Plays planned motions over drops, and keeps its memory between calls.
class ScatteredLandings {
 public:
  /// Room for so many landings at once: as many allocate nothing on one thread.
  void reserve(std::size_t landings) { plays_.reserve(landings), cases_.reserve(landings), peaks_.reserve(landings); }
  /// Landing of motion i over drop k is [i * drops.size() + k].
  const std::vector<LandingPeak>& play(std::span<const DrivenMotion> planned, std::span<const ScatteredDrop> drops,
                                       const ScatteredOptions& options, const MotionSpace* space = nullptr);

 private:
  std::vector<DrivenMotion> plays_;
  std::vector<BatchCase> cases_;
  std::vector<LandingPeak> peaks_;
};

/// What counts of a landing: its peak; a landing that broke a limit counts as `penalty`; infinite where it could not be
/// followed.
double counted(const LandingPeak& landing, double penalty);

}  // namespace ukemi::landing
