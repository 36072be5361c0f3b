// ukemi bench scenes: each term and each piece of work that a scene can do without, with it and without it.
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "common/median.hpp"
#include "common/stopwatch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/run/simulate.hpp"
#include "tools/bench/bench.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// The same landings with a piece of work and without it; how equal the peaks must be, and why.
struct Omission {
  std::string name, what;
  double tolerance;  ///< relative, of the peaks; 0: bit for bit
  std::string why;
  std::function<double(int)> with, without;  ///< the peak of landing i
};

constexpr int kLandings = 12;
constexpr double kDegree = 1 / kDegrees;

Motion motion(int i) { return {(-30 - i) * kDegree, (-80 + 2 * i) * kDegree, 0.15 + 0.01 * i}; }

std::vector<Omission> omissions() {
  const Scene paper = read_scene(dataset("scenes/paper.toml"));
  const SeaParameters<double> table2 = read_actuator(dataset("actuators/table2.toml")).sea;
  SeaParameters<double> unlimited = table2, far_limit = table2, still = table2;
  unlimited.tau_max = std::numeric_limits<double>::infinity(), far_limit.tau_max = 1e9;
  still.friction = 1e-300;
  Scene two_points = paper, air = paper, floor_below = paper, turning = paper;
  two_points.contacts[kHip] = false;
  floor_below.drop.pitch_rate = air.drop.pitch_rate = 0.5, floor_below.drop.height = air.drop.height = 5;
  floor_below.t_end = air.t_end = 0.5;
  air.floor.reset();
  turning.drop.pitch_rate = 1e-300;
  const auto peak = [](const Scene& s, const SeaParameters<double>& a, const SimulateOptions& o = {}) {
    return [s, a, o](int i) { return peak_acceleration(s, a, motion(i), o).peak; };
  };
  const auto hold = [paper, table2](double range) {
    return [paper, table2, range](int i) {
      return peak_acceleration(paper, table2, {(-30 - i) * kDegree, (-30 - i) * kDegree + range, 0.3}).peak;
    };
  };
  const auto hip_free = [paper, table2](const Scene& s) {
    return [s, table2](int i) {
      return peak_acceleration(s, table2, {(-27.2 - 0.01 * i) * kDegree, -82.4 * kDegree, 0.169}).peak;
    };
  };
  SimulateOptions to_the_end;
  to_the_end.rest = SimulateOptions::Rest::kIgnore;
  return {
      {"torque limit", "clamp and two guards of Eq. 2 that never act (tau_max = 1e9 Nm)", 0, "the same arithmetic",
       peak(paper, far_limit), peak(paper, unlimited)},
      {"further terms", "stiffening, dry friction, motor-side feedback (friction = 1e-300 Nm)", 1e-9,
       "terms of zero are added", peak(paper, still), peak(paper, table2)},
      {"contact point", "the hip, in landings that it never meets", 0, "its guard only watches", hip_free(paper),
       hip_free(two_points)},
      {"floor", "a floor that is not reached before t_end, a turning robot", 0, "the same arithmetic",
       peak(floor_below, table2), peak(air, table2)},
      {"first flight", "integrated (pitch rate 1e-300 rad/s) against closed form", 1e-7,
       "the integrated flight ends within its tolerance", peak(turning, table2), peak(paper, table2)},
      {"moving reference", "a quintic over 1e-13 rad against a hold", 1e-9, "the reference differs by 1e-13 rad",
       hold(1e-13), hold(0)},
      {"after rest", "followed to 10 s after touchdown against stopped at rest", 0, "no later peak is higher",
       peak(paper, table2, to_the_end), peak(paper, table2)},
      {"report", "touches, peaks, demands, energy accounts against the peak alone", 1e-9,
       "dense output of the accounts changes no step",
       [paper, table2](int i) { return simulate(paper, table2, motion(i)).peak; }, peak(paper, table2)},
  };
}

/// What valgrind collects between these: the landings of one side.
[[gnu::noinline]] double ukemi_bench_side(const std::function<double(int)>& side) {
  double sum = 0;
  for (int i = 0; i < kLandings; ++i) sum += side(i);
  return sum;
}

