// One trial from stretch to stretch: exactly where the rig is linear, integrated where it is not; from event to event
// where friction sticks or a limit is met, with exact derivatives through them. Included by the files
// that compile kernels (kernels.hpp, rollout_methods.cpp), by no other.
#pragma once

#include <cmath>
#include <memory>
#include <optional>

#include "common/integrate/saltation.hpp"
#include "identify/rollout/hang.hpp"
#include "identify/rollout/linear.hpp"
#include "identify/rollout/rollout.hpp"

namespace ukemi::identify {

/// One trial with `Method` and the kernel of `kTerms`, see `rollout`. With kIntegrated nothing else is compiled.
template <class Method, SeaTerms kTerms, class T, RolloutOptions::Linear kLinear = RolloutOptions::Linear::kExact>
class Roll {
  static constexpr bool kExact = kLinear == RolloutOptions::Linear::kExact;
  using System = OneLinkSystem<kTerms, T>;
  using Plain = OneLinkSystem<kTerms, double>;
  using State = typename System::State;
  using Values = typename Plain::State;
  using Flow = LinearFlow<T, System::kStates>;
  using PlainFlow = LinearFlow<double, System::kStates>;
  using Stretch = PreparedTrial::Stretch;
  using Status = integrate::Status;

 public:
  Roll(const Rig& rig, const SeaParameters<T>& sea, const Nuisance<T>& nuisance, const PreparedTrial& trial,
       const RolloutOptions& options, std::vector<T>& phi, std::vector<T>& phi_m, std::vector<T>* torque)
      : drive_(rig.drive),
        system_(driven_by(rig.drive, sea), rig),
        plain_(system_.template in_values<double>()),
        nuisance_(nuisance),
        trial_(trial),
        delay_(rig.drive.by_command() ? sea.control_delay : T(0)),
        shifted_(moved() ? trial.cut(shift(), value_of(delay_)) : std::vector<Stretch>()),
        t_(trial.trial->t),
        options_(options),
        most_steps_(options.max_steps + 2 * long(trial.stretches.size()) + steps_of_lag(sea)),
        motor_(kDerivatives<T> == 0 || !trial.trial->phi_motor.empty()),
        phi_(phi),
        phi_m_(phi_m),
        torque_(kDerivatives<T> == 0 || !trial.trial->torque.empty() ? torque : nullptr),
        driver_(system_, t_[0], start(rig.gravity),
                {.accuracy = options.accuracy,
                 .first_step = std::min(1e-3, options.max_step),
                 .max_step = options.max_step}) {
    if (!drive_.by_command() && std::isfinite(drive_.limit)) {
      system_.command_limit = sea.k_t * T(drive_.limit);
      plain_.command_limit = value_of(system_.command_limit);
    }
    if constexpr (kTerms.extended)
      system_.lossy = present(sea.spring_loss), system_.mode.rubs[kMotorSide] = system_.lossy || present(sea.friction),
      system_.mode.rubs[kOutputSide] = present(sea.output_friction),
      system_.stribeck = system_.mode.rubbing() && present(sea.breakaway);
    exact_ = kExact && options.linear == RolloutOptions::Linear::kExact && t_.size() > 1 &&
             !(kTerms.extended &&
               (present(sea.k_sea_cubic) || system_.stribeck || system_.lossy || rig.gravity.moment != 0));
    if constexpr (kTerms.late) {
      State y = driver_.state();
      if (!trial.stretches.empty()) system_.input = driven(trial.stretches.front().input);
      system_.steady(t_[0], y);
      driver_.refresh(y);
    }
  }

  RolloutStatus run() {
    phi_.resize(t_.size()), phi_m_.resize(motor_ ? t_.size() : 0);
    if (torque_) torque_->resize(t_.size());
    record(0, driver_.state());
    pace_from_ = t_[0];
    RolloutStatus status = RolloutStatus::kDone;
    sample_ = 1;
    for (const Stretch& stretch : moved() ? shifted_ : trial_.stretches) {
      begin_stretch(stretch);
      arrived_ = false;
      while (!arrived_ && status == RolloutStatus::kDone) status = follow(stretch.t_end);
      if (status != RolloutStatus::kDone) break;
    }
    if (const T& gain = nuisance_.encoder_gain; present(T(gain - T(1))))
      for (T& x : phi_) x = gain * (x - nuisance_.encoder_offset) + nuisance_.encoder_offset;
    if (options_.work) {
      *options_.work = driver_.counters();
      options_.work->events += met_;
    }
    return status;
  }

