#include "tools/study/robot_trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/error.hpp"
#include "common/uncertainty_file.hpp"
#include "landing/body/places.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/plan/design_numbers.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

const std::string kCommand = "command.", kSensor = "sensor.", kStart = "start.";

bool has_prefix(const std::string& name, const std::string& prefix) { return name.rfind(prefix, 0) == 0; }

/// The number of "start.JOINT.KEY", or "start.KEY" of the base.
double& start_number(DrivenStart& start, const Robot& robot, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot < kStart.size()) {
    const std::map<std::string, double*> base = {{"height", &start.height}, {"speed", &start.speed},
                                                 {"x", &start.x},           {"forward_speed", &start.forward_speed},
                                                 {"pitch", &start.pitch},   {"pitch_rate", &start.pitch_rate}};
    return *base.at(name.substr(kStart.size()));
  }
  const std::string joint = name.substr(kStart.size(), dot - kStart.size()), key = name.substr(dot + 1);
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].name == joint)
      return key == "phi" ? start.joint[i].phi : key == "dphi" ? start.joint[i].dphi : start.joint[i].spring;
  throw InputError(name + ": no such start");
}

/// Initial value and rate: of a line fitted to the first measured rows, or the measured rate; 0 where none is.
std::array<double, 2> start_of(const std::vector<double>& t, const std::vector<double>& x,
                               const std::vector<double>& rate = {}) {
  constexpr double kSpan = 0.01;  // [s]
  constexpr long kMinRows = 3;
  double n = 0, st = 0, sx = 0, stt = 0, stx = 0;
  for (std::size_t i = 0; i < x.size() && (t[i] <= kSpan || n < kMinRows); ++i) {
    if (!std::isfinite(x[i])) continue;
    n += 1, st += t[i], sx += x[i], stt += t[i] * t[i], stx += t[i] * x[i];
  }
  std::array<double, 2> out{};
  const double spread = n * stt - st * st;
  if (n > 0) out[0] = sx / n;
  if (spread > 0) out[1] = (n * stx - st * sx) / spread, out[0] = (sx - out[1] * st) / n;
  const auto first = std::find_if(rate.begin(), rate.end(), [](double v) { return std::isfinite(v); });
  if (first != rate.end()) out[1] = *first;
  return out;
}
DrivenStart start_of(const DropLog& log, const Robot& robot) {
  DrivenStart out;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const auto* of = &log.output[joint_channel(i)];
    const auto [phi, dphi] = start_of(log.t, of[kAngle], of[kRate]);
    out.joint.push_back({phi, dphi, 0});
  }
  if (robot.base != Base::kFree) return out;
  const auto* base = &log.output[base_channel(robot)];
  const auto [x, forward_speed] = start_of(log.t, base[kOriginX]);
  const auto [pitch, pitch_rate] = start_of(log.t, base[kPitch], base[kPitchRate]);
  out.x = x, out.forward_speed = forward_speed, out.pitch = pitch, out.pitch_rate = pitch_rate;
  if (!base[kOriginY].empty()) out.y = start_of(log.t, base[kOriginY]);
  return out;
}

/// The start from the log's first rows, corrected for gain and bias of the sensors.
DrivenStart corrected(const Sensors& sensors, const Robot& robot, const DropLog& log, DrivenStart s) {
  if (sensors.column.empty()) return s;
  const std::vector<MeasuredColumn> columns = measured_columns(robot);
  const auto correct = [&](std::size_t at, std::size_t rate_at, double& x, double& rate) {
    const Sensor sensor = sensors.of(columns[at].name);
    x = sensor.actual(x);
    const bool rate_measured = rate_at != at && !log.output[rate_at].empty();  // else of the fitted line
    rate = rate_measured ? sensors.of(columns[rate_at].name).actual(rate) : rate / sensor.gain;
  };
  for (std::size_t i = 0; i < s.joint.size(); ++i)
    correct(joint_channel(i) + kAngle, joint_channel(i) + kRate, s.joint[i].phi, s.joint[i].dphi);
  if (robot.base != Base::kFree) return s;
  const std::size_t base = base_channel(robot);
  correct(base + kOriginX, base + kOriginX, s.x, s.forward_speed);
  correct(base + kPitch, base + kPitchRate, s.pitch, s.pitch_rate);
  if (s.y) correct(base + kOriginY, base + kOriginY, (*s.y)[0], (*s.y)[1]);
  return s;
}

