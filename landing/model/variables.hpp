// The variables that a search chooses, and the motion and drive that a choice of them gives.
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string>

#include "landing/model/motion_data.hpp"

namespace ukemi::landing {

/// A variable of a motion space.
struct Variable {
  std::string name;     ///< key and column in files, without its unit: "phi_i"
  std::string words;    ///< for a reader: "phi_I"
  std::string unit;     ///< of its values, SI: "rad", "s", "1"
  double lower, upper;  ///< the range that is searched
  /// Where it does nothing, if such a value is within its range: a search also looks at motions without it.
  std::optional<double> neutral = {};
};

/// As many as a motion of Eq. 6 of [1] has: phi_I, phi_F, duration.
inline constexpr int kPaperVariables = 3;
/// A space has at most so many variables: points of it need no allocation.
inline constexpr int kMostVariables = 20;
/// A number for each variable, in their order, SI; nothing in it allocates. Takes and gives Eigen's vectors too.
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
  std::array<double, kMostVariables> values_{};
  int size_ = 0;
};

/// For each variable -1 on the lower edge of its range, +1 on the upper, else 0.
using Edges = std::array<signed char, kMostVariables>;

/// What a point of a space gives: the reference that is played, and the drive that follows it.
struct DrivenMotion {
  Motion motion;
  SeaParameters<double> sea;
};

/// How a motion that is played deviates from its plan, in parts of the execution tolerance, -1..1.
struct Deviation {
  double phi_i, phi_f, duration;
};

}  // namespace ukemi::landing
