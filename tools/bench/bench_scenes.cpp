// ukemi bench scenes: cost of each term or computation that a scene can omit, with it and without it.
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>

#include "common/actuator.hpp"
#include "common/degrees.hpp"
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

/// The same landings with a computation and without it; how far the peaks may differ, and why.
struct Omission {
  std::string name, what;
  double tolerance;  ///< relative, of the peaks; 0: bit for bit
  std::string why;
  std::function<double(int)> with, without;  ///< the peak of landing i
};

constexpr int kLandings = 12;

Motion motion(int i) { return {(-30 - i) * kDegree, (-80 + 2 * i) * kDegree, 0.15 + 0.01 * i}; }

std::vector<Omission> omissions() {
  const Scene paper = read_scene(dataset("scenes/paper.toml"));
  const SeaParameters<double> table2 = read_actuator(dataset("actuators/table2.toml")).sea;
  SeaParameters<double> unlimited = table2, far_limit = table2, tiny_friction = table2;
  unlimited.tau_max = std::numeric_limits<double>::infinity(), far_limit.tau_max = 1e9;
  tiny_friction.friction = 1e-300;
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
       "terms of zero are added", peak(paper, tiny_friction), peak(paper, table2)},
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

/// The landings of one side; callgrind counts the instructions of this function only.
[[gnu::noinline]] double ukemi_bench_side(const std::function<double(int)>& side) {
  double sum = 0;
  for (int i = 0; i < kLandings; ++i) sum += side(i);
  return sum;
}

/// Instructions per landing, by a run of this program under callgrind; absent where valgrind is not installed.
std::optional<double> instructions(const std::string& only) {
  char self[4096];
  const ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  if (n <= 0 || std::system("command -v valgrind >/dev/null 2>&1") != 0) return std::nullopt;
  self[n] = 0;
  const std::string command = fmt::format(
      "valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect='*ukemi_bench_side*' '{}' bench "
      "scenes --only '{}' --quiet -o '{}' 2>&1 >/dev/null",
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

/// The saving of an omission.
struct Saving {
  const Omission* omission;
  double difference = 0;  ///< largest relative difference of the peaks
  std::optional<double> instructions_with, instructions_without;
  double us_with = 0, us_without = 0;  ///< median [us]

  bool equal() const { return difference <= omission->tolerance; }
};
std::string percent_saved(double share) { return std::isnan(share) ? "-" : fmt::format("{:.1f} %", 100 * share); }
const Quantities<Saving> kSavingQuantities = {
    {"omission", "", "omission", {}, [](auto& s) { return s.omission->name; }},
    {"", "", "what is left out", {}, [](auto& s) { return s.omission->what; }},
    {"instructions_with", "instructions_with", "instructions with", "{:.0f}",
     [](auto& s) { return number(s.instructions_with); }},
    {"instructions_without", "instructions_without", "without", "{:.0f}",
     [](auto& s) { return number(s.instructions_without); }},
    {"", "", "saved", percent_saved,
     [](auto& s) { return 1 - s.instructions_without.value_or(NAN) / s.instructions_with.value_or(NAN); }},
    {"time_us_with", "", "time with [us]", "{:.1f}", &Saving::us_with},
    {"time_us_without", "", "without [us]", "{:.1f}", &Saving::us_without},
    {"", "with/time_s", [](auto& s) { return s.us_with * 1e-6; }},
    {"", "without/time_s", [](auto& s) { return s.us_without * 1e-6; }},
    {"", "", "saved", percent_saved, [](auto& s) { return 1 - s.us_without / s.us_with; }},
    {"difference", "difference", "difference of the peaks", "{:.1e}", &Saving::difference},
    {"allowed", "allowed", "allowed", "{:g}", [](auto& s) { return s.omission->tolerance; }},
    {"", "", "why", {}, [](auto& s) { return s.omission->why; }},
};

Saving measure(const Omission& o, int repetitions) {
  Saving out{&o};
  for (int i = 0; i < kLandings; ++i) out.difference = std::max(out.difference, std::abs(o.with(i) / o.without(i) - 1));
  std::vector<double> with, without;
  for (int r = 0; r < repetitions; ++r)
    for (auto [side, us] : {std::pair{&o.with, &with}, {&o.without, &without}}) {
      const Stopwatch watch(Stopwatch::Time::kProcess);
      (void)ukemi_bench_side(*side);
      us->push_back(1e6 * watch.seconds() / kLandings);
    }
  out.us_with = median(with), out.us_without = median(without);
  out.instructions_with = instructions(o.name + "/with");
  out.instructions_without = instructions(o.name + "/without");
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
  Run run(Outputs{"bench scenes", {"scenes.csv"}, {}}, common);
  std::vector<Saving> savings;
  for (const Omission& o : list) savings.push_back(measure(o, a.repetitions));
  Report report("What a scene does not need");
  const auto unequal = std::count_if(savings.begin(), savings.end(), [](const Saving& s) { return !s.equal(); });
  const Saving& best = *std::min_element(savings.begin(), savings.end(), [](const Saving& x, const Saving& y) {
    return x.us_without / x.us_with < y.us_without / y.us_with;
  });
  if (unequal > 0) run.warn(fmt::format("{} omissions change a peak by more than they may", unequal));
  report.answer({fmt::format("{} terms that a scene may lack; leaving out \"{}\" saves most: {} of a landing's time.",
                             savings.size(), best.omission->what, percent_saved(1 - best.us_without / best.us_with)),
                 {check(unequal == 0, "the same peaks",
                        fmt::format("{} of {} omissions change none", long(savings.size()) - unequal, savings.size()))},
                 "Leave out of your scene what your robot does not have."},
                run.warnings());
  const Table table(kSavingQuantities, savings);
  (void)add_table(table, report, run, "scenes.csv",
                  "A landing each: instructions (callgrind), time_us (median, processor time); difference: largest "
                  "relative, of the peaks.");
  report.write(run);
  return run.finish(table.keyed(), unequal > 0 ? kNumbers : kDone);
}

}  // namespace ukemi::tools
