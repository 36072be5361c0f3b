#include "landing/model/motion_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/model/release.hpp"

namespace ukemi::landing {

Deviation execution_deviation(int k) {
  if (k == 0) return {0, 0, 0};
  if (k <= 6) {
    const double s = k % 2 ? -1 : 1;
    const int axis = (k - 1) / 2;
    return {axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0};
  }
  const int corner = k - 7;
  return {corner & 4 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 1 ? 1.0 : -1.0};
}

double held_angle(const Scene& scene) {
  return scene.release ? scene.release->phi : std::midpoint(scene.search.phi[0], scene.search.phi[1]);
}

Motion deviated(const Motion& m, const ExecutionTolerance& tolerance, const Deviation& d) {
  constexpr double kShortest = 1e-4;  // lower bound if the tolerance exceeds the duration [s]
  Motion out = m;
  out.phi_i += d.phi_i * tolerance.phi, out.phi_f += d.phi_f * tolerance.phi;
  out.duration = std::max(kShortest, m.duration + d.duration * tolerance.duration);
  return out;
}

MotionSpace::MotionSpace(std::vector<Variable> variables) : variables_(std::move(variables)) {
  if (variables_.empty() || variables_.size() > std::size_t(kMaxVariables))
    throw InputError("variables: " + std::to_string(variables_.size()) + ": 1 to " + std::to_string(kMaxVariables) +
                     " are needed");
  for (const Variable& v : variables_)
    if (!(std::isfinite(v.lower) && std::isfinite(v.upper) && v.lower <= v.upper))
      throw InputError(v.name + ": " + shortest(v.lower) + " to " + shortest(v.upper) + " " + v.unit +
                       ": a finite range that rises is needed");
}

Coordinates MotionSpace::values(const Coordinates& unit) const {
  Coordinates x(unit.size());
  for (int k = 0; k < int(x.size()); ++k) {
    const Variable& v = variables_[std::size_t(k)];
    x[k] = v.lower + unit[k] * (v.upper - v.lower);
    if (unit[k] >= 0 && unit[k] <= 1) x[k] = std::clamp(x[k], v.lower, v.upper);
  }
  return x;
}

Coordinates MotionSpace::place(const Coordinates& values) const {
  Coordinates u(values.size());
  for (int k = 0; k < int(u.size()); ++k) {
    const Variable& v = variables_[std::size_t(k)];
    u[k] = v.upper > v.lower ? (values[k] - v.lower) / (v.upper - v.lower) : 0.5;
  }
  return u;
}

Edges MotionSpace::edges(const Coordinates& values) const {
  constexpr double kNear = 1e-3;
  Edges out{};
  const Coordinates u = place(values);
  for (int k = 0; k < dimension(); ++k)
    out[std::size_t(k)] = static_cast<signed char>((u[k] >= 1 - kNear) - (u[k] <= kNear));
  return out;
}

DrivenMotion MotionSpace::inexact(DrivenMotion play, const ExecutionTolerance& tolerance,
                                  const Deviation& deviation) const {
  play.motion = deviated(play.motion, tolerance, deviation);
  return play;
}

Eigen::MatrixXd MotionSpace::jacobian(const Coordinates& values) const {
  constexpr double kStep = 1e-4;  // of the range
  Eigen::MatrixXd j(kDrivenNumbers, dimension());
  for (int k = 0; k < dimension(); ++k) {
    const Variable& v = variables_[std::size_t(k)];
    Coordinates up = values, down = values;
    up[k] = std::min(v.upper, values[k] + kStep * (v.upper - v.lower));
    down[k] = std::max(v.lower, values[k] - kStep * (v.upper - v.lower));
    if (up[k] > down[k])
      j.col(k) = (numbers(play(up)) - numbers(play(down))) / (up[k] - down[k]);
    else
      j.col(k).setZero();
  }
  return j;
}

std::array<double, 2> move_end_range(double from, double fall) {
  constexpr double kShortest = 0.02, kMinRange = 0.08;  // [s]
  return {from + kShortest, std::max(from + kShortest + kMinRange, std::isfinite(fall) ? fall : 0)};
}

Eigen::Matrix<double, kDrivenNumbers, 1> numbers(const DrivenMotion& p) {
  Eigen::Matrix<double, kDrivenNumbers, 1> n;
  Motion m = p.motion;
  double none = 0;
  const auto pointers = motion_numbers(m, none);
  for (int k = 0; k < kMotionNumbers; ++k) n[k] = *pointers[std::size_t(k)];
  const auto drive = constants(p.sea);
  for (int k = 0; k < kConstants; ++k) n[kMotionNumbers + k] = drive[std::size_t(k)];
  return n;
}

/// A variable and its index in numbers().
struct ReferenceSpace::Number {
  int slot;
  Variable variable;
};

std::vector<ReferenceSpace::Number> ReferenceSpace::variables_of(const Scene& scene) {
  const SearchRange& range = scene.search;
  std::vector<Number> out = {{0, {"phi_i", "phi_I", "rad", range.phi[0], range.phi[1]}},
                             {1, {"phi_f", "phi_F", "rad", range.phi[0], range.phi[1]}},
                             {2, {"duration", "duration", "s", range.duration[0], range.duration[1]}}};
  const Freedom& free = scene.freedom;
  for (int k = 0; k < free.bumps; ++k)
    out.push_back(
        {kBumpSlot + k, {fmt::format("b{}", k), fmt::format("b_{}", k), "rad", free.bump[0], free.bump[1], 0.0}});
  if (const auto& gains = free.gains) {
    out.push_back({kGainSlot, {"gain_p", "factor of K_p", "1", (*gains)[0], (*gains)[1], 1.0}});
    out.push_back({kGainSlot + 1, {"gain_d", "factor of K_d", "1", (*gains)[0], (*gains)[1], 1.0}});
  }
  if (scene.release) {
    const auto to = move_end_range(scene.release->from, fall_time(scene));
    out.push_back({kToSlot, {"to", "end of the move in the air", "s", to[0], to[1]}});
  }
  return out;
}

ReferenceSpace::ReferenceSpace(const Scene& scene, const SeaParameters<double>& sea)
    : ReferenceSpace(scene, sea, variables_of(scene)) {}

ReferenceSpace::ReferenceSpace(const Scene& scene, const SeaParameters<double>& sea, const std::vector<Number>& numbers)
    : MotionSpace([&] {
        std::vector<Variable> variables;
        for (const Number& n : numbers) variables.push_back(n.variable);
        return variables;
      }()),
      release_(scene.release),
      sea_(sea) {
  for (const Number& n : numbers) slots_.push_back(n.slot);
}

void ReferenceSpace::release(const Scene& scene) {
  assert(scene.release.has_value() == release_.has_value());
  if (!scene.release) return;
  release_ = scene.release;
  const auto to = move_end_range(scene.release->from, fall_time(scene));
  set_range(dimension() - 1, to[0], to[1]);
}

Motion ReferenceSpace::motion(const Coordinates& x) const {
  Motion m{};
  if (release_) m.reposition = Reposition{release_->phi, release_->rate, release_->from, 0};
  double none = 0;
  const auto pointers = motion_numbers(m, none);
  for (int k = 0; k < dimension(); ++k) *pointers[std::size_t(slots_[std::size_t(k)])] = x[k];
  return m;
}

Coordinates ReferenceSpace::values_of(const Motion& m) const {
  const auto all = numbers({m, sea_});
  Coordinates x(dimension());
  for (int k = 0; k < dimension(); ++k) x[k] = all[slots_[std::size_t(k)]];
  return x;
}

std::optional<Coordinates> ReferenceSpace::holding(double phi) const {
  Coordinates x = values(centre());
  for (int k = 0; k < dimension(); ++k) {
    const int slot = slots_[std::size_t(k)];
    x[k] = slot < 2 ? phi : variables()[std::size_t(k)].neutral.value_or(x[k]);
  }
  return x;
}

Eigen::MatrixXd ReferenceSpace::jacobian(const Coordinates&) const {
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(kDrivenNumbers, dimension());
  for (int k = 0; k < dimension(); ++k) j(slots_[std::size_t(k)], k) = 1;
  return j;
}

}  // namespace ukemi::landing
