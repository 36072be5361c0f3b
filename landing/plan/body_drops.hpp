// Scattered drops of a robot of links: by the scene's scatter, the covariance of each drive's fitted constants, and the
// execution tolerance; or drops as they were measured.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "landing/body/body_run.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/scatter/measure.hpp"
#include "landing/scatter/sampler.hpp"

namespace ukemi::landing {

/// A scattered drop, and how the played motion differs from the planned one in it.
struct BodyDrop {
  /// Of a driven joint.
  struct Joint {
    double phi = 0, rate = 0;  ///< at release, minus the planned ones [rad], [rad/s]
    Deviation deviation{};     ///< of its motion, in units of the execution tolerance
  };
  BodyScene scene;            ///< with this drop, floor, detection delay and drives
  std::vector<Joint> joints;  ///< by index of Robot::joints
  bool from_floor = false;    ///< it would begin below the floor, and begins on it

  /// The planned motion as it is played in this drop.
  BodyMotion played(const BodyMotion& planned) const;
};

class BodyDropModel {
 public:
  struct Options {
    double inflate = 1;    ///< factor of the standard errors of the drives' and the robot's constants, >= 0
    bool inexact = false;  ///< motions are drawn uniformly from the execution box
  };
  /// Uses every term of the scatter, `phi` and `rate` independently for each driven joint; those of the floor scale all
  /// contacts alike. The scene's [uncertainty] and the covariance of a fit of the robot are included; the latter
  /// replaces the covariance of an actuator's file for the same drive. Throws InputError for an invalid scene or
  /// scatter, a term that the base or the contacts do not have, and a covariance that is not positive semidefinite.
  BodyDropModel(const BodyScene& scene, const Scatter& scatter, const Options& options);
  BodyDropModel(const BodyScene& scene, const Scatter& scatter) : BodyDropModel(scene, scatter, Options()) {}
  /// A model of measured drops, instead of drawn ones; at least one.
  static BodyDropModel measured(const BodyScene& scene, std::vector<BodyDrop> drops);

  const BodyScene& scene() const { return scene_; }
  const std::vector<BodyDrop>& measured() const { return measured_; }  ///< empty of drawn drops
  /// The distribution of the drops.
  const Sampler& sampler() const { return sampler_; }
  bool scatters() const { return sampler_.dimension() > 0 || !measured_.empty(); }
  /// The drop of a point of the unit cube with sampler().dimension() numbers.
  BodyDrop drop(std::span<const double> u) const;
  /// The drops of `count` points, stored one after the other; copies of the scene's drop where nothing scatters.
  std::vector<BodyDrop> drops(const std::vector<double>& points, long count) const;
  /// Of scrambled Sobol points from point `first` on: for searches, best with a power of two. Of measured drops `count`
  /// spread over all of them, or all.
  std::vector<BodyDrop> even(long count, std::uint64_t seed, long first = 0) const;
  /// Of independent points: for the report on a plan. Of measured drops all.
  std::vector<BodyDrop> independent(long count, std::uint64_t seed) const {
    return measured_.empty() ? drops(sampler_.independent(count, seed), count) : measured_;
  }

 private:
  void scatter_floor(const Uncertainty& known);
  void scatter_robot(const Uncertainty& known, double inflate);

  BodyScene scene_;
  Sampler sampler_;
  std::vector<int> driven_;  ///< indices of Robot::joints
  // What the numbers of the sampler change, in their order.
  std::vector<std::function<void(BodyScene&, double)>> robot_setters_;  ///< constants of a fit of the robot
  std::vector<double Scatter::*> scatter_terms_;                        ///< of the scene
  std::vector<std::string> floor_names_;                                ///< see floor_constants
  bool phi_, rate_, inexact_;
  std::vector<std::pair<int, std::vector<int>>> fitted_;  ///< joints with a covariance, indices of its constants
  std::vector<BodyDrop> measured_;
};

/// Scatter::assumed() without the terms that this base does not have.
Scatter assumed_scatter(const Robot& robot);
/// The requested scatter, else the scene's, else assumed_scatter().
Scatter scatter_for(const std::optional<Scatter>& requested, const BodyScene& scene);

/// The drops of the tolerant peak: the scene's own, those in which one number deviates by the execution tolerance, and
/// the eight corners in which all joints deviate alike. For one joint the fifteen of the paper's robot.
std::vector<BodyDrop> execution_drops(const BodyScene& scene);

/// Values of one motion over drops, see `worth`; infinite where a landing could not be followed or was cut off by
/// `over`.
struct PeaksOver {
  std::vector<double> peaks;
  long broken = 0;                  ///< number of drops in which a limit was broken
  std::vector<long> exceeded = {};  ///< of each load, number of drops in which it exceeds its rating
};
PeaksOver peaks_over(std::span<const BodyDrop> drops, const BodyMotion& motion, double accuracy, int threads,
                     const std::function<bool()>* over = nullptr);

}  // namespace ukemi::landing
