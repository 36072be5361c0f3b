#include "identify/trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "common/csv.hpp"

namespace ukemi::identify {

namespace {

const std::vector<std::string> kColumns = {"t", "phi", "force", "phi_ref", "dphi_ref", "phi_motor"};

bool is_angle(const std::string& name) { return name != "t" && name != "force"; }
bool ends_with(const std::string& s, const std::string& tail) {
  return s.size() > tail.size() && s.compare(s.size() - tail.size(), tail.size(), tail) == 0;
}

struct Source {
  std::string column;  ///< name in the file
  double scale = 1;    ///< to SI, sign included
};

/// Unit of a column from its suffix.
double unit_of(const std::string& column, const std::string& name) {
  if (name == "t" && ends_with(column, "_ms")) return 1e-3;
  if (is_angle(name) && ends_with(column, "_deg")) return std::numbers::pi / 180;
  return 1;
}

std::map<std::string, Source> parse_columns(const std::string& text) {
  std::map<std::string, Source> out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string item = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos || equals + 1 == item.size())
      throw InputError("--columns: " + quoted(item) + ": NAME=COLUMN is needed");
    const std::string name = item.substr(0, equals);
    if (std::find(kColumns.begin(), kColumns.end(), name) == kColumns.end())
      throw InputError("--columns: " + quoted(name) + ": one of t, phi, force, phi_ref, dphi_ref, phi_motor is needed" +
                       hint(name, kColumns));
    Source s{item.substr(equals + 1), 1};
    if (s.column.front() == '-') s = {s.column.substr(1), -1};
    s.scale *= unit_of(s.column, name);
    out[name] = s;
  }
  return out;
}

}  // namespace

Trial read_trial(const std::string& path, const TrialOptions& options) {
  const auto given = parse_columns(options.columns);
  const auto candidates = [&](const std::string& name) -> std::vector<Source> {
    const auto it = given.find(name);
    if (it != given.end()) return {it->second};
    std::vector<Source> c{{name, 1}};
    if (name == "t") c.push_back({"t_ms", 1e-3});
    if (is_angle(name)) c.push_back({name + "_deg", std::numbers::pi / 180});
    return c;
  };
  std::map<std::string, Source> wanted;  // by the file's column
  for (const std::string& name : kColumns)
    for (const Source& s : candidates(name)) wanted[s.column] = s;

  const CsvTable table = read_csv(path, [&](const std::string& column) { return wanted.count(column) > 0; });
  Trial trial;
  trial.file = path;
  std::map<std::string, int> index;
  const auto load = [&](const std::string& name, std::vector<double>& out) {
    for (const Source& s : candidates(name)) {
      const int c = table.find(s.column);
      if (c < 0) continue;
      if (!out.empty())
        throw InputError({path, table.header_line, table.header_column[std::size_t(c)]},
                         "column " + quoted(s.column) + ": '" + name + "' is given twice");
      index[name] = c;
      const auto& column = table.columns[std::size_t(c)];
      out.resize(column.size());
      for (std::size_t i = 0; i < column.size(); ++i) {
        if (std::isnan(column[i]))
          throw InputError(table.at(c, i), "column '" + s.column + "': empty: a number is needed");
        out[i] = column[i] * s.scale;
        if (is_angle(name) && name != "dphi_ref" && options.angles == TrialOptions::Angles::kOneTurn &&
            std::abs(out[i] / (name == "phi_motor" ? options.gear_ratio : 1)) > 2 * std::numbers::pi)
          throw InputError(table.at(c, i),
                           fmt::format("column '{}': {}: an angle beyond 2 pi rad; are these degrees? then name "
                                       "the column {}_deg (or --columns {}=..._deg); --multi-turn if it is meant",
                                       s.column, shortest(column[i]), name, name));
      }
    }
    if (out.empty() && given.count(name))
      throw InputError({path, table.header_line},
                       "no column " + quoted(given.at(name).column) + hint(given.at(name).column, table.header));
  };
  load("t", trial.t);
  load("phi", trial.phi);
  load("force", trial.force);
  load("phi_ref", trial.phi_ref);
  load("dphi_ref", trial.dphi_ref);
  load("phi_motor", trial.phi_motor);

  const auto missing = [&](const std::string& name) {
    throw InputError({path, table.header_line}, "no column '" + name + "'" + hint(name, table.header));
  };
  if (trial.t.empty()) missing("t");
  if (options.require_phi && trial.phi.empty()) missing("phi");
  if (trial.force.empty() && trial.phi_ref.empty())
    throw InputError({path, table.header_line},
                     "no column 'force' or 'phi_ref': at least one excitation is needed" + hint("force", table.header));
  if (!trial.dphi_ref.empty() && trial.phi_ref.empty()) missing("phi_ref");
  if (trial.samples() < 2) throw InputError({path, table.line.back()}, "one row: at least two samples are needed");
  for (std::size_t i = 1; i < trial.t.size(); ++i)
    if (!(trial.t[i] > trial.t[i - 1]))
      throw InputError(table.at(index["t"], i), fmt::format("column 't': {}: time must increase; {} stands before it",
                                                            shortest(trial.t[i]), shortest(trial.t[i - 1])));
  for (double& x : trial.phi_motor) x /= options.gear_ratio;
  return trial;
}

int shortest_pulse(const Trial& trial) {
  double peak = 0;
  for (const double f : trial.force) peak = std::max(peak, std::abs(f));
  if (peak == 0) return 0;
  int fewest = 0, run = 0;
  for (std::size_t i = 0; i <= trial.force.size(); ++i) {
    if (i < trial.force.size() && std::abs(trial.force[i]) > 0.05 * peak) {
      ++run;
    } else if (run > 0) {
      fewest = fewest == 0 ? run : std::min(fewest, run);
      run = 0;
    }
  }
  return fewest;
}

double noise_level(const std::vector<double>& x) {
  if (x.size() < 9) return 0;
  std::vector<double> d(x.size() - 4);
  for (std::size_t i = 0; i + 4 < x.size(); ++i)
    d[i] = std::abs(x[i] - 4 * x[i + 1] + 6 * x[i + 2] - 4 * x[i + 3] + x[i + 4]);
  std::nth_element(d.begin(), d.begin() + long(d.size() / 2), d.end());
  const double white =
      d[d.size() / 2] / (0.6744897501960817 * std::sqrt(70.0));  // median of |normal|; 1 + 16 + 36 + 16 + 1 = 70
  // A coarsely quantised log stands still most of the time: then its step, spread evenly, is the noise.
  double step = 0;
  std::size_t still = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double change = std::abs(x[i + 1] - x[i]);
    if (change < 1e-12)
      ++still;
    else
      step = step == 0 ? change : std::min(step, change);
  }
  return 2 * still > x.size() ? std::max(white, step / std::sqrt(12.0)) : white;
}

}  // namespace ukemi::identify
