// ukemi bench batch: landings a second in SIMD lanes against the scalar path, and how late a planner answers.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "common/actuator.hpp"
#include "common/random.hpp"
#include "common/stopwatch.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/search/planner.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/bench/bench.hpp"
#include "tools/report/report.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr int kLandings = 6000;
constexpr double kAbandon = 200;  ///< what a search on the paper's scene cares for after its first moments [m/s^2]

struct Row {
  std::string path;
  double accuracy, seconds = std::numeric_limits<double>::infinity(), abandoning = seconds, worst = 0, off = 0;
};

}  // namespace

int bench_batch(const BenchArguments& arguments, const CommonOptions& common) {
  Run run("bench batch", common);
  const Scene scene = read_scene(dataset("scenes/paper.toml"));
  const SeaParameters<double> sea = read_actuator(dataset("actuators/table2.toml")).sea;
  std::vector<BatchCase> cases;
  for (int i = 0; i < kLandings; ++i) {
    Random r(common.seed, std::uint64_t(i));
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
  const int passes = std::max(3, arguments.repetitions / 6);
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
  CsvWriter csv = run.csv();
  csv.comment("worst_error: of the peaks that are off by less than 1 %; off_1e4: how many are off by more than 1e-4.");
  csv.header({"path", "accuracy", "landings_per_second", "abandoning_per_second", "ratio_to_scalar", "worst_error",
              "off_1e4"});
  std::vector<std::vector<std::string>> table;
  double scalar = 0;
  Json summary;
  for (const Row& row : rows) {
    if (row.path == "scalar") scalar = row.seconds;
    csv.cell(row.path).cell(row.accuracy).cell(kLandings / row.seconds).cell(kLandings / row.abandoning);
    csv.cell(scalar / row.seconds).cell(row.worst).cell(row.off).end_row();
    table.push_back({row.path, fmt::format("{:g}", row.accuracy), fmt::format("{:.0f}", kLandings / row.seconds),
                     fmt::format("{:.0f}", kLandings / row.abandoning), fmt::format("{:.2f}", scalar / row.seconds),
                     fmt::format("{:.1e}", row.worst), fmt::format("{:.0f}", row.off)});
    run.say(fmt::format("  {}", fmt::join(table.back(), "  ")));
    summary["throughput"].push_back({{"path", row.path},
                                     {"accuracy", row.accuracy},
                                     {"landings_per_second", kLandings / row.seconds},
                                     {"ratio", scalar / row.seconds}});
  }
  run.add("batch.csv", csv.text());
  Report report("Landings in lanes");
  report.table({"path", "accuracy", "landings/s", fmt::format("abandoned above {:g}", kAbandon), "times scalar",
                "worst error", "off by > 1e-4"},
               table);

  CsvWriter late = run.csv();
  late.header({"objective", "deadline_s", "calls", "median_late_ms", "q999_late_ms", "worst_late_ms", "within_5ms",
               "own_within_5ms", "found"});
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant})
    for (const double deadline : {0.05, 0.1}) {
      Planner planner(scene, sea, {.goal = goal});
      std::vector<double> over, own;  // late by the clock, and by the time that the core was ours
      long found = 0;
      for (int i = 0; i < arguments.calls; ++i) {
        Random r(common.seed, std::uint64_t(i));
        Drop drop = scene.drop;
        drop.height += r.uniform(-0.1, 0.1), drop.pitch += r.uniform(-0.1, 0.1);
        drop.forward_speed += r.uniform(-0.2, 0.2);
        const Stopwatch watch(Stopwatch::Time::kWall), processor(Stopwatch::Time::kProcessor);
        found += planner.plan(drop, deadline, std::uint64_t(i)).found;
        over.push_back(watch.seconds() - deadline), own.push_back(processor.seconds() - deadline);
        run.progress("planner", i, arguments.calls);
      }
      std::sort(over.begin(), over.end());
      const auto at = [&](double q) {
        return 1e3 * over[std::min(over.size() - 1, std::size_t(q * double(over.size())))];
      };
      const auto within = [](const std::vector<double>& times) {
        return double(std::count_if(times.begin(), times.end(), [](double x) { return x <= 5e-3; })) /
               double(times.size());
      };
      const char* name = goal == Goal::kPeak ? "peak" : "tolerant";
      late.cell(name).cell(deadline).cell(arguments.calls).cell(at(0.5)).cell(at(0.999)).cell(at(1)).cell(within(over));
      late.cell(within(own)).cell(found).end_row();
      run.say(
          fmt::format("planner, {}, {:g} s: {} calls, late by {:.2f} ms at most, {:.3f} within 5 ms ({:.3f} by the "
                      "time that the core was ours), {} answered",
                      name, deadline, arguments.calls, at(1), within(over), within(own), found));
      summary["planner"].push_back({{"objective", name},
                                    {"deadline", deadline},
                                    {"within_5ms", within(over)},
                                    {"own_within_5ms", within(own)},
                                    {"worst_late_ms", at(1)},
                                    {"found", found}});
    }
  run.add("planner.csv", late.text());
  run.add("report.html", report.html(run.provenance()));
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools
