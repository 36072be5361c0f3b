// The batch kernels of robots of links of one instruction set: compiled once for each, with UKEMI_BATCH_LANES lanes
// (see CMakeLists.txt).
#if !defined(__x86_64__) || UKEMI_BATCH_LANES == 2
#define UKEMI_BATCH_TARGET
#elif UKEMI_BATCH_LANES == 4
#define UKEMI_BATCH_TARGET [[gnu::target("avx2,fma")]]
#else
#define UKEMI_BATCH_TARGET [[gnu::target("avx512f,avx512dq,avx512vl,avx2,fma,prefer-vector-width=512")]]
#endif

#include "landing/lanes/body_batch_entry.hpp"

#if defined(__clang__) && UKEMI_BATCH_LANES != 2
// Clang does not inline into a function of another target, and refuses Eigen's alignment of wide packs (3.4): it has
// the baseline alone.
namespace ukemi::landing {

template <>
void run_body_lanes<UKEMI_BATCH_LANES>(BodyBatchSource& source, bool small, const BodyBatchOptions& options) {
  run_body_lanes<2>(source, small, options);
}

}  // namespace ukemi::landing
#else
#include "landing/lanes/body_batch_engine.hpp"

namespace ukemi::landing {

template <>
void run_body_lanes<UKEMI_BATCH_LANES>(BodyBatchSource& source, bool small, const BodyBatchOptions& options) {
  if (small)
    BodyBatchEngine<kSmallBody, UKEMI_BATCH_LANES>(source, options).run();
  else
    BodyBatchEngine<kMiddleBody, UKEMI_BATCH_LANES>(source, options).run();
}

}  // namespace ukemi::landing
#endif
