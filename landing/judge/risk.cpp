#include "landing/judge/risk.hpp"

#include <algorithm>

#include "common/checks.hpp"
#include "landing/body/by_links.hpp"
#include "landing/body/load.hpp"
#include "landing/judge/risk_run.hpp"
#include "landing/judge/under_scatter.hpp"

namespace ukemi::landing {

void RiskOptions::validate() const { check_count("samples", samples, 1, 10'000'000); }

namespace {

/// The events of a plan; of each the load of the robot of links: ratings of the motor are no limits.
void add_events(RiskRun& run, const Scene& scene, const Actuator& actuator, const RiskOptions& options,
                const TwoLinkLanding& links) {
  using Kind = RiskEvent::Kind;
  const auto add = [&](const RiskEvent& event, const Load& load) {
    run.events.push_back(event), run.loads.push_back(load);
  };
  for (std::size_t i = 0; i < run.robot.contacts.size(); ++i)
    if (const int p = links.point(int(i)); options.forbidden[std::size_t(p)])
      add({.kind = Kind::kTouch, .point = p}, limit(run.robot, Load::Kind::kTouch, i, 0));
  const auto add_rating = [&](Kind kind, Load::Kind load, const std::optional<double>& rating) {
    if (!rating) return;
    add({.kind = kind, .limit = *rating}, limit(run.robot, load, 0, *rating)), run.loads.back().limit = false;
  };
  add_rating(Kind::kSpeed, Load::Kind::kMotorSpeed, actuator.speed_max);
  add_rating(Kind::kTorque, Load::Kind::kMotorTorque, actuator.motor_torque_max);
  if (scene.joint) add({.kind = Kind::kStops}, limit(run.robot, Load::Kind::kAngle, 0, 0, *scene.joint));
}

}  // namespace

Risk risk(const DropModel& model, const Actuator& actuator, const Motion& motion, const RiskOptions& options) {
  options.validate(), validate(actuator), validate(motion);
  const bool drawn = options.measured.empty();
  const DrivenMotion planned{motion, actuator.sea}, held{kHeld, actuator.sea};
  const auto drops = [&](long first, long count) {
    return drawn
               ? model.even(count, options.seed, first)
               : std::vector<ScatteredDrop>(options.measured.begin() + first, options.measured.begin() + first + count);
  };
  const auto playable = [&](const std::vector<ScatteredDrop>& scattered) {
    std::vector<PlayableDrop> out;
    out.reserve(scattered.size());
    for (const ScatteredDrop& d : scattered) {
      const DrivenMotion played = d.played(planned);
      TwoLinkLanding links(d.scene, played.sea, played.motion);
      out.push_back({std::move(links.scene), links.motion, {d.played(held).motion}, d.from_floor});
    }
    return out;
  };
  const long n = !drawn ? long(options.measured.size()) : model.dimension() > 0 ? options.samples : 1;
  const TwoLinkLanding links(model.scene(), actuator.sea, motion);
  RiskRun run{
      .robot = links.scene.robot,
      .events = {},
      .loads = {},
      .sampler = model.sampler(),
      .flight_counts = false,
      .drawn = drawn,
      .samples = n,
      .held = drawn ? std::min(n, Risk::kHeldDrops) : n,
      .seed = options.seed,
      .threads = options.threads,
      .monitor = options.monitor,
      .drops = [&](long first, long count) { return playable(drops(first, count)); },
      .at = [&](const std::vector<double>& points, long count) { return playable(model.drops(points, count)); }};
  add_events(run, model.scene(), actuator, options, links);
  Risk out;
  for (const auto& [peak, index] : run.play(out)) out.worst.push_back({drops(index, 1).front(), peak});
  for (PeakContact& c : out.contacts) c.point = links.point(c.point);
  for (int p = 0; p < kPoints; ++p) {  // forbidden points that cannot touch
    const auto at = std::find_if(out.events.begin(), out.events.end(),
                                 [p](const RiskEvent& e) { return e.point < 0 || e.point >= p; });
    if (options.forbidden[std::size_t(p)] && (at == out.events.end() || at->point != p))
      out.events.insert(at, {.kind = RiskEvent::Kind::kTouch, .point = p});
  }
  return out;
}

}  // namespace ukemi::landing
