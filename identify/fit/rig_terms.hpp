// The rig's terms: the five constants and what may be fitted along with them. One entry of the table is all that a term
// needs to be fitted, bounded, held by a prior, tested for by its score, reported, and stored.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/jet.hpp"
#include "identify/estimate/term.hpp"
#include "identify/rollout/rollout.hpp"

namespace ukemi::identify {

using SmallJet = ceres::Jet<double, kSmallJet>;
using LargeJet = ceres::Jet<double, kLargeJet>;

/// The inputs by which a rollout can be differentiated.
template <class T>
struct RolloutInputs {
  SeaParameters<T> sea;
  Nuisance<T> nuisance = {};
};

/// Accessor of a term's value in these inputs, for each scalar type: the rollout's derivative by it is exact.
struct InputField {
  double* (*in_double)(RolloutInputs<double>&) = nullptr;
  SmallJet* (*in_small)(RolloutInputs<SmallJet>&) = nullptr;
  LargeJet* (*in_large)(RolloutInputs<LargeJet>&) = nullptr;

  explicit operator bool() const { return in_double != nullptr; }
  template <class T>
  T& of(RolloutInputs<T>& in) const {
    if constexpr (std::is_same_v<T, double>)
      return *in_double(in);
    else if constexpr (std::is_same_v<T, SmallJet>)
      return *in_small(in);
    else
      return *in_large(in);
  }
};
/// From one generic lambda: input_field([](auto& in) { return &in.sea.friction; }).
template <class F>
InputField input_field(F) {
  return {[](RolloutInputs<double>& in) { return F{}(in); }, [](RolloutInputs<SmallJet>& in) { return F{}(in); },
          [](RolloutInputs<LargeJet>& in) { return F{}(in); }};
}

/// A term enters the model by `field`, exactly, or by `change`, whose derivative is a central difference.
struct RigTerm : Term {
  InputField field = {};
  /// What a value does to copies of the rig, the actuator and the trial's log; applied before the fields are set.
  std::function<void(double value, Rig& rig, SeaParameters<double>& sea, Trial& log)> change = {};
  /// The typical size is `part` of this constant at the start, where that is above 0.
  double SeaParameters<double>::*relative_to = nullptr;
  double part = 1;
  bool in_ladder = false;  ///< the model ladder tries the fit with and without it
  /// It is tested only where one of these constants is not 0: without them it has no effect. Empty: always.
  std::vector<double SeaParameters<double>::*> only_with = {};
  /// It has an effect only on trials that log this column.
  struct LogColumn {
    const char* name;
    std::vector<double> Trial::*at;
  };
  std::optional<LogColumn> needs = {};
  std::string key = {};                ///< its key in actuator.toml; empty: it is no constant of the actuator
  const RigErrorKey* error = nullptr;  ///< the rig states its error: it is considered where it is not fitted
  bool tested = true;                  ///< its score is tested; false: another term has the same effect
  /// How to measure it without a fit, as an imperative.
  std::string measure = {};

  /// Whether any of the trials logs what it needs.
  bool applies_to(const std::vector<Trial>& trials) const;
  /// Its value in an actuator; `absent` where it has no field there.
  double value_in(const SeaParameters<double>& sea) const;
  /// Sets a value, clamped to the term's bounds; no effect where it has no field.
  void set_in(SeaParameters<double>& sea, double value) const;
  /// The term as a problem's parameter that starts at an actuator's value, off its bound; a constant that is 0 there is
  /// scaled by the suggested one.
  Parameter column(const SeaParameters<double>& start, const SeaParameters<double>& suggested,
                   const Choice& choice) const;
};

/// The name of the term for the force's curve between its samples, see Trial::force_smooth.
inline constexpr const char* kForceSmooth = "force_smooth";

/// The table: the five constants in their order, then the others.
const std::vector<RigTerm>& rig_terms();
/// All five constants free, no nuisance terms.
Terms<RigTerm> rig_choice();

using RigLayout = Layout<RigTerm>;

/// The inputs of a trial's rollout at a point of the problem.
class RigPoint {
 public:
  RigPoint(const RigLayout& layout, const double* shared, const double* own)
      : layout_(layout), shared_(shared), own_(own) {}

  /// Puts the fields' values into the inputs; `lift(value, column)` makes the scalar.
  template <class T, class Lift>
  void place(RolloutInputs<T>& in, Lift&& lift) const {
    layout_.for_each(shared_, own_, [&](const RigTerm& t, double value, std::size_t column) {
      if (t.field) t.field.of(in) = lift(value, column);
    });
  }
  /// The actuator `base` and the trial's nuisance values at this point.
  RolloutInputs<double> inputs(const SeaParameters<double>& base) const {
    RolloutInputs<double> out{base};
    place(out, [](double v, std::size_t) { return v; });
    return out;
  }
  /// f(rig, base, trial) with the terms' changes applied (RigTerm::change); unchanged where no term has one.
  template <class F>
  auto with_changes(const Rig& rig, const SeaParameters<double>& base, const PreparedTrial& trial, F&& f) const {
    bool any = false;
    layout_.for_each(shared_, own_, [&](const RigTerm& t, double, std::size_t) { any = any || t.change; });
    if (!any) return f(rig, base, trial);
    Rig changed_rig = rig;
    SeaParameters<double> changed_base = base;
    Trial log = *trial.trial;
    layout_.for_each(shared_, own_, [&](const RigTerm& t, double value, std::size_t) {
      if (t.change) t.change(value, changed_rig, changed_base, log);
    });
    return f(changed_rig, changed_base, PreparedTrial(log));
  }

 private:
  const RigLayout& layout_;
  const double *shared_, *own_;
};

}  // namespace ukemi::identify
