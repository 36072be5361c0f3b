#include "identify/fit/trial_problem.hpp"

#include <algorithm>

#include "identify/fit/rig_terms.hpp"
#include "identify/fit/weighting.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

/// One trial as a function of a point of the problem. Derivatives are taken with respect to value / scale, so that they
/// are angles whatever the parameter's unit, as the integrator's error control expects; the Jacobians are not scaled.
struct TrialBlock {
  const Rig& rig;
  const SeaParameters<double> base;
  const RigLayout layout;
  const PreparedTrial& trial;
  const Weighting& weighting;
  const RolloutOptions options;
  const std::vector<Parameter> columns;
  const double per_torque = angle_per_torque(*trial.trial);

  std::size_t size() const { return std::size_t(trial.trial->measurements()); }

  bool evaluate(const double* shared, const double* own, double* residuals, double* jacobian) const {
    const RigPoint point(layout, shared, own);
    bool done;
    if (!jacobian)
      done = pass<double>(point, 0, residuals, nullptr);
    else if (columns.size() <= kSmallJet)
      done = pass<SmallJet>(point, 0, residuals, jacobian);
    else
      done = passes<LargeJet>(point, residuals, jacobian);
    if (!done || (jacobian && !difference_columns(shared, own, jacobian))) return false;
    if (weighting.u.size() == 0) return true;
    const auto whiten = [&](double* column) { weighting.whiten(Eigen::Map<Eigen::VectorXd>(column, long(size()))); };
    whiten(residuals);
    for (std::size_t k = 0; jacobian && k < columns.size(); ++k) whiten(jacobian + k * size());
    return true;
  }

 private:
  template <class T>
  struct Outputs {
    std::vector<T> phi, phi_m, torque;
  };
  /// The predictions with derivatives by the columns from `first` on, as many as T has slots.
  template <class T>
  bool simulate(const RigPoint& point, std::size_t first, Outputs<T>& out) const {
    const auto lift = [&](double value, [[maybe_unused]] std::size_t column) {
      T x(value);
      if constexpr (kDerivatives < T >> 0)
        if (column - first < std::size_t(kDerivatives<T>)) x.v[long(column - first)] = columns[column].scale;
      return x;
    };
    return point.with_changes(
        rig, base, trial, [&](const Rig& r, const SeaParameters<double>& sea, const PreparedTrial& t) {
          RolloutInputs<T> in{sea.cast<T>()};
          point.place(in, lift);
          return rollout(r, in.sea, in.nuisance, t, options, out.phi, out.phi_m,
                         trial.trial->torque.empty() ? nullptr : &out.torque) == RolloutStatus::kDone;
        });
  }
  /// f(measured, predicted, row, weight) for each output.
  template <class T, class F>
  void for_each_output(const Outputs<T>& out, F&& f) const {
    const Trial& log = *trial.trial;
    f(log.phi, out.phi, std::size_t(0), weighting.weight);
    f(log.phi_motor, out.phi_m, log.phi.size(), weighting.weight);
    f(log.torque, out.torque, log.phi.size() + log.phi_motor.size(), weighting.weight * per_torque);
  }

  /// The residuals and, with a Jet, the Jacobian's columns from `first` on.
  template <class T>
  bool pass(const RigPoint& point, std::size_t first, double* residuals, [[maybe_unused]] double* jacobian) const {
    thread_local Outputs<T> out;
    if (!simulate(point, first, out)) return false;
    for_each_output(
        out, [&](const std::vector<double>& measured, const std::vector<T>& predicted, std::size_t row, double weight) {
          for (std::size_t i = 0; i < measured.size(); ++i)
            residuals[row + i] = weight * (value_of(predicted[i]) - measured[i]);
          if constexpr (kDerivatives < T >> 0) {
            const std::size_t last = std::min(columns.size(), first + std::size_t(kDerivatives<T>));
            for (std::size_t k = first; k < last; ++k) {
              const double factor = weight / columns[k].scale;
              double* column = jacobian + k * size() + row;
              for (std::size_t i = 0; i < measured.size(); ++i) column[i] = factor * predicted[i].v[long(k - first)];
            }
          }
        });
    return true;
  }
  template <class T>
  bool passes(const RigPoint& point, double* residuals, double* jacobian) const {
    for (std::size_t first = 0; first < columns.size(); first += std::size_t(kDerivatives<T>))
      if (!pass<T>(point, first, residuals, jacobian)) return false;
    return true;
  }

