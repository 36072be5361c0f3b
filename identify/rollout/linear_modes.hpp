// The linear modes of the rig: the exact flow of each, and the first guard that falls to zero on it. Included by
// roll.hpp only.
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

/// The flow of one linear mode, with and without derivatives.
template <class T, int kStates>
struct LinearMode {
  using Flow = LinearFlow<T, kStates>;
  using ValueFlow = LinearFlow<double, kStates>;
  using Values = typename ValueFlow::State;

  Flow flow;
  ValueFlow value_flow;                                                 ///< with the interval between guard checks
  int checks;                                                           ///< guard checks per sampling interval
  std::optional<typename ValueFlow::Propagator> check_propagator = {};  ///< from one check to the next
  std::vector<typename Flow::Propagator> propagators = {};  ///< over lengths that recur, where the rig is driven
  Values torque_bound = Values::Zero();  ///< |spring torque| within a block from z on is at most torque_bound . |z|
};

/// The state of a flow, z = y - rest: about the equilibrium of a held reference, or driven by b0 + b1 t.
template <class State, class T>
struct LinearFrame {
  T angle;  ///< of both sides at the equilibrium [rad]
  State b0, b1;
  bool is_rest;   ///< about an equilibrium: b0, b1 are 0
  double origin;  ///< time where t is 0 [s]

  State drive(double t) const { return b0 + b1 * T(t - origin); }
};

/// The linear modes of a `System`; `spacing` is the trial's sampling interval, `delay` that of its command [s].
template <SeaTerms kTerms, class T>
class LinearModes {
  using System = OneLinkSystem<kTerms, T>;
  using ValueSystem = OneLinkSystem<kTerms, double>;

 public:
  using State = typename System::State;
  using Values = typename ValueSystem::State;
  using Mode = LinearMode<T, System::kStates>;
  using Frame = LinearFrame<State, T>;
  using Flow = typename Mode::Flow;
  using ValueFlow = typename Mode::ValueFlow;
  static constexpr double kOffGrid = 1e-9;  ///< tolerance of a sample's distance from the grid, in intervals

  LinearModes(const System& system, double spacing, double delay)
      : system_(system), values_(system.template cast_values<double>()), spacing_(spacing), delay_(delay) {}

  /// The present mode. Its matrix does not depend on the direction of slips.
  Mode& mode() {
    const RigMode& m = system_.mode;
    std::unique_ptr<Mode>& out =
        modes_[(m.stuck(kOutputSide) ? 1U : 0U) + (m.stuck(kMotorSide) ? 2U : 0U) + (m.command != 0 ? 4U : 0U)];
    if (!out) out = std::make_unique<Mode>(make_mode());
    return *out;
  }
  /// The frame of the present mode and input from t on; `guards` then are those of this frame.
  Frame enter_frame(double t) {
    const Frame f = make_frame(t);
    values_.mode = system_.mode;
    values_.input = f.is_rest ? Excitation<double>{} : system_.input.template with_force<double>(false);
    return f;
  }

  /// Whether friction or a limit of the command may change the mode.
  bool has_events() const {
    if constexpr (!kTerms.extended) return false;
    return system_.mode.rubbing() || std::isfinite(value_of(system_.command_limit));
  }
  /// Whether no guard can become zero.
  bool is_event_free() const { return !has_events() && !std::isfinite(value_of(system_.sea.tau_max)); }
  /// Whether the torque limit is out of reach for a block from z on, about a held reference.
  bool below_limit(const Mode& mode, const Values& z) const {
    return mode.torque_bound.dot(z.cwiseAbs()) < value_of(system_.sea.tau_max);
  }

  /// The propagator over a length that recurs at every sample: the interval, or the parts into which a delayed command
  /// cuts it. Null for other lengths.
  const typename Flow::Propagator* cached_propagator(Mode& mode, double length) const {
    constexpr std::size_t kMaxPropagators = 4;
    const auto matches = [&](double known) { return std::abs(length - known) <= kOffGrid * spacing_; };
    for (const auto& propagator : mode.propagators)
      if (matches(propagator.length)) return &propagator;
    const bool recurs = matches(spacing_) || (delay_ > 0 && mode.propagators.size() + 1 < kMaxPropagators);
    if (!recurs || mode.propagators.size() == kMaxPropagators) return nullptr;
    return &mode.propagators.emplace_back(mode.flow.propagator(length));
  }

  /// How many of the next `n` intervals, about a held reference, are safe from a guard's zero.
  int clear_intervals(const Mode& mode, const State& z, int n) const {
    if (!kTerms.torque_limit || n == 0) return n;
    const double h = mode.value_flow.h();
    Values y = values_of(z);
    if (below_limit(mode, y)) return n;
    Guards a = guards(0, y);
    for (int j = 0; j < n * mode.checks; ++j) {
      y = mode.value_flow.after(1, y);
      const Guards b = guards(0, y);
      for (int i = 0; i < System::kGuards; ++i) {
        const integrate::Node start = j == 0 ? integrate::start_node(a.value[i], a.rate[i] * h) : node(0, a, i, h);
        if (b.value[i] < 0 || bernstein_minimum(start, node(1, b, i, h)) <= 0) return j / mode.checks;
      }
      a = b;
    }
    return n;
  }

