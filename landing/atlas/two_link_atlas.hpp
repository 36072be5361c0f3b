// Interface of the paper's robot to an atlas.
#pragma once

#include "common/actuator.hpp"
#include "landing/atlas/atlas.hpp"

namespace ukemi::landing {

/// See AtlasRobot::checksum.
[[nodiscard]] std::string robot_checksum(const Scene& scene, const SeaParameters<double>& sea);

class TwoLinkAtlas : public AtlasRobot {
 public:
  TwoLinkAtlas(Scene scene, Actuator actuator) : scene_(std::move(scene)), actuator_(std::move(actuator)) {}
  std::string text() const override;
  std::string checksum() const override { return robot_checksum(scene_, actuator_.sea); }
  std::vector<Variable> variables() const override;
  void validate(const AtlasGrid& grid) const override;
  Scatter scatter(const std::optional<Scatter>& requested) const override { return scatter_for(requested, scene_); }
  AtlasCell plan(const AtlasOptions& options, const AtlasTask& task) const override;
  std::unique_ptr<AtlasTrial> trial(int threads, const std::function<bool()>& over) const override;

 private:
  Scene scene_;
  Actuator actuator_;
};

}  // namespace ukemi::landing
