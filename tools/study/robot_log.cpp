// Reading of logs of driven robots.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/median.hpp"
#include "identify/logs/columns.hpp"
#include "tools/study/robot_trials.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::ColumnMap, identify::Quantity;

namespace {

constexpr Quantity kCommandQuantity[kCommandColumns] = {Quantity::kAngle,   Quantity::kRate,    Quantity::kTorque,
                                                        Quantity::kCommand, Quantity::kCommand, Quantity::kCommand};

Quantity quantity_of(const std::string& unit) {
  static const std::map<std::string, Quantity> of = {{"m", Quantity::kLength},           {"rad", Quantity::kAngle},
                                                     {"rad/s", Quantity::kRate},         {"Nm", Quantity::kTorque},
                                                     {"m/s^2", Quantity::kAcceleration}, {"N", Quantity::kForce}};
  return of.at(unit);
}

std::vector<identify::Column> known_columns(const Robot& robot) {
  std::vector<identify::Column> out = {{"t", Quantity::kTime}};
  for (const Joint& j : robot.joints) {
    if (j.kind == DriveKind::kLocked) continue;
    for (int q = 0; q < (j.driven() ? kJointSignals : kTorque); ++q)
      out.push_back({std::string(kJointSignalNames[std::size_t(q)]) + "_" + j.name,
                     quantity_of(kJointSignalUnits[std::size_t(q)])});
    for (int q = 0; j.driven() && q < kCommandColumns; ++q)
      out.push_back({std::string(kCommandColumnNames[std::size_t(q)]) + "_" + j.name, kCommandQuantity[q]});
  }
  const std::vector<MeasuredColumn> measured = measured_columns(robot);
  for (std::size_t o = base_channel(robot); o < measured.size(); ++o)
    out.push_back({measured[o].name, quantity_of(measured[o].unit)});
  for (const MeasuredColumn& c : push_columns(robot)) out.push_back({c.name, Quantity::kForce});
  return out;
}

/// The columns of a log in SI units.
class LogColumns {
 public:
  LogColumns(const std::string& path, const ColumnMap& map)
      : map_(map), table_(read_csv(path, [&](const std::string& name) { return map.wants(name); })) {}

  const CsvTable& table() const { return table_; }
  /// Empty, and index -1, where the file has no such column.
  std::vector<double> get(const std::string& name, int* index = nullptr) const {
    identify::Source source;
    const int c = map_.find(table_, name, source);
    if (index) *index = c;
    if (c < 0) return {};
    std::vector<double> out = table_.columns[std::size_t(c)];
    for (double& x : out) x *= source.scale;
    return out;
  }
  std::vector<double> command(const std::string& name) const {
    if (const auto constant = map_.constant(table_, name)) return std::vector<double>(table_.rows(), *constant);
    int c = -1;
    std::vector<double> out = get(name, &c);
    if (c >= 0) table_.require_full(c);
    for (std::size_t i = 0; i < out.size() && name.rfind("on_", 0) == 0; ++i)
      if (!(out[i] >= 0 && out[i] <= 1))
        throw InputError(table_.at(c, i),
                         fmt::format("column '{}': {}: from 0 to 1 is needed, the share of the torque that acts", name,
                                     shortest(out[i])));
    return out;
  }
  std::vector<double> angle(const std::string& name, const RobotLogOptions& options) const {
    int c = -1;
    std::vector<double> out = get(name, &c);
    if (c < 0 && options.measured == RobotLogOptions::Measured::kAngles)
      throw InputError({table_.file, table_.header_line},
                       fmt::format("no column '{}'", name) + hint(name, table_.header));
    for (std::size_t i = 0; i < out.size() && options.angles == RobotLogOptions::Angles::kOneTurn; ++i)
      if (std::abs(out[i]) > 2 * std::numbers::pi)
        throw InputError(table_.at(c, i),
                         fmt::format("column '{}': {} rad: an angle beyond 2 pi; are these degrees? then name the "
                                     "column {}_deg; where turns are meant, --multi-turn",
                                     name, shortest(out[i]), name));
    return out;
  }
  std::vector<double> time() const {
    int c = -1;
    std::vector<double> out = get("t", &c);
    if (c < 0) throw InputError({table_.file, table_.header_line}, "no column 't'" + hint("t", table_.header));
    table_.require_full(c), table_.require_increasing(c, out);
    return out;
  }

