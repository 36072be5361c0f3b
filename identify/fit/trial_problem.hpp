// The fit of one set of trials as a least-squares problem: which parameter is which, and a residual block a trial.
#pragma once

#include <vector>

#include "identify/fit/fit.hpp"
#include "identify/fit/least_squares.hpp"
#include "identify/fit/starts.hpp"

namespace ukemi::identify {

/// Which parameter of the problem is which. First the free constants, then the terms that all trials share, then those
/// that each trial has of its own.
struct Layout {
  std::vector<int> constants;          ///< global g is constant constants[g]
  std::vector<NuisanceTerm> shared;    ///< the globals behind them
  std::vector<NuisanceTerm> of_trial;  ///< the locals

  explicit Layout(const FitOptions& o) {
    for (int i = 0; i < kConstants; ++i)
      if (o.free[std::size_t(i)]) constants.push_back(i);
    for (const NuisanceTerm t : o.nuisance) (is_shared(t) ? shared : of_trial).push_back(t);
  }
  int globals() const { return int(constants.size() + shared.size()); }
  int locals() const { return int(of_trial.size()); }

  /// Puts a point of the problem into the model; `lift(value, slot)` makes the scalar of derivative slot `slot`.
  template <class T, class Lift>
  void apply(const double* global, const double* local, SeaParameters<T>& sea, Nuisance<T>& nuisance,
             Lift&& lift) const {
    auto u = ukemi::constants(sea);
    int slot = 0;
    for (const int c : constants) u[std::size_t(c)] = lift(global[slot], slot), ++slot;
    set_constants(sea, u);
    for (const NuisanceTerm t : shared) place(t, sea, nuisance) = lift(global[slot], slot), ++slot;
    for (std::size_t i = 0; i < of_trial.size(); ++i, ++slot) place(of_trial[i], sea, nuisance) = lift(local[i], slot);
  }

 private:
  template <class T>
  static T& place(NuisanceTerm t, SeaParameters<T>& sea, Nuisance<T>& n) {
    switch (t) {
      case NuisanceTerm::kFriction:
        return sea.friction;
      case NuisanceTerm::kViscous:
        return sea.viscous;
      case NuisanceTerm::kStiffening:
        return sea.k_sea_cubic;
      case NuisanceTerm::kForceGain:
        return n.force_gain;
      case NuisanceTerm::kInitialAngle:
        return n.angle;
      case NuisanceTerm::kInitialRate:
        return n.rate;
      case NuisanceTerm::kForceBias:
        return n.force_bias;
      case NuisanceTerm::kTimeShift:
        return n.time_shift;
      case NuisanceTerm::kEncoderOffset:
        break;
    }
    return n.encoder_offset;
  }
};

/// Residuals predicted minus measured, phi then phi_motor, as each trial's weighting has them; parameters start at
/// `start` (at a tenth of a typical size where it is 0) and are scaled by it. A prior's standard deviation weighs as
/// much as the logs' own noise. `rig`, `prepared` and `weights` must outlive the problem.
LeastSquaresProblem make_problem(const Rig& rig, const std::vector<PreparedTrial>& prepared,
                                 const std::vector<Weighting>& weights, const SeaParameters<double>& start,
                                 const Suggestion& suggestion, const Layout& layout, const FitOptions& options,
                                 const RolloutOptions& rollout_options);

}  // namespace ukemi::identify
