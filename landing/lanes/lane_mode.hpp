// The mode of a landing system with a separate landing in each lane.
#pragma once

#include "common/pack.hpp"
#include "landing/model/landing_system.hpp"

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
struct LaneContact {
  Mask<W> below, pressed;
};
template <int W>
const Mask<W>& below(const LaneContact<W>& c) {
  return c.below;
}
template <int W>
const Mask<W>& pressed(const LaneContact<W>& c) {
  return c.pressed;
}

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

template <int W>
struct LaneMode {
  std::array<LaneContact<W>, kPoints> contact{};
  LaneSign<W> saturation{};
  std::array<LaneSign<W>, kSides> slip{};
  LanePhase<W> phase{};

  /// The mode of lane i.
  Mode lane(int i) const {
    Mode m;
    for (std::size_t j = 0; j < kPoints; ++j)
      m.contact[j] = !contact[j].below[i]    ? Contact::kClear
                     : contact[j].pressed[i] ? Contact::kPressed
                                             : Contact::kLoose;
    m.saturation = saturation[i];
    for (std::size_t j = 0; j < kSides; ++j) m.slip[j] = slip[j][i];
    m.phase = phase.moving[i] ? Phase::kMoving : phase.after[i] ? Phase::kAfter : Phase::kBefore;
    return m;
  }
  void set_lane(int i, const Mode& m) {
    for (std::size_t j = 0; j < kPoints; ++j)
      contact[j].below.set(i, below(m.contact[j])), contact[j].pressed.set(i, pressed(m.contact[j]));
    saturation.set(i, m.saturation);
    for (std::size_t j = 0; j < kSides; ++j) slip[j].set(i, m.slip[j]);
    phase.moving.set(i, moving(m.phase)), phase.after.set(i, after(m.phase));
  }
};

template <int W>
struct ModeOf<Pack<W>> {
  using type = LaneMode<W>;
};

}  // namespace ukemi::landing
