#include "tools/study/robot_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/eigen.hpp"
#include "common/error.hpp"
#include "identify/estimate/covariance.hpp"
#include "tools/study/drop_residuals.hpp"

namespace ukemi::tools {

using namespace landing;
using Eigen::MatrixXd;

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeastNoise = 1e-3;  ///< of the logs' own noise: a residual without any still has a weight

/// The first value that was measured.
double first_of(const std::vector<double>& x) {
  const auto at = std::find_if(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  return at == x.end() ? kUnknown : *at;
}

/// The part of a channel's name before its joint: "phi" of "phi_hip".
std::string kind_of(const DropChannel& c) { return c.name.substr(0, c.name.find('_')); }

/// Of each channel that is logged next: what was given, else what the trials in hand leave.
std::vector<double> noise_to_come(const std::vector<DropChannel>& channels, const std::vector<double>& in_hand,
                                  const std::map<std::string, double>& given) {
  std::vector<double> out = in_hand;
  std::vector<std::string> known;
  for (std::size_t o = 0; o < channels.size(); ++o) {
    known.push_back(channels[o].name);
    if (const auto kind = given.find(kind_of(channels[o])); kind != given.end()) out[o] = kind->second;
    if (const auto own = given.find(channels[o].name); own != given.end()) out[o] = own->second;
  }
  for (const auto& [name, std] : given) {
    const auto meant = [&, &n = name](auto& c) { return c.name == n || kind_of(c) == n; };
    if (std::none_of(channels.begin(), channels.end(), meant)) throw InputError("--noise: " + one_of(name, known));
    if (!(std > 0 && std::isfinite(std))) throw InputError(fmt::format("--noise: {}: above 0 is needed", name));
  }
  if (std::none_of(out.begin(), out.end(), [](double x) { return std::isfinite(x); }))
    throw InputError(
        "--noise is needed: no trial in hand, and no [identified] of the robot's file, says what is measured, and how "
        "exactly");
  return out;
}

/// What errors are told in parts of.
double part_of(const DropTerm& t, double value) {
  return t.judged_size > 0 ? t.judged_size : value != 0 ? std::abs(value) : t.size;
}

/// What is known with the faint prior.
struct Known {
  explicit Known(const MatrixXd& information)
      : with_prior(information + kFaint * MatrixXd::Identity(information.rows(), information.cols())) {}
  double size(identify::Criterion criterion) const { return size_of(criterion, with_prior); }
  Eigen::VectorXd half_widths() const {
    Eigen::VectorXd out = identify::half_widths(with_prior, 0);
    for (double& x : out)
      if (x > kOpen) x = std::numeric_limits<double>::infinity();
    return out;
  }

 private:
  static constexpr double kFaint = 1e-4, kOpen = 30;  // a prior of 100 parts; from 30 on it is the prior that speaks
  MatrixXd with_prior;
};

/// Trials in hand: what the robot leaves of each channel, how each tells of the constants, and what speaks against it.
struct InHand {
  std::vector<double> noise;
  std::vector<MatrixXd> tell;
  std::vector<std::string> doubts;
};
InHand follow(const DrivenRobot& robot, const std::vector<RobotTrial>& trials, const RobotFitOptions& options) {
  InHand out{.noise = std::vector<double>(sensed_channels(robot.scene.robot).size(), kUnknown)};
  const RobotTrials simulator(robot, trials, options);
  const FloorFit followed = validate_floor(simulator, options);
  for (const DropResult& d : followed.drops)
    if (!d.simulated) throw InputError({d.file}, "it cannot be followed with this robot: fit it first");
  for (std::size_t o = 0; o < out.noise.size(); ++o)
    out.noise[o] = std::max(followed.rms[o], kLeastNoise * followed.noise[o]);
  out.tell = informations(simulator, options, out.noise, followed.nuisance);
  out.doubts = followed.warnings;
  return out;
}

/// What the robot's file says that it was fitted with; nothing where it says nothing.
InHand identified(const DrivenRobot& robot, const RobotFitOptions& options) {
  const std::vector<DropChannel> channels = sensed_channels(robot.scene.robot);
  InHand out{.noise = std::vector<double>(channels.size(), kUnknown)};
  if (!robot.known) return out;
  for (std::size_t o = 0; o < channels.size(); ++o)
    if (const auto left = robot.known->rms.find(channels[o].name); left != robot.known->rms.end())
      out.noise[o] = left->second;
  const std::vector<std::string>&free = options.terms.free, &order = robot.known->constants.order;
  std::vector<long> from, to;
  for (std::size_t i = 0; i < free.size(); ++i)
    if (const auto at = std::find(order.begin(), order.end(), options.terms[free[i]].name); at != order.end())
      from.push_back(at - order.begin()), to.push_back(long(i));
  if (from.empty()) return out;
  const MatrixXd covariance = eigen(robot.known->constants.covariance)(from, from);
  out.tell.push_back(MatrixXd::Zero(long(free.size()), long(free.size())));
  out.tell.back()(to, to) = identify::ScaledSolver(covariance)(MatrixXd::Identity(long(to.size()), long(to.size())));
  return out;
}

/// Ranks candidates that can be followed.
void choose(const std::vector<MatrixXd>& of, const RobotDesignOptions& o, MatrixXd& known, RobotDesign& out) {
  for (int rank = 1; rank <= o.trials; ++rank) {
    std::size_t best = of.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < of.size(); ++c) {
      if (out.candidates[c].rank > 0 || !out.candidates[c].followed) continue;
      if (const double size = Known(known + of[c]).size(o.criterion); size < least) least = size, best = c;
    }
    if (best == of.size()) return;
    known += of[best];
    out.candidates[best].rank = rank, out.candidates[best].together = Known(known).size(o.criterion);
  }
}

}  // namespace

