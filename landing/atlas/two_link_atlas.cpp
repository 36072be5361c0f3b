#include "landing/atlas/two_link_atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/files.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/scene_file.hpp"

namespace ukemi::landing {

std::string robot_checksum(const Scene& s, const SeaParameters<double>& sea) {
  std::string text;
  const auto add = [&](double x) { text += fmt::format("{:.9g},", x); };
  for (const double x : s.robot.mass) add(x);
  for (const double x : s.robot.inertia_com) add(x);
  add(s.robot.link_length), add(s.robot.gravity);
  for (const bool touches : s.contacts) add(touches);
  const Floor<double> floor = s.floor.value_or(Floor<double>{});
  Floor<double>::for_each(floor, floor, [&](double x, double) { add(x); });
  if (s.joint) add((*s.joint)[0]), add((*s.joint)[1]);
  add(s.detection_delay), add(s.execution.phi), add(s.execution.duration);
  SeaParameters<double>::for_each(sea, sea, [&](double x, double) { add(x); });
  add(double(sea.feedback));
  return checksum(text);
}

namespace {

AtlasCell cell_of(const Optimum& best) {
  AtlasCell out{.state = AtlasCell::State::kNone};
  if (!best.found || best.landing.joint_lost) return out;
  out.state = AtlasCell::State::kPlanned;
  out.value = best.value, out.peak = best.landing.peak;
  out.tolerant_peak = best.tolerant.failed ? std::nan("") : best.tolerant.value;
  std::copy(best.values.begin(), best.values.end(), out.values.begin());
  return out;
}

class TwoLinkTrial : public AtlasTrial {
 public:
  TwoLinkTrial(const Scene& scene, const SeaParameters<double>& sea, int threads, const std::function<bool()>& over)
      : scene_(scene), sea_(sea), threads_(threads), over_(over) {
    if (scene.joint) limits_.joint = *scene.joint;
  }
  void set(const Drop& planned_for, const MotionValues& values) override {
    scene_.drop = planned_for;
    played_ = ReferenceSpace(scene_, sea_).play(values);
  }
  void play(std::span<const Drop> drops, double bound, std::span<double> peaks) override {
    constexpr double kAccuracy = 1e-5;
    if (scenes_.size() < drops.size()) scenes_.resize(drops.size(), scene_);
    cases_.clear(), landings_.resize(drops.size());
    for (std::size_t k = 0; k < drops.size(); ++k) {
      scenes_[k].drop = drops[k];
      cases_.push_back({&scenes_[k], &played_.sea, played_.motion, bound});
    }
    batch_peaks(cases_, landings_, {.accuracy = kAccuracy, .limits = limits_, .over = &over_}, threads_);
    for (std::size_t k = 0; k < drops.size(); ++k) {
      const LandingPeak& p = landings_[k];
      peaks[k] = no_landing(p.end) || p.end == End::kStopped ? kNoMotion : p.peak;
    }
  }

 private:
  Scene scene_;
  SeaParameters<double> sea_;
  int threads_;
  const std::function<bool()>& over_;
  Limits limits_;
  DrivenMotion played_{};
  std::vector<Scene> scenes_;
  std::vector<BatchCase> cases_;
  std::vector<LandingPeak> landings_;
};

}  // namespace

std::string TwoLinkAtlas::text() const { return to_toml(scene_, "") + to_toml(actuator_); }

std::vector<Variable> TwoLinkAtlas::variables() const { return ReferenceSpace(scene_, actuator_.sea).variables(); }

void TwoLinkAtlas::validate(const AtlasGrid& /*grid*/) const { scene_.validate(), ukemi::validate(actuator_); }

AtlasCell TwoLinkAtlas::plan(const AtlasOptions& options, const AtlasTask& task) const {
  constexpr long kJudging = 256;
  Scene scene = scene_;
  scene.drop = task.drop;
  OptimizeOptions search = options.search;
  search.evaluations = task.effort, search.starts = task.starts, search.seed = task.seed;
  search.threads = 1, search.tolerance_samples = 0;
  search.monitor = {{}, options.monitor.stop};
  if (options.robust.measure) {
    const DropModel drops(scene, scatter(options.robust.scatter), actuator_, {.inflate = options.robust.inflate});
    RobustOptions robust = options.robust;
    robust.judging = kJudging;
    search.goal = Goal::kRobust, search.search_accuracy = Robust::kAccuracy;
    search.robust = robust_goal(drops, robust, options.search.seed);
  }
  return cell_of(optimize(scene, actuator_.sea, search));
}

std::unique_ptr<AtlasTrial> TwoLinkAtlas::trial(int threads, const std::function<bool()>& over) const {
  return std::make_unique<TwoLinkTrial>(scene_, actuator_.sea, threads, over);
}

}  // namespace ukemi::landing
