// Figures of a fit: its trials, the residuals, the constants with their intervals.
#pragma once

#include <vector>

#include "identify/trust/prediction.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

/// Force, angle and residual of each trial in a column; four columns a row, at most twelve trials. With `judged` the
/// 95 % band about the residual.
Figure trials_figure(const std::vector<identify::Trial>& trials, const identify::Fit& fit,
                     const identify::Judgement* judged = nullptr);
/// Residuals of phi: autocorrelation, averaged over the trials, and histogram.
std::vector<Figure> residual_figures(const std::vector<identify::Trial>& trials, const identify::Fit& fit);
/// 95 % intervals of the estimates relative to their values [%]; an estimate without an interval is left out.
Figure constants_figure(const std::vector<identify::Estimate>& estimates);

/// Names of these figures.
std::vector<std::string> fit_figures();

/// sum_i d_i d_{i+lag} / sum_i d_i^2 of the deviations d from the mean; NaN for too few values.
double autocorrelation(const std::vector<double>& values, std::size_t lag);

}  // namespace ukemi::tools
