// How a time budget is spent.
#pragma once

namespace ukemi::landing {

/// A landing at the accuracy that judges takes up to so many times as long as one of the search.
inline constexpr double kTightLanding = 3;
/// How much of a time budget is kept back to verify what was found, where one landing of the search takes `landing`; at
/// most 0.45 of it [s].
double verification_time(double budget, double landing);
/// Throws InputError unless it is above 0 [s].
void check_deadline(double deadline);

}  // namespace ukemi::landing