/// A number of the command path or the sensors; null for a number of the scene. Throws InputError where there is none.
double* command_or_sensor_number(DrivenRobot& robot, const std::string& name) {
  const bool command = has_prefix(name, kCommand);
  if (!command && !has_prefix(name, kSensor)) return nullptr;
  const Robot& of = robot.scene.robot;
  double* const out = command ? command_number(robot.path, of, name.substr(kCommand.size()))
                              : sensor_number(robot.sensors, of, name.substr(kSensor.size()));
  if (!out) throw InputError(name + ": the robot has no such number");
  return out;
}

/// Whether the sensor of a channel affects that channel's samples only, since no start is taken from it.
bool affects_samples_only(const Robot& robot, std::size_t channel) {
  const std::size_t base = base_channel(robot);
  return channel < base ? channel % kJointSignals == kTorque : channel >= acceleration_channel(robot);
}

/// Sum over the channels of the residual sum of squares over that of the measured values about their mean.
double misfit(const DropLog& log, const FollowedDrop& d) {
  double out = 0;
  for (std::size_t o = 0; o < log.output.size(); ++o) {
    double residual = 0, sum = 0, squares = 0, n = 0;
    for (std::size_t i = 0; i < std::min(log.output[o].size(), d.value[o].size()); ++i)
      if (const double x = log.output[o][i]; std::isfinite(x))
        residual += std::pow(d.value[o][i] - x, 2), sum += x, squares += x * x, n += 1;
    const double spread = n > 0 ? squares - sum * sum / n : 0;
    if (spread > 0) out += residual / spread;
  }
  return out;
}

/// Number of delays and filters of the drives.
long lag_count(const Robot& robot) {
  long out = 0;
  for (const Joint& j : robot.joints)
    if (j.kind == DriveKind::kElastic) out += (j.sea.control_delay > 0) + (j.sea.velocity_filter > 0);
  return out;
}

/// `base` plus the difference `to` - `from`.
FollowedDrop plus_difference(FollowedDrop base, const FollowedDrop& from, const FollowedDrop& to) {
  base.complete = from.complete && to.complete, base.steps = from.steps + to.steps;
  for (std::size_t o = 0; base.complete && o < base.value.size(); ++o)
    for (std::size_t i = 0; i < base.value[o].size(); ++i) base.value[o][i] += to.value[o][i] - from.value[o][i];
  return base;
}

/// Whether no inertia exceeds that of the whole mass at the ends of its link.
bool is_physical(const Robot& robot) {
  constexpr double kMinLength = 0.02;  // [m]
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& l = robot.links[i];
    const double reach = std::max(extent(robot, int(i)), std::hypot(l.com.along, l.com.across));
    if (reach > kMinLength && l.inertia_com > l.mass * reach * reach) return false;
  }
  return true;
}

FitUncertainty read_identified(TomlSection& s, const DrivenRobot& robot) {
  const std::vector<std::string> none, order = s.optional_texts("order").value_or(none),
                                       outputs = s.optional_texts("outputs").value_or(none);
  FitUncertainty out{read_uncertainty(s, order, "the robot"), {}};
  for (const std::string& name : order) try {
      (void)number_of(robot, name);
    } catch (const InputError& e) {
      s.fail("order", e.what());
    }
  std::vector<std::string> known;
  for (const DropChannel& c : sensed_channels(robot.scene.robot)) known.push_back(c.name);
  const std::vector<double> rms = s.optional_list("rms", known.size(), Range::positive());
  if (rms.size() != outputs.size())
    s.fail("rms", fmt::format("{} numbers: 'outputs' names {}", rms.size(), outputs.size()));
  for (std::size_t o = 0; o < outputs.size(); ++o) {
    if (std::find(known.begin(), known.end(), outputs[o]) == known.end()) s.fail("outputs", one_of(outputs[o], known));
    out.rms[outputs[o]] = rms[o];
  }
  return out;
}

}  // namespace

