// What is counted while drops are played, and the points of Sobol's indices: the same for both kinds of robots.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "landing/judge/risk.hpp"
#include "landing/scatter/sampler.hpp"

namespace ukemi::landing {

/// Peaks of the motion and of the held reference, and the contacts that make them. A peak that is not finite: a
/// drop that could not be followed.
class PeakCensus {
 public:
  void held(double peak) { count(peak, held_, held_failed_); }
  /// Returns whether the drop could be followed.
  bool motion(double peak) { return count(peak, peaks_, failed_); }
  /// The contact that made the motion's peak, of a drop that could be followed.
  void contact(int number, int point) { ++contacts_[{number, point}]; }
  /// peaks, held, both failed, contacts, histogram.
  void finish(PeakRisk& out) const;

 private:
  static bool count(double peak, std::vector<double>& peaks, long& failed);

  std::vector<double> peaks_, held_;
  std::map<std::pair<int, int>, long> contacts_;
  long failed_ = 0, held_failed_ = 0;
};

/// Sobol's indices of the groups of a sampler: n base points each of A and B, and of A with one group of numbers at a
/// time from B.
class IndexPlan {
 public:
  /// As many points as samples, or none where fewer than two groups scatter.
  IndexPlan(const Sampler& sampler, long samples);
  long landings() const { return n_ * long(blocks()); }
  /// Why there are no indices of drawn drops; `stopped`: the run ended before they were begun.
  PeakRisk::WhyNone why_none(bool stopped) const;
  /// Peaks of so many points, infinite where there is none; empty: the run was stopped.
  using Peaks = std::function<std::optional<std::vector<double>>(const std::vector<double>& points, long count)>;
  /// Plays them, no more than `chunk` at once unless there are more groups; uncertainties, index_landings,
  /// index_failed.
  void work_out(PeakRisk& out, long chunk, std::uint64_t seed, int threads, const Peaks& play) const;

 private:
  std::size_t blocks() const { return sampler_->groups().size() + 2; }
  /// Those of `count` base points, block by block.
  std::vector<double> points(long count, std::uint64_t seed, long first) const;

  const Sampler* sampler_;
  long n_ = 0;
};

}  // namespace ukemi::landing
