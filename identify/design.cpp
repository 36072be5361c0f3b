#include "identify/design.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "common/parallel.hpp"
#include "common/random.hpp"
#include "identify/least_squares.hpp"

namespace ukemi::identify {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Jet = ceres::Jet<double, kSmallJet>;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::size_t slot(int constant) { return std::size_t(constant); }

/// The rig's angles with derivatives by each constant relative to its value.
RolloutStatus differentiate(const Rig& rig, const SeaParameters<double>& sea, const std::vector<int>& constants,
                            const PreparedTrial& trial, std::vector<Jet>& phi, std::vector<Jet>& phi_m) {
  auto p = sea.cast<Jet>();
  auto u = ukemi::constants(p);
  for (std::size_t i = 0; i < constants.size(); ++i) u[slot(constants[i])].v[long(i)] = u[slot(constants[i])].a;
  set_constants(p, u);
  return rollout(rig, p, {}, trial, {}, phi, phi_m);
}

SeaParameters<double> scaled(const Knowledge& k, const VectorXd& relative) {
  constexpr double kLeast = 1e-6;  // of a constant: none is below 0
  SeaParameters<double> sea = k.sea;
  auto u = ukemi::constants(sea);
  for (std::size_t i = 0; i < k.constants.size(); ++i)
    u[slot(k.constants[i])] *= std::max(1 + relative[long(i)], kLeast);
  set_constants(sea, u);
  return sea;
}

/// A hit that was looked over; `information` only where it is safe.
struct Candidate {
  Hit hit;
  HitSafety safety;
  MatrixXd information;
};

/// Looks a hit over: what it tells where it is safe.
Candidate look(const Rig& rig, const Knowledge& k, const Hit& hit, const DesignOptions& o) {
  Candidate c{hit, safety_of(rig, k, hit, o), {}};
  if (!c.safety.safe()) return c;
  if (auto information = information_of(rig, k.sea, k.constants, blank_log(hit, o.log), o.log.noise))
    c.information = std::move(*information);
  else
    c.safety.verdict = HitSafety::Verdict::kEscapes;
  return c;
}

/// The grid, a width after the other, peaks ascending; in each width the strongest hit that is safe too, for the best
/// hits lie where the budget ends.
std::vector<Candidate> grid(const Rig& rig, const Knowledge& k, const DesignOptions& o) {
  const HitBudget& b = o.budget;
  const int widths = b.min_width < b.max_width ? o.widths : 1;
  const auto width = [&](int w) {
    return widths == 1 ? b.min_width : b.min_width + (b.max_width - b.min_width) * w / (widths - 1);
  };
  std::vector<Candidate> out(std::size_t(widths * o.peaks));
  parallel_for(int(out.size()), o.threads, [&](int i) {
    out[std::size_t(i)] = look(rig, k, {b.peak * (i % o.peaks + 1) / o.peaks, width(i / o.peaks)}, o);
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
      Candidate c = look(rig, k, {middle, width(w)}, o);
      const bool holds = c.safety.safe();
      (holds ? low : high) = middle;
      if (holds) strongest[std::size_t(w)] = std::move(c);
    }
  });
  for (const auto& c : strongest)
    if (c) out.push_back(*c);
  return out;
}

using Set = std::vector<Candidate>;

MatrixXd total(const MatrixXd& in_hand, const Set& set) {
  MatrixXd sum = in_hand;
  for (const Candidate& c : set) sum += c.information;
  return sum;
}
double size_with(const MatrixXd& in_hand, const Set& set, std::size_t k, const Candidate& instead, Criterion by) {
  MatrixXd sum = in_hand;
  for (std::size_t i = 0; i < set.size(); ++i) sum += i == k ? instead.information : set[i].information;
  return size_of(by, sum);
}

/// Improvements below it are rounding.
constexpr double kBetter = 1 - 1e-9;

/// One hit after the other, then each exchanged for any other while that helps (Fedorov's exchange).
Set choose(const MatrixXd& in_hand, const Set& pool, const DesignOptions& o) {
  Set set;
  for (int h = 0; h < o.hits; ++h) {
    const MatrixXd sum = total(in_hand, set);
    const Candidate* best = &pool.front();
    double least = kInfinite;
    for (const Candidate& c : pool)
      if (const double s = size_of(o.criterion, sum + c.information); s < least) least = s, best = &c;
    set.push_back(*best);
  }
  for (bool improved = true; improved;) {
    improved = false;
    for (std::size_t k = 0; k < set.size(); ++k)
      for (const Candidate& c : pool)
        if (size_with(in_hand, set, k, c, o.criterion) < kBetter * size_of(o.criterion, total(in_hand, set)))
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
    // What it tells first: most moves tell less, and the safety of a hit costs more.
    const auto tells = information_of(rig, k.sea, k.constants, blank_log(hit, o.log), o.log.noise);
    if (!tells) return false;
    Candidate c{hit, {}, *tells};
    if (size_with(k.information, set, h, c, o.criterion) >= kBetter * size_of(o.criterion, total(k.information, set)))
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
std::vector<RunnerUp> runners_up(const MatrixXd& in_hand, const Set& set, const Set& pool, const DesignOptions& o) {
  constexpr std::size_t kShown = 5;
  struct Swap {
    double size;
    std::size_t k;
    const Candidate* instead;
  };
  std::vector<Swap> swaps;
  for (std::size_t k = 0; k < set.size(); ++k)
    for (const Candidate& c : pool)
      if (another_kind(c.hit, set[k].hit, o.budget))
        swaps.push_back({size_with(in_hand, set, k, c, o.criterion), k, &c});
  std::stable_sort(swaps.begin(), swaps.end(), [](const Swap& a, const Swap& b) { return a.size < b.size; });
  std::vector<Swap> kept;
  for (const Swap& s : swaps) {
    if (kept.size() == kShown || !std::isfinite(s.size)) break;
    if (std::all_of(kept.begin(), kept.end(),
                    [&](const Swap& q) { return another_kind(q.instead->hit, s.instead->hit, o.budget); }))
      kept.push_back(s);
  }
  std::vector<RunnerUp> out;
  for (const Swap& s : kept) {
    RunnerUp r{{}, s.size};
    for (std::size_t k = 0; k < set.size(); ++k) r.hits.push_back(k == s.k ? s.instead->hit : set[k].hit);
    out.push_back(r);
  }
  return out;
}

}  // namespace

const char* name(Criterion criterion) {
  return criterion == Criterion::kWorst ? "worst" : criterion == Criterion::kD ? "d" : "e";
}
const char* name(HitSafety::Verdict verdict) {
  switch (verdict) {
    case HitSafety::Verdict::kSafe:
      return "safe";
    case HitSafety::Verdict::kTooFar:
      return "beyond the largest angle";
    case HitSafety::Verdict::kEscapes:
      return "the link escapes";
  }
  return "?";
}

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
  positive("rate", log.rate, "Hz");
  positive("duration", log.duration, "s");
  positive("noise", log.noise, "rad");
  require(log.duration > log.start + budget.max_width, "duration", log.duration,
          fmt::format("the log must go on after the hit, which ends at {} s", shortest(log.start + budget.max_width)));
  require(log.rate * budget.min_width >= HitLog::kFewest, "rate", log.rate,
          fmt::format("a pulse of {} s needs at least {} samples, or the log loses part of the impulse",
                      shortest(budget.min_width), HitLog::kFewest));
  constexpr double kMost = 1e6;
  require(log.rate * log.duration <= kMost, "rate", log.rate, "at most a million samples a log");
  require(hits >= 1 && hits <= 20, "hits", hits, "must lie between 1 and 20");
  require(peaks >= 1 && widths >= 2 && draws >= 0, "grid", peaks, "at least one peak, two widths, no draws below 0");
}

Trial blank_log(const Hit& hit, const HitLog& log) {
  Trial trial;
  const int last = int(std::lround(log.duration * log.rate));
  for (int i = 0; i <= last; ++i) {
    const double t = i / log.rate, s = (t - log.start) / hit.width;
    trial.t.push_back(t);
    trial.force.push_back(s > 0 && s < 1 ? hit.peak * std::sin(std::numbers::pi * s) : 0);
  }
  trial.phi.assign(trial.t.size(), 0);
  if (log.outputs == HitLog::Outputs::kLinkAndMotor) trial.phi_motor = trial.phi;
  return trial;
}

std::optional<MatrixXd> information_of(const Rig& rig, const SeaParameters<double>& sea,
                                       const std::vector<int>& constants, const Trial& trial, double noise) {
  thread_local std::vector<Jet> phi, phi_m;
  const PreparedTrial prepared(trial);
  if (differentiate(rig, sea, constants, prepared, phi, phi_m) != RolloutStatus::kDone) return std::nullopt;
  using Square = Eigen::Matrix<double, kSmallJet, kSmallJet>;
  Square sum = Square::Zero();
  for (std::size_t i = 0; i < trial.phi.size(); ++i) sum.noalias() += phi[i].v * phi[i].v.transpose();
  for (std::size_t i = 0; i < trial.phi_motor.size(); ++i) sum.noalias() += phi_m[i].v * phi_m[i].v.transpose();
  const long n = long(constants.size());
  const MatrixXd out = sum.topLeftCorner(n, n) / (noise * noise);
  if (!out.allFinite()) return std::nullopt;
  return out;
}

std::vector<int> uncertain_constants(const Actuator& actuator) {
  const auto u = ukemi::constants(actuator.sea);
  const std::vector<std::string>& named = actuator.uncertain;
  std::vector<int> out;
  for (int c = 0; c < kConstants; ++c)
    if (u[slot(c)] > 0 &&
        (named.empty() || std::find(named.begin(), named.end(), kConstantNames[slot(c)]) != named.end()))
      out.push_back(c);
  return out;
}

Knowledge knowledge_of(const Rig& rig, const SeaParameters<double>& sea, const std::vector<int>& constants,
                       const std::vector<Trial>& trials, double noise) {
  const long n = long(constants.size());
  Knowledge k{.sea = sea, .constants = constants, .information = MatrixXd::Zero(n, n)};
  for (const Trial& t : trials) {
    const auto tells = information_of(rig, sea, constants, t, noise);
    if (!tells) throw InputError({t.file}, "the estimate cannot be followed through this trial: fit it first");
    k.information += *tells;
    k.measurements += long(t.measurements());
  }
  return k;
}

std::optional<Knowledge> knowledge_of(const Actuator& actuator) {
  Knowledge k{.sea = actuator.sea, .constants = uncertain_constants(actuator), .information = {}};
  if (actuator.uncertain.empty() || k.constants.empty()) return std::nullopt;
  const auto u = ukemi::constants(actuator.sea);
  std::vector<long> rows;
  VectorXd inverse(long(k.constants.size()));
  for (const int c : k.constants) {
    const auto at = std::find(actuator.uncertain.begin(), actuator.uncertain.end(), kConstantNames[slot(c)]);
    inverse[long(rows.size())] = 1 / u[slot(c)];
    rows.push_back(at - actuator.uncertain.begin());
  }
  const auto information =
      covariance_of(inverse.asDiagonal() * MatrixXd(actuator.covariance(rows, rows)) * inverse.asDiagonal());
  if (!information) return std::nullopt;
  k.information = *information;
  return k;
}

std::optional<MatrixXd> covariance_of(const MatrixXd& information) {
  // Unit diagonal first: what counts as singular then does not depend on scales.
  if (!(information.diagonal().array() > 0).all()) return std::nullopt;
  const VectorXd d = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(d.asDiagonal() * information * d.asDiagonal());
  constexpr double kSingular = 1e-13;
  const VectorXd& values = eigen.eigenvalues();
  if (!(values[0] > kSingular * values[values.size() - 1])) return std::nullopt;
  return MatrixXd(d.asDiagonal() * eigen.eigenvectors() * values.cwiseInverse().asDiagonal() *
                  eigen.eigenvectors().transpose() * d.asDiagonal());
}

VectorXd half_widths(const MatrixXd& information, long measurements) {
  const auto covariance = covariance_of(information);
  if (!covariance) return VectorXd::Constant(information.rows(), kInfinite);
  constexpr long kMany = 1'000'000'000;
  return t_quantile_975(measurements > 0 ? std::max(measurements - information.rows(), 1l) : kMany) *
         covariance->diagonal().cwiseSqrt();
}

double size_of(Criterion criterion, const MatrixXd& information) {
  const auto covariance = covariance_of(information);
  if (!covariance) return kInfinite;
  if (criterion == Criterion::kWorst) return std::sqrt(covariance->diagonal().maxCoeff());
  const VectorXd axes = Eigen::SelfAdjointEigenSolver<MatrixXd>(*covariance, Eigen::EigenvaluesOnly)
                            .eigenvalues()
                            .cwiseMax(0)
                            .cwiseSqrt();
  if (criterion == Criterion::kE) return axes.maxCoeff();
  return std::exp(axes.array().log().mean());
}

HitSafety safety_of(const Rig& rig, const Knowledge& k, const Hit& hit, const DesignOptions& o) {
  // Watched more closely and longer than it will be logged: the hit itself, not its samples, moves the link.
  constexpr double kSamplesInPulse = 40, kLongEnough = 1;
  HitLog close = o.log;
  close.rate = std::max(o.log.rate, kSamplesInPulse / hit.width);
  close.duration = std::max(o.log.duration, o.log.start + hit.width + kLongEnough);
  const Trial trial = blank_log(hit, close);
  const PreparedTrial prepared(trial);
  HitSafety out;
  thread_local std::vector<double> phi, phi_m;
  const auto stays = [&](const SeaParameters<double>& sea) {
    if (rollout(rig, sea, {}, prepared, {}, phi, phi_m) != RolloutStatus::kDone) {
      out.verdict = HitSafety::Verdict::kEscapes;
      return false;
    }
    for (const double a : phi) out.worst_angle = std::max(out.worst_angle, std::abs(a));
    if (out.worst_angle > o.budget.angle) out.verdict = HitSafety::Verdict::kTooFar;
    return out.safe();
  };
  if (!stays(k.sea)) {
    out.angle = out.worst_angle;
    return out;
  }
  out.angle = out.worst_angle;
  for (std::size_t i = 1; i + 1 < phi.size(); ++i) {
    const double d = phi_m[i] - phi[i],
                 rate = (phi_m[i + 1] - phi[i + 1] - phi_m[i - 1] + phi[i - 1]) * 0.5 * close.rate;
    const double tau = std::abs((k.sea.k_sea + k.sea.k_sea_cubic * d * d) * d + k.sea.c_sea * rate);
    out.torque = std::max(out.torque, tau);
    if (tau >= k.sea.tau_max) out.limited += 1 / close.rate;
  }

  constexpr double kChiSquare95[kConstants] = {3.841, 5.991, 7.815, 9.488, 11.070};
  const auto covariance = covariance_of(k.information);
  assert(covariance);
  const long n = covariance->rows();
  const double radius = std::sqrt(kChiSquare95[n - 1]);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(*covariance);
  const MatrixXd axes = radius * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();

  // Where the largest angle grows fastest: C g / sqrt(g' C g).
  thread_local std::vector<Jet> dphi, dphi_m;
  if (differentiate(rig, k.sea, k.constants, prepared, dphi, dphi_m) == RolloutStatus::kDone) {
    const Jet& farthest = *std::max_element(dphi.begin(), dphi.end(),
                                            [](const Jet& a, const Jet& b) { return std::abs(a.a) < std::abs(b.a); });
    const VectorXd g = axes.transpose() * farthest.v.head(n) * (farthest.a < 0 ? -1 : 1);
    if (g.norm() > 0 && !stays(scaled(k, axes * g.normalized()))) return out;
  }
  for (long a = 0; a < n; ++a)
    for (const double sign : {1.0, -1.0})
      if (!stays(scaled(k, sign * axes.col(a)))) return out;
  for (int draw = 0; draw < o.draws; ++draw) {
    Random random(o.seed, std::uint64_t(draw));
    VectorXd z(n);
    for (double& x : z) x = random.normal();
    if (!stays(scaled(k, axes * z.normalized()))) return out;
  }
  return out;
}

Design design(const Rig& rig, const Knowledge& k, const DesignOptions& o) {
  o.validate();
  Design out;
  out.before = half_widths(k.information, k.measurements);
  out.size_before = out.size_after = size_of(o.criterion, k.information);
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
    if (c.safety.verdict == HitSafety::Verdict::kTooFar) ++out.too_far;
    if (c.safety.verdict == HitSafety::Verdict::kEscapes) ++out.escaping;
    if (!weakest || c.hit.peak * c.hit.width < weakest->hit.peak * weakest->hit.width) weakest = &c;
  }
  if (pool.empty()) {
    out.status = Design::Status::kNoSafeHit;
    out.message = fmt::format(
        "no hit of this budget is safe: even {:.3g} N for {:.3g} ms: {} (|phi_1| up to {:.3g} rad within the "
        "estimate's uncertainty); a larger angle, a weaker peak or a better estimate is needed",
        weakest->hit.peak, 1e3 * weakest->hit.width, name(weakest->safety.verdict), weakest->safety.worst_angle);
    return out;
  }
  Set set = choose(k.information, pool, o);
  polish(rig, k, o, set);
  out.runners_up = runners_up(k.information, set, pool, o);
  out.information = total(k.information, set);
  out.after = half_widths(out.information, k.measurements);
  out.size_after = size_of(o.criterion, out.information);
  const auto turn = [&](Hit& hit, std::size_t place) {
    if (o.budget.directions == HitBudget::Directions::kAlternate && place % 2 == 1) hit.peak = -hit.peak;
  };
  for (std::size_t i = 0; i < set.size(); ++i) {
    out.hits.push_back({set[i].hit, set[i].safety, set[i].information});
    turn(out.hits.back().hit, i);
  }
  for (RunnerUp& r : out.runners_up)
    for (std::size_t i = 0; i < r.hits.size(); ++i) turn(r.hits[i], i);
  return out;
}

}  // namespace ukemi::identify
