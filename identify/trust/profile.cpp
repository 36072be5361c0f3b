#include "identify/trust/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/csv.hpp"
#include "common/error.hpp"

namespace ukemi::identify {

void ProfileOptions::validate() const {
  if (!(points >= 5 && points % 2 == 1))
    throw InputError(fmt::format("profile: {} points: an odd number of at least 5 is needed", points));
  if (!(reach > 0 && std::isfinite(reach)))
    throw InputError(fmt::format("profile: reach {}: must be above 0", shortest(reach)));
}

namespace {

/// Where the rise crosses the threshold between two points of the grid: linear in its root, which is straight where the
/// profile is a parabola.
double crossing(double from, double rise_from, double to, double rise_to, double threshold) {
  const double a = std::sqrt(rise_from), b = std::sqrt(rise_to), c = std::sqrt(threshold);
  return std::isfinite(b) ? from + (to - from) * (c - a) / (b - a) : from;
}

}  // namespace

Profile profile(const Experiment& experiment, const Fit& fit, const std::string& constant,
                const ProfileOptions& options) {
  experiment.validate(fit), options.validate();
  const auto found =
      std::find_if(fit.parameters.begin(), fit.parameters.end(), [&](const Estimate& e) { return e.name == constant; });
  if (found == fit.parameters.end()) throw InputError(fmt::format("profile: '{}': no such constant", constant));
  if (!found->std) throw InputError(fmt::format("profile: {}: it has no standard error", constant));
  const FitOptions& given = experiment.options;
  const RigTerm& term = given.terms[constant];
  FitOptions held = given;
  std::erase(held.terms.free, constant);
  if (held.terms.free.empty())
    throw InputError(fmt::format("profile: {}: no other constant is free to follow it", constant));
  const double best = deviance(fit, experiment.trials, given);

  Profile out{.constant = constant, .unit = found->unit, .threshold = fit.half_width * fit.half_width};
  const double variance_of_the_rig = std::max(*found->std * *found->std - *found->std_noise * *found->std_noise, 0.0);
  const double of_the_rig = fit.half_width * std::sqrt(variance_of_the_rig);  // half the width of its 95 % interval
  const int half = options.points / 2;
  out.value.assign(std::size_t(options.points), found->value);
  out.rise.assign(std::size_t(options.points), 0.0);
  for (const int side : {-1, 1}) {
    const double limit =
        side < 0 ? std::max(given.terms.lower_of(term), 1e-6 * found->value) : given.terms.upper_of(term);
    const double reach = std::min(options.reach * *found->std_noise, std::abs(limit - found->value));
    SeaParameters<double> from = fit.sea;  // each point starts where the one before it ended
    std::optional<double>& end = side < 0 ? out.low_noise : out.high_noise;
    for (int i = 1; i <= half; ++i) {
      const auto here = std::size_t(half + side * i), before = std::size_t(half + side * (i - 1));
      out.value[here] = found->value + side * reach * i / half;
      term.set_in(from, out.value[here]);
      const Fit f = refit(experiment.rig, experiment.trials, from, held);
      const double rise = deviance(f, experiment.trials, held) - best;
      out.rise[here] =
          f.trials.empty() || !std::isfinite(rise) ? std::numeric_limits<double>::infinity() : std::max(rise, 0.0);
      if (std::isfinite(out.rise[here])) from = f.sea;
      if (!end && out.rise[here] > out.threshold)
        end = crossing(out.value[before], out.rise[before], out.value[here], out.rise[here], out.threshold);
    }
    if (!end) continue;
    const double width = std::hypot(*end - found->value, of_the_rig);
    (side < 0 ? out.low : out.high) = found->value + side * std::min(width, std::abs(limit - found->value));
  }
  return out;
}

}  // namespace ukemi::identify
