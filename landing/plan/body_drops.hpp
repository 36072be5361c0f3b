// How a drop of a robot of links may come: the scene's scatter, each drive's constants by the covariance of their fit,
// how exactly the motions are played. Ours.
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

/// A drop as it may come, and how what is played then differs from what was planned.
struct BodyDrop {
  /// Of a joint that is driven.
  struct Joint {
    double phi = 0, rate = 0;  ///< at release, beside the planned [rad], [rad/s]
    Deviation deviation{};     ///< of its motion, within the scene's execution tolerance
  };
  BodyScene scene;            ///< its drop, floor, detection and drives
  std::vector<Joint> joints;  ///< of Robot::joints
  bool from_floor = false;    ///< it would begin below the floor, and begins on it

  /// What is planned, as this drop plays it.
  BodyMotion played(const BodyMotion& planned) const;
};

class BodyDropModel {
 public:
  struct Options {
    double inflate = 1;    ///< factor of the standard errors of the drives' and the robot's constants, >= 0
    bool inexact = false;  ///< the motions are played anywhere in the execution box, uniformly
  };
  /// Every term of a scatter counts, `phi` and `rate` for each driven joint on its own; those of the floor scale all
  /// contacts alike; the scene's [uncertainty] scatters with them, and what a fit knew of the robot, which goes before
  /// what an actuator's file knows of the same drive. Throws InputError for a scene or a scatter that is
  /// not valid, for one of `forward_speed` or `pitch_rate` where the base has none, and for a covariance that is not
  /// positive semidefinite.
  BodyDropModel(const BodyScene& scene, const Scatter& scatter, const Options& options);
  BodyDropModel(const BodyScene& scene, const Scatter& scatter) : BodyDropModel(scene, scatter, Options()) {}

  const BodyScene& scene() const { return scene_; }
  /// What a drop is drawn from.
  const Sampler& sampler() const { return sampler_; }
  bool scatters() const { return sampler_.dimension() > 0; }
  /// The drop of a point inside the unit cube, sampler().dimension() numbers.
  BodyDrop drop(std::span<const double> u) const;
  /// The drops of points, one after the other; where nothing scatters the scene's own, `count` times.
  std::vector<BodyDrop> drops(const std::vector<double>& points, long count) const;
  /// Scrambled Sobol points: for searches, which do best with a power of two of them.
  std::vector<BodyDrop> even(long count, std::uint64_t seed, long first = 0) const {
    return drops(sampler_.even(count, seed, first), count);
  }
  /// Independent ones: for what is said of a plan that was found.
  std::vector<BodyDrop> independent(long count, std::uint64_t seed) const {
    return drops(sampler_.independent(count, seed), count);
  }

 private:
  void scatter_floor(const Uncertainty& known);
  void scatter_robot(const Uncertainty& known, double inflate);

  BodyScene scene_;
  Sampler sampler_;
  std::vector<int> driven_;  ///< of Robot::joints
  /// What moves the robot's constants by the sampler's first numbers, as its fit names them.
  std::vector<std::function<void(BodyScene&, double)>> of_robot_;
  std::vector<double Scatter::*> of_scene_;  ///< what the numbers behind those of the robot are
  std::vector<std::string> of_floor_;        ///< what the numbers behind those are, see floor_constants
  bool phi_, rate_, inexact_;
  std::vector<std::pair<int, std::vector<int>>> fitted_;  ///< joints whose covariance is known, their constants
};

/// Scatter::assumed(), without what a base of this kind has not.
Scatter assumed_scatter(const Robot& robot);
/// How drops scatter: as asked for, else as the scene says, else assumed_scatter().
Scatter scatter_for(const std::optional<Scatter>& asked, const BodyScene& scene);

/// The drops of the tolerant peak: the scene's own, those in which one number is missed by the execution tolerance, and
/// the eight corners in which all joints miss alike. For one joint the fifteen of the paper's robot.
std::vector<BodyDrop> execution_drops(const BodyScene& scene);

/// What one motion is worth over drops, see `worth`; infinite where a landing could not be followed or `over` cut it
/// off.
struct PeaksOver {
  std::vector<double> peaks;
  long broken = 0;                  ///< drops in which a limit of the scene was broken
  std::vector<long> exceeded = {};  ///< of each load, drops in which it passes its rating
};
PeaksOver peaks_over(std::span<const BodyDrop> drops, const BodyMotion& motion, double accuracy, int threads,
                     const std::function<bool()>* over = nullptr);

}  // namespace ukemi::landing
