// A robot of links as an atlas sees it.
#pragma once

#include "landing/atlas/atlas.hpp"
#include "landing/plan/body_plan.hpp"

namespace ukemi::landing {

/// See AtlasRobot::checksum.
[[nodiscard]] std::string robot_checksum(const BodyScene& scene);
/// Which axes of a grid a robot's base has: a height where it falls, a forward speed where it is free, a pitch where no
/// rail keeps it.
std::array<bool, AtlasGrid::kAxes> axes_of(const Robot& robot);

/// Its drops are planned by `plan` (landing/plan); from the best few of what the block plays, as they land there.
class BodyAtlas : public AtlasRobot {
 public:
  explicit BodyAtlas(BodyScene scene) : scene_(std::move(scene)) {}
  std::string text() const override;
  std::string checksum() const override { return robot_checksum(scene_); }
  std::vector<Variable> variables() const override;
  /// An axis that the base has not must stand at the scene's value.
  void validate(const AtlasGrid& grid) const override;
  Scatter scatter(const std::optional<Scatter>& asked) const override;
  /// As the paper's robot's, in proportion to the variables.
  long effort(const AtlasOptions& options) const override;
  AtlasCell plan(const AtlasOptions& options, const AtlasTask& task) const override;
  std::unique_ptr<AtlasTrial> trial(int threads, const std::function<bool()>& over) const override;

 private:
  BodyScene scene_;
};

}  // namespace ukemi::landing
