// The landings of the paper's robot in lockstep, see lockstep.hpp.
#pragma once

#include <algorithm>

#include "landing/lanes/batch.hpp"
#include "landing/lanes/batch_source.hpp"
#include "landing/lanes/lane_mode.hpp"
#include "landing/lanes/lockstep.hpp"
#include "landing/run/rest.hpp"
#include "landing/run/schedule.hpp"

namespace ukemi::landing {

template <LandingTerms kTerms, int W>
class BatchEngine : private Lockstep<BatchEngine<kTerms, W>, LandingSystem<kTerms, false, Pack<W>>, W> {
  using System = LandingSystem<kTerms, false, Pack<W>>;
  using Single = LandingSystem<kTerms, false, double>;
  using Base = Lockstep<BatchEngine, System, W>;
  friend Base;
  static constexpr bool kMayHaveFriction = kTerms.sea.extended;  ///< dry friction is possible
  using Base::abandon_square_, Base::active_, Base::stale_, Base::accepted_, Base::kStates;
  using Base::system_, Base::step_, Base::h_next_, Base::stop_, Base::peak_, Base::steps_;
  using typename Base::M, typename Base::State, typename Base::T;

 public:
  BatchEngine(BatchSource& source, const BatchOptions& options)
      : Base(System{TwoLink<T>{{T(1.0), T(1.0)}, {T(1.0), T(1.0)}, T(1.0), T(0.0)}, Floor<T>{T(1.0), T(0.0), T(0.0)},
                    SeaParameters<T>{T(0.0), T(0.0), T(0.0), T(0.0), T(1.0)}, MotionOf<T>{T(0.0), T(0.0), T(1.0)}},
             options.accuracy, options.max_steps),
        source_(source),
        options_(options) {
    system_.sea.feedback = options.feedback;
  }
  void run() { this->run_all(source_); }

 private:
  /// Starts the next landing in lane i; those without integration end at once, unsupported ones run scalar.
  [[gnu::noinline]] void load(int i) {
    for (BatchCase c;;) {
      active_.set(i, false);
      if (!source_.next(i, c)) return this->clear_lane(i);
      case_[i] = c;
      const Scene& scene = *c.scene;
      if (!scene.touches() || (is_extended(*c.sea) && !kTerms.sea.extended) || (is_late(*c.sea) && !kTerms.sea.late) ||
          c.sea->feedback != options_.feedback || c.sea->k_sea_cubic < 0 || needs_fine_steps(*c.sea)) {
        hand_over(i);
        continue;
      }
      Single single(scene, *c.sea, c.motion);
      auto y = released(single, scene, scene.drop, c.motion);
      Schedule& schedule = schedule_[i] = Schedule(scene, c.motion, moves(c.motion));
      LandingPeak& out = out_[i] = {};
      const double t = schedule.start(), g = scene.robot.gravity;
      if (schedule.ballistic()) fly(single, scene, t, y);
      if (schedule.ends_in_flight()) {
        out.end = End::kNoContact, out.t_end = t, out.peak = g, std::copy_n(y.data(), kMechanical, out.state.begin());
        source_.done(i, out);
        continue;
      }
      const auto set = [i](T& lanes, double x) { lanes.set(i, x); };
      TwoLinkDynamics<T>::for_each(system_.link, single.link, set);
      Floor<T>::for_each(system_.floor, single.floor, set);
      SeaParameters<T>::for_each(system_.sea, single.sea, set);
      if constexpr (kTerms.sea.late) system_.lag = typename System::Lag(system_.sea);
      system_.shaped = system_.shaped || has_bumps(c.motion);
      single.change(schedule.initial_change(single), c.motion, t);
      single.settle(t, y);
      ReferencePiece<T>::for_each(system_.piece, single.piece, set);
      for (int j = 0; j < kPoints; ++j) system_.present[j].set(i, single.present[j]);
      for (int j = 0; j < kSides; ++j) system_.has_friction[j].set(i, single.has_friction[j]);
      system_.set_lane(i, single);
      this->begin(i, t, y, schedule.first_step(), schedule.ballistic() ? g * g : 0,
                  [&](int k) { return single.tolerance_unit(k); });
      rest_scale_.set(i, impact_energy(single)), joint_lost_.set(i, false);
      stop_.set(i, schedule.stop()), motion_max_step_.set(i, schedule.motion_max_step());
      abandon_square_.set(i, c.abandon_above * c.abandon_above);
      return;
    }
  }

  /// Runs the lane's landing in the scalar path.
  void hand_over(int i) {
    const BatchCase& c = case_[i];
    const LandingPeak peak = peak_acceleration(
        *c.scene, *c.sea, c.motion,
        {.accuracy = options_.accuracy,
         .abandon_above = c.abandon_above,
         .max_steps = options_.on_max_steps == BatchOptions::OnMaxSteps::kFail ? options_.max_steps
                                                                               : SimulateOptions{}.max_steps,
         .limits = options_.limits,
         .over = &over_});
    if (peak.end != End::kStopped) source_.done(i, peak);
  }