 private:
  RolloutStatus follow(double t_end) {
    if constexpr (kExact)
      if (is_linear()) {
        return flow(t_end);
      }
    return integrate(t_end);
  }
  /// Takes work from the budget; false where it is spent.
  bool afford(double work) const {
    if (!options_.budget) return true;
    options_.budget->left -= work;
    return options_.budget->left > -options_.budget->overdraft;
  }
  bool is_linear() const { return exact_ && system_.mode.saturation == 0 && !system_.input.pushed; }
  static constexpr double kStiff = 300;  ///< rate x interval beyond which the looks between samples cost too much
  /// Whether friction or a command's limit changes the linear mode.
  bool slides() const {
    if constexpr (!kTerms.extended) return false;
    return system_.mode.rubbing() || std::isfinite(value_of(system_.command_limit));
  }
  double shift() const { return value_of(nuisance_.time_shift); }
  /// Whether the trial's cuts are not where its log has them.
  bool moved() const { return shift() != 0 || value_of(delay_) != 0; }

  /// Eq. 3 as the drive has it: with its own gain, or not at all.
  static SeaParameters<T> driven_by(const Drive& drive, SeaParameters<T> sea) {
    if (drive.kind == Drive::Kind::kGains) return sea;
    const bool controller = !drive.by_command();
    sea.k_p = controller ? T(sea.k_t * T(drive.gain)) : T(0), sea.k_d = T(0);
    if (controller && drive.feedback) sea.feedback = *drive.feedback;
    return sea;
  }
  State start(const Gravity& gravity) const {
    State y = State::Constant(T(trial_.phi_start) + nuisance_.angle);
    y[System::kOmega] = nuisance_.rate, y[System::kOmegaM] = T(0);
    if constexpr (kTerms.extended)
      if (gravity.moment != 0) hang(system_, drive_, trial_.phi_start, nuisance_.angle, y);
    return y;
  }
  /// The input as it drives the rig. The cuts stand where the shift's value puts them; the force is continuous there,
  /// so its derivative by the shift is all there is.
  Excitation<T> driven(const Excitation<double>& e) const {
    const T delay = nuisance_.time_shift - T(shift());
    std::array<T, 4> force;
    bool pushed = false;
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double next = i + 1 < force.size() ? double(i + 1) * e.force[i + 1] : 0;
      force[i] = nuisance_.force_gain * (T(e.force[i]) - T(next) * delay);
      if (i == 0) force[i] += nuisance_.force_bias;
      pushed = pushed || present(force[i]);
    }
    Excitation<T> out = e.with_force(pushed, force);
    if (!drive_.by_command()) out.command = 0;  // it is logged, but does not drive
    return out;
  }
  void record(std::size_t sample, const State& y) {
    phi_[sample] = y[System::kPhi] + nuisance_.encoder_offset;
    if (motor_) phi_m_[sample] = y[System::kPhiM];
    record_torque(sample, y);
  }
  void record_torque(std::size_t sample, const State& y) {
    if (torque_) (*torque_)[sample] = nuisance_.torque_gain * system_.spring_on_output(y) + nuisance_.torque_bias;
  }
  /// kDone while the link is within its bounds.
  RolloutStatus bounds(double angle) const {
    if (std::abs(angle - trial_.phi_start) < options_.escape) return RolloutStatus::kDone;
    return std::isfinite(angle) ? RolloutStatus::kEscaped : RolloutStatus::kDiverged;
  }

  // --- events ---

  /// The input of a stretch; a command that jumps where it starts does so later by the delay, and the derivatives jump
  /// with it.
  void begin_stretch(const Stretch& stretch) {
    double commanded = system_.input.command;
    system_.input = driven(stretch.input);
    if (stretch.jumps) driver_.refresh();
    if constexpr (kTerms.extended && kDerivatives < T >> 0) {
      if (driver_.time() > t_[0] && system_.input.command != commanded && !delay_.v.isZero(0)) {
        State y = driver_.state(), field;
        std::swap(system_.input.command, commanded);
        system_.derivative(driver_.time(), y, field);
        const Values before = values(field);
        std::swap(system_.input.command, commanded);
        settle();
        system_.derivative(driver_.time(), y, field);
        integrate::saltate(y, before, values(field), delay_.v);
        driver_.refresh(y);
        return;
      }
    }
    if constexpr (kTerms.extended) settle();
  }