identify::Terms<DropTerm> design_terms(const DrivenRobot& robot, std::vector<RobotTrial> in_hand,
                                       const std::vector<RobotTrial>& candidates,
                                       const std::map<std::string, double>& noise) {
  const std::vector<DropChannel> channels = sensed_channels(robot.scene.robot);
  const bool as_fitted = in_hand.empty() && robot.known;
  in_hand.insert(in_hand.end(), candidates.begin(), candidates.end());
  for (std::size_t o = 0; o < channels.size() && !candidates.empty(); ++o)
    if (noise.contains(channels[o].name) || noise.contains(kind_of(channels[o])) ||
        (as_fitted && robot.known->rms.contains(channels[o].name)))
      in_hand.back().log.output[o] = {0};
  return robot_terms(robot, in_hand);
}

std::vector<RobotTrial> from_heights(const DrivenRobot& robot, const std::vector<RobotTrial>& candidates,
                                     const std::vector<double>& heights) {
  if (heights.empty()) return candidates;
  if (robot.scene.robot.base == Base::kPinned)
    throw InputError("--heights: the base is pinned: one that is free or on a rail is needed");
  std::vector<RobotTrial> out;
  for (const RobotTrial& c : candidates)
    for (const double height : heights) {
      if (!(height >= 0) || std::isinf(height))
        throw InputError(fmt::format("--heights: {:g} m: at least 0 is needed", height));
      out.push_back(c);
      out.back().height = height;
      out.back().log.file += fmt::format(" from {:g} m", height);
    }
  return out;
}

