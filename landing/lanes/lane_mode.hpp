// Signs and phases that differ by lane.
#pragma once

#include "common/pack.hpp"

namespace ukemi {

/// A sign for every lane: the side of a torque limit, or the direction of a slip.
template <int W>
struct LaneSign {
  Mask<W> positive, negative;
  int operator[](int i) const { return int(positive[i]) - int(negative[i]); }
  void set(int i, int sign) { positive.set(i, sign > 0), negative.set(i, sign < 0); }
};
template <int W>
const Mask<W>& at_upper(const LaneSign<W>& saturation) {
  return saturation.positive;
}
template <int W>
const Mask<W>& at_lower(const LaneSign<W>& saturation) {
  return saturation.negative;
}
template <int W>
const Mask<W>& slips_forward(const LaneSign<W>& slip) {
  return slip.positive;
}
template <int W>
const Mask<W>& slips_back(const LaneSign<W>& slip) {
  return slip.negative;
}

}  // namespace ukemi

namespace ukemi::landing {

template <int W>
struct LanePhase {
  Mask<W> moving, after;
};
template <int W>
const Mask<W>& moving(const LanePhase<W>& p) {
  return p.moving;
}
template <int W>
const Mask<W>& after(const LanePhase<W>& p) {
  return p.after;
}

}  // namespace ukemi::landing
