// Shared by all parts of the Python module: arrays, checks, long calls, figures.
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/degrees.hpp"
#include "common/error.hpp"
#include "common/toml.hpp"
#include "identify/logs/trial.hpp"
#include "identify/trust/profile.hpp"
#include "tools/program/actuators.hpp"

namespace ukemi::python {

namespace py = pybind11;

using AnyNumbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
/// An array argument; throws InputError if it has masked values.
struct Numbers {
  AnyNumbers array;
};
void refuse_masked(py::handle array);
/// An argument that names a file or a folder: str or os.PathLike.
struct Path {
  std::string text;
  operator const std::string&() const { return text; }
};
/// Absent where `given` is neither. Throws InputError for a path that cannot exist.
std::optional<Path> path_of(py::handle given);
using Bounds = std::map<std::string, double>;
using Priors = std::map<std::string, std::pair<double, double>>;  ///< value, standard deviation

/// Returns `value` if it is in range, as for values in files. Throws InputError "WHAT: value: rule".
double checked(const std::string& what, double value, const Range& range);
std::optional<double> checked(const std::string& what, std::optional<double> value, const Range& range);
/// A Python object as a number. Throws InputError where it is none.
double number(const std::string& what, py::handle value);
/// A one-dimensional array of `rows` numbers (0: any). Throws InputError for another shape.
std::vector<double> column(const std::string& what, const Numbers& numbers, std::size_t rows = 0);
std::vector<double> column(const std::string& what, const std::optional<Numbers>& numbers, std::size_t rows);

/// Read-only array of `count` numbers at `stride` bytes, kept alive by `owner`, without a copy.
py::array_t<double> view(const double* first, std::size_t count, std::size_t stride, py::handle owner);
inline py::array_t<double> view(const std::vector<double>& numbers, py::handle owner) {
  return view(numbers.data(), numbers.size(), sizeof(double), owner);
}

/// Runs f(stop) on another thread without the GIL. An exception of Python's signal handlers (Ctrl-C) makes stop() true
/// and is rethrown once f has returned.
template <class F>
auto long_call(F&& f) {
  std::atomic<bool> stop{false};
  const std::function<bool()> stopped = [&] { return stop.load(); };
  auto result = std::async(std::launch::async, [&] { return f(stopped); });
  std::optional<py::error_already_set> exception;
  const auto finished = [&] {
    const py::gil_scoped_release release;
    return result.wait_for(std::chrono::milliseconds(20)) == std::future_status::ready;
  };
  while (!finished())
    if (!exception && PyErr_CheckSignals() != 0) exception.emplace(), stop = true;
  if (exception) throw py::error_already_set(std::move(*exception));
  return result.get();
}

/// Runs f() as a long call, which ends early where its monitors hear stop(); afterwards they hear nothing.
template <class F, class... Monitors>
auto monitored(F f, Monitors&... monitors) {
  auto result = long_call([&](const std::function<bool()>& stop) {
    ((monitors.stop = stop), ...);
    return f();
  });
  ((monitors.stop = {}), ...);
  return result;
}

/// A planner or a reader (T) that a control program asks, with its scene and the name of its goal. Throws where another
/// thread asks it meanwhile; `what`: "planner".
template <class T, class Scene>
class Asked {
 public:
  template <class... Given>
  Asked(const char* what, const Scene& its_scene, const std::string& its_goal, const Given&... given)
      : scene(its_scene), goal(its_goal), what_(what), asked_(given...) {}
  const Scene scene;
  const std::string goal;  ///< name of what is compared
  /// f(planner or reader) without the GIL.
  template <class F>
  auto ask(F f) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) throw std::runtime_error(std::string("the ") + what_ + " is asked by another thread already");
    const py::gil_scoped_release release;
    return f(asked_);
  }

 private:
  const char* what_;
  T asked_;
  std::mutex mutex_;
};

/// Factor of the constants' standard errors under scatter, 0 to 100.
inline double inflation(double inflate) { return checked("inflate", inflate, {0, 100, false, "0 to 100"}); }
/// Rows per second [Hz], above 0.
inline double checked_rate(double rate) { return checked("rate", rate, {0, 1e6, true, "above 0 to 1e6 Hz"}); }
/// Checks an angle [rad]: at most one turn.
inline double angle(const std::string& what, double radians) {
  const double turn = 2 * std::numbers::pi;
  return checked(what, radians, {-turn, turn, false, "-2 pi to 2 pi rad; math.radians makes them of degrees"});
}

/// Binds a read-only property; `of`: a function or a member of a T. A copy is returned.
template <class T, class Of, class... Options>
void property(py::class_<T, Options...>& c, const char* name, const std::string& words, Of of) {
  c.def_property_readonly(
      name, [of](const T& x) { return std::invoke(of, x); }, words.c_str());
}
/// The same of a column of numbers, shown without a copy.
template <class T, class Of, class... Options>
void column_property(py::class_<T, Options...>& c, const char* name, const std::string& words, Of of) {
  c.def_property_readonly(
      name, [of](const py::object& self) { return view(std::invoke(of, self.cast<const T&>()), self); }, words.c_str());
}

