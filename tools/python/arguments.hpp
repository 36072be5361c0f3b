// Arguments that several verbs have: name, type and default of each at one place; and options made of them.
#pragma once

#include <tuple>

#include "landing/judge/under_scatter.hpp"
#include "landing/model/scatter_file.hpp"
#include "tools/python/landing.hpp"

namespace ukemi::python {

/// What may be given to several verbs. Units and meaning: as the docstrings of the verbs have them.
struct Arguments {
  std::uint64_t seed = 1;
  int threads = 0, starts = 0;
  std::string objective = "peak", solver = "auto", criterion = "worst";
  std::optional<long> evaluations = {};
  std::optional<double> deadline = {}, share = {}, force_noise = {};
  std::optional<std::string> robust = {}, scatter = {};
  double inflate = 1, rate = 1000, accuracy = 1e-9;
  long samples = landing::BodyPlanOptions().samples;
  bool inexact = false, respect_ratings = false, multi_turn = false;
  std::vector<std::string> forbid = {}, nuisance = {}, profile = {};
  std::optional<Path> drops = {};
  std::optional<std::vector<std::string>> free = {};
  Priors priors = {};
  Bounds lower = {}, upper = {}, errors = {};
};

/// An argument that becomes a member of the struct A; its default is the member's.
template <class T, class A>
struct Argument {
  const char* name;
  T A::*at;
  T value;
  const char* shown;  ///< the default as signatures show it; null: as Python does
  Argument(const char* its_name, T A::*member, const char* shown_as = nullptr)
      : name(its_name), at(member), value(A().*member), shown(shown_as) {}
  /// The same with another default.
  Argument with(T other) const {
    Argument out = *this;
    out.value = std::move(other);
    return out;
  }
};
inline const Argument kSeed{"seed", &Arguments::seed};
inline const Argument kThreads{"threads", &Arguments::threads}, kStarts{"starts", &Arguments::starts};
inline const Argument kObjective{"objective", &Arguments::objective}, kSolver{"solver", &Arguments::solver},
    kCriterion{"criterion", &Arguments::criterion};
inline const Argument kEvaluations{"evaluations", &Arguments::evaluations};
inline const Argument kDeadline{"deadline", &Arguments::deadline}, kShare{"share", &Arguments::share},
    kForceNoise{"force_noise", &Arguments::force_noise};
inline const Argument kRobust{"robust", &Arguments::robust}, kScatter{"scatter", &Arguments::scatter};
inline const Argument kInflate{"inflate", &Arguments::inflate}, kRate{"rate", &Arguments::rate},
    kAccuracy{"accuracy", &Arguments::accuracy};
inline const Argument kSamples{"samples", &Arguments::samples};
inline const Argument kInexact{"inexact", &Arguments::inexact},
    kRespectRatings{"respect_ratings", &Arguments::respect_ratings}, kMultiTurn{"multi_turn", &Arguments::multi_turn};
inline const Argument kForbid{"forbid", &Arguments::forbid}, kNuisance{"nuisance", &Arguments::nuisance},
    kProfile{"profile", &Arguments::profile};
inline const Argument kDrops{"drops", &Arguments::drops};
inline const Argument kFree{"free", &Arguments::free};
inline const Argument kPriors{"priors", &Arguments::priors};
inline const Argument kLower{"lower", &Arguments::lower}, kUpper{"upper", &Arguments::upper},
    kErrors{"errors", &Arguments::errors};

template <class Other>
inline constexpr bool kIsArgument = false;
template <class T, class A>
inline constexpr bool kIsArgument<Argument<T, A>> = true;
/// Whether no py::arg comes after an Argument.
template <class... What>
constexpr bool own_first() {
  bool gathers = false, ok = true;
  ((gathers |= kIsArgument<What>, ok &= !gathers || !std::is_base_of_v<py::arg, What>), ...);
  return ok;
}
template <class T, class A>
std::tuple<T A::*> member_of(const Argument<T, A>& argument) {
  return argument.at;
}
inline std::tuple<> member_of(const auto&) { return {}; }
template <class T, class A>
py::arg_v pybind_of(const Argument<T, A>& argument) {
  return py::arg_v(argument.name, argument.value, argument.shown);
}
const auto& pybind_of(const auto& other) { return other; }

/// f(arguments, own...) as a function of `own` and of each of the `members` of the arguments.
template <class F, class R, class A, class... Own, class... T, class... B>
auto gathered(F f, R (*)(A, Own...), std::tuple<T B::*...> members) {
  return [f, members](Own... own, T... given) -> R {
    std::decay_t<A> arguments{};
    std::apply([&](auto... at) { ((arguments.*at = std::move(given)), ...); }, members);
    return f(arguments, std::forward<Own>(own)...);
  };
}
template <class F, class... What>
auto gathered_of(F f, const What&... what) {
  static_assert(own_first<What...>());
  return gathered(f, static_cast<py::detail::function_signature_t<F>*>(nullptr), std::tuple_cat(member_of(what)...));
}
/// Binds f(arguments, own...) as a function or a method. `what`: a py::arg for each of `own`, then the Arguments that
/// may be given, and the docstring.
template <class Scope, class F, class... What>
void define(Scope& scope, const char* name, F f, const What&... what) {
  scope.def(name, gathered_of(f, what...), pybind_of(what)...);
}
/// The same of a constructor: f returns the object.
template <class Class, class F, class... What>
void define_constructor(Class& c, F f, const What&... what) {
  c.def(py::init(gathered_of(f, what...)), pybind_of(what)...);
}

/// The scatter of an argument, if given.
inline std::optional<landing::Scatter> parsed_scatter(const std::optional<std::string>& text) {
  return text ? std::optional(landing::parse_scatter("scatter", *text)) : std::nullopt;
}
/// Measured drops of a file, which replace drawn ones; none without a file. Throws InputError where what draws drops is
/// given too.
std::vector<landing::ScatteredDrop> measured_drops(const Arguments& a, const landing::Scene& scene,
                                                   const Actuator& actuator);
/// The same of a robot of links; null without a file.
std::shared_ptr<const std::vector<landing::BodyDrop>> measured_drops(const Arguments& a,
                                                                     const landing::BodyScene& scene);
/// Options of a plan under scatter.
landing::RobustOptions robust_of(const Arguments& a);

/// The scene with forbidden contacts and, if they are to be respected, the drives' ratings as further limits.
landing::BodyScene with_limits(landing::BodyScene scene, const Arguments& a);
/// Plan options from the arguments, validated for the scene.
landing::BodyPlanOptions plan_options(const landing::BodyScene& scene, const Arguments& a);

/// `terms` with the fitted names, priors and bounds of the arguments.
template <class Choice>
Choice chosen_terms(Choice terms, const Arguments& a) {
  if (a.free) terms.free = *a.free;
  terms.nuisance = a.nuisance, terms.lower = a.lower, terms.upper = a.upper;
  for (const auto& [name, prior] : a.priors) terms.priors.push_back({name, prior.first, prior.second});
  return terms;
}

/// `options` of a fit of `terms` with what the arguments say.
template <class Options, class Terms>
Options fit_options(Options options, Terms terms, const Arguments& a) {
  options.terms = chosen_terms(std::move(terms), a);
  options.accuracy = a.accuracy, options.seed = a.seed, options.profiles = a.profile;
  options.errors.assign(a.errors.begin(), a.errors.end());
  return options;
}

}  // namespace ukemi::python
