// Counts over played drops and the points of Sobol's indices, for both kinds of robots.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "landing/judge/risk.hpp"
#include "landing/scatter/sampler.hpp"

namespace ukemi::landing {

/// Collects peaks of the motion and of the held reference, and the contacts of the peaks. A peak that is not finite
/// stands for a drop that could not be followed.
class PeakCensus {
 public:
  void add_held(double peak) { count(peak, held_, held_failed_); }
  /// Returns whether the drop could be followed.
  bool add_motion(double peak) { return count(peak, peaks_, failed_); }
  /// The contact of the motion's peak, in a drop that could be followed.
  void add_contact(const RunEnd& l) {
    ++contacts_[{l.peak_contact + 1, l.peak_contact < 0 ? -1 : l.contacts[l.peak_contact]}];
  }
  /// Sets peaks, held, failed, held_failed, contacts and histogram.
  void report(PeakRisk& out) const;

 private:
  static bool count(double peak, std::vector<double>& peaks, long& failed);

  std::vector<double> peaks_, held_;
  std::map<std::pair<int, int>, long> contacts_;
  long failed_ = 0, held_failed_ = 0;
};

/// Indices of the drops with the highest peaks, at most Risk::kWorst.
class WorstDrops {
 public:
  void add(double peak, long index) { drops_.emplace_back(peak, index); }
  /// Sorts them, the worst first, and drops the others; of equal peaks the first index is first.
  void sort();
  const std::vector<std::pair<double, long>>& drops() const { return drops_; }

 private:
  std::vector<std::pair<double, long>> drops_;
};

/// Sobol's indices of the groups of a sampler: n base points each of A and B, and for each group those of A with its
/// numbers from B.
class IndexPlan {
 public:
  /// About as many points as samples; none where fewer than two groups scatter.
  IndexPlan(const Sampler& sampler, long samples);
  long landings() const { return n_ * long(blocks()); }
  /// Why there are no indices; `stopped`: the run ended before their start.
  PeakRisk::WhyNone why_none(bool stopped) const;
  /// Peaks of `count` points, infinite where not followed; absent: the run was stopped.
  using Peaks = std::function<std::optional<std::vector<double>>(const std::vector<double>& points, long count)>;
  /// Plays the points, at most `chunk` at once unless there are more groups; sets uncertainties, index_landings and
  /// index_failed.
  void compute(PeakRisk& out, long chunk, std::uint64_t seed, int threads, const Peaks& play) const;

 private:
  std::size_t blocks() const { return sampler_->groups().size() + 2; }
  /// Points of `count` base points, block by block.
  std::vector<double> points(long count, std::uint64_t seed, long first) const;

  const Sampler* sampler_;
  long n_ = 0;
};

}  // namespace ukemi::landing
