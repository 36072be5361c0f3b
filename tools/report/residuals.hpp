// A fit in pictures: every trial on one screen, what the residuals look like, the constants with their intervals.
#pragma once

#include <vector>

#include "identify/trust/prediction.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

/// Force, angle and residual of each trial, one above the other; four trials side by side, twelve at most. Where they
/// were judged, the 95 % band about the residual.
Figure trials_figure(const std::vector<identify::Trial>& trials, const identify::Fit& fit,
                     const identify::Judgement* judged = nullptr);
/// Of the residuals of phi: their autocorrelation, the mean over the trials, and how they are distributed.
std::vector<Figure> residual_figures(const std::vector<identify::Trial>& trials, const identify::Fit& fit);
/// Estimates with their 95 % intervals, in percent of the value: how well each is known. What has no interval is left
/// out.
Figure constants_figure(const std::vector<identify::Estimate>& estimates);

/// Names of all these figures.
std::vector<std::string> fit_figures();

/// The mean product of neighbours `lag` apart over the mean square, of numbers about their mean.
double autocorrelation(const std::vector<double>& values, std::size_t lag);

}  // namespace ukemi::tools
