// What stands first on a report: the answer as one sentence with its number, a checklist, and what to do next.
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

/// A peak above this part of the one that was planned or promised is a worse one: warnings and checks say so.
inline constexpr double kWorse = 1.05;

/// Good or bad.
Check check(bool right, const std::string& what, const std::string& words);
/// The motor's speed and torque against their ratings; one that is not known is said to be so.
Check within_ratings(const std::optional<landing::Ratings>& ratings);
/// Whether a fit ended at a minimum; `message`: why not.
Check converged(bool converged, const std::string& message);
/// Whether a peak is that of the motion and not of the integrator; `wrong`: see CheckedLanding.
Check converged(const landing::Sensitivity& sensitivity, bool wrong);
/// What a plan makes small: an acceleration [m/s^2] or, where loads are `rated`, the largest as a part of its rating.
std::string worth_words(double value, bool rated);
const char* worth_name(bool rated);  ///< "largest load", "peak"
const char* worth_unit(bool rated);
/// The worst tenth of drops against that of holding still.
Check under_scatter_check(double planned, double held, bool rated = false);
/// " Over the drops that it is planned for 135 (mean)."
std::string promised_words(const std::string& measure, double value);
/// Of a plan of the two-link robot.
FirstScreen first_screen(const landing::Answer& answer);

/// On the terminal: its sentence and the lines that belong to it; with --details every number of the table below.
void say(const FirstScreen& screen, const std::vector<std::string>& lines, const Table& details, const Run& run);
/// As HTML; `warnings` is how many sentences stand under "What to distrust".
std::string html(const FirstScreen& screen, std::size_t warnings);

}  // namespace ukemi::tools
