// The batch kernels of robots of links of one instruction set: compiled once for each, with UKEMI_BATCH_LANES lanes
// (see CMakeLists.txt).
#include "landing/lanes/batch_target.hpp"
#include "landing/lanes/body_batch_entry.hpp"

#ifdef UKEMI_BATCH_BASELINE_ALONE
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
    BodyBatchEngine<kSmall, UKEMI_BATCH_LANES>(source, options).run();
  else
    BodyBatchEngine<kMiddle, UKEMI_BATCH_LANES>(source, options).run();
}

}  // namespace ukemi::landing
#endif
