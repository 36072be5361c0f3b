#include "tools/report/first_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "common/degrees.hpp"
#include "landing/judge/answer.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/page/page.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::tools {

using State = Check::State;

namespace {

/// Class in style.css, symbol and word of a state.
struct Sign {
  const char *css, *symbol, *word;
};
Sign sign_of(State s) {
  switch (s) {
    case State::kGood:
      return {"good", "✓", "yes"};
    case State::kCaution:
      return {"caution", "!", "caution"};
    case State::kBad:
      return {"bad", "✗", "no"};
    case State::kUnknown:
      break;
  }
  return {"unknown", "?", "not known"};
}

std::string item(const Check& c) {
  const Sign s = sign_of(c.state);
  return fmt::format("<li class=\"{}\"><b><span class=\"sign\">{}</span> {}: {}</b>{}</li>", s.css, s.symbol,
                     prose(c.what), s.word, c.words.empty() ? "" : " — " + prose(c.words));
}

/// The worst peak within the execution tolerance, judged as in optimize.cpp's `warn`.
Check inexact_execution_check(const landing::Answer& a) {
  constexpr const char* kWhat = "holds when played inexactly";
  const double worst = a.best.tolerant.value;
  if (!a.tolerant_known) return {State::kUnknown, kWhat, "not played"};
  const State state = worst <= kWorse * a.peak() ? State::kGood : worst < a.held_peak() ? State::kCaution : State::kBad;
  return {state, kWhat,
          fmt::format("up to {} m/s^2 within {:g} deg, {:g} ms", short_peak_words(worst),
                      a.scene.execution.phi * kDegrees, a.scene.execution.duration * 1e3)};
}

}  // namespace

Check check(bool passed, const std::string& what, const std::string& words) {
  return {passed ? State::kGood : State::kBad, what, words};
}

Check within_ratings(const std::optional<landing::Ratings>& ratings) {
  constexpr const char* kWhat = "within ratings";
  if (!ratings) return {State::kUnknown, kWhat, "the landing was not played"};
  const landing::Ratings& r = *ratings;
  const double speed = std::max(r.reference_rate, r.demands.motor_speed);
  const auto rating_words = [](const std::optional<double>& rated, const char* unit) {
    return rated ? fmt::format(" of {:.3g} {}", *rated, unit) : fmt::format(" {}, rating unknown", unit);
  };
  const std::string words = fmt::format("speed {:.3g}{}; torque {:.3g}{}", speed, rating_words(r.speed_max, "rad/s"),
                                        r.demands.motor_torque, rating_words(r.motor_torque_max, "Nm"));
  const State state = r.too_fast() || r.too_strong()      ? State::kBad
                      : r.speed_max && r.motor_torque_max ? State::kGood
                                                          : State::kUnknown;
  return {state, kWhat, words};
}

Check converged(bool converged, const std::string& message) {
  return check(converged, "converged", converged ? "" : message);
}
Check converged(const landing::Sensitivity& s, bool wrong) {
  constexpr const char* kWhat = "converged";
  if (!s.checked) return {State::kUnknown, kWhat, "not checked"};
  return {wrong         ? State::kBad
          : s.sensitive ? State::kCaution
                        : State::kGood,
          kWhat,
          fmt::format("relative error of the peak {:.1g}{}", s.error_estimate,
                      s.sensitive ? "; a slightly different drop lands otherwise" : "")};
}

const char* goal_name(bool rated) { return rated ? "largest load" : "peak"; }
const char* goal_unit(bool rated) { return rated ? "of the rating" : "m/s^2"; }
std::string goal_text(double value, bool rated) { return fmt::format("{:.4g} {}", value, goal_unit(rated)); }

Check under_scatter_check(double planned, double held, bool rated) {
  constexpr const char* kWhat = "holds under scatter";
  if (!std::isfinite(held)) return {State::kUnknown, kWhat, "holding still could not be followed"};
  constexpr double kRounding = 1e-9;  // the held posture, played as a plan, is no worse than itself
  return check(planned <= (1 + kRounding) * held, kWhat,
               fmt::format("worst tenth of drops {}, holding still {:.4g}", goal_text(planned, rated), held));
}

Check keeps_limits_check(double kept, long drops, const std::string& which, const std::optional<double>& asked) {
  const double share = asked.value_or(1), margin = 3 * std::sqrt(share * (1 - share) / double(drops));
  return {kept >= share            ? State::kGood
          : kept >= share - margin ? State::kCaution
                                   : State::kBad,
          "keeps its limits under scatter",
          fmt::format("limits hold in {:.2f} % of {} {}{}", 100 * kept, drops, which,
                      asked ? fmt::format("; asked {:g} %", 100 * *asked) : "")};
}

std::string promised_words(const std::string& measure, double value) {
  return fmt::format(" Over the drops that it is planned for {:.4g} ({}).", value, measure);
}

FirstScreen first_screen(const landing::Answer& a) {
  FirstScreen out{.sentence = std::isfinite(a.peak())
                                  ? landing_sentence(a.peak(), a.held_peak())
                                  : fmt::format("The {} is {:.4g} m/s^2: there was no time to play the landing itself.",
                                                goal_words(a.options), a.best.value)};
  out.checks = {check(a.best.verified, "verified", "judged at a tight accuracy after the search"),
                within_ratings(a.ratings), inexact_execution_check(a)};
  if (a.under_scatter) {
    const landing::UnderScatter& u = *a.under_scatter;
    out.sentence += fmt::format(" In the worst tenth of drops {:.4g}.", u.planned.cvar90.value);
    out.checks.push_back(
        under_scatter_check(u.planned.cvar90.value, std::min(u.held.cvar90.value, u.posture.cvar90.value)));
    if (const long drops = u.planned.samples; a.options.search.limits.any())
      out.checks.push_back(keeps_limits_check(1 - double(u.broken) / double(drops), drops,
                                              a.scatter ? "fresh drops" : "measured drops"));
  } else {
    if (a.scattered) out.sentence += promised_words(a.options.robust.measure->name(), a.best.value);
    out.checks.push_back({State::kUnknown, "holds under scatter", "not played"});
  }
  out.next = "`ukemi risk` with --motion motion.toml plays it over many drops.";
  return out;
}

void say(const FirstScreen& screen, const std::vector<std::string>& lines, const Table& details, const Run& run) {
  run.say(screen.sentence);
  for (const std::string& line : lines) run.say(line);
  if (run.options().lines == CommonOptions::Lines::kAll) say(details, run);
}

std::string html(const FirstScreen& f, std::size_t warnings) {
  std::string out = "<section class=\"answer\"><p class=\"sentence\">" + prose(f.sentence) + "</p>\n<ul>";
  for (const Check& c : f.checks) out += item(c);
  out += item({warnings == 0 ? State::kGood : State::kCaution, "no warnings",
               warnings == 0 ? "" : fmt::format("{} under “What to distrust”", warnings)});
  out += "</ul>\n";
  if (!f.next.empty())
    out += "<p class=\"next\"><b>Next:</b> " +
           std::regex_replace(prose(f.next), std::regex("`([^`]*)`"), "<code>$1</code>") + "</p>\n";
  return out + "</section>\n";
}

}  // namespace ukemi::tools
