// The fit of one set of trials as a least-squares problem: which parameter is which, and a residual block a trial.
#pragma once

#include <vector>

#include "identify/fit.hpp"
#include "identify/least_squares.hpp"
#include "identify/starts.hpp"

namespace ukemi::identify {

inline bool fitted(NuisanceTerms::Term t) { return t == NuisanceTerms::Term::kFitted; }

/// Which parameter of the problem is which.
struct Layout {
  std::vector<int> constants;  ///< global g is constant constants[g]; friction comes after them
  bool friction, initial_angle, initial_rate;

  explicit Layout(const FitOptions& o)
      : friction(fitted(o.nuisance.friction)),
        initial_angle(fitted(o.nuisance.initial_angle)),
        initial_rate(fitted(o.nuisance.initial_rate)) {
    for (int i = 0; i < kConstants; ++i)
      if (o.free[std::size_t(i)]) constants.push_back(i);
  }
  int globals() const { return int(constants.size()) + friction; }
  int locals() const { return int(initial_angle) + int(initial_rate); }

  /// Puts a point of the problem into the model; `lift(value, slot)` makes the scalar of derivative slot `slot`.
  template <class T, class Lift>
  void apply(const double* global, const double* local, SeaParameters<T>& sea, InitialState<T>& initial,
             Lift&& lift) const {
    auto u = ukemi::constants(sea);
    int slot = 0;
    for (const int c : constants) u[std::size_t(c)] = lift(global[slot], slot), ++slot;
    set_constants(sea, u);
    if (friction) sea.friction = lift(global[slot], slot), ++slot;
    if (initial_angle) initial.angle = lift(local[0], slot), ++slot;
    if (initial_rate) initial.rate = lift(local[initial_angle], slot);
  }
};

/// Residuals predicted minus measured, phi then phi_motor, times the trial's weight; parameters start at `start` (at a
/// tenth of a typical size where it is 0) and are scaled by it. `prepared` and `rig` must outlive the problem.
LeastSquaresProblem make_problem(const Rig& rig, const std::vector<PreparedTrial>& prepared,
                                 const std::vector<double>& weights, const SeaParameters<double>& start,
                                 const Suggestion& suggestion, const Layout& layout, const FitOptions& options,
                                 const RolloutOptions& rollout_options);

}  // namespace ukemi::identify
