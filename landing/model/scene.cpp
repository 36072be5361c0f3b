#include "landing/model/scene.hpp"

#include <cmath>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "landing/model/motion.hpp"

namespace ukemi::landing {

namespace {

/// A range [low, high] of at least one value.
void check_rising(const char* what, const std::array<double, 2>& range) {
  if (!(range[0] < range[1] && std::isfinite(range[0]) && std::isfinite(range[1])))
    throw InputError(std::string(what) + ": " + shortest(range[0]) + " to " + shortest(range[1]) +
                     ": finite numbers that rise are needed");
}

}  // namespace

void Scatter::validate() const {
  for (const ScatterTerm& t : kScatterTerms) check_not_negative(t.name, this->*t.deviation);
}

void Scene::validate() const {
  for (const double m : robot.mass) check_positive("mass", m);
  for (const double i : robot.inertia_com) check_positive("inertia_com", i);
  check_range("link_length", robot.link_length, Range::link_length()), check_not_negative("gravity", robot.gravity);
  if (floor) {
    check_positive("stiffness", floor->stiffness);
    check_not_negative("damping_normal", floor->damping_normal);
    check_not_negative("damping_tangential", floor->damping_tangential);
  }
  check_not_negative("height", drop.height), check_finite("forward_speed", drop.forward_speed);
  check_finite("pitch", drop.pitch), check_finite("pitch_rate", drop.pitch_rate);
  check_finite("vertical_speed", drop.vertical_speed);
  if (joint) check_rising("joint", *joint);
  if (release) {
    check_finite("release.phi", release->phi), check_finite("release.rate", release->rate);
    check_not_negative("release.from", release->from);
  }
  static const std::vector<std::string> known(kUncertainNames.begin(), kUncertainNames.end());
  if (uncertainty) check(*uncertainty, known, "the scene");
  if (scatter) scatter->validate();
  check_not_negative("detection_delay", detection_delay);
  check_rising("search.phi", search.phi), check_rising("search.duration", search.duration);
  check_positive("search.duration", search.duration[0]);
  check_count("bumps", freedom.bumps, 0, kMaxBumps);
  if (freedom.bumps > 0) check_rising("bump", freedom.bump);
  if (freedom.gains)
    check_rising("landing_gains", *freedom.gains), check_not_negative("landing_gains", (*freedom.gains)[0]);
  check_not_negative("execution.phi", execution.phi), check_not_negative("execution.duration", execution.duration);
  if (t_end) check_positive("t_end", *t_end);
}

}  // namespace ukemi::landing
