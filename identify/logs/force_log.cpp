#include "identify/logs/force_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/median.hpp"
#include "common/noise.hpp"
#include "identify/logs/columns.hpp"

namespace ukemi::identify {

namespace {

/// Value of a signal at rest: the median of its first 2 % (5 samples or more).
double rest_of(const std::vector<double>& x) {
  return median({x.begin(), x.begin() + long(std::min(x.size(), std::max<std::size_t>(5, x.size() / 50)))});
}

/// Index of the first of two consecutive samples farther than `threshold` from `rest`; size() where there is none.
std::size_t onset(const std::vector<double>& x, double rest, double threshold) {
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::abs(x[i] - rest) > threshold && (i + 1 == x.size() || std::abs(x[i + 1] - rest) > threshold)) return i;
  return x.size();
}

/// Deviation from rest that is motion, not noise or slow drift.
double threshold_of(const std::vector<double>& x, double rest) {
  return std::max(6 * noise_level(x), 0.02 * largest_deviation(x, rest));
}

/// Time when a free link under the force has turned by `angle` either way [s]; the log's end where it does not.
double free_link_time_to(const ForceLog& log, const Rig& rig, double angle) {
  const double rest = rest_of(log.force);
  const std::size_t first = onset(log.force, rest, threshold_of(log.force, rest));
  if (first == log.force.size())
    throw InputError({log.file}, "the force never leaves its rest: without an onset the clocks cannot be aligned");
  double phi = 0, rate = 0;
  for (std::size_t i = first > 0 ? first - 1 : 0; i + 1 < log.t.size(); ++i) {
    const double dt = log.t[i + 1] - log.t[i], a = rig.length / rig.inertia * (log.force[i] - rest),
                 b = rig.length / rig.inertia * (log.force[i + 1] - rest);
    const double next = phi + dt * (rate + dt * (2 * a + b) / 6);  // the force is linear between samples
    if (std::abs(next) >= angle) return log.t[i] + dt * (angle - std::abs(phi)) / (std::abs(next) - std::abs(phi));
    phi = next, rate += dt * (a + b) / 2;
  }
  return log.t.back();
}

double aligning_shift(const Trial& trial, const ForceLog& log, const Rig& rig) {
  if (trial.phi.empty()) throw InputError({trial.file}, "no measured angle: the force's clock cannot be aligned to it");
  const double rest = rest_of(trial.phi), threshold = threshold_of(trial.phi, rest);
  const std::size_t i = onset(trial.phi, rest, threshold);
  if (i == trial.phi.size() || threshold == 0)
    throw InputError({trial.file}, "the angle never leaves its rest: without an onset the clocks cannot be aligned");
  double t = trial.t[i];
  if (i > 0) {
    const double before = std::abs(trial.phi[i - 1] - rest), after = std::abs(trial.phi[i] - rest);
    if (before < threshold) t -= (trial.t[i] - trial.t[i - 1]) * (after - threshold) / (after - before);
  }
  return t - free_link_time_to(log, rig, threshold);
}

}  // namespace

ForceLog read_force_log(const std::string& path, const std::string& columns) {
  const ColumnMap map("--force-columns", columns, {{"t", Quantity::kTime}, {"force", Quantity::kForce}});
  const CsvTable table = read_csv(path, [&](const std::string& column) { return map.wants(column); });
  ForceLog log;
  log.file = path;
  const auto load = [&](const char* name, std::vector<double>& out) {
    Source s;
    const int c = map.find(table, name, s);
    if (c < 0)
      throw InputError({path, table.header_line}, fmt::format("no column '{}'", name) + hint(name, table.header));
    table.require_full(c);
    for (const double x : table.columns[std::size_t(c)]) out.push_back(x * s.scale);
    return c;
  };
  const int time = load("t", log.t);
  load("force", log.force);
  if (log.t.size() < 2) throw InputError({path, table.line.back()}, "one row: at least two samples are needed");
  table.require_increasing(time, log.t);
  log.t_origin = log.t.front();
  for (double& t : log.t) t -= log.t_origin;
  return log;
}

void ForceLog::validate() const {
  const std::string what = ukemi::quoted(file);
  require_times(what + ": t", t);
  if (force.size() != t.size())
    throw InputError(
        fmt::format("{}: force: {} values: {} are needed, one for each time", what, force.size(), t.size()));
  for (std::size_t i = 0; i < force.size(); ++i)
    if (!std::isfinite(force[i]))
      throw InputError(fmt::format("{}: force[{}]: {}: a finite number is needed", what, i, force[i]));
}

double attach_force(Trial& trial, const ForceLog& log, const Rig& rig, ForceClock clock) {
  trial.validate(), log.validate(), rig.validate();
  if (!trial.force.empty())
    throw InputError({trial.file}, "a force in the trial beside the force log " + log.file + ": one of them is needed");
  const double shift = clock == ForceClock::kOwn ? aligning_shift(trial, log, rig) : log.t_origin - trial.t_origin;
  const double begin = log.t.front() + shift, end = log.t.back() + shift;
  if (end <= trial.t.front() || begin >= trial.t.back())
    throw InputError({log.file}, fmt::format("the force runs from {} to {} s, the angle in {} from {} to {} s: they do "
                                             "not overlap; a clock of its own? then --force-clock own",
                                             trial.clock_time(begin), trial.clock_time(end), trial.file,
                                             trial.clock_time(trial.t.front()), trial.clock_time(trial.t.back())));
  trial.force = log.force;
  trial.force_t = log.t;
  for (double& t : trial.force_t) t += shift;
  const double missing = std::max(begin - trial.t.front(), trial.t.back() - end),
               interval = (trial.t.back() - trial.t.front()) / double(trial.samples() - 1);
  if (missing > 3 * interval)
    trial.notes.push_back(fmt::format("the force in {} covers {} to {} s of {} to {} s: taken as 0 outside", log.file,
                                      trial.clock_time(begin), trial.clock_time(end), trial.clock_time(trial.t.front()),
                                      trial.clock_time(trial.t.back())));
  const std::vector<double>& r = trial.phi_ref;
  if (clock == ForceClock::kOwn && std::adjacent_find(r.begin(), r.end(), std::not_equal_to<>()) != r.end())
    trial.notes.push_back("the reference moves too: the onset that the force in " + log.file +
                          " was aligned to may be the reference's");
  return clock == ForceClock::kOwn ? shift + trial.t_origin - log.t_origin : 0;
}

}  // namespace ukemi::identify
