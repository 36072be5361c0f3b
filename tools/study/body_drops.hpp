// Simulated drops of a robot of links as a function of the fitted terms. Private to tools/study.
#pragma once

#include <vector>

#include "landing/drops/drop_rollout.hpp"
#include "tools/study/body_calibration.hpp"

namespace ukemi::tools {

/// The numbers of a scene by name: "height", "forward_speed", or as of landing::floor_constants "pitch", "KEY",
/// "CONTACT.KEY".
std::vector<double*> scene_numbers(landing::BodyScene& scene, const std::string& name);
/// The scene with the fitted constants.
landing::BodyScene fitted_scene(landing::BodyScene scene, const identify::Terms<DropTerm>& terms, const FloorFit& fit);

/// How derivatives are made.
enum class Slopes {
  kDifferences,
  kExact,  ///< of a robot of two links, by landing::kDropParameters
};

/// Keeps references to scene and drops, whose logs are of `channels`.
class BodyDrops : public DropSimulator {
 public:
  /// `accuracy` of the first touchdowns; `threads` of the differences.
  BodyDrops(const landing::BodyScene& scene, const std::vector<BodyLoggedDrop>& drops,
            std::vector<landing::DropChannel> channels, double accuracy, int threads,
            Slopes slopes = Slopes::kDifferences);

  const std::vector<landing::DropChannel>& channels() const override { return channels_; }
  std::size_t drops() const override { return drops_.size(); }
  const landing::DropLog& log(std::size_t m) const override { return drops_[m].log; }
  double value(const DropTerm& constant) const override;
  double first_touchdown(std::size_t m) const override { return touchdown_[m]; }
  FollowedDrop follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                      const landing::SimulateOptions& options) const override;
  bool differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                     const landing::SimulateOptions& options, FollowedDrop& followed) const override;
  double work_factor(std::size_t settings) const override {
    return slopes_ == Slopes::kExact ? 1 : 0.5 * double(1 + settings);
  }
  double peak(std::size_t m, const Settings& settings, double until,
              const landing::SimulateOptions& options) const override;

 private:
  landing::BodyScene scene_at(std::size_t m, const Settings& settings) const;

  const landing::BodyScene& scene_;
  const std::vector<BodyLoggedDrop>& drops_;
  std::vector<landing::DropChannel> channels_;
  int threads_;
  Slopes slopes_;
  std::vector<std::vector<std::size_t>> simulated_;  ///< channels that are computed, by drop
  std::vector<double> touchdown_;                    ///< first one of each drop [s]
};

}  // namespace ukemi::tools
