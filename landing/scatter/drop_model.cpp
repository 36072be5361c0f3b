#include "landing/scatter/drop_model.hpp"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/decompositions.hpp"
#include "common/error.hpp"
#include "common/random.hpp"
#include "landing/scatter/sobol.hpp"

namespace ukemi::landing {

double cut_normal(double u) {
  constexpr double kCut = 3;
  static const double tail = 0.5 * std::erfc(kCut / std::numbers::sqrt2);
  return std::numbers::sqrt2 * boost::math::erf_inv(2 * (tail + u * (1 - 2 * tail)) - 1);
}

namespace {

/// R with R R^T = C.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& c) {
  constexpr double kRounding = 1e-9;
  // Constants differ by powers of ten: what counts as negative is asked of the correlations.
  const Eigen::VectorXd std = c.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd inverse = std.unaryExpr([](double x) { return x > 0 ? 1 / x : 0; });
  const SymmetricEigen eigen = symmetric_eigen(inverse.asDiagonal() * c * inverse.asDiagonal());
  if (!c.allFinite() || (c.diagonal().array() < 0).any() || eigen.values.minCoeff() < -kRounding)
    throw InputError("covariance: its smallest eigenvalue is " + shortest(eigen.values.minCoeff()) +
                     " where its variances are 1: a positive semidefinite matrix is needed");
  return std.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

/// The reference stands at the joint's angle at release until the landing motion starts from there.
Reposition standing_until_touchdown(double phi, double rate) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  return {phi, rate, kNever, kNever};
}

Play with(const ScatteredDrop& d, Play p) {
  std::array<double, kConstants> u = ukemi::constants(p.sea);
  constexpr double kLeast = 1e-12;  // an inertia of 0 is none
  for (std::size_t k = 0; k < u.size(); ++k)
    if (d.constants[k] != 0) u[k] = std::max(kLeast, u[k] + d.constants[k]);
  set_constants(p.sea, u);
  if (p.motion.reposition)
    p.motion.reposition->phi += d.phi, p.motion.reposition->rate += d.rate;
  else if (d.rate != 0)
    p.motion.reposition = standing_until_touchdown(p.motion.phi_i + d.phi, d.rate);
  else
    p.motion.phi_i += d.phi;
  return p;
}
constexpr long kMostDrops = 1'000'000'000;
bool exact(const Deviation& d) { return d.phi_i == 0 && d.phi_f == 0 && d.duration == 0; }

}  // namespace

Play ScatteredDrop::played(const MotionSpace& space, const Play& planned) const {
  return with(*this, exact(deviation) ? planned : space.inexact(planned, scene.execution, deviation));
}
Play ScatteredDrop::played(const Play& planned) const {
  return with(*this, {deviated(planned.motion, scene.execution, deviation), planned.sea});
}

DropModel::DropModel(const Scene& scene, const Scatter& scatter, const Actuator& actuator, const Options& options)
    : scene_(scene), scatter_(scatter), inexact_(options.inexact) {
  scene.validate(), scatter.validate(), check_not_negative("inflate", options.inflate);
  if (!actuator.uncertain.empty() || actuator.covariance.size() > 0) validate(actuator);
  for (std::size_t k = 0; k < kScatterTerms.size(); ++k) {
    if (!(scatter.*kScatterTerms[k].deviation > 0)) continue;
    terms_.push_back(int(k));
    add(kScatterTerms[k].name, 1);
  }
  if (options.floor && scene.uncertainty) scatter_floor(*scene.uncertainty);
  scene_.uncertainty.reset(), scene_.verdicts.clear();  // of the planned floor
  if (options.actuator && options.inflate > 0 && actuator.covariance.size() > 0) {
    std::vector<int> known;
    for (std::size_t i = 0; i < actuator.uncertain.size(); ++i)
      for (int k = 0; k < kConstants; ++k)
        if (actuator.uncertain[i] == kConstantNames[std::size_t(k)]) known.push_back(int(i)), constants_.push_back(k);
    if (!known.empty()) {
      root_ = options.inflate * root_of(actuator.covariance(known, known));
      add("actuator", int(known.size()));
    }
  }
  if (inexact_) add("execution", 3);
}

