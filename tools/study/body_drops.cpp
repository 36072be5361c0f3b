#include "tools/study/body_drops.hpp"

#include <algorithm>

#include "landing/body/floor_constants.hpp"
#include "landing/model/release.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// Sets the numbers of a constant to `value`; adds `value` to those of a nuisance term.
void set_in(BodyScene& scene, const DropTerm& term, double value) {
  for (const std::string& name : term.moves)
    for (double* const number : scene_numbers(scene, name)) *number = term.is_constant() ? value : *number + value;
}

/// Of DropRollout::slope the derivatives by the settings.
Eigen::MatrixXd slope_by(const Settings& settings, const Eigen::MatrixXd& slope) {
  std::vector<long> columns;
  for (const Setting& s : settings) {  // one that shifts the log moves none: the last column, by time
    const auto moved = [&](const DropParameter& p) { return !s.term->shifts_log() && s.term->moves.front() == p.name; };
    columns.push_back(std::ranges::find_if(kDropParameters, moved) - kDropParameters.begin());
  }
  return slope(Eigen::all, columns);
}

}  // namespace

std::vector<double*> scene_numbers(BodyScene& scene, const std::string& name) {
  if (name == "height") return {&scene.drop.height};
  if (name == "forward_speed") return {&scene.drop.forward_speed};
  return floor_constants(scene, name);
}

BodyScene fitted_scene(BodyScene scene, const identify::Terms<DropTerm>& terms, const FloorFit& fit) {
  for (const DropTerm& t : *terms.table)  // those of single contacts come last
    if (t.is_constant())
      for (const identify::Estimate& e : fit.parameters)
        if (e.name == t.name && e.free) set_in(scene, t, e.value);
  return scene;
}

BodyDrops::BodyDrops(const BodyScene& scene, const std::vector<BodyLoggedDrop>& drops,
                     std::vector<DropChannel> channels, double accuracy, int threads, Slopes slopes)
    : scene_(scene), drops_(drops), channels_(std::move(channels)), threads_(threads), slopes_(slopes) {
  for (std::size_t m = 0; m < drops.size(); ++m) {
    simulated_.push_back({kAcc});  // for the peak
    for (std::size_t o = 1; o < channels_.size(); ++o)
      if (drops[m].log.count(o) > 0) simulated_[m].push_back(o);
    const BodyScene thrown = scene_at(m, {});
    if (slopes == Slopes::kExact)
      touchdown_.push_back(is_ballistic(thrown.drop, 0)
                               ? fall_time(thrown.robot.gravity, thrown.drop.height, thrown.drop.vertical_speed)
                               : 0);
    else
      touchdown_.push_back(
          roll_drop(thrown, drops[m].motion, {}, {drops[m].log.t.back()}, {.accuracy = accuracy}).first_touchdown);
  }
}

double BodyDrops::value(const DropTerm& constant) const {
  BodyScene scene = scene_;
  return *scene_numbers(scene, constant.moves.front()).front();
}

BodyScene BodyDrops::scene_at(std::size_t m, const Settings& settings) const {
  BodyScene scene = scene_;
  scene.drop = drops_[m].thrown;
  scene.drop.pitch = scene_.drop.pitch;
  for (const auto& [term, value] : settings) set_in(scene, *term, value);
  return scene;
}

FollowedDrop BodyDrops::follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                               const SimulateOptions& options) const {
  FollowedDrop out;
  const BodyScene scene = scene_at(m, settings);
  if (!(scene.drop.height >= 0)) return out;
  std::vector<DropChannel> channels;
  for (const std::size_t o : simulated_[m]) channels.push_back(channels_[o]);
  const bool exact = slopes_ == Slopes::kExact;
  const BodyMotion& motion = drops_[m].motion;
  DropRollout rolled = exact ? differentiated_drop(scene, motion, channels, times, options)
                             : roll_drop(scene, motion, channels, times, options);
  out.complete = rolled.complete, out.steps = rolled.steps, out.jumps = std::move(rolled.jumps);
  out.value.resize(channels_.size());
  if (exact) out.slope.resize(channels_.size());
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const std::size_t o = simulated_[m][k];
    out.value[o] = std::move(rolled.value[k]);
    if (exact) out.slope[o] = slope_by(settings, rolled.slope[k]);
  }
  return out;
}

bool BodyDrops::differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                              const SimulateOptions& options, FollowedDrop& followed) const {
  if (slopes_ == Slopes::kExact) return true;  // follow has set them
  constexpr double kStep = 1e-4;               // of a term's value or size: well above the rollout's own error at 1e-9
  return finite_difference_slopes(
      settings, kStep, threads_,
      [&](const Settings& perturbed, const DropTerm& term, double step) {
        std::vector<double> shifted = times;
        if (term.shifts_log())
          for (double& t : shifted) t = std::max(0.0, t + step);
        return follow(m, perturbed, shifted, options);
      },
      followed);
}

double BodyDrops::peak(std::size_t m, const Settings& settings, double until, const SimulateOptions& options) const {
  BodyScene scene = scene_at(m, settings);
  if (slopes_ == Slopes::kDifferences) return roll_drop(scene, drops_[m].motion, {}, {until}, options).peak;
  scene.t_end = until;
  SimulateOptions to_the_end = options;
  to_the_end.rest = SimulateOptions::Rest::kIgnore;
  return peak_acceleration(scene, drops_[m].motion, to_the_end).peak;
}

}  // namespace ukemi::tools
