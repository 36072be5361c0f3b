#include "tools/web/lander.hpp"

#include <algorithm>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "landing/body/body_scene.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/judge/under_scatter.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_plan.hpp"
#include "landing/plan/body_space.hpp"
#include "landing/plan/scene_doubts.hpp"
#include "landing/search/optimize.hpp"
#include "tools/report/animation.hpp"
#include "tools/report/landing_doubts.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr double kRate = 1000;  ///< rows of a trajectory per second [Hz]

/// Why there is no landing; empty: there is one.
std::string failure_of(const RunEnd& run) {
  if (run.end == End::kNoContact) return "Nothing touches the floor: there is no landing.";
  return no_landing(run.end) ? std::string("The landing cannot be followed: ") + reason(run) + "." : "";
}

void append(const std::vector<std::string>& items, std::vector<std::string>& to) {
  to.insert(to.end(), items.begin(), items.end());
}

/// The paper's robot.
class TwoLinkLander : public Lander {
 public:
  TwoLinkLander(Scene scene, Actuator actuator)
      : scene_(std::move(scene)), actuator_(std::move(actuator)), space_(scene_, actuator_.sea) {}

  std::vector<std::string> drop_keys() const override { return {"height", "pitch", "forward_speed", "pitch_rate"}; }
  std::vector<Variable> variables() const override { return space_.variables(); }
  MotionValues hold_values() const override { return space_.values_of(kHeld); }
  std::string hold_arguments() const override { return "--hold -45"; }
  std::string motion_toml(const MotionValues& values) const override {
    return to_toml(space_.play(values).motion, "A motion of ukemi's page.");
  }
  Played held() const override { return played("held", kHeld); }
  Played play(const std::string& file) const override { return played("this motion", read_motion(file)); }
  std::optional<MotionValues> plan(double seconds, const MotionValues& start) const override {
    const Optimum best =
        optimize(scene_, space_, {.deadline = seconds, .starts = {start}, .threads = 1, .tolerance_samples = 0});
    return best.found ? std::optional(best.values) : std::nullopt;
  }

 private:
  Played played(const std::string& name, const Motion& motion) const {
    const SeaParameters<double>& sea = actuator_.sea;
    const Landing l = simulate(scene_, sea, motion, {}, kRate);
    std::vector<std::string> doubts = landing_doubts(instability(scene_, sea, motion), sea.tau_max);
    append(landing_doubts(l), doubts), append(landing_doubts(ratings(scene_, actuator_, motion, l)), doubts);
    return {l.peak, failure_of(l), animation(name, l, {}, scene_.robot.link_length), doubts};
  }

  Scene scene_;
  Actuator actuator_;
  ReferenceSpace space_;
};

/// A robot of links.
class BodyLander : public Lander {
 public:
  explicit BodyLander(BodyScene scene) : scene_(std::move(scene)) {
    const auto& joints = scene_.robot.joints;
    if (std::any_of(joints.begin(), joints.end(), [](auto& j) { return j.driven(); })) space_.emplace(scene_);
  }

  std::vector<std::string> drop_keys() const override {
    if (scene_.robot.base == Base::kRail) return {"height", "pitch"};
    if (scene_.robot.base == Base::kPinned) return {"pitch"};
    return {"height", "pitch", "forward_speed", "pitch_rate"};
  }
  std::vector<Variable> variables() const override { return space_ ? space_->variables() : std::vector<Variable>(); }
  MotionValues hold_values() const override {
    return space_ ? MotionValues(space_->values(space_->unit(held_posture(scene_)))) : MotionValues();
  }
  std::string hold_arguments() const override { return ""; }
  std::string motion_toml(const MotionValues& values) const override {
    return space_ ? body_motion_toml(space_->motion(space_->unit(Coordinates(values))), scene_.robot,
                                     "A motion of ukemi's page.")
                  : "";
  }
  Played held() const override { return played("held", held_posture(scene_)); }
  Played play(const std::string& file) const override {
    return played("this motion", read_body_motion(file, scene_.robot));
  }
  std::optional<MotionValues> plan(double seconds, const MotionValues& start) const override {
    if (!space_) return std::nullopt;
    const BodyMotion from = space_->motion(space_->unit(Coordinates(start)));
    const BodyPlan best = landing::plan(scene_, {.deadline = seconds, .threads = 1, .starts = {from}});
    return best.found ? std::optional(MotionValues(space_->values(space_->unit(best.motion)))) : std::nullopt;
  }

 private:
  Played played(const std::string& name, const BodyMotion& motion) const {
    const BodyLanding l = simulate(scene_, motion, {}, kRate);
    std::vector<std::string> doubts = landing::doubts(scene_);
    if (!scene_.floor) doubts.push_back("the scene has no [floor]: nothing can touch");
    append(landing_doubts(scene_, motion, l), doubts);
    return {l.peak, failure_of(l), animation(name, scene_, l), doubts};
  }

  BodyScene scene_;
  std::optional<BodySpace> space_;
};

}  // namespace

std::unique_ptr<Lander> read_lander(const std::string& scene, const std::string& actuator) {
  if (is_of_links(scene)) {
    std::vector<GivenDrive> drives;
    if (!actuator.empty()) drives.push_back({"", actuator, "the actuator"});
    return std::make_unique<BodyLander>(read_body_scene(scene, drives));
  }
  if (actuator.empty()) throw InputError(Location{scene}, "an actuator file is needed for the paper's robot");
  return std::make_unique<TwoLinkLander>(read_scene(scene), read_actuator(actuator));
}

}  // namespace ukemi::tools
