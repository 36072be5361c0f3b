// Landings that are decided as lanes become free.
#pragma once

#include <cstddef>

#include "landing/lanes/batch.hpp"
#include "landing/lanes/lane_source.hpp"

namespace ukemi::landing {

using BatchSource = LaneSource<BatchCase, LandingPeak>;

/// The fastest set for a number of landings: eight lanes of which half are empty are slower than four.
InstructionSet quickest_instruction_set(std::size_t landings);

/// Runs a source until every lane is without work, or the source is over. `set` must be one that the machine has.
/// Allocates nothing, and checks nothing: the cases must be valid.
void run_batch(BatchSource& source, const BatchOptions& options, InstructionSet set = widest_instruction_set());

}  // namespace ukemi::landing
