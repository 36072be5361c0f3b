// Many landings of robots of links at once, one in each lane of the SIMD registers, as batch.hpp: the equations of
// landing/body with Pack as their scalar.
#pragma once

#include <span>

#include "landing/body/body_run.hpp"
#include "landing/lanes/batch_source.hpp"

namespace ukemi::landing {

/// One landing to simulate. What it points to must outlive the run, or live until the landing is done.
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

/// Runs until no lane has work or the source is over. The robots must differ from `robot` only in numbers: those with
/// another tree or other terms, other loads, Hunt and Crossley's law, a softening spring, drive friction that needs
/// fine steps, or beyond the largest kernel run in the scalar path. The cases must be valid, and the machine must have
/// `set`.
void run_body_batch(BodyBatchSource& source, const Robot& robot, const BodyBatchOptions& options,
                    InstructionSet set = widest_instruction_set());

/// Landings of many cases, as by peak_acceleration within the accuracy of the steps. `threads`: 0 for all cores; does
/// not affect results. Landings that `over` cuts off have End::kStopped. Throws InputError for an invalid case, and if
/// the numbers of landings and cases differ.
void body_batch_peaks(std::span<const BodyBatchCase> cases, std::span<BodyLanding> landings,
                      const BodyBatchOptions& options, int threads = 1, InstructionSet set = widest_instruction_set());

}  // namespace ukemi::landing
