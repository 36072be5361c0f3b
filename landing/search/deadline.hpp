// How a time budget is spent.
#pragma once

namespace ukemi::landing {

/// Cost of a landing at the accuracy of the answer relative to one of the search, at most [1].
inline constexpr double kTightCost = 3;
/// The part of a time budget that is reserved for verification, where a landing of the search takes `landing`; at most
/// 0.45 of it [s].
double verification_time(double budget, double landing);
/// Throws InputError unless it is above 0 [s].
void check_deadline(double deadline);

}  // namespace ukemi::landing
