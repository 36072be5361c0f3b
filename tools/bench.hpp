// The benches: error against run time, the stability map, what omission saves. Each is one function.
#pragma once

#include <algorithm>
#include <ctime>
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
  std::string only;                  ///< scenes: one side of one omission, for the instruction count
};

int bench_integrators(const BenchArguments& arguments, const CommonOptions& common);
int bench_batch(const BenchArguments& arguments, const CommonOptions& common);
int bench_identify(const BenchArguments& arguments, const CommonOptions& common);
int bench_stability(const BenchArguments& arguments, const CommonOptions& common);
int bench_optimizers(const BenchArguments& arguments, const CommonOptions& common);
int bench_scenes(const BenchArguments& arguments, const CommonOptions& common);

/// Processor time of this process, or of this thread [s].
inline double processor_seconds(clockid_t clock) {
  timespec t;
  clock_gettime(clock, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}
inline double cpu_seconds() { return processor_seconds(CLOCK_PROCESS_CPUTIME_ID); }
inline double thread_seconds() { return processor_seconds(CLOCK_THREAD_CPUTIME_ID); }

/// Times `work` n times, a pass each; the median [s].
template <class Work>
double median_seconds(int n, Work&& work) {
  std::vector<double> seconds(static_cast<std::size_t>(n));
  for (double& s : seconds) {
    const double start = cpu_seconds();
    work();
    s = cpu_seconds() - start;
  }
  std::nth_element(seconds.begin(), seconds.begin() + n / 2, seconds.end());
  return seconds[std::size_t(n / 2)];
}

}  // namespace ukemi::tools
