// Two sets of constants side by side as a reader sees them, of either kind of robot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "landing/scatter/measure.hpp"
#include "tools/report/landing.hpp"
#include "tools/study/compared.hpp"

namespace ukemi::tools {

/// A set's best motion.
struct MotionTexts {
  std::string set, words;
  Json numbers;
  std::optional<Json> tolerant_peak;  ///< absent: not told
  OfSets<double> peaks;               ///< with each set, or largest loads; without meaning unless all landed
};
/// A plan for scattered drops, and what it comes to with the identified constants.
struct PlanTexts {
  std::string set, words;
  double promised;
  landing::Distribution truth;
};
struct ComparisonTexts {
  std::string scene, source;  ///< names; source: of the floor's constants
  std::string peak;           ///< how its acceleration is called
  std::string truth;          ///< what has the identified constants: "the identified actuator"
  std::vector<MotionTexts> motions;
  std::vector<PlanTexts> plans;
  bool landed;         ///< all four landings were played
  bool rated = false;  ///< what counts is a load / its rating
};

/// The motions of a comparison that were found; `worth(set, landing)`.
template <class Motion, class Words, class Numbers, class Worth>
std::vector<MotionTexts> motion_texts(const std::vector<Motion>& motions, Words&& words, Numbers&& numbers,
                                      Worth&& worth) {
  std::vector<MotionTexts> out;
  for (const Motion& m : motions) {
    if (!m.best.found) continue;
    MotionTexts& texts = out.emplace_back(MotionTexts{m.set, words(m.best.motion), numbers(m.best.motion), {}, {}});
    for (std::size_t s = 0; s < 2; ++s)
      if (m.landings[s]) texts.peaks[s] = worth(s, *m.landings[s]);
  }
  return out;
}

/// Warns of what a search or a landing did not reach; `point`: what a robot meets the floor with.
template <class Motion>
void warn_of_motions(const std::vector<Motion>& motions, const char* point, Run& run) {
  for (const Motion& m : motions)
    if (!m.best.message.empty()) run.warn(m.set + ": " + m.best.message);
  for (const Motion& m : motions)
    for (const auto& l : m.landings)
      if (l && no_landing(l->end)) run.warn(failure_words(*l, point));
}

/// The page of a comparison, with what is to be distrusted of it.
Report comparison_page(const OfSets<std::string>& names, const Run& run);
/// The constants: parameters.csv, on the terminal, on the page, in the summary.
void report_constants(const std::vector<ConstantDifference>& constants, Json& summary, Report& report, Run& run);
/// Motions and plans, then where all landed their peaks in both directions and the lesson of them.
void report_motions(const ComparisonTexts& comparison, Json& summary, Report& report, Run& run);

}  // namespace ukemi::tools
