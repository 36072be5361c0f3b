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
constexpr double kMinNoise = 1e-3;  ///< relative to the logs' noise: bounds the weight of a residual near 0

/// The first finite value; NaN: none.
double first_of(const std::vector<double>& x) {
  const auto at = std::find_if(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  return at == x.end() ? kUnknown : *at;
}

/// The part of a channel's name before its joint: "phi" of "phi_hip".
std::string kind_of(const DropChannel& c) { return c.name.substr(0, c.name.find('_')); }

/// Noise of the next logs by channel: as given, else as of the trials in hand.
std::vector<double> next_noise(const std::vector<DropChannel>& channels, const std::vector<double>& in_hand,
                               const std::map<std::string, double>& given) {
  std::vector<double> out = in_hand;
  std::vector<std::string> known;
  for (std::size_t o = 0; o < channels.size(); ++o) {
    known.push_back(channels[o].name);
    if (const auto kind = given.find(kind_of(channels[o])); kind != given.end()) out[o] = kind->second;
    if (const auto own = given.find(channels[o].name); own != given.end()) out[o] = own->second;
  }
  for (const auto& [name, std] : given) {
    const auto matches = [&, &n = name](auto& c) { return c.name == n || kind_of(c) == n; };
    if (std::none_of(channels.begin(), channels.end(), matches)) throw InputError("--noise: " + one_of(name, known));
    if (!(std > 0 && std::isfinite(std))) throw InputError(fmt::format("--noise: {}: above 0 is needed", name));
  }
  if (std::none_of(out.begin(), out.end(), [](double x) { return std::isfinite(x); }))
    throw InputError(
        "--noise is needed: no trial in hand, and no [identified] of the robot's file, says what is measured, and how "
        "exactly");
  return out;
}

/// Scale of a constant's errors, see RobotDesign::scale.
double scale_of(const DropTerm& t, double value) {
  return t.judged_size > 0 ? t.judged_size : value != 0 ? std::abs(value) : t.size;
}

/// Fisher information with the weak prior.
struct Regularised {
  explicit Regularised(const MatrixXd& information)
      : with_prior(information + kWeakPrior * MatrixXd::Identity(information.rows(), information.cols())) {}
  double size(identify::Criterion criterion) const { return criterion_value(criterion, with_prior); }
  Eigen::VectorXd half_widths() const {
    Eigen::VectorXd out = identify::half_widths(with_prior, 0);
    for (double& x : out)
      if (x > kUndetermined) x = std::numeric_limits<double>::infinity();
    return out;
  }

 private:
  static constexpr double kWeakPrior = 1e-4, kUndetermined = 30;  // standard deviation 100; larger half-widths are its
  MatrixXd with_prior;
};

/// Trials in hand: residual noise of each channel, information of each trial on the constants, doubts about the fit.
struct InHand {
  std::vector<double> noise;
  std::vector<MatrixXd> information;
  std::vector<std::string> doubts;
};
InHand follow(const DrivenRobot& robot, const std::vector<RobotTrial>& trials, const RobotFitOptions& options) {
  InHand out{.noise = std::vector<double>(sensed_channels(robot.scene.robot).size(), kUnknown)};
  const RobotTrials simulator(robot, trials, options);
  const FloorFit followed = validate_floor(simulator, options);
  for (const DropResult& d : followed.drops)
    if (!d.simulated) throw InputError({d.file}, "it cannot be followed with this robot: fit it first");
  for (std::size_t o = 0; o < out.noise.size(); ++o)
    out.noise[o] = std::max(followed.rms[o], kMinNoise * followed.noise[o]);
  out.information = drop_information(simulator, options, out.noise, followed.nuisance);
  out.doubts = followed.warnings;
  return out;
}

/// Noise and information from the uncertainty in the robot's file; empty where it has none.
InHand uncertainty_of(const DrivenRobot& robot, const RobotFitOptions& options) {
  const std::vector<DropChannel> channels = sensed_channels(robot.scene.robot);
  InHand out{.noise = std::vector<double>(channels.size(), kUnknown)};
  if (!robot.known) return out;
  for (std::size_t o = 0; o < channels.size(); ++o)
    if (const auto rms = robot.known->rms.find(channels[o].name); rms != robot.known->rms.end())
      out.noise[o] = rms->second;
  const std::vector<std::string>&free = options.terms.free, &order = robot.known->constants.order;
  std::vector<long> from, to;
  for (std::size_t i = 0; i < free.size(); ++i)
    if (const auto at = std::find(order.begin(), order.end(), options.terms[free[i]].name); at != order.end())
      from.push_back(at - order.begin()), to.push_back(long(i));
  if (from.empty()) return out;
  const MatrixXd covariance = eigen(robot.known->constants.covariance)(from, from);
  out.information.push_back(MatrixXd::Zero(long(free.size()), long(free.size())));
  out.information.back()(to, to) =
      identify::ScaledSolver(covariance)(MatrixXd::Identity(long(to.size()), long(to.size())));
  return out;
}

/// Ranks the candidates greedily and adds the information of those chosen to `total`.
void choose(const std::vector<MatrixXd>& of, const RobotDesignOptions& o, MatrixXd& total, RobotDesign& out) {
  for (int rank = 1; rank <= o.trials; ++rank) {
    std::size_t best = of.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < of.size(); ++c) {
      if (out.candidates[c].rank > 0 || !out.candidates[c].followed) continue;
      if (const double size = Regularised(total + of[c]).size(o.criterion); size < least) least = size, best = c;
    }
    if (best == of.size()) return;
    total += of[best];
    out.candidates[best].rank = rank, out.candidates[best].together = Regularised(total).size(o.criterion);
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
    const std::vector<double>& command = commands.commands->joint[i][kPhiRef];
    if (r.joints[i].driven() && command.empty())
      throw InputError({commands.log.file},
                       fmt::format("no column '{0}', and no 'phi_ref_{1}': one is needed, where the joint starts",
                                   channels[o].name, r.joints[i].name));
    start[o] = r.joints[i].driven() ? command.front() : r.joints[i].phi;
  }
  for (std::size_t o = 0; o < channels.size(); ++o) {
    const bool needed = std::isfinite(noise[o]) || (o < base_channel(r) && o % kJointSignals == kAngle);
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
  InHand present = in_hand.empty() ? uncertainty_of(robot, options.fit) : follow(robot, in_hand, options.fit);
  out.doubts = std::move(present.doubts);
  out.noise = next_noise(out.channels, present.noise, options.noise);
  std::vector<RobotTrial> next;
  for (const RobotTrial& c : candidates) next.push_back(planned_trial(robot, c, out.noise));
  const RobotTrials planned(robot, next, options.fit);
  std::vector<double> sigma = out.noise;  // a channel without noise is not logged: it has no weight
  for (double& s : sigma)
    if (!std::isfinite(s)) s = std::numeric_limits<double>::infinity();
  const std::vector<MatrixXd> raw = drop_information(planned, options.fit, sigma, {});

  const long n = long(options.fit.terms.free.size());
  out.value.resize(n), out.scale.resize(n);
  for (long i = 0; i < n; ++i) {
    const DropTerm& t = options.fit.terms[options.fit.terms.free[std::size_t(i)]];
    out.constants.push_back(t.name), out.units.push_back(t.unit);
    out.value[i] = planned.value(t), out.scale[i] = scale_of(t, out.value[i]);
  }
  const auto scaled = [&](const MatrixXd& x) {
    return MatrixXd(out.scale.asDiagonal() * x.topLeftCorner(n, n) * out.scale.asDiagonal());
  };
  MatrixXd total = MatrixXd::Zero(n, n);
  for (const MatrixXd& x : present.information)
    if (x.size() > 0) total += scaled(x);
  out.before = Regularised(total).half_widths(), out.size_before = Regularised(total).size(options.criterion);
  std::vector<MatrixXd> information;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    CandidateTrial trial{.file = candidates[c].log.file, .followed = raw[c].size() > 0};
    information.push_back(trial.followed ? scaled(raw[c]) : MatrixXd());
    if (trial.followed) {
      const Regularised with(total + information.back());
      trial.alone = with.size(options.criterion), trial.half_width = with.half_widths();
    }
    out.candidates.push_back(std::move(trial));
  }
  choose(information, options, total, out);
  out.after = Regularised(total).half_widths(), out.size_after = Regularised(total).size(options.criterion);
  return out;
}

}  // namespace ukemi::tools
