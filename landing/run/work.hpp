// The cost of landings, counted in steps and not timed: a bound of it is the same on every machine and every day.
#pragma once

#include <limits>

#include "common/integrate/counters.hpp"

namespace ukemi::landing {

/// Steps, and what cost as much as steps: an event, whose zero is searched, counts 3, a Jacobian 10. One costs 0.5 to
/// 1 us of a core in doubles, a tenth of that in lanes. An ordinary landing takes some 300 at 1e-6.
inline long work_of(const integrate::Counters& c) { return c.steps + c.rejected + 3 * c.events + 10 * c.jacobians; }

inline constexpr long kUnbounded = std::numeric_limits<long>::max();
/// What a check may take, whatever the scene: seconds, where every landing needs the scalar path.
inline constexpr long kCheckWork = 2'000'000;

}  // namespace ukemi::landing
