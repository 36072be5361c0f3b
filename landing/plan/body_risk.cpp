#include "landing/plan/body_risk.hpp"

#include <algorithm>

#include "common/checks.hpp"
#include "landing/body/load.hpp"
#include "landing/judge/risk_run.hpp"

namespace ukemi::landing {

void BodyRiskOptions::validate() const { check_count("samples", samples, 1, 10'000'000); }

namespace {

using Kind = RiskEvent::Kind;

/// The events of a motion, and the load that each is beyond the rating of.
struct Events {
  std::vector<RiskEvent> all;
  std::vector<Load> loads;  ///< of the scene, then the ratings of the drives, which limit nothing

  explicit Events(const BodyScene& scene) : loads(scene.loads) {
    for (std::size_t i = 0; i < loads.size(); ++i) {
      const Load& l = loads[i];
      RiskEvent e{.kind = Kind::kLoad, .load = int(i), .limit = l.rating};
      if (l.kind == Load::Kind::kTouch) e.kind = Kind::kTouch, e.point = l.index;
      if (l.kind == Load::Kind::kAngle && l.limit && l.rating == 0) e.kind = Kind::kStops, e.joint = l.index;
      all.push_back(e);
    }
    for (std::size_t i = 0; i < scene.robot.joints.size(); ++i) {
      const Joint& j = scene.robot.joints[i];
      if (j.driven() && j.speed_max) add_rating(scene.robot, Kind::kSpeed, Load::Kind::kMotorSpeed, i, *j.speed_max);
      if (j.driven() && j.motor_torque_max)
        add_rating(scene.robot, Kind::kTorque, Load::Kind::kMotorTorque, i, *j.motor_torque_max);
    }
  }

 private:
  void add_rating(const Robot& robot, Kind kind, Load::Kind load, std::size_t joint, double rating) {
    all.push_back({.kind = kind, .joint = int(joint), .limit = rating});
    loads.push_back(limit(robot, load, joint, rating)), loads.back().limit = false;
  }
};

}  // namespace

BodyRisk body_risk(const BodyScene& scene, const BodyMotion& motion, const BodyRiskOptions& options) {
  options.validate(), validate(scene.robot, motion);
  BodyRisk out;
  const bool drawn = !options.measured;
  if (drawn) out.scatter = scatter_for(options.scatter, scene);
  out.assumed = drawn && !options.scatter && !scene.scatter;
  const Events events(scene);
  BodyScene bare = scene;
  bare.loads.clear();
  std::vector<BodyDrop> measured;
  if (!drawn) measured = *options.measured;
  for (BodyDrop& d : measured) d.scene.loads.clear();
  const BodyDropModel model =
      drawn ? BodyDropModel(bare, *out.scatter, options.drops) : BodyDropModel::measured(bare, measured);
  const auto drops = [&](long first, long count) {
    return drawn ? model.even(count, options.seed, first)
                 : std::vector<BodyDrop>(measured.begin() + first, measured.begin() + first + count);
  };
  const BodyMotion hold = held_posture(scene);
  const auto playable = [&](std::vector<BodyDrop> scattered) {
    std::vector<PlayableDrop> plays;
    plays.reserve(scattered.size());
    for (BodyDrop& d : scattered) {
      BodyMotion played = d.played(motion), held = d.played(hold);
      plays.push_back({std::move(d.scene), std::move(played), std::move(held), d.from_floor});
    }
    return plays;
  };
  const long samples = !drawn ? long(measured.size()) : model.scatters() ? options.samples : 1;
  const RiskRun run{
      .robot = scene.robot,
      .events = events.all,
      .loads = events.loads,
      .sampler = model.sampler(),
      .drawn = drawn,
      .samples = samples,
      .held = std::min(samples, PeakRisk::kHeldDrops),
      .seed = options.seed,
      .threads = options.threads,
      .monitor = options.monitor,
      .drops = [&](long first, long count) { return playable(drops(first, count)); },
      .at = [&](const std::vector<double>& points, long count) { return playable(model.drops(points, count)); }};
  for (const auto& [peak, index] : run.play(out)) out.worst.push_back({drops(index, 1).front(), peak});
  return out;
}

}  // namespace ukemi::landing
