// The batch kernels of one instruction set: compiled once for each, with UKEMI_BATCH_LANES lanes (see CMakeLists.txt).
#include "landing/lanes/batch_entry.hpp"
#include "landing/lanes/batch_target.hpp"

#ifdef UKEMI_BATCH_BASELINE_ALONE
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
