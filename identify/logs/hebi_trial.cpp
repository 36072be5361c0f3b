#include "identify/logs/hebi_trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/median.hpp"
#include "common/text.hpp"

namespace ukemi::identify {

namespace {

constexpr double kDuplicate = 0.1;  ///< in nominal intervals: closer stamps are duplicates
constexpr double kGap = 3;          ///< in nominal intervals: longer ones are gaps
constexpr double kDisorder = 1;     ///< largest backward step of a stamp that is sorted [s]

std::string plural(std::size_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

/// Indices of the samples of a trial, in order of time.
std::vector<std::size_t> order_samples(const HebiLog& log, const HebiModule& m, std::vector<std::string>& notes) {
  std::vector<std::size_t> order;
  std::size_t missing = 0, backward = 0;
  double latest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < m.t.size(); ++i) {
    if (!std::isfinite(m.t[i]) || !std::isfinite(m.position[i])) {
      ++missing;
      continue;
    }
    if (m.t[i] < latest - kDisorder)
      throw InputError({log.file},
                       fmt::format("sample {}: its stamp {} s stands {} s before an earlier one: at most {} "
                                   "s can be sorted",
                                   i + 1, shortest(m.t[i]), shortest(latest - m.t[i]), shortest(kDisorder)));
    if (m.t[i] < latest) ++backward;
    latest = std::max(latest, m.t[i]);
    order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return m.t[a] < m.t[b]; });
  if (missing > 0) notes.push_back(plural(missing, "sample", "samples") + " without time or position dropped");
  if (backward > 0) notes.push_back(plural(backward, "stamp", "stamps") + " out of order sorted");
  return order;
}

/// Drops samples that share a stamp and counts gaps.
void drop_duplicates(const HebiModule& m, std::vector<std::size_t>& order, std::vector<std::string>& notes) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < order.size(); ++k)
    if (const double dt = m.t[order[k]] - m.t[order[k - 1]]; dt > 0) intervals.push_back(dt);
  if (intervals.empty()) {
    order.resize(std::min<std::size_t>(order.size(), 1));
    return;
  }
  const double nominal = median(intervals);
  std::vector<std::size_t> kept;
  for (const std::size_t i : order)
    if (kept.empty() || m.t[i] - m.t[kept.back()] > kDuplicate * nominal) kept.push_back(i);
  if (const std::size_t n = order.size() - kept.size(); n > 0)
    notes.push_back(plural(n, "duplicate stamp", "duplicate stamps") + " dropped");
  std::size_t gaps = 0;
  double longest = 0;
  for (std::size_t k = 1; k < kept.size(); ++k)
    if (const double dt = m.t[kept[k]] - m.t[kept[k - 1]]; dt > kGap * nominal) ++gaps, longest = std::max(longest, dt);
  if (gaps > 0)
    notes.push_back(fmt::format("{} longer than {:g} nominal intervals of {:.3g} ms, the longest {:.3g} ms",
                                plural(gaps, "gap", "gaps"), kGap, 1e3 * nominal, 1e3 * longest));
  order = std::move(kept);
}

/// The reference from the commands; empty where none was ever given.
std::vector<double> hold_commands(const HebiModule& m, const std::vector<std::size_t>& order,
                                  std::vector<std::string>& notes) {
  std::vector<double> out;
  std::size_t before = 0, after = 0;
  bool commanded = false;
  for (const std::size_t i : order) {
    const double command = m.position_command[i];
    if (std::isfinite(command)) {
      commanded = true;
      out.push_back(command);
    } else {
      ++(commanded ? after : before);
      out.push_back(out.empty() ? m.position[i] : out.back());
    }
  }
  if (!commanded)
    notes.push_back("no position command in the log: the reference is held at the first position");
  else if (before > 0)
    notes.push_back(plural(before, "NaN command", "NaN commands") +
                    " before the first command: held at the first position");
  if (after > 0)
    notes.push_back(plural(after, "NaN command", "NaN commands") + " after the first: the last command is held");
  return out;
}

