// The fit of one set of trials as a least-squares problem: a residual block a trial, with its derivatives.
#pragma once

#include <vector>

#include "identify/estimate/least_squares.hpp"
#include "identify/fit/fit.hpp"
#include "identify/fit/rig_terms.hpp"
#include "identify/fit/starts.hpp"
#include "identify/fit/weighting.hpp"

namespace ukemi::identify {

/// Residuals predicted minus measured, phi, phi_motor, then torque by angle_per_torque, by each trial's weighting;
/// parameters start at `start` and are scaled by it, see RigTerm::column. A prior's standard deviation weighs as much
/// as the logs' own noise. `rig`, `prepared`, `weights` and the layout's terms must outlive the problem.
LeastSquaresProblem make_problem(const Rig& rig, const std::vector<PreparedTrial>& prepared,
                                 const std::vector<Weighting>& weights, const SeaParameters<double>& start,
                                 const Suggestion& suggestion, const RigLayout& layout, const FitOptions& options,
                                 const RolloutOptions& rollout_options);

}  // namespace ukemi::identify