  /// The first guard that falls to zero within a time d from z, if any; `end` is the state at d.
  struct Crossing {
    int guard = -1;
    double s = integrate::kNoZero;  ///< in fractions of d
  };
  Crossing first_crossing(const Mode& mode, const Values& z, double t, double d, const Values& end) const {
    Crossing crossing;
    if (!kTerms.torque_limit) return crossing;
    Values b0, b1;
    values_.derivative(t, Values(Values::Zero()), b0);
    values_.derivative(t + 1, Values(Values::Zero()), b1);
    b1 -= b0;
    const bool is_rest = b0.isZero(0) && b1.isZero(0);
    const auto at = [&](double s) {
      return is_rest ? mode.value_flow.advance(z, s * d) : mode.value_flow.advance(z, b0, b1, s * d);
    };
    const bool whole = mode.check_propagator && std::abs(d - spacing_) <= kOffGrid * spacing_;
    Guards a = guards(t, z);
    Values y = z;
    for (int k = 0; k < mode.checks && crossing.guard < 0; ++k) {
      const double sa = double(k) / mode.checks, sb = (k + 1.0) / mode.checks;
      y = k + 1 == mode.checks ? end : whole ? mode.check_propagator->after(y, b0 + b1 * (sa * d), b1) : at(sb);
      const Guards b = guards(t + sb * d, y);
      for (int i = 0; i < System::kGuards; ++i) {
        const integrate::Node start = k == 0 ? integrate::start_node(a.value[i], a.rate[i] * d) : node(sa, a, i, d);
        const double s = integrate::zero_between(start, node(sb, b, i, d),
                                                 [&](double x) { return guards(t + x * d, at(x)).value[i]; });
        if (s < crossing.s) crossing = {i, s};
      }
      a = b;
    }
    return crossing;
  }

 private:
  using Guards = integrate::Guards<System::kGuards>;

  Mode make_mode() const {
    typename Flow::Matrix a;
    typename ValueFlow::Matrix a_values;
    const double t = system_.input.t;
    State offset;
    system_.derivative(t, State(State::Zero()), offset);
    for (int j = 0; j < System::kStates; ++j) {
      State dy;
      system_.derivative(t, State(State::Unit(j)), dy);
      for (int i = 0; i < System::kStates; ++i) a(i, j) = dy[i] - offset[i], a_values(i, j) = value_of(a(i, j));
    }
    Flow flow(a, spacing_);
    // The guards are checked often enough for the cubics between checks to be accurate.
    constexpr double kAnglePerCheck = 0.5;
    constexpr int kMaxChecks = 8;
    // The states of a drive's lag decay too fast to matter.
    double rate = flow.rate_bound();
    if constexpr (kTerms.late) rate = LinearFlow<double, 4>::rate_bound_of(a_values.template topLeftCorner<4, 4>());
    const int checks = std::clamp(int(std::ceil(rate * spacing_ / kAnglePerCheck)), 1, kMaxChecks);
    Mode out{flow, ValueFlow(a_values, spacing_ / checks), checks};
    if (has_events()) {
      if (checks > 1) out.check_propagator = out.value_flow.propagator(spacing_ / checks);
      return out;
    }
    if (kTerms.torque_limit) out.torque_bound = torque_bound_of(a_values, out.value_flow, checks);
    return out;
  }

  /// torque_bound: the largest spring torque at the checks, and between them by its largest rate.
  Values torque_bound_of(const typename ValueFlow::Matrix& a, const ValueFlow& flow, int checks) const {
    Values torque = Values::Zero(), largest = torque, fastest = torque;
    torque.template head<4>() << -values_.sea.k_sea, values_.sea.k_sea, -values_.sea.c_sea, values_.sea.c_sea;
    for (int j = 0; j <= Flow::kBlock * checks; ++j) {
      largest = largest.cwiseMax(torque.cwiseAbs());
      fastest = fastest.cwiseMax((a.transpose() * torque).cwiseAbs());
      torque = flow.step().transpose() * torque;
    }
    return largest + 0.5 * flow.h() * fastest;
  }

  Frame make_frame(double t) const {
    const Excitation<T>& in = system_.input;
    Frame f{T(in.phi_ref), State::Zero(), State::Zero(),
            !has_events() && in.phi_ref_rate == 0 && in.dphi_ref == 0 && in.dphi_ref_rate == 0 && in.command == 0, t};
    if (f.is_rest) return f;
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
    values_.derivative(t, z, dz);
    Guards g;
    values_.guards(t, z, dz, g);
    return g;
  }
  static integrate::Node node(double s, const Guards& g, int i, double h) { return {s, g.value[i], g.rate[i] * h}; }

  const System& system_;
  ValueSystem values_;  ///< the system in values, in the frame, below the torque limit
  const double spacing_, delay_;
  std::array<std::unique_ptr<Mode>, kTerms.extended ? 8 : 1> modes_;  ///< made when first needed
};

}  // namespace ukemi::identify
