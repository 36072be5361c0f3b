#include "identify/logs/log_check.hpp"

#include <fmt/format.h>

#include "common/noise.hpp"
#include "identify/logs/hits.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

void warn_of_short_pulses(const std::vector<Trial>& trials, std::vector<std::string>& warnings) {
  for (const Trial& t : trials)
    if (const int n = shortest_pulse(t); n > 0 && n < 8)
      warnings.push_back(fmt::format(
          "{}: a pulse of {} samples: below 8 the log loses part of the impulse and biases the fit", t.file, n));
}

/// Warns of gaps, each log's longest and those in hits; true where one is in a hit.
bool warn_of_gaps(const std::vector<Trial>& trials, std::vector<std::string>& warnings) {
  bool any_in_hit = false;
  for (const Trial& t : trials) {
    const std::vector<Gap> all = gaps(t);
    const Gap* longest = nullptr;
    bool in_hit = false;
    for (const Gap& g : all) {
      if (!longest || g.length > longest->length) longest = &g;
      if (g.place != Gap::Place::kInHit || in_hit) continue;
      in_hit = any_in_hit = true;
      warnings.push_back(
          fmt::format("{}: a gap of {:.3g} ms at {} s, in a hit: what the force did there is lost; no "
                      "constant is trusted",
                      t.file, 1e3 * g.length, t.clock_time(g.t)));
    }
    if (longest && !in_hit)
      warnings.push_back(fmt::format("{}: {} in the log, the longest of {:.3g} ms at {} s", t.file,
                                     all.size() == 1 ? "a gap" : fmt::format("{} gaps", all.size()),
                                     1e3 * longest->length, t.clock_time(longest->t)));
  }
  return any_in_hit;
}

/// Warns of a force whose sign is flipped; true where one is.
bool warn_of_signs(const std::vector<Trial>& trials, std::vector<std::string>& warnings) {
  constexpr double kFlippedBelow = -0.3;
  std::vector<const Trial*> flipped;
  std::size_t tested = 0;
  for (const Trial& t : trials)
    if (const auto correlation = first_hit_correlation(t)) {
      ++tested;
      if (*correlation < kFlippedBelow) flipped.push_back(&t);
    }
  if (flipped.empty()) return false;
  if (flipped.size() == tested) {
    warnings.push_back(
        "the link moves against the force in every trial: its sign is flipped? try -F: force=-... in "
        "--columns (or --force-columns)");
    return true;
  }
  for (const Trial* t : flipped)
    warnings.push_back(
        fmt::format("{}: the link moves against the force, unlike in {} of {} trials: its sign is flipped "
                    "in this log?",
                    t->file, tested - flipped.size(), tested));
  return true;
}

/// Warns of times and forces that look like another unit's: a hit lasts some 10 ms, and is of some newtons.
void warn_of_units(const std::vector<Trial>& trials, std::vector<std::string>& warnings) {
  constexpr double kSlow = 0.5, kWeak = 1;  // [s], [N]
  for (const Trial& t : trials) {
    if (t.t.size() < 2 || t.force.empty()) continue;
    if (const double interval = (t.t.back() - t.t.front()) / double(t.t.size() - 1); interval >= kSlow)
      warnings.push_back(
          fmt::format("{}: a sample every {:.3g} s: are the times in milliseconds? [s] is needed", t.file, interval));
    if (const double largest = largest_deviation(t.force); largest > 0 && largest < kWeak)
      warnings.push_back(
          fmt::format("{}: the force is {:.3g} N at most: is it in kilonewtons? [N] is needed", t.file, largest));
  }
}

}  // namespace

LogCheck check_logs(const std::vector<Trial>& trials) {
  LogCheck out;
  warn_of_units(trials, out.warnings);
  warn_of_short_pulses(trials, out.warnings);
  const bool gap_in_hit = warn_of_gaps(trials, out.warnings), flipped = warn_of_signs(trials, out.warnings);
  out.flawed = gap_in_hit || flipped;
  return out;
}

}  // namespace ukemi::identify
