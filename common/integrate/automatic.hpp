// Explicit where it can be, implicit where it pays: chosen phase by phase while the run goes.
#pragma once

#include "common/integrate/rosenbrock.hpp"

namespace ukemi::integrate {

/// Takes `Explicit` steps until stability, not accuracy, bounds them, then `Implicit` ones until those are no longer
/// worth their price.
///
/// The measure while explicit is |h lambda| of the last two stages, which is free (Hairer, Wanner, IV.2): kPatience
/// steps beyond the method's stability boundary with less than kForget in a row inside it, and it changes over. While
/// implicit, the spectral radius rho of the Jacobian at hand (a power iteration a step) says which explicit step would
/// be stable, boundary / rho. An implicit step pays where it is kPrice times as long. If kTrial do not before one does,
/// it changes back and waits twice as long the next time; once one has, it takes kRegret in a row that do not.
template <class ExplicitMethod, class ImplicitMethod>
struct Automatic {
  using Explicit = ExplicitMethod;
  using Implicit = ImplicitMethod;
  static constexpr int kOrder = std::min(Explicit::kOrder, Implicit::kOrder);
  static constexpr int kPatience = 100, kForget = 6, kTrial = 3, kRegret = 20;
  static constexpr double kPrice = 10;  ///< an implicit step costs about as much as this many explicit ones
};

template <class Method, int N, int kCoupled>
class AutomaticStep : public Step<typename Method::Explicit, double, N> {
  using Base = Step<typename Method::Explicit, double, N>;
  using Explicit = typename Method::Explicit;
  using Implicit = typename Method::Implicit;

 public:
  using State = typename Base::State;

  bool implicit() const { return implicit_; }
  void forget() { stages_.forget(); }
  int error_order() const { return implicit_ ? Implicit::kErrorOrder : Explicit::kErrorOrder; }

  template <class F>
  void advance(F&& f) {
    taken_implicit_ = implicit_;
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
    taken_implicit_ ? stages_.prepare_dense() : Base::prepare_dense(f);
  }
  State at(double s) const {
    if (!taken_implicit_) return Base::at(s);
    const auto place = this->place(s);
    return this->extended(stages_.at(this->y, this->computed_end(), place.share), place.beyond);
  }
  double component_at(int index, double s) const {
    return taken_implicit_ ? at(s)[index] : Base::component_at(index, s);
  }

  /// After a whole accepted step: which method takes the next one, and its length.
  double choose(double h_next) {
    if (!implicit_) {
      if (Base::stiffness(kCoupled) > Explicit::kStabilityBoundary) {
        inside_ = 0;
        if (++outside_ >= patience_) implicit_ = true, outside_ = dear_ = 0, paid_ = false;
      } else if (++inside_ >= Method::kForget) {
        outside_ = 0;
      }
      return h_next;
    }
    const double stable = Explicit::kStabilityBoundary / stages_.spectral_radius();
    if (this->h >= Method::kPrice * stable) {
      dear_ = 0, paid_ = true, patience_ = Method::kPatience;
    } else if (h_next < kGrows * this->h && ++dear_ >= (paid_ ? Method::kRegret : Method::kTrial)) {
      implicit_ = false, inside_ = 0;
      if (!paid_) patience_ = std::min(2 * patience_, 16 * Method::kPatience);
      return std::min(h_next, stable);
    }
    return h_next;
  }

 private:
  static constexpr double kGrows = 1.5;  ///< a step that the next one exceeds so far says nothing yet
  RosenbrockStages<Implicit, N, kCoupled> stages_;
  bool implicit_ = false, taken_implicit_ = false, paid_ = false;
  int outside_ = 0, inside_ = 0, dear_ = 0, patience_ = Method::kPatience;
};

template <class E, class I, int N, int kCoupled>
struct StepOf<Automatic<E, I>, double, N, kCoupled> {
  using type = AutomaticStep<Automatic<E, I>, N, kCoupled>;
};

}  // namespace ukemi::integrate
