// Landings that are decided as lanes become free.
#pragma once

#include <cstddef>

#include "landing/lanes/batch.hpp"

namespace ukemi::landing {

/// What runs in a lane next, decided as the lanes become free. Lanes do not influence each other's results: a source
/// that gives each lane work of its own gets the same results whatever the number of lanes.
class BatchSource {
 public:
  virtual ~BatchSource() = default;
  /// The lane's next landing; false if there is none (it is then not asked again).
  virtual bool next(int lane, BatchCase& c) = 0;
  /// The lane's landing has ended.
  virtual void done(int lane, const LandingPeak& peak) = 0;
  /// Asked every few dozen steps: true ends the run, and nobody is told of the landings under way.
  virtual bool over() { return false; }
};

/// The quickest for so many landings: eight lanes of which half stand empty are slower than four.
InstructionSet quickest_instruction_set(std::size_t landings);

/// Runs a source until every lane is without work, or the source is over. `set` must be one that the machine has.
/// Allocates nothing, and looks at nothing: the cases must be valid.
void run_batch(BatchSource& source, const BatchOptions& options, InstructionSet set = widest_instruction_set());

}  // namespace ukemi::landing
