// Python bindings of fits and predictions.
#include <fmt/format.h>

#include "tools/python/arguments.hpp"
#include "tools/report/identify.hpp"

namespace ukemi::python {

using namespace identify;

namespace {

using tools::IdentifyQuestion;

/// A fit or a prediction with its inputs.
struct Identified {
  IdentifyQuestion question;
  Identification found;
  std::optional<Judgement> judgement = {};          ///< of a prediction
  std::optional<tools::LandingOfFit> landing = {};  ///< of a fit, if requested
};

struct IdentifyArguments : Arguments {
  std::optional<Actuator> start = {};
  double huber = 0;
  bool trial_weights = false, diagnose = false;
  std::optional<landing::Scene> scene = {};    ///< with the motion: the landing for which the effect of the
  std::optional<landing::Motion> motion = {};  ///< fit's errors is wanted
};
FitOptions options_of(const IdentifyArguments& a) {
  FitOptions o;
  o.terms = chosen_terms(std::move(o.terms), a);
  if (a.multi_turn) o.escape = Term::kInfinity;
  o.huber = a.huber, o.accuracy = a.accuracy, o.explore = a.starts, o.seed = a.seed, o.threads = a.threads;
  if (a.trial_weights) o.weights = FitOptions::Weights::kTrial;
  return o;
}

int report_of(const Identified& i, tools::Run& run) {
  if (i.judgement)
    return report(i.question, Prediction{i.found.fit, *i.judgement}, tools::Doubt::kReport, tools::Json::object(), run);
  return report(i.question, i.found, i.landing, tools::Doubt::kReport, tools::Json::object(), run);
}

Figure trial_figure(const Identified& i, std::size_t trial) {
  if (trial >= i.question.trials.size())
    throw InputError(fmt::format("trial: {}: 0 to {} is needed", trial, i.question.trials.size() - 1));
  return {tools::lines_svg("t [s]", "phi_1 [rad]",
                           tools::angle_curves(i.question.trials[trial], i.found.fit.trials[trial]))};
}

Identified identify_trials(const IdentifyArguments& a, const std::vector<Trial>& trials, const Rig& rig) {
  using enum TrustOptions::Depth;
  const FitOptions options = options_of(a);
  const std::optional<Actuator>& start = a.start;
  if (a.scene.has_value() != a.motion.has_value())
    throw InputError("scene, motion: both are needed for a landing of the fit, or none");
  Identified out{{.rig = rig, .trials = prepared(trials, rig, a.force_noise), .options = options, .given = start}, {}};
  out.question.base = tools::base_of(rig, start);
  options.validate();
  if (!start)
    for (const char* name : kConstantNames)
      if (!options.terms.fits(name))
        throw InputError(fmt::format("free: {} is not free and needs a value: give start", name));
  tools::choose_drive(out.question);
  const auto from = start ? std::optional(start->sea) : std::nullopt;
  const auto find = [&] {
    return identify::identify({out.question.rig, out.question.trials, out.question.options}, from, out.question.base,
                              {.depth = a.diagnose ? kRefit : kResiduals, .profiles = a.profile, .threads = a.threads});
  };
  out.found = monitored(find, out.question.options.monitor);
  if (a.scene && out.found.trust) {
    const py::gil_scoped_release release;
    out.landing =
        tools::landing_of_fit(*a.scene, fitted_actuator(out.question, out.found.fit), *a.motion, a.seed, a.threads);
  }
  return out;
}

/// start_angle: None (at the reference), a number [rad], or "fit".
InitialState initial_state(const py::object& start_angle) {
  using Kind = InitialState::Kind;
  if (start_angle.is_none()) return {};
  if (py::isinstance<py::str>(start_angle)) {
    if (const auto text = start_angle.cast<std::string>(); text != "fit")
      throw InputError("start_angle: " + quoted(text) + ": a number [rad], \"fit\" or None is needed");
    return {Kind::kFitted};
  }
  return {Kind::kGiven, angle("start_angle", number("start_angle", start_angle))};
}

struct PredictArguments : Arguments {
  py::object start_angle = py::none();
};
Identified predict_trials(const PredictArguments& a, const std::vector<Trial>& trials, const Rig& rig,
                          const Actuator& actuator) {
  const InitialState start = initial_state(a.start_angle);
  Identified out{{.verb = IdentifyQuestion::Verb::kPredict,
                  .rig = rig,
                  .trials = prepared(trials, rig, a.force_noise),
                  .options = {.accuracy = a.accuracy, .escape = a.multi_turn ? Term::kInfinity : kEscape},
                  .given = actuator},
                 {}};
  out.question.base = tools::base_of(rig, actuator);
  tools::choose_drive(out.question);
  out.question.options.validate();
  const py::gil_scoped_release release;
  out.question.trials = identify::with_nearer_force(rig, out.question.trials, out.question.base, out.question.options);
  if (!trials.empty()) out.found.force_smooth = out.question.trials.front().force_smooth;
  Actuator mounted = actuator;
  mounted.sea = out.question.base;
  Prediction prediction = identify::predict({rig, out.question.trials, out.question.options}, mounted, start);
  out.found.fit = std::move(prediction.fit), out.judgement = std::move(prediction.judgement);
  return out;
}

void bind_trial_fit(py::module_& m) {
  Value<TrialResult> c(m, "TrialFit", "A trial as the constants predict it.");
  c.def_readonly("name", &TrialResult::file, "Of the trial.")
      .def_readonly("rms", &TrialResult::rms, "Of the residual [rad].")
      .def_readonly("noise", &TrialResult::noise, "The log's own noise [rad].");
  column_property(c, "phi", "Predicted output angle [rad].", &TrialResult::phi);
  column_property(c, "phi_motor", "Predicted angle of the motor [rad].", &TrialResult::phi_m);
  column_property(c, "torque", "Predicted torque of the spring [Nm].", &TrialResult::torque);
}

void bind_identification(Value<Identified>& c) {
  bind_estimates(
      c, [](auto& i) -> auto& { return i.found.fit; });
  bind_profiles(c, [](auto& i) { return i.found.trust ? i.found.trust->profiles : std::vector<identify::Profile>{}; });
  property(c, "actuator", "The constants with covariance and verdicts, as actuator.toml has them.",
           [](auto& i) { return tools::fitted_actuator(i.question, i.found.fit); });
  property(c, "rms", "Of the residuals [rad].", [](auto& i) { return i.found.fit.rms; });
  property(c, "identifiable", "Whether the trials determine every fitted constant.",
           [](auto& i) { return i.found.fit.identifiable; });
  property(c, "feedback", "What the drive feeds back: the rig's, else the side whose fit is better.",
           [](auto& i) { return i.found.fit.sea.feedback; });
  property(c, "model_rejected", "Whether the residuals speak against the model.",
           [](auto& i) { return i.found.trust && i.found.trust->tests.model_rejected(); });
  c.def_property_readonly(
      "trials",
      [](const py::object& self) {
        py::list out;
        for (const TrialResult& t : self.cast<const Identified&>().found.fit.trials)
          out.append(py::cast(t, py::return_value_policy::reference_internal, self));
        return out;
      },
      "Each trial as predicted, a TrialFit.");
  property(c, "error_factor",
           "Of a prediction [1]: its error over what the logs' noise and the constants' errors allow for; at most 1: "
           "it holds. None of a fit, NaN where too little is measured.",
           [](auto& i) { return i.judgement ? std::optional(i.judgement->factor) : std::nullopt; });
  c.def("figure", &trial_figure, py::arg("trial") = 0, "Angles of a trial [rad] over time [s], measured and predicted.")
      .def(
          "_repr_svg_", [](const Identified& i) { return trial_figure(i, 0).svg; }, "What a notebook shows.");
  c.repr([](auto& i) {
    return fmt::format(" of {} trials, rms {:.3g} rad{}", i.question.trials.size(), i.found.fit.rms,
                       i.found.fit.trusted() ? ", trusted" : "");
  });
}

}  // namespace

void bind_identify(py::module_& m) {
  bind_trial_fit(m);
  Value<Identified> c(m, "Identification", "A fit of the actuator's constants, and how far it can be trusted.");
  bind_identification(c);
  property(c, "landing",
           "With a scene: what the fit's errors do to the motion's peak there [m/s^2]: peak, mean, deviation, "
           "worst_tenth; samples, failed [1]. Empty without.",
           [](auto& i) {
             std::map<std::string, double> out;
             if (const auto& l = i.landing)
               out = {{"peak", l->peak},
                      {"mean", l->mean},
                      {"deviation", l->deviation},
                      {"worst_tenth", l->worst_tenth},
                      {"samples", double(l->samples)},
                      {"failed", double(l->failed)}};
             return out;
           });
  c.def(
      "write_report",
      [](const Identified& i, const Path& folder, const std::vector<std::string>& figures) {
        return written(i, i.judgement ? tools::kPredictOutputs : tools::kIdentifyOutputs, folder, figures,
                       i.question.options.seed, report_of);
      },
      py::arg("folder"), py::arg("figures") = std::vector<std::string>{},
      report_words("identify` or `predict").c_str());
  define(
      m, "identify", &identify_trials, py::arg("trials"), py::arg("rig"), Argument{"start", &IdentifyArguments::start},
      kFree, kNuisance, kPriors, kLower, kUpper, Argument{"huber", &IdentifyArguments::huber},
      Argument{"trial_weights", &IdentifyArguments::trial_weights}, kAccuracy, kForceNoise, kMultiTurn, kStarts,
      Argument{"diagnose", &IdentifyArguments::diagnose}, kProfile, kSeed, kThreads,
      Argument{"scene", &IdentifyArguments::scene}, Argument{"motion", &IdentifyArguments::motion},
      "Fits the actuator's constants to impact trials, as `ukemi identify`. free: names of the constants that are "
      "fitted (None: all); priors: name -> (value, standard deviation); lower, upper: name -> bound, each in the "
      "term's unit; huber [rad]; force_noise [N]; threads 0: all cores; scene, motion: a landing whose peak the fit's "
      "errors move.");
  define(m, "predict", &predict_trials, py::arg("trials"), py::arg("rig"), py::arg("actuator"), kAccuracy, kForceNoise,
         kMultiTurn, Argument{"start_angle", &PredictArguments::start_angle},
         "The rig's motion for given constants [rad] beside each trial's log, and whether it holds (error_factor); as "
         "`ukemi predict`. start_angle: None, a number [rad], or \"fit\".");
}

}  // namespace ukemi::python