/// of(x) of each of `all`.
template <class All, class Of>
py::list list_of(const All& all, Of of) {
  py::list out;
  for (const auto& x : all) out.append(of(x));
  return out;
}

/// Binds a function that reads a file; read(path).
template <class Read>
void bind_reader(py::module_& m, const char* name, const char* words, Read read) {
  m.def(name, read, py::arg("path"), words);
}

/// An SVG picture; notebooks show it.
struct Figure {
  std::string svg;
};

/// Binds the estimates of a fit; of(result): the fit.
template <class Result, class Of, class... Options>
void bind_estimates(py::class_<Result, Options...>& c, Of of) {
  using identify::Estimate;
  const auto by_name = [](const std::vector<Estimate>& all) {
    std::map<std::string, Estimate> out;
    for (const Estimate& e : all) out[e.trial < 0 ? e.name : e.name + "[" + std::to_string(e.trial) + "]"] = e;
    return out;
  };
  property(c, "parameters", "The constants by name, fitted or not; each an Estimate.",
           [=](auto& r) { return by_name(of(r).parameters); });
  property(c, "nuisance", "The terms that were fitted along, by name; name[i] where each trial has its own.",
           [=](auto& r) { return by_name(of(r).nuisance); });
  property(c, "fitted", "Names in the order of `covariance`.", [=](auto& r) { return of(r).fitted; });
  property(c, "covariance", "Covariance of `fitted` [product of their units]; NaN where it is not determined.",
           [=](auto& r) -> Eigen::MatrixXd { return of(r).covariance; });
  property(c, "cost", "The sum of squares [square of the outputs' unit].", [=](auto& r) { return of(r).cost; });
  property(c, "converged", "Whether the search ended at a minimum.", [=](auto& r) { return of(r).converged; });
  property(c, "trusted", "Whether it converged and every fitted constant is trusted.",
           [=](auto& r) { return of(r).trusted(); });
  property(c, "message", "Why it did not converge; empty where it did.", [=](auto& r) { return of(r).message; });
  property(c, "error_budget",
           "Of each constant the shares of its variance [1]: noise, and the stated errors of what was not fitted.",
           [=](auto& r) {
             std::map<std::string, std::map<std::string, double>> out;
             for (const identify::ErrorBudget& b : identify::error_budget(of(r)))
               out[b.constant] = {b.shares.begin(), b.shares.end()};
             return out;
           });
  property(c, "warnings", "What a reader should know, a sentence each.", [=](auto& r) { return of(r).warnings; });
}

/// Binds the requested likelihood profiles; of(result): the profiles.
template <class Result, class Of, class... Options>
void bind_profiles(py::class_<Result, Options...>& c, Of of) {
  using Interval = std::pair<std::optional<double>, std::optional<double>>;
  property(c, "profiles",
           "Of each constant of `profile` the 95 % interval by its likelihood, the others refitted [its SI unit]; None "
           "where it ends beyond three standard errors.",
           [=](auto& r) {
             std::map<std::string, Interval> out;
             for (const identify::Profile& p : of(r)) out[p.constant] = {p.low, p.high};
             return out;
           });
}

/// Trials with zero force between hits and the command of the rig's drive. force_noise [N], >= 0.
std::vector<identify::Trial> prepared(std::vector<identify::Trial> trials, const identify::Rig& rig,
                                      std::optional<double> force_noise);
/// tools::require_gains for the argument "actuator".
inline void require_gains(const Actuator& actuator) { tools::require_gains(actuator, {"actuator"}); }

/// Each binds what the source file of its name has.
using Bind = void(py::module_& m);
Bind bind_common, bind_scene, bind_trials, bind_identify, bind_landing, bind_optimize, bind_risk, bind_map,
    bind_planner, bind_calibrate, bind_compare, bind_atlas, bind_trade, bind_robot_trials, bind_design, bind_report;

}  // namespace ukemi::python

template <>
struct pybind11::detail::type_caster<ukemi::python::Path> {
  PYBIND11_TYPE_CASTER(ukemi::python::Path, const_name("Union[str, os.PathLike]"));
  bool load(handle source, bool) {
    std::optional<ukemi::python::Path> path = ukemi::python::path_of(source);
    if (path) value = std::move(*path);
    return path.has_value();
  }
  static handle cast(const ukemi::python::Path& path, return_value_policy, handle) { return str(path.text).release(); }
};
template <>
struct pybind11::detail::type_caster<ukemi::python::Numbers> {
  PYBIND11_TYPE_CASTER(ukemi::python::Numbers, handle_type_name<ukemi::python::AnyNumbers>::name);
  bool load(handle source, bool convert) {
    make_caster<ukemi::python::AnyNumbers> plain;
    if (!plain.load(source, convert)) return false;
    ukemi::python::refuse_masked(source);
    value.array = cast_op<ukemi::python::AnyNumbers>(std::move(plain));
    return true;
  }
};
