#include "tools/study/body_drops.hpp"

#include <algorithm>
#include <cmath>

#include "landing/body/floor_constants.hpp"

namespace ukemi::tools {

using namespace landing;

double& number_in(BodyScene& scene, const std::string& name) {
  if (name == "height") return scene.drop.height;
  if (name == "forward_speed") return scene.drop.forward_speed;
  return *floor_constants(scene, name).front();
}

void set_in(BodyScene& scene, const DropTerm& term, double value) {
  for (const std::string& name : term.moves) {
    double& number = number_in(scene, name);
    number = term.is_constant() ? value : number + value;
  }
}

BodyDrops::BodyDrops(const BodyScene& scene, const std::vector<BodyLoggedDrop>& drops, double accuracy, int threads)
    : scene_(scene),
      drops_(drops),
      threads_(threads),
      channels_(body_channels(scene.robot)),
      names_(drop_channels(channels_)) {
  for (std::size_t m = 0; m < drops.size(); ++m) {
    asked_.push_back({kAcc});  // the peak's
    for (std::size_t o = 1; o < channels_.size(); ++o)
      if (drops[m].log.count(o) > 0) asked_[m].push_back(o);
    touchdown_.push_back(
        roll_drop(at(m, {}), drops[m].motion, {}, {drops[m].log.t.back()}, {.accuracy = accuracy}).first_touchdown);
  }
}

double BodyDrops::value(const DropTerm& constant) const {
  BodyScene scene = scene_;
  return number_in(scene, constant.moves.front());
}

BodyScene BodyDrops::at(std::size_t m, const Settings& settings) const {
  BodyScene scene = scene_;
  scene.drop = drops_[m].thrown;
  scene.drop.pitch = scene_.drop.pitch;
  for (const auto& [term, value] : settings) set_in(scene, *term, value);
  return scene;
}

FollowedDrop BodyDrops::follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                               const SimulateOptions& options) const {
  FollowedDrop out;
  const BodyScene scene = at(m, settings);
  if (!(scene.drop.height >= 0)) return out;
  std::vector<BodyChannel> asked;
  for (const std::size_t o : asked_[m]) asked.push_back(channels_[o]);
  BodyRollout rolled = roll_drop(scene, drops_[m].motion, asked, times, options);
  out.complete = rolled.complete, out.steps = rolled.steps, out.jumps = std::move(rolled.jumps);
  out.value.resize(channels_.size());
  for (std::size_t k = 0; k < asked.size(); ++k) out.value[asked_[m][k]] = std::move(rolled.value[k]);
  return out;
}

bool BodyDrops::differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                              const SimulateOptions& options, FollowedDrop& followed) const {
  constexpr double kStep = 1e-4;  // of a term's value or size: well above the rollout's own error at 1e-9
  return differentiate_by_differences(
      settings, kStep, threads_,
      [&](const Settings& beside, const DropTerm& moved, double by) {
        std::vector<double> then = times;
        if (moved.shifts_log())
          for (double& t : then) t = std::max(0.0, t + by);
        return follow(m, beside, then, options);
      },
      followed);
}

double BodyDrops::peak(std::size_t m, const Settings& settings, double until, const SimulateOptions& options) const {
  return roll_drop(at(m, settings), drops_[m].motion, {}, {until}, options).peak;
}

}  // namespace ukemi::tools
