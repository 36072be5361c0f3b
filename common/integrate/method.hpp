// The methods by name, for options and reports.
#pragma once

#include <array>

namespace ukemi::integrate {

/// How differential equations are solved. kAuto takes explicit steps (of order 5 down to an accuracy of 1e-7, of order
/// 8 below it) and switches to Rodas5P where a phase is stiff. Semi-implicit Euler and rk4 take the longest step that
/// the options allow, shortened at events; the others are error-controlled.
enum class Method { kAuto, kSemiImplicitEuler, kRungeKutta4, kDormandPrince54, kDormandPrince853, kRodas5P };

inline constexpr std::array<Method, 6> kMethods = {Method::kAuto,
                                                   Method::kSemiImplicitEuler,
                                                   Method::kRungeKutta4,
                                                   Method::kDormandPrince54,
                                                   Method::kDormandPrince853,
                                                   Method::kRodas5P};
inline constexpr std::array<const char*, 6> kMethodNames = {"auto",   "semi_implicit_euler", "rk4", "dopri5", "dop853",
                                                            "rodas5p"};
inline const char* name(Method m) { return kMethodNames[std::size_t(m)]; }
/// True where the method has no error estimate: its step is the longest one allowed.
inline bool fixed_step(Method m) { return m == Method::kSemiImplicitEuler || m == Method::kRungeKutta4; }

}  // namespace ukemi::integrate
