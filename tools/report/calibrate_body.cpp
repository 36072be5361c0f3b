#include <fmt/format.h>

#include <cmath>

#include "tools/report/body_scene_text.hpp"
#include "tools/report/calibrate.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

Quantities<TriedLaw> law_quantities() {
  return {
      {"", "law", "law", {}, [](auto& t) { return words(t.law); }},
      {"", "converged", &TriedLaw::converged},
      {"", "rms", "residual rms, in the logs' noise", "{:.4g}", [](auto& t) { return number(t.rms); }},
      {"", "fitted", "numbers fitted", "{}", &TriedLaw::fitted},
      {"", "bic", "BIC, less that of the scene's law", "{:.1f}", [](auto& t) { return number(t.bic); }},
      {"", "held_out", "rms of drops left out", "{:.4g}", [](auto& t) { return number(t.held_out); }},
      {"", "rejected", "its own residuals", {}, [](auto& t) { return t.rejected ? "reject it" : "do not reject it"; }}};
}

/// Which contact law the drops support best, and why.
std::string finding(const BodyCalibration& c) {
  const TriedLaw &given = c.laws.front(), &best = c.laws[c.best_law];
  if (c.best_law == 0)
    return fmt::format("of {} laws that were tried none is better than the scene's ({}){}", c.laws.size(),
                       words(given.law),
                       given.rejected ? "; but its residuals reject it too: the floor is none of these" : "");
  return fmt::format(
      "the drops ask for another law: {}, not {}: BIC {:.0f} lower, residuals {:.3g} in place of {:.3g} times the "
      "logs' noise{}{}; {}",
      words(best.law), words(given.law), -best.bic, best.rms, given.rms,
      std::isfinite(best.held_out)
          ? fmt::format(", of drops left out {:.3g} in place of {:.3g}", best.held_out, given.held_out)
          : ", and no drop could be left out to test it",
      best.rejected ? "; its own residuals reject it too" : "",
      c.scene_law == c.best_law ? "the constants and scene.toml are of that law" : "--law asked fits and writes it");
}

/// Reports the tried laws: table, JSON, finding.
void report_laws(const BodyCalibration& c, Report& report, Json& summary, Run& run) {
  if (c.laws.empty()) return;
  const Table laws(law_quantities(), c.laws);
  summary["laws"] = laws.objects();
  summary["law"] = {{"given", words(c.laws.front().law)}, {"asked", words(c.laws[c.best_law].law)}};
  summary["law_rejected"] = c.law_rejected();
  if (c.laws.size() < 2) return;
  report.heading("Which law do the drops ask for?");
  report.table(laws);
  const std::string text = finding(c);
  report.paragraph(text + ".");
  if (c.best_law == c.scene_law)
    run.say(text);
  else
    run.warn(text);
}

}  // namespace

int report(const std::string& path, const BodyCalibratedDrops& fitted,
           const std::optional<BodyCalibratedDrops>& validation, Doubt doubt, Run& run) {
  const BodyCalibration& c = fitted.result;
  BodyScene scene = c.scene;
  scene.source = "calibrated from drop logs by ukemi";
  return report(
      texts_of(fitted), validation ? std::optional(texts_of(*validation)) : std::nullopt, doubt,
      path.empty() ? std::map<std::string, std::string>{}
                   : scene_files(path, scene, scene_comments(run, c), run.folder()),
      [&](Report& page, Json& summary) { report_laws(c, page, summary, run); }, run);
}

}  // namespace ukemi::tools
