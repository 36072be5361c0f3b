// Entry points of batch_engine.hpp by number of lanes (batch_kernel.cpp); private to landing.
#pragma once

#include "landing/lanes/batch.hpp"
#include "landing/lanes/batch_source.hpp"

namespace ukemi::landing {

template <int kLanes>
void run_lanes(BatchSource& source, const BatchOptions& options);
template <>
void run_lanes<2>(BatchSource& source, const BatchOptions& options);
template <>
void run_lanes<4>(BatchSource& source, const BatchOptions& options);
template <>
void run_lanes<8>(BatchSource& source, const BatchOptions& options);

}  // namespace ukemi::landing
