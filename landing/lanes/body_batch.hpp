// Many landings of robots of links at once, one in each lane of the machine's SIMD registers: batch.hpp's, with the
// equations of landing/body in Pack.
#pragma once

#include <span>

#include "landing/body/body_run.hpp"
#include "landing/lanes/batch_source.hpp"

namespace ukemi::landing {

/// One landing to be followed. What it points to must outlive the run, or until it is done.
struct BodyBatchCase {
  const BodyScene* scene;
  const BodyMotion* motion;
  double abandon_above = std::numeric_limits<double>::infinity();  ///< [m/s^2], see SimulateOptions
};
using BodyBatchSource = LaneSource<BodyBatchCase, BodyLanding>;

struct BodyBatchOptions {
  double accuracy = 1e-6;                       ///< relative tolerance of each step: the method is of order 5
  long max_steps = 200'000;                     ///< see SimulateOptions
  const std::function<bool()>* over = nullptr;  ///< see SimulateOptions
};

/// Runs a source until every lane is without work, or the source is over. The robots differ in numbers alone: another
/// tree than the first one's, Hunt and Crossley's law, limits of joints, loads, a spring that softens, friction of a
/// drive that asks for fine steps, and robots beyond the largest kernel are followed by the scalar path. The cases must
/// be valid. `set` must be one that the machine has.
void run_body_batch(BodyBatchSource& source, const Robot& robot, const BodyBatchOptions& options,
                    InstructionSet set = widest_instruction_set());

/// The landings of many cases as peak_acceleration gives them, to the accuracy of the steps; `threads` as everywhere: 0
/// for all cores, and without influence on the results. Those that `over` cut off come back with End::kStopped. Throws
/// InputError for a case that is not valid, and for another number of landings than of cases.
void body_batch_peaks(std::span<const BodyBatchCase> cases, std::span<BodyLanding> landings,
                      const BodyBatchOptions& options, int threads = 1, InstructionSet set = widest_instruction_set());

}  // namespace ukemi::landing
