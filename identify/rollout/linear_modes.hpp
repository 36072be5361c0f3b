// The linear modes of the rig: the exact flow of each, and the first guard that falls to zero on it. Included by
// roll.hpp, by no other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "common/integrate/guards.hpp"
#include "identify/rig/one_link.hpp"
#include "identify/rollout/linear.hpp"
#include "identify/rollout/rig_events.hpp"

namespace ukemi::identify {

/// The flow of one linear mode, and of its values.
template <class T, int kStates>
struct LinearMode {
  using Flow = LinearFlow<T, kStates>;
  using PlainFlow = LinearFlow<double, kStates>;
  using Values = typename PlainFlow::State;

  Flow flow;
  PlainFlow values;                                   ///< by the interval between looks at the guards
  int looks;                                          ///< so many in a sampling interval
  std::optional<typename PlainFlow::Leap> look = {};  ///< from one to the next
  std::vector<typename Flow::Leap> leaps = {};        ///< over lengths that come again, where the rig is driven
  Values torque_bound = Values::Zero();  ///< of the spring's torque for a block from z on: torque_bound . |z|
};

/// The state as a flow sees it, z = y - rest: about a held reference, which is then a rest, or driven by b0 + b1 t.
template <class State, class T>
struct LinearFrame {
  T angle;  ///< of both sides at rest [rad]
  State b0, b1;
  bool held;
  double from;  ///< where t is 0 [s]

  State drive(double t) const { return b0 + b1 * T(t - from); }
};

/// The linear modes of a `System`; `spacing` is the trial's sampling interval, `delay` that of its command [s].
template <SeaTerms kTerms, class T>
class LinearModes {
  using System = OneLinkSystem<kTerms, T>;
  using Plain = OneLinkSystem<kTerms, double>;

 public:
  using State = typename System::State;
  using Values = typename Plain::State;
  using Mode = LinearMode<T, System::kStates>;
  using Frame = LinearFrame<State, T>;
  using Flow = typename Mode::Flow;
  using PlainFlow = typename Mode::PlainFlow;
  static constexpr double kOffGrid = 1e-9;  ///< of an interval: samples so near a grid are on it

  LinearModes(const System& system, double spacing, double delay)
      : system_(system), plain_(system.template in_values<double>()), spacing_(spacing), delay_(delay) {}

  /// The present mode. Its matrix does not depend on the direction of slips.
  Mode& mode() {
    const RigMode& m = system_.mode;
    std::unique_ptr<Mode>& out =
        modes_[(m.stuck(kOutputSide) ? 1U : 0U) + (m.stuck(kMotorSide) ? 2U : 0U) + (m.command != 0 ? 4U : 0U)];
    if (!out) out = std::make_unique<Mode>(prepared());
    return *out;
  }
  /// That of the present mode and input from t on; the guards are those of it from here on.
  Frame enter(double t) {
    const Frame f = frame(t);
    plain_.mode = system_.mode;
    plain_.input = f.held ? Excitation<double>{} : system_.input.template with_force<double>(false);
    return f;
  }

  /// Whether friction or a command's limit changes the mode.
  bool slides() const {
    if constexpr (!kTerms.extended) return false;
    return system_.mode.rubbing() || std::isfinite(value_of(system_.command_limit));
  }
  /// Whether no guard can be met.
  bool unlimited() const { return !slides() && !std::isfinite(value_of(system_.sea.tau_max)); }
  /// Whether the torque limit is out of reach for a block from here on, about a held reference.
  bool below_limit(const Mode& mode, const Values& z) const {
    return mode.torque_bound.dot(z.cwiseAbs()) < value_of(system_.sea.tau_max);
  }

  /// The leap over a length that comes at every sample: the interval, or the parts into which a delayed command cuts
  /// it. Null for other lengths.
  const typename Flow::Leap* leap_over(Mode& mode, double length) const {
    constexpr std::size_t kMost = 4;
    const auto is = [&](double known) { return std::abs(length - known) <= kOffGrid * spacing_; };
    for (const auto& leap : mode.leaps)
      if (is(leap.length)) return &leap;
    const bool again = is(spacing_) || (delay_ > 0 && mode.leaps.size() + 1 < kMost);
    if (!again || mode.leaps.size() == kMost) return nullptr;
    return &mode.leaps.emplace_back(mode.flow.leap(length));
  }

