#include "landing/atlas/body_atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/files.hpp"
#include "landing/body/floor_constants.hpp"
#include "landing/body/load.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/plan/body_goal.hpp"

namespace ukemi::landing {

namespace {

class Listing;
void list(const Load& l, Listing& add);

/// Concatenates numbers and names as text.
class Listing {
 public:
  explicit Listing(const char* number) : number_(number) {}
  Listing& operator()(double x) { return text_ += fmt::format(fmt::runtime(number_), x), *this; }
  Listing& operator()(const std::string& name) { return text_ += name + ";", *this; }
  Listing& operator()(const Place& p) { return (*this)(p.along)(p.across); }
  Listing& operator()(const std::array<double, 2>& x) { return (*this)(x[0])(x[1]); }
  /// The listings of all elements, sorted: independent of their order.
  template <class T>
  Listing& sorted(const std::vector<T>& all) {
    std::vector<std::string> texts;
    for (const T& x : all) {
      Listing one(number_);
      list(x, one);
      texts.push_back(one.text());
    }
    std::sort(texts.begin(), texts.end());
    for (const std::string& text : texts) text_ += text;
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  const char* number_;
  std::string text_;
};

void list(const Joint& j, Listing& add) {
  add(j.name)(j.child)(double(j.kind))(j.stiffness)(j.damping)(j.rest)(j.parallel_stiffness)(j.parallel_rest)(j.phi);
  SeaParameters<double>::for_each(j.sea, j.sea, [&](double x, double) { add(x); });
  add(double(j.sea.feedback));
}

void list(const ContactPoint& c, Listing& add) {
  add(c.name)(c.link)(c.at)(c.law.hunt_crossley);
  for (const LawConstant& constant : kLawConstants) add(c.law.*constant.at);
  if (!c.pad) return;
  for (const PadConstant& constant : kPadConstants) add(*c.pad.*constant.at);
}

void list(const Load& l, Listing& add) { add("load")(double(l.kind))(l.index)(l.at)(l.phi)(l.rating)(l.limit); }

/// The robot and its floor, see AtlasRobot::checksum.
void list_robot(const BodyScene& s, Listing& add) {
  const Robot& r = s.robot;
  add(r.gravity)(double(r.base))(r.rail_direction)(r.rail_viscous)(r.pin_height)(r.peak_link)(r.peak);
  if (r.rail_friction > 0 || r.rail_load_friction > 0) add("rail")(r.rail_friction)(r.rail_load_friction);
  for (const Link& l : r.links) add(l.name)(l.parent)(l.at)(l.mass)(l.inertia_com)(l.com);
  for (const Joint& j : r.joints) list(j, add);
  for (const ContactPoint& c : r.contacts) list(c, add);
  add(s.floor)(s.slope)(s.detection_delay)(s.execution.phi)(s.execution.duration);
  add.sorted(s.loads);
}

/// The rest on which a plan depends.
void list_plan(const BodyScene& s, Listing& add) {
  for (const JointSearch& j : s.search) add(j.phi)(j.held());
  add(s.duration)(s.own_durations)(s.freedom.bumps)(s.freedom.bump)("gains");
  if (s.freedom.gains) add(*s.freedom.gains);
  if (s.t_end) add("t_end")(*s.t_end);
  if (s.release) {
    add("release")(s.release->from);
    for (const BodyRelease::Joint& j : s.release->joints) add(j.phi)(j.rate);
  }
  const auto list_known = [&](const std::vector<std::string>& names, const DenseMatrix& covariance) {
    for (const std::string& name : names) add(name);
    for (long i = 0; i < covariance.size(); ++i) add(covariance.data()[i]);
  };
  if (s.uncertainty) list_known(s.uncertainty->order, s.uncertainty->covariance);
  for (const Joint& j : s.robot.joints) list_known(j.uncertain, j.covariance);
}

/// The scene with this drop; landings end where they break a limit.
BodyScene with_drop(BodyScene scene, const Drop& drop) {
  scene.drop = drop, scene.ends_broken = true;
  return scene;
}

class BodyTrial : public AtlasTrial {
 public:
  BodyTrial(const BodyScene& scene, int threads, const std::function<bool()>& over)
      : scene_(with_drop(scene, scene.drop)), threads_(threads), over_(over) {}
  void set(const Drop& planned_for, const MotionValues& values) override {
    scene_.drop = planned_for;
    const BodySpace space(scene_);
    motion_ = space.motion(space.unit(Coordinates(values)));
  }
  void play(std::span<const Drop> drops, double bound, std::span<double> peaks) override {
    constexpr double kAccuracy = 1e-5;
    if (scenes_.size() < drops.size()) scenes_.resize(drops.size(), scene_);
    cases_.clear(), landings_.resize(drops.size());
    for (std::size_t k = 0; k < drops.size(); ++k) {
      scenes_[k].drop = drops[k];
      cases_.push_back({&scenes_[k], &motion_, bound});
    }
    body_batch_peaks(cases_, landings_, {.accuracy = kAccuracy, .over = &over_}, threads_);
    for (std::size_t k = 0; k < drops.size(); ++k) {
      const BodyLanding& l = landings_[k];
      peaks[k] = no_landing(l.end) || l.broken || l.end == End::kStopped ? kNoMotion : worth(scenes_[k], l);
    }
  }

