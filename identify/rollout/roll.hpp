// One trial from stretch to stretch: exactly where the rig is linear, integrated where it is not. Included by the files
// that compile kernels (rollout.cpp, rollout_methods.cpp), by no other.
// Private: not installed.
#pragma once

#include <cmath>
#include <optional>

#include "identify/rollout/linear.hpp"
#include "identify/rollout/rollout.hpp"

namespace ukemi::identify {

/// Whether a term is there; a constant at 0 that is being fitted is.
template <class T>
bool present(const T& x) {
  if constexpr (kDerivatives < T >> 0)
    return x.a != 0 || !x.v.isZero(0);
  else
    return x != 0;
}

/// One trial with `Method` and the kernel of `kTerms`, see `rollout`. With kIntegrated nothing else is compiled.
template <class Method, SeaTerms kTerms, class T, RolloutOptions::Linear kLinear = RolloutOptions::Linear::kExact>
class Roll {
  static constexpr bool kExact = kLinear == RolloutOptions::Linear::kExact;
  using System = OneLinkSystem<kTerms, T>;
  using Plain = OneLinkSystem<kTerms, double>;
  using State = typename System::State;
  using Values = typename Plain::State;
  using Stretch = PreparedTrial::Stretch;
  using Status = integrate::Status;

 public:
  Roll(const Rig& rig, const SeaParameters<T>& sea, const Nuisance<T>& nuisance, const PreparedTrial& trial,
       const RolloutOptions& options, std::vector<T>& phi, std::vector<T>& phi_m)
      : system_(sea, rig.length, rig.inertia),
        plain_(values(sea), rig.length, rig.inertia),
        nuisance_(nuisance),
        trial_(trial),
        shifted_(shift() == 0 ? std::vector<Stretch>() : trial.cut(shift())),
        t_(trial.trial->t),
        options_(options),
        most_steps_(options.max_steps + 2 * long(trial.stretches.size())),
        motor_(kDerivatives<T> == 0 || !trial.trial->phi_motor.empty()),
        phi_(phi),
        phi_m_(phi_m),
        driver_(system_, t_[0], start(),
                {.accuracy = options.accuracy,
                 .first_step = std::min(1e-3, options.max_step),
                 .max_step = options.max_step}) {
    if constexpr (kExact) {
      const bool nonlinear = kTerms.extended && (present(sea.friction) || present(sea.k_sea_cubic));
      if (options.linear == RolloutOptions::Linear::kExact && !nonlinear) prepare_flow();
    }
  }

  RolloutStatus run() {
    phi_.resize(t_.size()), phi_m_.resize(motor_ ? t_.size() : 0);
    record(0, driver_.state());
    pace_from_ = t_[0];
    RolloutStatus status = RolloutStatus::kDone;
    sample_ = 1;
    for (const Stretch& stretch : shift() == 0 ? trial_.stretches : shifted_) {
      system_.input = driven(stretch.input);
      if (stretch.jumps) driver_.refresh();
      arrived_ = false;
      while (!arrived_ && status == RolloutStatus::kDone) status = follow(stretch.t_end);
      if (status != RolloutStatus::kDone) break;
    }
    if (options_.work) {
      *options_.work = driver_.counters();
      options_.work->events += met_;
    }
    return status;
  }

 private:
  RolloutStatus follow(double t_end) {
    if constexpr (kExact)
      if (is_linear()) return flow(t_end);
    return integrate(t_end);
  }
  /// Takes work from the budget; false where it is spent.
  bool afford(double work) const {
    if (!options_.budget) return true;
    options_.budget->left -= work;
    return options_.budget->left > -options_.budget->overdraft;
  }
  bool is_linear() const { return flow_ && system_.saturation == 0 && !system_.input.pushed; }
  double shift() const { return value_of(nuisance_.time_shift); }

