#include "landing/batch.hpp"

#include "common/error.hpp"
#include "common/parallel.hpp"
#include "landing/batch_entry.hpp"

namespace ukemi::landing {

InstructionSet widest_instruction_set() {
#if defined(__x86_64__)
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

void run_batch(BatchSource& source, const BatchOptions& options, InstructionSet set) {
  switch (std::min(set, widest_instruction_set())) {
    case InstructionSet::kAvx512:
      return run_batch_avx512(source, options);
    case InstructionSet::kAvx2:
      return run_batch_avx2(source, options);
    case InstructionSet::kBaseline:
      return run_batch_baseline(source, options);
  }
}

namespace {
/// The cases in order, to whichever lane is free.
class Queue : public BatchSource {
 public:
  Queue(std::span<const BatchCase> cases, std::span<LandingPeak> peaks) : cases_(cases), peaks_(peaks) {}
  bool next(int lane, BatchCase& c) override {
    if (next_ == cases_.size()) return false;
    c = cases_[in_lane_[lane] = next_++];
    return true;
  }
  void done(int lane, const LandingPeak& peak) override { peaks_[in_lane_[lane]] = peak; }

 private:
  std::span<const BatchCase> cases_;
  std::span<LandingPeak> peaks_;
  std::size_t next_ = 0;
  std::array<std::size_t, lanes(InstructionSet::kAvx512)> in_lane_{};
};
}  // namespace

void batch_peaks(std::span<const BatchCase> cases, std::span<LandingPeak> peaks, const BatchOptions& options,
                 int threads, InstructionSet set) {
  BatchOptions o = options;
  for (const BatchCase& c : cases) o.extended = o.extended || is_extended(*c.sea);
  constexpr std::size_t kChunk = 256;
  const int chunks = int((cases.size() + kChunk - 1) / kChunk);
  parallel_for(chunks, threads, [&](int i) {
    const std::size_t first = std::size_t(i) * kChunk, n = std::min(kChunk, cases.size() - first);
    Queue queue(cases.subspan(first, n), peaks.subspan(first, n));
    run_batch(queue, o, set);
  });
}

}  // namespace ukemi::landing
