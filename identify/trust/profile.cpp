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

Profile profile(const Profiled& constant, const ProfileOptions& options) {
  options.validate();
  const Estimate& e = constant.estimate;
  if (!e.std) throw InputError(fmt::format("profile: {}: it has no standard error", e.name));
  Profile out{.constant = e.name, .unit = e.unit, .threshold = constant.half_width * constant.half_width};
  const double rig_variance = std::max(*e.std * *e.std - *e.std_noise * *e.std_noise, 0.0);
  const double rig_half_width = constant.half_width * std::sqrt(rig_variance);  // half its 95 % interval
  const int half = options.points / 2;
  out.value.assign(std::size_t(options.points), e.value);
  out.rise.assign(std::size_t(options.points), 0.0);
  for (const int side : {-1, 1}) {
    const double limit = side < 0 ? constant.lower : constant.upper;
    const double reach = std::min(options.reach * *e.std_noise, std::abs(limit - e.value));
    std::optional<double>& end = side < 0 ? out.low_noise : out.high_noise;
    for (int i = 1; i <= half; ++i) {
      const auto here = std::size_t(half + side * i), before = std::size_t(half + side * (i - 1));
      out.value[here] = e.value + side * reach * i / half;
      const double rise = constant.rise(out.value[here], i == 1 ? Profiled::From::kFit : Profiled::From::kLast);
      out.rise[here] = std::isfinite(rise) ? std::max(rise, 0.0) : std::numeric_limits<double>::infinity();
      if (!end && out.rise[here] > out.threshold)
        end = crossing(out.value[before], out.rise[before], out.value[here], out.rise[here], out.threshold);
    }
    if (!end) continue;
    const double width = std::hypot(*end - e.value, rig_half_width);
    (side < 0 ? out.low : out.high) = e.value + side * std::min(width, std::abs(limit - e.value));
  }
  return out;
}

Profile profile(const Experiment& experiment, const Fit& fit, const std::string& constant,
                const ProfileOptions& options) {
  experiment.validate(fit);
  const Estimate* found = find_constant(fit, constant);
  if (!found) throw InputError(fmt::format("profile: '{}': no such constant", constant));
  const FitOptions& given = experiment.options;
  const RigTerm& term = given.terms[constant];
  FitOptions held = given;
  std::erase(held.terms.free, constant);
  if (held.terms.free.empty())
    throw InputError(fmt::format("profile: {}: no other constant is free to follow it", constant));
  const double best = deviance(fit, experiment.trials, given);
  SeaParameters<double> last = fit.sea;
  const auto rise = [&](double value, Profiled::From from) {
    if (from == Profiled::From::kFit) last = fit.sea;
    term.set_in(last, value);
    const Fit f = refit(experiment.rig, experiment.trials, last, held);
    const double out =
        f.trials.empty() ? std::numeric_limits<double>::infinity() : deviance(f, experiment.trials, held) - best;
    if (std::isfinite(out)) last = f.sea;
    return out;
  };
  const double lower = std::max(given.terms.lower_of(term), 1e-6 * found->value);
  return profile({*found, fit.half_width, lower, given.terms.upper_of(term), rise}, options);
}

}  // namespace ukemi::identify
