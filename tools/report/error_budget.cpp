// Error budget of a fit: the logs' noise and the rig's stated errors.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "tools/report/identify.hpp"

namespace ukemi::tools {

using identify::ErrorBudget;
using identify::Fit;
using identify::Rig;
using identify::RigErrorKey;

namespace {

/// The rig's stated errors: "inertia 1 %, ..., delay 1 ms".
std::string errors_in_words(const Rig& rig) {
  std::vector<std::string> out;
  for (const auto& [key, at, unit] : identify::rig_error_keys())
    if (const double error = rig.errors.*at; error > 0)
      out.push_back(unit == RigErrorKey::Unit::kPart ? fmt::format("{} {:g} %", key, 100 * error)
                                                     : fmt::format("{} {:g} ms", key, 1e3 * error));
  return out.empty() ? "none, exact" : fmt::format("{}", fmt::join(out, ", "));
}

/// The term of a source of error: a key of the rig's [errors], or the name of a fitted term; null: none.
const identify::RigTerm* term_of(const std::string& source) {
  for (const identify::RigTerm& t : identify::rig_terms())
    if ((t.error && t.error->key == source) || t.name == source) return &t;
  return nullptr;
}

/// The largest source of error of the constant with the largest relative error, and how to reduce it.
std::string what_to_measure(const Fit& fit, const std::vector<ErrorBudget>& budget) {
  const auto relative = [&](const ErrorBudget& b) {
    const identify::Estimate* e = find_constant(fit, b.constant);
    return e->half_width() / std::abs(e->value);
  };
  const ErrorBudget& worst =
      *std::max_element(budget.begin(), budget.end(), [&](auto& a, auto& b) { return relative(a) < relative(b); });
  const auto& [source, share] =
      *std::max_element(worst.shares.begin(), worst.shares.end(), [](auto& a, auto& b) { return a.second < b.second; });
  const std::string text = fmt::format("{} is known least, within {:.2g} %: {:.0f} % of its variance is {}",
                                       worst.constant, 100 * relative(worst), 100 * share, source);
  const identify::RigTerm* term = term_of(source);
  if (!term || term->measure.empty()) return text + ": more hits, or harder ones, say more (`ukemi design`)";
  const bool fitted = std::ranges::count(fit.fitted, term->name) > 0;
  return fmt::format("{}: {}, and state it with its error in the rig file{}", text, term->measure,
                     fitted ? "" : fmt::format(", or fit it along (--nuisance {})", term->name));
}

}  // namespace

std::string experiments(const std::vector<std::string>& terms) {
  std::vector<std::string> out;
  for (const identify::RigTerm& t : identify::rig_terms())
    if (std::find(terms.begin(), terms.end(), t.name) != terms.end() && !t.measure.empty()) out.push_back(t.measure);
  return fmt::format("{}", fmt::join(out, "; or "));
}

void report_error_budget(const Rig& rig, const Fit& fit, Report& report, Json& summary, Run& run) {
  for (const auto& [key, at, unit] : identify::rig_error_keys()) summary["rig_errors"][key] = rig.errors.*at;
  run.say("errors of the rig, standard deviations ([errors] of its file): " + errors_in_words(rig));
  const std::vector<ErrorBudget> budget = report_error_shares(
      fit, "as far as the rig states its error (" + errors_in_words(rig) + ")", report, summary, run);
  if (budget.empty() || fit.considered.empty()) return;
  const std::string advice = what_to_measure(fit, budget);
  run.say(advice), report.paragraph(advice + ".");
}

}  // namespace ukemi::tools
