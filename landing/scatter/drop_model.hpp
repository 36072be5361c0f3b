// How a drop may come: the scene's scatter, the actuator's constants by the covariance of their fit, how exactly the
// motion is played. Drops are drawn from it, or read as they were measured.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/model/scatter.hpp"

namespace ukemi::landing {

/// A drop as it may come, and how what is played then differs from what was planned.
struct ScatteredDrop {
  Scene scene;                                 ///< its drop, floor and detection
  double phi = 0, rate = 0;                    ///< of the joint at release, beside the planned [rad], [rad/s]
  std::array<double, kConstants> constants{};  ///< beside the actuator's own; none falls to 0
  Deviation deviation{};                       ///< of the motion, within the scene's execution tolerance
  bool from_floor = false;                     ///< it would begin below the floor, and begins on it

  /// What is planned, as this drop plays it.
  Play played(const MotionSpace& space, const Play& planned) const;
  Play played(const Play& planned) const;
};

/// Numbers that are drawn together, with one word for all of them.
struct ScatterGroup {
  std::string name;
  int first, count;  ///< coordinates
};

class DropModel {
 public:
  struct Options {
    bool floor = true;     ///< the floor's constants scatter where the scene holds their covariance
    bool actuator = true;  ///< its constants scatter where its file holds their covariance
    double inflate = 1;    ///< factor of their standard errors, >= 0
    bool inexact = false;  ///< the motion is played anywhere in the execution box, uniformly
  };
  /// Throws InputError for a scene, a scatter or an actuator that is not valid, and for a covariance that is not
  /// positive semidefinite.
  DropModel(const Scene& scene, const Scatter& scatter, const Actuator& actuator, const Options& options);
  DropModel(const Scene& scene, const Scatter& scatter) : DropModel(scene, scatter, Actuator{}, Options()) {}

  /// Drops as they were measured, in place of drawn ones.
  static DropModel measured(const Scene& scene, std::vector<ScatteredDrop> drops) {
    DropModel out(scene, Scatter{}, Actuator{}, {.floor = false, .actuator = false});
    out.measured_ = std::move(drops);
    return out;
  }

  /// Whether drops differ at all.
  bool scatters() const { return dimension_ > 0 || !measured_.empty(); }
  /// Of the coordinates that a drop is drawn from; 0: nothing scatters.
  int dimension() const { return dimension_; }
  const std::vector<ScatterGroup>& groups() const { return groups_; }
  const Scene& scene() const { return scene_; }
  /// The drop of a point inside the unit cube, dimension() numbers; normal numbers are cut at three deviations.
  ScatteredDrop drop(std::span<const double> u) const;

  /// Scrambled Sobol points from point `first` on: for searches, which do best with a power of two of them. Of measured
  /// drops at most so many, spread over all of them.
  std::vector<ScatteredDrop> even(long count, std::uint64_t seed, long first = 0) const;
  /// Independent ones: for what is said of a plan that was found. Of measured drops all.
  std::vector<ScatteredDrop> independent(long count, std::uint64_t seed) const;

 private:
  void add(const std::string& name, int count);
  void scatter_floor(const Uncertainty& known);

  Scene scene_;
  std::vector<ScatteredDrop> measured_;
  Scatter scatter_;
  std::vector<int> terms_;                   ///< of kScatterTerms, those that scatter
  std::vector<int> constants_;               ///< of U, those of the covariance
  Eigen::MatrixXd root_;                     ///< R R^T is their covariance
  std::vector<double Scatter::*> of_floor_;  ///< the numbers of the scene's [uncertainty], as a scatter has them
  Eigen::MatrixXd floor_root_;               ///< of those, relative for the floor's constants
  bool inexact_;
  int dimension_ = 0;
  std::vector<ScatterGroup> groups_;
};

/// A standard normal number cut at three, for u in (0, 1): its quantile.
double cut_normal(double u);

}  // namespace ukemi::landing
