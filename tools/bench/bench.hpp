// The benchmarks: error against run time, the stability map, the savings of omitted terms. Each is one function.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/program/command.hpp"

namespace ukemi::tools {

class Report;

/// The scenes of datasets/scenes that the benchmarks run.
inline constexpr std::array<const char*, 10> kShippedScenes = {
    "paper", "paper_rough_a", "paper_rough_b", "paper_soft", "low", "high", "straight", "fast", "tilted", "hard"};

/// A CSV cell for text that may hold commas.
inline std::string in_quotes(const std::string& text) { return "\"" + text + "\""; }

struct BenchArguments {
  int repetitions = 30;              ///< timed runs of each entry
  int random = 400;                  ///< stability: seeded combinations
  int draws = 20;                    ///< identify: noise draws
  int seeds = 1;                     ///< optimizers: seeds of each search
  std::vector<double> times;         ///< optimizers: budgets of one core [s]; empty: the default ones
  std::vector<std::string> solvers;  ///< optimizers: empty: all but cma
  std::vector<std::string> with;     ///< optimizers: files of earlier runs, whose searches are not run again
  std::string only;                  ///< scenes: NAME/with or NAME/without, run alone under callgrind
};

int bench_integrators(const BenchArguments& arguments, const CommonOptions& common);
int bench_identify(const BenchArguments& arguments, const CommonOptions& common);
int bench_stability(const BenchArguments& arguments, const CommonOptions& common);
int bench_optimizers(const BenchArguments& arguments, const CommonOptions& common);
int bench_scenes(const BenchArguments& arguments, const CommonOptions& common);

/// Fits of stiff and extreme data, a part of `stability`; writes stability_identify.csv. Returns "cases" and "wrong".
Json stability_of_fits(Run& run, Report& report);

}  // namespace ukemi::tools