DrivenRobot read_driven_robot(const std::string& path, const Texts& texts) {
  DrivenRobot out{.scene = read_edited_robot(path, texts), .path = {}};
  TomlFile file = open_edited(out.scene.robot_file.empty() ? path : out.scene.robot_file, texts);
  out.path = read_command_path(file, out.scene.robot);
  require_contact_stiffness(out.scene, path);
  if (out.scene.slope != 0)
    throw InputError(Location{path}, "slope_deg: trials are followed on a level floor: 0 is needed");
  try {
    check_driven(out.scene.robot);
  } catch (const InputError& e) {
    throw InputError(Location{path}, e.what());
  }
  out.sensors = read_sensors(file, out.scene.robot);
  const auto has_errors = [](const TomlSection& s) {
    return s.has("order") || s.has("covariance") || s.has("outputs") || s.has("rms");
  };
  if (auto s = file.optional("identified"); s && has_errors(*s)) out.known = read_identified(*s, out);
  return out;
}

std::vector<const DropLog*> logs_of(const std::vector<RobotTrial>& trials) {
  std::vector<const DropLog*> out;
  for (const RobotTrial& t : trials) out.push_back(&t.log);
  return out;
}

std::vector<std::string> runs_of(const std::vector<RobotTrial>& trials) {
  std::vector<std::string> out;
  for (const RobotTrial& t : trials)
    if (std::find(out.begin(), out.end(), t.run) == out.end()) out.push_back(t.run);
  return out;
}

double number_of(const DrivenRobot& robot, const std::string& name) {
  DrivenRobot copy = robot;  // the look-up adds a sensor that is not listed yet
  const double* const number = command_or_sensor_number(copy, name);
  return number ? *number : design_number(robot.scene, name);
}

void set_in(DrivenRobot& robot, const DropTerm& term, double value) {
  for (const std::string& name : term.moves)
    if (double* const number = command_or_sensor_number(robot, name))
      *number = value;
    else
      set_design_number(robot.scene, name, value);
}

RobotTrials::RobotTrials(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                         const RobotFitOptions& options)
    : robot_(robot), trials_(trials), options_(options), channels_(sensed_channels(robot.scene.robot)) {
  const std::vector<std::string> runs = runs_of(trials);
  for (const RobotTrial& t : trials) {
    start_.push_back(start_of(t.log, robot.scene.robot));
    run_.push_back(int(std::find(runs.begin(), runs.end(), t.run) - runs.begin()));
  }
  for (const DropTerm& t : *options.terms.table)
    for (const std::string& name : t.moves)
      if (!has_prefix(name, kCommand) && !has_prefix(name, kSensor) && !has_prefix(name, kStart))
        setters_[name] = design_setter(robot.scene, name);
  for (std::size_t m = 0; m < trials.size() && robot.scene.robot.base != Base::kPinned; ++m)
    if (trials[m].height)
      start_[m].height = *trials[m].height;
    else if (!start_[m].y)
      guess_height(m);
}

/// Estimates the initial height of a trial that does not log it: the best fit to the begin of the log, which shows fall
/// and first contact, of a grid up to kHighest; 0 unless another height is much better.
void RobotTrials::guess_height(std::size_t m) {
  constexpr int kHeights = 40;
  constexpr double kLowest = 0.005, kHighest = 3, kMuchBetter = 0.75;  // [m]; of the misfit at 0
  constexpr double kSpan = 1.5;                                        // [s]
  const std::vector<double>& t = trials_[m].log.t;
  const std::vector<double> first(t.begin(), std::upper_bound(t.begin(), t.end(), kSpan));
  double least = std::numeric_limits<double>::infinity(), best = 0;
  for (int k = 0; k <= kHeights; ++k) {
    const double height = k == 0 ? 0 : kLowest * std::pow(kHighest / kLowest, double(k - 1) / (kHeights - 1));
    start_[m].height = height;
    const FollowedDrop d = follow(m, {}, first, {});
    const double error = d.complete ? misfit(trials_[m].log, d) : std::numeric_limits<double>::infinity();
    if (error < least) least = error, best = height;
    if (k == 0) least = kMuchBetter * error;
  }
  start_[m].height = best;
}

