// The top of a report: the result as one sentence, a checklist, and what to do next.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/report/landing_sentence.hpp"

namespace ukemi::landing {
struct Answer;
struct Ratings;
struct Sensitivity;
}  // namespace ukemi::landing

namespace ukemi::tools {

class Run;
class Table;

/// One line of the checklist. Each state has a symbol and a word beside its colour, so that it can be read in grey.
struct Check {
  enum class State { kGood, kCaution, kBad, kUnknown };
  State state;
  std::string what;   ///< "within ratings"
  std::string words;  ///< what was found, with its number
};

struct FirstScreen {
  std::string sentence;
  std::vector<Check> checks;
  std::string next;  ///< what to do next; empty: nothing
};

/// Warnings and checks call a peak worse if it exceeds the planned or promised one by this factor.
inline constexpr double kWorse = 1.05;

/// kGood if `passed`, else kBad.
Check check(bool passed, const std::string& what, const std::string& words);
/// The motor's speed and torque against their ratings; kUnknown where a rating is not given.
Check within_ratings(const std::optional<landing::Ratings>& ratings);
/// Whether a fit ended at a minimum; `message`: why not.
Check converged(bool converged, const std::string& message);
/// Whether a peak is free of integration error; `wrong`: see CheckedLanding.
Check converged(const landing::Sensitivity& sensitivity, bool wrong);
/// Value of a plan's goal: an acceleration [m/s^2] or, if `rated`, the largest load divided by its rating [1].
std::string goal_text(double value, bool rated);
const char* goal_name(bool rated);  ///< "largest load", "peak"
const char* goal_unit(bool rated);
/// Mean of the worst tenth of drops of the plan and of the held posture.
Check under_scatter_check(double planned, double held, bool rated = false);
/// Whether the limits hold in the share of `drops` that was asked for, absent: in all; kCaution within three standard
/// errors of it. `which`: "fresh drops".
Check keeps_limits_check(double kept, long drops, const std::string& which, const std::optional<double>& asked = {});
/// " Over the drops that it is planned for 135 (mean)."
std::string promised_words(const std::string& measure, double value);
/// First screen of a plan of the two-link robot.
FirstScreen first_screen(const landing::Answer& answer);

/// Prints the sentence and `lines`; with --details the table too.
void say(const FirstScreen& screen, const std::vector<std::string>& lines, const Table& details, const Run& run);
/// The screen as HTML; `warnings`: number of sentences under "What to distrust".
std::string html(const FirstScreen& screen, std::size_t warnings);

}  // namespace ukemi::tools
