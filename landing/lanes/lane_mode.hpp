// The mode of a landing system whose lanes are landings of their own.
#pragma once

#include "common/pack.hpp"
#include "landing/model/landing_system.hpp"

namespace ukemi {

template <int W>
struct LaneSaturation {
  Mask<W> upper, lower;
};
template <int W>
const Mask<W>& at_upper(const LaneSaturation<W>& s) {
  return s.upper;
}
template <int W>
const Mask<W>& at_lower(const LaneSaturation<W>& s) {
  return s.lower;
}

}  // namespace ukemi

namespace ukemi::landing {

template <int W>
struct LaneSlip {
  Mask<W> forward, back;
  void set(int i, int slip) { forward.set(i, slip > 0), back.set(i, slip < 0); }
};
template <int W>
const Mask<W>& slips_forward(const LaneSlip<W>& s) {
  return s.forward;
}
template <int W>
const Mask<W>& slips_back(const LaneSlip<W>& s) {
  return s.back;
}

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
  LaneSaturation<W> saturation{};
  std::array<LaneSlip<W>, kSides> slip{};
  LanePhase<W> phase{};

  /// One lane of it as a mode, and back.
  Mode lane(int i) const {
    Mode m;
    for (std::size_t j = 0; j < kPoints; ++j)
      m.contact[j] = !contact[j].below[i]    ? Contact::kClear
                     : contact[j].pressed[i] ? Contact::kPressed
                                             : Contact::kLoose;
    m.saturation = int(saturation.upper[i]) - int(saturation.lower[i]);
    for (std::size_t j = 0; j < kSides; ++j) m.slip[j] = int(slip[j].forward[i]) - int(slip[j].back[i]);
    m.phase = phase.moving[i] ? Phase::kMoving : phase.after[i] ? Phase::kAfter : Phase::kBefore;
    return m;
  }
  void set_lane(int i, const Mode& m) {
    for (std::size_t j = 0; j < kPoints; ++j)
      contact[j].below.set(i, below(m.contact[j])), contact[j].pressed.set(i, pressed(m.contact[j]));
    saturation.upper.set(i, at_upper(m.saturation)), saturation.lower.set(i, at_lower(m.saturation));
    for (std::size_t j = 0; j < kSides; ++j) slip[j].set(i, m.slip[j]);
    phase.moving.set(i, moving(m.phase)), phase.after.set(i, after(m.phase));
  }
};

template <int W>
struct ModeOf<Pack<W>> {
  using type = LaneMode<W>;
};

}  // namespace ukemi::landing
