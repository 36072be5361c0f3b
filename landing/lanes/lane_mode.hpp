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
template <int W>
void set_lane(LaneSaturation<W>& s, int i, int mode) {
  s.upper.set(i, at_upper(mode)), s.lower.set(i, at_lower(mode));
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
/// One lane of it as a mode, and back.
template <int W>
Contact lane(const LaneContact<W>& c, int i) {
  return !c.below[i] ? Contact::kClear : c.pressed[i] ? Contact::kPressed : Contact::kLoose;
}
template <int W>
void set_lane(LaneContact<W>& c, int i, Contact mode) {
  c.below.set(i, below(mode)), c.pressed.set(i, pressed(mode));
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
void set_lane(LanePhase<W>& p, int i, Phase mode) {
  p.moving.set(i, moving(mode)), p.after.set(i, after(mode));
}

template <int W>
struct ModeOf<Pack<W>> {
  using Contact = LaneContact<W>;
  using Saturation = LaneSaturation<W>;
  using Phase = LanePhase<W>;
};

}  // namespace ukemi::landing
