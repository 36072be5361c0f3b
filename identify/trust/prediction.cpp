#include "identify/trust/prediction.hpp"

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "identify/estimate/prediction_error.hpp"
#include "identify/estimate/statistics.hpp"
#include "identify/fit/trial_problem.hpp"
#include "identify/logs/trial_checks.hpp"
#include "identify/trust/diagnostics.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

/// Variance of noise_level^2 / sigma^2 over n samples of white noise, times n. Measured on normal numbers;
/// test/regression/predict.cpp.
constexpr double kNoiseLevelVariance = 10.3;

/// The term of this key in actuator.toml. Throws InputError where the table lacks it.
const RigTerm& term_of_key(const std::string& key, const std::vector<RigTerm>& table) {
  const auto term = std::find_if(table.begin(), table.end(), [&](const RigTerm& t) { return t.key == key; });
  if (term == table.end()) throw InputError(quoted(key) + ": uncertain, and no term of the fit");
  return *term;
}

/// All trials as one problem: its globals are the constants that the actuator's file calls uncertain, its locals each
/// trial's initial state.
struct PredictionProblem {
  PredictionProblem(const Experiment& e, const Actuator& a)
      : options(e.options), prepared(e.trials.begin(), e.trials.end()), unweighted(e.trials.size()) {
    for (const std::string& key : a.uncertain) layout.shared.push_back(&term_of_key(key, *options.terms.table));
    if (layout.shared.empty()) layout.shared.push_back(&options.terms["i_motor"]);  // at least one, held
    for (const char* name : {"initial_angle", "initial_rate"}) layout.own.push_back(&options.terms[name]);
    problem = make_problem(e.rig, prepared, unweighted, a.sea,
                           {.centre = {1, 1, 1, 1, 1}, .spread_gains = 1, .spread_rest = 1}, layout, options,
                           options.rollout());
    problem.priors.clear();  // they would pull at held globals
    for (std::size_t g = 0; g < layout.shared.size(); ++g) {
      constants.push_back(layout.shared[g]->value_in(a.sea));
      problem.globals[g].start = constants.back();
    }
    own = MatrixXd::Zero(long(prepared.size()), long(layout.own.size()));
  }
  PredictionProblem(const PredictionProblem&) = delete;

  FitOptions options;
  RigLayout layout;
  std::vector<PreparedTrial> prepared;
  std::vector<Weighting> unweighted;
  LeastSquaresProblem problem;
  std::vector<double> constants;
  MatrixXd own;  ///< trials x (angle, rate)
};

/// Fits the initial states; false where a trial cannot be simulated.
bool fit_initial_states(PredictionProblem& p, std::vector<Estimate>& out) {
  p.problem.hold_globals();
  const LeastSquaresSolution s = solve(p.problem, {});
  if (!s.usable) return false;
  p.own = s.locals;
  const long degrees = std::max(1l, s.residuals - s.locals.size());
  for (long l = 0; l < s.locals.cols(); ++l)
    for (long m = 0; m < s.locals.rows(); ++m)
      out.push_back(estimate_of(p.problem.locals[std::size_t(l)], s.locals(m, l),
                                s.local_variance.size() > 0 ? s.local_variance(m, l) * s.cost / double(degrees) : NAN,
                                t_quantile_975(degrees), int(m)));
  return true;
}

/// Cuts half widths of the band, row by row of the residuals, into the trial's columns.
void set_bands(const VectorXd& half, const Trial& log, JudgedTrial& out) {
  const double* from = half.data();
  const auto convert = [&](const std::vector<double>& measured, double unit, std::vector<double>& to) {
    for (std::size_t i = 0; i < measured.size(); ++i) to.push_back(*from++ / unit);
  };
  convert(log.phi, 1, out.phi), convert(log.phi_motor, 1, out.phi_m),
      convert(log.torque, angle_per_torque(log), out.torque);
}

