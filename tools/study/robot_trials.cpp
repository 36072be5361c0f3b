#include "tools/study/robot_trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "landing/plan/design_numbers.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

const std::string kCommand = "command.", kStart = "start.";

bool begins(const std::string& name, const std::string& with) { return name.rfind(with, 0) == 0; }

/// The joint and the key of "start.JOINT.KEY".
double& number_in(DrivenStart& start, const Robot& robot, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot < kStart.size()) return name == kStart + "height" ? start.height : start.speed;
  const std::string joint = name.substr(kStart.size(), dot - kStart.size()), key = name.substr(dot + 1);
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].name == joint)
      return key == "phi" ? start.joint[i].phi : key == "dphi" ? start.joint[i].dphi : start.joint[i].spring;
  throw InputError(name + ": no such start");
}

/// Angle and rate by a line through the first rows that are measured; 0 where none is.
JointStart start_of(const DropLog& log, std::size_t joint) {
  constexpr double kSpan = 0.01;  // [s]
  constexpr long kLeast = 3;
  const std::vector<double>&phi = log.output[kSensed * joint + kAngle], &dphi = log.output[kSensed * joint + kRate];
  double n = 0, st = 0, sp = 0, stt = 0, stp = 0;
  for (std::size_t i = 0; i < phi.size() && (log.t[i] <= kSpan || n < kLeast); ++i) {
    if (!std::isfinite(phi[i])) continue;
    n += 1, st += log.t[i], sp += phi[i], stt += log.t[i] * log.t[i], stp += log.t[i] * phi[i];
  }
  JointStart out;
  const double spread = n * stt - st * st;
  if (n > 0) out.phi = sp / n;
  if (spread > 0) out.dphi = (n * stp - st * sp) / spread, out.phi = (sp - out.dphi * st) / n;
  const auto first = std::find_if(dphi.begin(), dphi.end(), [](double x) { return std::isfinite(x); });
  if (first != dphi.end()) out.dphi = *first;
  return out;
}

/// Whether matter can have these numbers: no inertia beyond that of all the mass at both ends of a link.
bool is_possible(const Robot& robot) {
  constexpr double kShort = 0.02;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& l = robot.links[i];
    const double most = std::max(extent(robot, int(i)), std::hypot(l.com.along, l.com.across));
    if (most > kShort && l.inertia_com > l.mass * most * most) return false;
  }
  return true;
}

}  // namespace

DrivenRobot read_driven_robot(const std::string& path) {
  DrivenRobot out{.scene = read_robot(path), .path = {}};
  TomlFile file(out.scene.robot_file.empty() ? path : out.scene.robot_file);
  out.path = read_command_path(file, out.scene.robot);
  try {
    check_driven(out.scene.robot);
  } catch (const InputError& e) {
    throw InputError(Location{path}, e.what());
  }
  return out;
}

std::vector<const DropLog*> logs_of(const std::vector<RobotTrial>& trials) {
  std::vector<const DropLog*> out;
  for (const RobotTrial& t : trials) out.push_back(&t.log);
  return out;
}

double number_of(const DrivenRobot& robot, const std::string& name) {
  if (!begins(name, kCommand)) return design_number(robot.scene, name);
  CommandPath path = robot.path;
  return *command_number(path, robot.scene.robot, name.substr(kCommand.size()));
}

void set_in(DrivenRobot& robot, const DropTerm& term, double value) {
  for (const std::string& name : term.moves)
    if (begins(name, kCommand))
      *command_number(robot.path, robot.scene.robot, name.substr(kCommand.size())) = value;
    else
      set_design_number(robot.scene, name, value);
}

RobotTrials::RobotTrials(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                         const RobotFitOptions& options)
    : robot_(robot), trials_(trials), options_(options), channels_(sensed_channels(robot.scene.robot)) {
  for (const RobotTrial& t : trials) {
    DrivenStart start;
    for (std::size_t i = 0; i < robot.scene.robot.joints.size(); ++i) start.joint.push_back(start_of(t.log, i));
    start_.push_back(std::move(start));
  }
  for (const DropTerm& t : *options.terms.table)
    for (const std::string& name : t.moves)
      if (!begins(name, kCommand) && !begins(name, kStart)) setters_[name] = design_setter(robot.scene, name);
}

