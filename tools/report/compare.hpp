// Reports comparing two sets of constants, for both kinds of robot.
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
  std::optional<Json> tolerant_peak;  ///< absent: not reported
  PerSet<double> peaks;               ///< with each set, or largest loads; valid only if all landed
};
/// A plan for scattered drops and its peaks with the identified constants.
struct PlanTexts {
  std::string set, words;
  double promised;
  landing::Distribution truth;
};
struct ComparisonTexts {
  std::string scene, source;  ///< name; where the floor's constants come from
  std::string peak;           ///< symbol of the acceleration: "|ddr_0|"
  std::string truth;          ///< the system with the identified constants: "the identified actuator"
  std::vector<MotionTexts> motions;
  std::vector<PlanTexts> plans;
  bool landed;         ///< whether all four landings were played
  bool rated = false;  ///< peaks are loads divided by their ratings
};

/// Texts of the motions that were found; `worth(set, landing)`: value of the goal.
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

/// Warns of failed searches and landings, and of doubts(set, motion, landing); `point`: what touches the floor, "point"
/// or "contact".
template <class Motion, class DoubtsOf>
void warn_of_motions(const std::vector<Motion>& motions, const char* point, DoubtsOf&& doubts, Run& run) {
  for (const Motion& m : motions)
    if (!m.best.message.empty()) run.warn(m.set + ": " + m.best.message);
  for (const Motion& m : motions)
    for (const auto& l : m.landings)
      if (l && no_landing(l->end)) run.warn(failure_words(*l, point));
  for (const Motion& m : motions)
    for (std::size_t s = 0; s < 2; ++s)
      if (m.landings[s])
        warn_of(doubts(s, m.best.motion, *m.landings[s]), run, "best for " + m.set + ", with " + kSets[s] + ": ");
}

/// Warns of a set for which the other set's motion is better than the one that was searched for it.
void warn_of_short_search(const ComparisonTexts& comparison, Run& run);
/// Begins the page of a comparison, with the run's warnings.
Report comparison_page(const PerSet<std::string>& names, const Run& run);
/// Reports the constants on terminal, page and summary, and writes parameters.csv.
void report_constants(const std::vector<ConstantDifference>& constants, Json& summary, Report& report, Run& run);
/// Reports motions and plans and, where all landed, the peak of each motion with each set and the conclusion.
void report_motions(const ComparisonTexts& comparison, Json& summary, Report& report, Run& run);

}  // namespace ukemi::tools
