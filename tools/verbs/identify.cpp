// ukemi identify, ukemi predict.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/error.hpp"
#include "identify/rig/rig.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/identify_report.hpp"
#include "tools/report/trust.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

namespace {

void parse_bounds(const std::string& option, const std::string& list, std::array<double, kConstants>& bounds) {
  for (const std::string& item : split(list)) {
    const Assignment bound = assignment(option, item);
    bounds[constant_index(option, bound.name)] = to_number(option, bound.value);
  }
}

identify::NuisanceTerm nuisance_term(const std::string& wanted) {
  std::vector<std::string> known;
  for (const identify::NuisanceTerm t : identify::kNuisanceTerms) {
    if (name(t) == wanted) return t;
    known.push_back(name(t));
  }
  throw InputError("--nuisance: " + one_of(wanted, known));
}

identify::FitOptions fit_options(const IdentifyArguments& a, const CommonOptions& common) {
  identify::FitOptions o;
  o.seed = common.seed;
  o.accuracy = a.accuracy;
  o.escape = escape_of(a.reading);
  if (!a.free.empty()) {
    o.free.fill(false);
    for (const std::string& name : split(a.free)) o.free[constant_index("--free", name)] = true;
  }
  for (const std::string& name : split(a.nuisance)) o.nuisance.push_back(nuisance_term(name));
  for (const std::string& item : split(a.prior)) {
    const NamedPrior known = named_prior("--prior", item);
    o.prior[constant_index("--prior", known.name)] = identify::Prior{known.value, known.std};
  }
  o.explore = a.starts;
  o.threads = common.threads;
  parse_bounds("--lower", a.lower, o.lower);
  parse_bounds("--upper", a.upper, o.upper);
  if (a.loss.rfind("huber:", 0) == 0) {
    o.huber = to_number("--loss", a.loss.substr(6));
    if (!(o.huber > 0)) throw InputError("--loss: " + quoted(a.loss) + ": Huber's delta must be above 0 rad");
  } else if (a.loss != "none") {
    throw InputError("--loss: " + quoted(a.loss) + ": none or huber:DELTA is needed");
  }
  using enum identify::FitOptions::Weights;
  o.weights = choice<identify::FitOptions::Weights>("--weights", a.weights, {{"equal", kEqual}, {"trial", kTrial}});
  o.validate();
  return o;
}

}  // namespace

