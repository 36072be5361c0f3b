#include "landing/plan/body_goal.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include "common/parallel.hpp"
#include "landing/body/load.hpp"
#include "landing/scatter/sampler.hpp"

namespace ukemi::landing {

Valuation::Valuation(const BodyGoal& goal, BodyMotion motion, double bound)
    : goal_(&goal), motion_(std::move(motion)), bound_(bound), value_(kNoMotion), peaks_(goal.counted, 0.0) {}

bool Valuation::next(BodyBatchCase& c) {
  if (finished_) return false;
  const BodyDrop& drop = goal_->drops[drop_];
  played_motion_ = drop.played(motion_);
  c = {&drop.scene, &played_motion_};
  if (goal_->worst() && drop_ < goal_->counted) c.abandon_above = bound_;
  return true;
}

void Valuation::done(const BodyLanding& l) {
  const bool counts = drop_ < goal_->counted, last = drop_ + 1 == goal_->drops.size();
  if (drop_ == 0) first_contact_ = l.contacts.first_point();
  ++played_, ++drop_, flew_ += l.end == End::kNoContact;
  if (no_landing(l.end) || (l.broken && ++broken_ > goal_->allowed_broken())) return finish(kNoMotion);
  if (counts) {
    peaks_[drop_ - 1] = worth(goal_->drops[drop_ - 1].scene, l);
    const bool compare = bound_ < kNoMotion || drop_ == goal_->counted;
    std::vector<double> copy;
    if (compare) copy = peaks_;
    if (const double v = compare ? goal_->measure.of(copy) : 0; v > bound_) return finish(v);
  }
  if (last) finish(goal_->measure.of(peaks_));
}

namespace {

/// Hands motions in their order to the next free lane of any thread; each stays in its lane to its end.
class MotionQueue : public BodyBatchSource {
 public:
  MotionQueue(std::span<Valuation> motions, std::atomic<std::size_t>& next, const std::function<bool()>* over)
      : motions_(motions), next_(next), over_(over) {}
  bool next(int lane, BodyBatchCase& c) override {
    Valuation*& motion = in_lane_[std::size_t(lane)];
    while (!over()) {
      if (motion && motion->next(c)) return true;
      const std::size_t i = next_++;
      if (i >= motions_.size()) return false;
      motion = &motions_[i];
    }
    return false;
  }
  void done(int lane, const BodyLanding& landing) override { in_lane_[std::size_t(lane)]->done(landing); }
  bool over() override { return over_ && (*over_)(); }

 private:
  std::span<Valuation> motions_;
  std::atomic<std::size_t>& next_;
  const std::function<bool()>* over_;
  std::array<Valuation*, kMaxLanes> in_lane_{};
};

BodyScene end_at_limit(BodyScene scene) {
  scene.ends_broken = true;
  return scene;
}

}  // namespace

void play(std::span<Valuation> motions, const Robot& robot, double accuracy, int threads,
          const std::function<bool()>* over) {
  constexpr std::size_t kPart = 2;  // motions a thread, at least
  const int parts = std::min(thread_count(threads), int((motions.size() + kPart - 1) / kPart));
  std::atomic<std::size_t> next{0};
  parallel_for(parts, parts, [&](int) {
    MotionQueue queue(motions, next, over);
    run_body_batch(queue, robot, {.accuracy = accuracy},
                   fastest_instruction_set(2 * motions.size() / std::size_t(parts)));
  });
}

BodyGoal nominal_drop(const BodyScene& scene) {
  return {{Measure::Kind::kWorst}, {{end_at_limit(scene), std::vector<BodyDrop::Joint>(scene.robot.joints.size())}}};
}
BodyGoal execution_box(const BodyScene& scene, bool measured) {
  BodyGoal out{{Measure::Kind::kWorst}, execution_drops(end_at_limit(scene))};
  if (!measured) out.counted = 1;
  return out;
}

BodyDropModel drop_model(const BodyScene& scene, const BodyPlanOptions& options) {
  if (options.measured) return BodyDropModel::measured(scene, *options.measured);
  return {scene,
          scatter_for(options.scatter, scene),
          {.inflate = options.inflate, .inexact = options.goal == Goal::kTolerant}};
}

BodyGoals plan_goals(const BodyScene& scene, const BodyPlanOptions& options, long searched, long judging) {
  const BodyGoal nominal = nominal_drop(scene);
  const bool tolerant = options.goal == Goal::kTolerant;
  if (!options.measure && tolerant) return {execution_box(scene, true), execution_box(scene, true)};
  if (!options.measure) return {nominal, scene.limited() ? execution_box(scene, false) : nominal};
  const BodyDropModel model = drop_model(scene, options);
  if (!model.scatters()) return {nominal, nominal};
  const double share = options.share.value_or(options.measure->share());
  BodyGoals out{
      {.measure = *options.measure, .drops = model.even(searched, options.seed), .share = share},
      {.measure = *options.measure, .drops = model.even(judging, selection_seed(options.seed)), .share = share}};
  // One standard error more than the promised share, as the best of many is chosen by these drops.
  if (options.share) out.judge.share = std::min(1.0, share + std::sqrt(share * (1 - share) / double(judging)));
  return out;
}

void check_share(const BodyScene& scene, const std::optional<double>& share, const std::string& option) {
  if (share && !scene.limited()) throw InputError(option + ": the scene has no limit to keep");
}

void check_solver(const BodyScene& scene, const BodyPlanOptions& options) {
  const bool worst = !options.measure || options.measure->kind == Measure::Kind::kWorst;
  if (options.solver == "sqp" && (scene.limited() || !worst))
    throw InputError("solver: sqp: a scene without limits and a goal that is a largest peak are needed");
}

long judging_drops(const BodyPlanOptions& options) {
  constexpr double kBroken = 10, kMost = 4096;  // drops that may break a limit; maximum of drops
  if (!options.share) return options.judging;
  const double needed = kBroken / std::max(1 - *options.share, kBroken / kMost);
  return std::max(options.judging, long(std::bit_ceil(std::uint64_t(std::ceil(needed - 1e-6)))));
}

Judged judged(const BodyGoal& judge, const BodyMotion& motion, double accuracy, int threads,
              const std::function<bool()>* over) {
  std::vector<BodyDrop> drops = judge.drops;
  for (BodyDrop& d : drops) d.scene.ends_broken = false;
  const PeaksOver all = peaks_over(drops, motion, accuracy, threads, over);
  std::vector<double> peaks = all.peaks;
  const double v = judge.measure.of(std::span(peaks).first(judge.counted));
  return {std::isfinite(v) ? v : kNoMotion, all.broken <= judge.allowed_broken()};
}

}  // namespace ukemi::landing
