// The batch kernels with AVX2.
#if defined(__x86_64__)
#define UKEMI_BATCH_TARGET [[gnu::target("avx2,fma")]]
#else
#define UKEMI_BATCH_TARGET
#endif

#include "landing/lanes/batch_engine.hpp"
#include "landing/lanes/batch_entry.hpp"

namespace ukemi::landing {

void run_batch_avx2(BatchSource& source, const BatchOptions& options) {
  if (options.extended)
    BatchEngine<LandingTerms(SeaTerms{true, true}), 4>(source, options).run();
  else
    BatchEngine<LandingTerms(SeaTerms{true, false}), 4>(source, options).run();
}

}  // namespace ukemi::landing