  /// The modes that hold where an input may have jumped, at a time that does not depend on the constants.
  void settle() {
    const RigMode before = system_.mode;
    system_.settle(driver_.time(), driver_.state());
    if (before != system_.mode) driver_.refresh();
  }

  /// Passes the zero of a guard at the driver's time. The field is continuous but where a slip ends: there the side's
  /// rate is exactly zero from now on, or turns, and the derivatives jump (saltation.hpp). False where events pile up
  /// at one instant.
  bool cross(int guard) {
    constexpr int kMostAtOnce = 20;
    const double t = driver_.time();
    at_once_ = t == last_event_ ? at_once_ + 1 : 0, last_event_ = t;
    if (at_once_ > kMostAtOnce) return false;
    State y = driver_.state();
    if (!system_.stops(guard)) {
      system_.cross(guard, t, y);
      driver_.refresh();
      return true;
    }
    const int place = System::rate_of(System::side_of(guard));
    if constexpr (kDerivatives < T >> 0) {
      State field;
      system_.derivative(t, y, field);
      const Values before = values(field);
      const T stopped = y[place];
      system_.cross(guard, t, y);
      system_.derivative(t, y, field);
      if (before[place] != 0)
        integrate::saltate(y, before, values(field), integrate::event_shift(stopped, before[place]));
      y[place] = system_.mode.stuck(System::side_of(guard)) ? T(0) : y[place] - T(value_of(y[place]));
    } else {
      system_.cross(guard, t, y);
      y[place] = 0;
    }
    driver_.refresh(y);
    return true;
  }

  /// What the poles of a drive that is late take of an explicit method, however soft the rest.
  long steps_of_lag([[maybe_unused]] const SeaParameters<T>& sea) const {
    if constexpr (kTerms.late) return long(DriveLag<T>(sea).fastest() * (t_.back() - t_.front()));
    return 0;
  }

  // --- integrated ---

  /// To the end of the stretch, or to where the rig becomes linear.
  RolloutStatus integrate(double t_end) {
    for (;;) {
      const integrate::Outcome outcome = driver_.step(t_end);
      if (outcome.status > Status::kEvent || ++steps_ > most_steps_ || !afford(1)) return RolloutStatus::kDiverged;
      const double end = driver_.time();
      // Constants too stiff for an explicit method show early: at the pace of the last steps the rest would take too
      // many.
      constexpr long kPace = 200;
      if (steps_ % kPace == 0) {
        if (double(kPace) * (t_.back() - end) > double(most_steps_) * (end - pace_from_))
          return RolloutStatus::kDiverged;
        pace_from_ = end;
      }
      const bool reached = outcome.status == Status::kReached;
      for (; sample_ < t_.size() && (reached ? t_[sample_] <= t_end : t_[sample_] < end); ++sample_) {
        if (t_[sample_] == t_end) {
          record(sample_, driver_.state());
        } else {
          const auto& step = driver_.dense();
          const double s = step.place_of(t_[sample_]);
          phi_[sample_] = step.component_at(System::kPhi, s) + nuisance_.encoder_offset;
          if (motor_) phi_m_[sample_] = step.component_at(System::kPhiM, s);
          if (torque_) {
            State y;
            for (int i = 0; i < System::kStates; ++i) y[i] = step.component_at(i, s);
            record_torque(sample_, y);
          }
        }
      }
      const RolloutStatus status = bounds(value_of(driver_.state()[System::kPhi]));
      if constexpr (kTerms.extended) {
        const Values y = values(driver_.state());
        if (gives_way(plain_.sea.k_sea, plain_.sea.k_sea_cubic, y[System::kPhiM] - y[System::kPhi]))
          return RolloutStatus::kEscaped;
      }
      if (status != RolloutStatus::kDone) return status;
      if (outcome.event >= 0) {
        if (!cross(outcome.event)) return RolloutStatus::kDiverged;
        if (is_linear()) return RolloutStatus::kDone;
      }
      if (reached) {
        arrived_ = true;
        return RolloutStatus::kDone;
      }
    }
  }

  // --- exact ---

