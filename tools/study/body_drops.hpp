// Drops of a robot of links as a function of a fit's terms. Private to tools/study.
#pragma once

#include <vector>

#include "landing/drops/body_rollout.hpp"
#include "tools/study/body_calibration.hpp"

namespace ukemi::tools {

/// A number of a scene by its name: "height", "forward_speed", "pitch", "CONTACT.KEY" as landing::floor_constants has
/// it.
double& number_in(landing::BodyScene& scene, const std::string& name);
/// Puts a term's value there.
void set_in(landing::BodyScene& scene, const DropTerm& term, double value);

/// What it is made from must outlive it.
class BodyDrops : public DropSimulator {
 public:
  BodyDrops(const landing::BodyScene& scene, const std::vector<BodyLoggedDrop>& drops, double accuracy, int threads);

  const std::vector<landing::DropChannel>& channels() const override { return names_; }
  std::size_t drops() const override { return drops_.size(); }
  const landing::DropLog& log(std::size_t m) const override { return drops_[m].log; }
  double value(const DropTerm& constant) const override;
  double first_touchdown(std::size_t m) const override { return touchdown_[m]; }
  FollowedDrop follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                      const landing::SimulateOptions& options) const override;
  bool differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                     const landing::SimulateOptions& options, FollowedDrop& followed) const override;
  double patience(std::size_t settings) const override { return 0.5 * double(1 + settings); }
  double peak(std::size_t m, const Settings& settings, double until,
              const landing::SimulateOptions& options) const override;

 private:
  landing::BodyScene at(std::size_t m, const Settings& settings) const;

  const landing::BodyScene& scene_;
  const std::vector<BodyLoggedDrop>& drops_;
  int threads_;
  std::vector<landing::BodyChannel> channels_;
  std::vector<landing::DropChannel> names_;
  std::vector<std::vector<std::size_t>> asked_;  ///< channels of each drop that are worked out
  std::vector<double> touchdown_;
};

}  // namespace ukemi::tools
