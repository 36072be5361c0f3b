// How a drop may come: the scene's scatter, the actuator's constants by the covariance of their fit, how exactly the
// motion is played. Drops are drawn from it, or read as they were measured.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "landing/model/scatter.hpp"
#include "landing/model/scene.hpp"
#include "landing/model/variables.hpp"

namespace ukemi::landing {

class MotionSpace;
class Sampler;

/// A drop as it may come, and how what is played then differs from what was planned.
struct ScatteredDrop {
  Scene scene;                                         ///< its drop, floor and detection
  double phi = 0, rate = 0;                            ///< of the joint at release, less the planned [rad], [rad/s]
  std::array<double, kActuatorConstants> constants{};  ///< less the actuator's own, within their ranges
  Deviation deviation{};                               ///< of the motion, within the scene's execution tolerance
  bool from_floor = false;                             ///< it would begin below the floor, and begins on it

  /// What is planned, as this drop plays it.
  DrivenMotion played(const MotionSpace& space, const DrivenMotion& planned) const;
  DrivenMotion played(const DrivenMotion& planned) const;
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

  /// Drops as they were measured, instead of drawn ones.
  static DropModel measured(const Scene& scene, std::vector<ScatteredDrop> drops);

  /// Whether drops differ at all.
  bool scatters() const { return dimension() > 0 || !measured_.empty(); }
  /// Number of coordinates that a drop is drawn from; 0: nothing scatters.
  int dimension() const;
  /// What a drop is drawn from.
  const Sampler& sampler() const { return *sampler_; }
  const Scene& scene() const { return scene_; }
  /// The drop of a point inside the unit cube, dimension() numbers; normal numbers are cut at three deviations.
  ScatteredDrop drop(std::span<const double> u) const;

  /// The drops of points, one after the other; where nothing scatters the scene's own, `count` times.
  std::vector<ScatteredDrop> drops(const std::vector<double>& points, long count) const;
  /// Scrambled Sobol points from point `first` on: for searches, which do best with a power of two of them. Of measured
  /// drops at most so many, spread over all of them.
  std::vector<ScatteredDrop> even(long count, std::uint64_t seed, long first = 0) const;
  /// Independent ones: for what is said of a plan that was found. Of measured drops all.
  std::vector<ScatteredDrop> independent(long count, std::uint64_t seed) const;

 private:
  void scatter_floor(const Uncertainty& known, Sampler& sampler);

  Scene scene_;
  std::vector<ScatteredDrop> measured_;
  std::shared_ptr<const Sampler> sampler_;
  std::vector<double Scatter::*> of_drop_;   ///< what the sampler's first numbers are
  std::vector<double Scatter::*> of_floor_;  ///< of the scene's [uncertainty]; the floor's constants relative
  std::vector<int> constants_;               ///< of actuator_constants(), those of the covariance
  bool inexact_;
};

}  // namespace ukemi::landing
