// ukemi bench.
#include "tools/bench/bench.hpp"

#include <memory>

#include "common/toml.hpp"
#include "tools/program/verb.hpp"

namespace ukemi::tools {

namespace {

void add_bench(CLI::App* bench, Action& chosen) {
  bench->require_subcommand(1);
  struct Kind {
    const char *name, *what, *example;
    int (*run)(const BenchArguments&, const CommonOptions&);
  };
  static constexpr Kind kKinds[] = {
      {"integrators", "landings and the rig: error against run time of every integrator",
       "ukemi bench integrators -o out", bench_integrators},
      {"identify", "the fit: error of constants and derivatives against run time",
       "ukemi bench identify --draws 20 -o out", bench_identify},
      {"optimizers", "every solver on ten scenes and both goals: gap to the best known against time",
       "ukemi bench optimizers --seeds 5 --times 0.03,0.1,0.3,1,10 -o out", bench_optimizers},
      {"stability", "stiff and extreme landings and fits: a map of pass, sensitive, refused",
       "ukemi bench stability --random 400 -o out", bench_stability},
      {"scenes", "what a scene does not need: instructions and time with and without each term",
       "ukemi bench scenes -o out", bench_scenes},
  };
  for (const Kind& kind : kKinds) {
    auto args = std::make_shared<BenchArguments>();
    CLI::App* verb = bench->add_subcommand(kind.name, kind.what);
    verb->add_option("--repetitions", args->repetitions, "timed runs of each entry [30]")->check(CLI::Range(1, 100000));
    if (kind.run == bench_stability)
      verb->add_option("--random", args->random, "seeded random combinations [400]")->check(CLI::Range(0, 1000000));
    if (kind.run == bench_optimizers) {
      verb->add_option("--seeds", args->seeds, "searches of each kind [1]")->check(CLI::Range(1, 1000));
      verb->add_option("--times", args->times,
                       "budgets of one core [s] [0.03,0.1,0.3,1: some four minutes on two cores]")
          ->delimiter(',')
          ->check(CLI::Range(0.001, 1e4));
      verb->add_option("--solvers", args->solvers, "only these [all but cma]")->delimiter(',');
      verb->add_option("--with", args->with, "optimizers.csv of earlier runs: what they searched is not run again");
    }
    if (kind.run == bench_identify)
      verb->add_option("--draws", args->draws, "noise draws [20]")->check(CLI::Range(2, 100000));
    if (kind.run == bench_scenes) verb->add_option("--only", args->only)->group("");  // for its own instruction counts
    add_action<BenchArguments>(*verb, args, kind.example, chosen, kind.run);
  }
}

const Verb bench_verb(VerbGroup::kProgram, "bench", "error against run time, and the stability map", add_bench);

}  // namespace

}  // namespace ukemi::tools
