#include "landing/plan/body_planner.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/error.hpp"
#include "landing/plan/body_fall.hpp"
#include "landing/plan/body_space.hpp"

namespace ukemi::landing {

namespace {

BodyAnswer refused(std::string wrong) { return {.status = Plan::Status::kBadInput, .wrong = std::move(wrong)}; }

/// Delays the ends of the moves in the air by `seconds`.
BodyMotion delayed(BodyMotion motion, double seconds) {
  for (Motion& m : motion)
    if (m.reposition) m.reposition->to += seconds;
  return motion;
}

}  // namespace

std::string fault_of(const BodyFallState& s, std::size_t joints) {
  if (s.joints.size() != joints)
    return fmt::format("joints: {}: one for each of {} joints is needed", s.joints.size(), joints);
  for (const BodyRelease::Joint& j : s.joints)
    if (const char* wrong = fault_of_joint(j.phi, j.rate)) return wrong;
  const char* wrong = fault_of_elapsed(s.elapsed);
  return wrong ? wrong : "";
}
BodyScene falling(BodyScene scene, const BodyFallState& s, double from) {
  const double free_fall = -fall_acceleration(scene.robot) * s.elapsed;
  scene.drop = {s.height, s.forward_speed, s.pitch, s.pitch_rate, s.vertical_speed.value_or(free_fall)};
  scene.release = BodyRelease{s.joints, from};
  return scene;
}

BodyPlanner::BodyPlanner(const BodyScene& scene, const BodyPlanOptions& options) : scene_(scene), options_(options) {
  options_.deadline.reset(), options_.starts.clear();
  options_.validate(), scene_.validate();
  (void)BodySpace(scene_);
}

BodyAnswer BodyPlanner::search(const BodyScene& scene, double deadline, std::uint64_t seed) {
  BodyPlanOptions options = options_;
  options.deadline = deadline, options.seed = seed;
  options.starts = std::exchange(starts_, {});
  if (options.starts.empty() && !last_.empty()) options.starts = {last_};
  BodyAnswer out;
  try {
    out.plan = landing::plan(scene, options);
  } catch (const InputError& e) {  // e.g. a speed that the base does not have
    return refused(e.what());
  }
  out.status = out.plan.found ? Plan::Status::kFound : Plan::Status::kNothing;
  return out;
}

BodyAnswer BodyPlanner::plan(const Drop& drop, double deadline, std::uint64_t seed) {
  for (const char* wrong : {fault_of(drop), fault_of_deadline(deadline)})
    if (wrong) return refused(wrong);
  BodyScene scene = scene_;
  scene.drop = drop;
  const BodyAnswer out = search(scene, deadline, seed);
  if (out.found()) last_ = out.plan.motion;
  return out;
}

BodyAnswer BodyPlanner::plan(const BodyFallState& s, double deadline, std::uint64_t seed) {
  const BodyScene scene = falling(scene_, s, deadline);
  if (std::string wrong = fault_of(s, scene_.robot.joints.size()); !wrong.empty()) return refused(std::move(wrong));
  for (const char* wrong : {fault_of(scene.drop), fault_of_deadline(deadline)})
    if (wrong) return refused(wrong);
  if (!(fall_time(scene) > deadline)) return {.status = Plan::Status::kFloorFirst};
  last_ = delayed(std::move(last_), -s.elapsed);
  const BodyAnswer out = search(scene, deadline, seed);
  last_ = delayed(out.found() ? out.plan.motion : std::move(last_), s.elapsed);
  return out;
}

}  // namespace ukemi::landing
