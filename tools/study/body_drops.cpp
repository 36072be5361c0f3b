#include "tools/study/body_drops.hpp"

#include <algorithm>

#include "landing/body/floor_constants.hpp"

namespace ukemi::tools {

using namespace landing;

double& scene_number(BodyScene& scene, const std::string& name) {
  if (name == "height") return scene.drop.height;
  if (name == "forward_speed") return scene.drop.forward_speed;
  return *floor_constants(scene, name).front();
}

void set_in(BodyScene& scene, const DropTerm& term, double value) {
  for (const std::string& name : term.moves) {
    double& number = scene_number(scene, name);
    number = term.is_constant() ? value : number + value;
  }
}

BodyDrops::BodyDrops(const BodyScene& scene, const std::vector<BodyLoggedDrop>& drops, double accuracy, int threads)
    : scene_(scene),
      drops_(drops),
      threads_(threads),
      channels_(body_channels(scene.robot)),
      drop_channels_(drop_channels(channels_)) {
  for (std::size_t m = 0; m < drops.size(); ++m) {
    simulated_.push_back({kAcc});  // for the peak
    for (std::size_t o = 1; o < channels_.size(); ++o)
      if (drops[m].log.count(o) > 0) simulated_[m].push_back(o);
    touchdown_.push_back(
        roll_drop(scene_at(m, {}), drops[m].motion, {}, {drops[m].log.t.back()}, {.accuracy = accuracy})
            .first_touchdown);
  }
}

double BodyDrops::value(const DropTerm& constant) const {
  BodyScene scene = scene_;
  return scene_number(scene, constant.moves.front());
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
  std::vector<BodyChannel> channels;
  for (const std::size_t o : simulated_[m]) channels.push_back(channels_[o]);
  BodyRollout rolled = roll_drop(scene, drops_[m].motion, channels, times, options);
  out.complete = rolled.complete, out.steps = rolled.steps, out.jumps = std::move(rolled.jumps);
  out.value.resize(channels_.size());
  for (std::size_t k = 0; k < channels.size(); ++k) out.value[simulated_[m][k]] = std::move(rolled.value[k]);
  return out;
}

bool BodyDrops::differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                              const SimulateOptions& options, FollowedDrop& followed) const {
  constexpr double kStep = 1e-4;  // of a term's value or size: well above the rollout's own error at 1e-9
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
  return roll_drop(scene_at(m, settings), drops_[m].motion, {}, {until}, options).peak;
}

}  // namespace ukemi::tools
