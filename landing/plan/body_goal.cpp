#include "landing/plan/body_goal.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include "common/parallel.hpp"
#include "landing/body/load.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/scatter/sampler.hpp"
#include "landing/search/nlopt_solver.hpp"
#include "landing/search/population.hpp"

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
  ++played_, ++drop_;
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

long judging_drops(const BodyPlanOptions& options) {
  constexpr double kBroken = 10, kMost = 4096;  // drops that may break a limit; maximum of drops
  if (!options.share) return options.judging;
  const double needed = kBroken / std::max(1 - *options.share, kBroken / kMost);
  return std::max(options.judging, long(std::bit_ceil(std::uint64_t(std::ceil(needed - 1e-6)))));
}

Judged judged(const BodyGoal& judge, const BodyMotion& motion, const BodyPlanOptions& options) {
  std::vector<BodyDrop> drops = judge.drops;
  for (BodyDrop& d : drops) d.scene.ends_broken = false;
  PeaksOver over = peaks_over(drops, motion, options.measure ? kSearchAccuracy : options.accuracy, options.threads);
  const double v = judge.measure.of(std::span(over.peaks).first(judge.counted));
  return {std::isfinite(v) ? v : kNoMotion, over.broken <= judge.allowed_broken()};
}

void descend_by_gradient(const BodyGoal& goal, const BodySpace& space, const Coordinates& start, double value,
                         int threads, const std::function<bool(const Coordinates&)>& play) {
  constexpr double kConverged = 1e-7;
  const int per_drop = goal.single() ? 6 : 2, n = space.dimension();
  const std::vector<BodyParameter> parameters = space.parameters();
  const auto peaks = [&](const double* x, double* a, double* gradient) {
    const Coordinates u = Eigen::Map<const Eigen::VectorXd>(x, n);
    if (!play(u)) return false;
    const BodyMotion motion = space.motion(u);
    // Padded to a fixed number of constraints; those beyond the maxima found, 0 <= s, always hold.
    std::fill_n(a, std::size_t(per_drop) * goal.counted, 0.0);
    std::fill_n(gradient, std::size_t(per_drop * n) * goal.counted, 0.0);
    parallel_for(int(goal.counted), threads, [&](int drop_index) {
      const auto k = std::size_t(drop_index);
      const BodyDrop& drop = goal.drops[k];
      const BodyGradients g =
          gradients(drop.scene, drop.played(motion), parameters, {.accuracy = kSearchAccuracy}, per_drop);
      std::vector<std::pair<double, const BodyPeakGradient*>> rows;  // with their ratings, sorted by value / rating
      if (!rated(drop.scene))
        for (const BodyPeakGradient& p : g.peaks) rows.push_back({1, &p});
      for (std::size_t i = 0; i < g.loads.size(); ++i)
        for (const BodyPeakGradient& p : g.loads[i])
          if (!drop.scene.loads[i].limit) rows.push_back({drop.scene.loads[i].rating, &p});
      std::erase_if(rows, [](const auto& row) { return !row.second->d.allFinite(); });
      std::stable_sort(rows.begin(), rows.end(), [](const auto& one, const auto& other) {
        return one.second->value / one.first > other.second->value / other.first;
      });
      for (std::size_t i = 0; i < std::min(rows.size(), std::size_t(per_drop)); ++i) {
        const auto [rating, peak] = rows[i];
        const std::size_t row = k * std::size_t(per_drop) + i;
        a[row] = peak->value / rating;
        for (int j = 0; j < n; ++j) {
          const Variable& v = space.variables()[std::size_t(j)];
          gradient[row * std::size_t(n) + std::size_t(j)] = peak->d[j] * (v.upper - v.lower) / rating;
        }
      }
    });
    return true;
  };
  minimize_epigraph({per_drop * int(goal.counted),
                     peaks,
                     std::vector<double>(std::size_t(n), 0),
                     std::vector<double>(std::size_t(n), 1),
                     {start.begin(), start.end()},
                     value},
                    kConverged);
}

}  // namespace ukemi::landing