 private:
  const ColumnMap& map_;
  CsvTable table_;
};

/// Rows at which a robot on a rail pushes off, one for each hop, see RobotLogOptions::Cuts: the leg's extension rises
/// through the middle of its range (5 % to 95 % quantile), after it was 10 % of the range below, and the reported
/// torques work at least half as much as at the strongest push.
std::vector<std::size_t> push_offs(const Robot& robot, const std::vector<double>& t,
                                   const std::vector<std::vector<double>>& measured) {
  constexpr double kHysteresis = 0.1, kSpan = 0.02, kMinWork = 0.5;  // of the range; [s]; of the largest work
  std::vector<std::vector<double>> phi(robot.joints.size());
  for (std::size_t i = 0; i < phi.size(); ++i)
    phi[i] = robot.joints[i].kind == DriveKind::kLocked ? std::vector<double>(t.size(), robot.joints[i].phi)
                                                        : measured[joint_channel(i) + kAngle];
  const std::vector<double> reach = extensions(robot, phi);
  std::vector<double> sorted = reach;
  std::erase_if(sorted, [](double x) { return !std::isfinite(x); });
  std::sort(sorted.begin(), sorted.end());
  if (sorted.empty()) return {};
  const double low = sorted[sorted.size() / 20], high = sorted[sorted.size() - 1 - sorted.size() / 20];
  const double middle = 0.5 * (low + high), armed_below = middle - kHysteresis * (high - low);
  const auto work_before = [&](std::size_t row) {
    double sum = 0;
    for (std::size_t k = row; k-- > 0 && t[row] - t[k] < kSpan;)
      for (std::size_t i = 0; i < phi.size(); ++i)
        if (const auto& torque = measured[joint_channel(i) + kTorque]; !torque.empty())
          if (const double dw = torque[k] * (phi[i][k + 1] - phi[i][k]); std::isfinite(dw)) sum += dw;
    return sum;
  };
  std::vector<std::size_t> out;
  std::vector<double> work;
  bool armed = false;
  for (std::size_t i = 1; i < t.size(); ++i) {
    armed = armed || reach[i] < armed_below;
    if (!armed || !(reach[i] >= middle)) continue;
    armed = false, out.push_back(i), work.push_back(work_before(i));
  }
  const double largest = work.empty() ? 0 : *std::max_element(work.begin(), work.end());
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < out.size(); ++k)
    if (work[k] >= kMinWork * largest) kept.push_back(out[k]);
  return kept;
}

/// Every n-th cut, and the last.
std::vector<std::size_t> tied(const std::vector<std::size_t>& cuts, int n) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < cuts.size(); ++k)
    if (k % std::size_t(n) == 0 || k + 1 == cuts.size()) out.push_back(cuts[k]);
  return out;
}

/// The first row of each piece, and the end of the last one.
std::vector<std::size_t> cut(const std::vector<double>& t, double length, const std::vector<double>& times) {
  if (!times.empty()) {
    std::vector<std::size_t> out;
    for (const double time : times) out.push_back(std::size_t(std::lower_bound(t.begin(), t.end(), time) - t.begin()));
    return out;
  }
  const double whole = t.back() - t.front();
  const long n = length > 0 ? std::max(1l, std::lround(whole / length)) : 1;
  std::vector<std::size_t> out{0};
  for (long k = 1; k < n; ++k)
    out.push_back(
        std::size_t(std::lower_bound(t.begin(), t.end(), t.front() + whole * double(k) / double(n)) - t.begin()));
  out.push_back(t.size());
  return out;
}

/// Notes gaps of missing rows, over which commands are held and nothing is measured.
void note_gaps(const std::vector<double>& t, std::vector<std::string>& notes) {
  constexpr double kGap = 3;  // median steps
  std::vector<double> steps;
  for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
  const double usual = median(steps);
  const long gaps = std::count_if(steps.begin(), steps.end(), [&](double s) { return s > kGap * usual; });
  const auto widest = std::max_element(steps.begin(), steps.end());
  if (gaps > 0)
    notes.push_back(
        fmt::format("{} gap{}, the widest of {:.3g} s at {:.3f} s, where a row takes {:.3g} s: commands are held "
                    "through it; --pieces cuts the log there",
                    gaps, gaps > 1 ? "s" : "", *widest, t[std::size_t(widest - steps.begin())], usual));
}

