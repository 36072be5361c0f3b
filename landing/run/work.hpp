// The cost of landings, counted in steps instead of time: budgets are reproducible on every machine.
#pragma once

#include <limits>

#include "common/integrate/counters.hpp"

namespace ukemi::landing {

/// Work in equivalent steps: an event, whose zero is located, counts 3, a Jacobian 10. A step takes 0.5 to 1 us of a
/// core in doubles, a tenth of that in lanes. A typical landing takes 300 at 1e-6.
inline long work_of(const integrate::Counters& c) { return c.steps + c.rejected + 3 * c.events + 10 * c.jacobians; }

inline constexpr long kUnbounded = std::numeric_limits<long>::max();
/// Budget of a check: seconds if every landing needs the scalar path.
inline constexpr long kCheckWork = 2'000'000;

}  // namespace ukemi::landing
