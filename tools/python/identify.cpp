// Python bindings of fits and predictions.
#include <fmt/format.h>

#include "tools/python/trials.hpp"
#include "tools/python/value.hpp"
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

/// The landing for which the effect of the fit's errors is wanted.
struct LandingArguments {
  std::optional<landing::Scene> scene;
  std::optional<landing::Motion> motion;
};

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

Identified identify_trials(const std::vector<Trial>& trials, const Rig& rig, const std::optional<Actuator>& start,
                           const FitOptions& options, const TrustOptions& trust, std::optional<double> force_noise,
                           const LandingArguments& landing) {
  if (landing.scene.has_value() != landing.motion.has_value())
    throw InputError("scene, motion: both are needed for a landing of the fit, or none");
  Identified out{{.rig = rig, .trials = prepared(trials, rig, force_noise), .options = options, .given = start}, {}};
  out.question.base = tools::base_of(rig, start);
  options.validate();
  if (!start)
    for (const char* name : kConstantNames)
      if (!options.terms.fits(name))
        throw InputError(fmt::format("free: {} is not free and needs a value: give start", name));
  tools::choose_drive(out.question);
  const auto from = start ? std::optional(start->sea) : std::nullopt;
  out.found = long_call([&](const std::function<bool()>& stop) {
    out.question.options.monitor.stop = stop;
    return identify::identify({out.question.rig, out.question.trials, out.question.options}, from, out.question.base,
                              trust);
  });
  if (landing.scene && out.found.trust) {
    const py::gil_scoped_release release;
    out.landing = tools::landing_of_fit(*landing.scene, fitted_actuator(out.question, out.found.fit), *landing.motion,
                                        options.seed, options.threads);
  }
  out.question.options.monitor = {};
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

Identified predict_trials(const std::vector<Trial>& trials, const Rig& rig, const Actuator& actuator, double accuracy,
                          std::optional<double> force_noise, bool multi_turn, const py::object& start_angle) {
  const InitialState start = initial_state(start_angle);
  Identified out{{.verb = IdentifyQuestion::Verb::kPredict,
                  .rig = rig,
                  .trials = prepared(trials, rig, force_noise),
                  .options = {.accuracy = accuracy, .escape = multi_turn ? Term::kInfinity : kEscape},
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
  py::class_<TrialResult> c(m, "TrialFit", "A trial as the constants predict it.");
  c.def_readonly("name", &TrialResult::file, "Of the trial.")
      .def_readonly("rms", &TrialResult::rms, "Of the residual [rad].")
      .def_readonly("noise", &TrialResult::noise, "The log's own noise [rad].");
  column_property(c, "phi", "Predicted output angle [rad].", &TrialResult::phi);
  column_property(c, "phi_motor", "Predicted angle of the motor [rad].", &TrialResult::phi_m);
  column_property(c, "torque", "Predicted torque of the spring [Nm].", &TrialResult::torque);
  bind_value(c);
}

void bind_landing_of_fit(py::class_<Identified>& c) {
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
}

void bind_identification(py::class_<Identified>& c) {
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
          "_repr_svg_", [](const Identified& i) { return trial_figure(i, 0).svg; }, "What a notebook shows.")
      .def("__repr__", [](const Identified& i) {
        return fmt::format("<ukemi.Identification of {} trials, rms {:.3g} rad{}>", i.question.trials.size(),
                           i.found.fit.rms, i.found.fit.trusted() ? ", trusted" : "");
      });
}

}  // namespace

void bind_identify(py::module_& m) {
  bind_trial_fit(m);
  py::class_<Identified> c(m, "Identification", "A fit of the actuator's constants, and how far it can be trusted.");
  bind_identification(c);
  bind_landing_of_fit(c);
  bind_value(c);
  c.def(
      "write_report",
      [](const Identified& i, const Path& folder, const std::vector<std::string>& figures) {
        return written(i, i.judgement ? tools::kPredictOutputs : tools::kIdentifyOutputs, folder, figures,
                       i.question.options.seed, report_of);
      },
      py::arg("folder"), py::arg("figures") = std::vector<std::string>{},
      report_words("identify` or `predict").c_str());
  m.def(
      "identify",
      [](const std::vector<Trial>& trials, const Rig& rig, const std::optional<Actuator>& start,
         const std::optional<std::vector<std::string>>& free, const std::vector<std::string>& nuisance,
         const Priors& priors, const Bounds& lower, const Bounds& upper, double huber, bool trial_weights,
         double accuracy, std::optional<double> force_noise, bool multi_turn, int starts, bool diagnose,
         const std::vector<std::string>& profile, std::uint64_t seed, int threads,
         const std::optional<landing::Scene>& scene, const std::optional<landing::Motion>& motion) {
        FitOptions o;
        o.terms = chosen_terms(std::move(o.terms), free, nuisance, priors, lower, upper);
        if (multi_turn) o.escape = Term::kInfinity;
        o.huber = huber, o.accuracy = accuracy, o.explore = starts, o.seed = seed, o.threads = threads;
        if (trial_weights) o.weights = FitOptions::Weights::kTrial;
        using enum TrustOptions::Depth;
        return identify_trials(trials, rig, start, o,
                               {.depth = diagnose ? kRefit : kResiduals, .profiles = profile, .threads = threads},
                               force_noise, {scene, motion});
      },
      py::arg("trials"), py::arg("rig"), py::arg("start") = py::none(), py::arg("free") = py::none(),
      py::arg("nuisance") = std::vector<std::string>{}, py::arg("priors") = Priors{}, py::arg("lower") = Bounds{},
      py::arg("upper") = Bounds{}, py::arg("huber") = 0.0, py::arg("trial_weights") = false, py::arg("accuracy") = 1e-9,
      py::arg("force_noise") = py::none(), py::arg("multi_turn") = false, py::arg("starts") = 0,
      py::arg("diagnose") = false, py::arg("profile") = std::vector<std::string>{}, py::arg("seed") = 1,
      py::arg("threads") = 0, py::arg("scene") = py::none(), py::arg("motion") = py::none(),
      "Fits the actuator's constants to impact trials, as `ukemi identify`. free: names of the constants that are "
      "fitted (None: all); priors: name -> (value, standard deviation); lower, upper: name -> bound, each in the "
      "term's unit; huber [rad]; force_noise [N]; threads 0: all cores; scene, motion: a landing whose peak the fit's "
      "errors move.");
  m.def("predict", &predict_trials, py::arg("trials"), py::arg("rig"), py::arg("actuator"), py::arg("accuracy") = 1e-9,
        py::arg("force_noise") = py::none(), py::arg("multi_turn") = false, py::arg("start_angle") = py::none(),
        "The rig's motion for given constants [rad] beside each trial's log, and whether it holds (error_factor); as "
        "`ukemi predict`. start_angle: None, a number [rad], or \"fit\".");
}

}  // namespace ukemi::python
