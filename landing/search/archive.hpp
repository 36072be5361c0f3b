// Archive of the best candidates that lie apart: starts, basins, contenders for the answer.
#pragma once

#include <algorithm>
#include <array>

#include "landing/search/objective.hpp"

namespace ukemi::landing {

/// Distance of two points in the maximum norm, as a fraction of the box.
inline double distance(const Candidate& a, const Candidate& b) { return (a.u - b.u).lpNorm<Eigen::Infinity>(); }

/// Candidates sorted by value, no two of them closer than `separation`. Allocates nothing.
class Archive {
 public:
  static constexpr std::size_t kMost = 64;

  /// Capacity, 1 to kMost; minimum distance of two members, as a fraction of the box, >= 0.
  Archive(std::size_t capacity, double separation) : capacity_(std::min(capacity, kMost)), separation_(separation) {}

  /// Inserts a candidate that could be followed: it replaces all members within `separation`, or the worst of a full
  /// archive. Refused where a member that close is at least as good, or where it is no better than the worst of a full
  /// archive. Returns whether it was inserted.
  bool add(const Candidate& p) {
    if (!(p.value < bound()) || beside(p, p.value)) return false;
    const auto too_close = [&](const Candidate& q) { return distance(p, q) < separation_; };
    size_ = std::size_t(std::remove_if(all_.begin(), all_.begin() + long(size_), too_close) - all_.begin());
    size_ = std::min(size_, capacity_ - 1);
    const auto place = std::upper_bound(all_.begin(), all_.begin() + long(size_), p);
    std::move_backward(place, all_.begin() + long(size_), all_.begin() + long(size_) + 1);
    *place = p, ++size_;
    return true;
  }
  /// Whether a member within `separation` of p has at most `value`.
  bool beside(const Candidate& p, double value) const {
    return std::any_of(begin(), end(), [&](auto& q) { return q.value <= value && distance(p, q) < separation_; });
  }
  /// The value below which a candidate can be inserted: the worst of a full archive; kNoMotion where it is not full.
  double bound() const { return size_ == capacity_ ? all_[size_ - 1].value : kNoMotion; }
  /// The lowest value; kNoMotion of an empty archive.
  double lowest() const { return size_ > 0 ? all_[0].value : kNoMotion; }

  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  const Candidate& operator[](std::size_t i) const { return all_[i]; }
  const Candidate* begin() const { return all_.data(); }
  const Candidate* end() const { return all_.data() + size_; }

 private:
  std::array<Candidate, kMost> all_;
  std::size_t capacity_, size_ = 0;
  double separation_;
};

}  // namespace ukemi::landing
