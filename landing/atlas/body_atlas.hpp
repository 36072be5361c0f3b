// Interface of a robot of links to an atlas.
#pragma once

#include "landing/atlas/atlas.hpp"
#include "landing/plan/body_plan.hpp"

namespace ukemi::landing {

/// See AtlasRobot::checksum.
[[nodiscard]] std::string robot_checksum(const BodyScene& scene);
/// Which axes of a grid a robot's base has: height unless it cannot fall, forward speed of a free base, pitch except on
/// a rail.
std::array<bool, AtlasGrid::kAxes> axes_of(const Robot& robot);

/// Drops are planned by `plan` (landing/plan), with the block's motions that are best in the drop as warm starts.
class BodyAtlas : public AtlasRobot {
 public:
  explicit BodyAtlas(BodyScene scene) : scene_(std::move(scene)) {}
  std::string text() const override;
  std::string checksum() const override { return robot_checksum(scene_); }
  std::vector<Variable> variables() const override;
  /// An axis that the base does not have must be fixed at the scene's value.
  void validate(const AtlasGrid& grid) const override;
  Scatter scatter(const std::optional<Scatter>& requested) const override;
  /// As of the paper's robot, times the number of variables / kPaperVariables.
  long effort(const AtlasOptions& options) const override;
  AtlasCell plan(const AtlasOptions& options, const AtlasTask& task) const override;
  std::unique_ptr<AtlasTrial> trial(int threads, const std::function<bool()>& over) const override;

 private:
  BodyScene scene_;
};

}  // namespace ukemi::landing
