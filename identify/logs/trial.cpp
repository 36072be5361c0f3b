#include "identify/logs/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/noise.hpp"
#include "common/same_numbers.hpp"
#include "identify/logs/columns.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

const std::vector<Column> kColumns = {{"t", Quantity::kTime},          {"phi", Quantity::kAngle},
                                      {"force", Quantity::kForce},     {"phi_ref", Quantity::kAngle},
                                      {"dphi_ref", Quantity::kRate},   {"phi_motor", Quantity::kAngle},
                                      {"command", Quantity::kCommand}, {"torque", Quantity::kTorque},
                                      {"dphi", Quantity::kRate},       {"dphi_motor", Quantity::kRate}};

/// The angle as the running sum of an encoder's rate, from 0 on. Exact to the encoder's step where the rate is the
/// encoder's change from sample to sample.
std::vector<double> running_sum(const std::vector<double>& t, const std::vector<double>& rate) {
  std::vector<double> out(rate.size(), 0.0);
  for (std::size_t i = 1; i < rate.size(); ++i) out[i] = out[i - 1] + rate[i] * (t[i] - t[i - 1]);
  return out;
}

/// The columns of a trial.
struct TrialColumn {
  const char* name;
  std::vector<double> Trial::*at;
};
constexpr TrialColumn kTrialColumns[] = {{"phi", &Trial::phi},           {"phi_motor", &Trial::phi_motor},
                                         {"torque", &Trial::torque},     {"phi_ref", &Trial::phi_ref},
                                         {"dphi_ref", &Trial::dphi_ref}, {"command", &Trial::command},
                                         {"force", &Trial::force}};

bool constant(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [&](double v) { return v == x.front(); });
}
bool zero(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [](double v) { return v == 0; });
}

/// Advice for a column that is read as radians and may hold degrees; empty where it is read in another unit.
std::string advice_on_unit(const std::string& name, const Source& s) {
  if (std::abs(s.scale) != 1) return "";
  return fmt::format("are these degrees? then name the column {}_deg, or give --columns {}={}*{}; ", name, name,
                     shortest(s.scale * kDegree), s.column);
}

}  // namespace

Trial read_trial(const std::string& path, const TrialOptions& options) {
  const ColumnMap map("--columns", options.columns, kColumns);
  const CsvTable table = read_csv(path, [&](const std::string& column) { return map.wants(column); });
  Trial trial;
  trial.file = path;
  int time_column = -1;
  const auto load = [&](const Column& which, std::vector<double>& out) {
    Source s;
    const int c = map.find(table, which.name, s);
    if (which.quantity == Quantity::kTime) time_column = c;
    if (c < 0) return;
    const bool one_turn = which.quantity == Quantity::kAngle && options.angles == TrialOptions::Angles::kOneTurn;
    const double gear = which.name == "phi_motor" || which.name == "dphi_motor" ? options.gear_ratio : 1;
    table.require_full(c);
    const auto& column = table.columns[std::size_t(c)];
    out.resize(column.size());
    for (std::size_t i = 0; i < column.size(); ++i) {
      out[i] = column[i] * s.scale / gear;
      if (one_turn && std::abs(out[i]) > 2 * std::numbers::pi)
        throw InputError(table.at(c, i),
                         fmt::format("column '{}': {}: an angle beyond 2 pi rad; {}--multi-turn if it is meant",
                                     s.column, shortest(column[i]), advice_on_unit(which.name, s)));
    }
  };
  std::vector<double> dphi, dphi_motor;
  std::vector<double>* const targets[] = {&trial.t,        &trial.phi,       &trial.force,   &trial.phi_ref,
                                          &trial.dphi_ref, &trial.phi_motor, &trial.command, &trial.torque,
                                          &dphi,           &dphi_motor};
  for (std::size_t k = 0; k < kColumns.size(); ++k) load(kColumns[k], *targets[k]);

  const auto missing = [&](const std::string& name) {
    throw InputError({path, table.header_line}, "no column '" + name + "'" + hint(name, table.header));
  };
  if (trial.t.empty()) missing("t");
  const auto sum = [&](const char* name, const std::vector<double>& rate, std::vector<double>& angle) {
    if (rate.empty() || !angle.empty()) return;
    angle = running_sum(trial.t, rate);
    trial.notes.push_back(
        fmt::format("the angle is the running sum of {}, from 0 on: right for an encoder's rate", name));
  };
  sum("dphi", dphi, trial.phi), sum("dphi_motor", dphi_motor, trial.phi_motor);
  if (options.require_phi && trial.phi.empty()) missing("phi");
  const bool elsewhere = options.force == TrialOptions::Force::kElsewhere;
  if (trial.force.empty() && trial.phi_ref.empty() && trial.command.empty() && !elsewhere)
    throw InputError({path, table.header_line},
                     "no column 'force' or 'phi_ref': at least one excitation is needed" + hint("force", table.header));
  if (!trial.dphi_ref.empty() && trial.phi_ref.empty()) missing("phi_ref");
  if (trial.samples() < 2) throw InputError({path, table.line.back()}, "one row: at least two samples are needed");
  table.require_increasing(time_column, trial.t);
  count_from_first(trial);
  for (std::string& note : near_misses(table, map)) trial.notes.push_back(std::move(note));
  return trial;
}

