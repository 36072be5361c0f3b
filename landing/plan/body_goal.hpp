// The objective of a robot of links: a measure of the peaks over drops, within the limits of the scene.
#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "landing/lanes/body_batch.hpp"
#include "landing/plan/body_drops.hpp"
#include "landing/plan/body_plan.hpp"
#include "landing/plan/body_space.hpp"

namespace ukemi::landing {

/// Relative accuracy of the landings of a search.
inline constexpr double kSearchAccuracy = 1e-6;

struct BodyGoal {
  Measure measure;
  std::vector<BodyDrop> drops;
  std::size_t counted = drops.size();  ///< the first drops, whose peaks are measured; the others only check the limits
  double share = 1;                    ///< of all drops, in which the limits must be kept, 0..1

  bool single() const { return drops.size() == 1; }
  /// Whether the measure is the largest peak.
  bool worst() const { return single() || measure.kind == Measure::Kind::kWorst; }
  long allowed_broken() const { return long(std::floor((1 - share) * double(drops.size()) + 1e-9)); }
};

/// Evaluates a motion landing by landing: kNoMotion where one cannot be followed or the limits are not kept. A value
/// above `bound` is only a lower bound, as further landings can only increase it.
class Valuation {
 public:
  Valuation(const BodyGoal& goal, BodyMotion motion, double bound);
  /// Sets the next landing to be played; false once the value is final.
  bool next(BodyBatchCase& c);
  void done(const BodyLanding& landing);
  double value() const { return value_; }
  long played() const { return played_; }
  /// Landings that never touched the floor.
  long flew() const { return flew_; }
  /// The contact that touches first in the first drop; -1: none, or it was not played.
  int first_contact() const { return first_contact_; }

 private:
  void finish(double value) { value_ = value, finished_ = true; }

  const BodyGoal* goal_;
  BodyMotion motion_, played_motion_;
  double bound_, value_;
  std::vector<double> peaks_;
  std::size_t drop_ = 0;
  long played_ = 0, flew_ = 0, broken_ = 0;
  int first_contact_ = -1;
  bool finished_ = false;
};
/// Plays them in parallel lanes and threads (0: all cores), which have no influence on the results. Those that `over`
/// cuts off get kNoMotion.
void play(std::span<Valuation> motions, const Robot& robot, double accuracy, int threads,
          const std::function<bool()>* over);

/// The scene's own drop; a landing ends where it first breaks a limit.
BodyGoal nominal_drop(const BodyScene& scene);
/// The execution box: all its peaks are measured, or (false) all but the exact motion's only check the limits.
BodyGoal execution_box(const BodyScene& scene, bool measured);

/// Throws InputError for a share where the scene has no limits; `option`: its name in the message.
void check_share(const BodyScene& scene, const std::optional<double>& share, const std::string& option = "share");

/// Throws InputError for sqp where the goal has no derivatives.
void check_solver(const BodyScene& scene, const BodyPlanOptions& options);

/// The goal of the search, and the one by which its best few are judged.
struct BodyGoals {
  BodyGoal search, judge;
};
/// The drops of plans under scatter: measured or drawn.
BodyDropModel drop_model(const BodyScene& scene, const BodyPlanOptions& options);
/// Of a scene; where drops scatter under a measure, `searched` and `judging` of them.
BodyGoals plan_goals(const BodyScene& scene, const BodyPlanOptions& options, long searched, long judging);
/// Number of judging drops without a deadline: enough to distinguish a requested share from a smaller one.
long judging_drops(const BodyPlanOptions& options);

/// The value of a motion over judging drops, each played to its end.
struct Judged {
  double value;       ///< kNoMotion where one of them cannot be followed
  bool keeps_limits;  ///< in the required share of them
};

Judged judged(const BodyGoal& judge, const BodyMotion& motion, double accuracy, int threads,
              const std::function<bool()>* over = nullptr);
/// At the accuracy of a plan: under a measure that of the search.
inline Judged judged(const BodyGoal& judge, const BodyMotion& motion, const BodyPlanOptions& options) {
  return judged(judge, motion, options.measure ? kSearchAccuracy : options.accuracy, options.threads);
}

}  // namespace ukemi::landing
