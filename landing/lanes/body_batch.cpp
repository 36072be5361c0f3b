#include "landing/lanes/body_batch.hpp"

#include <algorithm>
#include <atomic>
#include <string>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/parallel.hpp"
#include "landing/lanes/body_batch_entry.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

namespace {

/// Runs all landings in the scalar path, for a robot that fits no kernel of lanes.
void run_scalar(BodyBatchSource& source, const BodyBatchOptions& options) {
  const std::function<bool()> over = [&] { return source.over(); };
  for (BodyBatchCase c; !source.over() && source.next(0, c);) {
    const BodyLanding l = peak_of_valid(*c.scene, *c.motion,
                                        {.accuracy = options.accuracy,
                                         .abandon_above = c.abandon_above,
                                         .max_steps = options.max_steps,
                                         .over = &over});
    if (l.end == End::kStopped) return;
    source.done(0, l);
  }
}

}  // namespace

void run_body_batch(BodyBatchSource& source, const Robot& robot, const BodyBatchOptions& options, InstructionSet set) {
  if (options.accuracy < kLowOrder || !(fits(robot, kMiddle) || fits(robot, kLateLeg)))
    return run_scalar(source, options);
  in_kernel<kPlainPair, kStraightPair, kPair, kPlainTriple, kStraightTriple, kTriple, kQuad, kLateLeg, kMiddle>(
      robot, [&]<Capacity kSize>() {
        switch (std::min(set, widest_instruction_set())) {
          case InstructionSet::kAvx512:  // others gain less than a tenth by it, and take long to compile
            if constexpr (kSize.straight()) return run_body_lanes<kSize, 8>(source, robot, options);
            [[fallthrough]];
          case InstructionSet::kAvx2:
            return run_body_lanes<kSize, 4>(source, robot, options);
          case InstructionSet::kBaseline:
            return run_body_lanes<kSize, 2>(source, robot, options);
        }
      });
}

void body_batch_peaks(std::span<const BodyBatchCase> cases, std::span<BodyLanding> landings,
                      const BodyBatchOptions& options, int threads, InstructionSet set) {
  SimulateOptions{.accuracy = options.accuracy, .max_steps = options.max_steps}.validate();
  const BodyScene* scene = nullptr;
  const BodyMotion* motion = nullptr;  // the last ones that were checked
  for (const BodyBatchCase& c : cases) {
    if (!c.scene || !c.motion) throw InputError("batch: a case without a scene or a motion");
    if (!(c.abandon_above >= 0))
      throw InputError("abandon_above: " + shortest(c.abandon_above) + ": at least 0 is needed");
    const bool same_scene = c.scene == scene;
    if (same_scene && c.motion == motion) continue;
    if (!same_scene) c.scene->validate();
    scene = c.scene, motion = c.motion;
    validate(scene->robot, *motion);
  }
  if (landings.size() != cases.size())
    throw InputError("batch: " + std::to_string(landings.size()) + " landings: " + std::to_string(cases.size()) +
                     " are needed, one for each case");
  if (cases.empty()) return;
  BodyLanding stopped;
  stopped.end = End::kStopped;
  std::fill(landings.begin(), landings.end(), stopped);
  constexpr std::size_t kMinPerThread = 8;  // fewer landings are not worth a thread
  const int workers = std::min(thread_count(threads), int((cases.size() + kMinPerThread - 1) / kMinPerThread));
  std::atomic<std::size_t> next{0};
  parallel_for(workers, workers, [&](int) {
    CaseQueue<BodyBatchCase, BodyLanding> queue(cases, landings, next, options.over);
    run_body_batch(queue, cases[0].scene->robot, options, set);
  });
}

}  // namespace ukemi::landing
