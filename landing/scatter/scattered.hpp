// Landings of one or more motions over scattered drops, in lanes.
#pragma once

#include <functional>
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
  const std::function<bool()>* over = nullptr;  ///< see SimulateOptions: landings that it ends are End::kStopped
  BatchOptions::OnMaxSteps on_max_steps = BatchOptions::OnMaxSteps::kScalar;  ///< see BatchOptions
  long max_steps = BatchOptions().max_steps;                                  ///< the same
};

/// Plays planned motions over drops; reuses its memory between calls.
class ScatteredLandings {
 public:
  /// Reserves memory: a call of up to this many landings then allocates nothing on one thread.
  void reserve(std::size_t landings) { motions_.reserve(landings), cases_.reserve(landings), peaks_.reserve(landings); }
  /// Landing of motion i over drop k is [i * drops.size() + k].
  const std::vector<LandingPeak>& play(std::span<const DrivenMotion> planned, std::span<const ScatteredDrop> drops,
                                       const ScatteredOptions& options, const MotionSpace* space = nullptr);

 private:
  std::vector<DrivenMotion> motions_;
  std::vector<BatchCase> cases_;
  std::vector<LandingPeak> peaks_;
};

/// Value of a landing: its peak; `penalty` where it broke a limit; infinite where it could not be simulated.
double counted(const LandingPeak& landing, double penalty);

}  // namespace ukemi::landing
