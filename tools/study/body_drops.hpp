// Simulated drops of a robot of links as a function of the fitted terms. Private to tools/study.
#pragma once

#include <vector>

#include "landing/drops/body_rollout.hpp"
#include "tools/study/body_calibration.hpp"

namespace ukemi::tools {

/// A number of a scene by name: "height", "forward_speed", or as of landing::floor_constants "pitch", "CONTACT.KEY".
double& scene_number(landing::BodyScene& scene, const std::string& name);
/// Sets the numbers of a constant to `value`; adds `value` to those of a nuisance term.
void set_in(landing::BodyScene& scene, const DropTerm& term, double value);

/// Keeps references to its arguments.
class BodyDrops : public DropSimulator {
 public:
  BodyDrops(const landing::BodyScene& scene, const std::vector<BodyLoggedDrop>& drops, double accuracy, int threads);

  const std::vector<landing::DropChannel>& channels() const override { return drop_channels_; }
  std::size_t drops() const override { return drops_.size(); }
  const landing::DropLog& log(std::size_t m) const override { return drops_[m].log; }
  double value(const DropTerm& constant) const override;
  double first_touchdown(std::size_t m) const override { return touchdown_[m]; }
  FollowedDrop follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                      const landing::SimulateOptions& options) const override;
  bool differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                     const landing::SimulateOptions& options, FollowedDrop& followed) const override;
  double work_factor(std::size_t settings) const override { return 0.5 * double(1 + settings); }
  double peak(std::size_t m, const Settings& settings, double until,
              const landing::SimulateOptions& options) const override;

 private:
  landing::BodyScene scene_at(std::size_t m, const Settings& settings) const;

  const landing::BodyScene& scene_;
  const std::vector<BodyLoggedDrop>& drops_;
  int threads_;
  std::vector<landing::BodyChannel> channels_;
  std::vector<landing::DropChannel> drop_channels_;
  std::vector<std::vector<std::size_t>> simulated_;  ///< channels that are computed, by drop
  std::vector<double> touchdown_;                    ///< first one of each drop [s]
};

}  // namespace ukemi::tools
