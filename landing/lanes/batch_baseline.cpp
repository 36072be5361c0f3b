// The batch kernels of any machine.
#define UKEMI_BATCH_TARGET

#include "landing/lanes/batch_engine.hpp"
#include "landing/lanes/batch_entry.hpp"

namespace ukemi::landing {

void run_batch_baseline(BatchSource& source, const BatchOptions& options) {
  if (options.extended)
    BatchEngine<LandingTerms(SeaTerms{true, true}), 2>(source, options).run();
  else
    BatchEngine<LandingTerms(SeaTerms{true, false}), 2>(source, options).run();
}

}  // namespace ukemi::landing
