// The entry of body_batch_engine.hpp for so many lanes (body_batch_kernel.cpp); private to landing.
#pragma once

#include "landing/body/equations.hpp"
#include "landing/lanes/body_batch.hpp"

namespace ukemi::landing {

template <int kLanes>
void run_body_lanes(BodyBatchSource& source, bool small, const BodyBatchOptions& options);
template <>
void run_body_lanes<2>(BodyBatchSource& source, bool small, const BodyBatchOptions& options);
template <>
void run_body_lanes<4>(BodyBatchSource& source, bool small, const BodyBatchOptions& options);
template <>
void run_body_lanes<8>(BodyBatchSource& source, bool small, const BodyBatchOptions& options);

}  // namespace ukemi::landing
