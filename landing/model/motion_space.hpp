// The motions that a search may choose from: a box of variables, and what a point of it means. Solvers, map, evidence,
// gradients and reports count no variables of their own: they ask the space.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "landing/model/motion.hpp"
#include "landing/model/scene.hpp"
#include "landing/model/variables.hpp"

namespace ukemi::landing {

/// A number for each variable: values in their units, or places 0..1 in their ranges.
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostVariables, 1>;

/// The numbers of a play that gradients know, in the order of Parameter (landing/derivatives/gradient.hpp): those of
/// the motion, phi_I, phi_F and duration first, then constants() of the drive.
inline constexpr int kPlayNumbers = kMotionNumbers + kConstants;
Eigen::Matrix<double, kPlayNumbers, 1> numbers(const DrivenMotion& p);

/// The range of `to` where the reference may move from `from` on and the floor comes after `fall` [s]: a move ends
/// before a robot that does not move would meet the floor, but lasts its shortest.
std::array<double, 2> ends_of_move(double from, double fall);

/// Where the reference of a robot that plans nothing stands: where it is released, else in the middle of the range of
/// the end angles [rad].
double held_angle(const Scene& scene);

/// The motions of the tolerant peak: x (k = 0), six face centres, eight corners of the box of an execution tolerance.
inline constexpr int kExecutionPoints = 15;
Deviation execution_deviation(int k);

class MotionSpace {
 public:
  /// 1 to kMostVariables of them. Throws InputError for a range that is empty or not finite.
  explicit MotionSpace(std::vector<Variable> variables);
  virtual ~MotionSpace() = default;

  int dimension() const { return int(variables_.size()); }
  const std::vector<Variable>& variables() const { return variables_; }
  /// Values of a point of the unit cube, within their ranges (beyond them where it is beyond the cube); and the middle
  /// of the cube.
  Coordinates values(const Coordinates& unit) const;
  /// The inverse: the place of values, beyond the cube where they are beyond their ranges; then the nearest in it. A
  /// range of one value has its middle.
  Coordinates place(const Coordinates& values) const;
  Coordinates unit(const Coordinates& values) const { return place(values).cwiseMax(0).cwiseMin(1); }
  Coordinates centre() const { return Coordinates::Constant(dimension(), 0.5); }

  /// The motion whose reference is phi [rad] throughout, else as the drive is: what a robot does that plans
  /// nothing. It may lie beyond the ranges. Absent where a space knows none.
  virtual std::optional<Coordinates> holding(double /*phi*/) const { return std::nullopt; }
  /// Which of the values lie on the lower (-1) or upper (+1) edge of their range, or beyond it, to a thousandth of it.
  Edges edges(const Coordinates& values) const;

  /// What the values stand for.
  virtual DrivenMotion play(const Coordinates& values) const = 0;
  /// The motion as a robot plays it: end angles and duration are what it misses, whatever the other variables. The box
  /// may leave the ranges; a duration stops at 0.1 ms.
  virtual DrivenMotion inexact(DrivenMotion play, const ExecutionTolerance& tolerance,
                               const Deviation& deviation) const;
  /// Point k of its execution box, the play itself first.
  DrivenMotion execution_point(const DrivenMotion& play, const ExecutionTolerance& tolerance, int k) const {
    return k == 0 ? play : inexact(play, tolerance, execution_deviation(k));
  }
  /// d numbers(play) / d values, kPlayNumbers by dimension(): by central differences where a space knows no better.
  virtual Eigen::MatrixXd jacobian(const Coordinates& values) const;

 protected:
  void set_range(int variable, double lower, double upper) {
    variables_[std::size_t(variable)].lower = lower, variables_[std::size_t(variable)].upper = upper;
  }

 private:
  std::vector<Variable> variables_;
};

/// Eq. 6 of [1], x = [phi_I phi_F t] within the scene's search range, played by one actuator; and what the scene lets a
/// motion have beside it, in this order: bumps, gains, the end of the move in the air.
class ReferenceSpace : public MotionSpace {
 public:
  ReferenceSpace(const Scene& scene, const SeaParameters<double>& sea);
  DrivenMotion play(const Coordinates& x) const override { return {motion(x), sea_}; }
  /// The values of a motion; what it has and the space has not is lost.
  Coordinates values_of(const Motion& m) const;
  std::optional<Coordinates> holding(double phi) const override;
  Eigen::MatrixXd jacobian(const Coordinates&) const override;
  /// This space for another release: of `scene`, which has one if and only if the space's own had.
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

/// A motion with its deviation; a duration stops at 0.1 ms.
Motion deviated(const Motion& motion, const ExecutionTolerance& tolerance, const Deviation& deviation);

}  // namespace ukemi::landing
