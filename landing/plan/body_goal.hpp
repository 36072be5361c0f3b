// What a motion of a robot of links is worth: a measure of its peaks over drops, within the limits of the scene. Ours.
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

/// Relative accuracy of the landings that searches play.
inline constexpr double kSearchAccuracy = 1e-6;

struct BodyGoal {
  Measure measure;
  std::vector<BodyDrop> drops;
  std::size_t counted = drops.size();  ///< of the drops, the first; the others only keep the limits
  double share = 1;                    ///< of all drops, in which the limits are kept

  bool single() const { return drops.size() == 1; }
  /// The largest of the peaks counts.
  bool worst() const { return single() || measure.kind == Measure::Kind::kWorst; }
  long may_break() const { return long(std::floor((1 - share) * double(drops.size()) + 1e-9)); }
};

/// What a motion is worth, landing by landing: kNoMotion where one cannot be followed or the limits are not kept. A
/// value above `bound` is a bound of the value: what is still to come can only add.
class Valuation {
 public:
  Valuation(const BodyGoal& goal, BodyMotion motion, double bound);
  /// The next landing to be played, until the value stands.
  bool next(BodyBatchCase& c);
  void done(const BodyLanding& landing);
  double value() const { return value_; }
  long played() const { return played_; }
  /// Which contact touches first, in the first drop; -1: none, or it was not played.
  int first_contact() const { return first_contact_; }

 private:
  void settle(double value) { value_ = value, over_ = true; }

  const BodyGoal* goal_;
  BodyMotion motion_, as_played_;
  double bound_, value_;
  std::vector<double> peaks_;
  std::size_t drop_ = 0;
  long played_ = 0, broken_ = 0;
  int first_contact_ = -1;
  bool over_ = false;
};
/// Plays them, side by side in lanes and threads (0: all cores); the results do not depend on how many there are. What
/// `over` cuts off comes out with kNoMotion.
void play(std::span<Valuation> motions, const Robot& robot, double accuracy, int threads,
          const std::function<bool()>* over);

/// The scene's own drop. A run of a search by one drop ends where it first breaks a limit.
BodyGoal own_drop(const BodyScene& scene);
/// The execution box: the goal (`counts`), or what keeps the limits.
BodyGoal execution_box(const BodyScene& scene, bool counts);

/// Throws InputError where a share of drops is to keep limits, and the scene has none; `option`: as it is asked for.
void check_share(const BodyScene& scene, const std::optional<double>& share, const std::string& option = "share");

/// What a plan is searched by, and what its best few are judged by.
struct BodyGoals {
  BodyGoal search, judge;
};
/// Those of a scene; where its drops scatter under a measure, so many to search and to judge on.
BodyGoals plan_goals(const BodyScene& scene, const BodyPlanOptions& options, long searched, long judging);
/// Drops that judge, without a deadline: so many that a share that is asked for can be told from a smaller one.
long judging_drops(const BodyPlanOptions& options);

/// What a motion is worth by the drops that judge, each played to its end.
struct Judged {
  double value;       ///< kNoMotion where one of them cannot be followed
  bool keeps_limits;  ///< in as many of them as are asked for
};
Judged judged(const BodyGoal& judge, const BodyMotion& motion, const BodyPlanOptions& options);

/// Follows the exact gradients of a goal in which the largest peak counts down from a place: the paper's SQP on
/// min s subject to a_k(u) <= s, a_k the largest local maxima of the goal's landings. `play` plays each point that is
/// reached, as the search does, and says whether to go on.
void descend_by_gradient(const BodyGoal& goal, const BodySpace& space, const Coordinates& start, double value,
                         int threads, const std::function<bool(const Coordinates&)>& play);

}  // namespace ukemi::landing