/// Notes columns of link positions, which trials of this robot do not use.
void note_unread_places(const CsvTable& table, const Robot& robot, std::vector<std::string>& notes) {
  const std::vector<identify::Column> known = known_columns(robot);
  for (const Link& l : robot.links)
    for (const char* quantity : {"x_", "y_", "theta_"}) {
      const std::string name = quantity + l.name;
      const auto same = [&](const identify::Column& c) { return c.name == name; };
      if (table.find(name) >= 0 && std::none_of(known.begin(), known.end(), same))
        notes.push_back("column " + quoted(name) +
                        " is not read: trials have places of the base of a free robot alone");
    }
}

/// Notes columns that are named like forces but not after a contact of the robot.
void note_unread_forces(const CsvTable& table, const ColumnMap& map, std::vector<std::string>& notes) {
  const auto noted = [&](const std::string& name) {
    return std::any_of(notes.begin(), notes.end(),
                       [&](const std::string& note) { return note.find(quoted(name)) != std::string::npos; });
  };
  for (const std::string& name : table.header)
    if ((name.starts_with("f_") || name.starts_with("force")) && !map.wants(name) && !noted(name))
      notes.push_back("column " + quoted(name) +
                      " is not read: the force on a contact is f_CONTACT_x, f_CONTACT_y, by the contact's name");
}

}  // namespace

std::vector<DropChannel> sensed_channels(const Robot& robot) {
  std::vector<DropChannel> out;
  for (const MeasuredColumn& c : measured_columns(robot)) {
    const bool jumps = c.unit == "m/s^2" || c.unit == "N";
    out.push_back({c.name, c.unit, jumps});
  }
  return out;
}

std::vector<std::string> force_doubts(const DrivenRobot& robot, const std::vector<RobotTrial>& trials) {
  constexpr double kSmall = 0.2, kLarge = 1e3;  // plausible range of the sum of the largest forces over the weight
  constexpr double kTurned = 0.05;              // largest over -lowest force below which the sign looks wrong
  const Robot& body = robot.scene.robot;
  std::vector<std::string> out, upright;
  double total = 0;
  const std::vector<DropChannel> channels = sensed_channels(body);
  for (std::size_t o = 0; o < channels.size(); ++o) {
    const std::string& name = channels[o].name;
    if (channels[o].unit != "N") continue;
    const Sensor sensor = robot.sensors.of(name);
    std::map<std::string, double> size;  // largest magnitude in each log
    double lowest = 0, largest = 0, overall = 0;
    for (const RobotTrial& t : trials)
      for (const double x : t.log.output[o]) {
        if (!std::isfinite(x)) continue;
        double& of_log = size[t.run];
        of_log = std::max(of_log, std::abs(x)), overall = std::max(overall, of_log);
        lowest = std::min(lowest, sensor.actual(x)), largest = std::max(largest, sensor.actual(x));
      }
    for (const auto& [run, amount] : size)
      if (amount == 0 && overall > 0) out.push_back(fmt::format("{}: column {}: 0 in every row", run, quoted(name)));
    if (overall == 0 || !name.ends_with(kForceNames[1])) continue;
    if (largest < kTurned * -lowest) {
      out.push_back(fmt::format(
          "column {}: down to {:.3g} N and hardly above 0, where the floor pushes upwards: is its sign turned?",
          quoted(name), lowest));
    } else {
      upright.push_back(name), total += largest;
    }
  }
  const double weight = body.base == Base::kPinned ? 0 : body.mass() * body.gravity;
  if (weight > 0 && total > 0 && (total < kSmall * weight || total > kLarge * weight))
    out.push_back(
        fmt::format("the forces of contacts ({}) come to {:.3g} N at most, and the robot weighs {:.3g} N: are they in "
                    "N? Another unit is said by the name, as {}_kN",
                    fmt::join(upright, ", "), total, weight, upright.front()));
  return out;
}

std::vector<std::string> remove_flat_columns(const Robot& robot, std::vector<RobotTrial>& trials) {
  std::vector<std::string> out;
  const std::vector<DropChannel> channels = sensed_channels(robot);
  for (std::size_t o = 0; o < channels.size(); ++o) {
    double first = std::numeric_limits<double>::quiet_NaN();
    bool varies = channels[o].unit == "rad" || channels[o].unit == "m", there = false;
    for (const RobotTrial& t : trials)
      for (const double x : t.log.output[o]) {
        there = true;
        if (std::isnan(first)) first = x;
        varies = varies || (std::isfinite(x) && x != first);
      }
    if (varies || !there) continue;
    out.push_back(fmt::format("column {}: the same in every row, it is left out", quoted(channels[o].name)));
    for (RobotTrial& t : trials) t.log.output[o].clear();
  }
  return out;
}

