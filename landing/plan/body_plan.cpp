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

/// The best few of every contact that may touch first, apart from one another. A landing on the foot and one on the
/// knee are far apart, and what lies between them is worse than both: each is searched for itself, or the wider one
/// hides the other.
class ByFirstContact {
 public:
  ByFirstContact(std::size_t most, double apart) : most_(most), apart_(apart) {}
  void clear() { of_contact_.clear(); }
  bool empty() const { return of_contact_.empty(); }
  void add(const Candidate& p) {
    std::size_t at = place(p);
    if (at == of_contact_.size()) of_contact_.emplace_back(most_, apart_);
    of_contact_[at].add(p);
    for (; at > 0 && of_contact_[at].lowest() < of_contact_[at - 1].lowest(); --at)
      std::swap(of_contact_[at], of_contact_[at - 1]);
  }
  /// The lowest value of the contact that touches first as in p; kNoMotion where there is none.
  double lowest(const Candidate& p) const {
    const std::size_t at = place(p);
    return at < of_contact_.size() ? of_contact_[at].lowest() : kNoMotion;
  }
  /// One of the best of a contact that has good ones: of the best contact as often as of all others.
  const Candidate& draw(Random& r, std::size_t most = Archive::kMost) const {
    const int n = int(good());
    const Archive& of = of_contact_[n == 1 || r.uniform() < 0.5 ? 0 : std::size_t(random_index(r, n))];
    return of[low_index(r, std::min(most, of.size()))];
  }
  /// What is no better is neither taken of a contact that has good ones, nor a good one of another.
  double bound() const {
    double out = 0;
    for (std::size_t i = 0; i < good(); ++i) out = std::max(out, of_contact_[i].bound());
    return empty() ? kNoMotion : std::min(out, kGood * of_contact_[0].lowest());
  }
  /// So many of each contact that has good ones, the best of all first.
  std::vector<Candidate> best(std::size_t most = Archive::kMost) const {
    std::vector<Candidate> out;
    for (std::size_t i = 0; i < good(); ++i)
      out.insert(out.end(), of_contact_[i].begin(), of_contact_[i].begin() + std::min(most, of_contact_[i].size()));
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  static constexpr double kGood = 2;  ///< times the best value
  /// Of the contact that touches first as in p; the size where it is not known.
  std::size_t place(const Candidate& p) const {
    const auto same = [&](const Archive& a) { return a[0].first_contact == p.first_contact; };
    return std::size_t(std::find_if(of_contact_.begin(), of_contact_.end(), same) - of_contact_.begin());
  }
  /// The first so many contacts have good ones.
  std::size_t good() const {
    const auto bad = [&](const Archive& a) { return a.lowest() > kGood * of_contact_[0].lowest(); };
    return std::size_t(std::find_if(of_contact_.begin(), of_contact_.end(), bad) - of_contact_.begin());
  }

  std::size_t most_;
  double apart_;
  std::vector<Archive> of_contact_;  ///< the one with the best first
};

/// The search's state: what was spent, the best few so far.
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

  /// Searches by one goal until its part of the budget is spent.
  void descend() {
    if (basins_.empty()) {
      scout(options_.deadline ? kFirst : std::clamp(evaluations_ / 8 / cost(), kFirst, kMostScouts), 0.6);
      for (const BodyMotion& m : options_.starts) {
        Candidate start{space_.unit(m)};
        evaluate(std::span(&start, 1));
        if (start.value < kNoMotion && !over()) close_in(start, kNarrow, kRough);
      }
      for (const Candidate& start : starts_.best(kRuns))
        if (!over()) close_in(start, kNarrow, kRough);
    }
    const double known = goal_ == &final_ && !final_.single() ? 0.7 : 0.35;  // how often beside what is known
    while (!over()) {
      if (goal_ == &final_ && share() > kLate && !best_.empty())
        refine(Candidate(best_[0]));
      else if (!basins_.empty() && random_.uniform() < known)
        start_beside_a_basin();
      else
        start_anywhere();
    }
  }

