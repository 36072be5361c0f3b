// The landings of robots of links in lockstep, see lockstep.hpp: robots of the same tree with different numbers.
#pragma once

#include "landing/body/body_course.hpp"
#include "landing/body/body_rest.hpp"
#include "landing/body/load.hpp"
#include "landing/body/load_value.hpp"
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
  static constexpr bool kMayHaveFriction = !System::kPlainDrives;  ///< dry friction is possible
  using Engine::abandon_square_, Engine::active_, Engine::stale_, Engine::kStates;
  using Engine::system_, Engine::step_, Engine::h_next_, Engine::stop_, Engine::peak_, Engine::steps_,
      Engine::accepted_, Engine::shift_;
  using typename Engine::M, typename Engine::State, typename Engine::T;
  using typename Engine::RunningMaximum;
  using Values = typename Course::State;

 public:
  BodyBatchEngine(BodyBatchSource& source, const Robot& robot, const BodyBatchOptions& options)
      : Engine(System(), options.accuracy, options.max_steps), source_(source), options_(options) {
    system_.copy_structure(typename Course::System(robot, 0));
    system_.shaped = false;
  }
  void run() { this->run_all(source_); }

 private:
  /// Starts the next landing in lane i; unsupported landings run in the scalar path.
  [[gnu::noinline]] void load(int i) {
    for (BodyBatchCase c;;) {
      active_.set(i, false);
      if (!source_.next(i, c)) return this->clear_lane(i);
      case_[i] = c;
      if (!is_supported(*c.scene)) {
        hand_over(i);
        continue;
      }
      Course& course = course_[i].emplace(*c.scene, *c.motion);
      const Values y = course.released();
      system_.shaped = system_.shaped || course.system.shaped;
      const std::vector<LaneLoad> loads = loads_of_lanes(*c.scene);
      if (!any(active_)) loads_ = loads;
      if (!system_.same_structure(course.system) || !same_loads(loads) ||
          course.step_accuracy(options_.accuracy) < options_.accuracy) {
        hand_over(i);
        continue;
      }
      out_[i] = {};
      System::for_each(system_, course.system, [i](T& lanes, double x) { lanes.set(i, x); });
      const typename Course::Fall fall = course.fall(y);
      this->begin(i, fall.until, fall.at(fall.until), fall.first_step(), 0,
                  [&](int k) { return course.system.tolerance_unit(k); });
      joint_lost_.set(i, false);
      rest_test_[i].restart(), rest_energy_[i] = {course.system, options_.accuracy};
      per_square_.set(i, rest_energy_[i].per_square), unresolved_.set(i, rest_energy_[i].unresolved);
      const double abandon = c.abandon_above * peak_rating(*c.scene);
      abandon_square_.set(i, abandon * abandon);
      init_loads(i, loads);
      sync_lane(i);
      return;
    }
  }
  static bool is_supported(const BodyScene& scene) {
    if (!scene.touches() || !fits(scene.robot, kSize)) return false;
    for (const ContactPoint& c : scene.robot.contacts)
      if (c.law.hunt_crossley) return false;
    for (const Joint& j : scene.robot.joints)
      if (j.sea.k_sea_cubic < 0) return false;
    return true;
  }

  /// Runs the lane's landing in the scalar path.
  void hand_over(int i) {
    const BodyBatchCase& c = case_[i];
    const BodyLanding l = peak_of_valid(*c.scene, *c.motion,
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
      out.end = end, out.t_end = step_.t[i], out.peak = std::sqrt(peak_.square[i]), out.t_peak = peak_.t[i];
      out.work.steps = long(steps_[i]), out.joint_lost = joint_lost_[i];
      const Values y = values(i);
      const bool free = case_[i].scene->robot.base == Base::kFree;
      out.base = {y[System::kX], free ? y[System::kY] : 0}, out.speed = {y[System::kVx], free ? y[System::kVy] : 0};
      report_loads(i);
      source_.done(i, out);
    }
    load(i);
  }

  Values values(int i) const {
    Values y;
    for (int k = 0; k < kStates; ++k) y[k] = step_.y[k][i];
    return y;
  }
  /// Copies mode, references and deadlines of the lane's course into the lane.
  void sync_lane(int i) {
    const Course& course = *course_[i];
    system_.set_lane(i, course.system);
    System::for_each_scheduled(system_, course.system, [i](T& lanes, double x) { lanes.set(i, x); });
    stop_.set(i, course.stop()), longest_.set(i, course.longest_step());
    h_next_.set(i, std::min(h_next_[i], course.longest_step()));
  }

  /// Changes the mode at guard g; false if the landing ends there.
  [[gnu::noinline]] bool cross(int i, int g) {
    Course& course = *course_[i];
    const double t = step_.t[i];
    Values y = values(i);
    const typename Course::Crossing crossing = course.cross(g, t, y);
    if (crossing.touched >= 0)
      touched(i, crossing.touched);
    else if (crossing.surface)
      lifted(i, g / System::kGuardsPerContact);
    if (crossing.lands) land(i);
    settle(i, y);
    sync_lane(i), stale_.set(i, true);
    return !(out_[i].broken && case_[i].scene->ends_broken);
  }

  /// Lets places slip that friction no longer holds; writes the rates and slips of y to the lane.
  void settle(int i, Values& y) {
    course_[i]->settle(step_.t[i], y);
    for (int k = System::kVx; k < kStates; ++k) step_.y[k].set(i, y[k]);
  }

  /// Handles the deadline at the end of a step; returns how the landing ended, if it did.
  [[gnu::noinline]] std::optional<End> reached(int i) {
    constexpr double kRounding = 1e-14;  // [s]
    Course& course = *course_[i];
    const double t = step_.t[i];
    if (t + kRounding >= course.limit()) return course.touched() ? End::kTimeLimit : End::kNoContact;
    if (course.lands_at(t)) {
      Values y = values(i);
      land(i), settle(i, y), stale_.set(i, true);  // at other deadlines the field does not jump
    }
    if (out_[i].broken && case_[i].scene->ends_broken) return End::kBroken;
    course.advance(t);
    sync_lane(i);
    return std::nullopt;
  }

  // --- loads, as load_observer.hpp ---

  /// A load in all lanes: a function of the state, or an impulse, whose maximum is over the touches that have ended.
  struct alignas(8 * W) LaneLoad {  // the allocation may be compiled for narrower registers
    LoadValue<System> evaluator;
    int index;  ///< of BodyScene::loads
    bool is_peak = false;
    RunningMaximum maximum{};
    T max_square{0.0};  ///< of the tracked quantity: beyond it a limit is broken, or the landing abandoned
    M touching{false};  ///< a touch is under way
    std::array<T, 2> impulse{T(0.0), T(0.0)};  ///< [N s]
    const Load& load() const { return evaluator.load(); }
    bool is_impulse() const { return load().kind == Load::Kind::kImpulse; }
    bool is_tracked() const { return !is_peak && !is_impulse(); }
  };
  std::vector<LaneLoad> loads_of_lanes(const BodyScene& scene) const {
    std::vector<LaneLoad> out;
    for (std::size_t k = 0; k < scene.loads.size(); ++k) {
      const Load& l = scene.loads[k];
      if (is_state_function(l.kind) || l.kind == Load::Kind::kImpulse)
        out.push_back({.evaluator{l, system_}, .index = int(k), .is_peak = is_peak_acceleration(l, scene.robot)});
    }
    return out;
  }
  /// Whether loads differ from those of the other lanes only in their ratings.
  bool same_loads(const std::vector<LaneLoad>& other) const {
    return std::equal(loads_.begin(), loads_.end(), other.begin(), other.end(), [](auto& a, auto& b) {
      const Load &x = a.load(), &y = b.load();
      return x.kind == y.kind && x.index == y.index && x.phi == y.phi && x.at.along == y.at.along &&
             x.at.across == y.at.across && a.index == b.index && x.limit == y.limit;
    });
  }
  /// Initialises the loads of a landing that starts in lane i.
  void init_loads(int i, const std::vector<LaneLoad>& loads) {
    for (std::size_t k = 0; k < loads_.size(); ++k) {
      LaneLoad& x = loads_[k];
      x.evaluator.copy_arms(LoadValue<typename Course::System>(x.load(), course_[i]->system),
                            [i](T& lanes, double number) { lanes.set(i, number); });
      const double rating = loads[k].load().rating,
                   threshold =
                       tracked_value(x.load(), x.load().limit ? rating_limit(loads[k].load(), case_[i].scene->robot)
                                                              : case_[i].abandon_above * rating);
      x.max_square.set(i, threshold * threshold);
      x.maximum.square.set(i, 0), x.maximum.t.set(i, 0), x.maximum.start.set(i, 0), x.touching.set(i, false);
    }
    out_[i].loads.assign(case_[i].scene->loads.size(), {});
  }
  void report_loads(int i) {
    for (LaneLoad& x : loads_) end_touch(i, x);
    for (const LaneLoad& x : loads_)
      out_[i].loads[std::size_t(x.index)] =
          x.is_peak ? LoadPeak{out_[i].peak, out_[i].t_peak}
                    : LoadPeak{x.evaluator.value(std::sqrt(x.maximum.square[i])), x.maximum.t[i]};
  }
  void touched(int i, int contact) {
    out_[i].contacts.touchdown(contact, step_.t[i]);
    for (LaneLoad& x : loads_)
      if (x.is_impulse() && x.load().index == contact)
        x.touching.set(i, true), x.impulse[0].set(i, 0), x.impulse[1].set(i, 0);
    const std::vector<Load>& loads = case_[i].scene->loads;
    for (std::size_t k = 0; k < loads.size(); ++k) {
      if (loads[k].kind != Load::Kind::kTouch || loads[k].index != contact) continue;
      if (out_[i].loads[k].value == 0) out_[i].loads[k] = {1, step_.t[i]};
      if (loads[k].rating < 1) broken(i, {int(k), step_.t[i]});
    }
  }
  void lifted(int i, int contact) {
    out_[i].contacts.liftoff(contact, step_.t[i]);
    for (LaneLoad& x : loads_)
      if (x.is_impulse() && x.load().index == contact) end_touch(i, x);
  }
  void end_touch(int i, LaneLoad& x) {
    if (!x.touching[i]) return;
    const double square = x.impulse[0][i] * x.impulse[0][i] + x.impulse[1][i] * x.impulse[1][i];
    x.touching.set(i, false);
    if (square > x.maximum.square[i]) x.maximum.square.set(i, square), x.maximum.t.set(i, step_.t[i]);
    if (x.load().limit && square > x.max_square[i]) broken(i, {x.index, step_.t[i]});
  }
  /// Starts the landing motions.
  void land(int i) {
    const double t = step_.t[i];
    const std::vector<Load>& loads = case_[i].scene->loads;
    for (std::size_t k = 0; k < loads.size(); ++k) {
      if (loads[k].kind != Load::Kind::kReferenceRate) continue;
      const double rate = peak_reference_rate((*case_[i].motion)[std::size_t(loads[k].index)], t);
      out_[i].loads[k] = {rate, t};
      if (rate > rating_limit(loads[k].rating)) broken(i, {int(k), t});
    }
    course_[i]->land(t);
  }
  void broken(int i, const BrokenLimit& what) {
    if (!out_[i].broken) out_[i].broken = what;
  }
  double rest_square(int i) const {
    RestSquare out(peak_.square[i]);
    for (const LaneLoad& x : loads_) {
      if (x.touching[i]) return -1;
      if (x.is_tracked())
        out.add(x.load().kind, reference_square(x.load(), x.maximum.square[i], x.max_square[i]), x.maximum.start[i]);
    }
    return out.value();
  }

  // --- every lane at once ---

  void start_other_maxima(const M& where) {
    if (!loads_.empty()) start_loads(where);
  }
  void track_other_maxima() {
    if (!loads_.empty()) track_loads();
  }
  UKEMI_BATCH_STAGE void start_loads(const M& where) {
    for (LaneLoad& x : loads_)
      if (x.is_tracked())
        this->track_start(x.maximum, where, x.evaluator.square(system_, step_.t, step_.y, step_.slope));
  }
  UKEMI_BATCH_STAGE void track_loads() {
    for (LaneLoad& x : loads_) {
      if (x.is_impulse()) integrate_impulse(x);
      if (x.is_tracked())
        this->track(x.maximum, [this, &x](const T& t, const State& y, const State& dy)
                                   UKEMI_INLINE_LAMBDA { return x.evaluator.square(system_, t, y, dy); });
    }
  }
  /// Adds the integrals of the force over the accepted steps, up to their events.
  UKEMI_INLINE void integrate_impulse(LaneLoad& x) {
    const M where = accepted_ & x.touching;
    if (!any(where)) return;
    const T part = T(1.0) + shift_ / max(step_.h, T(1e-12)), h = step_.h + shift_;
    for (const auto& [at, weight] : kImpulseNodes) {
      const State y = step_.at(T(at) * part);
      const Vec2<T> f = contact_force(system_, x.load().index, system_.pose(y), y);
      for (const std::size_t q : {0, 1}) assign(x.impulse[q], where, T(x.impulse[q] + T(weight) * h * f[long(q)]));
    }
  }
  M abandoned(const M& where) const {
    M out = where & (peak_.square > abandon_square_);
    for (const LaneLoad& x : loads_)
      if (!x.load().limit && !x.is_peak) out |= where & (x.maximum.square > x.max_square);
    return out;
  }
  /// Records broken limits; lanes whose landing ends by one.
  M breaking(const M& where) {
    M out(false);
    for (const LaneLoad& x : loads_) {
      if (!x.load().limit) continue;
      const M exceeded = where & ((x.is_peak ? peak_.square : x.maximum.square) > x.max_square);
      if (!any(exceeded)) continue;
      for (int i = 0; i < W; ++i)
        if (exceeded[i]) broken(i, {x.index, step_.t[i]});
    }
    for (int i = 0; i < W && !loads_.empty(); ++i)
      if (where[i] && out_[i].broken && case_[i].scene->ends_broken) out.set(i, true);
    return out;
  }

  UKEMI_INLINE static T peak_square(const System& s, const State& y, const State& dy) { return s.peak_square(y, dy); }
  void peak_raised(int i) { out_[i].peak_contact = out_[i].contacts.size() - 1; }
  /// Lanes whose steps are so short that they may be stiff: the scalar path, which may go implicit, runs them.
  UKEMI_INLINE M given_up() const {
    constexpr double kPatience = 5'000, kShortest = 1e-4;  // steps; their mean length [s]
    return (steps_ > T(kPatience)) & (step_.t < T(kShortest) * steps_);
  }
  UKEMI_INLINE const T& longest_step() const { return longest_; }
  UKEMI_INLINE void stepped() { joint_lost_ |= accepted_ & system_.lost_joint(step_.y); }
  /// Lanes at rest among `no_event`, by the rule of body_rest.hpp; motions and the kinetic energy are checked first.
  UKEMI_INLINE M resting(const M& no_event) {
    M out = no_event;
    for (int i = 0; i < system_.body.joints; ++i) out &= !moving(system_.joint[i].phase);
    if (!any(out)) return out;
    auto p = system_.pose(step_.y);
    if (system_.body.base == Base::kFree) p.vx = T(0.0);
    const T energy = kinetic_energy(system_.body, p);
    out &= (energy <= per_square_ * peak_.square) | (energy <= unresolved_);
    if (!any(out)) return out;
    for (int i = 0; i < W; ++i)
      if (out[i]) out.set(i, rest_test_[i].due(steps_[i]) && rests(i));
    return out;
  }
  [[gnu::noinline]] bool rests(int i) {
    const Course& course = *course_[i];
    return course.touched() && !course.detecting() &&
           rest_test_[i](steps_[i], course.system, step_.t[i], values(i), rest_energy_[i](rest_square(i)));
  }

  BodyBatchSource& source_;
  const BodyBatchOptions options_;
  const std::function<bool()> over_ = [this] { return source_.over(); };
  M joint_lost_;
  T longest_{0.0}, per_square_{0.0}, unresolved_{0.0};
  std::array<RestEnergy, W> rest_energy_{};
  std::array<RestTest, W> rest_test_{};
  std::array<std::optional<Course>, W> course_{};
  std::array<BodyBatchCase, W> case_{};
  std::array<BodyLanding, W> out_{};
  std::vector<LaneLoad> loads_;  ///< of the landings in the lanes
};

}  // namespace ukemi::landing
