#include "landing/plan/body_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/parallel.hpp"
#include "common/stopwatch.hpp"
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
    scout(anywhere_first());
    while (!over()) {
      evolve_population();
      if (!over()) close_in(best_[0], kNarrow);
      if (!over()) restart();
    }
    judge();
    out_.evaluations = spent_, out_.seconds = watch_.seconds();
  }

 private:
  static constexpr std::size_t kFew = 16;  // of the best that lie apart, so many are remembered
  static constexpr double kApart = 0.03;   // in parts of the box
  static constexpr double kNarrow = 0.05;  // a distribution's first width beside a good place
  static constexpr double kReserve = 4;    // accurate landings that a deadline keeps back
  static constexpr std::size_t kPopulation = 24;

  bool over() const { return spent_ >= options_.evaluations || late() || options_.monitor.stopped(); }
  bool late() const { return options_.deadline && watch_.seconds() > *options_.deadline - reserve_; }
  double share() const {
    const double motions = double(spent_) / double(options_.evaluations);
    return options_.deadline ? std::max(motions, watch_.seconds() / (*options_.deadline - reserve_)) : motions;
  }

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
  /// Among the best few: in place of the one that it is near, else of the worst, if it is better.
  void keep(const Candidate& p) {
    if (best_.empty() || p.value < best_[0].value) out_.progress.push_back({spent_, watch_.seconds(), p.value});
    auto place = std::find_if(best_.begin(), best_.end(), [&](const Candidate& b) { return distance(b, p) < kApart; });
    if (place == best_.end() && best_.size() < kFew)
      best_.push_back(p);
    else if (place = place == best_.end() ? place - 1 : place; p < *place)
      *place = p;
    std::sort(best_.begin(), best_.end());
  }

  long anywhere_first() const {
    return options_.deadline ? 3 * kBatch : std::clamp(options_.evaluations / 20, long(kBatch), 20L * kBatch);
  }
  /// Motions from anywhere, and beside the best of those before; each followed only while it may be one of the few.
  void scout(long motions) {
    std::vector<Candidate> batch(kBatch);
    for (long n = 0; n < motions && !over(); n += kBatch) {
      const double bound = best_.size() < kFew ? kNoMotion : best_.back().value;
      for (Candidate& p : batch) {
        p = best_.empty() || n == 0 || random_.uniform() < 0.5
                ? random_point(random_, space_.dimension())
                : beside(best_[low_index(random_, best_.size())], std::pow(10.0, -random_.uniform(0.5, 1.5)), random_);
        p.bound = bound;
      }
      evaluate(batch);
    }
  }
  /// Differential evolution among the best few, and what lies beside them, until it has gathered or stands still.
  void evolve_population() {
    constexpr double kGathered = 0.02;
    constexpr int kPatience = 12;
    std::vector<Candidate> population(best_.begin(), best_.end());
    const std::size_t known = population.size();
    for (std::size_t i = known; i < kPopulation; ++i)
      population.push_back(known > 0 ? beside(best_[i % known], 0.1, random_)
                                     : random_point(random_, space_.dimension()));
    evaluate(std::span(population).subspan(known));
    std::vector<Candidate> trials(population.size());
    double before = kNoMotion;
    for (int still = 0; !over() && still < kPatience && spread(population) > kGathered;) {
      evolve([this](std::span<Candidate> p) { evaluate(p); }, random_, population, trials, {.leaders = 3});
      const double now = std::min_element(population.begin(), population.end())->value;
      still = now < before * (1 - 1e-3) ? 0 : still + 1;
      before = std::min(before, now);
    }
  }
  /// A distribution that finds its way down from a place.
  void close_in(const Candidate& from, double size) {
    constexpr double kFinest = 1e-5;
    constexpr int kPatience = 25;
    const int generation = 4 + int(3 * std::log(space_.dimension())) + 2;
    CovarianceAdaptation distribution;
    distribution.start(from.u, size, generation);
    std::vector<Candidate> points(static_cast<std::size_t>(generation));
    double bound = kNoMotion, before = kNoMotion;
    for (int still = 0; !over() && still < kPatience && distribution.widest() > kFinest;) {
      distribution.sample(random_, points);
      for (Candidate& p : points) p.bound = bound;
      evaluate(points);
      std::sort(points.begin(), points.end());
      if (over()) return;
      distribution.learn(points);
      bound = std::max(2 * points.back().value, from.value);  // what is far worse need not be ranked
      still = points[0].value < before * (1 - 1e-5) ? 0 : still + 1;
      before = std::min(before, points[0].value);
    }
  }
  /// Anew: from the best of fresh motions from anywhere, at a width that finds other basins, or beside a good one.
  void restart() {
    std::vector<Candidate> fresh(kBatch);
    const bool close = random_.uniform() < 0.5;
    for (Candidate& p : fresh) {
      p = close ? beside(best_[low_index(random_, best_.size())], 0.15, random_)
                : random_point(random_, space_.dimension());
      p.bound = best_.empty() ? kNoMotion : 3 * best_[0].value;
    }
    evaluate(fresh);
    const auto best = std::min_element(fresh.begin(), fresh.end());
    if (best->value < kNoMotion) close_in(*best, close ? kNarrow : 2 * kNarrow);
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
  std::vector<Candidate> best_;
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
