// Entry points of body_batch_engine.hpp by number of lanes (body_batch_kernel.cpp); private to landing.
#pragma once

#include "landing/body/body_kernel.hpp"
#include "landing/body/equations.hpp"
#include "landing/lanes/body_batch.hpp"

namespace ukemi::landing {

/// See run_body_batch; `robot` fits the kernel. Instantiated in body_batch_kernel.cpp for every kernel of lanes.
template <Capacity kSize, int kLanes>
void run_body_lanes(BodyBatchSource& source, const Robot& robot, const BodyBatchOptions& options);

}  // namespace ukemi::landing
