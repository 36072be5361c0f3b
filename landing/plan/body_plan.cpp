#include "landing/plan/body_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "common/checks.hpp"
#include "common/parallel.hpp"
#include "common/stopwatch.hpp"
#include "landing/body/load.hpp"
#include "landing/plan/body_drops.hpp"
#include "landing/plan/body_goal.hpp"
#include "landing/plan/body_space.hpp"
#include "landing/scatter/sampler.hpp"
#include "landing/search/archive.hpp"
#include "landing/search/cma.hpp"
#include "landing/search/population.hpp"

namespace ukemi::landing {

long BodyPlanOptions::default_evaluations(const BodyScene& scene) const {
  const long own = measure ? 100'000 : goal == Goal::kTolerant ? 5'000 : 40'000;
  const auto driven =
      std::count_if(scene.robot.joints.begin(), scene.robot.joints.end(), [](auto& j) { return j.driven(); });
  return own + own / 2 * std::max(0L, BodySpace(scene).dimension() - 2 * driven - 1);
}

void BodyPlanOptions::validate() const {
  if (evaluations) check_count("evaluations", *evaluations, 1, 1'000'000'000);
  if (goal == Goal::kRobust) throw InputError("goal: kPeak or kTolerant is needed: a measure makes it robust");
  if (measure) measure->validate();
  if (share && !(measure && *share > 0 && *share <= 1))
    throw InputError(fmt::format("share: {}: above 0 to 1, beside a measure of drops that scatter, is needed", *share));
  if (scatter) scatter->validate();
  check_not_negative("inflate", inflate);
  check_count("samples", samples, 1, 4096), check_count("judging", judging, 1, 4096);
  check_count("fresh", fresh, 0, 1'000'000);
  if (deadline) check_positive("deadline", *deadline);
  SimulateOptions{.accuracy = accuracy}.validate();
}

namespace {

/// An archive for every contact that may touch first. Landings on the foot and on the knee are separated by worse ones,
/// and the wider set of basins would displace the other from a common archive.
class ContactArchives {
 public:
  ContactArchives(std::size_t capacity, double separation) : capacity_(capacity), separation_(separation) {}
  void clear() { archives_.clear(); }
  bool empty() const { return archives_.empty(); }
  void add(const Candidate& p) {
    std::size_t at = find(p);
    if (at == archives_.size()) archives_.emplace_back(capacity_, separation_);
    archives_[at].add(p);
    for (; at > 0 && archives_[at].lowest() < archives_[at - 1].lowest(); --at)
      std::swap(archives_[at], archives_[at - 1]);
  }
  /// The lowest value with the same first contact as p; kNoMotion where there is none.
  double lowest(const Candidate& p) const {
    const std::size_t at = find(p);
    return at < archives_.size() ? archives_[at].lowest() : kNoMotion;
  }
  /// A random one of the first `limit` of a good archive: with probability 1/2 of the best archive.
  const Candidate& draw(Random& r, std::size_t limit = Archive::kMost) const {
    const int n = int(good_count());
    const Archive& archive = archives_[n == 1 || r.uniform() < 0.5 ? 0 : std::size_t(random_index(r, n))];
    return archive[biased_index(r, std::min(limit, archive.size()))];
  }
  /// A candidate that is no better enters no good archive and makes no other archive good.
  double bound() const {
    double out = 0;
    for (std::size_t i = 0; i < good_count(); ++i) out = std::max(out, archives_[i].bound());
    return empty() ? kNoMotion : std::min(out, kGoodRatio * archives_[0].lowest());
  }
  /// The first `limit` of each good archive, sorted.
  std::vector<Candidate> best(std::size_t limit = Archive::kMost) const {
    std::vector<Candidate> out;
    for (std::size_t i = 0; i < good_count(); ++i)
      out.insert(out.end(), archives_[i].begin(), archives_[i].begin() + std::min(limit, archives_[i].size()));
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  static constexpr double kGoodRatio = 2;  ///< maximum of a good archive's lowest value relative to the best
  /// Index of the archive with the same first contact as p; the size where there is none.
  std::size_t find(const Candidate& p) const {
    const auto same = [&](const Archive& a) { return a[0].first_contact == p.first_contact; };
    return std::size_t(std::find_if(archives_.begin(), archives_.end(), same) - archives_.begin());
  }
  /// Number of good archives, which come first.
  std::size_t good_count() const {
    const auto bad = [&](const Archive& a) { return a.lowest() > kGoodRatio * archives_[0].lowest(); };
    return std::size_t(std::find_if(archives_.begin(), archives_.end(), bad) - archives_.begin());
  }

  std::size_t capacity_;
  double separation_;
  std::vector<Archive> archives_;  ///< sorted by their lowest values
};

/// A search with its budget and its best so far.
class BodySearch {
 public:
  BodySearch(const BodyScene& scene, const BodyPlanOptions& options, BodyPlan& out)
      : scene_(scene),
        options_(options),
        judging_options_(options),
        space_(scene),
        out_(out),
        evaluations_(
            options.evaluations.value_or(options.deadline ? 1'000'000'000 : options.default_evaluations(scene))),
        random_(options.seed) {}

  /// Searches by the current goal until its share of the budget is spent.
  void descend() {
    if (basins_.empty()) {
      scout(options_.deadline ? kMinScouts : std::clamp(evaluations_ / 8 / cost(), kMinScouts, kMaxScouts), 0.6);
      for (const BodyMotion& m : options_.starts) {
        Candidate start{space_.unit(m)};
        evaluate(std::span(&start, 1));
        if (start.value < kNoMotion && !over()) run_cma(start, kNarrow, kRough);
      }
      for (const Candidate& start : starts_.best(kRuns))
        if (!over()) run_cma(start, kNarrow, kRough);
    }
    const double local = goal_ == &search_goal_ && !search_goal_.single() ? 0.7 : 0.35;  // probability near a basin
    while (!over()) {
      if (goal_ == &search_goal_ && share() > kLate && !best_.empty())
        refine(Candidate(best_[0]));
      else if (!basins_.empty() && random_.uniform() < local)
        restart_near_basin();
      else
        restart_globally();
    }
  }

  void run() {
    out_.variables = space_.variables();
    simulate_held();
    set_goals();
    evaluate_held();
    if (options_.deadline) bound_reserve();
    if (!scene_.release) search_held();
    if (!options_.starts.empty()) accept_if_better(Candidate{space_.unit(options_.starts[0])});
    const std::vector<BodyDrop>& drops = search_goal_.drops;
    BodyGoal first_stage = nominal_drop(scene_);
    if (options_.measure)  // the mean of a few: the minimum of a single drop is often at a cliff
      first_stage = {{}, {drops.begin(), drops.begin() + long(std::min(kFirstStageDrops, drops.size()))}};
    if (search_goal_.counted > 1) {
      goal_ = &first_stage, best_.clear(), lowest_by_contact_.clear();
      descend();
      reevaluate_first_stage();
    }
    descend();
    judge();
    out_.evaluations = spent_, out_.seconds = watch_.seconds();
  }

 private:
  static constexpr std::size_t kContenders = 16;      // capacity of the archive of the best
  static constexpr double kApart = 0.03;              // their minimum distance, as a fraction of the box
  static constexpr double kNarrow = 0.05;             // initial standard deviation around a good start
  static constexpr double kReserve = 4;               // accurate landings for which a deadline reserves time
  static constexpr double kMaxReserve = 0.4;          // share of the deadline, for judging
  static constexpr double kSlower = 2;                // judging time relative to the held posture's, at most
  static constexpr double kFirstStageShare = 0.35;    // of the budget, for the first stage
  static constexpr std::size_t kFirstStageDrops = 8;  // of the first stage under scatter
  static constexpr std::size_t kFinalists = 5;        // of the best, that are judged on many drops
  // For each first contact: starts from scouts; first runs; basins.
  static constexpr std::size_t kStarts = 12, kRuns = 3, kBasins = 8;
  static constexpr double kStartsApart = 0.1, kBasinsApart = 0.2;
  static constexpr double kNeutral = 0.5;  // share of scouts without shape terms and gains
  static constexpr long kMinScouts = 96, kMaxScouts = 1'500, kRestartScouts = 64;  // motions

  /// When a run ends: standard deviation, as a fraction of the box; relative improvement that is not a stall.
  struct StopRule {
    double width, min_gain;
  };
  static constexpr StopRule kRough{2e-3, 3e-3}, kFine{1e-5, 1e-5};
  static constexpr double kLate = 0.85, kRefined = 0.01;  // share of the budget, then the best is refined; its sigma

  double share() const {
    const double motions = double(spent_) / double(evaluations_);
    if (!options_.deadline) return motions;
    return std::max(motions, (watch_.seconds() - search_begin_) / (*options_.deadline - reserve_ - search_begin_));
  }
  /// Evaluations of a motion, where all its landings are played.
  long cost() const { return options_.measure ? long(goal_->drops.size()) : 1; }
  bool over() const {
    return spent_ >= evaluations_ || past_deadline() || options_.monitor.stopped() ||
           (goal_ != &search_goal_ && share() > kFirstStageShare);
  }
  bool past_deadline() const { return options_.deadline && watch_.seconds() > *options_.deadline - reserve_; }

  /// Plays the held posture, and reserves time by its landing.
  void simulate_held() {
    out_.hold = held_posture(scene_);
    const double before = watch_.seconds();
    out_.held = simulate(scene_, out_.hold, {.accuracy = options_.accuracy}, options_.rate);
    reserve_ = kReserve * (watch_.seconds() - before);
    ++spent_;
  }
  /// The goals of search and judging; with a deadline over as many drops as there is time for.
  void set_goals() {
    long searched = options_.samples, judging = judging_drops(options_);
    if (options_.measure && options_.deadline) {
      constexpr double kSearched = 0.5, kMotions = 150, kJudging = 0.2;  // shares of the deadline; motions in kSearched
      const double before = watch_.seconds();
      (void)peak_acceleration(scene_, out_.hold, {.accuracy = kSearchAccuracy});
      const double per_landing = (watch_.seconds() - before) / thread_count(options_.threads) / *options_.deadline;
      const auto fit = [](long maximum, double landings) {
        const double fewest = double(std::min(8L, maximum));
        return long(std::bit_floor(std::uint64_t(std::clamp(landings, fewest, double(maximum)))));
      };
      searched = fit(searched, kSearched / (kMotions * per_landing));
      judging = fit(judging, kJudging / (double(kFinalists + 1) * per_landing));
    }
    BodyGoals goals = plan_goals(scene_, options_, searched, judging);
    search_goal_ = std::move(goals.search), judging_goal_ = std::move(goals.judge);
  }
  void evaluate_held() {
    if (no_landing(out_.held.end)) return;
    out_.held_value = worth(scene_, out_.held);
    if (!judging_goal_.single()) {
      const double begin = watch_.seconds();
      choose_accuracy();
      const Judged held = judged(judging_goal_, out_.hold, judging_options_);
      out_.held_value = held.value, out_.held_keeps_limits = held.keeps_limits;
      spent_ += options_.measure ? long(judging_goal_.drops.size()) : 0;
      judging_time_ = watch_.seconds() - begin;
      if (options_.deadline) reserve_ += double(kFinalists) * judging_time_;
    }
    if (!(out_.held_value < kNoMotion) || !out_.held_keeps_limits) return;
    out_.motion = out_.hold, out_.landing = out_.held, out_.value = out_.held_value, out_.found = true;
    if (scene_.release) return;  // the space has no motion that holds the released joints
    Candidate c{space_.unit(out_.hold)};
    c.value = out_.held_value;
    record(c);
  }

  /// Other postures to hold, where the robot may be released in any: random ones in the scene's own drop, then ones
  /// around the best; the best that lie apart by the goal. The best of all may be the answer.
  void search_held() {
    constexpr std::size_t kMany = 64, kFew = 16, kBest = 3;  // postures
    constexpr double kHolding = 0.05, kAround = 0.1;         // share of the budget; sigma
    const bool many = !options_.deadline && kHolding * double(evaluations_) > 2 * kMany;
    Random random(options_.seed);
    const BodyGoal nominal = nominal_drop(scene_);
    const Archive known = best_;
    const ContactArchives known_lowest = lowest_by_contact_;
    Archive best(kBest, kApart);
    std::vector<Candidate> postures(many ? kMany : kFew);
    goal_ = &nominal;
    for (int round = 0; round < 2 && share() < kHolding; ++round) {
      for (Candidate& p : postures) {
        p = best.empty() ? random_point(random, space_.dimension()) : perturbed(best[0], kAround, random);
        p.u = space_.held(p.u);
      }
      evaluate(postures);
      for (const Candidate& p : postures)
        if (p.value < kNoMotion) best.add(p);
    }
    goal_ = &search_goal_;
    std::vector<Candidate> judged(best.begin(), best.end());
    for (Candidate& p : judged) p.bound = kNoMotion;
    evaluate(judged);
    best_ = known, lowest_by_contact_ = known_lowest;  // no run is abandoned for being worse than a posture
    const auto lowest = std::min_element(judged.begin(), judged.end());
    if (lowest != judged.end() && lowest->value < kNoMotion && !past_deadline()) accept_if_better(*lowest);
  }

  /// Evaluates as many of the points as the budget allows; the others get kNoMotion.
  void evaluate(std::span<Candidate> points) {
    const long left = std::max(0L, evaluations_ - spent_), per_motion = cost();
    const auto allowed = std::min(points.size(), std::size_t((left + per_motion - 1) / per_motion));
    const std::function<bool()> stop = [this] { return past_deadline() || options_.monitor.stopped(); };
    for (Candidate& p : points) p.value = kNoMotion;
    std::vector<Valuation> motions = valuations(*goal_, points.first(allowed));
    play(motions, scene_.robot, kSearchAccuracy, options_.threads, &stop);
    for (std::size_t i = 0; i < allowed; ++i)
      points[i].value = motions[i].value(), points[i].first_contact = motions[i].first_contact();
    if (goal_->single() && !judging_goal_.single() && scene_.limited()) check_limits(points.first(allowed), stop);
    for (std::size_t i = 0; i < allowed; ++i) {
      spent_ += options_.measure ? motions[i].played() : 1;
      if (points[i].value <= points[i].bound && points[i].value < kNoMotion) record(points[i]);
    }
    if (!options_.deadline) options_.monitor.progress(std::min(spent_, evaluations_), evaluations_);
  }
  /// New best motions of the scene's own drop must keep the limits in the whole execution box.
  void check_limits(std::span<Candidate> points, const std::function<bool()>& stop) {
    const double best = best_.empty() ? kNoMotion : best_[0].value;
    std::vector<Candidate*> better;
    for (Candidate& p : points)
      if (p.value < best) better.push_back(&p);
    std::vector<Valuation> motions;
    for (const Candidate* p : better) motions.emplace_back(judging_goal_, space_.motion(p->u), kNoMotion);
    play(motions, scene_.robot, kSearchAccuracy, options_.threads, &stop);
    for (std::size_t i = 0; i < better.size(); ++i)
      if (!(motions[i].value() < kNoMotion)) better[i]->value = kNoMotion;
  }
  std::vector<Valuation> valuations(const BodyGoal& goal, std::span<const Candidate> points) const {
    std::vector<Valuation> out;
    out.reserve(points.size());
    for (const Candidate& p : points) out.emplace_back(goal, space_.motion(p.u), p.bound);
    return out;
  }
  void record(const Candidate& p) {
    if (goal_ == &search_goal_ && (best_.empty() || p.value < best_[0].value))
      out_.progress.push_back({spent_, watch_.seconds(), p.value});
    best_.add(p), lowest_by_contact_.add(p);
  }

  /// Uniform motions (with probability `uniform`) and ones around the best so far; all followed up to the starts'
  /// bound.
  void scout(long motions, double uniform) {
    starts_.clear();
    std::vector<Candidate> batch(kBatch);
    for (long n = 0; n < motions && !over(); n += kBatch) {
      const double bound = starts_.bound();
      for (Candidate& p : batch) {
        p = starts_.empty() || random_.uniform() < uniform
                ? random_point(random_, space_.variables(), kNeutral)
                : perturbed(starts_.draw(random_), std::pow(10.0, -random_.uniform(0.5, 1.5)), random_);
        p.bound = bound;
      }
      evaluate(batch);
      for (const Candidate& p : batch)
        if (p.value <= p.bound && p.value < kNoMotion) starts_.add(p);
    }
  }
  /// Covariance matrix adaptation from a start until it has converged, stalls or lags behind the best.
  void run_cma(const Candidate& start, double size, const StopRule& stop) {
    constexpr double kSlack = 0.6, kDecay = 0.97;  // of the slack, a generation
    constexpr int kFree = 8, kPoints = 14;
    const int patience = 10 + 2 * space_.dimension();
    CovarianceAdaptation distribution;
    distribution.start(start.u, size, kPoints);
    std::vector<Candidate> points(kPoints);
    Candidate best = start;
    double bound = kNoMotion, milestone = kNoMotion;
    for (int n = 0, stalled = 0; !over() && stalled < patience && distribution.largest_deviation() > stop.width; ++n) {
      distribution.sample(random_, points);
      for (Candidate& p : points) p.bound = bound;
      evaluate(points);
      if (over()) break;
      bound = distribution.update(points);
      if (points[0] < best) best = points[0];
      stalled = best.value < milestone * (1 - stop.min_gain) ? 0 : stalled + 1;
      if (stalled == 0) milestone = best.value;
      if (n > kFree && best.value > lowest_by_contact_.lowest(best) * (1 + kSlack * std::pow(kDecay, n - kFree))) break;
    }
    basins_.add(best);
  }
  /// Descends by gradients where the goal is the largest peak without limits; by a narrow distribution otherwise, or
  /// where that brought no improvement.
  void refine(const Candidate& best) {
    if (search_goal_.worst() && !scene_.limited() && best.u != refined_) {
      refined_ = best.u;
      descend_by_gradient(search_goal_, space_, best.u, best.value, options_.threads, [&](const Coordinates& u) {
        Candidate p{u};
        evaluate(std::span(&p, 1));
        spent_ += cost_of_gradient();
        return !over();
      });
      if (best_[0].value < best.value) return;
    }
    run_cma(best, kRefined, kFine);
  }
  /// In motions: a landing with its derivatives for eight numbers takes about as long as ten.
  long cost_of_gradient() const { return 10 * ((space_.dimension() + 7) / 8); }
  void restart_near_basin() {
    const double size = std::pow(10.0, -random_.uniform(0.7, 2));
    run_cma(perturbed(basins_.draw(random_), size, random_), size, kRough);
  }
  void restart_globally() {
    scout(kRestartScouts, 1);
    if (!starts_.empty()) run_cma(Candidate(starts_.draw(random_, kRuns)), kNarrow, kRough);
  }

  /// Evaluates the best and the basins of the first stage by the goal.
  void reevaluate_first_stage() {
    std::vector<Candidate> known(best_.begin(), best_.end());
    if (!known.empty()) first_stage_best_ = known[0];
    const std::vector<Candidate> basins = basins_.best();
    known.insert(known.end(), basins.begin(), basins.end());
    best_.clear(), lowest_by_contact_.clear(), basins_.clear(), starts_.clear();
    goal_ = &search_goal_;
    for (Candidate& p : known) p.bound = kNoMotion;
    const auto batch = std::size_t(kBatch);
    for (std::size_t i = 0; i < known.size() && !over(); i += batch)
      evaluate(std::span(known).subspan(i, std::min(batch, known.size() - i)));
    for (const Candidate& p : known)
      if (p.value < kNoMotion) basins_.add(p);
  }

  /// Limits the time reserved for judging to its share of the remaining time.
  void bound_reserve() {
    search_begin_ = watch_.seconds();
    reserve_ = std::min(reserve_, kMaxReserve * std::max(0.0, *options_.deadline - search_begin_));
  }
  /// Judges many landings at kSearchAccuracy where a tighter one takes too much of the deadline.
  void choose_accuracy() {
    const double landing = reserve_ / kReserve, all = double(kFinalists * judging_goal_.drops.size()) * landing;
    if (options_.deadline && all > kMaxReserve * *options_.deadline)
      judging_options_.accuracy = std::max(options_.accuracy, kSearchAccuracy);
  }
  /// Makes a motion the answer where it is better at a tight accuracy.
  void accept_if_better(const Candidate& p) {
    const BodyMotion motion = space_.motion(p.u);
    const Judged result = judging_goal_.single() ? Judged{0, true} : judged(judging_goal_, motion, judging_options_);
    double value = result.value;
    if (!result.keeps_limits || (out_.found && !(value < out_.value))) return;
    const BodyLanding l = simulate(scene_, motion, {.accuracy = options_.accuracy}, options_.rate);
    if (judging_goal_.single()) value = worth(scene_, l);
    if (no_landing(l.end) || (out_.found && !(value < out_.value))) return;
    out_.motion = motion, out_.landing = l, out_.value = value, out_.found = true;
    out_.edges = p.u == space_.held(p.u) ? Edges{} : space_.edges(p.u);  // a posture lies on no edge of the duration
  }
  /// Judges the best few at a tight accuracy, as the best often lies at a cliff; under a measure on other drops.
  void judge() {
    std::size_t n = 0;
    for (const Candidate& p : best_) {
      if (out_.found && !options_.measure && !(p.value < out_.value)) break;  // nor is any after it
      if (options_.measure && out_.found && n++ >= kFinalists) break;         // more where none keeps the limits
      if (options_.deadline && out_.value < out_.held_value &&
          watch_.seconds() + kSlower * judging_time_ > *options_.deadline)
        break;
      accept_if_better(p);
    }
    if (first_stage_best_ && !(out_.value < out_.held_value))
      accept_if_better(*first_stage_best_);  // no time was left for the goal
    if (out_.found) {
      if (options_.monitor.stopped()) out_.message = "interrupted: the best so far";
      return;
    }
    out_.value = out_.landing.peak = std::numeric_limits<double>::quiet_NaN();
    out_.message = out_.held.end == End::kNoContact ? "no contact touches the floor: there is no landing to plan"
                   : scene_.limited()               ? "no motion was found that keeps the limits" + held_breaks()
                                                    : "no motion could be followed to the floor";
  }

  /// The first limit that the held posture breaks, for the message.
  std::string held_breaks() const {
    const BrokenLimit& b = out_.held.broken;
    if (!b) return "";
    return fmt::format("; holding breaks them after {:.3g} s: {}", b.t, scene_.loads[std::size_t(b.load)].name);
  }

  const BodyScene& scene_;
  const BodyPlanOptions& options_;
  BodyPlanOptions judging_options_;  ///< for the best few
  const BodySpace space_;
  BodyPlan& out_;
  const long evaluations_;
  BodyGoal search_goal_, judging_goal_;   ///< of the search; of the best few
  const BodyGoal* goal_ = &search_goal_;  ///< of `evaluate` at present
  Random random_;
  Archive best_{kContenders, kApart};
  ContactArchives starts_{kStarts, kStartsApart}, basins_{kBasins, kBasinsApart}, lowest_by_contact_{1, 0};
  Stopwatch watch_{Stopwatch::Time::kWall};
  Coordinates refined_;                        ///< the last start of a descent by gradients
  std::optional<Candidate> first_stage_best_;  ///< by the goal of the first stage
  double reserve_ = 0;                         ///< time before the deadline that is kept for judging [s]
  double search_begin_ = 0;                    ///< [s]
  double judging_time_ = 0;                    ///< of the held posture on many drops [s]
  long spent_ = 0;
};

/// Of a deadline, for the fresh drops that estimate the share of those that keep the limits.
constexpr double kFreshShare = 0.1;

/// A plan and the held posture over drops that were not used in the search; with a deadline over as many as there is
/// time for, absent where there is none.
std::optional<BodyUnderScatter> evaluate_on_fresh(const BodyScene& scene, const BodyPlan& plan,
                                                  const BodyPlanOptions& options, const Stopwatch& watch) {
  constexpr std::size_t kChunk = 128;  // drops between two checks of the clock
  const bool drawn = !options.measured;
  BodyUnderScatter out{.scatter = drawn ? std::optional(scatter_for(options.scatter, scene)) : std::nullopt,
                       .assumed = drawn && !options.scatter && !scene.scatter};
  const BodyDropModel model = drop_model(scene, options);
  if (!model.scatters()) return std::nullopt;
  const std::vector<BodyDrop> drops = model.independent(options.fresh, fresh_seed(options.seed));
  const std::function<bool()> past_deadline = [&] { return options.deadline && watch.seconds() > *options.deadline; };
  std::vector<double> planned, held;
  const std::size_t chunk = options.deadline ? kChunk : drops.size();
  for (std::size_t first = 0; first < drops.size(); first += chunk) {
    const auto next = std::span(drops).subspan(first, std::min(chunk, drops.size() - first));
    const PeaksOver of_plan = peaks_over(next, plan.motion, kSearchAccuracy, options.threads, &past_deadline),
                    of_held = peaks_over(next, plan.hold, kSearchAccuracy, options.threads, &past_deadline);
    if (past_deadline()) break;
    planned.insert(planned.end(), of_plan.peaks.begin(), of_plan.peaks.end());
    held.insert(held.end(), of_held.peaks.begin(), of_held.peaks.end());
    out.broken += of_plan.broken;
    out.exceeded.resize(std::max(out.exceeded.size(), of_plan.exceeded.size()));
    for (std::size_t i = 0; i < of_plan.exceeded.size(); ++i) out.exceeded[i] += of_plan.exceeded[i];
    out.from_floor += std::count_if(next.begin(), next.end(), [](auto& d) { return d.from_floor; });
  }
  if (planned.empty()) return std::nullopt;
  out.planned = distribution(planned), out.held = distribution(held);
  out.measured = estimated(options.measure.value_or(Measure{}), planned);
  return out;
}

}  // namespace

BodyPlan plan(const BodyScene& scene, const BodyPlanOptions& options) {
  scene.validate(), options.validate(), check_share(scene, options.share);
  const Stopwatch watch(Stopwatch::Time::kWall);
  const bool reports = options.fresh > 0 && (!options.deadline || options.share);
  BodyPlanOptions search = options;
  if (reports && search.deadline) *search.deadline *= 1 - kFreshShare;
  BodyPlan out;
  BodySearch(scene, search, out).run();
  if (reports && out.found && !options.monitor.stopped()) out.under = evaluate_on_fresh(scene, out, options, watch);
  return out;
}

}  // namespace ukemi::landing