  void run() {
    out_.variables = space_.variables();
    land_held();
    set_goals();
    judge_held();
    if (options_.deadline) share_out();
    if (!scene_.release) hold_others();
    if (!options_.starts.empty()) offer(Candidate{space_.unit(options_.starts[0])});  // no answer is worse
    BodyGoal first_look = own_drop(scene_);
    if (options_.measure)  // the mean of a few: the deepest place of one drop is often a cliff
      first_look = {{}, {final_.drops.begin(), final_.drops.begin() + long(std::min(kFewDrops, final_.drops.size()))}};
    if (final_.counted > 1) {
      goal_ = &first_look, best_.clear(), lowest_.clear();
      descend();
      judge_anew();
    }
    descend();
    judge();
    out_.evaluations = spent_, out_.seconds = watch_.seconds();
  }

 private:
  static constexpr std::size_t kContenders = 16;  // of the best that lie apart, so many are remembered
  static constexpr double kApart = 0.03;          // in parts of the box
  static constexpr double kNarrow = 0.05;         // a distribution's first width beside a good place
  static constexpr double kReserve = 4;           // accurate landings that a deadline keeps back
  static constexpr double kMostReserved = 0.4;    // of the deadline, for judging
  static constexpr double kSlower = 2;            // at most, than the held posture, is a motion judged
  static constexpr double kFirstLook = 0.35;      // of the budget: on the scene's own drop
  static constexpr std::size_t kFewDrops = 8;     // of the first look under scatter
  static constexpr std::size_t kJudged = 5;       // of the best, where many drops judge
  // Of each contact that touches first: places that scouts keep; that are searched from at first; where runs end.
  static constexpr std::size_t kStarts = 12, kRuns = 3, kBasins = 8;
  static constexpr double kStartsApart = 0.1, kBasinsApart = 0.2;
  static constexpr double kPlain = 0.5;                                // of the scouts, without shape terms and gains
  static constexpr long kFirst = 96, kMostScouts = 1'500, kRace = 64;  // motions of the scouts

  /// When a run ends: its width, in parts of the box; by which part of its value it must better itself meanwhile.
  struct Enough {
    double width, better;
  };
  static constexpr Enough kRough{2e-3, 3e-3}, kFine{1e-5, 1e-5};
  static constexpr double kLate = 0.85, kRefined = 0.01;  // from this share on the best place is refined, so narrow

  double share() const {
    const double motions = double(spent_) / double(evaluations_);
    if (!options_.deadline) return motions;
    return std::max(motions, (watch_.seconds() - begin_) / (*options_.deadline - reserve_ - begin_));
  }
  /// What a motion costs of the evaluations, where all its landings are played.
  long cost() const { return options_.measure ? long(goal_->drops.size()) : 1; }
  bool over() const {
    return spent_ >= evaluations_ || late() || options_.monitor.stopped() || (goal_ != &final_ && share() > kFirstLook);
  }
  bool late() const { return options_.deadline && watch_.seconds() > *options_.deadline - reserve_; }

  /// The posture that is held comes before all.
  void land_held() {
    out_.hold = held_posture(scene_);
    const double before = watch_.seconds();
    out_.held = simulate(scene_, out_.hold, {.accuracy = options_.accuracy}, options_.rate);
    reserve_ = kReserve * (watch_.seconds() - before);
    ++spent_;
  }
  /// What is searched for, and what the best few are judged by: over drops as many as the deadline has time for.
  void set_goals() {
    long searched = options_.samples, judging = judging_drops(options_);
    if (options_.measure && options_.deadline) {
      constexpr double kSearched = 0.5, kMotions = 150, kJudging = 0.2;  // parts of the deadline; motions in the first
      const double before = watch_.seconds();
      (void)peak_acceleration(scene_, out_.hold, {.accuracy = kSearchAccuracy});
      const double each = (watch_.seconds() - before) / thread_count(options_.threads) / *options_.deadline;
      const auto fit = [](long most, double landings) {
        const double fewest = double(std::min(8L, most));
        return long(std::bit_floor(std::uint64_t(std::clamp(landings, fewest, double(most)))));
      };
      searched = fit(searched, kSearched / (kMotions * each));
      judging = fit(judging, kJudging / (double(kJudged + 1) * each));
    }
    BodyGoals goals = plan_goals(scene_, options_, searched, judging);
    final_ = std::move(goals.search), judge_ = std::move(goals.judge);
  }
  void judge_held() {
    if (no_landing(out_.held.end)) return;
    out_.held_value = worth(scene_, out_.held);
    if (!judge_.single()) {
      const double begin = watch_.seconds();
      choose_accuracy();
      const Judged held = judged(judge_, out_.hold, judging_options_);
      out_.held_value = held.value, out_.held_keeps_limits = held.keeps_limits;
      spent_ += options_.measure ? long(judge_.drops.size()) : 0;
      judging_ = watch_.seconds() - begin;
      if (options_.deadline) reserve_ += double(kJudged) * judging_;
    }
    if (!(out_.held_value < kNoMotion) || !out_.held_keeps_limits) return;
    out_.motion = out_.hold, out_.landing = out_.held, out_.value = out_.held_value, out_.found = true;
    if (scene_.release) return;  // no motion of the space holds the joints where they are let go
    Candidate c{space_.unit(out_.hold)};
    c.value = out_.held_value;
    keep(c);
  }