RobotTrial planned_trial(const DrivenRobot& robot, const RobotTrial& commands, const std::vector<double>& noise) {
  RobotTrial out = commands;
  const Robot& r = robot.scene.robot;
  const std::vector<DropChannel> channels = sensed_channels(r);
  std::vector<double> start(channels.size());
  for (std::size_t o = 0; o < channels.size(); ++o) {
    const double measured = first_of(commands.log.output[o]);
    start[o] = std::isfinite(measured) ? measured : 0;
  }
  for (std::size_t i = 0; i < r.joints.size(); ++i) {
    const std::size_t o = joint_channel(i) + kAngle;
    if (std::isfinite(first_of(commands.log.output[o])) || r.joints[i].kind == DriveKind::kLocked) continue;
    const std::vector<double>& told = commands.commands->joint[i][kPhiRef];
    if (r.joints[i].driven() && told.empty())
      throw InputError({commands.log.file}, fmt::format("no column '{0}', and no 'phi_ref_{1}': one is needed, where "
                                                        "the joint starts",
                                                        channels[o].name, r.joints[i].name));
    start[o] = r.joints[i].driven() ? told.front() : r.joints[i].phi;
  }
  for (std::size_t o = 0; o < channels.size(); ++o) {
    const bool needed = std::isfinite(noise[o]) || (o < base_channel(r) && o % kSensed == kAngle);
    out.log.output[o].assign(needed ? out.log.t.size() : 0, start[o]);
  }
  if (r.base == Base::kFree && !out.log.output[base_channel(r) + kOriginY].empty() &&
      !std::isfinite(first_of(commands.log.output[base_channel(r) + kOriginY])))
    throw InputError({commands.log.file}, fmt::format("no column '{}': where the free base starts is needed",
                                                      channels[base_channel(r) + kOriginY].name));
  return out;
}

RobotDesign design_trials(const DrivenRobot& robot, const std::vector<RobotTrial>& in_hand,
                          const std::vector<RobotTrial>& candidates, const RobotDesignOptions& options) {
  if (options.trials < 1) throw InputError(fmt::format("--hits: {}: at least 1 is needed", options.trials));
  if (candidates.empty()) throw InputError("--next: at least one log of commands is needed");
  RobotDesign out{.criterion = options.criterion, .in_hand = int(in_hand.size())};
  out.channels = sensed_channels(robot.scene.robot);
  InHand present = in_hand.empty() ? identified(robot, options.fit) : follow(robot, in_hand, options.fit);
  out.doubts = std::move(present.doubts);
  out.noise = noise_to_come(out.channels, present.noise, options.noise);
  std::vector<RobotTrial> next;
  for (const RobotTrial& c : candidates) next.push_back(planned_trial(robot, c, out.noise));
  const RobotTrials planned(robot, next, options.fit);
  std::vector<double> sigma = out.noise;  // an angle that is only a start counts for nothing
  for (double& s : sigma)
    if (!std::isfinite(s)) s = std::numeric_limits<double>::infinity();
  const std::vector<MatrixXd> of = informations(planned, options.fit, sigma, {});

  const long n = long(options.fit.terms.free.size());
  out.value.resize(n), out.part_of.resize(n);
  for (long i = 0; i < n; ++i) {
    const DropTerm& t = options.fit.terms[options.fit.terms.free[std::size_t(i)]];
    out.constants.push_back(t.name), out.units.push_back(t.unit);
    out.value[i] = planned.value(t), out.part_of[i] = part_of(t, out.value[i]);
  }
  const auto in_parts = [&](const MatrixXd& x) {
    return MatrixXd(out.part_of.asDiagonal() * x.topLeftCorner(n, n) * out.part_of.asDiagonal());
  };
  MatrixXd known = MatrixXd::Zero(n, n);
  for (const MatrixXd& x : present.tell)
    if (x.size() > 0) known += in_parts(x);
  out.before = Known(known).half_widths(), out.size_before = Known(known).size(options.criterion);
  std::vector<MatrixXd> told;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    NextTrial trial{.file = candidates[c].log.file, .followed = of[c].size() > 0};
    told.push_back(trial.followed ? in_parts(of[c]) : MatrixXd());
    if (trial.followed) {
      const Known with(known + told.back());
      trial.alone = with.size(options.criterion), trial.half_width = with.half_widths();
    }
    out.candidates.push_back(std::move(trial));
  }
  choose(told, options, known, out);
  out.after = Known(known).half_widths(), out.size_after = Known(known).size(options.criterion);
  return out;
}

}  // namespace ukemi::tools
