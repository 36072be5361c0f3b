// Fits of driven robots, and predictions with their uncertainty.
#include <algorithm>
#include <cmath>

#include "common/eigen.hpp"
#include "identify/estimate/estimates.hpp"
#include "tools/study/robot_trials.hpp"

namespace ukemi::tools {

namespace {

/// A constant of the robot, and its estimates: a single one, or one for each run.
struct FittedNumber {
  std::string name;
  std::vector<const identify::Estimate*> estimates;
  double mean() const {
    double sum = 0;
    for (const auto* e : estimates) sum += e->value;
    return sum / double(estimates.size());
  }
  /// Sample variance of the runs' values; 0 for a single one.
  double variance() const {
    double sum = 0;
    for (const double average = mean(); const auto* e : estimates) sum += std::pow(e->value - average, 2);
    return estimates.size() > 1 ? sum / double(estimates.size() - 1) : 0;
  }
};
std::vector<FittedNumber> fitted_numbers(const identify::Terms<DropTerm>& terms, const FloorFit& fit) {
  std::vector<FittedNumber> out;
  for (const identify::Estimate& e : fit.parameters) {
    if (!e.free) continue;
    const std::string& name = terms[e.name].moves.front();
    auto found = std::find_if(out.begin(), out.end(), [&](const FittedNumber& n) { return n.name == name; });
    if (found == out.end()) found = out.insert(out.end(), {name, {}});
    found->estimates.push_back(&e);
  }
  return out;
}

/// Uncertainty of the numbers in a further run: of their means, plus the variance between runs; those with an error.
std::optional<FitUncertainty> uncertainty_of(const std::vector<FittedNumber>& numbers, const FloorFit& fit) {
  std::vector<std::string> names;
  for (const FittedNumber& n : numbers)
    for (const auto* e : n.estimates) names.push_back(e->name);
  const std::optional<Uncertainty> fitted = fit.uncertainty(&names);
  if (!fitted) return std::nullopt;
  FitUncertainty out;
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(long(numbers.size()), long(fitted->order.size()));
  Eigen::VectorXd variance_between = Eigen::VectorXd::Zero(mean.rows());
  long row = 0;
  for (const FittedNumber& n : numbers) {
    std::vector<long> columns;
    for (const auto* e : n.estimates)
      if (const auto at = std::find(fitted->order.begin(), fitted->order.end(), e->name); at != fitted->order.end())
        columns.push_back(at - fitted->order.begin());
    if (columns.size() < n.estimates.size()) continue;
    for (const long column : columns) mean(row, column) = 1 / double(columns.size());
    out.constants.order.push_back(n.name), variance_between[row++] = n.variance();
  }
  const Eigen::MatrixXd all = mean * eigen(fitted->covariance) * mean.transpose();
  out.constants.covariance = all.topLeftCorner(row, row) + Eigen::MatrixXd(variance_between.head(row).asDiagonal());
  for (std::size_t o = 0; o < fit.channels.size(); ++o)
    if (std::isfinite(fit.noise[o])) out.rms[fit.channels[o].name] = std::fmax(fit.rms[o], fit.noise[o]);
  return out;
}

/// The robot with the fitted constants, their uncertainty and verdicts.
DrivenRobot robot_of(DrivenRobot robot, const identify::Terms<DropTerm>& terms, const FloorFit& fit) {
  const std::vector<FittedNumber> numbers = fitted_numbers(terms, fit);
  for (const FittedNumber& n : numbers) set_in(robot, terms[n.estimates.front()->name], n.mean());
  robot.known = uncertainty_of(numbers, fit);
  robot.scene.robot_verdicts.clear();
  for (const identify::Estimate& e : fit.parameters)
    if (e.free) robot.scene.robot_verdicts.emplace_back(e.name, identify::name(e.verdict));
  return robot;
}

/// Adds errors of the delays of elastic drives, as large as a rig's, unless the file or the options state the delays.
void add_delay_errors(const DrivenRobot& robot, RobotFitOptions& options) {
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
  add_delay_errors(robot, all);
  RobotFit out{fit_floor(RobotTrials(robot, trials, all), all), robot};
  out.robot = robot_of(robot, options.terms, out);
  return out;
}

RobotFit predict_robot(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                       const RobotFitOptions& options) {
  const RobotTrials simulator(robot, trials, options);
  RobotFit out{validate_floor(simulator, options), robot};
  if (robot.known) out.bands = predict_bands(simulator, options, out, *robot.known);
  return out;
}

}  // namespace ukemi::tools
