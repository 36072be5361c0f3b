#include "landing/drops/drop_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

namespace {

/// A known column and the factor that converts it to SI.
struct Column {
  std::string name;
  int output;  ///< index of the channel; -1: time
  double unit;
};

std::vector<Column> columns_of(const std::vector<DropChannel>& channels) {
  constexpr double kG = 9.80665;
  std::vector<Column> out = {{"t", -1, 1}, {"t_ms", -1, 1e-3}};
  for (int o = 0; o < int(channels.size()); ++o) {
    const DropChannel& c = channels[std::size_t(o)];
    out.push_back({c.name, o, 1});
    if (c.unit == "m/s^2") out.push_back({c.name + "_g", o, kG});
    if (c.unit == "m") out.push_back({c.name + "_mm", o, 1e-3});
    if (c.unit == "rad") out.push_back({c.name + "_deg", o, kDegree});
  }
  return out;
}

/// Notes on columns that are not read: those of the paper's robot, and near misses of missing ones.
std::vector<std::string> notes_of(const CsvTable& table, const std::vector<Column>& columns) {
  const auto contains = [](const std::vector<Column>& list, const std::string& name) {
    return std::any_of(list.begin(), list.end(), [&](const Column& c) { return c.name == name; });
  };
  const std::vector<Column> paper_columns = columns_of(thigh_channels());
  std::vector<std::string> missing, out;
  for (const Column& c : columns)
    if (table.find(c.name) < 0) missing.push_back(c.name);
  for (const std::string& name : table.header)
    if (!contains(columns, name) && contains(paper_columns, name))
      out.push_back("column " + quoted(name) +
                    " is not read: of a robot of links x_LINK, y_LINK are of a link's origin, theta_LINK its angle");
  const auto known = [&](const std::string& name) { return contains(columns, name) || contains(paper_columns, name); };
  for (const auto& [c, hint_text] : table.near_misses(known, missing))
    out.push_back("column " + quoted(table.header[c]) + " is not read" + hint_text);
  return out;
}

}  // namespace

const std::vector<DropChannel>& thigh_channels() {
  using enum DropChannel::Kind;
  static const std::vector<DropChannel> channels = {{"acc", "m/s^2", true, kAcc}, {"ax", "m/s^2", true, kAccX},
                                                    {"ay", "m/s^2", true, kAccY}, {"x_0", "m", false, kPeakX},
                                                    {"y_0", "m", false, kPeakY},  {"phi_0", "rad", false, kTheta}};
  return channels;
}

std::vector<DropChannel> body_channels(const Robot& robot) {
  using enum DropChannel::Kind;
  std::vector<DropChannel> out = {
      {"acc", "m/s^2", true, kAcc}, {"ax", "m/s^2", true, kAccX}, {"ay", "m/s^2", true, kAccY}};
  for (int i = 0; i < int(robot.links.size()); ++i) {
    const std::string& link_name = robot.links[std::size_t(i)].name;
    out.push_back({"x_" + link_name, "m", false, kOriginX, i}),
        out.push_back({"y_" + link_name, "m", false, kOriginY, i});
    out.push_back({"theta_" + link_name, "rad", false, kTheta, i});
  }
  for (int i = 0; i < int(robot.joints.size()); ++i)
    if (const Joint& j = robot.joints[std::size_t(i)]; j.kind != DriveKind::kLocked)
      out.push_back({"phi_" + j.name, "rad", false, kPhi, i});
  return out;
}

std::string names_of(const std::vector<DropChannel>& channels) {
  std::string out;
  for (std::size_t o = 0; o < channels.size(); ++o)
    out += (o == 0 ? "" : o + 1 < channels.size() ? ", " : " or ") + channels[o].name;
  return out;
}

long DropLog::count(std::size_t o) const {
  return std::count_if(output[o].begin(), output[o].end(), [](double x) { return std::isfinite(x); });
}

DropLog read_drop(const std::string& path, const std::vector<DropChannel>& channels) {
  const std::vector<Column> columns = columns_of(channels);
  const auto find = [&](const std::string& name) {
    const auto it = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return name == c.name; });
    return it == columns.end() ? nullptr : &*it;
  };
  const CsvTable table = read_csv(path, [&](const std::string& name) { return find(name) != nullptr; });
  DropLog log;
  log.file = path, log.notes = notes_of(table, columns);
  log.output.assign(channels.size(), {});
  int time = -1;
  std::vector<int> column_of(channels.size(), -1);
  for (int c = 0; c < int(table.header.size()); ++c) {
    const Column* column = find(table.header[std::size_t(c)]);
    if (!column) continue;
    int& found = column->output < 0 ? time : column_of[std::size_t(column->output)];
    if (found >= 0)
      throw InputError({path, table.header_line, table.header_column[std::size_t(c)]},
                       fmt::format("column {}: {} gives the same in another unit: one of them is needed",
                                   quoted(column->name), quoted(table.header[std::size_t(found)])));
    found = c;
  }
  if (time < 0) throw InputError({path, table.header_line}, "no column 't'" + hint("t", table.header));
  if (std::all_of(column_of.begin(), column_of.end(), [](int c) { return c < 0; }))
    throw InputError({path, table.header_line}, "no measured output: at least one of " + names_of(channels) +
                                                    " is needed" + hint("acc", table.header));

  std::vector<double> t = table.columns[std::size_t(time)];
  table.require_full(time);
  for (double& s : t) s *= find(table.header[std::size_t(time)])->unit;
  table.require_increasing(time, t);
  if (t.front() >= kLongestGap)
    throw InputError(table.at(time, 0),
                     fmt::format("column 't': {} s: time counts from the release, t = 0: less than {:g} s is needed",
                                 shortest(t.front()), kLongestGap));
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t[i] < 0) {
      ++log.before_release;
      continue;
    }
    log.t.push_back(t[i]);
    for (std::size_t o = 0; o < channels.size(); ++o) {
      if (column_of[o] < 0) continue;
      const auto c = std::size_t(column_of[o]);
      const double value = table.columns[c][i] * find(table.header[c])->unit;
      if (channels[o].unit == "rad" && std::abs(value) > 2 * std::numbers::pi)
        throw InputError(
            table.at(int(c), i),
            fmt::format("column {}: {}: an angle beyond 2 pi rad; are these degrees? then name the column {}_deg",
                        quoted(table.header[c]), shortest(table.columns[c][i]), channels[o].name));
      log.output[o].push_back(value);
    }
  }
  if (log.t.size() < 2)
    throw InputError({path, table.line.back()},
                     fmt::format("{} rows from the release (t = 0) on: at least two are needed", log.t.size()));
  return log;
}

}  // namespace ukemi::landing