/// Constants of the floor are log-normal: their covariance counts relative to what they are.
void DropModel::scatter_floor(const Uncertainty& known) {
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(long(known.order.size()));
  for (std::size_t i = 0; i < known.order.size(); ++i) {
    const auto term = std::find_if(kScatterTerms.begin(), kScatterTerms.end(),
                                   [&](const ScatterTerm& t) { return known.order[i] == t.name; });
    of_floor_.push_back(term->deviation);
    if (term->kind != ScatterTerm::Kind::kRelative) continue;
    const Floor<double> floor = scene_.floor.value_or(Floor<double>{});
    const double value = term->deviation == &Scatter::stiffness        ? floor.stiffness
                         : term->deviation == &Scatter::damping_normal ? floor.damping_normal
                                                                       : floor.damping_tangential;
    unit[long(i)] = value > 0 ? 1 / value : 0;
  }
  floor_root_ = root_of(unit.asDiagonal() * known.covariance * unit.asDiagonal());
  add("floor", int(of_floor_.size()));
}

void DropModel::add(const std::string& name, int count) {
  groups_.push_back({name, dimension_, count});
  dimension_ += count;
}

ScatteredDrop DropModel::drop(std::span<const double> u) const {
  if (u.size() != std::size_t(dimension_))
    throw InputError("drop: " + std::to_string(u.size()) + " coordinates: " + std::to_string(dimension_) +
                     " are needed");
  for (const double x : u)
    if (!(x >= 0 && x <= 1)) throw InputError("drop: coordinate " + shortest(x) + ": 0 to 1 is needed");
  ScatteredDrop d{.scene = scene_};
  std::size_t next = 0;
  Scatter z;
  for (const int t : terms_) {
    double Scatter::*const deviation = kScatterTerms[std::size_t(t)].deviation;
    z.*deviation = scatter_.*deviation * cut_normal(u[next++]);
  }
  if (!of_floor_.empty()) {
    Eigen::VectorXd normal(floor_root_.cols());
    for (double& x : normal) x = cut_normal(u[next++]);
    const Eigen::VectorXd by = floor_root_ * normal;
    for (std::size_t i = 0; i < of_floor_.size(); ++i) z.*of_floor_[i] += by[long(i)];
  }
  Drop& drop = d.scene.drop;
  drop.pitch += z.pitch, drop.forward_speed += z.forward_speed, drop.pitch_rate += z.pitch_rate;
  drop.height += z.height;
  if (drop.height < 0) drop.height = 0, d.from_floor = true;
  d.phi = z.phi, d.rate = z.rate;
  if (auto& floor = d.scene.floor) {
    floor->stiffness *= std::exp(z.stiffness);
    floor->damping_normal *= std::exp(z.damping_normal), floor->damping_tangential *= std::exp(z.damping_tangential);
  }
  d.scene.detection_delay = std::max(0.0, d.scene.detection_delay + z.delay);
  if (!constants_.empty()) {
    Eigen::VectorXd normal(root_.cols());
    for (double& x : normal) x = cut_normal(u[next++]);
    const Eigen::VectorXd by = root_ * normal;
    for (std::size_t i = 0; i < constants_.size(); ++i) d.constants[std::size_t(constants_[i])] = by[long(i)];
  }
  if (inexact_)
    for (double* x : {&d.deviation.phi_i, &d.deviation.phi_f, &d.deviation.duration}) *x = 2 * u[next++] - 1;
  return d;
}

std::vector<ScatteredDrop> DropModel::even(long count, std::uint64_t seed, long first) const {
  check_count("drops", count, 0, kMostDrops), check_count("first", first, 0, kMostDrops);
  if (!measured_.empty()) {
    const std::size_t n = std::min(measured_.size(), std::size_t(count));
    std::vector<ScatteredDrop> out;
    for (std::size_t i = 0; i < n; ++i) out.push_back(measured_[i * measured_.size() / n]);
    return out;
  }
  const auto d = std::size_t(dimension_);
  const std::vector<double> points =
      d > 0 ? ScrambledSobol(dimension_, seed).points(count, first) : std::vector<double>();
  std::vector<ScatteredDrop> out;
  out.reserve(std::size_t(count));
  for (std::size_t n = 0; n < std::size_t(count); ++n) out.push_back(drop(std::span(points).subspan(n * d, d)));
  return out;
}

std::vector<ScatteredDrop> DropModel::independent(long count, std::uint64_t seed) const {
  check_count("drops", count, 0, kMostDrops);
  if (!measured_.empty()) return measured_;
  std::vector<double> u(static_cast<std::size_t>(dimension_));
  std::vector<ScatteredDrop> out;
  out.reserve(std::size_t(count));
  for (long n = 0; n < count; ++n) {
    Random random(seed, std::uint64_t(n));
    for (double& x : u) x = random.uniform();
    out.push_back(drop(u));
  }
  return out;
}

}  // namespace ukemi::landing