  /// How many of `n` intervals from z on, about a held reference, pass without a guard coming near zero.
  int clear_intervals(const Mode& mode, const State& z, int n) const {
    if (!kTerms.torque_limit || n == 0) return n;
    const double h = mode.values.h();
    Values y = values_of(z);
    if (below_limit(mode, y)) return n;
    Guards a = guards(0, y);
    for (int j = 0; j < n * mode.looks; ++j) {
      y = mode.values.after(1, y);
      const Guards b = guards(0, y);
      for (int i = 0; i < System::kGuards; ++i) {
        const integrate::Node start = j == 0 ? integrate::start_node(a.value[i], a.rate[i] * h) : node(0, a, i, h);
        if (b.value[i] < 0 || bernstein_minimum(start, node(1, b, i, h)) <= 0) return j / mode.looks;
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
  Meeting meeting(const Mode& mode, const Values& z, double t, double d, const Values& end) const {
    Meeting met;
    if (!kTerms.torque_limit) return met;
    Values b0, b1;
    plain_.derivative(t, Values(Values::Zero()), b0);
    plain_.derivative(t + 1, Values(Values::Zero()), b1);
    b1 -= b0;
    const bool held = b0.isZero(0) && b1.isZero(0);
    const auto at = [&](double s) {
      return held ? mode.values.advance(z, s * d) : mode.values.advance(z, b0, b1, s * d);
    };
    const bool whole = mode.look && std::abs(d - spacing_) <= kOffGrid * spacing_;
    Guards a = guards(t, z);
    Values y = z;
    for (int look = 0; look < mode.looks && met.guard < 0; ++look) {
      const double sa = double(look) / mode.looks, sb = (look + 1.0) / mode.looks;
      y = look + 1 == mode.looks ? end : whole ? mode.look->after(y, b0 + b1 * (sa * d), b1) : at(sb);
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

 private:
  using Guards = integrate::Guards<System::kGuards>;

  Mode prepared() const {
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
    Flow flow(a, spacing_);
    // The guards are looked at often enough for the cubics between to be exact.
    constexpr double kTurn = 0.5;
    constexpr int kMostLooks = 8;
    // A drive's lag decays faster than anything turns.
    double rate = flow.rate();
    if constexpr (kTerms.late) rate = LinearFlow<double, 4>::rate_of(plain.template topLeftCorner<4, 4>());
    const int looks = std::clamp(int(std::ceil(rate * spacing_ / kTurn)), 1, kMostLooks);
    Mode out{flow, PlainFlow(plain, spacing_ / looks), looks};
    if (slides()) {
      if (looks > 1) out.look = out.values.leap(spacing_ / looks);
      return out;
    }
    if (kTerms.torque_limit) out.torque_bound = bound_of_torque(plain, out.values, looks);
    return out;
  }

  /// The spring's torque within a block is at most this . |z|: at the looks, and between them by its rate.
  Values bound_of_torque(const typename PlainFlow::Matrix& plain, const PlainFlow& flow, int looks) const {
    Values torque = Values::Zero(), largest = torque, fastest = torque;
    torque.template head<4>() << -plain_.sea.k_sea, plain_.sea.k_sea, -plain_.sea.c_sea, plain_.sea.c_sea;
    for (int j = 0; j <= Flow::kBlock * looks; ++j) {
      largest = largest.cwiseMax(torque.cwiseAbs());
      fastest = fastest.cwiseMax((plain.transpose() * torque).cwiseAbs());
      torque = flow.step().transpose() * torque;
    }
    return largest + 0.5 * flow.h() * fastest;
  }

  Frame frame(double t) const {
    const Excitation<T>& in = system_.input;
    Frame f{T(in.phi_ref), State::Zero(), State::Zero(),
            !slides() && in.phi_ref_rate == 0 && in.dphi_ref == 0 && in.dphi_ref_rate == 0 && in.command == 0, t};
    if (f.held) return f;
    f.angle = T(0);
    State next;
    system_.derivative(t, State(State::Zero()), f.b0);
    system_.derivative(t + 1, State(State::Zero()), next);
    f.b1 = next - f.b0;
    return f;
  }

  /// The guards at a state in the frame.
  Guards guards(double t, const Values& z) const {
    Values dz;
    plain_.derivative(t, z, dz);
    Guards g;
    plain_.guards(t, z, dz, g);
    return g;
  }
  static integrate::Node node(double s, const Guards& g, int i, double h) { return {s, g.value[i], g.rate[i] * h}; }

  const System& system_;
  Plain plain_;  ///< of the frame, in values, with the limit not reached
  const double spacing_, delay_;
  std::array<std::unique_ptr<Mode>, kTerms.extended ? 8 : 1> modes_;  ///< each once it was needed
};

}  // namespace ukemi::identify
