// A batch run whose landings are supplied as lanes become free.
#pragma once

#include <cstddef>

#include "landing/lanes/batch.hpp"
#include "landing/lanes/lane_source.hpp"

namespace ukemi::landing {

using BatchSource = LaneSource<BatchCase, LandingPeak>;

/// The fastest instruction set for a number of landings: eight half-empty lanes are slower than four.
InstructionSet fastest_instruction_set(std::size_t landings);

/// Runs until no lane has work or the source is over. The machine must have `set`, and the cases be valid; their scenes
/// must not change. Landings whose actuator has terms that `drive` has not (is_extended, is_late), or with other
/// contact points than `scene`, run in the scalar path.
void run_batch(BatchSource& source, const Scene& scene, const SeaParameters<double>& drive, const BatchOptions& options,
               InstructionSet set = widest_instruction_set());

}  // namespace ukemi::landing
