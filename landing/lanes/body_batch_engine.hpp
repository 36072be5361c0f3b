// The landings of robots of links in lockstep, see lockstep.hpp: the robots of all lanes are one tree, whose numbers
// differ.
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
  static constexpr bool kMayRub = true;  ///< there may be dry friction
  using Engine::abandon_square_, Engine::active_, Engine::stale_, Engine::kStates;
  using Engine::system_, Engine::step_, Engine::h_next_, Engine::stop_, Engine::peak_, Engine::steps_,
      Engine::accepted_, Engine::shift_;
  using typename Engine::Largest;
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
      Values y = course.released();
      if (system_.links == 0) system_.take_structure(course.system);
      const std::vector<LaneLoad> loads = loads_of_lanes(*c.scene);
      if (!any(active_)) loads_ = loads;
      if (!system_.same_structure(course.system) || !same_loads(loads) ||
          course.step_accuracy(options_.accuracy) < options_.accuracy) {
        hand_over(i);
        continue;
      }
      out_[i] = {};
      System::for_each(system_, course.system, [i](T& lanes, double x) { lanes.set(i, x); });
      const double fallen = course.fall(y);
      this->begin(i, fallen, y, 1e-4, 0, [&](int k) { return course.system.tolerance_unit(k); });
      asked_[i] = 0, impact_[i] = impact_energy(course.system), per_square_.set(i, impact_[i]);
      const double abandon = c.abandon_above * own_rating(*c.scene);
      abandon_square_.set(i, abandon * abandon);
      bear(i, loads);
      enter(i);
      return;
    }
  }
  static bool suits(const BodyScene& scene) {
    if (!scene.touches() || !fits(scene.robot, kSize)) return false;
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
      out.end = end, out.t_end = step_.t[i], out.peak = std::sqrt(peak_.square[i]), out.t_peak = peak_.t[i];
      out.first_touchdown = course_[i]->first_touchdown(), out.first_contact = course_[i]->first_contact();
      out.work.steps = long(steps_[i]);
      const Values y = values(i);
      const bool free = case_[i].scene->robot.base == Base::kFree;
      out.base = {y[System::kX], free ? y[System::kY] : 0}, out.speed = {y[System::kVx], free ? y[System::kVy] : 0};
      tell_loads(i);
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
  void enter(int i) {
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
    if (crossing.touched >= 0)
      touched(i, crossing.touched);
    else if (crossing.surface)
      lifted(i, g / System::kOfContact);
    if (crossing.lands) land(i);
    settle(i, y);
    enter(i);
    return !(out_[i].broken && case_[i].scene->ends_broken);
  }

  /// What friction no longer holds slips; the lane's rates and slips from y.
  void settle(int i, Values& y) {
    course_[i]->settle(step_.t[i], y);
    for (int k = System::kVx; k < kStates; ++k) step_.y[k].set(i, y[k]);
  }

  /// The lane's step has ended at its deadline: the next one, or how the landing ended.
  [[gnu::noinline]] std::optional<End> reached(int i) {
    constexpr double kRounding = 1e-14;  // [s]
    Course& course = *course_[i];
    const double t = step_.t[i];
    if (t + kRounding >= course.limit()) return course.touched() ? End::kTimeLimit : End::kNoContact;
    if (course.lands_at(t)) {
      Values y = values(i);
      land(i), settle(i, y);
    }
    if (out_[i].broken && case_[i].scene->ends_broken) return End::kBroken;
    course.advance(t);
    enter(i);
    return std::nullopt;
  }

  // --- loads, as load_observer.hpp ---

  /// Of all lanes: one that has its value at every state, or an impulse, whose largest value is that of touches that
  /// have ended.
  struct alignas(8 * W) LaneLoad {  // for what is compiled for wider registers than the allocation
    LoadValue<System> of;
    int index;  ///< of BodyScene::loads
    bool own = false;
    Largest largest{};
    T most{0.0};  ///< square of what is tracked beyond which a limit is broken, or the landing worse than is asked for
    M down{false};                              ///< a touch gathers its impulse:
    std::array<T, 2> gathered{T(0.0), T(0.0)};  ///< [N s]
    const Load& load() const { return of.load(); }
    bool is_impulse() const { return load().kind == Load::Kind::kImpulse; }
    bool is_followed() const { return !own && !is_impulse(); }
  };
  std::vector<LaneLoad> loads_of_lanes(const BodyScene& scene) const {
    std::vector<LaneLoad> out;
    for (std::size_t k = 0; k < scene.loads.size(); ++k) {
      const Load& l = scene.loads[k];
      if (at_every_state(l.kind) || l.kind == Load::Kind::kImpulse)
        out.push_back({.of{l, system_}, .index = int(k), .own = own(l, scene.robot)});
    }
    return out;
  }
  /// Whether loads differ from those of the other lanes by their ratings alone.
  bool same_loads(const std::vector<LaneLoad>& other) const {
    return std::equal(loads_.begin(), loads_.end(), other.begin(), other.end(), [](auto& a, auto& b) {
      const Load &x = a.load(), &y = b.load();
      return x.kind == y.kind && x.index == y.index && x.phi == y.phi && x.at.along == y.at.along &&
             x.at.across == y.at.across && a.index == b.index && x.limit == y.limit;
    });
  }
  /// The loads of a landing that begins in a lane.
  void bear(int i, const std::vector<LaneLoad>& these) {
    for (std::size_t k = 0; k < loads_.size(); ++k) {
      LaneLoad& x = loads_[k];
      x.of.take_arms(LoadValue<typename Course::System>(x.load(), course_[i]->system),
                     [i](T& lanes, double number) { lanes.set(i, number); });
      const double rating = these[k].load().rating,
                   most = tracked(x.load(), x.load().limit ? rating : case_[i].abandon_above * rating);
      x.most.set(i, most * most);
      x.largest.square.set(i, 0), x.largest.t.set(i, 0), x.largest.start.set(i, 0), x.down.set(i, false);
    }
    out_[i].loads.assign(case_[i].scene->loads.size(), {});
  }
  void tell_loads(int i) {
    for (LaneLoad& x : loads_) end_touch(i, x);
    for (const LaneLoad& x : loads_)
      out_[i].loads[std::size_t(x.index)] = x.own
                                                ? LoadPeak{out_[i].peak, out_[i].t_peak}
                                                : LoadPeak{x.of.value(std::sqrt(x.largest.square[i])), x.largest.t[i]};
  }
  void touched(int i, int contact) {
    for (LaneLoad& x : loads_)
      if (x.is_impulse() && x.load().index == contact)
        x.down.set(i, true), x.gathered[0].set(i, 0), x.gathered[1].set(i, 0);
    const std::vector<Load>& loads = case_[i].scene->loads;
    for (std::size_t k = 0; k < loads.size(); ++k) {
      if (loads[k].kind != Load::Kind::kTouch || loads[k].index != contact) continue;
      if (out_[i].loads[k].value == 0) out_[i].loads[k] = {1, step_.t[i]};
      if (loads[k].rating < 1) broken(i, {int(k), step_.t[i]});
    }
  }
  void lifted(int i, int contact) {
    for (LaneLoad& x : loads_)
      if (x.is_impulse() && x.load().index == contact) end_touch(i, x);
  }
  void end_touch(int i, LaneLoad& x) {
    if (!x.down[i]) return;
    const double square = x.gathered[0][i] * x.gathered[0][i] + x.gathered[1][i] * x.gathered[1][i];
    x.down.set(i, false);
    if (square > x.largest.square[i]) x.largest.square.set(i, square), x.largest.t.set(i, step_.t[i]);
    if (x.load().limit && square > x.most[i]) broken(i, {x.index, step_.t[i]});
  }
  /// The landing motions start.
  void land(int i) {
    const double t = step_.t[i];
    const std::vector<Load>& loads = case_[i].scene->loads;
    for (std::size_t k = 0; k < loads.size(); ++k) {
      if (loads[k].kind != Load::Kind::kReferenceRate) continue;
      const double rate = peak_reference_rate((*case_[i].motion)[std::size_t(loads[k].index)], t);
      out_[i].loads[k] = {rate, t};
      if (rate > loads[k].rating) broken(i, {int(k), t});
    }
    course_[i]->land(t);
  }
  void broken(int i, const BrokenLimit& what) {
    if (!out_[i].broken) out_[i].broken = what;
  }
  double rest_square(int i) const {
    RestSquare out(peak_.square[i]);
    for (const LaneLoad& x : loads_) {
      if (x.down[i]) return -1;
      if (x.is_followed())
        out.add(x.load().kind, large_square(x.load(), x.largest.square[i], x.most[i]), x.largest.start[i]);
    }
    return out.value();
  }

  // --- every lane at once ---

  void start_beside(const M& where) {
    if (!loads_.empty()) start_loads(where);
  }
  void look_beside() {
    if (!loads_.empty()) look_at_loads();
  }
  UKEMI_BATCH_STAGE void start_loads(const M& where) {
    for (LaneLoad& x : loads_)
      if (x.is_followed()) this->follow_start(x.largest, where, x.of.square(system_, step_.t, step_.y, step_.slope));
  }
  UKEMI_BATCH_STAGE void look_at_loads() {
    for (LaneLoad& x : loads_) {
      if (x.is_impulse()) gather(x);
      if (x.is_followed())
        this->follow(x.largest, [this, &x](const T& t, const State& y, const State& dy)
                                    UKEMI_INLINE_LAMBDA { return x.of.square(system_, t, y, dy); });
    }
  }
  /// The accepted steps' parts of the integral of the force, up to their events.
  UKEMI_INLINE void gather(LaneLoad& x) {
    const M where = accepted_ & x.down;
    if (!any(where)) return;
    const T part = T(1.0) + shift_ / max(step_.h, T(1e-12)), h = step_.h + shift_;
    for (const auto& [at, weight] : kImpulseNodes) {
      const State y = step_.at(T(at) * part);
      const Vec2<T> f = contact_force(system_, x.load().index, system_.pose(y), y);
      for (const std::size_t q : {0, 1}) assign(x.gathered[q], where, T(x.gathered[q] + T(weight) * h * f[long(q)]));
    }
  }
  M beyond(const M& where) const {
    M out = where & (peak_.square > abandon_square_);
    for (const LaneLoad& x : loads_)
      if (!x.load().limit && !x.own) out |= where & (x.largest.square > x.most);
    return out;
  }
  /// Lanes whose landing ends there.
  M breaking(const M& where) {
    M out(false);
    for (const LaneLoad& x : loads_) {
      if (!x.load().limit) continue;
      const M more = where & ((x.own ? peak_.square : x.largest.square) > x.most);
      if (!any(more)) continue;
      for (int i = 0; i < W; ++i)
        if (more[i]) broken(i, {x.index, step_.t[i]});
    }
    for (int i = 0; i < W && !loads_.empty(); ++i)
      if (where[i] && out_[i].broken && case_[i].scene->ends_broken) out.set(i, true);
    return out;
  }

  UKEMI_INLINE static T peak_square(const System& s, const State& y, const State& dy) { return s.peak_square(y, dy); }
  void peak_moved(int) {}
  UKEMI_INLINE const T& longest_step() const { return longest_; }
  void stepped() {}
  /// Lanes at rest, where the step ended at no event: the rule of body_rest.hpp, where the kinetic energy allows it.
  UKEMI_INLINE M resting(const M& plain) {
    auto p = system_.pose(step_.y);
    if (system_.body.base == Base::kFree) p.vx = T(0.0);
    constexpr long kAsked = 8;  // steps of a lane between two questions, which cost as much as the steps of all lanes
    M out = plain & (kinetic_energy(system_.body, p) <= per_square_ * peak_.square);
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
    return course.touched() && !course.waits() &&
           at_rest(course.system, step_.t[i], values(i), rest_square(i), impact_[i]);
  }

  BodyBatchSource& source_;
  const BodyBatchOptions options_;
  const std::function<bool()> over_ = [this] { return source_.over(); };
  T longest_{0.0}, per_square_{0.0};
  std::array<double, W> impact_{}, asked_{};  ///< energies of impact [J]; steps at the last question for rest
  std::array<std::optional<Course>, W> course_{};
  std::array<BodyBatchCase, W> case_{};
  std::array<BodyLanding, W> out_{};
  std::vector<LaneLoad> loads_;  ///< of the landings in the lanes
};

}  // namespace ukemi::landing
