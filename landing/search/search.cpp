#include "landing/search/search.hpp"

#include <algorithm>
#include <numeric>

#include "landing/search/population.hpp"

namespace ukemi::landing {

long work_allowed(long landings, long motions) {
  constexpr long kMotion = 1'500;  // of one landing
  const long each = kMotion * landings;
  return motions < kUnbounded / each ? std::max(kCheckWork, each * motions) : kUnbounded;
}

Search::Search(Objective& objective, const Budget& budget, std::uint64_t seed_, std::vector<Progress>* progress)
    : seed(seed_),
      objective_(objective),
      budget_(budget),
      start_(objective.watch.seconds()),
      first_motion_(objective.motions()),
      first_landing_(objective.landings()),
      progress_(progress),
      held_(nothing()),
      screened_(nothing()),
      sampled_(nothing()) {
  few_.fill(nothing());
  objective.deadline = start_ + budget.seconds;
  objective.grant(budget.work);
  hold();
}

void Search::hold() {
  constexpr double kInLanes = 10;  // a landing in lanes takes a tenth of the time
  constexpr int kRounds = 2, kPostures = 16;
  const Scene& scene = objective_.scene();
  const MotionSpace& space = objective_.space();
  auto [low, high] = scene.search.phi;
  const auto holding = [&](double phi) { return Candidate{space.place(*space.holding(phi))}; };
  if (budget_.hold <= 0 || !space.holding(low)) return;
  held_ = holding(scene.release ? scene.release->phi : std::midpoint(low, high));
  judge_held(held_);
  if (scene.release) return;
  // Postures side by side by the peak, then between the best one's neighbours; the best of each round is judged.
  const double most = std::min(double(budget_.motions), kInLanes * budget_.seconds / objective_.landing_time());
  std::array<Candidate, kPostures> postures;
  for (int round = 0; round < kRounds && budget_.hold * most > (round + 1) * kPostures; ++round) {
    const double step = (high - low) / (kPostures - 1), from = low;
    for (int i = 0; i < kPostures; ++i) postures[std::size_t(i)] = holding(from + i * step);
    evaluate(postures, Goal::kPeak);
    const auto best = std::min_element(postures.begin(), postures.end());
    const double phi = from + double(best - postures.begin()) * step;
    judge_held(*best);
    low = std::max(low, phi - step), high = std::min(high, phi + step);
  }
}

void Search::judge_held(Candidate p) {
  p.bound = kNoMotion;
  evaluate({&p, 1});
  if (p < held_) held_ = p;
}

/// The best posture to hold stands among the few, however many are better: they may fall.
void Search::include_held() {
  const auto same = [&](const Candidate& p) { return p.value < kNoMotion && p.u == held_.u; };
  if (held_.value >= kNoMotion || std::any_of(few_.begin(), few_.end(), same)) return;
  few_.back() = held_;
  std::sort(few_.begin(), few_.end());
}

/// Plays what was only screened, where nothing that was played is better than holding.
void Search::play_screened(double deadline) {
  constexpr double kLast = 3e-3;  // what an answer in place of none may take, however late it is [s]
  const bool none = few_[0].value >= kNoMotion;
  objective_.deadline = none ? std::max(deadline, objective_.watch.seconds() + kLast) : deadline;
  for (Candidate p : {screened_, sampled_}) {
    if (few_[0].value < held_.value || p.value >= few_[0].value) continue;
    p.bound = few_[0].value;
    play({&p, 1});
  }
}

double Search::share() const {
  const double time = std::isfinite(budget_.seconds) ? seconds() / budget_.seconds : 0;
  return std::min(1.0, std::max(time, double(spent()) / double(budget_.motions)));
}

std::size_t Search::allowed(std::size_t motions) const {
  const long left = std::max(0L, budget_.motions - spent());
  return scattered() ? (left > 0 ? motions : 0) : std::min(motions, std::size_t(left));
}

void Search::evaluate(std::span<Candidate> points) { evaluate(points, objective_.options().goal); }

void Search::evaluate(std::span<Candidate> points, Goal goal) {
  const std::size_t n = allowed(points.size());
  for (Candidate& p : points.subspan(n)) p.value = kNoMotion;
  if (n == 0) return;
  if (goal == objective_.options().goal) {
    play(points.first(n));
  } else {
    objective_.evaluate(points.first(n), goal);
    for (const Candidate& p : points.first(n))
      if (p.value <= p.bound && p < screened_) screened_ = p;
  }
  report();
}

void Search::evaluate_over(std::span<Candidate> points, std::size_t drops) {
  if (drops >= objective_.options().robust->drops.size()) return evaluate(points);
  const std::size_t n = allowed(points.size());
  for (Candidate& p : points.subspan(n)) p.value = kNoMotion;
  objective_.evaluate_scattered(points.first(n), drops);
  for (const Candidate& p : points.first(n))
    if (p.value <= p.bound && p < sampled_) sampled_ = p;
  report();
}

void Search::report() const {
  if (!tell) return;
  constexpr double kMilli = 1e3;
  if (budget_.motions < kUnbounded)
    tell(spent(), budget_.motions);
  else if (std::isfinite(budget_.seconds))
    tell(long(kMilli * seconds()), long(kMilli * budget_.seconds));
}

void Search::play(std::span<Candidate> points) {
  objective_.evaluate(points, objective_.options().goal);
  for (const Candidate& p : points)
    if (p.value <= p.bound && p.value < few_.back().value) keep(p);
}

void Search::keep(const Candidate& p) {
  constexpr double kSame = 1e-3;  // of the box: of neighbours only the best is kept
  const bool better = p.value < few_[0].value;
  std::size_t i = few_.size() - 1;
  for (std::size_t n = 0; n < few_.size(); ++n)
    if (few_[n].value < kNoMotion && distance(few_[n], p) < kSame) {
      if (few_[n].value <= p.value) return;
      i = n;
      break;
    }
  for (; i > 0 && p.value < few_[i - 1].value; --i) few_[i] = few_[i - 1];
  few_[i] = p;
  if (better && p.value < milestone_ * (1 - budget_.tolerance)) milestone_ = p.value, milestone_motions_ = motions();
  if (better && progress_ && progress_->size() < progress_->capacity())
    progress_->push_back({motions(), objective_.landings(), seconds(), p});
}

Candidate Search::judge_scattered(double deadline) {
  Candidate best = best_of_judged(deadline);
  if (best.value < kNoMotion && !objective_.keeps_limits(best)) best.value = kNoMotion;
  return best;
}

Candidate Search::best_of_judged(double deadline) {
  objective_.grant(kUnbounded);
  play_screened(deadline);
  objective_.deadline = deadline;
  if (few_[0].value >= kNoMotion) few_[0] = sampled_.value < kNoMotion ? sampled_ : screened_;
  include_held();
  Candidate best = few_[0];
  if (objective_.options().robust->judging.empty()) return best;
  bool judged = false;
  for (Candidate p : few_) {
    if (p.value >= kNoMotion || objective_.late()) break;
    p.bound = judged ? best.value : kNoMotion;
    objective_.judge_scattered({&p, 1});
    if (p.value < kNoMotion && (!judged || p < best)) best = p, judged = true;
  }
  if (held_ < best && objective_.late()) best = held_;
  return best;
}

Candidate Search::judge(double accuracy, double deadline) {
  if (objective_.options().goal == Goal::kRobust) return judge_scattered(deadline);
  constexpr double kFallen = 1e-3, kTight = 1e-9;
  objective_.grant(kCheckWork);
  play_screened(deadline);
  include_held();
  objective_.deadline = deadline;
  objective_.grant(kCheckWork);
  if (few_[0].value >= kNoMotion) return few_[0];
  const double searched = objective_.accuracy();
  const Few found = few_;
  objective_.set_accuracy(kTight);
  few_.fill(nothing());
  // A tolerant peak fills the lanes by itself.
  const std::size_t at_once = objective_.options().goal == Goal::kPeak ? 4 : 1;
  Few again = found;
  for (std::size_t i = 0; i < again.size() && found[i].value < few_[0].value && !objective_.late(); i += at_once) {
    const auto part = std::span(again).subspan(i, at_once);
    for (Candidate& p : part) p.bound = few_[0].value;
    play(part);
  }
  if (few_[0].value > found[0].value * (1 + kFallen)) {
    // Back from the edge: a population about the place where it seemed to be, from a hundredth of the box down to its
    // rounding, that converges on ground that holds.
    constexpr int kGenerations = 80;
    constexpr double kConverged = 1e-8;
    Random random(seed, 0x5e77);
    std::array<Candidate, 24> population, trials;
    for (Candidate& p : population) p = beside(found[0], std::pow(10.0, random.uniform(-7, -2)), random);
    play(population);
    for (int n = 0; n < kGenerations && spread(population) > kConverged && !objective_.late(); ++n)
      evolve([this](std::span<Candidate> p) { play(p); }, random, population, trials, {});
  }
  objective_.set_accuracy(searched);
  objective_.grant(kCheckWork);
  Candidate best = nothing();
  // Where nothing stood in the lanes, or the deadline came before, what was found is judged.
  for (Candidate p : few_[0].value < kNoMotion ? few_ : found) {
    if (p.value >= best.value) break;
    p.value = std::max(p.value, objective_.verified(objective_.play(p), accuracy, best.value));
    if (p < best) best = p;
  }
  if (held_ < best && objective_.late()) best = held_;
  return best;
}

}  // namespace ukemi::landing