  /// Other postures to hold, where the robot may be let go in any: some by the scene's own drop, then beside the best
  /// of them; the best that lie apart by the goal. The best of all is an answer.
  void hold_others() {
    constexpr std::size_t kMany = 64, kFew = 16, kBest = 3;
    constexpr double kHolding = 0.05, kBeside = 0.1;  // of the budget; of the box
    const bool many = !options_.deadline && kHolding * double(evaluations_) > 2 * kMany;
    Random random(options_.seed);
    const BodyGoal own = own_drop(scene_);
    const Archive known = best_;
    const ByFirstContact known_lowest = lowest_;
    Archive best(kBest, kApart);
    std::vector<Candidate> postures(many ? kMany : kFew);
    goal_ = &own;
    for (int round = 0; round < 2 && share() < kHolding; ++round) {
      for (Candidate& p : postures) {
        p = best.empty() ? random_point(random, space_.dimension()) : beside(best[0], kBeside, random);
        p.u = space_.held(p.u);
      }
      evaluate(postures);
      for (const Candidate& p : postures)
        if (p.value < kNoMotion) best.add(p);
    }
    goal_ = &final_;
    std::vector<Candidate> judged(best.begin(), best.end());
    for (Candidate& p : judged) p.bound = kNoMotion;
    evaluate(judged);
    best_ = known, lowest_ = known_lowest;  // no run is given up for being worse than a posture
    const auto lowest = std::min_element(judged.begin(), judged.end());
    if (lowest != judged.end() && lowest->value < kNoMotion && !late()) offer(*lowest);
  }

  /// Values of as many of the points as the budget allows; the others come back with kNoMotion.
  void evaluate(std::span<Candidate> points) {
    const long left = std::max(0L, evaluations_ - spent_), each = cost();
    const auto allowed = std::min(points.size(), std::size_t((left + each - 1) / each));
    const std::function<bool()> stop = [this] { return late() || options_.monitor.stopped(); };
    for (Candidate& p : points) p.value = kNoMotion;
    std::vector<Valuation> motions = valuations(*goal_, points.first(allowed));
    play(motions, scene_.robot, kSearchAccuracy, options_.threads, &stop);
    for (std::size_t i = 0; i < allowed; ++i)
      points[i].value = motions[i].value(), points[i].first_contact = motions[i].first_contact();
    if (goal_->single() && !judge_.single() && scene_.limited()) check_limits(points.first(allowed), stop);
    for (std::size_t i = 0; i < allowed; ++i) {
      spent_ += options_.measure ? motions[i].played() : 1;
      if (points[i].value <= points[i].bound && points[i].value < kNoMotion) keep(points[i]);
    }
    if (!options_.deadline) options_.monitor.progress(std::min(spent_, evaluations_), evaluations_);
  }
  /// What would be the best by its own landing must keep the limits in the whole execution box.
  void check_limits(std::span<Candidate> points, const std::function<bool()>& stop) {
    const double best = best_.empty() ? kNoMotion : best_[0].value;
    std::vector<Candidate*> better;
    for (Candidate& p : points)
      if (p.value < best) better.push_back(&p);
    std::vector<Valuation> motions;
    for (const Candidate* p : better) motions.emplace_back(judge_, space_.motion(p->u), kNoMotion);
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
  void keep(const Candidate& p) {
    if (goal_ == &final_ && (best_.empty() || p.value < best_[0].value))
      out_.progress.push_back({spent_, watch_.seconds(), p.value});
    best_.add(p), lowest_.add(p);
  }

  /// Motions from anywhere, and beside the best of those before; each followed only while it may be a start.
  void scout(long motions, double anywhere) {
    starts_.clear();
    std::vector<Candidate> batch(kBatch);
    for (long n = 0; n < motions && !over(); n += kBatch) {
      const double bound = starts_.bound();
      for (Candidate& p : batch) {
        p = starts_.empty() || random_.uniform() < anywhere
                ? point_of(random_, space_.variables(), kPlain)
                : beside(starts_.draw(random_), std::pow(10.0, -random_.uniform(0.5, 1.5)), random_);
        p.bound = bound;
      }
      evaluate(batch);
      for (const Candidate& p : batch)
        if (p.value <= p.bound && p.value < kNoMotion) starts_.add(p);
    }
  }
  /// A distribution that finds its way down from a place, until it has gathered, stands still or falls behind.
  void close_in(const Candidate& start, double size, const Enough& enough) {
    constexpr double kBound = 1.3, kBehind = 0.6, kForgives = 0.97;
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
      if (n > kFree && best.value > lowest_.lowest(best) * (1 + kBehind * std::pow(kForgives, n - kFree))) break;
    }
    basins_.add(best);
  }
  /// Where the largest peak counts and nothing limits it, by its gradients; a place that they do not better is refined
  /// by a narrow distribution.
  void refine(const Candidate& best) {
    if (final_.worst() && !scene_.limited() && best.u != refined_) {
      refined_ = best.u;
      descend_by_gradient(final_, space_, best.u, best.value, options_.threads, [&](const Coordinates& u) {
        Candidate p{u};
        evaluate(std::span(&p, 1));
        spent_ += cost_of_gradient();
        return !over();
      });
      if (best_[0].value < best.value) return;
    }
    close_in(best, kRefined, kFine);
  }
  /// In motions, roughly: a landing with its derivatives by eight numbers takes some ten times a landing.
  long cost_of_gradient() const { return 10 * ((space_.dimension() + 7) / 8); }
  void start_beside_a_basin() {
    const double size = std::pow(10.0, -random_.uniform(0.7, 2));
    close_in(beside(basins_.draw(random_), size, random_), size, kRough);
  }
  void start_anywhere() {
    scout(kRace, 1);
    if (!starts_.empty()) close_in(Candidate(starts_.draw(random_, kRuns)), kNarrow, kRough);
  }