  State start() const {
    const T angle = T(trial_.phi_start) + nuisance_.angle;
    State y;
    y << angle, angle, nuisance_.rate, T(0);
    return y;
  }
  /// The input as it drives the rig. The cuts stand where the shift's value puts them; the force is continuous there,
  /// so its derivative by the shift is all there is.
  Excitation<T> driven(const Excitation<double>& e) const {
    const T later = nuisance_.time_shift - T(shift());
    const T force = nuisance_.force_gain * (T(e.force) - T(e.force_rate) * later) + nuisance_.force_bias,
            rate = nuisance_.force_gain * T(e.force_rate);
    return e.with_force(present(force) || present(rate), force, rate);
  }
  void record(std::size_t sample, const State& y) {
    phi_[sample] = y[System::kPhi] + nuisance_.encoder_offset;
    if (motor_) phi_m_[sample] = y[System::kPhiM];
  }
  /// kDone while the link is within its bounds.
  RolloutStatus bounds(double angle) const {
    if (std::abs(angle - trial_.phi_start) < options_.escape) return RolloutStatus::kDone;
    return std::isfinite(angle) ? RolloutStatus::kEscaped : RolloutStatus::kDiverged;
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
        }
      }
      const RolloutStatus status = bounds(value_of(driver_.state()[System::kPhi]));
      if (status != RolloutStatus::kDone) return status;
      if (outcome.event >= 0) {
        system_.cross(outcome.event);
        driver_.refresh();
        if (is_linear()) return RolloutStatus::kDone;
      }
      if (reached) {
        arrived_ = true;
        return RolloutStatus::kDone;
      }
    }
  }

  // --- exact ---

  void prepare_flow() {
    if (t_.size() < 2) return;
    Eigen::Matrix<T, 4, 4> a;
    Eigen::Matrix<double, 4, 4> plain;
    for (int j = 0; j < 4; ++j) {  // the field is linear, and zero at rest at a reference of zero
      State dy;
      system_.derivative(0.0, State(State::Unit(j)), dy);
      for (int i = 0; i < 4; ++i) a(i, j) = dy[i], plain(i, j) = value_of(dy[i]);
    }
    flow_.emplace(a, trial_.spacing);
    // The guards are looked at often enough for the cubics between to be exact.
    constexpr double kTurn = 0.5;
    constexpr int kMostLooks = 8;
    looks_ = std::clamp(int(std::ceil(flow_->rate() * trial_.spacing / kTurn)), 1, kMostLooks);
    values_flow_.emplace(plain, trial_.spacing / looks_);
    if (!kTerms.torque_limit) return;
    // The spring's torque within a block is at most torque_bound_ . |z|: at the looks, and between them by its rate.
    Values torque{-plain_.sea.k_sea, plain_.sea.k_sea, -plain_.sea.c_sea, plain_.sea.c_sea}, largest = Values::Zero(),
                                                                                             fastest = Values::Zero();
    for (int j = 0; j <= LinearFlow<T>::kBlock * looks_; ++j) {
      largest = largest.cwiseMax(torque.cwiseAbs());
      fastest = fastest.cwiseMax((plain.transpose() * torque).cwiseAbs());
      torque = values_flow_->step().transpose() * torque;
    }
    torque_bound_ = largest + 0.5 * values_flow_->h() * fastest;
  }

  /// The state as the flow sees it: about a held reference, which is then a rest.
  struct Frame {
    T rest;
    State b0, b1;
    bool held;
  };
  Frame frame(double t) {
    const Excitation<T>& in = system_.input;
    Frame f{T(in.phi_ref), State::Zero(), State::Zero(),
            in.phi_ref_rate == 0 && in.dphi_ref == 0 && in.dphi_ref_rate == 0};
    if (f.held) return f;
    f.rest = T(0);
    State later;
    system_.derivative(t, State(State::Zero()), f.b0);
    system_.derivative(t + 1, State(State::Zero()), later);
    f.b1 = later - f.b0;
    return f;
  }
  static Values values(const State& y) {
    Values v;
    for (int i = 0; i < 4; ++i) v[i] = value_of(y[i]);
    return v;
  }
  static SeaParameters<double> values(const SeaParameters<T>& sea) {
    SeaParameters<double> p{};
    SeaParameters<double>::for_each(p, sea, [](double& to, const T& from) { to = value_of(from); });
    p.feedback = sea.feedback;
    return p;
  }

  /// To the end of the stretch, or to where the torque limit is met.
  [[gnu::flatten]] RolloutStatus flow(double t_end) {
    double t = driver_.time();
    const Frame f = frame(t);
    plain_.input = f.held ? Excitation<double>{} : system_.input.with_force(false, 0.0, 0.0);
    const State rest{f.rest, f.rest, T(0), T(0)};
    State z = driver_.state() - rest;
    const double from = t;
    while (t < t_end) {
      if (const int n = f.held ? clear_intervals(z, on_grid(t, t_end)) : 0; n > 0) {
        const T offset = f.rest + nuisance_.encoder_offset;
        for (int j = 0; j < n; ++j, ++sample_) {
          flow_->angle(phi_[sample_], offset, 0, j, z);
          if (motor_) flow_->angle(phi_m_[sample_], f.rest, 1, j, z);
          const RolloutStatus status = bounds(value_of(phi_[sample_]));
          if (status != RolloutStatus::kDone) return status;
        }
        t = t_[sample_ - 1];
        z = flow_->after(n, z);
        continue;
      }
      // A part of an interval, or one that meets the limit.
      const bool to_sample = sample_ < t_.size() && t_[sample_] <= t_end;
      const double next = to_sample ? t_[sample_] : t_end, left = next - t, d = std::min(left, trial_.spacing);
      if (!afford(flow_->work(d))) return RolloutStatus::kDiverged;
      const Meeting met = f.held && below_limit(values(z)) ? Meeting{} : meeting(values(z), t, d);
      const double h = met.guard < 0 ? d : met.s * d;
      z = f.held ? flow_->advance(z, h) : flow_->advance(z, f.b0 + f.b1 * T(t - from), f.b1, h);
      t = h == left ? next : t + h;
      if (met.guard >= 0) {
        driver_.restart(t, z + rest);
        system_.cross(met.guard);
        ++met_;
        return RolloutStatus::kDone;
      }
      if (h < left || !to_sample) continue;
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
    constexpr double kOff = 1e-9;  // of an interval
    int n = 0;
    while (n < LinearFlow<T>::kBlock && sample_ + std::size_t(n) < t_.size() && t_[sample_ + std::size_t(n)] <= t_end &&
           std::abs(t_[sample_ + std::size_t(n)] - t - (n + 1) * trial_.spacing) <= kOff * trial_.spacing)
      ++n;
    return n;
  }

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

  /// Whether the torque limit is out of reach for a block from here on, about a held reference.
  bool below_limit(const Values& z) const { return torque_bound_.dot(z.cwiseAbs()) < value_of(system_.sea.tau_max); }

  /// How many of `n` intervals from z on pass without a guard coming near zero.
  int clear_intervals(const State& z, int n) const {
    if (!kTerms.torque_limit || n == 0) return n;
    const double h = values_flow_->h();
    Values y = values(z);
    if (below_limit(y)) return n;
    Guards a = guards(0, y);
    for (int j = 0; j < n * looks_; ++j) {
      y = values_flow_->after(1, y);
      const Guards b = guards(0, y);
      for (int i = 0; i < System::kGuards; ++i) {
        const integrate::Node start = j == 0 ? integrate::start_node(a.value[i], a.rate[i] * h) : node(0, a, i, h);
        if (b.value[i] < 0 || bernstein_minimum(start, node(1, b, i, h)) <= 0) return j / looks_;
      }
      a = b;
    }
    return n;
  }

  /// The first guard that falls to zero within d of z, and where.
  struct Meeting {
    int guard = -1;
    double s = integrate::kNoZero;  ///< in parts of d
  };
  Meeting meeting(const Values& z, double t, double d) const {
    Meeting met;
    if (!kTerms.torque_limit) return met;
    Values b0, b1;
    plain_.derivative(t, Values(Values::Zero()), b0);
    plain_.derivative(t + 1, Values(Values::Zero()), b1);
    b1 -= b0;
    const bool held = b0.isZero(0) && b1.isZero(0);
    const auto at = [&](double s) {
      return held ? values_flow_->advance(z, s * d) : values_flow_->advance(z, b0, b1, s * d);
    };
    Guards a = guards(t, z);
    for (int look = 0; look < looks_ && met.guard < 0; ++look) {
      const double sa = double(look) / looks_, sb = (look + 1.0) / looks_;
      const Guards b = guards(t + sb * d, at(sb));
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

  System system_;
  Plain plain_;  ///< of the frame, in values, with the limit not reached
  const Nuisance<T>& nuisance_;
  const PreparedTrial& trial_;
  const std::vector<Stretch> shifted_;  ///< the cuts, where the force is shifted
  const std::vector<double>& t_;
  const RolloutOptions& options_;
  const long most_steps_;
  const bool motor_;  ///< phi_m is asked for
  std::vector<T>&phi_, &phi_m_;
  integrate::Integrator<Method, System> driver_;
  std::optional<LinearFlow<T>> flow_;  ///< where the rig has a linear mode
  std::optional<LinearFlow<double>> values_flow_;
  int looks_ = 1;                         ///< at the guards in an interval
  Values torque_bound_ = Values::Zero();  ///< of the spring's torque for a block from z on: torque_bound_ . |z|
  bool arrived_ = false;                  ///< at the end of the stretch
  std::size_t sample_ = 0;                ///< the next to be recorded
  long steps_ = 0, met_ = 0;              ///< integrated; limits met where the rig was linear
  double pace_from_ = 0;                  ///< time at the last look at the pace [s]
};

}  // namespace ukemi::identify
