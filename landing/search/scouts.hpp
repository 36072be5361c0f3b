// Scouts: motions drawn uniformly and around the best of earlier ones, evaluated in lanes.
#pragma once

#include <cmath>
#include <vector>

#include "landing/search/archive.hpp"
#include "landing/search/population.hpp"
#include "landing/search/search.hpp"

namespace ukemi::landing {

/// Where the scouts of a batch are drawn.
struct Scouting {
  double uniform;            ///< share of uniform ones, 0..1; the others are around an incumbent
  double nearest, farthest;  ///< log10 of sigma around an incumbent, as a fraction of the box
  double neutral;            ///< see random_point
};

/// Evaluates scouts; those within their bounds become incumbents where they are good enough.
inline void evaluate_scouts(Search& search, Fidelity fidelity, Archive& incumbents, std::vector<Candidate>& batch) {
  search.evaluate(batch, fidelity);
  for (const Candidate& p : batch)
    if (p.value <= p.bound) incumbents.add(p);
}

/// A batch of scouts, each followed only while it may improve on an incumbent; the best become incumbents. A better
/// incumbent is more often sampled around. Allocates nothing where `batch` has capacity for kBatch.
inline void scout(Search& search, Random& random, const Scouting& options, Fidelity fidelity, Archive& incumbents,
                  std::vector<Candidate>& batch) {
  batch.assign(kBatch, search.centre());
  for (Candidate& p : batch) {
    if (options.uniform >= 1 || incumbents.empty() || random.uniform() < options.uniform) {
      p = random_point(random, search.objective().variables(), options.neutral);
      p.bound = incumbents.bound();
    } else {
      const Candidate& incumbent = incumbents.draw(random);
      p = perturbed(incumbent, std::pow(10.0, random.uniform(options.nearest, options.farthest)), random);
      p.bound = incumbent.value;
    }
  }
  evaluate_scouts(search, fidelity, incumbents, batch);
}

}  // namespace ukemi::landing
