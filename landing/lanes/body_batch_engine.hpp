// The landings of robots of links in lockstep, see lockstep.hpp: the robots of all lanes are one tree, whose numbers
// differ.
#pragma once

#include "landing/body/body_course.hpp"
#include "landing/body/body_rest.hpp"
#include "landing/body/load.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/lanes/body_batch_entry.hpp"
#include "landing/lanes/body_lane_mode.hpp"
#include "landing/lanes/lockstep.hpp"

namespace ukemi::landing {

template <Capacity kSize, int W>
class BodyBatchEngine : private Lockstep<BodyBatchEngine<kSize, W>, BodySystem<kSize, false, Pack<W>>, W> {
  using System = BodySystem<kSize, false, Pack<W>>;
  using Course = BodyCourse<kSize, false>;  ///< of one lane, in doubles
  using Engine = Lockstep<BodyBatchEngine, System, W>;
  friend Engine;
  using Engine::abandon_square_, Engine::active_, Engine::stale_, Engine::kStates;
  using Engine::system_, Engine::step_, Engine::h_next_, Engine::stop_, Engine::square_, Engine::t_peak_,
      Engine::steps_;
  using typename Engine::M, typename Engine::State, typename Engine::T;
  using Values = typename Course::State;

 public:
  BodyBatchEngine(BodyBatchSource& source, const BodyBatchOptions& options)
      : Engine(System(), options.accuracy, options.max_steps), source_(source), options_(options) {}
  void run() { this->run_all(source_); }

 private:
  /// Takes the next landing into a lane; landings that no lane can follow are ended on the spot.
  [[gnu::noinline]] void load(int i) {
    for (BodyBatchCase c;;) {
      active_.set(i, false);
      if (!source_.next(i, c)) return this->empty(i);
      case_[i] = c;
      if (!suits(*c.scene)) {
        hand_over(i);
        continue;
      }
      Course& course = course_[i].emplace(*c.scene, *c.motion);
      const Values y = course.released();
      if (system_.links == 0) system_.take_structure(course.system);
      if (!system_.same_structure(course.system) || course.step_accuracy(options_.accuracy) < options_.accuracy) {
        hand_over(i);
        continue;
      }
      out_[i] = {};
      System::for_each(system_, course.system, [i](T& lanes, double x) { lanes.set(i, x); });
      this->begin(i, 0, y, 1e-4, 0, [&](int k) { return course.system.tolerance_unit(k); });
      asked_[i] = 0, impact_[i] = impact_energy(course.system), per_square_.set(i, impact_[i]);
      const double abandon = c.abandon_above * own_rating(*c.scene);
      abandon_square_.set(i, abandon * abandon);
      follow(i);
      return;
    }
  }
  static bool suits(const BodyScene& scene) {
    if (observed(scene) || !scene.touches() || !scene.limits.joints.empty() || !fits(scene.robot, kSize)) return false;
    for (const ContactPoint& c : scene.robot.contacts)
      if (c.law.hunt_crossley) return false;
    for (const Joint& j : scene.robot.joints)
      if (j.sea.k_sea_cubic < 0) return false;
    return true;
  }

  /// The scalar path follows the lane's landing.
  void hand_over(int i) {
    const BodyBatchCase& c = case_[i];
    const BodyLanding l = peak_acceleration(*c.scene, *c.motion,
                                            {.accuracy = options_.accuracy,
                                             .abandon_above = c.abandon_above,
                                             .max_steps = options_.max_steps,
                                             .over = &over_});
    if (l.end != End::kStopped) source_.done(i, l);
  }

  [[gnu::noinline]] void finish(int i, End end) {
    if (end == End::kFailed && steps_[i] <= double(options_.max_steps)) {
      hand_over(i);
    } else {
      BodyLanding& out = out_[i];
      if (end == End::kFailed) out.failure = Failure::kSteps;
      out.end = end, out.t_end = step_.t[i], out.peak = std::sqrt(square_[i]), out.t_peak = t_peak_[i];
      out.first_touchdown = course_[i]->first_touchdown(), out.work.steps = long(steps_[i]);
      const Values y = values(i);
      const bool free = case_[i].scene->robot.base == Base::kFree;
      out.base = {y[System::kX], free ? y[System::kY] : 0}, out.speed = {y[System::kVx], free ? y[System::kVy] : 0};
      source_.done(i, out);
    }
    load(i);
  }