std::vector<double> RobotTrials::parts() const {
  double longest = 0;
  for (const RobotTrial& t : trials_) longest = std::max(longest, t.log.t.back());
  std::vector<double> out;
  for (const double after : {0.2, 0.5, 1.0, 2.0, 4.0})
    if (2 * after < longest) out.push_back(after);
  out.push_back(std::numeric_limits<double>::infinity());
  return out;
}

double RobotTrials::value(const DropTerm& constant) const { return number_of(robot_, constant.moves.front()); }

std::optional<RobotTrials::Posed> RobotTrials::pose(std::size_t m, const Settings& settings) const {
  Posed out{robot_, start_[m]};
  for (const auto& [term, value] : settings)
    for (const std::string& name : term->moves)
      if (begins(name, kStart))
        number_in(out.start, robot_.scene.robot, name) += value;
      else if (begins(name, kCommand))
        *command_number(out.robot.path, robot_.scene.robot, name.substr(kCommand.size())) = value;
      else
        setters_.at(name)(out.robot.scene, value);
  try {
    out.robot.scene.robot.validate();
  } catch (const InputError&) {
    return std::nullopt;
  }
  if (!is_possible(out.robot.scene.robot)) return std::nullopt;
  return out;
}

FollowedDrop RobotTrials::roll(std::size_t m, const Settings& settings, const std::vector<double>& times,
                               double step) const {
  FollowedDrop out;
  const std::optional<Posed> posed = pose(m, settings);
  if (!posed) return out;
  std::vector<double> clock = times;
  for (double& t : clock) t += trials_[m].origin;
  DrivenOptions options = options_.roll;
  if (step > 0) options.step = step;
  DrivenRollout rolled =
      roll_driven(posed->robot.scene.robot, posed->robot.path, *trials_[m].commands, posed->start, clock, options);
  out.complete = rolled.complete, out.steps = rolled.steps, out.changes = std::move(rolled.changes);
  for (ContactChange& c : out.changes) c.t -= trials_[m].origin, out.jumps.push_back(c.t);
  for (auto& joint : rolled.joint)
    for (auto& values : joint) out.value.push_back(std::move(values));
  return out;
}

FollowedDrop RobotTrials::follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                                 const SimulateOptions&) const {
  return roll(m, settings, times, 0);
}

bool RobotTrials::differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                                const SimulateOptions&, FollowedDrop& followed) const {
  const std::optional<Posed> here = pose(m, settings);
  if (!here) return false;
  const double step = options_.roll.step > 0
                          ? options_.roll.step
                          : stable_step(here->robot.scene.robot, here->robot.path, *trials_[m].commands, here->start);
  return differentiate_by_differences(
      settings, options_.difference, options_.threads,
      [&](const Settings& beside, const DropTerm&, double) { return roll(m, beside, times, step); }, followed);
}

double RobotTrials::peak(std::size_t, const Settings&, double, const SimulateOptions&) const {
  return std::numeric_limits<double>::quiet_NaN();
}

namespace {

/// The robot with the constants that a fit found.
DrivenRobot robot_of(DrivenRobot robot, const identify::Terms<DropTerm>& terms, const FloorFit& fit) {
  for (const identify::Estimate& e : fit.parameters)
    if (e.free) set_in(robot, terms[e.name], e.value);
  return robot;
}

}  // namespace

RobotFit fit_robot(const DrivenRobot& robot, const std::vector<RobotTrial>& trials, const RobotFitOptions& options) {
  RobotFit out{fit_floor(RobotTrials(robot, trials, options), options), robot};
  out.robot = robot_of(robot, options.terms, out);
  return out;
}

RobotFit predict_robot(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                       const RobotFitOptions& options) {
  return {validate_floor(RobotTrials(robot, trials, options), options), robot};
}

}  // namespace ukemi::tools
