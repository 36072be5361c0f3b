// Distribution of drops: the scene's scatter, the actuator's constants by the covariance of their fit, the execution
// tolerance of the motion. Drops are drawn from it, or read as they were measured.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/actuator.hpp"
#include "landing/model/scatter.hpp"
#include "landing/model/scene.hpp"
#include "landing/model/variables.hpp"

namespace ukemi::landing {

class MotionSpace;
class Sampler;

/// A sample of a drop, and how the executed motion then deviates from the planned one.
struct ScatteredDrop {
  Scene scene;                                         ///< its drop, floor and detection
  double phi = 0, rate = 0;                            ///< of the joint at release, minus the planned [rad], [rad/s]
  std::array<double, kActuatorConstants> constants{};  ///< minus the actuator's own, within their ranges
  Deviation deviation{};                               ///< of the motion, within the scene's execution tolerance
  bool from_floor = false;                             ///< it would begin below the floor and was moved onto it

  /// The planned motion as executed in this drop.
  DrivenMotion played(const MotionSpace& space, const DrivenMotion& planned) const;
  DrivenMotion played(const DrivenMotion& planned) const;
};

class DropModel {
 public:
  struct Options {
    bool floor = true;     ///< the floor's constants scatter where the scene holds their covariance
    bool actuator = true;  ///< its constants scatter where its file holds their covariance
    double inflate = 1;    ///< factor of their standard errors, >= 0
    bool inexact = false;  ///< the motion deviates uniformly within the execution tolerance
  };
  /// Throws InputError for a scene, a scatter or an actuator that is not valid, and for a covariance that is not
  /// positive semidefinite.
  DropModel(const Scene& scene, const Scatter& scatter, const Actuator& actuator, const Options& options);
  DropModel(const Scene& scene, const Scatter& scatter) : DropModel(scene, scatter, Actuator{}, Options()) {}

  /// A model of measured drops, instead of drawn ones.
  static DropModel measured(const Scene& scene, std::vector<ScatteredDrop> drops);

  /// Whether drops differ at all.
  bool scatters() const { return dimension() > 0 || !measured_.empty(); }
  /// Number of coordinates that a drop is drawn from; 0: nothing scatters.
  int dimension() const;
  /// The distribution that a drop is drawn from.
  const Sampler& sampler() const { return *sampler_; }
  const Scene& scene() const { return scene_; }
  /// The drop at a point of the unit cube, dimension() numbers; normal numbers are truncated at three deviations.
  ScatteredDrop drop(std::span<const double> u) const;

  /// The drops at `points`, concatenated; where nothing scatters the scene's own, `count` times.
  std::vector<ScatteredDrop> drops(const std::vector<double>& points, long count) const;
  /// At scrambled Sobol points from point `first` on: for searches, best with a power of two of them. Of measured drops
  /// at most `count`, evenly chosen.
  std::vector<ScatteredDrop> even(long count, std::uint64_t seed, long first = 0) const;
  /// At independent points: for the statistics of a plan. Of measured drops all.
  std::vector<ScatteredDrop> independent(long count, std::uint64_t seed) const;

 private:
  void scatter_floor(const Uncertainty& known, Sampler& sampler);

  Scene scene_;
  std::vector<ScatteredDrop> measured_;
  std::shared_ptr<const Sampler> sampler_;
  std::vector<double Scatter::*> of_drop_;   ///< members of the sampler's first numbers
  std::vector<double Scatter::*> of_floor_;  ///< of the scene's [uncertainty]; the floor's constants relative
  std::vector<int> constants_;               ///< of actuator_constants(), those of the covariance
  bool inexact_;
};

}  // namespace ukemi::landing
