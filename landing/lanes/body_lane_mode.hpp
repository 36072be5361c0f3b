// The mode of robots of links with a separate landing in each lane.
#pragma once

#include "landing/body/body_system.hpp"
#include "landing/lanes/lane_mode.hpp"

namespace ukemi::landing {

template <int W>
struct LanePoint {
  Mask<W> touching, pad, below, floor, forward, back;
};
template <int W>
const Mask<W>& slides_forward(const LanePoint<W>& m) {
  return m.forward;
}
template <int W>
const Mask<W>& slides_back(const LanePoint<W>& m) {
  return m.back;
}

template <int W>
struct LaneJoint {
  LaneSign<W> saturation;
  std::array<LaneSign<W>, kSides> slip;
  LanePhase<W> phase;
};

template <Capacity kSize, int W>
struct BodyLaneMode {
  std::array<LanePoint<W>, kSize.contacts> contact{};
  std::array<LaneJoint<W>, kSize.joints> joint{};
  LaneSign<W> rail_slip{};

  void set_lane(int i, const BodyMode<kSize>& m) {
    for (std::size_t k = 0; k < contact.size(); ++k) {
      LanePoint<W>& p = contact[k];
      const PointMode& from = m.contact[k];
      p.touching.set(i, from.touching), p.pad.set(i, from.pad), p.below.set(i, from.below);
      p.floor.set(i, from.floor), p.forward.set(i, slides_forward(from)), p.back.set(i, slides_back(from));
    }
    for (std::size_t k = 0; k < joint.size(); ++k) {
      LaneJoint<W>& j = joint[k];
      const JointMode& from = m.joint[k];
      j.saturation.set(i, from.saturation);
      for (std::size_t side = 0; side < kSides; ++side) j.slip[side].set(i, from.slip[side]);
      j.phase.moving.set(i, moving(from.phase)), j.phase.after.set(i, after(from.phase));
    }
    rail_slip.set(i, m.rail_slip);
  }
};

template <Capacity kSize, int W>
struct BodyModeOf<kSize, Pack<W>> {
  using type = BodyLaneMode<kSize, W>;
};

}  // namespace ukemi::landing
