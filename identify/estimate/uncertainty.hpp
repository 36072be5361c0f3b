// How far the result of a least-squares fit can be relied on: standard errors, 95 % intervals, a verdict for each
// constant, and the direction in which the data say least.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/estimate/estimate.hpp"
#include "identify/estimate/least_squares.hpp"

namespace ukemi::identify {

/// The estimate of a parameter; at_bound where the value is at a bound.
[[nodiscard]] Estimate estimate_of(const Parameter& parameter, double value, double variance, double half_width,
                                   int trial = -1);
/// Sets standard error and 95 % interval from the total variance and the noise's part of it; none where it is NaN.
void set_error(Estimate& e, double variance, double noise_variance, double half_width);

/// The verdict by the widths above.
[[nodiscard]] Identifiability judge(const Estimate& e);

/// Where the residual is far above the noise the model does not explain the logs, and its error bars mean little:
/// what was trusted is weak.
void distrust(std::vector<Estimate>& parameters);

/// The weakest combination, of a solution whose residuals have this variance; `sizes` are those of the constants, its
/// first globals. None where fewer than two are off their bounds. The step is `half_width` standard errors along it.
[[nodiscard]] std::optional<Weakest> weakest_of(const LeastSquaresSolution& solution,
                                                const LeastSquaresProblem& problem, const std::vector<double>& sizes,
                                                double variance, double half_width);

}  // namespace ukemi::identify
