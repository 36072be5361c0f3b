// ukemi bench batch: landings a second in SIMD lanes against the scalar path, and how late a planner answers.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/actuator.hpp"
#include "common/random.hpp"
#include "common/stopwatch.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/planner.hpp"
#include "tools/bench/bench.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr int kLandings = 6000;
constexpr double kAbandon = 200;  ///< what a search on the paper's scene cares for after its first moments [m/s^2]

struct Row {
  std::string path;
  double accuracy, seconds = std::numeric_limits<double>::infinity(), abandoning = seconds, worst = 0, off = 0;
  double scalar = seconds;  ///< the scalar path's seconds
};
const Quantities<Row> kRowQuantities = {
    {"path", "path", "path", {}, &Row::path},
    {"accuracy", "accuracy", "accuracy", "{:g}", &Row::accuracy},
    {"landings_per_second", "landings_per_second", "landings/s", "{:.0f}",
     [](auto& r) { return kLandings / r.seconds; }},
    {"abandoning_per_second", "", fmt::format("abandoned above {:g}", kAbandon), "{:.0f}",
     [](auto& r) { return kLandings / r.abandoning; }},
    {"ratio_to_scalar", "ratio", "times scalar", "{:.2f}", [](auto& r) { return r.scalar / r.seconds; }},
    {"worst_error", "", "worst error", "{:.1e}", &Row::worst},
    {"off_1e4", "", "off by > 1e-4", "{:.0f}", &Row::off},
};

/// How late a planner answers, against one deadline.
struct Lateness {
  const char* objective;
  double deadline;
  std::vector<double> over, own;  ///< late by the clock, sorted, and by the time that the core was ours [s]
  long found = 0;

  double at(double quantile) const {  ///< [ms]
    return 1e3 * over[std::min(over.size() - 1, std::size_t(quantile * double(over.size())))];
  }
};
double within_5ms(const std::vector<double>& times) {
  return double(std::count_if(times.begin(), times.end(), [](double x) { return x <= 5e-3; })) / double(times.size());
}
const Quantities<Lateness> kLatenessQuantities = {
    {"objective", "objective", "objective", {}, &Lateness::objective},
    {"deadline_s", "deadline", "deadline [s]", "{:g}", &Lateness::deadline},
    {"calls", "", "calls", {}, [](auto& l) { return l.over.size(); }},
    {"median_late_ms", "", "late, median [ms]", "{:.2f}", [](auto& l) { return l.at(0.5); }},
    {"q999_late_ms", "", "99.9 % [ms]", "{:.2f}", [](auto& l) { return l.at(0.999); }},
    {"worst_late_ms", "worst_late_ms", "worst [ms]", "{:.2f}", [](auto& l) { return l.at(1); }},
    {"within_5ms", "within_5ms", "within 5 ms", "{:.3f}", [](auto& l) { return within_5ms(l.over); }},
    {"own_within_5ms", "own_within_5ms", "by the core's own time", "{:.3f}", [](auto& l) { return within_5ms(l.own); }},
    {"found", "found", "answered", {}, &Lateness::found},
};