  Values values(int i) const {
    Values y;
    for (int k = 0; k < kStates; ++k) y[k] = step_.y[k][i];
    return y;
  }
  /// The lane into the mode of its course.
  void follow(int i) {
    const Course& course = *course_[i];
    system_.set_lane(i, course.system);
    System::for_each_played(system_, course.system, [i](T& lanes, double x) { lanes.set(i, x); });
    stop_.set(i, course.stop()), longest_.set(i, course.longest_step());
    h_next_.set(i, std::min(h_next_[i], course.longest_step()));
    stale_.set(i, true);
  }

  /// The mode beyond guard g; false where the landing ends there.
  [[gnu::noinline]] bool cross(int i, int g) {
    Course& course = *course_[i];
    const double t = step_.t[i];
    Values y = values(i);
    const typename Course::Crossing crossing = course.cross(g, t, y);
    for (int k = System::kSlip; k < kStates; ++k) step_.y[k].set(i, y[k]);
    const std::vector<bool>& forbidden = case_[i].scene->limits.forbidden;
    if (crossing.touched >= 0 && !forbidden.empty() && forbidden[std::size_t(crossing.touched)] && !out_[i].broken)
      out_[i].broken = {BrokenLimit::Kind::kForbidden, crossing.touched, t};
    if (crossing.lands) course.land(t);
    follow(i);
    return !(out_[i].broken && case_[i].scene->limits.broken == BodyLimits::Broken::kEnds);
  }

  /// The lane's step has ended at its deadline: the next one, or how the landing ended.
  [[gnu::noinline]] std::optional<End> reached(int i) {
    constexpr double kRounding = 1e-14;  // [s]
    Course& course = *course_[i];
    const double t = step_.t[i];
    if (t + kRounding >= course.limit()) return course.touched() ? End::kTimeLimit : End::kNoContact;
    if (course.lands_at(t)) course.land(t);
    course.advance(t);
    follow(i);
    return std::nullopt;
  }

  // --- every lane at once ---

  UKEMI_INLINE static T peak_square(const System& s, const State& y, const State& dy) { return s.peak_square(y, dy); }
  void peak_moved(int) {}
  UKEMI_INLINE const T& longest_step() const { return longest_; }
  void stepped() {}
  M breaking(const M&) const { return M(false); }
  /// Lanes at rest, where the step ended at no event: the rule of body_rest.hpp, where the kinetic energy allows it.
  UKEMI_INLINE M resting(const M& plain) {
    auto p = system_.pose(step_.y);
    if (system_.body.base == Base::kFree) p.vx = T(0.0);
    constexpr long kAsked = 8;  // steps of a lane between two questions, which cost as much as the steps of all lanes
    M out = plain & (kinetic_energy(system_.body, p) <= per_square_ * square_);
    if (!any(out)) return out;
    for (int i = 0; i < W; ++i)
      if (out[i]) {
        const bool ask = steps_[i] >= asked_[i] + kAsked;
        if (ask) asked_[i] = steps_[i];
        out.set(i, ask && rests(i));
      }
    return out;
  }
  [[gnu::noinline]] bool rests(int i) const {
    const Course& course = *course_[i];
    return course.touched() && !course.waits() && at_rest(course.system, step_.t[i], values(i), square_[i], impact_[i]);
  }

  BodyBatchSource& source_;
  const BodyBatchOptions options_;
  const std::function<bool()> over_ = [this] { return source_.over(); };
  T longest_{0.0}, per_square_{0.0};
  std::array<double, W> impact_{}, asked_{};  ///< energies of impact [J]; steps at the last question for rest
  std::array<std::optional<Course>, W> course_{};
  std::array<BodyBatchCase, W> case_{};
  std::array<BodyLanding, W> out_{};
};

}  // namespace ukemi::landing
