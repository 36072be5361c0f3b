#include "identify/fit/trial_problem.hpp"

#include <algorithm>

namespace ukemi::identify {

namespace {

static_assert(kConstants + int(kNuisanceTerms.size()) <= kLargeJet, "each constant and each term needs a slot");

/// Residuals of one trial and, with a Jet, their Jacobians. Derivatives are taken with respect to value / scale, so
/// that they are angles whatever the parameter's unit, as the integrator's error control expects; the Jacobians are not
/// scaled.
template <class T>
bool evaluate(const Rig& rig, const SeaParameters<double>& base, const Layout& layout, const PreparedTrial& prepared,
              const RolloutOptions& options, const Weighting& weighting, const std::vector<double>& scale,
              const double* global, const double* local, double* const residuals, double* const jacobians) {
  auto sea = base.cast<T>();
  Nuisance<T> nuisance;
  layout.apply<T>(global, local, sea, nuisance, [&](double v, [[maybe_unused]] int slot) {
    T x(v);
    if constexpr (kDerivatives < T >> 0) x.v[slot] = scale[std::size_t(slot)];
    return x;
  });
  thread_local std::vector<T> phi, phi_m;
  if (rollout(rig, sea, nuisance, prepared, options, phi, phi_m) != RolloutStatus::kDone) return false;
  const std::size_t size = std::size_t(prepared.trial->measurements());
  const double weight = weighting.weight;
  double *r = residuals, *jacobian = jacobians;
  const auto compare = [&](const std::vector<double>& measured, const std::vector<T>& predicted) {
    for (std::size_t i = 0; i < measured.size(); ++i) r[i] = weight * (value_of(predicted[i]) - measured[i]);
    r += measured.size();
    if constexpr (kDerivatives < T >> 0) {
      for (std::size_t k = 0; k < scale.size(); ++k) {
        const double factor = weight / scale[k];
        for (std::size_t i = 0; i < measured.size(); ++i) jacobian[k * size + i] = factor * predicted[i].v[long(k)];
      }
      jacobian += measured.size();
    }
  };
  compare(prepared.trial->phi, phi);
  compare(prepared.trial->phi_motor, phi_m);
  if (weighting.u.size() > 0) {
    const auto whiten = [&](double* column) { weighting.whiten(Eigen::Map<Eigen::VectorXd>(column, long(size))); };
    whiten(residuals);
    for (std::size_t k = 0; kDerivatives < T >> 0 && k < scale.size(); ++k) whiten(jacobians + k * size);
  }
  return true;
}

/// A term as a parameter: where it starts, its bounds and its typical size.
Parameter parameter(NuisanceTerm t, const SeaParameters<double>& start) {
  constexpr double kInf = FitOptions::kInfinity;
  const auto signless = [&](double at, double size) {
    return Parameter{name(t), unit(t), at > 0 ? at : size, 0, kInf, size};
  };
  switch (t) {
    case NuisanceTerm::kFriction:
      return signless(start.friction, start.k_p > 0 ? 0.01 * start.k_p : 0.1);
    case NuisanceTerm::kViscous:
      return signless(start.viscous, start.k_d > 0 ? 0.1 * start.k_d : 0.1);
    case NuisanceTerm::kStiffening:  // as much torque as the linear part at a deflection of 1 rad
      return signless(start.k_sea_cubic, start.k_sea > 0 ? start.k_sea : 10);
    case NuisanceTerm::kForceGain:
      return {name(t), unit(t), 1, 0.01, 100, 1};
    case NuisanceTerm::kInitialAngle:
    case NuisanceTerm::kEncoderOffset:
      return {name(t), unit(t), 0, -kInf, kInf, 0.01};
    case NuisanceTerm::kInitialRate:
      return {name(t), unit(t), 0, -kInf, kInf, 0.1};
    case NuisanceTerm::kForceBias:
      return {name(t), unit(t), 0, -kInf, kInf, 1};
    case NuisanceTerm::kTimeShift:
      return {name(t), unit(t), 0, -0.1, 0.1, 1e-3};
  }
  return {};
}

/// Size of a constant for scaling, where the start is 0.
double typical(int constant, const Suggestion& s) { return ukemi::constants(s.centre)[std::size_t(constant)]; }

}  // namespace

LeastSquaresProblem make_problem(const Rig& rig, const std::vector<PreparedTrial>& prepared,
                                 const std::vector<Weighting>& weights, const SeaParameters<double>& start,
                                 const Suggestion& suggestion, const Layout& layout, const FitOptions& options,
                                 const RolloutOptions& rollout_options) {
  LeastSquaresProblem problem;
  const auto u = ukemi::constants(start);
  for (const int c : layout.constants) {
    const auto k = std::size_t(c);
    const double size = u[k] > 0 ? u[k] : typical(c, suggestion);
    // i_motor divides Eq. 4: its bound of 0 is the smallest positive number that the model can be asked with.
    const double lower = c == 4 ? std::max(options.lower[k], 1e-6 * size) : options.lower[k];
    problem.globals.push_back(
        {kConstantNames[k], kConstantUnits[k], std::max(u[k], 0.1 * size), lower, options.upper[k], size});
  }
  for (const NuisanceTerm t : layout.shared) problem.globals.push_back(parameter(t, start));
  for (const NuisanceTerm t : layout.of_trial) problem.locals.push_back(parameter(t, start));
  for (std::size_t g = 0; g < layout.constants.size(); ++g)
    if (const auto& prior = options.prior[std::size_t(layout.constants[g])]) {
      std::vector<const Trial*> logs;
      for (const PreparedTrial& p : prepared) logs.push_back(p.trial);
      problem.priors.push_back({int(g), prior->value, noise_level(logs) / prior->std});
    }
  std::vector<double> scale;
  for (const auto& list : {problem.globals, problem.locals})
    for (const Parameter& p : list) scale.push_back(p.scale);
  const bool small = layout.globals() + layout.locals() <= kSmallJet;
  for (std::size_t m = 0; m < prepared.size(); ++m) {
    const PreparedTrial* trial = &prepared[m];
    const Weighting* weight = &weights[m];
    problem.blocks.push_back(
        {int(trial->trial->measurements()), [=, &rig](const double* g, const double* l, double* r, double* jacobian) {
           if (!jacobian)
             return evaluate<double>(rig, start, layout, *trial, rollout_options, *weight, scale, g, l, r, jacobian);
           if (small)
             return evaluate<ceres::Jet<double, kSmallJet>>(rig, start, layout, *trial, rollout_options, *weight, scale,
                                                            g, l, r, jacobian);
           return evaluate<ceres::Jet<double, kLargeJet>>(rig, start, layout, *trial, rollout_options, *weight, scale,
                                                          g, l, r, jacobian);
         }});
  }
  return problem;
}

}  // namespace ukemi::identify
