// The objective of a landing of the paper's robot: peak, tolerant peak or measure under scatter over a motion space,
// evaluated in lanes.
#pragma once

#include <memory>

#include "landing/lanes/batch.hpp"
#include "landing/scatter/scattered.hpp"
#include "landing/search/objective.hpp"
#include "landing/search/robust.hpp"
#include "landing/search/tolerant_peak.hpp"

namespace ukemi::landing {

class TwoLinkObjective : public Objective {
 public:
  struct Options {
    Goal goal = Goal::kPeak;
    double accuracy = 1e-6;  ///< see BatchOptions
    /// Limits that every landing of the execution box must keep; the scene's joint stops are added. A motion whose
    /// reference is too fast is refused without a landing.
    Limits limits;
    int threads = 1;  ///< see Common, as are the next three
    Stopwatch::Time time = Stopwatch::Time::kWall;
    double deadline = std::numeric_limits<double>::infinity();
    std::function<bool()> stop;
    std::shared_ptr<const Robust> robust;  ///< for Goal::kRobust
  };

  /// Both must outlive the objective; the scene's drop may change between calls.
  TwoLinkObjective(const Scene& scene, const MotionSpace& space, const Options& options);
  /// Over the motions of Eq. 6.
  TwoLinkObjective(const Scene& scene, const SeaParameters<double>& sea, const Options& options);

  const Scene& scene() const { return scene_; }
  const MotionSpace& space() const { return space_; }
  const Limits& limits() const { return limits_; }
  const std::vector<Variable>& variables() const override { return space_.variables(); }
  /// The motion and drive of a candidate.
  DrivenMotion play(const Candidate& c) const { return space_.play(space_.values(c.u)); }

  /// On one thread it allocates nothing. Drops are played in stages; a motion that can no longer reach its bound gets
  /// its value over the drops played so far, raised above the bound.
  void evaluate(std::span<Candidate> points, Fidelity fidelity) override;
  bool exact(Fidelity fidelity) const override {
    return fidelity.goal == goal() && (fidelity.goal != Goal::kRobust || fidelity.drops >= robust_->drops.size());
  }
  /// The points of its execution box, for the value or to check the limits; a motion that is only screened by its peak
  /// is checked at the exact motion alone.
  int landings_per_motion(Goal of) const override {
    if (of == Goal::kRobust) return int(robust_->drops.size());
    return of == Goal::kTolerant || (of == goal() && limited_) ? kExecutionPoints : 1;
  }
  /// In the scalar path. With a deadline, a landing of very many steps counts as one that cannot be followed.
  double verified(const Candidate& p, double accuracy, double bound = kNoMotion) override;

  const Measure* measure() const override { return robust_ ? &robust_->measure : nullptr; }
  bool has_judging() const override { return robust_ && !robust_->judging.empty(); }
  void evaluate_judging(std::span<Candidate> points) override;
  /// Measure::share of the drops counts. Drops that were not played count as broken, up to the size of the smaller set
  /// (searched on, or judging).
  bool keeps_limits(const Candidate& p) const override;
  /// Under scatter: reserves memory, so that up to `motions` at once are evaluated without allocation.
  void reserve_scattered(std::size_t motions);

  std::optional<Candidate> held() const override;
  bool may_hold_others() const override { return !scene_.release; }
  /// A grid of the range of angles, then one between the neighbours of the best.
  void draw_postures(int round, std::span<Candidate> postures) const override;

  int gradient_rows(Fidelity fidelity) const override;
  /// Under scatter the one row is the measure over the drops of the fidelity.
  void linearise(const Coordinates& u, Fidelity fidelity, std::span<double> peaks, std::span<double> gradient) override;

 private:
  class Race;
  struct Scattered;
  TwoLinkObjective(const Scene& scene, std::unique_ptr<const MotionSpace> owned, const Options& options);
  /// Whether the peak of point k of the execution box enters the value; else it only checks the limits.
  static bool in_value(int k, Goal goal) { return k == 0 || goal == Goal::kTolerant; }
  bool too_fast(const DrivenMotion& play) const;
  void evaluate_boxes(std::span<Candidate> points, Goal goal);
  void update_order(std::span<const Candidate> points, Goal goal);
  void race_over(std::span<Candidate> points, std::span<const ScatteredDrop> drops, bool searching);

  std::unique_ptr<const MotionSpace> owned_;
  const Scene& scene_;
  const MotionSpace& space_;
  Limits limits_;
  std::shared_ptr<const Robust> robust_;
  bool limited_;                  ///< a landing may break a limit
  SeaParameters<double> drive_;   ///< with every term of the actuators played
  bool unlimited_steps_ = false;  ///< of a landing
  long max_steps_ = 0;
  std::array<int, kExecutionPoints> order_;  ///< in which an execution box is played, the most frequent failures first
  std::array<long, kExecutionPoints> failures_{};  ///< how often each point gave a value or ended a motion
  std::shared_ptr<Scattered> scattered_;           ///< buffers of race_over
};

}  // namespace ukemi::landing
