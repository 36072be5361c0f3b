// Searches for the best motion, each by one solver on one core: run, or taken from the files of earlier runs.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "landing/search/optimize.hpp"
#include "tools/bench/bench.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::tools {

inline constexpr auto& kScenes = kShippedScenes;
inline constexpr std::array<double, 5> kMarks = {100, 300, 1'000, 5'000, 20'000};

/// What a row of optimizers.csv tells of a search; after_N: its best after N motions, by its own accuracy. Nothing
/// found, or not known: NaN, an empty cell.
enum Found { kTime, kEvaluations, kLandings, kValue, kPhiI, kPhiF, kDuration, kAfter, kFound = kAfter + kMarks.size() };
inline constexpr std::array<const char*, kFound> kColumns = {"time_s",    "evaluations", "landings",   "value",
                                                             "phi_i_deg", "phi_f_deg",   "duration",   "after_100",
                                                             "after_300", "after_1000",  "after_5000", "after_20000"};

/// One search by one solver on one core.
struct Trial {
  std::size_t scene, goal;
  std::string solver;
  std::uint64_t seed;
  double budget;  ///< [s]
  std::array<double, kFound> found;

  bool operator<(const Trial& o) const { return key() < o.key(); }
  std::tuple<std::size_t, std::size_t, const std::string&, std::uint64_t, double> key() const {
    return {scene, goal, solver, seed, budget};
  }
};

/// The searches to run.
struct Cases {
  std::vector<std::string> solvers;
  std::vector<double> times;  ///< [s], increasing
  std::uint64_t first_seed;
  int seeds;
};

/// The searches that an earlier run's optimizers.csv holds.
std::vector<Trial> read_trials(const std::string& path);
/// Every search of the cases; those of `earlier` runs are taken from there.
std::vector<Trial> searched(const Cases& cases, std::vector<Trial> earlier, const Run& run);

/// The best that any search has found, ours or an earlier one's: [scene][goal], datasets/best_known.csv.
using BestKnown = std::array<std::array<double, kGoalNames.size()>, kScenes.size()>;
BestKnown best_known(const std::string& path);

}  // namespace ukemi::tools
