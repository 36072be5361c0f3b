#include "identify/design/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/parallel.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

using Candidate = ProposedHit;

/// Assesses a hit: its safety and, where safe, its information.
Candidate assess(const Rig& rig, const Knowledge& k, const Hit& hit, const DesignOptions& o) {
  Candidate c{hit, safety_of(rig, k, hit, o), {}};
  if (!c.safety.safe()) return c;
  if (auto information = information_of(rig, k.sea, k.constants, blank_log(hit, o.log), o.log.noise))
    c.information = std::move(*information);
  else
    c.safety.outcome = HitSafety::Outcome::kEscapes;
  return c;
}

/// The grid, width by width, peaks ascending; then the strongest safe hit of each width, because the best hits lie at
/// the edge of the budget.
std::vector<Candidate> grid(const Rig& rig, const Knowledge& k, const DesignOptions& o) {
  const HitBudget& b = o.budget;
  const int widths = b.min_width < b.max_width ? o.widths : 1;
  const auto width = [&](int w) {
    return widths == 1 ? b.min_width : b.min_width + (b.max_width - b.min_width) * w / (widths - 1);
  };
  std::vector<Candidate> out(std::size_t(widths * o.peaks));
  parallel_for(int(out.size()), o.threads, [&](int i) {
    out[std::size_t(i)] = assess(rig, k, {b.peak * (i % o.peaks + 1) / o.peaks, width(i / o.peaks)}, o);
  });
  std::vector<std::optional<Candidate>> strongest(std::size_t(widths), std::nullopt);
  parallel_for(widths, o.threads, [&](int w) {
    const Candidate* row = &out[std::size_t(w * o.peaks)];
    int safe = 0;
    while (safe < o.peaks && row[safe].safety.safe()) ++safe;
    if (safe == 0 || safe == o.peaks) return;
    double low = row[safe - 1].hit.peak, high = row[safe].hit.peak;
    constexpr int kBisections = 8;
    for (int i = 0; i < kBisections; ++i) {
      const double middle = 0.5 * (low + high);
      Candidate c = assess(rig, k, {middle, width(w)}, o);
      const bool safe_hit = c.safety.safe();
      (safe_hit ? low : high) = middle;
      if (safe_hit) strongest[std::size_t(w)] = std::move(c);
    }
  });
  for (const auto& c : strongest)
    if (c) out.push_back(*c);
  return out;
}

using Set = std::vector<Candidate>;

MatrixXd total(const MatrixXd& prior, const Set& set) {
  MatrixXd sum = prior;
  for (const Candidate& c : set) sum += c.information;
  return sum;
}
double criterion_with(const MatrixXd& prior, const Set& set, std::size_t k, const Candidate& other,
                      Criterion criterion) {
  MatrixXd sum = prior;
  for (std::size_t i = 0; i < set.size(); ++i) sum += i == k ? other.information : set[i].information;
  return criterion_value(criterion, sum);
}

/// A smaller relative improvement is rounding.
constexpr double kBetter = 1 - 1e-9;

/// Greedy choice of one hit after the other, then exchanges while they improve the criterion (Fedorov's exchange).
Set choose(const MatrixXd& prior, const Set& pool, const DesignOptions& o) {
  Set set;
  for (int h = 0; h < o.hits; ++h) {
    const MatrixXd sum = total(prior, set);
    const Candidate* best = &pool.front();
    double lowest = kInfinite;
    for (const Candidate& c : pool)
      if (const double s = criterion_value(o.criterion, sum + c.information); s < lowest) lowest = s, best = &c;
    set.push_back(*best);
  }
  for (bool improved = true; improved;) {
    improved = false;
    for (std::size_t k = 0; k < set.size(); ++k)
      for (const Candidate& c : pool)
        if (criterion_with(prior, set, k, c, o.criterion) < kBetter * criterion_value(o.criterion, total(prior, set)))
          set[k] = c, improved = true;
  }
  return set;
}

/// Each hit moved off the grid: a pattern search whose steps halve, in the peak and, at one impulse, in the width.
void polish(const Rig& rig, const Knowledge& k, const DesignOptions& o, Set& set) {
  const HitBudget& b = o.budget;
  constexpr int kHalvings = 7;
  double dp = 0.5 * b.peak / o.peaks, dw = 0.5 * (b.max_width - b.min_width) / o.widths;
  const auto moved = [&](const Hit& h, double by_peak, double by_width) {
    const double width = std::clamp(h.width + by_width, b.min_width, b.max_width);
    return Hit{std::min(h.peak * h.width / width + by_peak, b.peak), width};
  };
  const auto improve = [&](std::size_t h, const Hit& hit) {
    if (hit.peak <= 0 || (hit.peak == set[h].hit.peak && hit.width == set[h].hit.width)) return false;
    // Information first: most moves reduce it, and the safety of a hit costs more.
    const auto information = information_of(rig, k.sea, k.constants, blank_log(hit, o.log), o.log.noise);
    if (!information) return false;
    Candidate c{hit, {}, *information};
    if (criterion_with(k.information, set, h, c, o.criterion) >=
        kBetter * criterion_value(o.criterion, total(k.information, set)))
      return false;
    c.safety = safety_of(rig, k, hit, o);
    if (!c.safety.safe()) return false;
    set[h] = c;
    return true;
  };
  for (int halving = 0; halving < kHalvings; ++halving, dp /= 2, dw /= 2)
    for (bool improved = true; improved;) {
      improved = false;
      for (std::size_t h = 0; h < set.size(); ++h)
        for (const auto& [p, w] : {std::pair{dp, 0.0}, {-dp, 0.0}, {0.0, dw}, {0.0, -dw}})
          improved = improve(h, moved(set[h].hit, p, w)) || improved;
    }
}

