// The search space of motions: a box of variables, and the motion and drive of each point. Solvers, map, evidence,
// gradients and reports take variables only from here.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/actuator.hpp"
#include "landing/model/motion.hpp"
#include "landing/model/scene.hpp"
#include "landing/model/variables.hpp"

namespace ukemi::landing {

/// A number for each variable: values in their units, or coordinates 0..1 in their ranges.
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxVariables, 1>;

/// The numbers of a DrivenMotion with derivatives, in the order of Parameter (landing/derivatives/gradient.hpp): those
/// of the motion, then constants() of the drive.
inline constexpr int kDrivenNumbers = kMotionNumbers + kConstants;
Eigen::Matrix<double, kDrivenNumbers, 1> numbers(const DrivenMotion& p);

/// Range of `to` for a move from `from` on and a fall to the floor of `fall` [s]: the move ends before the touchdown of
/// a robot that does not move, but has a minimum duration.
std::array<double, 2> move_end_range(double from, double fall);

/// Constant reference of a robot without a plan: its release angle, else the middle of the range of end angles [rad].
double held_angle(const Scene& scene);

/// The motions of the tolerant peak: x (k = 0), six face centres, eight corners of the box of an execution tolerance.
inline constexpr int kExecutionPoints = 15;
Deviation execution_deviation(int k);

class MotionSpace {
 public:
  /// Takes 1 to kMaxVariables variables. Throws InputError for a range that is empty or not finite.
  explicit MotionSpace(std::vector<Variable> variables);
  virtual ~MotionSpace() = default;

  int dimension() const { return int(variables_.size()); }
  const std::vector<Variable>& variables() const { return variables_; }
  /// Values of a point of the unit cube; beyond their ranges if it is outside the cube.
  Coordinates values(const Coordinates& unit) const;
  /// The inverse of values(), 0.5 in empty ranges, outside the cube for values beyond ranges; unit() clamps it.
  Coordinates place(const Coordinates& values) const;
  Coordinates unit(const Coordinates& values) const { return place(values).cwiseMax(0).cwiseMin(1); }
  Coordinates centre() const { return Coordinates::Constant(dimension(), 0.5); }

  /// Values for a constant reference phi [rad] and neutral other variables, maybe beyond the ranges; absent: none.
  virtual std::optional<Coordinates> holding(double /*phi*/) const { return std::nullopt; }
  /// For each value -1 at or below the lower edge of its range, +1 at or above the upper, to a thousandth of the range.
  Edges edges(const Coordinates& values) const;

  /// The motion and drive of the values.
  virtual DrivenMotion play(const Coordinates& values) const = 0;
  /// The motion with a deviation of its end angles and duration, in units of the tolerance. The result may leave the
  /// ranges; durations are at least 0.1 ms.
  virtual DrivenMotion inexact(DrivenMotion play, const ExecutionTolerance& tolerance,
                               const Deviation& deviation) const;
  /// Point k of the execution box of `play`; point 0 is `play` itself.
  DrivenMotion execution_point(const DrivenMotion& play, const ExecutionTolerance& tolerance, int k) const {
    return k == 0 ? play : inexact(play, tolerance, execution_deviation(k));
  }
  /// d numbers(play) / d values, kDrivenNumbers by dimension(): by default from central differences.
  virtual Eigen::MatrixXd jacobian(const Coordinates& values) const;

 protected:
  void set_range(int variable, double lower, double upper) {
    variables_[std::size_t(variable)].lower = lower, variables_[std::size_t(variable)].upper = upper;
  }

 private:
  std::vector<Variable> variables_;
};

/// Eq. 6 of [1], x = [phi_I phi_F t] within the scene's search range, played by one actuator; then the scene's
/// further variables, in this order: bumps, gains, the end of the move in the air.
class ReferenceSpace : public MotionSpace {
 public:
  ReferenceSpace(const Scene& scene, const SeaParameters<double>& sea);
  DrivenMotion play(const Coordinates& x) const override { return {motion(x), sea_}; }
  /// The values of a motion; numbers that are no variables of the space are dropped.
  Coordinates values_of(const Motion& m) const;
  std::optional<Coordinates> holding(double phi) const override;
  Eigen::MatrixXd jacobian(const Coordinates&) const override;
  /// Sets the release of `scene`, which must have one if and only if the space was built with one.
  void release(const Scene& scene);

 private:
  Motion motion(const Coordinates& x) const;

  struct Number;
  static std::vector<Number> variables_of(const Scene& scene);
  ReferenceSpace(const Scene& scene, const SeaParameters<double>& sea, const std::vector<Number>& numbers);

  std::vector<int> slots_;  ///< of `numbers`, by variable
  std::optional<Release> release_;
  SeaParameters<double> sea_;
};

/// A motion with a deviation in units of the tolerance; the duration is at least 0.1 ms.
Motion deviated(const Motion& motion, const ExecutionTolerance& tolerance, const Deviation& deviation);

}  // namespace ukemi::landing
