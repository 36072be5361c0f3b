// Scouts: motions from anywhere, and beside the best of earlier ones, in lanes.
#pragma once

#include <cmath>
#include <vector>

#include "landing/search/archive.hpp"
#include "landing/search/population.hpp"
#include "landing/search/search.hpp"

namespace ukemi::landing {

/// Where the scouts of a batch are drawn.
struct Scouting {
  double anywhere;           ///< the share of them, 0..1; the others are close to an incumbent
  double nearest, farthest;  ///< how close: powers of ten, parts of the box
  double plain;              ///< see point_of
};

/// Follows scouts for their bounds; the best become incumbents.
inline void race(Search& search, Fidelity fidelity, Archive& incumbents, std::vector<Candidate>& batch) {
  search.evaluate(batch, fidelity);
  for (const Candidate& p : batch)
    if (p.value <= p.bound) incumbents.add(p);
}

/// A batch of scouts, each followed only while it may better what it competes with; the best become incumbents. The
/// better an incumbent, the more are drawn beside it. Allocates nothing where `batch` has room for kBatch.
inline void scout(Search& search, Random& random, const Scouting& how, Fidelity fidelity, Archive& incumbents,
                  std::vector<Candidate>& batch) {
  batch.assign(kBatch, search.nothing());
  for (Candidate& p : batch) {
    if (how.anywhere >= 1 || incumbents.empty() || random.uniform() < how.anywhere) {
      p = point_of(random, search.objective().space().variables(), how.plain);
      p.bound = incumbents.bound();
    } else {
      const Candidate& incumbent = incumbents[low_index(random, incumbents.size())];
      p = beside(incumbent, std::pow(10.0, random.uniform(how.nearest, how.farthest)), random);
      p.bound = incumbent.value;
    }
  }
  race(search, fidelity, incumbents, batch);
}

}  // namespace ukemi::landing
