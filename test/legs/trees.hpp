// Random trees of links, each joint passive without any torque, and states of theirs.
#pragma once

#include "common/random.hpp"
#include "landing/body/body_system.hpp"

namespace legs {

using namespace ukemi;
using namespace ukemi::landing;

using System = BodySystem<kAny>;
using State = System::State;

/// A tree of 2 to `most` links.
inline Robot random_tree(Random& r, int most, Base base) {
  Robot out;
  out.base = base;
  const int links = 2 + int(r.uniform() * (most - 1));
  for (int i = 0; i < links; ++i) {
    const int parent = i == 0 ? -1 : int(r.uniform() * i);
    const auto place = [&] { return Place{r.uniform(-0.1, 0.3), r.uniform(-0.05, 0.05)}; };
    out.links.push_back({"link", parent, place(), r.uniform(0.2, 2), r.uniform(1e-3, 2e-2), place()});
    if (i > 0) out.joints.push_back({.name = "joint", .child = i, .kind = DriveKind::kPassive});
  }
  out.peak = out.links[0].com;
  return out;
}

inline State random_state(Random& r, const Robot& robot) {
  State y = State::Zero();
  const bool rail = robot.base == Base::kRail;
  for (int i = 0; i < int(robot.links.size()); ++i) {
    y[System::kTheta + i] = r.uniform(-3, 3);
    y[System::kOmega + i] = rail && i == 0 ? 0 : r.uniform(-5, 5);
  }
  if (robot.base != Base::kPinned) y[System::kVx] = r.uniform(-2, 2);
  if (robot.base == Base::kFree) y[System::kVy] = r.uniform(-2, 2);
  return y;
}

}  // namespace legs
