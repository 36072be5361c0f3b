// The benches: error against run time, the stability map, what omission saves. Each is one function.
#pragma once

#include <string>
#include <vector>

#include "tools/output.hpp"

namespace ukemi::tools {

struct BenchArguments {
  int repetitions = 30;              ///< timed runs of each entry
  int random = 400;                  ///< stability: seeded combinations
  int draws = 20;                    ///< identify: noise draws
  int calls = 1000;                  ///< batch: of a planner
  int seeds = 1;                     ///< optimizers: of each search
  std::vector<double> times;         ///< optimizers: budgets of one core [s]; empty: the quick mode's
  std::vector<std::string> solvers;  ///< optimizers: empty: all
  std::vector<std::string> with;     ///< optimizers: files of earlier runs, whose searches are not run again
  std::string only;                  ///< scenes: one side of one omission, for the instruction count
};

int bench_integrators(const BenchArguments& arguments, const CommonOptions& common);
int bench_batch(const BenchArguments& arguments, const CommonOptions& common);
int bench_identify(const BenchArguments& arguments, const CommonOptions& common);
int bench_stability(const BenchArguments& arguments, const CommonOptions& common);
int bench_optimizers(const BenchArguments& arguments, const CommonOptions& common);
int bench_scenes(const BenchArguments& arguments, const CommonOptions& common);

}  // namespace ukemi::tools
