// The batch kernels of robots of links of one instruction set: compiled once for each, with UKEMI_BATCH_LANES lanes
// (see CMakeLists.txt).
#include "landing/lanes/batch_target.hpp"
#include "landing/lanes/body_batch_entry.hpp"
#ifndef UKEMI_BATCH_BASELINE_ALONE
#include "landing/lanes/body_batch_engine.hpp"
#endif

namespace ukemi::landing {

#ifdef UKEMI_BATCH_BASELINE_ALONE  // in the file of two lanes
extern template void run_body_lanes<kPlainPair, 2>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
extern template void run_body_lanes<kStraightPair, 2>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
extern template void run_body_lanes<kPair, 2>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
extern template void run_body_lanes<kPlainTriple, 2>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
extern template void run_body_lanes<kStraightTriple, 2>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
extern template void run_body_lanes<kTriple, 2>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
extern template void run_body_lanes<kQuad, 2>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
extern template void run_body_lanes<kMiddle, 2>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
extern template void run_body_lanes<kLateLeg, 2>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
#endif

template <Capacity kSize, int kLanes>
void run_body_lanes(BodyBatchSource& source, const Robot& robot, const BodyBatchOptions& options) {
#ifdef UKEMI_BATCH_BASELINE_ALONE
  run_body_lanes<kSize, 2>(source, robot, options);
#else
  BodyBatchEngine<kSize, kLanes>(source, robot, options).run();
#endif
}

template void run_body_lanes<kPlainPair, UKEMI_BATCH_LANES>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
template void run_body_lanes<kStraightPair, UKEMI_BATCH_LANES>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
template void run_body_lanes<kPlainTriple, UKEMI_BATCH_LANES>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
template void run_body_lanes<kStraightTriple, UKEMI_BATCH_LANES>(BodyBatchSource&, const Robot&,
                                                                 const BodyBatchOptions&);
#if UKEMI_BATCH_LANES != 8  // the others: run_body_batch
template void run_body_lanes<kPair, UKEMI_BATCH_LANES>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
template void run_body_lanes<kTriple, UKEMI_BATCH_LANES>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
template void run_body_lanes<kQuad, UKEMI_BATCH_LANES>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
template void run_body_lanes<kMiddle, UKEMI_BATCH_LANES>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
template void run_body_lanes<kLateLeg, UKEMI_BATCH_LANES>(BodyBatchSource&, const Robot&, const BodyBatchOptions&);
#endif

}  // namespace ukemi::landing
