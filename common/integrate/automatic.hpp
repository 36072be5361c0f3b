// Automatic switching between an explicit and an implicit method, while the run goes.
#pragma once

#include "common/integrate/rosenbrock.hpp"
#include "common/integrate/tableaus.hpp"

namespace ukemi::integrate {

/// Takes `Explicit` steps until stability, not accuracy, bounds them, then `Implicit` ones until those no
/// longer pay.
///
/// The measure while explicit is |h lambda| of the last two stages, which is free (Hairer, Wanner, IV.2): it switches
/// after kStiffSteps steps beyond the method's stability boundary with less than kNonstiffSteps in a row within it.
/// While implicit, the longest stable explicit step is boundary / rho, rho the spectral radius of the Jacobian (one
/// power iteration a step). An implicit step pays where it is kImplicitCost times as long. If kTrialSteps do not before
/// one does, it switches back and doubles kStiffSteps the next time; once one has, kReturnSteps in a row must not pay.
template <class ExplicitMethod, class ImplicitMethod>
struct Automatic {
  using Explicit = ExplicitMethod;
  using Implicit = ImplicitMethod;
  static constexpr int kOrder = std::min(Explicit::kOrder, Implicit::kOrder);
  static constexpr int kStiffSteps = 100, kNonstiffSteps = 6, kTrialSteps = 3, kReturnSteps = 20;
  static constexpr double kImplicitCost = 10;  ///< of an implicit step, in explicit ones
};

/// The methods of landings, for accuracies of 1e-7 and looser, and for finer ones.
using LowOrder = Automatic<DormandPrince54, Rodas5P>;
using HighOrder = Automatic<DormandPrince853, Rodas5P>;

template <class Method, int N, int kCoupled>
class AutomaticStep : public Step<typename Method::Explicit, double, N> {
  using Base = Step<typename Method::Explicit, double, N>;
  using Explicit = typename Method::Explicit;
  using Implicit = typename Method::Implicit;

 public:
  using State = typename Base::State;

  bool implicit() const { return implicit_; }
  void invalidate() { stages_.invalidate(); }
  int error_order() const { return implicit_ ? Implicit::kErrorOrder : Explicit::kErrorOrder; }

  template <class F>
  void advance(F&& f) {
    was_implicit_ = implicit_;
    if (!implicit_) return Base::advance(f);
    this->compute();
    stages_.advance(*this, f);
  }
  template <int kControlled>
  double error(const Tolerance<kControlled>& tolerance) const {
    return implicit_ ? error_size(stages_.error(), this->y, this->y_end, tolerance) : Base::error(tolerance);
  }
  template <class F>
  void prepare_dense(F&& f) {
    was_implicit_ ? stages_.prepare_dense() : Base::prepare_dense(f);
  }
  State at(double s) const {
    if (!was_implicit_) return Base::at(s);
    const auto point = this->point_at(s);
    return this->extrapolated(stages_.at(this->y, this->computed_end(), point.fraction), point.excess);
  }
  double component_at(int index, double s) const { return was_implicit_ ? at(s)[index] : Base::component_at(index, s); }

  /// After a whole accepted step: which method takes the next one, and its length.
  double choose(double h_next) {
    if (!implicit_) {
      if (Base::stiffness(kCoupled) > Explicit::kStabilityBoundary) {
        nonstiff_ = 0;
        if (++stiff_ >= stiff_limit_) implicit_ = true, stiff_ = costly_ = 0, paid_off_ = false;
      } else if (++nonstiff_ >= Method::kNonstiffSteps) {
        stiff_ = 0;
      }
      return h_next;
    }
    const double stable = Explicit::kStabilityBoundary / stages_.spectral_radius();
    if (this->h >= Method::kImplicitCost * stable) {
      costly_ = 0, paid_off_ = true, stiff_limit_ = Method::kStiffSteps;
    } else if (h_next < kGrowing * this->h && ++costly_ >= (paid_off_ ? Method::kReturnSteps : Method::kTrialSteps)) {
      implicit_ = false, nonstiff_ = 0;
      if (!paid_off_) stiff_limit_ = std::min(2 * stiff_limit_, 16 * Method::kStiffSteps);
      return std::min(h_next, stable);
    }
    return h_next;
  }

 private:
  static constexpr double kGrowing = 1.5;  ///< a step whose next one is longer by this factor is not judged
  RosenbrockStages<Implicit, N, kCoupled> stages_;
  bool implicit_ = false, was_implicit_ = false, paid_off_ = false;
  int stiff_ = 0, nonstiff_ = 0, costly_ = 0, stiff_limit_ = Method::kStiffSteps;
};

template <class E, class I, int N, int kCoupled>
struct StepOf<Automatic<E, I>, double, N, kCoupled> {
  using type = AutomaticStep<Automatic<E, I>, N, kCoupled>;
};

}  // namespace ukemi::integrate
