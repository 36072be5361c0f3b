// The entry of body_batch_engine.hpp for so many lanes (body_batch_kernel.cpp); private to landing.
#pragma once

#include "landing/body/equations.hpp"
#include "landing/lanes/body_batch.hpp"

namespace ukemi::landing {

/// The kernels that there are.
inline constexpr Capacity kSmallBody{3, 2, 4}, kMiddleBody{5, 4, 7};
inline bool fits(const Robot& robot, const Capacity& c) {
  return robot.links.size() <= std::size_t(c.bodies) && robot.joints.size() <= std::size_t(c.joints) &&
         robot.contacts.size() <= std::size_t(c.contacts);
}

template <int kLanes>
void run_body_lanes(BodyBatchSource& source, bool small, const BodyBatchOptions& options);
template <>
void run_body_lanes<2>(BodyBatchSource& source, bool small, const BodyBatchOptions& options);
template <>
void run_body_lanes<4>(BodyBatchSource& source, bool small, const BodyBatchOptions& options);
template <>
void run_body_lanes<8>(BodyBatchSource& source, bool small, const BodyBatchOptions& options);

}  // namespace ukemi::landing
