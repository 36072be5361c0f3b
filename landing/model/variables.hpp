// The variables of a search, and the motion and drive that their values give.
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string>

#include "landing/model/motion_data.hpp"

namespace ukemi::landing {

/// A variable of a motion space.
struct Variable {
  std::string name;     ///< key and column in files, without unit: "phi_i"
  std::string words;    ///< in reports: "phi_I"
  std::string unit;     ///< of its values, SI: "rad", "s", "1"
  double lower, upper;  ///< search range
  /// Value without effect, if within its range: a search also tries motions without the variable.
  std::optional<double> neutral = {};
};

/// Number of variables of Eq. 6 of [1]: phi_I, phi_F, duration.
inline constexpr int kPaperVariables = 3;
/// Maximum number of variables of a space: its points need no allocation.
inline constexpr int kMaxVariables = 20;
/// A number for each variable, in order, SI, without allocation; converts from and to Eigen's vectors.
class MotionValues {
 public:
  MotionValues() = default;
  MotionValues(std::initializer_list<double> values) {
    for (const double v : values) values_[std::size_t(size_++)] = v;
  }
  template <class V>
  requires requires { V::MaxRowsAtCompileTime; }
  MotionValues(const V& v) : size_(int(v.size())) {
    for (int i = 0; i < size_; ++i) values_[std::size_t(i)] = v[i];
  }
  template <class V>
  requires requires { V::MaxRowsAtCompileTime; }
  operator V() const {
    V v(size_);
    for (int i = 0; i < size_; ++i) v[i] = values_[std::size_t(i)];
    return v;
  }
  int size() const { return size_; }
  double& operator[](int i) { return values_[std::size_t(i)]; }
  double operator[](int i) const { return values_[std::size_t(i)]; }
  const double* begin() const { return values_.data(); }
  const double* end() const { return values_.data() + size_; }
  bool operator==(const MotionValues&) const = default;

 private:
  std::array<double, kMaxVariables> values_{};
  int size_ = 0;
};

/// For each variable -1 on the lower edge of its range, +1 on the upper, else 0.
using Edges = std::array<signed char, kMaxVariables>;

/// The motion and the drive of a point of a space.
struct DrivenMotion {
  Motion motion;
  SeaParameters<double> sea;
};

/// Deviation of an executed motion from its plan, in units of the execution tolerance, -1..1.
struct Deviation {
  double phi_i, phi_f, duration;
};

}  // namespace ukemi::landing
