// Many landings at once: one in each lane of the machine's SIMD registers.
//
// Every lane has its own motion, drop, floor and actuator, its own step size, events, rest test and peak; a lane that
// finishes takes the next landing at once. The equations are those of the scalar path, with Pack as their scalar. Which
// instruction set runs is chosen when the program runs.
#pragma once

#include <span>

#include "landing/run/landing.hpp"

namespace ukemi::landing {

/// One landing to simulate. What it points to must outlive the run.
struct BatchCase {
  const Scene* scene;
  const SeaParameters<double>* sea;
  Motion motion;
  double abandon_above = std::numeric_limits<double>::infinity();  ///< [m/s^2], see SimulateOptions
};

struct BatchOptions {
  double accuracy = 1e-5;  ///< relative tolerance of each step, 1e-14..1e-2: the method is of order 5
  Limits limits;           ///< see SimulateOptions
  enum class OnMaxSteps { kScalar, kFail } on_max_steps = OnMaxSteps::kScalar;  ///< for a landing beyond max_steps
  long max_steps = 20'000;                      ///< steps of a lane; the scalar path has 200,000, and may go implicit
  const std::function<bool()>* over = nullptr;  ///< of batch_peaks: see SimulateOptions
  void validate() const;                        ///< throws InputError
};

/// Instruction sets, and the widest that this machine has.
enum class InstructionSet { kBaseline, kAvx2, kAvx512 };
inline constexpr std::array<const char*, 3> kInstructionSetNames = {"baseline", "avx2", "avx512"};
InstructionSet widest_instruction_set();
/// Lanes of an instruction set: 2, 4, 8.
constexpr int lanes(InstructionSet s) { return 2 << int(s); }
/// The peaks of many landings, by the kernel that holds the terms of all of them; `threads` as everywhere: 0 for all
/// cores, and without influence on the results. Those that `over` cut off come back with End::kStopped. Throws
/// InputError for options or cases that are not valid, and for another number of peaks than of cases.
void batch_peaks(std::span<const BatchCase> cases, std::span<LandingPeak> peaks, const BatchOptions& options,
                 int threads = 1, InstructionSet set = widest_instruction_set());

}  // namespace ukemi::landing