void count_from_first(Trial& trial) {
  if (trial.t.empty() || trial.t.front() == 0) return;
  const double first = trial.t.front();
  for (std::vector<double>* times : {&trial.t, &trial.force_t})
    for (double& t : *times) t -= first;
  trial.t_origin += first;
}

std::string Trial::clock_time(double at) const {
  constexpr double kMicroseconds = 1e6;
  return shortest(std::round((t_origin + at) * kMicroseconds) / kMicroseconds);
}

void Trial::validate() const {
  const std::string what = file.empty() ? "trial" : file;
  const auto check_times = [&](const char* name, const std::vector<double>& times) {
    require_times(what + ": " + name, times);
    if (!(std::abs(times.front()) <= kLongestGap))
      throw InputError(fmt::format("{}: {}[0]: {}: within {:g} s of 0 is needed: see count_from_first", what, name,
                                   shortest(times.front()), kLongestGap));
  };
  check_times("t", t);
  if (!force_t.empty()) check_times("force_t", force_t);
  constexpr double kMost = 1e12;  // sums of squares stay finite
  for (const auto& [name, at] : kTrialColumns) {
    const std::vector<double>& column = this->*at;
    const std::size_t rows = at == &Trial::force && !force_t.empty() ? force_t.size() : t.size();
    if (!column.empty() && column.size() != rows)
      throw InputError(
          fmt::format("{}: {}: {} values: {} are needed, one for each time", what, name, column.size(), rows));
    for (std::size_t i = 0; i < column.size(); ++i)
      if (!(std::abs(column[i]) <= kMost))
        throw InputError(fmt::format("{}: {}[{}]: {}: a finite number within {:g} is needed", what, name, i,
                                     shortest(column[i]), kMost));
  }
  if (!dphi_ref.empty() && phi_ref.empty()) throw InputError(what + ": dphi_ref without phi_ref");
  check_not_negative(what + ": force_noise", force_noise), check_finite(what + ": force_rest", force_rest);
  // Only finite: finite differences step over the bounds, which `fit` checks.
  check_finite(what + ": force_smooth", force_smooth);
  if (rig) rig->validate();
}

void require_excitation(const Trial& trial) {
  if (!zero(trial.force) || !constant(trial.phi_ref) || !zero(trial.dphi_ref) || !zero(trial.command)) return;
  throw InputError({trial.file}, fmt::format("no excitation: {} and {}: a force or a moving reference is needed",
                                             trial.force.empty() ? "no force" : "a force of 0 throughout",
                                             trial.phi_ref.empty() ? "no reference" : "a reference that stays"));
}

bool same_content(const Trial& a, const Trial& b) {
  return same_numbers(a.t, b.t) && same_numbers(a.force_t, b.force_t) &&
         std::ranges::all_of(kTrialColumns, [&](auto& c) { return same_numbers(a.*c.at, b.*c.at); });
}

std::vector<double> force_at_samples(const Trial& trial) {
  if (trial.force_t.empty()) return trial.force;
  const std::vector<double>&ft = trial.force_t, &f = trial.force;
  std::vector<double> out;
  for (const double t : trial.t) {
    const auto after = std::lower_bound(ft.begin(), ft.end(), t);
    if (after == ft.end() || t < ft.front()) {
      out.push_back(0);
    } else if (after == ft.begin()) {
      out.push_back(f.front());
    } else {
      const std::size_t i = std::size_t(after - ft.begin());
      out.push_back(f[i - 1] + (f[i] - f[i - 1]) * (t - ft[i - 1]) / (ft[i] - ft[i - 1]));
    }
  }
  return out;
}

double angle_per_torque(const Trial& trial) {
  if (trial.torque.empty()) return 0;
  constexpr double kExact = 1e-6;  // of a column's range: lower bound of its noise
  const auto noise = [](const std::vector<double>& x) {
    return x.empty() ? 0 : std::max(noise_level(x), kExact * largest_deviation(x, x.front()));
  };
  const double angle = std::max(noise(trial.phi), noise(trial.phi_motor)), torque = noise(trial.torque);
  return torque > 0 ? angle / torque : 0;
}

long measurements(const std::vector<Trial>& trials) {
  long n = 0;
  for (const Trial& t : trials) n += long(t.measurements());
  return n;
}

double noise_level(const std::vector<const Trial*>& trials) {
  double sum = 0, n = 0;
  for (const Trial* t : trials)
    for (const std::vector<double>* column : {&t->phi, &t->phi_motor}) {
      const double noise = noise_level(*column);
      sum += double(column->size()) * noise * noise, n += double(column->size());
    }
  return n > 0 ? std::sqrt(sum / n) : 0;
}
double noise_level(const std::vector<Trial>& trials) {
  std::vector<const Trial*> all;
  for (const Trial& t : trials) all.push_back(&t);
  return noise_level(all);
}

}  // namespace ukemi::identify
