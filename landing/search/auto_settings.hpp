// The settings of AutoSearch: what each means, its range, and how it was chosen.
//
// They were tuned on the ten shipped scenes, by the gap to the best known value, with seeds from 100 on: so a table
// over those scenes says how well they were tuned, and only scenes that were never seen say how well the search works.
// Those of three variables: `ukemi bench optimizers --solvers auto --seed 100 --seeds 20 --set NAME=VALUE` repeats the
// experiment for one of them.
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace ukemi::landing {

struct AutoSettings {
  int leads = 2, first = 128;
  double lead_apart = 0.15, anywhere = 0.1, later = 0.5, near = 0.6, by = 1, at_last = 3, scouting = 0.7;
  long early = 1'000, few = 1'500, many = 6'000;
  int best_scouts = 24, smallest = 12, largest = 32, race = 60, screen = 300, trial_period = 12, global = 3,
      refinement = 3, batch = 16, basins = 64;
  double scouts_apart = 0.01, race_share = 0.2, first_share = 0.3, converged = 1e-4, apart = 0.04, behind = 1.12,
         finest = 1e-7, close = 0.5, side = 0.15, nearly = 1.06, late = 0.7;
  // More variables than three (wide_search.hpp).
  int wide_scouts = 3'000, wide_race = 200, wide_points = 16;
  double wide_size = 0.03, wide_near = 0.5, wide_bound = 1.2, wide_behind = 1.6, wide_patience = 0.985,
         wide_poor = 1e-3, wide_plain = 0.1, wide_screen = 0.5;
  // Plans under scatter (robust_search.hpp).
  int robust_few = 4, robust_scouts = 1'536, robust_starts = 48, robust_points = 14, robust_basins = 4;
  double robust_size = 0.08, robust_near = 0.5, robust_late = 0.65, robust_behind = 0.5, robust_patience = 0.93,
         robust_fine = 0.02, robust_hint = 0.03, robust_tail = 2, robust_scouting = 0.15;

  /// Throws InputError for a setting outside of its range.
  void validate() const;
  /// Sets one by its name. Throws InputError for a name that is not known or a value outside of its range.
  void set(const std::string& name, double value);
};

/// One setting, as a reader sees it.
struct AutoSetting {
  std::string name;
  std::variant<int AutoSettings::*, long AutoSettings::*, double AutoSettings::*> member;
  double lower, upper;
  std::string meaning;
  double value_in(const AutoSettings& settings) const;
};
const std::vector<AutoSetting>& auto_settings();

}  // namespace ukemi::landing