  /// What the first look found, by the goal.
  void judge_anew() {
    std::vector<Candidate> known(best_.begin(), best_.end());
    if (!known.empty()) first_look_ = known[0];
    const std::vector<Candidate> basins = basins_.best();
    known.insert(known.end(), basins.begin(), basins.end());
    best_.clear(), lowest_.clear(), basins_.clear(), starts_.clear();
    goal_ = &final_;
    for (Candidate& p : known) p.bound = kNoMotion;
    const auto batch = std::size_t(kBatch);
    for (std::size_t i = 0; i < known.size() && !over(); i += batch)
      evaluate(std::span(known).subspan(i, std::min(batch, known.size() - i)));
    for (const Candidate& p : known)
      if (p.value < kNoMotion) basins_.add(p);
  }

  /// What is left of the deadline: so much for judging.
  void share_out() {
    begin_ = watch_.seconds();
    reserve_ = std::min(reserve_, kMostReserved * std::max(0.0, *options_.deadline - begin_));
  }
  /// Many landings judge, at the search's accuracy where a tighter one takes too much of the deadline.
  void choose_accuracy() {
    const double landing = reserve_ / kReserve, all = double(kJudged * judge_.drops.size()) * landing;
    if (options_.deadline && all > kMostReserved * *options_.deadline)
      judging_options_.accuracy = std::max(options_.accuracy, kSearchAccuracy);
  }
  /// Takes a motion for the answer where it is better, at a tight accuracy, than what is known.
  void offer(const Candidate& p) {
    const BodyMotion motion = space_.motion(p.u);
    const Judged result = judge_.single() ? Judged{0, true} : judged(judge_, motion, judging_options_);
    double value = result.value;
    if (!result.keeps_limits || (out_.found && !(value < out_.value))) return;
    const BodyLanding l = simulate(scene_, motion, {.accuracy = options_.accuracy}, options_.rate);
    if (judge_.single()) value = worth(scene_, l);
    if (no_landing(l.end) || (out_.found && !(value < out_.value))) return;
    out_.motion = motion, out_.landing = l, out_.value = value, out_.found = true;
    out_.edges = p.u == space_.held(p.u) ? Edges{} : space_.edges(p.u);  // of a posture the duration has no say
  }
  /// The best few at a tight accuracy: many a best stands on a cliff. Those of a measure on other drops.
  void judge() {
    std::size_t n = 0;
    for (const Candidate& p : best_) {
      if (out_.found && !options_.measure && !(p.value < out_.value)) break;  // those behind it are no better
      if (options_.measure && out_.found && n++ >= kJudged) break;  // the next ones, where none keeps the limits
      if (options_.deadline && out_.value < out_.held_value &&
          watch_.seconds() + kSlower * judging_ > *options_.deadline)
        break;
      offer(p);
    }
    if (first_look_ && !(out_.value < out_.held_value)) offer(*first_look_);  // there was time for that alone
    if (out_.found) {
      if (options_.monitor.stopped()) out_.message = "interrupted: the best so far";
      return;
    }
    out_.value = out_.landing.peak = std::numeric_limits<double>::quiet_NaN();
    out_.message = out_.held.end == End::kNoContact ? "no contact touches the floor: there is no landing to plan"
                   : scene_.limited()               ? "no motion was found that keeps the limits" + held_breaks()
                                                    : "no motion could be followed to the floor";
  }