/// The motor's angle at the gear's output side; empty where the log or the rig does not give it.
std::vector<double> motor_angles(const HebiModule& m, const std::vector<std::size_t>& order,
                                 const std::optional<double>& gear_ratio, std::vector<std::string>& notes) {
  std::size_t measured = 0;
  for (const std::size_t i : order) measured += std::isfinite(m.motor_position[i]);
  if (measured == 0) return {};
  if (!gear_ratio) {
    notes.push_back("the motor's position is not used: the rig names no gear_ratio");
    return {};
  }
  if (measured < order.size()) {
    notes.push_back(fmt::format("the motor's position is not used: {} of {} samples lack it", order.size() - measured,
                                order.size()));
    return {};
  }
  std::vector<double> out, offset;
  for (const std::size_t i : order) {
    out.push_back(m.motor_position[i] / *gear_ratio);
    offset.push_back(m.position[i] - out.back());
  }
  const double zero = median(offset);
  for (double& x : out) x += zero;
  notes.push_back(fmt::format(
      "the motor's position counts from where it was switched on: moved by {:.4g} rad to the output's median", zero));
  return out;
}

std::string label(const HebiModule& m) {
  std::string text = quoted(m.name.empty() ? m.address : m.name);
  if (!m.family.empty()) text += " of " + quoted(m.family);
  if (!m.address.empty()) text += fmt::format(" ({}:{})", m.address, m.port);
  return text;
}

}  // namespace

const HebiModule& choose_module(const HebiLog& log, const std::string& module) {
  std::vector<const HebiModule*> all, named;
  for (const HebiModule& m : log.modules)
    if (!m.t.empty()) all.push_back(&m);
  std::string list;
  for (std::size_t i = 0; i < all.size(); ++i) list += fmt::format("{}{} {}", i ? "; " : "", i + 1, label(*all[i]));
  if (all.empty()) throw InputError({log.file}, "no module has a sample");
  if (module.empty()) {
    if (all.size() == 1) return *all[0];
    throw InputError({log.file}, fmt::format("{} modules: --module NAME or number is needed: {}", all.size(), list));
  }
  for (const HebiModule* m : all)
    if (m->name == module || m->family + "/" + m->name == module) named.push_back(m);
  if (named.size() == 1) return *named[0];
  if (named.size() > 1)
    throw InputError({log.file}, fmt::format("--module: {}: {} modules are called so: FAMILY/NAME or number is needed: "
                                             "{}",
                                             quoted(module), named.size(), list));
  if (const auto number = parsed_number<std::size_t>(module); number && *number >= 1 && *number <= all.size())
    return *all[*number - 1];
  throw InputError({log.file}, fmt::format("--module: {}: no such module; the log has {}", quoted(module), list));
}

Trial hebi_trial(const HebiLog& log, const HebiTrialOptions& options) {
  const HebiModule& m = choose_module(log, options.module);
  Trial trial;
  trial.file = log.file;
  trial.notes = log.notes;
  std::vector<std::size_t> order = order_samples(log, m, trial.notes);
  drop_duplicates(m, order, trial.notes);
  if (order.size() < 2)
    throw InputError({log.file}, fmt::format("module {}: {}: at least two samples with time and position are needed",
                                             label(m), plural(order.size(), "sample", "samples")));
  for (const std::size_t i : order) trial.t.push_back(m.t[i]), trial.phi.push_back(m.position[i]);
  if (const auto fault = time_fault(trial.t))
    throw InputError({log.file}, fmt::format("module {}: sample {}: stamp {}: {}", label(m), order[fault->at] + 1,
                                             shortest(trial.t[fault->at]), fault->rule));
  trial.phi_ref = hold_commands(m, order, trial.notes);
  trial.phi_motor = motor_angles(m, order, options.gear_ratio, trial.notes);
  if (options.effort == HebiTrialOptions::Effort::kTorque)
    for (const std::size_t i : order) {
      if (i >= m.effort.size() || !std::isfinite(m.effort[i]))
        throw InputError({log.file}, fmt::format("module {}: sample {}: no effort", label(m), i + 1));
      trial.torque.push_back(m.effort[i]);
    }
  if (options.angles == TrialOptions::Angles::kOneTurn)
    for (const auto* column : {&trial.phi, &trial.phi_ref, &trial.phi_motor})
      for (std::size_t k = 0; k < column->size(); ++k)
        if (std::abs((*column)[k]) > 2 * std::numbers::pi)
          throw InputError({log.file},
                           fmt::format("module {}: sample {}: {}: {} rad: an angle beyond 2 pi; --multi-turn if it is "
                                       "meant",
                                       label(m), order[k] + 1,
                                       column == &trial.phi       ? "position"
                                       : column == &trial.phi_ref ? "position command"
                                                                  : "motor position / gear_ratio",
                                       shortest((*column)[k])));
  count_from_first(trial);
  return trial;
}

}  // namespace ukemi::identify
