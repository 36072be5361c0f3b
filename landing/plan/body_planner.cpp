#include "landing/plan/body_planner.hpp"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <utility>

#include "common/error.hpp"
#include "landing/plan/body_fall.hpp"
#include "landing/plan/body_space.hpp"

namespace ukemi::landing {

namespace {

struct Number {
  double value, low, high;
  const char* rule;
};
/// What is wrong with the first of the numbers that is out of its range or NaN; empty: nothing.
std::string fault_of(std::initializer_list<Number> numbers) {
  for (const Number& n : numbers)
    if (!(n.value >= n.low && n.value <= n.high)) return n.rule;
  return "";
}
constexpr double kFar = 1e4, kFast = 1e3, kTurn = 6.283185307179586;

std::string fault_of(const Drop& d, double deadline) {
  const std::string wrong = fault_of({{deadline, 1e-6, kFast, "deadline: above 0 to 1e3 s is needed"}});
  return wrong.empty() ? landing::fault_of(d) : wrong;
}
BodyAnswer refused(std::string wrong) { return {.status = Plan::Status::kBadInput, .wrong = std::move(wrong)}; }

/// The ends of the moves in the air, so much later [s].
BodyMotion delayed(BodyMotion motion, double seconds) {
  for (Motion& m : motion)
    if (m.reposition) m.reposition->to += seconds;
  return motion;
}

}  // namespace

std::string fault_of(const Drop& d) {
  return fault_of({{d.height, 0, kFar, "height: 0 to 1e4 m is needed"},
                   {d.forward_speed, -kFast, kFast, "forward_speed: at most 1e3 m/s either way is needed"},
                   {d.pitch, -kTurn, kTurn, "pitch: radians, at most 2 pi either way, are needed"},
                   {d.pitch_rate, -kFast, kFast, "pitch_rate: at most 1e3 rad/s either way is needed"},
                   {d.vertical_speed, -kFast, kFast, "vertical_speed: at most 1e3 m/s either way is needed"}});
}
std::string fault_of(const BodyFallState& s, std::size_t joints) {
  if (s.joints.size() != joints)
    return fmt::format("joints: {}: one for each of {} joints is needed", s.joints.size(), joints);
  for (const BodyRelease::Joint& j : s.joints) {
    const std::string wrong = fault_of({{j.phi, -kTurn, kTurn, "phi: radians, at most 2 pi either way, are needed"},
                                        {j.rate, -kFast, kFast, "rate: at most 1e3 rad/s either way is needed"}});
    if (!wrong.empty()) return wrong;
  }
  return fault_of({{s.elapsed, 0, kFast, "elapsed: 0 to 1e3 s is needed"}});
}
BodyScene falling(BodyScene scene, const BodyFallState& s, double from) {
  const Robot& robot = scene.robot;
  const double along = robot.base == Base::kRail ? std::sin(robot.rail_direction) : 1,
               fallen = robot.base == Base::kPinned ? 0 : -robot.gravity * along * along * s.elapsed;
  scene.drop = {s.height, s.forward_speed, s.pitch, s.pitch_rate, s.vertical_speed.value_or(fallen)};
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
  } catch (const InputError& e) {  // as a speed of a base that has none
    return refused(e.what());
  }
  out.status = out.plan.found ? Plan::Status::kFound : Plan::Status::kNothing;
  return out;
}

BodyAnswer BodyPlanner::plan(const Drop& drop, double deadline, std::uint64_t seed) {
  if (std::string wrong = fault_of(drop, deadline); !wrong.empty()) return refused(std::move(wrong));
  BodyScene scene = scene_;
  scene.drop = drop;
  const BodyAnswer out = search(scene, deadline, seed);
  if (out.found()) last_ = out.plan.motion;
  return out;
}

BodyAnswer BodyPlanner::plan(const BodyFallState& s, double deadline, std::uint64_t seed) {
  const BodyScene scene = falling(scene_, s, deadline);
  for (std::string wrong : {fault_of(s, scene_.robot.joints.size()), fault_of(scene.drop, deadline)})
    if (!wrong.empty()) return refused(std::move(wrong));
  if (!(fall_time(scene) > deadline)) return {.status = Plan::Status::kFloorFirst};
  last_ = delayed(std::move(last_), -s.elapsed);
  const BodyAnswer out = search(scene, deadline, seed);
  last_ = delayed(out.found() ? out.plan.motion : std::move(last_), s.elapsed);
  return out;
}

}  // namespace ukemi::landing
