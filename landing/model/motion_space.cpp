#include "landing/model/motion_space.hpp"

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"

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

Motion deviated(const Motion& m, const ExecutionTolerance& tolerance, const Deviation& d) {
  constexpr double kShortest = 1e-4;  // a box wider than the duration itself stops here [s]
  Motion out = m;
  out.phi_i += d.phi_i * tolerance.phi, out.phi_f += d.phi_f * tolerance.phi;
  out.duration = std::max(kShortest, m.duration + d.duration * tolerance.duration);
  return out;
}

MotionSpace::MotionSpace(std::vector<Variable> variables) : variables_(std::move(variables)) {
  if (variables_.empty() || variables_.size() > std::size_t(kMostVariables))
    throw InputError("variables: " + std::to_string(variables_.size()) + ": 1 to " + std::to_string(kMostVariables) +
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
    x[k] = std::clamp(v.lower + unit[k] * (v.upper - v.lower), v.lower, v.upper);
  }
  return x;
}

Play MotionSpace::inexact(Play play, const ExecutionTolerance& tolerance, const Deviation& deviation) const {
  play.motion = deviated(play.motion, tolerance, deviation);
  return play;
}

Eigen::MatrixXd MotionSpace::jacobian(const Coordinates& values) const {
  constexpr double kStep = 1e-4;  // of the range
  Eigen::MatrixXd j(kPlayNumbers, dimension());
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

QuinticSpace::QuinticSpace(const SearchRange& range, const SeaParameters<double>& sea)
    : MotionSpace({{"phi_i", "phi_I", "rad", range.phi[0], range.phi[1]},
                   {"phi_f", "phi_F", "rad", range.phi[0], range.phi[1]},
                   {"duration", "duration", "s", range.duration[0], range.duration[1]}}),
      sea_(sea) {}

}  // namespace ukemi::landing
