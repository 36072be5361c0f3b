#include "landing/search/two_link_objective.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/parallel.hpp"
#include "landing/lanes/batch_source.hpp"

namespace ukemi::landing {

TwoLinkObjective::TwoLinkObjective(const Scene& scene, const SeaParameters<double>& sea, const Options& options)
    : TwoLinkObjective(scene, std::make_unique<ReferenceSpace>(scene, sea), options) {}

TwoLinkObjective::TwoLinkObjective(const Scene& scene, std::unique_ptr<const MotionSpace> owned, const Options& options)
    : TwoLinkObjective(scene, *owned, options) {
  owned_ = std::move(owned);
}

TwoLinkObjective::TwoLinkObjective(const Scene& scene, const MotionSpace& space, const Options& options)
    : Objective({options.goal, options.accuracy, options.threads, options.time, options.deadline, options.stop}),
      scene_(scene),
      space_(space),
      limits_(options.limits),
      robust_(options.robust) {
  const DrivenMotion middle = space.play(space.values(space.centre()));
  drive_ = middle.sea;
  if (scene.joint) limits_.joint = *scene.joint;
  limited_ = limits_.any_forbidden() || limits_.within_steps() || (limits_.any() && middle.motion.reposition);
  std::iota(order_.begin(), order_.end(), 0);
  // A landing that chatters without end may take a thousand times as long as the others: its steps are limited. Where
  // the centre of the box takes as many, the scene is stiff, and long landings are played in the scalar path.
  constexpr long kUsual = 300, kFactor = 20;  // steps of a landing; maximum relative to that
  constexpr double kShare = 0.1;              // of the deadline, for this landing
  deadline *= kShare;
  const LandingPeak landing =
      peak_acceleration(scene, middle.sea, middle.motion,
                        {.accuracy = options.accuracy, .max_steps = 2 * kUsual * kFactor, .over = &over_});
  deadline = options.deadline;
  landing_time_ = watch.seconds();
  const long steps = landing.work.steps;
  unlimited_steps_ = steps > kUsual * kFactor || landing.end == End::kStopped;
  max_steps_ = kFactor * std::max(kUsual, steps);
}

/// Whether the reference exceeds its maximum rate, exactly or with the shortest duration of the execution box.
bool TwoLinkObjective::too_fast(const DrivenMotion& play) const {
  const double max_rate = limits_.reference_rate;
  if (!std::isfinite(max_rate)) return false;
  for (int k = 0; k < kExecutionPoints; ++k) {
    if (k > 0 && execution_deviation(k).duration >= 0) continue;
    if (peak_reference_rate(space_.execution_point(play, scene_.execution, k).motion) > max_rate) return true;
  }
  return false;
}

/// Motions raced over their execution boxes: each lane takes a motion and plays the points of its box until the first
/// landing above the bound; once all motions are taken, idle lanes share those that are left. Where the goal is the
/// peak, the other points only check the limits.
class TwoLinkObjective::Race : public BatchSource {
 public:
  static constexpr std::size_t kMost = 64;

  Race(const TwoLinkObjective& o, std::span<Candidate> points, Goal goal, long max_work)
      : o_(o), points_(points), max_work_(max_work), goal_(goal), box_points_(o.landings_per_motion(goal)) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i].value = 0, points[i].played = points[i].broken = 0;
      if (const DrivenMotion play = o.play(points[i]); o.too_fast(play))
        fail(i, kNoMotion * (1 + peak_reference_rate(play.motion)));
    }
  }

  bool next(int lane, BatchCase& c) override {
    if (over()) return false;
    int& current = motion_[lane];
    if (current < 0 || !pending(std::size_t(current))) current = admit();
    if (current < 0) return false;
    const auto i = std::size_t(current);
    const Candidate& p = points_[i];
    const int k = box_point(p, step_[i]++);
    box_point_[lane] = k;
    const DrivenMotion& play = play_[lane] = o_.space_.execution_point(o_.play(p), o_.scene_.execution, k);
    c = {&o_.scene_, &play.sea, play.motion, in_value(k, goal_) ? p.bound : std::numeric_limits<double>::infinity()};
    return true;
  }

  void done(int lane, const LandingPeak& peak) override {
    const auto i = std::size_t(motion_[lane]);
    ++landings, ++ended_[i];
    flights += peak.end == End::kNoContact;
    work += work_of(peak.work);
    Candidate& p = points_[i];
    const bool broken = no_landing(peak.end), higher = in_value(box_point_[lane], goal_) && peak.peak > p.value;
    if (box_points_ > 1 && (broken || higher)) p.worst = box_point_[lane];
    if (broken) return fail(i, kNoMotion);
    if (higher) p.value = peak.peak, failed_[i] = p.value > p.bound;
  }

  bool over() override { return interrupted_ = interrupted_ || work >= max_work_ || o_.interrupted(); }

  /// Gives kNoMotion to motions that were interrupted.
  void close() {
    for (std::size_t i = 0; interrupted_ && i < points_.size(); ++i)
      if (ended_[i] < box_points_ && !failed_[i]) fail(i, kNoMotion);
  }

  long landings = 0, flights = 0, work = 0;

 private:
  bool pending(std::size_t i) const { return !failed_[i] && step_[i] < box_points_; }
  void fail(std::size_t i, double value) {
    failed_[i] = true;
    points_[i].value = std::max(points_[i].value, value);
  }
  /// The last worst point of the motion first, then those that failed most motions.
  int box_point(const Candidate& p, int step) const {
    if (box_points_ == 1) return 0;
    const int first = first_[std::size_t(&p - points_.data())];
    const auto& order = o_.order_;
    if (first < 0) return order[std::size_t(step)];
    if (step == 0) return first;
    const auto place = std::find(order.begin(), order.end(), first) - order.begin();
    return order[std::size_t(step <= place ? step - 1 : step)];
  }
  int admit() {
    while (next_point_ < points_.size()) {
      const std::size_t i = next_point_++;
      first_[i] = points_[i].worst;
      if (pending(i)) return int(i);
    }
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (pending(i)) return int(i);
    return -1;
  }

  const TwoLinkObjective& o_;
  std::span<Candidate> points_;
  const long max_work_;
  const Goal goal_;
  const int box_points_;
  std::size_t next_point_ = 0;
  std::array<bool, kMost> failed_{};
  std::array<int, kMost> step_{}, first_{}, ended_{};
  bool interrupted_ = false;
  static constexpr int kLanes = lanes(InstructionSet::kAvx512);
  std::array<int, kLanes> motion_{-1, -1, -1, -1, -1, -1, -1, -1}, box_point_{};
  std::array<DrivenMotion, kLanes> play_;  ///< referenced by the lane's landing
};