std::vector<double> RobotTrials::horizons() const {
  constexpr double kFirst = 0.2, kLongest = 5;  // [s]
  // Ratio of successive parts, and least ratio of the whole to the last: smaller for a robot with contacts, which meets
  // one touchdown after the other.
  const bool touches = !robot_.scene.robot.contacts.empty();
  const double grow = touches ? 1.25 : 2.3, least = touches ? 1.1 : 2;
  double longest = 0;
  for (const RobotTrial& t : trials_) longest = std::max(longest, t.log.t.back());
  std::vector<double> out;
  for (double part = kFirst; least * part < longest && part < kLongest; part *= grow) out.push_back(part);
  out.push_back(std::numeric_limits<double>::infinity());
  return out;
}

double RobotTrials::value(const DropTerm& constant) const { return number_of(robot_, constant.moves.front()); }

std::optional<RobotTrials::Setup> RobotTrials::set_up(std::size_t m, const Settings& settings) const {
  Setup out{robot_, {}};
  const auto for_each = [&](bool of_start, auto&& f) {
    for (const auto& [term, value] : settings)
      for (const std::string& name : acts_on(m, *term) ? term->moves : std::vector<std::string>{})
        if (has_prefix(name, kStart) == of_start) f(name, value);
  };
  for_each(false, [&](const std::string& name, double value) {
    if (double* const number = command_or_sensor_number(out.robot, name))
      *number = value;
    else
      setters_.at(name)(out.robot.scene, value);
  });
  out.start = corrected(out.robot.sensors, robot_.scene.robot, trials_[m].log, start_[m]);
  for_each(true,
           [&](const std::string& name, double value) { start_number(out.start, robot_.scene.robot, name) += value; });
  try {
    out.robot.scene.robot.validate();
  } catch (const InputError&) {
    return std::nullopt;
  }
  if (!is_physical(out.robot.scene.robot)) return std::nullopt;
  return out;
}

FollowedDrop RobotTrials::roll(std::size_t m, const Setup& setup, const std::vector<double>& times,
                               const DrivenOptions& requested) const {
  FollowedDrop out;
  const Robot& robot = setup.robot.scene.robot;
  std::vector<double> clock = times;
  for (double& t : clock) t += trials_[m].origin;
  DrivenOptions options = options_.roll;
  if (requested.step > 0) options.step = requested.step;
  const auto& measured = trials_[m].log.output;
  const auto loads = measured.begin() + long(acceleration_channel(robot));
  options.loads = requested.loads || std::any_of(loads, measured.end(), [](auto& x) { return !x.empty(); });
  options.sensors = &setup.robot.sensors;
  DrivenRollout rolled = roll_driven(robot, setup.robot.path, *trials_[m].commands, setup.start, clock, options);
  out.complete = rolled.complete, out.steps = rolled.steps, out.changes = std::move(rolled.changes);
  for (ContactChange& c : out.changes) c.t -= trials_[m].origin, out.jumps.push_back(c.t);
  for (auto& joint : rolled.joint)
    for (auto& values : joint) out.value.push_back(std::move(values));
  if (robot.base == Base::kFree)
    for (auto& values : rolled.base) out.value.push_back(std::move(values));
  for (auto& values : rolled.acceleration) out.value.push_back(std::move(values));
  for (auto& contact : rolled.force)
    for (auto& values : contact) out.value.push_back(std::move(values));
  out.value.resize(channels_.size());
  return out;
}

