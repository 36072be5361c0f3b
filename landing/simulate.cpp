#include "landing/simulate.hpp"

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/kernels.hpp"

namespace ukemi::landing {

const char* name(End end) {
  switch (end) {
    case End::kRest:
      return "rest";
    case End::kTimeLimit:
      return "t_end";
    case End::kAbandoned:
      return "abandoned";
    case End::kBroken:
      return "limit broken";
    case End::kFailed:
      return "failed";
  }
  return "?";
}

void SimulateOptions::validate() const {
  if (!(accuracy >= 1e-14 && accuracy <= 1e-2))
    throw InputError("accuracy: " + shortest(accuracy) + ": a relative tolerance from 1e-14 to 1e-2 is needed");
  if (!(max_step > 0)) throw InputError("max_step: " + shortest(max_step) + ": above 0 is needed");
  if (max_steps < 1) throw InputError("max_steps: " + std::to_string(max_steps) + ": at least 1 is needed");
}

Landing simulate(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                 const SimulateOptions& options, double rate) {
  Landing out;
  dispatch<true>(scene, sea, motion, options, out, &out, rate);
  return out;
}

}  // namespace ukemi::landing
