// The batch kernels of one instruction set: compiled once for each, with UKEMI_BATCH_LANES lanes (see CMakeLists.txt).
#if !defined(__x86_64__) || UKEMI_BATCH_LANES == 2
#define UKEMI_BATCH_TARGET
#elif UKEMI_BATCH_LANES == 4
#define UKEMI_BATCH_TARGET [[gnu::target("avx2,fma")]]
#else
#define UKEMI_BATCH_TARGET [[gnu::target("avx512f,avx512dq,avx512vl,avx2,fma,prefer-vector-width=512")]]
#endif

#include "landing/lanes/batch_entry.hpp"

#if defined(__clang__) && UKEMI_BATCH_LANES != 2
// Clang does not inline into a function of another target, and refuses Eigen's alignment of wide packs (3.4): it has
// the baseline alone.
namespace ukemi::landing {

template <>
void run_lanes<UKEMI_BATCH_LANES>(BatchSource& source, const BatchOptions& options) {
  run_lanes<2>(source, options);
}

}  // namespace ukemi::landing
#else
#include "landing/lanes/batch_engine.hpp"
#include "landing/lanes/batch_source.hpp"

namespace ukemi::landing {

template <>
void run_lanes<UKEMI_BATCH_LANES>(BatchSource& source, const BatchOptions& options) {
  if (options.late)
    BatchEngine<kLateTerms, UKEMI_BATCH_LANES>(source, options).run();
  else if (options.extended)
    BatchEngine<kExtendedTerms, UKEMI_BATCH_LANES>(source, options).run();
  else
    BatchEngine<kLimitedTerms, UKEMI_BATCH_LANES>(source, options).run();
}

}  // namespace ukemi::landing
#endif