  /// The exact flow of a linear mode, and of its values.
  struct Exact {
    Flow flow;
    PlainFlow values;                                   ///< by the interval between looks at the guards
    int looks;                                          ///< so many in a sampling interval
    std::optional<typename PlainFlow::Leap> look = {};  ///< from one to the next
    std::vector<typename Flow::Leap> leaps = {};        ///< over lengths that come again, where the rig is driven
  };

  /// That of the present mode. Its matrix does not depend on the direction of slips.
  Exact& exact() {
    const RigMode& m = system_.mode;
    std::unique_ptr<Exact>& out =
        exacts_[(m.stuck(kOutputSide) ? 1U : 0U) + (m.stuck(kMotorSide) ? 2U : 0U) + (m.command != 0 ? 4U : 0U)];
    if (!out) out = std::make_unique<Exact>(prepared());
    return *out;
  }

  Exact prepared() {
    typename Flow::Matrix a;
    typename PlainFlow::Matrix plain;
    const double t = system_.input.t;
    State none;
    system_.derivative(t, State(State::Zero()), none);
    for (int j = 0; j < System::kStates; ++j) {
      State dy;
      system_.derivative(t, State(State::Unit(j)), dy);
      for (int i = 0; i < System::kStates; ++i) a(i, j) = dy[i] - none[i], plain(i, j) = value_of(a(i, j));
    }
    Flow flow(a, trial_.spacing);
    // The guards are looked at often enough for the cubics between to be exact.
    constexpr double kTurn = 0.5;
    constexpr int kMostLooks = 8;
    // A drive's lag decays faster than anything turns.
    double rate = flow.rate();
    if constexpr (kTerms.late) rate = LinearFlow<double, 4>::rate_of(plain.template topLeftCorner<4, 4>());
    const int looks = std::clamp(int(std::ceil(rate * trial_.spacing / kTurn)), 1, kMostLooks);
    Exact out{flow, PlainFlow(plain, trial_.spacing / looks), looks};
    if (slides()) {
      if (looks > 1) out.look = out.values.leap(trial_.spacing / looks);
      return out;
    }
    if (kTerms.torque_limit) bound_torque(plain, out.values, looks);
    return out;
  }

  /// The spring's torque within a block is at most torque_bound_ . |z|: at the looks, and between them by its rate.
  void bound_torque(const typename PlainFlow::Matrix& plain, const PlainFlow& flow, int looks) {
    Values torque = Values::Zero(), largest = torque, fastest = torque;
    torque.template head<4>() << -plain_.sea.k_sea, plain_.sea.k_sea, -plain_.sea.c_sea, plain_.sea.c_sea;
    for (int j = 0; j <= Flow::kBlock * looks; ++j) {
      largest = largest.cwiseMax(torque.cwiseAbs());
      fastest = fastest.cwiseMax((plain.transpose() * torque).cwiseAbs());
      torque = flow.step().transpose() * torque;
    }
    torque_bound_ = largest + 0.5 * flow.h() * fastest;
  }

  /// The state as the flow sees it: about a held reference, which is then a rest.
  struct Frame {
    T rest;
    State b0, b1;
    bool held;
  };
  Frame frame(double t) const {
    const Excitation<T>& in = system_.input;
    Frame f{T(in.phi_ref), State::Zero(), State::Zero(),
            !slides() && in.phi_ref_rate == 0 && in.dphi_ref == 0 && in.dphi_ref_rate == 0 && in.command == 0};
    if (f.held) return f;
    f.rest = T(0);
    State next;
    system_.derivative(t, State(State::Zero()), f.b0);
    system_.derivative(t + 1, State(State::Zero()), next);
    f.b1 = next - f.b0;
    return f;
  }
  static Values values(const State& y) {
    Values v;
    for (int i = 0; i < System::kStates; ++i) v[i] = value_of(y[i]);
    return v;
  }

