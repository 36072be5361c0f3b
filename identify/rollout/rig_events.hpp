// What an event changes on the rig: its mode, its rates and, where T is a Jet, its derivatives. Included by roll.hpp,
// by no other.
#pragma once

#include <limits>
#include <utility>

#include "common/integrate/saltation.hpp"
#include "identify/rig/one_link.hpp"

namespace ukemi::identify {

/// Of a state or its field.
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

  /// The input of a stretch, which may jump where it starts; a command that does so jumps later by the delay, and the
  /// derivatives with it.
  void change_input(const Excitation<T>& input, bool jumps, [[maybe_unused]] const T& delay) {
    double commanded = system_.input.command;
    system_.input = input;
    if (jumps) driver_.refresh();
    if constexpr (kTerms.extended && kDerivatives < T >> 0) {
      if (driver_.time() > start_ && system_.input.command != commanded && !delay.v.isZero(0)) {
        State y = driver_.state(), field;
        std::swap(system_.input.command, commanded);
        system_.derivative(driver_.time(), y, field);
        const auto before = values_of(field);
        std::swap(system_.input.command, commanded);
        settle();
        system_.derivative(driver_.time(), y, field);
        integrate::saltate(y, before, values_of(field), delay.v);
        driver_.refresh(y);
        return;
      }
    }
    if constexpr (kTerms.extended) settle();
  }

  /// Passes the zero of a guard. The field is continuous but where a slip ends: there the side's rate is exactly zero
  /// from now on, or turns, and the derivatives jump (saltation.hpp). False where events pile up at one instant.
  bool cross(int guard) {
    constexpr int kMostAtOnce = 20;
    const double t = driver_.time();
    at_once_ = t == last_ ? at_once_ + 1 : 0, last_ = t;
    if (at_once_ > kMostAtOnce) return false;
    if (system_.stops(guard)) {
      stop(guard);
    } else {
      system_.cross(guard, t, driver_.state());
      driver_.refresh();
    }
    return true;
  }

 private:
  /// The modes that hold where an input may have jumped, at a time that does not depend on the constants.
  void settle() {
    const RigMode before = system_.mode;
    system_.settle(driver_.time(), driver_.state());
    if (before != system_.mode) driver_.refresh();
  }

  /// A slip ends.
  void stop(int guard) {
    const double t = driver_.time();
    State y = driver_.state();
    const int place = System::rate_of(System::side_of(guard));
    if constexpr (kDerivatives < T >> 0) {
      State field;
      system_.derivative(t, y, field);
      const auto before = values_of(field);
      const T stopped = y[place];
      system_.cross(guard, t, y);
      system_.derivative(t, y, field);
      if (before[place] != 0)
        integrate::saltate(y, before, values_of(field), integrate::event_shift(stopped, before[place]));
      y[place] = system_.mode.stuck(System::side_of(guard)) ? T(0) : y[place] - T(value_of(y[place]));
    } else {
      system_.cross(guard, t, y);
      y[place] = 0;
    }
    driver_.refresh(y);
  }

  System& system_;
  Driver& driver_;
  const double start_;                                      ///< of the trial [s]
  double last_ = -std::numeric_limits<double>::infinity();  ///< time of the last event [s]
  int at_once_ = 0;                                         ///< events at that time but one
};

}  // namespace ukemi::identify
