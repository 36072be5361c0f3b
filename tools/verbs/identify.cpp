// ukemi identify, ukemi predict.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "common/checks.hpp"
#include "common/error.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/identify.hpp"
#include "tools/study/landing_of_fit.hpp"
#include "tools/verbs/robot_logs.hpp"
#include "tools/verbs/runs.hpp"
#include "tools/verbs/term_help.hpp"

namespace ukemi::tools {

namespace {

/// Name of the term with this name or alias, among those of the table that the predicate admits.
template <class Predicate>
std::string term_name(const std::string& option, const std::string& given, Predicate&& admits) {
  std::vector<std::string> known;
  for (const identify::RigTerm& t : identify::rig_terms()) {
    if (!admits(t)) continue;
    if (t.is_called(given)) return t.name;
    known.push_back(t.name);
  }
  throw InputError(option + ": " + one_of(given, known));
}
/// Terms with this role in a comma-separated list.
std::vector<std::string> term_names(const std::string& option, const std::string& list, identify::Term::Role role) {
  std::vector<std::string> out;
  for (const std::string& name : split(list)) {
    const std::string term = term_name(option, name, [&](const identify::RigTerm& t) { return t.role == role; });
    if (std::find(out.begin(), out.end(), term) != out.end())
      throw InputError(option + ": " + quoted(name) + ": named twice");
    out.push_back(term);
  }
  return out;
}

void parse_bounds(const std::string& option, const std::string& list, std::map<std::string, double>& bounds) {
  for (const std::string& item : split(list)) {
    const Assignment bound = assignment(option, item);
    set_once(option, bound.name, kConstantNames[constant_index(option, bound.name)], to_number(option, bound.value),
             bounds);
  }
}

identify::FitOptions fit_options(const IdentifyArguments& a, const CommonOptions& common) {
  identify::FitOptions o;
  o.seed = common.seed;
  o.accuracy = a.accuracy;
  o.escape = escape_of(a.reading);
  using enum identify::Term::Role;
  if (!a.free.empty()) {  // in the table's order, whatever the option's
    const std::vector<std::string> named = term_names("--free", a.free, kConstant);
    std::erase_if(o.terms.free, [&](auto& name) { return std::find(named.begin(), named.end(), name) == named.end(); });
  }
  o.terms.nuisance = term_names("--nuisance", a.nuisance, kNuisance);
  for (const std::string& item : split(a.prior)) {
    const NamedPrior known = named_prior("--prior", item);
    const std::string name =
        term_name("--prior", known.name, [](auto& t) { return t.scope == identify::Scope::kShared; });
    std::erase_if(o.terms.priors, [&](const identify::Prior& p) { return p.term == name; });  // the last one holds
    o.terms.priors.push_back({name, known.value, known.std});
  }
  o.explore = a.starts;
  o.threads = common.threads;
  parse_bounds("--lower", a.lower, o.terms.lower);
  parse_bounds("--upper", a.upper, o.terms.upper);
  if (a.loss.rfind("huber:", 0) == 0) {
    o.huber = to_number("--loss", a.loss.substr(6));
    if (!(o.huber > 0)) throw InputError("--loss: " + quoted(a.loss) + ": Huber's delta must be above 0 rad");
  } else if (a.loss != "none") {
    throw InputError("--loss: " + quoted(a.loss) + ": none or huber:DELTA is needed");
  }
  o.weights = a.weights;
  o.validate();
  return o;
}

/// Throws InputError where a profile cannot be computed, or a constant that is not fitted has no value.
void check(const IdentifyArguments& a, const IdentifyQuestion& q) {
  for (const std::string& name : split(a.profile)) {
    if (!q.options.terms.fits(kConstantNames[constant_index("--profile", name)]))
      throw InputError("--profile: " + name + ": it is not among the --free constants");
    if (q.options.terms.free.size() == 1)
      throw InputError("--profile: " + name + ": no other constant is free to follow it");
  }
  if (q.verb == IdentifyQuestion::Verb::kIdentify && !q.given)
    for (const std::string name : kConstantNames)
      if (!q.options.terms.fits(name))
        throw InputError("--free: " + name + " is not free and needs a value: give --start");
}

/// Fits torque_gain with HEBI's effort: deflection times the module's spring constant, which unscaled it would return.
void scale_effort(const TrialArguments& a, IdentifyQuestion& q) {
  identify::Terms<identify::RigTerm>& terms = q.options.terms;
  const bool effort = a.effort == identify::HebiTrialOptions::Effort::kTorque;
  if (effort && q.verb == IdentifyQuestion::Verb::kIdentify && !terms.fits("torque_gain"))
    terms.nuisance.push_back("torque_gain");
}

/// The required content of the trials: excitation, unless the initial angle or rate is fitted.
TrialNeeds needs_of(const IdentifyQuestion& q) {
  TrialNeeds needs;
  if (q.verb == IdentifyQuestion::Verb::kPredict)
    needs.phi = TrialNeeds::Angle::kOptional;
  else if (!q.options.terms.fits("initial_angle") && !q.options.terms.fits("initial_rate"))
    needs.excitation = TrialNeeds::Excitation::kRequired;
  return needs;
}

/// --start-angle: a number of rad, or "fit"; empty: at the reference.
identify::InitialState initial_state(const std::string& text) {
  using Kind = identify::InitialState::Kind;
  if (text.empty()) return {};
  if (text == "fit") return {Kind::kFitted};
  const double angle = to_number("--start-angle", text);
  if (!(std::abs(angle) <= 2 * std::numbers::pi))
    throw InputError("--start-angle: " + quoted(text) + ": an angle within 2 pi rad, or fit, is needed");
  return {Kind::kGiven, angle};
}

/// The landing of --scene, read before any computation.
struct RequestedLanding {
  landing::Scene scene;
  landing::Motion motion;
};
std::optional<RequestedLanding> requested_landing(const IdentifyArguments& a, const IdentifyQuestion& q, Run& run) {
  const bool motion = !a.motion.file.empty() || a.motion.hold;
  if (a.scene.empty() && !motion) return std::nullopt;
  if (a.scene.empty()) throw InputError("--motion, --hold: --scene is needed with them");
  if (!q.options.terms.fits("k_p") && q.base.k_p == 0)
    throw InputError("--scene: a landing needs K_p and K_d, and this drive is identified by its command (k_t)");
  RequestedLanding out{.scene = scene_of(a.scene, run), .motion = {}};
  out.motion = motion_of(a.motion, "identify --scene", run);
  return out;
}

}  // namespace

int run_identify(const IdentifyArguments& a, const CommonOptions& common) {
  const bool predict = !a.actuator.empty();
  Run run(predict ? kPredictOutputs : kIdentifyOutputs, common);
  IdentifyQuestion q{.verb = predict ? IdentifyQuestion::Verb::kPredict : IdentifyQuestion::Verb::kIdentify,
                     .rig = rig_of(a.rig, a.reading),
                     .exports = a.exports};
  run.input(a.rig);
  if (a.speed_max) check_positive("--speed-max", *a.speed_max), q.rig.speed_max = a.speed_max;
  if (a.motor_torque_max)
    check_positive("--motor-torque-max", *a.motor_torque_max), q.rig.motor_torque_max = a.motor_torque_max;
  if (predict) q.given = actuator_of(a.actuator, run);
  if (!a.start.empty()) q.given = read_actuator(a.start), run.input(a.start);
  const identify::InitialState initial = initial_state(a.start_angle);
  q.options = fit_options(a, common);
  q.options.monitor = run.monitor("identify", "starts");
  check(a, q);
  TrialInputs inputs = read_trials(a.trials, a.reading, q.rig, needs_of(q), run);
  q.trials = std::move(inputs.trials);
  q.base = base_of(q.rig, q.given);
  choose_drive(q);
  scale_effort(a.reading, q);
  if (predict) q.trials = with_force_curve(q.trials, a.reading, q.rig, q.base);
  const std::optional<RequestedLanding> requested = requested_landing(a, q, run);

  run.info(fmt::format("{} {} trials", predict ? "predicting" : "fitting", q.trials.size()));
  if (predict) {
    Actuator mounted = *q.given;
    mounted.sea = q.base;
    return report(q, identify::predict({q.rig, q.trials, q.options}, mounted, initial), a.doubt,
                  std::move(inputs.summary), run);
  }
  const auto start = q.given ? std::optional(q.given->sea) : std::nullopt;
  using Force = identify::TrustOptions::Force;
  const bool by_residuals = a.reading.force_curve == TrialArguments::ForceCurve::kByResiduals;
  const identify::TrustOptions depth{.depth = a.depth,
                                     .force = by_residuals ? Force::kByResiduals : Force::kAsSet,
                                     .profiles = split(a.profile),
                                     .threads = common.threads};
  const identify::Identification found = identify::identify({q.rig, q.trials, q.options}, start, q.base, depth);
  std::optional<LandingOfFit> landing;
  if (requested && found.trust)
    landing =
        landing_of_fit(requested->scene, fitted_actuator(q, found.fit), requested->motion, common.seed, common.threads);
  return report(q, found, landing, a.doubt, std::move(inputs.summary), run);
}

namespace {

/// Runs identify or predict of a rig or of a robot of links.
int run_any(const IdentifyArguments& a, const CommonOptions& common, Predicts predicts) {
  if (!a.robot.empty()) return identify_robot(a, common, predicts);
  if (a.rig.empty()) throw InputError("--rig is required, or --robot of a robot of links");
  if (predicts == Predicts::kYes && a.actuator.empty()) throw InputError("--actuator is required");
  check_no_pieces(a.pieces, a.tie);
  if (!a.errors.empty()) throw InputError("--errors: --robot is needed with it: a rig's file has [errors]");
  if (!a.per_run.empty()) throw InputError("--per-run: --robot is needed with it");
  if (predicts == Predicts::kYes && !a.nuisance.empty())
    throw InputError("--nuisance: --robot is needed with it: of a rig's trial --start-angle fit fits the start");
  return run_identify(a, common);
}
int run_identify_of(const IdentifyArguments& a, const CommonOptions& common) {
  return run_any(a, common, Predicts::kNo);
}
int run_predict_of(const IdentifyArguments& a, const CommonOptions& common) {
  return run_any(a, common, Predicts::kYes);
}

using SharedArguments = std::shared_ptr<IdentifyArguments>;

/// Options of a prediction.
void add_prediction_options(CLI::App* verb, const SharedArguments& args) {
  verb->add_option("--start-angle", args->start_angle,
                   "angle that every trial starts at, at rest [rad], or fit: angle and rate of each trial are fitted "
                   "to it [at rest at its reference]");
  verb->add_flag_callback(
      "--strict", [args] { args->doubt = Doubt::kFail; }, "exit 1 where the prediction does not hold");
  verb->add_option("--nuisance", args->nuisance,
                   "with --robot: what of its start is fitted to each trial, as of identify; none: it starts as its "
                   "first rows say [all]");
}
/// Options of a fit: starts, free terms, bounds, weights.
void add_fit_options(CLI::App* verb, const SharedArguments& args) {
  verb->add_option("--start", args->start, "actuator file to start from [worked out from the rig and the trials]");
  verb->add_option("--speed-max", args->speed_max, "the motor's rated speed at the output [rad/s] [the rig's]");
  verb->add_option("--motor-torque-max", args->motor_torque_max,
                   "the motor's rated torque there [Nm] [the rig's]; tau_max of the rig limits the spring");
  verb->add_option("--free", args->free, "constants that are fitted [k_p,k_d,k_sea,c_sea,i_motor]");
  verb->add_option("--per-run", args->per_run,
                   "with --robot: constants of --free that each log has for its own, NAME@1 of the first [none]");
  verb->add_option("--nuisance", args->nuisance, nuisance_help(identify::rig_terms(), "A trial each"));
  verb->add_option(
      "--errors", args->errors,
      "with --robot: link.LINK.mass=0.01,...: standard deviations of constants that are not fitted: all "
      "errors and verdicts include theirs [1 ms of each elastic drive's control_delay and velocity_filter]");
  verb->add_option("--prior", args->prior,
                   "k_sea=65:5,...: what is known of fitted terms beforehand, VALUE:STD, counted like a measurement");
  verb->add_option("--starts", args->starts,
                   "explore: so many starts within 10x of --start or of what the logs suggest, and every minimum found")
      ->check(CLI::Range(1, 100'000));
  verb->add_option("--lower", args->lower, "k_p=0,...: lower bounds [0]");
  verb->add_option("--upper", args->upper, "k_p=200,...: upper bounds [none]");
  verb->add_option("--loss", args->loss, "none or huber:DELTA, DELTA in rad [none]");
  using enum identify::FitOptions::Weights;
  add_choice(*verb, "--weights", args->weights, {{"equal", kEqual}, {"trial", kTrial}},
             "equal, or trial: 1 / each trial's own residual variance [equal]");
}
/// Options of the tests of a fit, and of its effect on a landing.
void add_judgement_options(CLI::App* verb, const SharedArguments& args) {
  verb->add_flag_callback(
      "--strict", [args] { args->doubt = Doubt::kFail; },
      "exit 1 unless every fitted constant is trusted (95 % interval within 10 % of its value)");
  verb->add_flag_callback(
      "--diagnose", [args] { args->depth = identify::TrustOptions::Depth::kRefit; },
      "refit with and without each optional term (BIC, likelihood ratio, held-out error), and without each trial");
  verb->add_option("--profile", args->profile,
                   "k_sea,...: profile likelihood of these constants: profile.csv and unsymmetric 95 % intervals");
  verb->add_option("--scene", args->scene,
                   "scene file (TOML): how far the errors of the fit move the peak of a landing there, with --motion "
                   "or --hold");
  add_motion(*verb, args->motion);
}

void add_options(CLI::App* verb, Action& chosen, bool predict) {
  auto args = std::make_shared<IdentifyArguments>();
  verb->add_option(
          "TRIAL", args->trials,
          "trial files: CSV (t [s], phi [rad], force [N] and/or phi_ref [rad]), HEBI .hebilog or its CSV export")
      ->required();
  verb->add_option("--rig", args->rig, "rig file (TOML)");
  verb->add_option("--robot", args->robot, "of a robot of links, in place of the rig: robot file (TOML)");
  add_pieces(*verb, args->pieces, args->tie);
  if (predict) verb->add_option("--actuator", args->actuator, "actuator file (TOML)");
  add_trial_options(*verb, args->reading);
  verb->add_option("--accuracy", args->accuracy, "relative tolerance of the rollout [1e-9]");
  if (predict) {
    add_prediction_options(verb, args);
  } else {
    add_fit_options(verb, args);
    add_judgement_options(verb, args);
  }
  add_export(*verb, args->exports, actuator_exports());
  note_given(*verb, {args, &args->given});
  add_action<IdentifyArguments>(*verb, args,
                                predict ? "ukemi predict trial_9.csv --rig rig.toml --actuator actuator.toml -o out"
                                        : "ukemi identify trial_*.csv --rig rig.toml -o out",
                                chosen, predict ? run_predict_of : run_identify_of);
}

const Verb identify_verb(VerbGroup::kConstants, "identify", "fit the actuator's constants to impact trials",
                         [](CLI::App* verb, Action& chosen) { add_options(verb, chosen, false); });
const Verb predict_verb(VerbGroup::kConstants, "predict", "the rig's motion for given constants, against the log",
                        [](CLI::App* verb, Action& chosen) { add_options(verb, chosen, true); });

}  // namespace

}  // namespace ukemi::tools
