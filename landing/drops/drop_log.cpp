#include "landing/drops/drop_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/csv.hpp"
#include "common/degrees.hpp"

namespace ukemi::landing {

namespace {

/// A column that is known, and what makes SI of it.
struct Column {
  const char* name;
  int output;  ///< DropOutput; -1: time
  double unit;
};
constexpr double kG = 9.80665;
constexpr std::array<Column, 14> kColumns = {{{"t", -1, 1},
                                              {"t_ms", -1, 1e-3},
                                              {"acc", kAcc, 1},
                                              {"acc_g", kAcc, kG},
                                              {"ax", kAccX, 1},
                                              {"ax_g", kAccX, kG},
                                              {"ay", kAccY, 1},
                                              {"ay_g", kAccY, kG},
                                              {"x_0", kThighX, 1},
                                              {"x_0_mm", kThighX, 1e-3},
                                              {"y_0", kThighY, 1},
                                              {"y_0_mm", kThighY, 1e-3},
                                              {"phi_0", kThighAngle, 1},
                                              {"phi_0_deg", kThighAngle, kDegree}}};

const Column* find(const std::string& name) {
  const auto it = std::find_if(kColumns.begin(), kColumns.end(), [&](const Column& c) { return name == c.name; });
  return it == kColumns.end() ? nullptr : &*it;
}

}  // namespace

long DropLog::count(DropOutput o) const {
  return std::count_if(output[o].begin(), output[o].end(), [](double x) { return std::isfinite(x); });
}

DropLog read_drop(const std::string& path) {
  const CsvTable table = read_csv(path, [](const std::string& name) { return find(name) != nullptr; });
  DropLog log;
  log.file = path;
  int time = -1;
  std::array<int, kOutputs> from;
  from.fill(-1);
  for (int c = 0; c < int(table.header.size()); ++c) {
    const Column* column = find(table.header[std::size_t(c)]);
    if (!column) continue;
    int& place = column->output < 0 ? time : from[std::size_t(column->output)];
    if (place >= 0)
      throw InputError({path, table.header_line, table.header_column[std::size_t(c)]},
                       fmt::format("column {}: {} gives the same in another unit: one of them is needed",
                                   quoted(column->name), quoted(table.header[std::size_t(place)])));
    place = c;
  }
  if (time < 0) throw InputError({path, table.header_line}, "no column 't'" + hint("t", table.header));
  if (std::all_of(from.begin(), from.end(), [](int c) { return c < 0; }))
    throw InputError(
        {path, table.header_line},
        "no measured output: at least one of acc, ax, ay, x_0, y_0, phi_0 is needed" + hint("acc", table.header));

  std::vector<double> t = table.columns[std::size_t(time)];
  table.require_full(time);
  for (double& s : t) s *= find(table.header[std::size_t(time)])->unit;
  table.require_increasing(time, t);
  if (t.front() >= kLongestGap)
    throw InputError(table.at(time, 0), fmt::format("column 't': {} s: time counts from the release, t = 0: less than "
                                                    "{:g} s is needed",
                                                    shortest(t.front()), kLongestGap));
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t[i] < 0) {
      ++log.before_release;
      continue;
    }
    log.t.push_back(t[i]);
    for (int o = 0; o < kOutputs; ++o) {
      if (from[std::size_t(o)] < 0) continue;
      const auto c = std::size_t(from[std::size_t(o)]);
      const double value = table.columns[c][i] * find(table.header[c])->unit;
      if (o == kThighAngle && std::abs(value) > 2 * std::numbers::pi)
        throw InputError(table.at(int(c), i),
                         fmt::format("column {}: {}: an angle beyond 2 pi rad; are these degrees? then name the column "
                                     "phi_0_deg",
                                     quoted(table.header[c]), shortest(table.columns[c][i])));
      log.output[std::size_t(o)].push_back(value);
    }
  }
  if (log.t.size() < 2)
    throw InputError({path, table.line.back()},
                     fmt::format("{} rows from the release (t = 0) on: at least two are needed", log.t.size()));
  return log;
}

}  // namespace ukemi::landing
