#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/decompositions.hpp"
#include "common/random.hpp"
#include "identify/design/design.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

SeaParameters<double> scaled(const Knowledge& k, const VectorXd& relative) {
  constexpr double kMinFactor = 1e-6;  // of a constant: keeps it above 0
  SeaParameters<double> sea = k.sea;
  auto u = ukemi::constants(sea);
  for (std::size_t i = 0; i < k.constants.size(); ++i)
    u[std::size_t(k.constants[i])] *= std::max(1 + relative[long(i)], kMinFactor);
  set_constants(sea, u);
  return sea;
}

}  // namespace

const char* name(HitSafety::Outcome outcome) {
  constexpr const char* kNames[] = {"safe", "beyond the largest angle", "the link escapes"};
  return kNames[int(outcome)];
}

void HitLog::validate() const {
  check_positive("rate", rate), check_positive("duration", duration);
  check_not_negative("start", start), check_not_negative("noise", noise);
  constexpr double kMaxSamples = 1e6;
  if (!(rate * duration <= kMaxSamples))
    throw InputError(fmt::format("rate: {}: at most a million samples a log", shortest(rate)));
}

Trial blank_log(const Hit& hit, const HitLog& log) {
  log.validate();
  check_finite("peak", hit.peak), check_positive("width", hit.width);
  Trial trial;
  const int last = int(std::lround(log.duration * log.rate));
  for (int i = 0; i <= last; ++i) {
    const double t = i / log.rate, s = (t - log.start) / hit.width;
    trial.t.push_back(t);
    trial.force.push_back(s > 0 && s < 1 ? hit.peak * std::sin(std::numbers::pi * s) : 0);
  }
  trial.phi.assign(trial.t.size(), 0);
  if (log.outputs == HitLog::Outputs::kLinkAndMotor) trial.phi_motor = trial.phi;
  return trial;
}

namespace {

/// A finer and longer log than the real one: the hit itself, not its samples, moves the link.
HitLog fine_log(const HitLog& log, const Hit& hit) {
  constexpr double kSamplesInPulse = 40, kLongEnough = 1;
  HitLog out = log;
  out.rate = std::max(log.rate, kSamplesInPulse / hit.width);
  out.duration = std::max(log.duration, log.start + hit.width + kLongEnough);
  return out;
}

/// The spring's largest torque in a rollout sampled at `rate` [Hz], and how long it is at its limit.
void add_spring_torque(const std::vector<double>& phi, const std::vector<double>& phi_m,
                       const SeaParameters<double>& sea, double rate, HitSafety& out) {
  for (std::size_t i = 1; i + 1 < phi.size(); ++i) {
    const double d = phi_m[i] - phi[i], d_rate = (phi_m[i + 1] - phi[i + 1] - phi_m[i - 1] + phi[i - 1]) * 0.5 * rate;
    const double tau = std::abs((sea.k_sea + sea.k_sea_cubic * d * d) * d + sea.c_sea * d_rate);
    out.torque = std::max(out.torque, tau);
    if (tau >= sea.tau_max) out.limited += 1 / rate;
  }
}

/// The half axes of the 95 % confidence ellipsoid of the constants, a column each.
MatrixXd confidence_axes(const Knowledge& k) {
  constexpr double kChiSquare95[kConstants] = {3.841, 5.991, 7.815, 9.488, 11.070};
  const auto covariance = covariance_of(k.information);
  assert(covariance);
  const double radius = std::sqrt(kChiSquare95[covariance->rows() - 1]);
  const SymmetricEigen eigen = symmetric_eigen(*covariance);
  return radius * eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

/// The point of the ellipsoid where the largest angle grows fastest, C g / sqrt(g' C g), in units of the axes; none
/// where the gradient g is 0, or the rollout fails.
std::optional<VectorXd> steepest(const Rig& rig, const Knowledge& k, const PreparedTrial& hit, const MatrixXd& axes) {
  thread_local std::vector<ConstantJet> dphi, dphi_m;
  if (differentiate(rig, k.sea, k.constants, hit, dphi, dphi_m) != RolloutStatus::kDone) return std::nullopt;
  const ConstantJet& farthest =
      *std::max_element(dphi.begin(), dphi.end(),
                        [](const ConstantJet& a, const ConstantJet& b) { return std::abs(a.a) < std::abs(b.a); });
  const VectorXd g = axes.transpose() * farthest.v.head(axes.rows()) * (farthest.a < 0 ? -1 : 1);
  return g.norm() > 0 ? std::optional<VectorXd>(g.normalized()) : std::nullopt;
}

}  // namespace

HitSafety safety_of(const Rig& rig, const Knowledge& k, const Hit& hit, const DesignOptions& o) {
  rig.validate(), k.validate(), o.validate();
  check_finite("peak", hit.peak), check_positive("width", hit.width);
  const HitLog fine = fine_log(o.log, hit);
  const Trial trial = blank_log(hit, fine);
  const PreparedTrial prepared(trial);
  HitSafety out;
  thread_local std::vector<double> phi, phi_m;
  const auto is_safe = [&](const SeaParameters<double>& sea) {
    if (rollout(rig, sea, {}, prepared, {}, phi, phi_m) != RolloutStatus::kDone) {
      out.outcome = HitSafety::Outcome::kEscapes;
      return false;
    }
    for (const double a : phi) out.worst_angle = std::max(out.worst_angle, std::abs(a));
    if (out.worst_angle > o.budget.angle) out.outcome = HitSafety::Outcome::kTooFar;
    return out.safe();
  };
  const bool safe = is_safe(k.sea);
  out.angle = out.worst_angle;
  if (!safe) return out;
  add_spring_torque(phi, phi_m, k.sea, fine.rate, out);

  const MatrixXd axes = confidence_axes(k);
  const auto is_safe_at = [&](const VectorXd& point) { return is_safe(scaled(k, axes * point)); };
  if (const auto point = steepest(rig, k, prepared, axes); point && !is_safe_at(*point)) return out;
  const long n = axes.rows();
  for (long a = 0; a < n; ++a)
    for (const double sign : {1.0, -1.0})
      if (!is_safe(scaled(k, sign * axes.col(a)))) return out;
  for (int draw = 0; draw < o.draws; ++draw) {
    Random random(o.seed, std::uint64_t(draw));
    VectorXd z(n);
    for (double& x : z) x = random.normal();
    if (!is_safe_at(z.normalized())) return out;
  }
  return out;
}

}  // namespace ukemi::identify
