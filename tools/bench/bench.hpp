// The benches: error against run time, the stability map, what omission saves. Each is one function.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/program/command.hpp"

namespace ukemi::tools {

class Report;

/// The scenes that the benches run, of datasets/scenes.
inline constexpr std::array<const char*, 10> kShippedScenes = {
    "paper", "paper_rough_a", "paper_rough_b", "paper_soft", "low", "high", "straight", "fast", "tilted", "hard"};

/// A cell of text that may hold commas.
inline std::string in_quotes(const std::string& text) { return "\"" + text + "\""; }

struct BenchArguments {
  int repetitions = 30;              ///< timed runs of each entry
  int random = 400;                  ///< stability: seeded combinations
  int draws = 20;                    ///< identify: noise draws
  int seeds = 1;                     ///< optimizers: of each search
  std::vector<double> times;         ///< optimizers: budgets of one core [s]; empty: the quick mode's
  std::vector<std::string> solvers;  ///< optimizers: empty: all
  std::vector<std::string> with;     ///< optimizers: files of earlier runs, whose searches are not run again
  std::string only;                  ///< scenes: one side of one omission, for the instruction count
};

int bench_integrators(const BenchArguments& arguments, const CommonOptions& common);
int bench_identify(const BenchArguments& arguments, const CommonOptions& common);
int bench_stability(const BenchArguments& arguments, const CommonOptions& common);
int bench_optimizers(const BenchArguments& arguments, const CommonOptions& common);
int bench_scenes(const BenchArguments& arguments, const CommonOptions& common);

/// Fits of stiff and extreme data, a part of `stability`: "cases" and "wrong" of the summary; stability_identify.csv.
Json stability_of_fits(Run& run, Report& report);

}  // namespace ukemi::tools
