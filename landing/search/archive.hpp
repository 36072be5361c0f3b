// Archive of the best few candidates that differ: starts, basins, contenders for the answer.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "landing/search/objective.hpp"

namespace ukemi::landing {

/// Largest difference of two points in any variable, in parts of the box.
inline double distance(const Candidate& a, const Candidate& b) { return (a.u - b.u).lpNorm<Eigen::Infinity>(); }

/// Holds candidates in the order of their values, no two of them nearer than `apart`. Allocates nothing.
class Archive {
 public:
  static constexpr std::size_t kMost = 64;

  /// Largest size, 1 to kMost; least distance of two, in parts of the box, >= 0.
  Archive(std::size_t most, double apart) : most_(std::min(most, kMost)), apart_(apart) {}

  /// Takes a candidate that could be followed, instead of all within `apart` of it, or, where there is no place left,
  /// of the worst. One that close to a better or equal one, or is the worst of too many, is refused. Returns whether
  /// it was taken.
  bool add(const Candidate& p) {
    if (!(p.value < bound()) || beside(p, p.value)) return false;
    const auto near = [&](const Candidate& q) { return distance(p, q) < apart_; };
    size_ = std::size_t(std::remove_if(all_.begin(), all_.begin() + long(size_), near) - all_.begin());
    size_ = std::min(size_, most_ - 1);
    const auto place = std::upper_bound(all_.begin(), all_.begin() + long(size_), p);
    std::move_backward(place, all_.begin() + long(size_), all_.begin() + long(size_) + 1);
    *place = p, ++size_;
    return true;
  }
  /// Whether p is within `apart` of one that is at least as good as `value`.
  bool beside(const Candidate& p, double value) const {
    return std::any_of(begin(), end(), [&](const Candidate& q) { return q.value <= value && distance(p, q) < apart_; });
  }
  /// The value below which a candidate is taken: the worst of a full list, kNoMotion where there is a place.
  double bound() const { return size_ == most_ ? all_[size_ - 1].value : kNoMotion; }
  /// The lowest value; kNoMotion where there is none.
  double lowest() const { return size_ > 0 ? all_[0].value : kNoMotion; }

  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  const Candidate& operator[](std::size_t i) const { return all_[i]; }
  const Candidate* begin() const { return all_.data(); }
  const Candidate* end() const { return all_.data() + size_; }

 private:
  std::array<Candidate, kMost> all_;
  std::size_t most_, size_ = 0;
  double apart_;
};

}  // namespace ukemi::landing