/// Further apart than a tenth of the budget: another kind of hit.
bool another_kind(const Hit& a, const Hit& b, const HitBudget& budget) {
  return std::abs(a.peak - b.peak) > 0.1 * budget.peak ||
         std::abs(a.width - b.width) > 0.1 * (budget.max_width - budget.min_width);
}

/// Sets with one hit replaced by another kind, best first, each of another kind than those before it.
std::vector<RunnerUp> runners_up(const MatrixXd& prior, const Set& set, const Set& pool, const DesignOptions& o) {
  constexpr std::size_t kShown = 5;
  struct Swap {
    double size;
    std::size_t k;
    const Candidate* replacement;
  };
  std::vector<Swap> swaps;
  for (std::size_t k = 0; k < set.size(); ++k)
    for (const Candidate& c : pool)
      if (another_kind(c.hit, set[k].hit, o.budget))
        swaps.push_back({criterion_with(prior, set, k, c, o.criterion), k, &c});
  std::stable_sort(swaps.begin(), swaps.end(), [](const Swap& a, const Swap& b) { return a.size < b.size; });
  std::vector<Swap> kept;
  for (const Swap& s : swaps) {
    if (kept.size() == kShown || !std::isfinite(s.size)) break;
    if (std::all_of(kept.begin(), kept.end(),
                    [&](const Swap& q) { return another_kind(q.replacement->hit, s.replacement->hit, o.budget); }))
      kept.push_back(s);
  }
  std::vector<RunnerUp> out;
  for (const Swap& s : kept) {
    RunnerUp r{{}, s.size};
    for (std::size_t k = 0; k < set.size(); ++k) r.hits.push_back(k == s.k ? s.replacement->hit : set[k].hit);
    out.push_back(r);
  }
  return out;
}

}  // namespace

void DesignOptions::validate() const {
  const auto require = [](bool holds, const char* what, double value, const std::string& rule) {
    if (!holds) throw InputError(fmt::format("{}: {}: {}", what, shortest(value), rule));
  };
  const auto positive = [&](const char* what, double value, const char* unit) {
    require(value > 0 && std::isfinite(value), what, value, fmt::format("must be above 0 {}", unit));
  };
  positive("peak", budget.peak, "N");
  positive("width", budget.min_width, "s");
  require(budget.max_width >= budget.min_width && std::isfinite(budget.max_width), "width", budget.max_width,
          fmt::format("the longest pulse must be at least the shortest, {} s", shortest(budget.min_width)));
  require(budget.angle > 0 && budget.angle < kEscape, "angle", budget.angle, "must lie between 0 and pi rad");
  log.validate();
  positive("noise", log.noise, "rad");
  require(log.duration > log.start + budget.max_width, "duration", log.duration,
          fmt::format("the log must go on after the hit, which ends at {} s", shortest(log.start + budget.max_width)));
  require(log.rate * budget.min_width >= HitLog::kMinPulseSamples, "rate", log.rate,
          fmt::format("a pulse of {} s needs at least {} samples, or the log loses part of the impulse",
                      shortest(budget.min_width), HitLog::kMinPulseSamples));
  require(hits >= 1 && hits <= 20, "hits", hits, "must lie between 1 and 20");
  require(peaks >= 1 && widths >= 2 && draws >= 0, "grid", peaks, "at least one peak, two widths, no draws below 0");
}

Design design(const Rig& rig, const Knowledge& k, const DesignOptions& o) {
  rig.validate(), k.validate(), o.validate();
  Design out;
  out.before = half_widths(k.information, k.measurements);
  out.size_before = out.size_after = criterion_value(o.criterion, k.information);
  out.information = k.information, out.after = out.before;
  if (!covariance_of(k.information)) {
    out.status = Design::Status::kNotDetermined;
    out.message =
        "the constants are not determined by what is in hand: no hit can be called safe; add trials of weak "
        "hits first";
    return out;
  }
  const std::vector<Candidate> candidates = grid(rig, k, o);
  Set pool;
  const Candidate* weakest = nullptr;
  for (const Candidate& c : candidates) {
    ++out.candidates;
    if (c.safety.safe()) pool.push_back(c);
    if (c.safety.outcome == HitSafety::Outcome::kTooFar) ++out.too_far;
    if (c.safety.outcome == HitSafety::Outcome::kEscapes) ++out.escaping;
    if (!weakest || c.hit.peak * c.hit.width < weakest->hit.peak * weakest->hit.width) weakest = &c;
  }
  if (pool.empty()) {
    out.status = Design::Status::kNoSafeHit;
    out.message = fmt::format(
        "no hit of this budget is safe: even {:.3g} N for {:.3g} ms: {} (|phi_1| up to {:.3g} rad within the "
        "estimate's uncertainty); a larger angle, a weaker peak or a better estimate is needed",
        weakest->hit.peak, 1e3 * weakest->hit.width, name(weakest->safety.outcome), weakest->safety.worst_angle);
    return out;
  }
  Set set = choose(k.information, pool, o);
  polish(rig, k, o, set);
  out.runners_up = runners_up(k.information, set, pool, o);
  out.information = total(k.information, set);
  out.after = half_widths(out.information, k.measurements);
  out.size_after = criterion_value(o.criterion, out.information);
  const auto alternate = [&](Hit& hit, std::size_t index) {
    if (o.budget.directions == HitBudget::Directions::kAlternate && index % 2 == 1) hit.peak = -hit.peak;
  };
  for (std::size_t i = 0; i < set.size(); ++i) alternate(set[i].hit, i);
  out.hits = std::move(set);
  for (RunnerUp& r : out.runners_up)
    for (std::size_t i = 0; i < r.hits.size(); ++i) alternate(r.hits[i], i);
  return out;
}

}  // namespace ukemi::identify