JudgedTrial judge_trial(const Experiment& experiment, const Actuator& actuator, const PredictionProblem& p,
                        std::size_t m, const InitialState& start, const TrialResult& result) {
  constexpr double kExact = 1e-6;  // of an angle's range: no log is more accurate
  const Trial& log = experiment.trials[m];
  JudgedTrial out;
  double noise = result.noise;
  if (noise == 0 && log.samples() < 9) return out;  // too few to estimate the noise
  for (const std::vector<double>* angle : {&log.phi, &log.phi_motor})
    if (!angle->empty()) {
      const auto [low, high] = std::minmax_element(angle->begin(), angle->end());
      noise = std::max(noise, kExact * (*high - *low));
    }
  const VectorXd own = p.own.row(long(m));
  const long n = long(log.measurements()), k = long(actuator.uncertain.size()), l = own.size();
  VectorXd r(n);
  MatrixXd j(n, long(p.constants.size()) + l);
  const ResidualBlock& block = p.problem.blocks[m];
  if (n == 0 || noise == 0 || !block.evaluate(p.constants.data(), own.data(), r.data(), j.data())) return out;
  const Weighting weighting =
      force_noise_weighting(experiment.rig, actuator.sea, {own[0], own[1]}, log, noise, p.options.rollout());
  PredictionCase c{.residual = r,
                   .by_constants = j.leftCols(k),
                   .covariance = actuator.covariance,
                   .by_fitted = start.kind == InitialState::Kind::kFitted ? j.rightCols(l) : MatrixXd(n, 0),
                   .noise = noise,
                   .noise_variance = kNoiseLevelVariance};
  const double level = kTestLevel / double(experiment.trials.size());
  PredictionError error = prediction_error(c, level);
  VectorXd variance = error.std.cwiseAbs2();
  if (weighting.u.size() > 0) {
    const VectorXd s2 = (1 - weighting.shrink.array()).square().inverse() - 1;
    variance += noise * noise * weighting.u.cwiseAbs2() * s2;
    for (auto* columns : {&c.by_constants, &c.by_fitted})
      for (long i = 0; i < columns->cols(); ++i) weighting.whiten(columns->col(i));
    weighting.whiten(c.residual);
    error = prediction_error(c, level);
  }
  out.factor = error.factor;
  set_bands(kNormal975 * variance.cwiseSqrt(), log, out);
  return out;
}

}  // namespace

Verdict verdict_of(double factor) {
  if (std::isnan(factor)) return Verdict::kNotMeasured;
  return factor <= 1 ? Verdict::kHolds : factor <= kFarAboveNoise ? Verdict::kHoldsWithin : Verdict::kDoesNotHold;
}

Prediction predict(const Experiment& experiment, const Actuator& actuator, const InitialState& start) {
  using Kind = InitialState::Kind;
  experiment.rig.validate(), experiment.options.validate();
  validate(actuator), check_finite("initial angle", start.angle);
  PredictionProblem p(experiment, actuator);
  std::vector<Estimate> initial;
  bool simulated = true;
  if (start.kind == Kind::kFitted) simulated = fit_initial_states(p, initial);
  if (start.kind == Kind::kGiven)
    for (std::size_t m = 0; m < p.prepared.size(); ++m) p.own(long(m), 0) = start.angle - p.prepared[m].phi_start;
  std::vector<Nuisance<double>> own;
  for (long m = 0; m < p.own.rows(); ++m) own.push_back({p.own(m, 0), p.own(m, 1)});
  Prediction out{predict(experiment.rig, experiment.trials, actuator.sea, experiment.options, own), {}};
  out.fit.nuisance = std::move(initial);
  if (!simulated) out.fit.converged = false, out.fit.message = "no initial state of the trials could be fitted";
  Judgement& j = out.judgement;
  j.by_noise_alone = actuator.uncertain.empty();
  for (std::size_t m = 0; m < experiment.trials.size(); ++m) {
    const TrialResult& result = out.fit.trials[m];
    j.trials.push_back(result.status == RolloutStatus::kDone ? judge_trial(experiment, actuator, p, m, start, result)
                                                             : JudgedTrial{});
    j.factor = std::fmax(j.factor, j.trials.back().factor);
  }
  return out;
}

}  // namespace ukemi::identify
