#include "landing/lanes/batch.hpp"

#include <algorithm>
#include <atomic>
#include <map>
#include <utility>
#include <vector>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/parallel.hpp"
#include "common/sea.hpp"
#include "landing/body/by_links.hpp"
#include "landing/lanes/batch_source.hpp"
#include "landing/lanes/body_batch.hpp"

namespace ukemi::landing {

InstructionSet widest_instruction_set() {
#if defined(__x86_64__) && !defined(__clang__)  // see batch_target.hpp
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

namespace {

/// Supplies landings of the paper's robot as landings of a robot of links.
class AsLinks : public BodyBatchSource {
 public:
  AsLinks(BatchSource& source, const Limits& limits) : source_(source), limits_(limits) {}
  bool next(int lane, BodyBatchCase& c) override {
    BatchCase next;
    if (!source_.next(lane, next)) return false;
    TwoLinkLanding& landing = reused_landing(lane);
    if (std::exchange(scene_[std::size_t(lane)], next.scene) != next.scene) {
      landing.set_scene(*next.scene);
      landing.set_limits(limits_);
    }
    landing.set_drive(*next.sea, next.motion);
    c = {&landing.scene, &landing.motion, next.abandon_above};
    return true;
  }
  void done(int lane, const BodyLanding& landing) override {
    source_.done(lane, reused_landing(lane).outcome(landing));
  }
  bool over() override { return source_.over(); }

 private:
  BatchSource& source_;
  const Limits& limits_;
  std::array<const Scene*, kMaxLanes> scene_{};  ///< of the lane's last landing
};

}  // namespace

void run_batch(BatchSource& source, const Scene& scene, const SeaParameters<double>& drive, const BatchOptions& options,
               InstructionSet set) {
  AsLinks links(source, options.limits);
  TwoLinkLanding& alike = reused_landing(kMaxLanes);
  alike.set_scene(scene), alike.set_drive(drive, Motion{});
  const bool fails = options.on_max_steps == BatchOptions::OnMaxSteps::kFail;
  run_body_batch(links, alike.scene.robot,
                 {.accuracy = options.accuracy, .max_steps = fails ? options.max_steps : SimulateOptions{}.max_steps},
                 set);
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

/// What the landings in lanes must have in common: the terms of their drives, and which points may touch.
int structure_of(const BatchCase& c) {
  const SeaParameters<double>& sea = *c.sea;
  int out = 0;
  for (const bool term :
       std::initializer_list<bool>{bool(is_late(sea)), is_extended(sea), sea.output_friction != 0,
                                   sea.friction != 0 || sea.spring_loss != 0, sea.feedback == Feedback::kMotor,
                                   c.scene->contacts[kHip], c.scene->contacts[kKnee], c.scene->contacts[kFoot]})
    out = 2 * out + term;
  return out;
}

/// The peaks of cases of one structure.
void peaks_of_alike(std::span<const BatchCase> cases, std::span<LandingPeak> peaks, const BatchOptions& options,
                    int threads, InstructionSet set) {
  constexpr std::size_t kMinPerThread = 24;  // fewer landings are not worth a thread
  const int workers = std::min(thread_count(threads), int((cases.size() + kMinPerThread - 1) / kMinPerThread));
  std::atomic<std::size_t> next{0};
  parallel_for(workers, workers, [&](int) {
    CaseQueue<BatchCase, LandingPeak> queue(cases, peaks, next, options.over);
    run_batch(queue, *cases[0].scene, *cases[0].sea, options, set);
  });
}

}  // namespace

void batch_peaks(std::span<const BatchCase> cases, std::span<LandingPeak> peaks, const BatchOptions& options,
                 int threads, InstructionSet set) {
  options.validate(), validate_all(cases);
  if (peaks.size() != cases.size())
    throw InputError("batch: " + std::to_string(peaks.size()) + " peaks: " + std::to_string(cases.size()) +
                     " are needed, one for each case");
  LandingPeak stopped;
  stopped.end = End::kStopped;
  std::fill(peaks.begin(), peaks.end(), stopped);
  if (cases.empty()) return;
  if (std::all_of(cases.begin(), cases.end(),
                  [of_all = structure_of(cases[0])](const BatchCase& c) { return structure_of(c) == of_all; }))
    return peaks_of_alike(cases, peaks, options, threads, set);
  std::map<int, std::vector<std::size_t>> groups;  // so that no result depends on other cases
  for (std::size_t i = 0; i < cases.size(); ++i) groups[structure_of(cases[i])].push_back(i);
  for (const auto& [structure, group] : groups) {
    std::vector<BatchCase> alike;
    for (const std::size_t i : group) alike.push_back(cases[i]);
    std::vector<LandingPeak> found(group.size(), stopped);
    peaks_of_alike(alike, found, options, threads, set);
    for (std::size_t k = 0; k < group.size(); ++k) peaks[group[k]] = found[k];
  }
}

}  // namespace ukemi::landing