int run_identify(const IdentifyArguments& a, const CommonOptions& common, Actuator* fitted) {
  const bool predict = !a.actuator.empty();
  Run run(predict ? "predict" : "identify", common);
  const identify::Rig rig = identify::read_rig(a.rig);
  run.input(a.rig);
  const std::string& given = predict ? a.actuator : a.start;
  std::optional<Actuator> start;
  if (!given.empty()) {
    start = predict ? actuator_of(given, run) : read_actuator(given);
    run.input(given);
  }
  identify::FitOptions options = fit_options(a, common);
  options.monitor = run.monitor("identify");
  for (const std::string& name : split(a.trust.profile)) {
    if (!options.free[constant_index("--profile", name)])
      throw InputError("--profile: " + name + ": it is not among the --free constants");
    if (std::count(options.free.begin(), options.free.end(), true) == 1)
      throw InputError("--profile: " + name + ": no other constant is free to follow it");
  }
  if (!predict && !start)
    for (int i = 0; i < kConstants; ++i)
      if (!options.free[std::size_t(i)])
        throw InputError("--free: " + std::string(kConstantNames[std::size_t(i)]) +
                         " is not free and needs a value: give --start");
  // From rest, a trial without excitation says nothing; one that is let go from elsewhere does.
  const bool from_rest =
      !options.fits(identify::NuisanceTerm::kInitialAngle) && !options.fits(identify::NuisanceTerm::kInitialRate);
  TrialNeeds needs;
  if (predict) needs.phi = TrialNeeds::Angle::kOptional;
  if (!predict && from_rest) needs.excitation = TrialNeeds::Excitation::kRequired;
  TrialInputs inputs = read_trials(a.trials, a.reading, rig, needs, run);
  const std::vector<identify::Trial>& trials = inputs.trials;

  // tau_max and feedback: the rig's, else the given actuator's, else no limit and Eq. 3 as printed.
  SeaParameters<double> base{};
  if (start) base = start->sea;
  base.tau_max = rig.tau_max.value_or(base.tau_max);
  base.feedback = rig.feedback.value_or(base.feedback);
  const std::string assumed = fmt::format(
      "tau_max: {}; Eq. 3 feeds back the {} angle ({})",
      std::isfinite(base.tau_max) ? fmt::format("{:g} Nm ({})", base.tau_max, rig.tau_max ? "rig" : "actuator")
                                  : std::string("no limit (neither rig nor actuator names one)"),
      name(base.feedback),
      rig.feedback ? "rig"
      : start      ? "actuator"
                   : "default");

  run.info(fmt::format("{} {} trials", predict ? "predicting" : "fitting", trials.size()));
  identify::Fit fit = predict
                          ? identify::predict(rig, trials, base, options)
                          : identify::fit(rig, trials, start ? std::optional(start->sea) : std::nullopt, base, options);
  for (const std::string& w : fit.warnings) run.warn(w);
  if (!fit.converged && predict) run.warn(fit.message);
  if (!fit.converged && !predict && !fit.interrupted)
    run.warn("not converged: " + fit.message + "; try another --start, more trials, or fewer --free constants");
  const bool found = predict || !fit.fitted.empty();
  if (!found) run.warn("nothing was found: no actuator.toml is written");
  std::optional<Trust> trust;
  if (!predict && found) trust = examine({rig, trials, options}, fit, a.trust, run);

  Json parameters, nuisance = Json::object(), rows = Json::array();
  for (const auto& e : fit.parameters) {
    parameters[e.name] = estimate_json(e);
    if (!predict) parameters[e.name]["verdict"] = identify::name(e.verdict);
    run.say(fmt::format("{:8} {:28} {:12} {}", e.name, text_of(e), e.unit, predict ? "" : identify::name(e.verdict)));
  }
  for (const auto& e : fit.nuisance) {
    if (e.trial < 0)
      nuisance[e.name] = estimate_json(e);
    else
      nuisance[e.name].push_back(estimate_json(e));
    run.say(fmt::format("{:8} {:28} {}", e.trial < 0 ? e.name : fmt::format("{}[{}]", e.name, e.trial + 1), text_of(e),
                        e.unit));
  }
  for (const auto& t : fit.trials)
    rows.push_back({{"file", t.file}, {"samples", t.samples}, {"rms", number(t.rms)}, {"noise", number(t.noise)}});
  run.say(assumed);
  if (options.fits(identify::NuisanceTerm::kFriction) || base.friction > 0)
    run.say(fmt::format("dry friction smoothed below v_s = {} rad/s", kFrictionSpeed));
  if (options.explore > 0)
    for (const identify::Minimum& m : fit.minima)
      run.say(fmt::format(
          "minimum of cost {:.9g} rad^2, found by {} of {} starts: k_p {:.5g} k_d {:.5g} k_sea {:.5g} c_sea "
          "{:.5g} i_motor {:.5g}",
          m.cost, m.found, fit.starts, m.sea.k_p, m.sea.k_d, m.sea.k_sea, m.sea.c_sea, m.sea.i_motor));
  run.say(fmt::format("residual rms {:.6g} rad over {} trials", fit.rms, trials.size()));
  if (trust) say(*trust, fit, run);

  Json summary = std::move(inputs.summary);
  summary["parameters"] = parameters;
  summary["nuisance"] = nuisance;
  summary["rms"] = number(fit.rms);
  summary["cost"] = number(fit.cost);
  summary["converged"] = fit.converged;
  summary["iterations"] = fit.iterations;
  summary["identifiable"] = fit.identifiable;
  if (!predict) summary["trusted"] = fit.trusted();
  if (trust) summary["weakest"] = weakest_json(fit), summary["diagnostics"] = diagnostics_json(*trust, fit);
  summary["starts"] = fit.starts;
  summary["minima"] = minima_json(fit);
  summary["assumed"] = assumed;
  summary["friction_speed"] = kFrictionSpeed;
  summary["fitted"] = fit.fitted;
  summary["correlation"] = matrix_json(fit.correlation);
  summary["eigenvalues"] = std::vector<double>(fit.eigenvalues.begin(), fit.eigenvalues.end());
  summary["trials"] = rows;

  Actuator out;
  out.name = predict ? start->name : fmt::format("identified from {} trials", trials.size());
  out.sea = fit.sea;
  if (start) out.speed_max = start->speed_max;
  if (rig.speed_max) out.speed_max = rig.speed_max;
  for (const identify::Estimate& e : fit.parameters)
    if (!predict) out.verdicts.emplace_back(e.name, identify::name(e.verdict));
  // Only what was determined goes into the covariance, of the actuator: a file holds numbers, not gaps.
  std::vector<long> determined;
  for (long i = 0; i < fit.covariance.rows(); ++i) {
    const std::string& term = fit.fitted[std::size_t(i)];
    if (!std::isfinite(fit.covariance(i, i)) || term == name(identify::NuisanceTerm::kForceGain)) continue;
    determined.push_back(i);
    out.uncertain.push_back(term == name(identify::NuisanceTerm::kStiffening) ? "k_sea_cubic" : term);
  }
  out.covariance = fit.covariance(determined, determined);
  out.provenance = run.provenance();
  if (!predict && found) {
    out.provenance.emplace_back("converged", fit.converged ? "true" : "false: these constants are not a minimum");
    run.add("actuator.toml", to_toml(out, fit.half_width));
  }
  run.add("fit.csv", fit_csv(run, trials, fit));
  run.add("report.html", identification_html(run, predict ? "Prediction" : "Identification", trials, fit, trust));
  if (trust && !trust->profiles.empty()) run.add("profile.csv", profile_csv(*trust, run));
  if (fitted) *fitted = out;
  const bool doubted = !predict && a.trust.doubt == TrustArguments::Doubt::kFail && !fit.trusted();
  return run.finish(summary, fit.converged && !doubted ? kDone : kNumbers);
}

