#include "landing/scatter/drop_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/actuator_constants.hpp"
#include "common/checks.hpp"
#include "common/eigen.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/scatter/moved.hpp"
#include "landing/scatter/sampler.hpp"

namespace ukemi::landing {

namespace {

/// The reference is the joint's angle at release until the landing motion starts from there.
Reposition held_until_touchdown(double phi, double rate) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  return {phi, rate, kNever, kNever};
}

DrivenMotion released(const ScatteredDrop& d, const DrivenMotion& p) {
  return {released_beside(p.motion, d.phi, d.rate), moved(p.sea, d.constants)};
}
bool exact(const Deviation& d) { return d.phi_i == 0 && d.phi_f == 0 && d.duration == 0; }

}  // namespace

SeaParameters<double> moved(SeaParameters<double> sea, std::span<const double> deviation) {
  const auto& all = actuator_constants();
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (deviation[k] == 0) continue;
    constexpr double kMinPositive = 1e-12;  // an inertia must be above 0
    const Range& range = all[k].range;
    double& x = sea.*all[k].at;
    x = std::clamp(x + deviation[k], range.low_open ? kMinPositive : range.low, range.high);
  }
  return sea;
}

bool move_drop(Drop& drop, const Scatter& deviation) {
  drop.pitch += deviation.pitch, drop.forward_speed += deviation.forward_speed, drop.pitch_rate += deviation.pitch_rate;
  drop.height += deviation.height;
  const bool below = drop.height < 0;
  if (below) drop.height = 0;
  return below;
}

Motion released_beside(Motion m, double phi, double rate) {
  if (m.reposition)
    m.reposition->phi += phi, m.reposition->rate += rate;
  else if (rate != 0)
    m.reposition = held_until_touchdown(m.phi_i + phi, rate);
  else
    m.phi_i += phi;
  return m;
}

DrivenMotion ScatteredDrop::played(const MotionSpace& space, const DrivenMotion& planned) const {
  return released(*this, exact(deviation) ? planned : space.inexact(planned, scene.execution, deviation));
}
DrivenMotion ScatteredDrop::played(const DrivenMotion& planned) const {
  return released(*this, {deviated(planned.motion, scene.execution, deviation), planned.sea});
}

DropModel DropModel::measured(const Scene& scene, std::vector<ScatteredDrop> drops) {
  DropModel out(scene, Scatter{}, Actuator{}, {.floor = false, .actuator = false});
  out.measured_ = std::move(drops);
  return out;
}

DropModel::DropModel(const Scene& scene, const Scatter& scatter, const Actuator& actuator, const Options& options)
    : scene_(scene), inexact_(options.inexact) {
  Sampler sampler;
  scene.validate(), scatter.validate(), check_not_negative("inflate", options.inflate);
  if (!actuator.uncertain.empty() || actuator.covariance.size() > 0) validate(actuator);
  for (const ScatterTerm& t : kScatterTerms) {
    if (!(scatter.*t.deviation > 0)) continue;
    if (t.of_links) throw InputError(std::string("scatter: ") + t.name + ": a robot of links is needed");
    of_drop_.push_back(t.deviation);
    sampler.normal(t.name, scatter.*t.deviation);
  }
  if (options.floor && scene.uncertainty) scatter_floor(*scene.uncertainty, sampler);
  scene_.uncertainty.reset(), scene_.verdicts.clear();  // of the planned floor
  if (options.actuator && options.inflate > 0 && actuator.covariance.size() > 0) {
    constants_ = constant_indices(actuator.uncertain);
    sampler.correlated("actuator", actuator.covariance, options.inflate);
  }
  if (inexact_) sampler.uniform("execution", 3);
  sampler_ = std::make_shared<const Sampler>(std::move(sampler));
}

int DropModel::dimension() const { return sampler_->dimension(); }

/// Constants of the floor are log-normal: their covariance is taken relative to their values.
void DropModel::scatter_floor(const Uncertainty& known, Sampler& sampler) {
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
  sampler.correlated("floor", unit.asDiagonal() * eigen(known.covariance) * unit.asDiagonal());
}

ScatteredDrop DropModel::drop(std::span<const double> u) const {
  const std::vector<double> deviation = sampler_->at(u);
  ScatteredDrop d{.scene = scene_};
  auto next = deviation.begin();
  Scatter z;
  for (const auto& names : {of_drop_, of_floor_})
    for (double Scatter::*const name : names) z.*name += *next++;
  d.from_floor = move_drop(d.scene.drop, z);
  d.phi = z.phi, d.rate = z.rate;
  if (auto& floor = d.scene.floor) {
    floor->stiffness *= std::exp(z.stiffness);
    floor->damping_normal *= std::exp(z.damping_normal), floor->damping_tangential *= std::exp(z.damping_tangential);
  }
  d.scene.detection_delay = std::max(0.0, d.scene.detection_delay + z.delay);
  for (const int k : constants_) d.constants[std::size_t(k)] = *next++;
  if (inexact_)
    for (double* x : {&d.deviation.phi_i, &d.deviation.phi_f, &d.deviation.duration}) *x = *next++;
  return d;
}

std::vector<ScatteredDrop> DropModel::drops(const std::vector<double>& points, long count) const {
  const auto d = std::size_t(dimension());
  std::vector<ScatteredDrop> out;
  out.reserve(std::size_t(count));
  for (std::size_t n = 0; n < std::size_t(count); ++n) out.push_back(drop(std::span(points).subspan(n * d, d)));
  return out;
}

std::vector<ScatteredDrop> DropModel::even(long count, std::uint64_t seed, long first) const {
  if (measured_.empty()) return drops(sampler_->even(count, seed, first), count);
  check_count("drops", count, 0, long(1e9));
  const std::size_t n = std::min(measured_.size(), std::size_t(count));
  std::vector<ScatteredDrop> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(measured_[i * measured_.size() / n]);
  return out;
}

std::vector<ScatteredDrop> DropModel::independent(long count, std::uint64_t seed) const {
  return measured_.empty() ? drops(sampler_->independent(count, seed), count) : measured_;
}

}  // namespace ukemi::landing
