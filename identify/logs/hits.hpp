// Where in a log the force acts: hits, what the load cell reads between them, gaps, and a force whose sign is flipped.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/logs/trial.hpp"

namespace ukemi::identify {

/// Samples first .. last of a trial's force, between which it acts.
struct LoggedHit {
  std::size_t first, last;
};
/// The hits of a log whose load cell adds `noise` [N, standard deviation] to `rest` [N]: from where the force leaves
/// rest by more than 5 times the noise, back and on to where it is within it. Without noise: wherever it is not at
/// rest.
std::vector<LoggedHit> hits(const Trial& trial, double noise, double rest = 0);

/// Standard deviation of the force before the first hit [N]; 0 where there are too few samples before it or where they
/// are no noise: samples that follow each other smoothly are a force.
double force_noise_before_first_hit(const Trial& trial);

/// Between hits nothing touches the link: there the force becomes what the load cell reads at rest, 0 unless its mean
/// before the first hit differs from 0 by more than 4 of its standard errors. Sets Trial::force_noise and force_rest.
/// `noise` [N] >= 0, or estimated as above and then from all samples between hits; with none, nothing changes. A force
/// that is not at rest between its hits, noise apart, is left as it is.
void rest_between_hits(Trial& trial, std::optional<double> noise = std::nullopt);

/// An interval in which samples are missing: 1.5 times what 95 % of the intervals are at most, or longer.
struct Gap {
  double t, length;                            ///< where it begins, how long it is [s]
  enum class Place { kAtRest, kInHit } place;  ///< kInHit: the force is lost there, or what it did to the angle at once
};
std::vector<Gap> gaps(const Trial& trial);

/// Correlation of the angle with the force within the first hit: near 1, the angle answers along the force. None where
/// the angle does not stand out of its noise, or the reference moves by then.
std::optional<double> answer_to_first_hit(const Trial& trial);

}  // namespace ukemi::identify