FollowedDrop RobotTrials::logged(FollowedDrop actual, const Sensors& sensors) const {
  for (const auto& [name, sensor] : sensors.column)
    if (const std::optional<std::size_t> c = channel(name))
      for (double& x : actual.value[*c]) x = sensor.logged(x);
  return actual;
}

std::optional<std::size_t> RobotTrials::channel(const std::string& name) const {
  const auto found = std::find_if(channels_.begin(), channels_.end(), [&](auto& c) { return c.name == name; });
  if (found == channels_.end()) return std::nullopt;
  return std::size_t(found - channels_.begin());
}

std::optional<std::size_t> RobotTrials::sensed_by(const DropTerm& term) const {
  if (term.moves.size() != 1 || !has_prefix(term.moves[0], kSensor)) return std::nullopt;
  const std::string name = term.moves[0].substr(kSensor.size());
  return channel(name.substr(0, name.rfind('.')));
}

FollowedDrop RobotTrials::follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                                 const SimulateOptions&) const {
  const std::optional<Setup> setup = set_up(m, settings);
  return setup ? logged(roll(m, *setup, times), setup->robot.sensors) : FollowedDrop{};
}

double RobotTrials::step_of(std::size_t m, const Setup& setup) const {
  if (options_.roll.step > 0) return options_.roll.step;
  return stable_step(setup.robot.scene.robot, setup.robot.path, *trials_[m].commands, setup.start);
}

bool RobotTrials::differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                                const SimulateOptions&, FollowedDrop& followed) const {
  constexpr double kTinyDelay = 1e-12;   // [s]
  constexpr double kContactFactor = 10;  // touchdowns make small differences of a rollout noisy
  const std::optional<Setup> here = set_up(m, settings);
  if (!here) return false;
  const double step = step_of(m, *here);
  const double difference = options_.difference * (here->robot.scene.robot.contacts.empty() ? 1 : kContactFactor);
  return finite_difference_slopes(
      settings, difference, options_.threads,
      [&](const Settings& perturbed, const DropTerm& term, double) {
        if (!acts_on(m, term)) return followed;
        const std::optional<Setup> there = set_up(m, perturbed);
        if (!there) return FollowedDrop{};
        if (const auto c = sensed_by(term); c && affects_samples_only(robot_.scene.robot, *c)) {
          FollowedDrop out = followed;
          const std::string& name = channels_[*c].name;
          const Sensor before = here->robot.sensors.of(name), after = there->robot.sensors.of(name);
          for (double& x : out.value[*c]) x = after.logged(before.actual(x));
          return out;
        }
        const auto rolled = [&](const Setup& setup, double h) {
          return logged(roll(m, setup, times, {.step = h}), setup.robot.sensors);
        };
        if (lag_count(there->robot.scene.robot) == lag_count(here->robot.scene.robot)) return rolled(*there, step);
        Settings slightly_late = perturbed;  // a delay adds states: its difference is between delayed rollouts
        for (Setting& s : slightly_late)
          if (s.term == &term) s.value = kTinyDelay;
        const double delayed_step = step_of(m, *there);
        return plus_difference(followed, rolled(*set_up(m, slightly_late), delayed_step), rolled(*there, delayed_step));
      },
      followed);
}

double RobotTrials::peak(std::size_t m, const Settings& settings, double until, const SimulateOptions&) const {
  constexpr double kSample = 2e-4;  // [s]
  std::vector<double> times;
  for (long k = 0; double(k) * kSample <= until; ++k) times.push_back(double(k) * kSample);
  const std::optional<Setup> setup = set_up(m, settings);
  const FollowedDrop d = setup ? roll(m, *setup, times, {.loads = true}) : FollowedDrop{};
  if (!d.complete) return std::numeric_limits<double>::quiet_NaN();
  const std::vector<double>& norm = d.value[acceleration_channel(robot_.scene.robot)];
  return *std::max_element(norm.begin(), norm.end());
}

}  // namespace ukemi::tools
