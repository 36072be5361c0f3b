// The batch kernels with AVX-512.
#if defined(__x86_64__)
#define UKEMI_BATCH_TARGET [[gnu::target("avx512f,avx512dq,avx512vl,avx2,fma,prefer-vector-width=512")]]
#else
#define UKEMI_BATCH_TARGET
#endif

#include "landing/lanes/batch_engine.hpp"
#include "landing/lanes/batch_entry.hpp"

namespace ukemi::landing {

void run_batch_avx512(BatchSource& source, const BatchOptions& options) {
  if (options.extended)
    BatchEngine<LandingTerms(SeaTerms{true, true}), 8>(source, options).run();
  else
    BatchEngine<LandingTerms(SeaTerms{true, false}), 8>(source, options).run();
}

}  // namespace ukemi::landing
