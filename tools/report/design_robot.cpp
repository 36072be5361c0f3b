// The results of `ukemi design` of a robot of links.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tools/report/design.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

namespace {

/// Constants by their place, and their 95 % half-widths, in parts of the value or of what they are judged by.
Quantities<std::size_t> error_bar_quantities(const RobotDesign& d) {
  return {
      {"", "", "constant", {}, [&d](auto& i) { return d.constants[i]; }},
      {"", "value", "value", "{:.6g}", [&d](auto& i) { return number(d.value[long(i)]); }},
      {"", "unit", "unit", {}, [&d](auto& i) { return d.units[i]; }},
      {"", "part_of", "in parts of", "{:.6g}", [&d](auto& i) { return number(d.part_of[long(i)]); }},
      {"", "half_width_before", "95 % before", half_width_words, [&d](auto& i) { return number(d.before[long(i)]); }},
      {"", "half_width_after", "95 % after, predicted", half_width_words,
       [&d](auto& i) { return number(d.after[long(i)]); }},
  };
}

/// The constant that is known worst.
std::string worst_of(const RobotDesign& d, const NextTrial& t) {
  if (!t.followed) return "";
  long worst = 0;
  const double width = t.half_width.maxCoeff(&worst);
  return fmt::format("{} {}", d.constants[std::size_t(worst)], half_width_words(width));
}

Quantities<NextTrial> candidate_quantities(const RobotDesign& d) {
  const auto known = [](double x, bool is) { return is ? number(x) : Json(); };
  return {
      {"rank", "rank", "rank", {}, [known](auto& t) { return known(t.rank, t.rank > 0); }},
      {"file", "file", "commands", {}, [](auto& t) { return t.file; }},
      {"together", "together", "criterion with those before it", "{:.3g}",
       [known](auto& t) { return known(t.together, t.rank > 0); }},
      {"alone", "alone", "alone", "{:.3g}", [known](auto& t) { return known(t.alone, t.followed); }},
      {"", "", "then known worst", {}, [&d](auto& t) { return worst_of(d, t); }},
      {"", "followed", [](auto& t) { return t.followed; }},
  };
}

Json noise_of(const RobotDesign& d) {
  Json out = Json::object();
  for (std::size_t o = 0; o < d.noise.size(); ++o)
    if (std::isfinite(d.noise[o])) out[d.channels[o].name] = number(d.noise[o]);
  return out;
}

}  // namespace

int report(const RobotDesign& d, Run& run) {
  std::vector<NextTrial> order = d.candidates;
  std::stable_sort(order.begin(), order.end(), [](const NextTrial& a, const NextTrial& b) {
    const auto key = [](const NextTrial& t) {
      return std::pair(t.rank > 0 ? t.rank : 1 << 20, t.followed ? t.alone : HUGE_VAL);
    };
    return key(a) < key(b);
  });
  for (const NextTrial& t : order)
    if (!t.followed) run.warn(t.file + ": the robot cannot be simulated under these commands");
  for (const std::string& doubt : d.doubts) run.warn(doubt);
  if (!d.doubts.empty()) run.warn("the trials in hand reject the robot: errors to come are larger than predicted");
  std::vector<std::size_t> places(d.constants.size());
  std::iota(places.begin(), places.end(), std::size_t(0));
  const Table bars(error_bar_quantities(d), places), candidates(candidate_quantities(d), order);
  const auto chosen = std::count_if(order.begin(), order.end(), [](auto& t) { return t.rank > 0; });
  Report report("The next trials");
  report.distrust(run.warnings());
  report.heading("What to log next");
  (void)add_table(candidates, report, run, "next.csv",
                  "Candidates, the best to log next first. together: the criterion with what is in hand and all of "
                  "lower rank; alone: with this one.");
  report.heading("Error bars, 95 %, relative");
  (void)add_table(bars, report, run);
  const Json summary = {
      {"criterion",
       {{"name", identify::name(d.criterion)}, {"before", number(d.size_before)}, {"after", number(d.size_after)}}},
      {"constants", bars.keyed()},
      {"in_hand", fmt::format("{} trials", d.in_hand)},
      {"noise", noise_of(d)},
      {"candidates", candidates.objects()}};
  FirstScreen first;
  if (chosen > 0)
    first.sentence = fmt::format("Log {} next: the criterion ({}) goes from {:.3g} to {:.3g}.", order[0].file,
                                 identify::name(d.criterion), d.size_before, d.size_after);
  else
    first.sentence = "The robot cannot be simulated under any of these commands.";
  const auto open = std::count_if(d.after.begin(), d.after.end(), [](double x) { return !std::isfinite(x); });
  first.checks = {check(open == 0, "every constant is determined then",
                        open == 0 ? "" : fmt::format("{} stay open: other commands are needed", open))};
  if (chosen > 0) first.next = "Play them on the robot, then `ukemi identify --robot` with the new logs.";
  report.answer(first, run.warnings());
  report.write(run);
  return run.finish(summary, chosen > 0 ? kDone : kNumbers);
}

}  // namespace ukemi::tools
