// Report of `ukemi design` for robots of links.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tools/report/design.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

namespace {

/// Columns of a constant, given by its index: 95 % half-widths relative to its value or to `part_of`.
Quantities<std::size_t> error_bar_quantities(const RobotDesign& d) {
  return {
      {"", "", "constant", {}, [&d](auto& i) { return d.constants[i]; }},
      {"", "value", "value", "{:.6g}", [&d](auto& i) { return number(d.value[long(i)]); }},
      {"", "unit", "unit", {}, [&d](auto& i) { return d.units[i]; }},
      {"", "part_of", "in parts of", "{:.6g}", [&d](auto& i) { return number(d.scale[long(i)]); }},
      {"", "half_width_before", "95 % before", half_width_words, [&d](auto& i) { return number(d.before[long(i)]); }},
      {"", "half_width_after", "95 % after, predicted", half_width_words,
       [&d](auto& i) { return number(d.after[long(i)]); }},
  };
}

/// The constant with the largest relative half-width, and that.
std::string worst_of(const RobotDesign& d, const CandidateTrial& t) {
  if (!t.followed) return "";
  long worst = 0;
  const double width = t.half_width.maxCoeff(&worst);
  return fmt::format("{} {}", d.constants[std::size_t(worst)], half_width_words(width));
}

Quantities<CandidateTrial> candidate_quantities(const RobotDesign& d) {
  const auto number_if = [](double x, bool condition) { return condition ? number(x) : Json(); };
  return {
      {"rank", "rank", "rank", {}, [number_if](auto& t) { return number_if(t.rank, t.rank > 0); }},
      {"file", "file", "commands", {}, [](auto& t) { return t.file; }},
      {"together", "together", "criterion with those before it", "{:.3g}",
       [number_if](auto& t) { return number_if(t.together, t.rank > 0); }},
      {"alone", "alone", "alone", "{:.3g}", [number_if](auto& t) { return number_if(t.alone, t.followed); }},
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
  std::vector<CandidateTrial> order = d.candidates;
  std::stable_sort(order.begin(), order.end(), [](const CandidateTrial& a, const CandidateTrial& b) {
    const auto key = [](const CandidateTrial& t) {
      return std::pair(t.rank > 0 ? t.rank : 1 << 20, t.followed ? t.alone : HUGE_VAL);
    };
    return key(a) < key(b);
  });
  for (const CandidateTrial& t : order)
    if (!t.followed) run.warn(t.file + ": the robot cannot be simulated under these commands");
  for (const std::string& doubt : d.doubts) run.warn(doubt);
  if (!d.doubts.empty()) run.warn("the trials in hand reject the robot: errors to come are larger than predicted");
  std::vector<std::size_t> indices(d.constants.size());
  std::iota(indices.begin(), indices.end(), std::size_t(0));
  const Table bars(error_bar_quantities(d), indices), candidates(candidate_quantities(d), order);
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
  const auto undetermined = std::count_if(d.after.begin(), d.after.end(), [](double x) { return !std::isfinite(x); });
  first.checks = {check(undetermined == 0, "every constant is determined then",
                        undetermined == 0 ? "" : fmt::format("{} stay open: other commands are needed", undetermined))};
  if (chosen > 0) first.next = "Play them on the robot, then `ukemi identify --robot` with the new logs.";
  report.answer(first, run.warnings());
  report.write(run);
  return run.finish(summary, chosen > 0 ? kDone : kNumbers);
}

}  // namespace ukemi::tools
