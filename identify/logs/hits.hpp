// Where in a log the force acts: hits, what the load cell reads between them, gaps, and a force whose sign is flipped.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/logs/trial.hpp"

namespace ukemi::identify {

/// The force is at rest in a sample at most this far from it, in standard deviations of its noise.
inline constexpr double kHitEnd = 2.5;

/// A hit: samples first .. last of a trial's force.
struct LoggedHit {
  std::size_t first, last;
};
/// The hits of a log whose load cell adds `noise` [N, standard deviation] to `rest` [N]: each sample
/// farther from rest than 5 times the noise, extended both ways to the first sample within kHitEnd times the
/// noise, that one included: a hit that ended before it would lose the force there.
std::vector<LoggedHit> hits(const Trial& trial, double noise, double rest = 0);

/// Standard deviation of the force before the first hit [N]; 0 where there are too few samples before it, or where they
/// are smooth: then they are a force, not noise.
double force_noise_before_first_hit(const Trial& trial);

/// Sets the force between hits, where nothing touches the link, to the load cell's reading at rest: 0 unless its mean
/// between hits differs from 0 by more than 4 of its standard errors. Sets Trial::force_noise and force_rest.
/// `noise` [N] >= 0; absent: estimated as above, then from all samples between hits. No change without noise, or where
/// the force is not at rest between its hits.
void flatten_force_between_hits(Trial& trial, std::optional<double> noise = std::nullopt);

/// Samples of the shortest pulse of the force (a run above 5 % of the largest |force|); 0 without force.
int shortest_pulse(const Trial& trial);

/// An interval in which samples are missing: at least 1.5 times the 95 % quantile of the intervals.
struct Gap {
  double t, length;                            ///< start and length [s]
  enum class Place { kAtRest, kInHit } place;  ///< kInHit: the force, or its immediate effect, was not logged
};
std::vector<Gap> gaps(const Trial& trial);

/// Correlation of the angle with the force within the first hit: 1 where the link moves along the force. None where the
/// angle does not exceed its noise, or the reference has moved by then.
std::optional<double> first_hit_correlation(const Trial& trial);

}  // namespace ukemi::identify
