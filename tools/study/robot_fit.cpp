// Fits of driven robots, and predictions with what they found.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/eigen.hpp"
#include "identify/estimate/estimates.hpp"
#include "tools/study/robot_trials.hpp"

namespace ukemi::tools {

namespace {

/// A constant of the robot, and its fitted values: one, or one of each run.
struct FoundNumber {
  std::string name;
  std::vector<const identify::Estimate*> of_run;
  double mean() const {
    double sum = 0;
    for (const auto* e : of_run) sum += e->value;
    return sum / double(of_run.size());
  }
  /// Of the runs' values.
  double variance() const {
    double sum = 0;
    for (const double middle = mean(); const auto* e : of_run) sum += std::pow(e->value - middle, 2);
    return of_run.size() > 1 ? sum / double(of_run.size() - 1) : 0;
  }
};
std::vector<FoundNumber> found_numbers(const identify::Terms<DropTerm>& terms, const FloorFit& fit) {
  std::vector<FoundNumber> out;
  for (const identify::Estimate& e : fit.parameters) {
    if (!e.free) continue;
    const std::string& name = terms[e.name].moves.front();
    auto found = std::find_if(out.begin(), out.end(), [&](const FoundNumber& n) { return n.name == name; });
    if (found == out.end()) found = out.insert(out.end(), {name, {}});
    found->of_run.push_back(&e);
  }
  return out;
}

/// How well these are known, of a run to come too; none of those without an error.
std::optional<Identified> known_of(const std::vector<FoundNumber>& numbers, const FloorFit& fit) {
  std::vector<std::string> names;
  for (const FoundNumber& n : numbers)
    for (const auto* e : n.of_run) names.push_back(e->name);
  const std::optional<Uncertainty> well = fit.uncertainty(&names);
  if (!well) return std::nullopt;
  Identified out;
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(long(numbers.size()), long(well->order.size()));
  Eigen::VectorXd between = Eigen::VectorXd::Zero(mean.rows());
  long row = 0;
  for (const FoundNumber& n : numbers) {
    std::vector<long> columns;
    for (const auto* e : n.of_run)
      if (const auto at = std::find(well->order.begin(), well->order.end(), e->name); at != well->order.end())
        columns.push_back(at - well->order.begin());
    if (columns.size() < n.of_run.size()) continue;
    for (const long column : columns) mean(row, column) = 1 / double(columns.size());
    out.constants.order.push_back(n.name), between[row++] = n.variance();
  }
  const Eigen::MatrixXd all = mean * eigen(well->covariance) * mean.transpose();
  out.constants.covariance = all.topLeftCorner(row, row) + Eigen::MatrixXd(between.head(row).asDiagonal());
  for (std::size_t o = 0; o < fit.channels.size(); ++o)
    if (std::isfinite(fit.noise[o])) out.rms[fit.channels[o].name] = std::fmax(fit.rms[o], fit.noise[o]);
  return out;
}

/// The robot with the constants that a fit found.
DrivenRobot robot_of(DrivenRobot robot, const identify::Terms<DropTerm>& terms, const FloorFit& fit) {
  const std::vector<FoundNumber> numbers = found_numbers(terms, fit);
  for (const FoundNumber& n : numbers) set_in(robot, terms[n.of_run.front()->name], n.mean());
  robot.known = known_of(numbers, fit);
  robot.scene.robot_verdicts.clear();
  for (const identify::Estimate& e : fit.parameters)
    if (e.free) robot.scene.robot_verdicts.emplace_back(e.name, identify::name(e.verdict));
  return robot;
}

/// An elastic drive acts as late as a rig's may, unless the file or the user says how late.
void add_unstated(const DrivenRobot& robot, RobotFitOptions& options) {
  constexpr identify::RigErrors kUnstated;
  const identify::Terms<DropTerm>& terms = options.terms;
  for (const landing::Joint& j : robot.scene.robot.joints) {
    const auto add = [&](const std::string& key, double given, double std) {
      const std::string name = "drive." + j.name + "." + key;
      const auto is_it = [&](const auto& named) { return named == name; };
      if (given > 0 || terms.fits(name) || std::ranges::none_of(*terms.table, is_it, &DropTerm::name) ||
          std::ranges::any_of(options.errors, is_it, &std::pair<std::string, double>::first))
        return;
      options.errors.emplace_back(name, std);
    };
    add("control_delay", j.sea.control_delay, kUnstated.delay);
    add("velocity_filter", j.sea.velocity_filter, kUnstated.filter);
  }
}

}  // namespace

RobotFit fit_robot(const DrivenRobot& robot, const std::vector<RobotTrial>& trials, const RobotFitOptions& options) {
  RobotFitOptions all = options;
  add_unstated(robot, all);
  RobotFit out{fit_floor(RobotTrials(robot, trials, all), all), robot};
  out.robot = robot_of(robot, options.terms, out);
  return out;
}

RobotFit predict_robot(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                       const RobotFitOptions& options) {
  const RobotTrials simulator(robot, trials, options);
  RobotFit out{validate_floor(simulator, options), robot};
  if (robot.known) out.promises = promises(simulator, options, out, *robot.known);
  return out;
}

}  // namespace ukemi::tools