  /// What the held posture breaks first.
  std::string held_breaks() const {
    const BrokenLimit& b = out_.held.broken;
    if (!b) return "";
    return fmt::format("; holding breaks them after {:.3g} s: {}", b.t, scene_.loads[std::size_t(b.load)].name);
  }

  const BodyScene& scene_;
  const BodyPlanOptions& options_;
  BodyPlanOptions judging_options_;  ///< of the best few
  const BodySpace space_;
  BodyPlan& out_;
  const long evaluations_;
  BodyGoal final_, judge_;          ///< what is searched for; what the best few are judged by
  const BodyGoal* goal_ = &final_;  ///< what motions are tried by now
  Random random_;
  Archive best_{kContenders, kApart};
  ByFirstContact starts_{kStarts, kStartsApart}, basins_{kBasins, kBasinsApart}, lowest_{1, 0};
  Stopwatch watch_{Stopwatch::Time::kWall};
  Coordinates refined_;                  ///< the last place that gradients were followed from
  std::optional<Candidate> first_look_;  ///< what it found, by its own goal
  double reserve_ = 0;                   ///< [s]
  double begin_ = 0;                     ///< of the search [s]
  double judging_ = 0;                   ///< what the held posture took, where many landings judge [s]
  long spent_ = 0;
};

/// Of a deadline, for the fresh drops that tell the share of those that keep the limits.
constexpr double kForFresh = 0.1;

/// A plan and the held posture over drops that nothing was chosen by; with a deadline over as many of them as there is
/// time for, absent where there is none.
std::optional<BodyUnderScatter> over_fresh(const BodyScene& scene, const BodyPlan& plan, const BodyPlanOptions& options,
                                           const Stopwatch& watch) {
  constexpr std::size_t kPiece = 128;  // drops between two looks at the clock
  BodyUnderScatter out{.scatter = scatter_for(options.scatter, scene), .assumed = !options.scatter && !scene.scatter};
  const BodyDropModel model(scene, out.scatter,
                            {.inflate = options.inflate, .inexact = options.goal == Goal::kTolerant});
  const std::vector<BodyDrop> drops = model.independent(options.fresh, fresh_seed(options.seed));
  const std::function<bool()> late = [&] { return options.deadline && watch.seconds() > *options.deadline; };
  std::vector<double> planned, held;
  const std::size_t piece = options.deadline ? kPiece : drops.size();
  for (std::size_t first = 0; first < drops.size(); first += piece) {
    const auto next = std::span(drops).subspan(first, std::min(piece, drops.size() - first));
    const PeaksOver of_plan = peaks_over(next, plan.motion, kSearchAccuracy, options.threads, &late),
                    of_held = peaks_over(next, plan.hold, kSearchAccuracy, options.threads, &late);
    if (late()) break;
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
  const bool scatters = options.measure || options.scatter || scene.scatter;
  const bool told = options.fresh > 0 && (options.deadline ? options.share.has_value() : scatters);
  BodyPlanOptions search = options;
  if (told && search.deadline) *search.deadline *= 1 - kForFresh;
  BodyPlan out;
  BodySearch(scene, search, out).run();
  if (told && out.found && !options.monitor.stopped()) out.under = over_fresh(scene, out, options, watch);
  return out;
}

}  // namespace ukemi::landing
