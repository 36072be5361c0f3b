// The objective of a landing of a robot of links: of search/objective.hpp.
#pragma once

#include "landing/plan/body_goal.hpp"
#include "landing/run/simulate.hpp"
#include "landing/search/objective.hpp"

namespace ukemi::landing {

class BodyObjective : public Objective {
 public:
  /// Over the motions of a space; the three must outlive the objective. Plays a landing of the held posture, whose
  /// `held_value` may be known.
  BodyObjective(const BodyScene& scene, const BodySpace& space, const BodyGoals& goals, const Common& options,
                double held_value = kNoMotion);

  BodyMotion motion(const Candidate& p) const { return space_.motion(p.u); }
  const std::vector<Variable>& variables() const override { return space_.variables(); }

  /// Where the goal is the peak, limits are checked in the whole execution box for motions that are better than all
  /// before.
  void evaluate(std::span<Candidate> points, Fidelity fidelity) override;
  bool exact(Fidelity fidelity) const override {
    return fidelity.goal == goal() && fidelity.drops >= goals_.search.drops.size();
  }
  int landings_per_motion(Goal of) const override { return int(goal_of(of).drops.size()); }
  void set_accuracy(double accuracy) override { Objective::set_accuracy(accuracy), lowest_ = kNoMotion; }
  bool several_contacts() const override { return scene_.robot.contacts.size() > 1; }
  double tight_accuracy() const override { return kLowOrder; }
  /// Over the judging drops, by `judged`.
  double verified(const Candidate& p, double accuracy, double bound) override;
  const Measure* measure() const override { return goal() == Goal::kRobust ? &goals_.search.measure : nullptr; }
  /// Limits that the best breaks over the judging drops are broken close by, too.
  double separation() const override { return goal() == Goal::kRobust ? 0.03 : Objective::separation(); }
  bool has_judging() const override { return goal() == Goal::kRobust; }
  void evaluate_judging(std::span<Candidate> points) override;

  /// The held posture of a robot that is not in the air: no other has a motion of the space.
  std::optional<Candidate> held() const override;
  bool may_hold_others() const override { return !scene_.release; }
  /// Random ones, then ones around the best.
  void draw_postures(int round, std::span<Candidate> postures) const override;

  /// Of goals that are the largest peak, of scenes without limits.
  int gradient_rows(Fidelity fidelity) const override;
  bool refines() const override { return true; }
  /// Counts as fifty motions for every eight variables: it takes about as long as those in lanes.
  void linearise(const Coordinates& u, Fidelity fidelity, std::span<double> peaks, std::span<double> gradient) override;

 private:
  const BodyGoal& goal_of(Fidelity fidelity) const;
  void check_limits(std::span<Candidate> points);

  const BodyScene& scene_;
  const BodySpace& space_;
  const BodyGoals& goals_;
  const BodyGoal nominal_;
  const double held_value_;
  mutable BodyGoal few_;       ///< the first drops of the search's goal
  double lowest_ = kNoMotion;  ///< of motions that keep the limits, where the goal is the peak
};

}  // namespace ukemi::landing
