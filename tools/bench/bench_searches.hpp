// Searches for the best motion, each by one solver on one core: run here or read from earlier runs' files.
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
inline constexpr std::array<double, 5> kMotions = {100, 300, 1'000, 5'000, 20'000};

/// Result columns of optimizers.csv; after_N: the best value after N motions, at the search's own accuracy. NaN, an
/// empty cell: nothing found, or not known.
enum Column { kTime, kEvaluations, kLandings, kValue, kPhiI, kPhiF, kDuration, kAfter };
inline constexpr std::size_t kResults = kAfter + kMotions.size();
inline constexpr std::array<const char*, kResults> kColumns = {"time_s",    "evaluations", "landings",   "value",
                                                               "phi_i_deg", "phi_f_deg",   "duration",   "after_100",
                                                               "after_300", "after_1000",  "after_5000", "after_20000"};

/// One search by one solver on one core, and its result.
struct SearchRun {
  std::size_t scene, goal;
  std::string solver;
  std::uint64_t seed;
  double budget;                        ///< [s]
  std::array<double, kResults> result;  ///< by Column

  bool operator<(const SearchRun& o) const { return key() < o.key(); }
  std::tuple<std::size_t, std::size_t, const std::string&, std::uint64_t, double> key() const {
    return {scene, goal, solver, seed, budget};
  }
};

/// The searches to run.
struct SearchPlan {
  std::vector<std::string> solvers;
  std::vector<double> times;  ///< [s], increasing
  std::uint64_t first_seed;
  int seeds;
};

/// The searches in an earlier run's optimizers.csv.
std::vector<SearchRun> read_searches(const std::string& path);
/// Runs every search of the plan; those among `earlier` are copied from there.
std::vector<SearchRun> run_searches(const SearchPlan& plan, std::vector<SearchRun> earlier, const Run& run);

/// The lowest value that any search has found, [scene][goal]; datasets/best_known.csv.
using BestKnown = std::array<std::array<double, kGoalNames.size()>, kScenes.size()>;
BestKnown best_known(const std::string& path);

}  // namespace ukemi::tools
