// Archive of the best candidates that lie apart: starts, basins, contenders for the answer.
#pragma once

#include <algorithm>
#include <array>

#include "landing/search/population.hpp"

namespace ukemi::landing {

/// Distance of two points in the maximum norm, as a fraction of the box.
inline double distance(const Candidate& a, const Candidate& b) { return (a.u - b.u).lpNorm<Eigen::Infinity>(); }

/// Candidates sorted by value, no two of them closer than `separation`. Each first contact has places of its own:
/// landings on the foot and on the knee are separated by worse ones, and the wider set of basins would displace the
/// other. Allocates nothing.
class Archive {
 public:
  static constexpr std::size_t kMost = 64;

  /// Capacity for each first contact, 1 to kMost, which is that of all; minimum distance of two members, as a fraction
  /// of the box, >= 0.
  Archive(std::size_t capacity, double separation) : capacity_(std::min(capacity, kMost)), separation_(separation) {}

  /// Inserts a candidate that could be followed: it replaces all members within `separation`, or the worst where no
  /// place is left. Refused where a member that close is at least as good, or where it is no better than the worst.
  /// Returns whether it was inserted.
  bool add(const Candidate& p) {
    if (!(p.value < bound_of(p)) || beside(p, p.value)) return false;
    const auto too_close = [&](const Candidate& q) { return same_contact(p, q) && distance(p, q) < separation_; };
    size_ = std::size_t(std::remove_if(all_.begin(), all_.begin() + long(size_), too_close) - all_.begin());
    if (const Candidate* worst = worst_of(p)) {
      std::move(worst + 1, end(), all_.begin() + (worst - begin()));
      --size_;
    }
    const auto place = std::upper_bound(all_.begin(), all_.begin() + long(size_), p);
    std::move_backward(place, all_.begin() + long(size_), all_.begin() + long(size_) + 1);
    *place = p, ++size_;
    return true;
  }
  /// Whether a member within `separation` of p has at most `value`.
  bool beside(const Candidate& p, double value) const {
    return std::any_of(begin(), end(),
                       [&](auto& q) { return q.value <= value && same_contact(p, q) && distance(p, q) < separation_; });
  }
  /// The value below which a candidate can be inserted: the worst of a full archive; kNoMotion where it is not full.
  /// With several first contacts, those whose lowest value is above kGood times the lowest do not count.
  double bound() const {
    double out = 0;
    bool several = false;
    for_each_contact([&](const Candidate& best) { out = std::max(out, bound_of(best)), several |= &best != begin(); });
    return empty() ? kNoMotion : several ? std::min(out, kGood * lowest()) : out;
  }
  /// The lowest value; kNoMotion of an empty archive.
  double lowest() const { return size_ > 0 ? all_[0].value : kNoMotion; }
  /// The lowest value with the first contact of p.
  double lowest(const Candidate& p) const {
    const auto* best = std::find_if(begin(), end(), [&](auto& q) { return same_contact(p, q); });
    return best == end() ? kNoMotion : best->value;
  }
  /// The best member with one of the first contacts: of the best member with probability 1/2, else of any that counts.
  const Candidate& draw_best(Random& random) const {
    std::array<const Candidate*, kMost> good{};
    int n = 0;
    for_each_contact([&](const Candidate& best) { good[std::size_t(n++)] = &best; });
    return *good[n == 1 || random.uniform() < 0.5 ? 0 : std::size_t(random_index(random, n))];
  }
  /// A random member with the first contact of draw_best, a better one with higher probability.
  const Candidate& draw(Random& random) const {
    const Candidate& best = draw_best(random);
    std::size_t left = biased_index(random, count_of(best));
    return *std::find_if(begin(), end(), [&](auto& q) { return same_contact(best, q) && left-- == 0; });
  }

  /// Calls f with the best member of each first contact that counts, the best first.
  template <class F>
  void for_each_contact(F&& f) const {
    for (const Candidate* p = begin(); p != end() && p->value <= kGood * lowest(); ++p)
      if (std::none_of(begin(), p, [&](auto& q) { return same_contact(*p, q); })) f(*p);
  }

  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  const Candidate& operator[](std::size_t i) const { return all_[i]; }
  const Candidate* begin() const { return all_.data(); }
  const Candidate* end() const { return all_.data() + size_; }

 private:
  static constexpr double kGood = 2;

  /// Whether two candidates touch the floor with the same contact first, as far as that is known.
  static bool same_contact(const Candidate& a, const Candidate& b) {
    return a.first_contact < 0 || b.first_contact < 0 || a.first_contact == b.first_contact;
  }
  std::size_t count_of(const Candidate& p) const {
    return std::size_t(std::count_if(begin(), end(), [&](auto& q) { return same_contact(p, q); }));
  }
  /// The member that is to give way to p; null where there is a place.
  const Candidate* worst_of(const Candidate& p) const {
    const bool full = count_of(p) == capacity_;
    if (!full && size_ < kMost) return nullptr;
    const Candidate* worst = end() - 1;
    while (full && !same_contact(p, *worst)) --worst;
    return worst;
  }
  double bound_of(const Candidate& p) const {
    const Candidate* worst = worst_of(p);
    return worst ? worst->value : kNoMotion;
  }
  std::array<Candidate, kMost> all_;
  std::size_t capacity_, size_ = 0;
  double separation_;
};

}  // namespace ukemi::landing