void TwoLinkObjective::evaluate(std::span<Candidate> points, Fidelity fidelity) {
  if (fidelity.goal != Goal::kRobust) return evaluate_boxes(points, fidelity.goal);
  const auto& drops = robust_->drops;
  race_over(points, std::span(drops).first(std::min(fidelity.drops, drops.size())), true);
}

void TwoLinkObjective::evaluate_boxes(std::span<Candidate> points, Goal goal) {
  const int chunks = int((points.size() + Race::kMost - 1) / Race::kMost);
  const int parts = std::max(chunks, std::min(2, int(points.size() / 16)));  // fixed by the size, not by the threads
  std::atomic<long> landings{0}, flights{0}, work{0};
  const long max_work = max_work_ == kUnbounded ? kUnbounded : std::max(0L, max_work_ - work_) / std::max(1, parts);
  const BatchOptions batch{
      .accuracy = accuracy(),
      .limits = limits_,
      .on_max_steps = unlimited_steps_ ? BatchOptions::OnMaxSteps::kScalar : BatchOptions::OnMaxSteps::kFail,
      .max_steps = unlimited_steps_ ? BatchOptions().max_steps : max_steps_};
  parallel_for(parts, threads(), [&](int i) {
    const std::size_t n = points.size(), a = n * std::size_t(i) / std::size_t(parts),
                      b = n * (std::size_t(i) + 1) / std::size_t(parts);
    Race race(*this, points.subspan(a, b - a), goal, max_work);
    run_batch(race, scene_, drive_, batch, fastest_instruction_set((b - a) * std::size_t(landings_per_motion(goal))));
    race.close();
    landings += race.landings, flights += race.flights, work += race.work;
  });
  if (landings_per_motion(goal) > 1) update_order(points, goal);
  motions_ += long(points.size());
  landings_ += landings, flights_ += flights, work_ += work;
}

/// Sorts the box by failures. Where it only checks the limits, a motion that kept them is not counted.
void TwoLinkObjective::update_order(std::span<const Candidate> points, Goal goal) {
  for (const Candidate& p : points)
    if (p.worst >= 0 && (goal == Goal::kTolerant || p.value > p.bound || p.value >= kNoMotion))
      ++failures_[std::size_t(p.worst)];
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    const long fa = failures_[std::size_t(a)], fb = failures_[std::size_t(b)];
    return fa != fb ? fa > fb : a < b;
  });
}

double TwoLinkObjective::verified(const Candidate& c, double accuracy, double bound) {
  const DrivenMotion play = this->play(c);
  double worst = 0;
  const int n = landings_per_motion(goal());
  constexpr double kAny = std::numeric_limits<double>::infinity();
  // With a deadline, no landing that chatters without end.
  const long steps = std::isfinite(deadline) ? max_steps_ : SimulateOptions().max_steps;
  if (too_fast(play)) return kNoMotion;
  for (int k = 0; k < n && !interrupted(); ++k) {
    const DrivenMotion deviated = space_.execution_point(play, scene_.execution, k);
    const LandingPeak p = peak_acceleration(scene_, deviated.sea, deviated.motion,
                                            {.accuracy = accuracy,
                                             .abandon_above = in_value(k, goal()) ? bound : kAny,
                                             .max_steps = steps,
                                             .limits = limits_,
                                             .over = &over_});
    work_ += work_of(p.work);
    if (no_landing(p.end)) return kNoMotion;
    if (in_value(k, goal())) worst = std::max(worst, p.peak);
    if (worst > bound) break;
  }
  return worst;
}

std::optional<Candidate> TwoLinkObjective::held() const {
  const std::optional<Coordinates> values = space_.holding(held_angle(scene_));
  return values ? std::optional(Candidate{space_.place(*values)}) : std::nullopt;
}

void TwoLinkObjective::draw_postures(int round, std::span<Candidate> postures) const {
  auto [low, high] = scene_.search.phi;
  if (round > 0) {
    const double step = (high - low) / double(postures.size() - 1);
    const auto best = std::min_element(postures.begin(), postures.end());
    const double phi = low + double(best - postures.begin()) * step;
    low = std::max(low, phi - step), high = std::min(high, phi + step);
  }
  const double step = (high - low) / double(postures.size() - 1);
  for (std::size_t i = 0; i < postures.size(); ++i)
    postures[i] = Candidate{space_.place(*space_.holding(low + double(i) * step))};
}

}  // namespace ukemi::landing