namespace {

constexpr std::size_t kFewestRows = 8;  // of a trial

/// The rows between two cuts each, as trials of their own.
std::vector<RobotTrial> pieces_of(const std::string& path, const std::shared_ptr<Commands>& commands,
                                  const std::vector<std::vector<double>>& measured,
                                  const std::vector<std::size_t>& cuts) {
  std::vector<RobotTrial> out;
  for (std::size_t p = 0; p + 1 < cuts.size(); ++p) {
    const std::size_t from = cuts[p], to = cuts[p + 1];
    if (to < from + kFewestRows)
      throw InputError(fmt::format("--pieces: fewer than {} rows of '{}' from {:g} s on in one", kFewestRows, path,
                                   commands->t[std::min(from, commands->t.size() - 1)]));
    RobotTrial trial{.log = {}, .origin = commands->t[from], .run = path, .commands = commands};
    trial.log.file = to - from == commands->t.size()
                         ? path
                         : fmt::format("{}, {:.3f} to {:.3f} s", path, trial.origin, commands->t[to - 1]);
    for (std::size_t i = from; i < to; ++i) trial.log.t.push_back(commands->t[i] - trial.origin);
    trial.log.output.assign(measured.size(), {});
    for (std::size_t o = 0; o < measured.size(); ++o)
      if (!measured[o].empty())
        trial.log.output[o] = {measured[o].begin() + long(from), measured[o].begin() + long(to)};
    out.push_back(std::move(trial));
  }
  return out;
}

}  // namespace

std::vector<RobotTrial> read_robot_trials(const std::string& path, const Robot& robot, const RobotLogOptions& options) {
  const ColumnMap map("--columns", options.columns, known_columns(robot));
  const LogColumns log(path, map);
  auto commands = std::make_shared<Commands>();
  commands->t = log.time();
  if (commands->t.size() < kFewestRows)
    throw InputError({path, log.table().line.back()},
                     fmt::format("{} rows: at least {} are needed", commands->t.size(), kFewestRows));
  commands->joint.resize(robot.joints.size());
  const std::vector<DropChannel> channels = sensed_channels(robot);
  std::vector<std::vector<double>> measured(channels.size());
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& j = robot.joints[i];
    if (j.kind == DriveKind::kLocked) continue;
    measured[joint_channel(i) + kAngle] = log.angle("phi_" + j.name, options);
    measured[joint_channel(i) + kRate] = log.get("dphi_" + j.name);
    if (!j.driven()) continue;
    measured[joint_channel(i) + kTorque] = log.get("torque_" + j.name);
    for (std::size_t q = 0; q < kCommandColumns; ++q)
      commands->joint[i][q] = log.command(std::string(kCommandColumnNames[q]) + "_" + j.name);
  }
  for (std::size_t o = base_channel(robot); o < channels.size(); ++o) measured[o] = log.get(channels[o].name);
  const std::vector<MeasuredColumn> pushed = push_columns(robot);
  for (std::size_t c = 0; c < pushed.size(); c += 2) {
    auto& force = commands->push.emplace_back();
    for (std::size_t q = 0; q < 2; ++q) force[q] = log.command(pushed[c + q].name);
    if (force[0].empty() && force[1].empty())
      throw InputError({path, log.table().header_line}, fmt::format("no column '{}' or '{}': the robot has this push",
                                                                    pushed[c].name, pushed[c + 1].name));
  }
  const bool hops = options.cuts == RobotLogOptions::Cuts::kHops;
  if (hops && robot.base != Base::kRail)
    throw InputError("--pieces: auto: base = \"rail\" is needed: a log is cut where a robot on a rail pushes off");
  const std::vector<std::size_t> cuts = tied(
      hops ? push_offs(robot, commands->t, measured) : cut(commands->t, options.pieces, options.times), options.tied);
  if (hops && cuts.size() < 2)
    throw InputError(
        {path}, fmt::format("--pieces: auto: {} pushes: at least two are needed, a piece is between two", cuts.size()));
  std::vector<std::string> notes = near_misses(log.table(), map);
  note_gaps(commands->t, notes), note_unread_places(log.table(), robot, notes);
  note_unread_forces(log.table(), map, notes);
  std::vector<RobotTrial> out = pieces_of(path, commands, measured, cuts);
  if (!out.empty()) out.front().notes = std::move(notes);
  return out;
}

}  // namespace ukemi::tools
