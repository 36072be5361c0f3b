// Ceres' dual numbers as a scalar: exact derivatives of whatever is written for any scalar.
#pragma once

#include <ceres/jet.h>

#include "common/scalar.hpp"

namespace ukemi {

template <int P>
inline constexpr int kDerivatives<ceres::Jet<double, P>> = P;

}  // namespace ukemi