  /// To the end of the stretch, or to where a limit is met: a block of intervals at once about a held reference, else
  /// from interval to interval. A side that is stuck does not move at all: its rows of the flow are zero.
  RolloutStatus flow(double t_end) {
    Exact& exact = this->exact();
    const Flow& flow = exact.flow;
    const bool sliding = slides();
    if (sliding && !(flow.rate() * trial_.spacing < kStiff)) return RolloutStatus::kDiverged;
    double t = driver_.time();
    const Frame f = frame(t);
    plain_.mode = system_.mode;
    plain_.input = f.held ? Excitation<double>{} : system_.input.template with_force<double>(false);
    State rest = State::Zero();
    rest[System::kPhi] = rest[System::kPhiM] = f.rest;
    State z = driver_.state() - rest;
    const double from = t;
    while (t < t_end) {
      if (const int n = f.held ? clear_intervals(exact, z, on_grid(t, t_end)) : 0; n > 0) {
        const T offset = f.rest + nuisance_.encoder_offset;
        for (int j = 0; j < n; ++j, ++sample_) {
          flow.angle(phi_[sample_], offset, 0, j, z);
          if (motor_) flow.angle(phi_m_[sample_], f.rest, 1, j, z);
          const RolloutStatus status = bounds(value_of(phi_[sample_]));
          if (status != RolloutStatus::kDone) return status;
        }
        t = t_[sample_ - 1];
        z = flow.after(n, z);
        if (torque_) record_torque(sample_ - 1, z + rest);
        continue;
      }
      const bool to_sample = sample_ < t_.size() && t_[sample_] <= t_end;
      const double next = to_sample ? t_[sample_] : t_end, left = next - t, d = std::min(left, trial_.spacing);
      const auto* leap = f.held ? nullptr : leap_over(exact, d);
      const bool clear = f.held ? below_limit(values(z)) : unlimited();
      if (!(leap && clear) && !afford(f.held ? flow.work(d) : 1 + flow.rate() * d)) return RolloutStatus::kDiverged;
      const State drive = f.b0 + f.b1 * T(t - from);
      const auto after = [&](double h) { return f.held ? flow.advance(z, h) : flow.advance(z, drive, f.b1, h); };
      const State end = leap ? leap->after(z, drive, f.b1) : after(d);
      if (const Meeting met = clear ? Meeting{} : meeting(exact, values(z), t, d, values(end)); met.guard >= 0) {
        driver_.restart(t + met.s * d, after(met.s * d) + rest);
        ++met_;
        return cross(met.guard) ? RolloutStatus::kDone : RolloutStatus::kDiverged;
      }
      z = end;
      t = d == left ? next : t + d;
      if (d < left || !to_sample) continue;
      record(sample_++, z + rest);
      const RolloutStatus status = bounds(value_of(z[0] + f.rest));
      if (status != RolloutStatus::kDone) return status;
    }
    driver_.restart(t, z + rest);
    arrived_ = true;
    return RolloutStatus::kDone;
  }

  /// How many of the next samples are one interval apart from `t` on; at most a block.
  int on_grid(double t, double t_end) const {
    const int most = torque_ ? 1 : Flow::kBlock;  // a block knows the angles between, not the rates
    int n = 0;
    while (n < most && sample_ + std::size_t(n) < t_.size() && t_[sample_ + std::size_t(n)] <= t_end &&
           std::abs(t_[sample_ + std::size_t(n)] - t - (n + 1) * trial_.spacing) <= kOffGrid * trial_.spacing)
      ++n;
    return n;
  }

  static constexpr double kOffGrid = 1e-9;  ///< of an interval: samples so near a grid are on it
  using Guards = integrate::Guards<System::kGuards>;
  /// The guards at a state in the frame.
  Guards guards(double t, const Values& z) const {
    Values dz;
    plain_.derivative(t, z, dz);
    Guards g;
    plain_.guards(t, z, dz, g);
    return g;
  }
  static integrate::Node node(double s, const Guards& g, int i, double h) { return {s, g.value[i], g.rate[i] * h}; }

  /// The leap over a length that comes at every sample: the interval, or the parts into which a delayed command cuts
  /// it.
  const typename Flow::Leap* leap_over(Exact& exact, double length) const {
    constexpr std::size_t kMost = 4;
    const auto is = [&](double known) { return std::abs(length - known) <= kOffGrid * trial_.spacing; };
    for (const auto& leap : exact.leaps)
      if (is(leap.length)) return &leap;
    const bool again = is(trial_.spacing) || (value_of(delay_) > 0 && exact.leaps.size() + 1 < kMost);
    if (!again || exact.leaps.size() == kMost) return nullptr;
    return &exact.leaps.emplace_back(exact.flow.leap(length));
  }
  /// Whether no guard can be met.
  bool unlimited() const { return !slides() && !std::isfinite(value_of(system_.sea.tau_max)); }
  /// Whether the torque limit is out of reach for a block from here on, about a held reference.
  bool below_limit(const Values& z) const { return torque_bound_.dot(z.cwiseAbs()) < value_of(system_.sea.tau_max); }