  [[gnu::noinline]] void finish(int i, End end) {
    LandingPeak& out = out_[i];
    if (end == End::kFailed && options_.on_max_steps == BatchOptions::OnMaxSteps::kScalar) {
      hand_over(i);
    } else {
      if (end == End::kFailed) out.failure = Failure::kSteps;
      out.end = end, out.t_end = step_.t[i], out.peak = std::sqrt(peak_.square[i]), out.t_peak = peak_.t[i];
      out.work.steps = long(steps_[i]), out.joint_lost = joint_lost_[i];
      for (int k = 0; k < kMechanical; ++k) out.state[std::size_t(k)] = step_.y[k][i];
      source_.done(i, out);
    }
    load(i);
  }

  /// Changes the mode at guard g; false if the landing ends there.
  [[gnu::noinline]] bool cross(int i, int g) {
    const double t = step_.t[i];
    Mode mode = system_.lane(i);
    const Schedule::Crossing crossing = schedule_[i].cross(g, t, mode, options_.limits, out_[i].contacts);
    if (crossing.forbidden) return false;
    system_.set_lane(i, mode);
    stale_.set(i, true);
    if (crossing.first && !change(i, crossing.change)) return false;
    settle(i, g);
    return true;
  }

  /// LandingSystem::settle for one lane.
  void settle(int i, int event) {
    if constexpr (!kTerms.sea.extended) return;
    if (!system_.has_friction[kOutputSide][i] && !system_.has_friction[kMotorSide][i]) return;
    if (event >= kLandingGuards && system_.stuck(Mode::side_of(event))[i]) {
      const bool motor = Mode::side_of(event) == kMotorSide;
      step_.y[motor ? kOmegaM : kOmega1].set(i, motor ? 0 : step_.y[kOmega0][i]);
    }
    const std::array<Hold<T>, kSides> hold = system_.holds(step_.t, step_.y);
    for (const Side side : {kOutputSide, kMotorSide})
      if (system_.stuck(side)[i])
        system_.slip[side].set(i, breakaway_direction(hold[side].margin_up()[i], hold[side].margin_down()[i]));
  }

  /// LandingSystem::change for one lane, and its next deadline. False if the change breaks a limit.
  [[gnu::noinline]] bool change(int i, ReferenceChange to) {
    stop_.set(i, schedule_[i].stop());
    if (to == ReferenceChange::kNone || to == ReferenceChange::kHoldFinal) return true;
    if (to == ReferenceChange::kLand && options_.limits.broken_by(case_[i].motion, step_.t[i])) return false;
    ReferencePiece<double> piece;
    ReferencePiece<double>::for_each(piece, system_.piece, [i](double& x, const T& lanes) { x = lanes[i]; });
    piece = piece_after(to, case_[i].motion, piece, step_.t[i]);
    ReferencePiece<T>::for_each(system_.piece, piece, [i](T& lanes, double x) { lanes.set(i, x); });
    motion_max_step_.set(i, schedule_[i].motion_max_step());
    h_next_.set(i, std::min(h_next_[i], motion_max_step_[i]));
    stale_.set(i, true);
    if (to != ReferenceChange::kLand) return true;
    const SeaParameters<double> sea = with_landing_gains(*case_[i].sea, case_[i].motion);
    system_.sea.k_p.set(i, sea.k_p), system_.sea.k_d.set(i, sea.k_d);
    return true;
  }

  /// Handles the deadline at the end of a step; returns how the landing ended, if it did.
  [[gnu::noinline]] std::optional<End> reached(int i) {
    Mode mode = system_.lane(i);
    const Schedule::Deadline deadline = schedule_[i].reached(step_.t[i], mode);
    system_.set_lane(i, mode);
    if (!change(i, deadline.change)) return End::kBroken;
    if (deadline.change == ReferenceChange::kLand) settle(i, -1);
    return deadline.end;
  }

  // --- every lane at once ---

  UKEMI_INLINE static T peak_square(const System& s, const State& y, const State& dy) {
    const Vec2<T> a = thigh_acceleration(s.link, s.pose(y), {dy[kVx], dy[kVy], dy[kOmega0], dy[kOmega1]});
    return a.x() * a.x() + a.y() * a.y();
  }
  void start_other_maxima(const M&) {}
  void track_other_maxima() {}
  UKEMI_INLINE M abandoned(const M& where) const { return where & (peak_.square > abandon_square_); }
  M given_up() const { return M(false); }
  void peak_raised(int i) { out_[i].peak_contact = out_[i].contacts.size() - 1; }
  UKEMI_INLINE T longest_step() const {
    return select(system_.phase.moving, motion_max_step_, T(std::numeric_limits<double>::infinity()));
  }
  UKEMI_INLINE void stepped() { joint_lost_ |= accepted_ & (abs(step_.y[kTheta1] - step_.y[kTheta0]) > T(kLostJoint)); }
  UKEMI_INLINE M breaking(const M& where) const {
    if (!options_.limits.within_steps()) return M(false);
    return where & options_.limits.broken_by(System::sea_state(step_.y), system_.motor_torque_of(step_.t, step_.y));
  }
  /// Lanes at rest among `no_event`.
  UKEMI_INLINE M resting(const M& no_event) const {
    return no_event & at_rest(system_, step_.y, peak_.square, rest_scale_);
  }

  BatchSource& source_;
  const BatchOptions options_;
  const std::function<bool()> over_ = [this] { return source_.over(); };
  T motion_max_step_{0.0}, rest_scale_{0.0};
  M joint_lost_;
  std::array<Schedule, W> schedule_{};
  std::array<BatchCase, W> case_{};
  std::array<LandingPeak, W> out_{};
};

}  // namespace ukemi::landing