void add_identify(CLI::App& app, Action& chosen) {
  for (const bool predict : {false, true}) {
    auto args = std::make_shared<IdentifyArguments>();
    auto common = std::make_shared<CommonOptions>();
    CLI::App* verb = predict ? app.add_subcommand("predict", "the rig's motion for given constants, against the log")
                             : app.add_subcommand("identify", "fit the actuator's constants to impact trials");
    verb->add_option(
            "TRIAL", args->trials,
            "trial files: CSV (t [s], phi [rad], force [N] and/or phi_ref [rad]), HEBI .hebilog or its CSV export")
        ->required();
    verb->add_option("--rig", args->rig, "rig file (TOML)")->required();
    if (predict) verb->add_option("--actuator", args->actuator, "actuator file (TOML)")->required();
    add_trial_options(*verb, args->reading);
    verb->add_option("--accuracy", args->accuracy, "relative tolerance of the rollout [1e-9]");
    if (!predict) {
      verb->add_option("--start", args->start, "actuator file to start from [worked out from the rig and the trials]");
      verb->add_option("--free", args->free, "constants that are fitted [k_p,k_d,k_sea,c_sea,i_motor]");
      verb->add_option("--nuisance", args->nuisance,
                       "fitted along: friction, viscous_friction, stiffening, force_gain (one for all trials); "
                       "initial_angle, initial_rate, "
                       "encoder_offset, force_bias, time_shift (a trial each)");
      verb->add_option("--prior", args->prior,
                       "k_sea=65:5,...: what is known beforehand, VALUE:STD, counted like a measurement");
      verb->add_option(
              "--starts", args->starts,
              "explore: so many starts within 10x of --start or of what the logs suggest, and every minimum found")
          ->check(CLI::Range(1, 100'000));
      verb->add_option("--lower", args->lower, "k_p=0,...: lower bounds [0]");
      verb->add_option("--upper", args->upper, "k_p=200,...: upper bounds [none]");
      verb->add_option("--loss", args->loss, "none or huber:DELTA, DELTA in rad [none]");
      verb->add_option("--weights", args->weights, "equal, or trial: 1 / each trial's own residual variance [equal]");
      add_trust_options(*verb, args->trust);
    }
    add_common(*verb, *common);
    verb->footer(predict ? "Example: ukemi predict trial_9.csv --rig rig.toml --actuator actuator.toml -o out"
                         : "Example: ukemi identify trial_*.csv --rig rig.toml -o out");
    verb->callback([args, common, &chosen] { chosen = [args, common] { return run_identify(*args, *common); }; });
  }
}

}  // namespace ukemi::tools