/// Instructions a landing, by a run of this program under callgrind; none where valgrind is not installed.
std::optional<double> instructions(const std::string& only) {
  char self[4096];
  const ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  if (n <= 0 || std::system("command -v valgrind >/dev/null 2>&1") != 0) return std::nullopt;
  self[n] = 0;
  const std::string command = fmt::format(
      "valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect='*ukemi_bench_side*' '{}' bench "
      "scenes "
      "--only '{}' --quiet -o '{}' 2>&1 >/dev/null",
      self, only, (std::filesystem::temp_directory_path() / "ukemi-bench-scenes").string());
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return std::nullopt;
  std::optional<double> out;
  char line[512];
  while (std::fgets(line, sizeof line, pipe))
    if (const char* at = std::strstr(line, "Collected :")) out = std::strtod(at + 11, nullptr) / kLandings;
  pclose(pipe);
  return out;
}

}  // namespace

int bench_scenes(const BenchArguments& a, const CommonOptions& common) {
  const std::vector<Omission> list = omissions();
  if (!a.only.empty()) {
    for (const Omission& o : list) {
      if (a.only == o.name + "/with") return ukemi_bench_side(o.with) > 0 ? kDone : kNumbers;
      if (a.only == o.name + "/without") return ukemi_bench_side(o.without) > 0 ? kDone : kNumbers;
    }
    throw InputError("--only: " + quoted(a.only) + ": no such omission");
  }
  Run run("bench scenes", common);
  CsvWriter csv = run.csv();
  csv.comment(
      "A landing each: instructions (callgrind), time_us (median, processor time); difference: largest relative, of "
      "the peaks.");
  csv.header({"omission", "instructions_with", "instructions_without", "time_us_with", "time_us_without", "difference",
              "allowed"});
  Report report("What a scene does not need");
  std::vector<std::vector<std::string>> rows;
  Json summary;
  int unequal = 0;
  run.say(fmt::format("{:<18} {:>12} {:>12} {:>7} {:>9} {:>9} {:>7} {:>10}", "omission", "instr with", "without",
                      "saved", "us with", "without", "saved", "difference"));
  for (const Omission& o : list) {
    double difference = 0;
    for (int i = 0; i < kLandings; ++i) {
      const double with = o.with(i), without = o.without(i);
      difference = std::max(difference, std::abs(with / without - 1));
    }
    unequal += difference > o.tolerance;
    std::vector<double> with(std::size_t(a.repetitions)), without = with;
    for (std::size_t r = 0; r < with.size(); ++r)
      for (auto [side, seconds] : {std::pair{&o.with, &with[r]}, {&o.without, &without[r]}}) {
        const Stopwatch watch(Stopwatch::Time::kProcess);
        (void)ukemi_bench_side(*side);
        *seconds = watch.seconds() / kLandings;
      }
    const double us_with = 1e6 * median(with), us_without = 1e6 * median(without);
    const auto i_with = instructions(o.name + "/with"), i_without = instructions(o.name + "/without");
    const auto saved = [](double x, double y) { return fmt::format("{:.1f} %", 100 * (1 - y / x)); };
    const std::string count_with = i_with ? fmt::format("{:.0f}", *i_with) : "-",
                      count_without = i_without ? fmt::format("{:.0f}", *i_without) : "-",
                      count_saved = i_with && i_without ? saved(*i_with, *i_without) : "-",
                      equal = difference == 0 ? "none" : fmt::format("{:.1e}", difference);
    run.say(fmt::format("{:<18} {:>12} {:>12} {:>7} {:>9.1f} {:>9.1f} {:>7} {:>10}", o.name, count_with, count_without,
                        count_saved, us_with, us_without, saved(us_with, us_without), equal));
    csv.cell(o.name).cell(i_with.value_or(NAN)).cell(i_without.value_or(NAN)).cell(us_with).cell(us_without);
    csv.cell(difference).cell(o.tolerance);
    csv.end_row();
    rows.push_back({o.name, o.what, count_saved, saved(us_with, us_without), equal,
                    o.tolerance == 0 ? "bit for bit: " + o.why : fmt::format("{:g}: {}", o.tolerance, o.why)});
    summary[o.name] = {{"instructions_with", number(i_with)},
                       {"instructions_without", number(i_without)},
                       {"difference", difference},
                       {"allowed", o.tolerance},
                       {"with", {{"time_s", us_with * 1e-6}}},
                       {"without", {{"time_s", us_without * 1e-6}}}};
  }
  report.table(
      {"omission", "what is left out", "instructions saved", "time saved", "difference of the peaks", "allowed"}, rows);
  run.add("scenes.csv", csv.text());
  run.add("report.html", report.html(run.provenance()));
  if (unequal > 0) run.warn(fmt::format("{} omissions change a peak by more than they may", unequal));
  return run.finish(summary, unequal > 0 ? kNumbers : kDone);
}

}  // namespace ukemi::tools
