#include "landing/lanes/batch.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/parallel.hpp"
#include "common/sea.hpp"
#include "landing/lanes/batch_entry.hpp"

namespace ukemi::landing {

InstructionSet widest_instruction_set() {
#if defined(__x86_64__) && !defined(__clang__)  // see batch_kernel.cpp
  static const InstructionSet set = [] {
    __builtin_cpu_init();
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512vl");
    return avx512 ? InstructionSet::kAvx512 : avx2 ? InstructionSet::kAvx2 : InstructionSet::kBaseline;
  }();
  return set;
#else
  return InstructionSet::kBaseline;
#endif
}

InstructionSet fastest_instruction_set(std::size_t landings) {
  constexpr std::size_t kMinForAvx512 = 12;
  return landings < kMinForAvx512 ? std::min(widest_instruction_set(), InstructionSet::kAvx2)
                                  : widest_instruction_set();
}

void run_batch(BatchSource& source, const BatchOptions& options, InstructionSet set) {
  switch (std::min(set, widest_instruction_set())) {
    case InstructionSet::kAvx512:
      return run_lanes<8>(source, options);
    case InstructionSet::kAvx2:
      return run_lanes<4>(source, options);
    case InstructionSet::kBaseline:
      return run_lanes<2>(source, options);
  }
}

void BatchOptions::validate() const {
  const SimulateOptions same{.accuracy = accuracy, .max_steps = max_steps, .limits = limits};
  same.validate();
}

namespace {

void validate_all(std::span<const BatchCase> cases) {
  const Scene* scene = nullptr;
  const SeaParameters<double>* sea = nullptr;
  for (const BatchCase& c : cases) {  // consecutive cases usually share scene and actuator
    if (!c.scene || !c.sea) throw InputError("batch: a case without a scene or an actuator");
    if (!(c.abandon_above >= 0))
      throw InputError("abandon_above: " + shortest(c.abandon_above) + ": at least 0 is needed");
    if (c.scene != std::exchange(scene, c.scene)) scene->validate();
    if (c.sea != std::exchange(sea, c.sea)) validate(*sea);
    validate(c.motion);
  }
}

}  // namespace

void batch_peaks(std::span<const BatchCase> cases, std::span<LandingPeak> peaks, const BatchOptions& options,
                 int threads, InstructionSet set) {
  options.validate(), validate_all(cases);
  if (peaks.size() != cases.size())
    throw InputError("batch: " + std::to_string(peaks.size()) + " peaks: " + std::to_string(cases.size()) +
                     " are needed, one for each case");
  BatchOptions batch_options = options;
  std::size_t motor_side = 0;
  for (const BatchCase& c : cases) {
    batch_options.extended = batch_options.extended || is_extended(*c.sea),
    batch_options.late = batch_options.late || is_late(*c.sea);
    motor_side += c.sea->feedback == Feedback::kMotor;
  }
  batch_options.feedback = 2 * motor_side > cases.size() ? Feedback::kMotor : Feedback::kOutput;
  constexpr std::size_t kMinPerThread = 24;  // fewer landings are not worth a thread
  const int workers = std::min(thread_count(threads), int((cases.size() + kMinPerThread - 1) / kMinPerThread));
  LandingPeak stopped;
  stopped.end = End::kStopped;
  std::fill(peaks.begin(), peaks.end(), stopped);
  std::atomic<std::size_t> next{0};
  parallel_for(workers, workers, [&](int) {
    CaseQueue<BatchCase, LandingPeak> queue(cases, peaks, next, options.over);
    run_batch(queue, batch_options, set);
  });
}

}  // namespace ukemi::landing