 private:
  BodyScene scene_;
  int threads_;
  const std::function<bool()>& over_;
  BodyMotion motion_;
  std::vector<BodyScene> scenes_;
  std::vector<BodyBatchCase> cases_;
  std::vector<BodyLanding> landings_;
};

/// The neighbours' motions that are best in this drop.
std::vector<BodyMotion> best_starts(const BodyScene& scene, const BodySpace& space,
                                    const std::vector<MotionValues>& starts, const std::function<bool()>* over) {
  constexpr std::size_t kStarts = 3;
  const BodyGoal goal = nominal_drop(scene);
  std::vector<BodyMotion> motions;
  std::vector<Valuation> played;
  for (const MotionValues& v : starts) {
    motions.push_back(space.motion(space.unit(Coordinates(v))));
    played.emplace_back(goal, motions.back(), kNoMotion);
  }
  play(played, scene.robot, kSearchAccuracy, 1, over);
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < played.size(); ++k)
    if (played[k].value() < kNoMotion) order.push_back(k);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return played[a].value() < played[b].value(); });
  std::vector<BodyMotion> out;
  for (std::size_t k = 0; k < std::min(kStarts, order.size()); ++k) out.push_back(motions[order[k]]);
  return out;
}

/// Whether the space contains a motion; not so holding outside of its ranges, or in the air.
bool contains(const BodySpace& space, const Robot& robot, const BodyMotion& motion) {
  constexpr double kSame = 1e-9;
  const BodyMotion nearest = space.motion(space.unit(motion));
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const Motion &a = motion[i], &b = nearest[i];
    if (!robot.joints[i].driven()) continue;
    if (std::abs(a.phi_i - b.phi_i) > kSame || std::abs(a.phi_f - b.phi_f) > kSame) return false;
    if (a.reposition && !std::isfinite(a.reposition->to)) return false;
  }
  return true;
}

AtlasCell cell_of(const BodyScene& scene, const BodySpace& space, const BodyPlan& best, const AtlasOptions& options) {
  AtlasCell out{.state = AtlasCell::State::kNone};
  if (!best.found || !contains(space, scene.robot, best.motion)) return out;
  out.state = AtlasCell::State::kPlanned;
  out.value = best.value, out.peak = best.landing.peak;
  if (options.search.goal == Goal::kTolerant && !options.robust.measure) {
    out.tolerant_peak = best.value;
  } else {
    const std::vector<double> peaks = peaks_over(execution_drops(scene), best.motion, kSearchAccuracy, 1).peaks;
    const double worst = *std::max_element(peaks.begin(), peaks.end());
    out.tolerant_peak = std::isfinite(worst) ? std::max(worst, worth(scene, best.landing)) : std::nan("");
  }
  const Coordinates values = space.values(space.unit(best.motion));
  std::copy(values.begin(), values.end(), out.values.begin());
  return out;
}

}  // namespace

std::string robot_checksum(const BodyScene& scene) {
  Listing numbers("{:.9g},");
  list_robot(scene, numbers);
  return ukemi::checksum(numbers.text());
}

std::array<bool, AtlasGrid::kAxes> axes_of(const Robot& robot) {
  const bool rail = robot.base == Base::kRail, free = robot.base == Base::kFree;
  return {free || (rail && std::sin(robot.rail_direction) != 0), free, !rail};
}

std::string BodyAtlas::text() const {
  Listing numbers("{},");
  list_robot(scene_, numbers), list_plan(scene_, numbers);
  return numbers.text();
}

std::vector<Variable> BodyAtlas::variables() const { return BodySpace(scene_).variables(); }

void BodyAtlas::validate(const AtlasGrid& grid) const {
  constexpr std::array<const char*, AtlasGrid::kAxes> kWhy = {"the base keeps this robot from falling",
                                                              "the base of this robot has no forward speed",
                                                              "a robot on a rail keeps the pitch of its scene"};
  scene_.validate();
  const Drop& d = scene_.drop;
  const std::array<double, AtlasGrid::kAxes> scene_values = {d.height, d.forward_speed, d.pitch};
  const auto has = axes_of(scene_.robot);
  for (std::size_t k = 0; k < scene_values.size(); ++k)
    if (!has[k] && !(grid.axes[k].stands() && grid.axes[k].lower == scene_values[k]))
      throw InputError(fmt::format("atlas: {}: {}", AtlasGrid::kNames[k], kWhy[k]));
  if (const int n = BodySpace(scene_).dimension(); n > kAtlasVariables)
    throw InputError(fmt::format("atlas: motions of {} variables: at most {} are needed", n, kAtlasVariables));
  if (!scene_.touches())
    throw InputError("atlas: no contact of the scene touches a floor: there is no landing to plan");
}

Scatter BodyAtlas::scatter(const std::optional<Scatter>& requested) const { return scatter_for(requested, scene_); }

long BodyAtlas::effort(const AtlasOptions& options) const {
  if (options.search.evaluations) return options.effort();
  return options.effort() * BodySpace(scene_).dimension() / kPaperVariables;
}

AtlasCell BodyAtlas::plan(const AtlasOptions& options, const AtlasTask& task) const {
  BodyScene scene = scene_;
  scene.drop = task.drop;
  const BodySpace space(scene);
  const std::function<bool()> over = [&options] { return options.monitor.stopped(); };
  BodyPlanOptions search;
  search.goal = options.search.goal, search.measure = options.robust.measure;
  search.scatter = scatter(options.robust.scatter), search.inflate = options.robust.inflate;
  search.samples = options.robust.samples, search.fresh = 0;
  search.evaluations = task.effort, search.seed = task.seed, search.threads = 1;
  search.monitor = {{}, options.monitor.stop};
  if (!task.starts.empty()) search.starts = best_starts(scene, space, task.starts, &over);
  return cell_of(scene, space, landing::plan(scene, search), options);
}

std::unique_ptr<AtlasTrial> BodyAtlas::trial(int threads, const std::function<bool()>& over) const {
  return std::make_unique<BodyTrial>(scene_, threads, over);
}

}  // namespace ukemi::landing