  /// The columns of terms with a RigTerm::change, by central differences within their bounds.
  bool difference_columns(const double* shared, const double* own, double* jacobian) const {
    constexpr double kStep = 1e-3;  // of the scale: balances the integrator's error and the curvature
    std::vector<double> point(shared, shared + layout.shared.size());
    point.insert(point.end(), own, own + layout.own.size());
    bool done = true;
    layout.for_each(shared, own, [&](const RigTerm& term, double value, std::size_t k) {
      if (!term.change || !done) return;
      const Parameter& p = columns[k];
      const double low = std::max(value - kStep * p.scale, p.lower), high = std::min(value + kStep * p.scale, p.upper);
      Outputs<double> out[2];
      for (const int side : {0, 1}) {
        point[k] = side ? high : low;
        const RigPoint moved(layout, point.data(), point.data() + layout.shared.size());
        done = done && simulate(moved, 0, out[side]);
      }
      point[k] = value;
      if (!done) return;
      for (const int side : {0, 1})
        for_each_output(out[side], [&](const std::vector<double>& measured, const std::vector<double>& predicted,
                                       std::size_t row, double weight) {
          double* column = jacobian + k * size() + row;
          const double factor = weight / (high - low);
          for (std::size_t i = 0; i < measured.size(); ++i)
            column[i] = side ? column[i] + factor * predicted[i] : -factor * predicted[i];
        });
    });
    return done;
  }
};

/// The given priors, and the rig's stated errors as priors of the terms that are fitted.
std::vector<Prior> priors_of(const Rig& rig, const Terms<RigTerm>& terms) {
  std::vector<Prior> out = terms.priors;
  for (const RigTerm& t : *terms.table) {
    if (!t.error || !terms.fits(t.name) || !(rig.errors.*t.error->at > 0)) continue;
    if (std::none_of(out.begin(), out.end(), [&](const Prior& p) { return p.term == t.name; }))
      out.push_back({t.name, t.value_in(rig.mounted({})), rig.errors.*t.error->at});
  }
  return out;
}

}  // namespace

LeastSquaresProblem make_problem(const Rig& rig, const std::vector<PreparedTrial>& prepared,
                                 const std::vector<Weighting>& weights, const SeaParameters<double>& start,
                                 const Suggestion& suggestion, const RigLayout& layout, const FitOptions& options,
                                 const RolloutOptions& rollout_options) {
  LeastSquaresProblem problem;
  for (const auto& [terms, parameters] : {std::pair(&layout.shared, &problem.globals), {&layout.own, &problem.locals}})
    for (const RigTerm* t : *terms) parameters->push_back(t->column(start, suggestion.centre, options.terms));
  std::vector<const Trial*> logs;
  for (const PreparedTrial& p : prepared) logs.push_back(p.trial);
  const std::vector<Prior> priors = priors_of(rig, options.terms);
  for (std::size_t g = 0; g < layout.shared.size(); ++g)
    for (const Prior& prior : priors)
      if (prior.term == layout.shared[g]->name)
        problem.priors.push_back({int(g), prior.value, noise_level(logs) / prior.std});
  std::vector<Parameter> columns = problem.globals;
  columns.insert(columns.end(), problem.locals.begin(), problem.locals.end());
  for (std::size_t m = 0; m < prepared.size(); ++m) {
    const TrialBlock block{rig, start, layout, prepared[m], weights[m], rollout_options, columns};
    problem.blocks.push_back(
        {int(block.size()), [block](const double* g, const double* l, double* r, double* jacobian) {
           return block.evaluate(g, l, r, jacobian);
         }});
  }
  return problem;
}

}  // namespace ukemi::identify