std::vector<Row> throughput(const Scene& scene, const SeaParameters<double>& sea, int repetitions, const Run& run) {
  std::vector<BatchCase> cases;
  for (int i = 0; i < kLandings; ++i) {
    Random r(run.options().seed, std::uint64_t(i));
    const auto [phi, duration] = scene.search;
    cases.push_back(
        {&scene, &sea, {r.uniform(phi[0], phi[1]), r.uniform(phi[0], phi[1]), r.uniform(duration[0], duration[1])}});
  }
  std::vector<BatchCase> bounded = cases;
  for (BatchCase& c : bounded) c.abandon_above = kAbandon;
  std::vector<double> exact;
  for (const BatchCase& c : cases) exact.push_back(peak_acceleration(scene, sea, c.motion, {.accuracy = 1e-11}).peak);

  // Every entry once a pass, so that all share the machine's moods; the least time of each counts.
  std::vector<Row> rows;
  for (const double accuracy : {1e-5, 1e-6}) {
    rows.push_back({"scalar", accuracy});
    for (int s = 0; s <= int(widest_instruction_set()); ++s)
      rows.push_back({kInstructionSetNames[std::size_t(s)], accuracy});
  }
  std::vector<LandingPeak> peaks(cases.size());
  const auto play = [&](const Row& row, const std::vector<BatchCase>& which) {
    const Stopwatch watch(Stopwatch::Time::kProcessor);
    if (row.path == "scalar")
      for (std::size_t i = 0; i < which.size(); ++i)
        peaks[i] = peak_acceleration(scene, sea, which[i].motion,
                                     {.accuracy = row.accuracy, .abandon_above = which[i].abandon_above});
    else
      for (int s = 0; s < 3; ++s)
        if (row.path == kInstructionSetNames[std::size_t(s)])
          batch_peaks(which, peaks, {.accuracy = row.accuracy}, 1, InstructionSet(s));
    return watch.seconds();
  };
  const int passes = std::max(3, repetitions / 6);
  for (int pass = 0; pass < passes; ++pass)
    for (Row& row : rows) {
      run.progress("batch", pass, passes);
      row.abandoning = std::min(row.abandoning, play(row, bounded));
      row.seconds = std::min(row.seconds, play(row, cases));
      row.worst = row.off = 0;
      for (std::size_t i = 0; i < cases.size(); ++i) {
        const double error = std::abs(peaks[i].peak - exact[i]) / exact[i];
        row.off += error > 1e-4;
        if (error < 0.01) row.worst = std::max(row.worst, error);
      }
    }
  double scalar = 0;
  for (Row& row : rows) row.scalar = scalar = row.path == "scalar" ? row.seconds : scalar;
  return rows;
}

Lateness lateness(Goal goal, double deadline, const Scene& scene, const SeaParameters<double>& sea, int calls,
                  const Run& run) {
  Planner planner(scene, sea, {.goal = goal});
  Lateness out{goal == Goal::kPeak ? "peak" : "tolerant", deadline, {}, {}};
  for (int i = 0; i < calls; ++i) {
    Random r(run.options().seed, std::uint64_t(i));
    Drop drop = scene.drop;
    drop.height += r.uniform(-0.1, 0.1), drop.pitch += r.uniform(-0.1, 0.1);
    drop.forward_speed += r.uniform(-0.2, 0.2);
    const Stopwatch watch(Stopwatch::Time::kWall), processor(Stopwatch::Time::kProcessor);
    out.found += planner.plan(drop, deadline, std::uint64_t(i)).found();
    out.over.push_back(watch.seconds() - deadline), out.own.push_back(processor.seconds() - deadline);
    run.progress("planner", i, calls);
  }
  std::sort(out.over.begin(), out.over.end());
  return out;
}

}  // namespace

int bench_batch(const BenchArguments& arguments, const CommonOptions& common) {
  Run run("bench batch", common);
  const Scene scene = read_scene(dataset("scenes/paper.toml"));
  const SeaParameters<double> sea = read_actuator(dataset("actuators/table2.toml")).sea;
  Report report("Landings in lanes");
  Json summary;
  summary["throughput"] =
      tell(Table(kRowQuantities, throughput(scene, sea, arguments.repetitions, run)), report, run, "batch.csv",
           "worst_error: of the peaks that are off by less than 1 %; off_1e4: how many are off by more than 1e-4.");
  std::vector<Lateness> late;
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant})
    for (const double deadline : {0.05, 0.1})
      late.push_back(lateness(goal, deadline, scene, sea, arguments.calls, run));
  summary["planner"] = tell(Table(kLatenessQuantities, late), report, run, "planner.csv");
  report.write(run);
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools
