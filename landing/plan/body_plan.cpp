#include "landing/plan/body_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/parallel.hpp"
#include "common/stopwatch.hpp"
#include "landing/search/archive.hpp"
#include "landing/search/cma.hpp"
#include "landing/search/population.hpp"

namespace ukemi::landing {

BodySpace::BodySpace(const BodyScene& scene) : rest_(held_posture(scene)) {
  for (std::size_t i = 0; i < scene.robot.joints.size(); ++i) {
    const Joint& joint = scene.robot.joints[i];
    if (!joint.driven()) continue;
    driven_.push_back(int(i));
    const auto& [low, high] = scene.search[i].phi;
    variables_.push_back({"phi_i_" + joint.name, "phi_I of " + joint.name, "rad", low, high});
    variables_.push_back({"phi_f_" + joint.name, "phi_F of " + joint.name, "rad", low, high});
  }
  if (driven_.empty()) throw InputError("no joint is driven: there is no motion to plan");
  variables_.push_back({"duration", "duration", "s", scene.duration[0], scene.duration[1]});
  if (dimension() > kMostVariables)
    throw InputError(
        fmt::format("{} driven joints: a plan holds at most {}", driven_.size(), (kMostVariables - 1) / 2));
}

BodyMotion BodySpace::motion(const Coordinates& unit) const {
  BodyMotion out = rest_;
  const auto value = [&](std::size_t k) { return std::lerp(variables_[k].lower, variables_[k].upper, unit[long(k)]); };
  for (std::size_t j = 0; j < driven_.size(); ++j)
    out[std::size_t(driven_[j])] = {value(2 * j), value(2 * j + 1), value(2 * driven_.size())};
  return out;
}

Coordinates BodySpace::unit(const BodyMotion& motion) const {
  Coordinates out(dimension());
  const auto set = [&](std::size_t k, double value) {
    const Variable& v = variables_[k];
    out[long(k)] = std::clamp((value - v.lower) / (v.upper - v.lower), 0.0, 1.0);
  };
  for (std::size_t j = 0; j < driven_.size(); ++j) {
    const Motion& m = motion[std::size_t(driven_[j])];
    set(2 * j, m.phi_i), set(2 * j + 1, m.phi_f), set(2 * driven_.size(), m.duration);
  }
  return out;
}

Edges BodySpace::edges(const Coordinates& unit) const {
  constexpr double kEdge = 1e-3;
  Edges out{};
  for (int k = 0; k < dimension(); ++k) out[std::size_t(k)] = unit[k] < kEdge ? -1 : unit[k] > 1 - kEdge ? 1 : 0;
  return out;
}

void BodyPlanOptions::validate() const {
  check_count("evaluations", evaluations, 1, 1'000'000'000);
  if (deadline) check_positive("deadline", *deadline);
  SimulateOptions{.accuracy = accuracy}.validate();
}

namespace {

constexpr double kSearchAccuracy = 1e-6;

/// The search's state: what was spent, the best few so far.
class BodySearch {
 public:
  BodySearch(const BodyScene& scene, const BodyPlanOptions& options, BodyPlan& out)
      : scene_(scene), options_(options), space_(scene), out_(out), random_(options.seed) {}

  void run() {
    out_.variables = space_.variables();
    hold();
    scout(options_.deadline ? kFirst : std::clamp(options_.evaluations / 8, kFirst, kMostScouts), 0.6);
    const Archive first = starts_;
    for (std::size_t i = 0; i < std::min(kRuns, first.size()) && !over(); ++i) close_in(first[i], kNarrow, kRough);
    while (!over()) {
      if (share() > kLate && !best_.empty())
        close_in(Candidate(best_[0]), kRefined, kFine);
      else if (!basins_.empty() && random_.uniform() < 0.35)
        start_beside_a_basin();
      else
        start_anywhere();
    }
    judge();
    out_.evaluations = spent_, out_.seconds = watch_.seconds();
  }

 private:
  static constexpr std::size_t kFew = 16;                // of the best that lie apart, so many are remembered
  static constexpr double kApart = 0.03;                 // in parts of the box
  static constexpr double kNarrow = 0.05;                // a distribution's first width beside a good place
  static constexpr double kReserve = 4;                  // accurate landings that a deadline keeps back
  static constexpr std::size_t kStarts = 12, kRuns = 3;  // places that scouts keep; that are searched from at first
  static constexpr std::size_t kBasins = 8;
  static constexpr double kStartsApart = 0.1, kBasinsApart = 0.2;
  static constexpr long kFirst = 96, kMostScouts = 1'500, kRace = 64;  // motions of the scouts

  /// When a run ends: its width, in parts of the box; by which part of its value it must better itself meanwhile.
  struct Enough {
    double width, better;
  };
  static constexpr Enough kRough{2e-3, 3e-3}, kFine{1e-5, 1e-5};
  static constexpr double kLate = 0.85, kRefined = 0.01;  // from this share on the best place is refined, so narrow

  double share() const {
    const double motions = double(spent_) / double(options_.evaluations);
    return options_.deadline ? std::max(motions, watch_.seconds() / (*options_.deadline - reserve_)) : motions;
  }
  bool over() const { return spent_ >= options_.evaluations || late() || options_.monitor.stopped(); }
  bool late() const { return options_.deadline && watch_.seconds() > *options_.deadline - reserve_; }

  /// The posture that is held, judged before all.
  void hold() {
    out_.hold = held_posture(scene_);
    const double before = watch_.seconds();
    out_.held = simulate(scene_, out_.hold, {.accuracy = options_.accuracy}, options_.rate);
    reserve_ = kReserve * (watch_.seconds() - before);
    ++spent_;
    if (no_landing(out_.held.end)) return;
    out_.motion = out_.hold, out_.landing = out_.held, out_.found = true;
    Candidate c{space_.unit(out_.hold)};
    c.value = out_.held.peak;
    keep(c);
  }

  /// Values of as many of the points as the budget allows; the others come back with kNoMotion.
  void evaluate(std::span<Candidate> points) {
    const long left = std::max(0L, options_.evaluations - spent_);
    const auto allowed = std::min(points.size(), std::size_t(left));
    const std::function<bool()> stop = [this] { return late() || options_.monitor.stopped(); };
    for (Candidate& p : points) p.value = kNoMotion;
    parallel_for(int(allowed), options_.threads, [&](int i) {
      if (stop()) return;
      Candidate& p = points[std::size_t(i)];
      const BodyLanding l = peak_acceleration(scene_, space_.motion(p.u),
                                              {.accuracy = kSearchAccuracy, .abandon_above = p.bound, .over = &stop});
      if (!no_landing(l.end) && l.end != End::kStopped) p.value = l.peak;
    });
    spent_ += long(allowed);
    for (std::size_t i = 0; i < allowed; ++i)
      if (points[i].value <= points[i].bound && points[i].value < kNoMotion) keep(points[i]);
    options_.monitor.progress(spent_, options_.evaluations);
  }
  void keep(const Candidate& p) {
    if (best_.empty() || p.value < best_[0].value) out_.progress.push_back({spent_, watch_.seconds(), p.value});
    best_.add(p);
  }

  /// Motions from anywhere, and beside the best of those before; each followed only while it may be a start.
  void scout(long motions, double anywhere) {
    starts_.clear();
    std::vector<Candidate> batch(kBatch);
    for (long n = 0; n < motions && !over(); n += kBatch) {
      const double bound = starts_.bound();
      for (Candidate& p : batch) {
        p = starts_.empty() || random_.uniform() < anywhere
                ? random_point(random_, space_.dimension())
                : beside(starts_[low_index(random_, starts_.size())], std::pow(10.0, -random_.uniform(0.5, 1.5)),
                         random_);
        p.bound = bound;
      }
      evaluate(batch);
      for (const Candidate& p : batch)
        if (p.value <= p.bound && p.value < kNoMotion) starts_.add(p);
    }
  }
  /// A distribution that finds its way down from a place, until it has gathered, stands still or falls behind.
  void close_in(const Candidate& start, double size, const Enough& enough) {
    constexpr double kBound = 1.3, kBehind = 1.6, kForgives = 0.97;
    constexpr int kFree = 8, kPoints = 14;
    const int patience = 10 + 2 * space_.dimension();
    CovarianceAdaptation distribution;
    distribution.start(start.u, size, kPoints);
    std::vector<Candidate> points(kPoints);
    Candidate best = start;
    double bound = kNoMotion, milestone = kNoMotion;
    for (int n = 0, still = 0; !over() && still < patience && distribution.widest() > enough.width; ++n) {
      distribution.sample(random_, points);
      for (Candidate& p : points) p.bound = bound;
      evaluate(points);
      if (over()) break;
      std::sort(points.begin(), points.end());
      if (points[0] < best) best = points[0];
      const double middle = points[kPoints / 2].value;
      bound = middle < kNoMotion ? kBound * middle : kNoMotion;  // what is worse is not learnt from
      distribution.learn(points);
      still = best.value < milestone * (1 - enough.better) ? 0 : still + 1;
      if (still == 0) milestone = best.value;
      if (n > kFree && best.value > best_[0].value * (1 + (kBehind - 1) * std::pow(kForgives, n - kFree))) break;
    }
    basins_.add(best);
  }
  void start_beside_a_basin() {
    const double size = std::pow(10.0, -random_.uniform(0.7, 2));
    close_in(beside(basins_[low_index(random_, basins_.size())], size, random_), size, kRough);
  }
  void start_anywhere() {
    scout(kRace, 1);
    if (!starts_.empty())
      close_in(Candidate(starts_[low_index(random_, std::min(kRuns, starts_.size()))]), kNarrow, kRough);
  }

  /// The best few at a tight accuracy: many a best stands on a cliff.
  void judge() {
    for (const Candidate& p : best_) {
      if (out_.found && !(p.value < out_.landing.peak)) break;  // those behind it are no better
      if (options_.deadline && out_.landing.peak < out_.held.peak && watch_.seconds() > *options_.deadline) break;
      const BodyMotion motion = space_.motion(p.u);
      const BodyLanding l = simulate(scene_, motion, {.accuracy = options_.accuracy}, options_.rate);
      if (no_landing(l.end) || (out_.found && !(l.peak < out_.landing.peak))) continue;
      out_.motion = motion, out_.landing = l, out_.found = true, out_.edges = space_.edges(p.u);
    }
    if (!out_.found)
      out_.message = out_.held.end == End::kNoContact ? "no contact touches the floor: there is no landing to plan"
                                                      : "no motion could be followed to the floor";
    else if (options_.monitor.stopped())
      out_.message = "interrupted: the best so far";
  }

  const BodyScene& scene_;
  const BodyPlanOptions& options_;
  const BodySpace space_;
  BodyPlan& out_;
  Random random_;
  Archive best_{kFew, kApart}, starts_{kStarts, kStartsApart}, basins_{kBasins, kBasinsApart};
  Stopwatch watch_{Stopwatch::Time::kWall};
  double reserve_ = 0;  ///< [s]
  long spent_ = 0;
};

}  // namespace

BodyPlan plan(const BodyScene& scene, const BodyPlanOptions& options) {
  scene.validate(), options.validate();
  BodyPlan out;
  BodySearch(scene, options, out).run();
  return out;
}

}  // namespace ukemi::landing
