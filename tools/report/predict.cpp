// Report of `ukemi predict`.
#include <fmt/format.h>

#include <cmath>

#include "tools/report/identify.hpp"
#include "tools/report/residuals.hpp"

namespace ukemi::tools {

const Outputs kPredictOutputs =
    Outputs{"predict", {"fit.csv", "contacts.csv", "landings.csv", "actuator.mjcf.xml", "actuator.urdf.xml"}}.with(
        fit_figures());

using identify::JudgedTrial, identify::Judgement, identify::Verdict;

namespace {

std::string words(double factor) {
  switch (identify::verdict_of(factor)) {
    case Verdict::kHolds:
      return "holds";
    case Verdict::kHoldsWithin:
      return fmt::format("holds within {:.2g} times the errors", factor);
    case Verdict::kDoesNotHold:
      return "does not hold";
    case Verdict::kNotMeasured:
      return "not judged: too little is measured";
  }
  return "";
}

/// The verdict in a sentence.
std::string verdict_text(const Judgement& j) {
  const char* errors = j.by_noise_alone ? "the logs' noise alone, for the actuator's file holds no covariance"
                                        : "the logs' noise and the errors of the actuator's constants";
  std::string text = fmt::format("the prediction {}", words(j.factor));
  if (std::isfinite(j.factor))
    text += fmt::format(": its error is {:.3g} times what is allowed for by {}", j.factor, errors);
  return text;
}

Quantities<JudgedTrial> verdict_quantities() {
  return {
      {"", "factor", "error over what is allowed", "{:.3g}", &JudgedTrial::factor},
      {"", "verdict", "verdict", {}, [](auto& t) { return words(t.factor); }},
  };
}

void report_verdict(const Judgement& j, const std::vector<identify::TrialResult>& trials, Report& report, Json& summary,
                    Run& run) {
  if (j.verdict() == Verdict::kDoesNotHold)
    run.warn(verdict_text(j));
  else
    run.say(verdict_text(j));
  summary["verdict"] = words(j.factor), summary["factor"] = number(j.factor);
  summary["by_noise_alone"] = j.by_noise_alone;
  const Table of_trials(trial_quantities(), trials), verdicts(verdict_quantities(), j.trials);
  summary["trials"] = of_trials.objects();
  for (std::size_t m = 0; m < j.trials.size(); ++m) summary["trials"][m].update(verdicts.object(m));
  report.heading("Does it hold?");
  report.paragraph(fmt::format(
      "{}. The factor: by so much the noise and the constants' errors would have to be larger for a residual like this "
      "one to be met once in a hundred times. The residual counts whole, over all samples: what the constants' errors "
      "can explain by their covariance, the rest by the log's own noise. At most 1: it holds; at most {:g}: it holds "
      "within so many times the errors; above: it does not hold.",
      verdict_text(j), identify::kFarAboveNoise));
  report.heading("Trials");
  report.table(of_trials);
  report.table(verdicts);
}

}  // namespace

int report(const IdentifyQuestion& q, const identify::Prediction& prediction, Doubt doubt, Json summary, Run& run) {
  const identify::Fit& fit = prediction.fit;
  const Judgement& judgement = prediction.judgement;
  for (const std::string& w : fit.warnings) run.warn(w);
  if (!fit.converged) run.warn(fit.message);
  Report report("Prediction");
  std::string sentence = verdict_text(judgement) + ".";
  sentence.front() = 'T';
  const Verdict verdict = judgement.verdict();
  report.answer({sentence,
                 {converged(fit.converged, fit.message),
                  {verdict == Verdict::kHolds         ? Check::State::kGood
                   : verdict == Verdict::kHoldsWithin ? Check::State::kCaution
                   : verdict == Verdict::kDoesNotHold ? Check::State::kBad
                                                      : Check::State::kUnknown,
                   "held-out trials are met", words(judgement.factor)},
                  {judgement.by_noise_alone ? Check::State::kUnknown : Check::State::kGood,
                   "the constants' errors are known", ""}},
                 verdict == Verdict::kHolds ? "`ukemi optimize` plans a landing with this actuator."
                                            : "`ukemi identify --diagnose` looks for what the model lacks."},
                run.warnings());
  begin_report(fit, estimate_quantities(), report, summary, run);
  run.say(assumptions(q));
  run.say(fmt::format("residual rms {:.6g} rad over {} trials", fit.rms, q.trials.size()));
  summary["force_curve"] = q.trials.front().force_smooth > 0 ? "smooth" : "linear";
  summary["rms"] = number(fit.rms);
  summary["identifiable"] = fit.identifiable;
  summary["minima"] = Json::array();
  summary["assumed"] = assumptions(q);
  report_verdict(judgement, fit.trials, report, summary, run);
  report.figure(trials_figure(q.trials, fit, &judgement));
  for (Figure& f : residual_figures(q.trials, fit)) report.figure(std::move(f));
  Actuator mounted = *q.given;
  mounted.sea = q.base;
  for (auto& [name, content] : exported(q.exports, mounted, {q.rig.length, q.rig.inertia}, run)) run.add(name, content);
  run.add("fit.csv", fit_csv(run, q.trials, fit, &judgement));
  report.write(run);
  const bool doubted = doubt == Doubt::kFail && judgement.verdict() == Verdict::kDoesNotHold;
  return run.finish(summary, fit.converged && !doubted ? kDone : kNumbers);
}

}  // namespace ukemi::tools
