// Effects of events on the rig: on its mode, its rates and, where T is a Jet, its derivatives. Included by roll.hpp
// only.
#pragma once

#include <limits>
#include <utility>

#include "common/integrate/saltation.hpp"
#include "identify/rig/one_link.hpp"

namespace ukemi::identify {

/// The values of a state or its derivative.
template <class State>
auto values_of(const State& y) {
  Eigen::Matrix<double, State::RowsAtCompileTime, 1> v;
  for (int i = 0; i < y.size(); ++i) v[i] = value_of(y[i]);
  return v;
}

/// Events of `System` at the time of the `Driver` that integrates it.
template <class System, class Driver, SeaTerms kTerms, class T>
class RigEvents {
  using State = typename System::State;

 public:
  RigEvents(System& system, Driver& driver) : system_(system), driver_(driver), start_(driver.time()) {}

  /// Sets the input of a segment, which may jump at its start. A command jumps later by its delay: there the
  /// derivatives by the delay jump.
  void change_input(const Excitation<T>& input, bool jumps, [[maybe_unused]] const T& command_delay) {
    double previous_command = system_.input.command;
    system_.input = input;
    if (jumps) driver_.refresh();
    if constexpr (kTerms.extended && kDerivatives < T >> 0) {
      if (driver_.time() > start_ && system_.input.command != previous_command && !command_delay.v.isZero(0)) {
        State y = driver_.state(), field;
        std::swap(system_.input.command, previous_command);
        system_.derivative(driver_.time(), y, field);
        const auto before = values_of(field);
        std::swap(system_.input.command, previous_command);
        settle();
        system_.derivative(driver_.time(), y, field);
        integrate::saltate(y, before, values_of(field), command_delay.v);
        driver_.refresh(y);
        return;
      }
    }
    if constexpr (kTerms.extended) settle();
  }

  /// Handles the zero of a guard. The field is continuous except where a slip ends: there the side's rate is exactly
  /// zero from then on, or changes sign, and the derivatives jump (saltation.hpp). False after too many at one time.
  bool cross(int guard) {
    constexpr int kMaxSimultaneous = 20;
    const double t = driver_.time();
    simultaneous_ = t == last_event_ ? simultaneous_ + 1 : 0, last_event_ = t;
    if (simultaneous_ > kMaxSimultaneous) return false;
    if (system_.ends_slip(guard)) {
      end_slip(guard);
    } else {
      system_.cross(guard, t, driver_.state());
      driver_.refresh();
    }
    return true;
  }

 private:
  /// Updates the mode where an input may have jumped, at a time that does not depend on the constants.
  void settle() {
    const RigMode before = system_.mode;
    system_.settle(driver_.time(), driver_.state());
    if (before != system_.mode) driver_.refresh();
  }

  /// Ends a slip: the side sticks or reverses.
  void end_slip(int guard) {
    const double t = driver_.time();
    State y = driver_.state();
    const int rate_index = System::rate_index(System::side_of(guard));
    if constexpr (kDerivatives < T >> 0) {
      State field;
      system_.derivative(t, y, field);
      const auto before = values_of(field);
      const T guard_value = y[rate_index];
      system_.cross(guard, t, y);
      system_.derivative(t, y, field);
      if (before[rate_index] != 0)
        integrate::saltate(y, before, values_of(field), integrate::event_shift(guard_value, before[rate_index]));
      y[rate_index] = system_.mode.stuck(System::side_of(guard)) ? T(0) : y[rate_index] - T(value_of(y[rate_index]));
    } else {
      system_.cross(guard, t, y);
      y[rate_index] = 0;
    }
    driver_.refresh(y);
  }

  System& system_;
  Driver& driver_;
  const double start_;                                            ///< of the trial [s]
  double last_event_ = -std::numeric_limits<double>::infinity();  ///< time of the last event [s]
  int simultaneous_ = 0;                                          ///< further events at that time
};

}  // namespace ukemi::identify