  /// How many of `n` intervals from z on pass without a guard coming near zero.
  int clear_intervals(const Exact& exact, const State& z, int n) const {
    if (!kTerms.torque_limit || n == 0) return n;
    const double h = exact.values.h();
    Values y = values(z);
    if (below_limit(y)) return n;
    Guards a = guards(0, y);
    for (int j = 0; j < n * exact.looks; ++j) {
      y = exact.values.after(1, y);
      const Guards b = guards(0, y);
      for (int i = 0; i < System::kGuards; ++i) {
        const integrate::Node start = j == 0 ? integrate::start_node(a.value[i], a.rate[i] * h) : node(0, a, i, h);
        if (b.value[i] < 0 || bernstein_minimum(start, node(1, b, i, h)) <= 0) return j / exact.looks;
      }
      a = b;
    }
    return n;
  }

  /// The first guard that falls to zero within d of z, and where; `end` is the state there.
  struct Meeting {
    int guard = -1;
    double s = integrate::kNoZero;  ///< in parts of d
  };
  Meeting meeting(const Exact& exact, const Values& z, double t, double d, const Values& end) const {
    Meeting met;
    if (!kTerms.torque_limit) return met;
    Values b0, b1;
    plain_.derivative(t, Values(Values::Zero()), b0);
    plain_.derivative(t + 1, Values(Values::Zero()), b1);
    b1 -= b0;
    const bool held = b0.isZero(0) && b1.isZero(0);
    const auto at = [&](double s) {
      return held ? exact.values.advance(z, s * d) : exact.values.advance(z, b0, b1, s * d);
    };
    const bool whole = exact.look && std::abs(d - trial_.spacing) <= kOffGrid * trial_.spacing;
    Guards a = guards(t, z);
    Values y = z;
    for (int look = 0; look < exact.looks && met.guard < 0; ++look) {
      const double sa = double(look) / exact.looks, sb = (look + 1.0) / exact.looks;
      y = look + 1 == exact.looks ? end : whole ? exact.look->after(y, b0 + b1 * (sa * d), b1) : at(sb);
      const Guards b = guards(t + sb * d, y);
      for (int i = 0; i < System::kGuards; ++i) {
        const integrate::Node start = look == 0 ? integrate::start_node(a.value[i], a.rate[i] * d) : node(sa, a, i, d);
        const double s = integrate::zero_between(start, node(sb, b, i, d),
                                                 [&](double x) { return guards(t + x * d, at(x)).value[i]; });
        if (s < met.s) met = {i, s};
      }
      a = b;
    }
    return met;
  }

  const Drive drive_;
  System system_;
  Plain plain_;  ///< of the frame, in values, with the limit not reached
  const Nuisance<T>& nuisance_;
  const PreparedTrial& trial_;
  const T delay_;                       ///< of a logged command; that of a drive in the loop is the system's
  const std::vector<Stretch> shifted_;  ///< the cuts, where the force is shifted or the command is late
  const std::vector<double>& t_;
  const RolloutOptions& options_;
  const long most_steps_;
  const bool motor_;  ///< phi_m is asked for
  std::vector<T>&phi_, &phi_m_;
  std::vector<T>* const torque_;  ///< null: not asked for
  integrate::Integrator<Method, System> driver_;
  bool exact_;  ///< the rig has linear modes, and they are wanted
  std::array<std::unique_ptr<Exact>, kTerms.extended ? 8 : 1> exacts_;  ///< of each, once it was needed
  Values torque_bound_ = Values::Zero();  ///< of the spring's torque for a block from z on: torque_bound_ . |z|
  bool arrived_ = false;                  ///< at the end of the stretch
  std::size_t sample_ = 0;                ///< the next to be recorded
  long steps_ = 0, met_ = 0;              ///< integrated; limits met where the rig was linear
  double last_event_ = -std::numeric_limits<double>::infinity();  ///< time of the last event [s]
  int at_once_ = 0;                                               ///< events at that time but one
  double pace_from_ = 0;                                          ///< time at the last look at the pace [s]
};

}  // namespace ukemi::identify
