#include "landing/search/search.hpp"

#include <algorithm>

#include "landing/search/population.hpp"

namespace ukemi::landing {

namespace {
constexpr std::size_t kContenders = 12;  ///< capacity of their archive
constexpr double kGrace = 3e-3;          ///< processor time for a first answer after the deadline [s]
}  // namespace

long work_allowed(long landings, long motions) {
  constexpr long kPerLanding = 1'500;
  const long per_motion = kPerLanding * landings;
  return motions < kUnbounded / per_motion ? std::max(kCheckWork, per_motion * motions) : kUnbounded;
}

Search::Search(Objective& objective, const Budget& budget, std::uint64_t seed_, std::vector<Progress>* progress)
    : seed(seed_),
      objective_(objective),
      budget_(budget),
      start_(objective.watch.seconds()),
      first_motion_(objective.motions()),
      first_landing_(objective.landings()),
      progress_(progress),
      centre_{objective.centre()},
      contenders_(kContenders, objective.separation()),
      held_(centre_),
      screened_{centre_, centre_} {
  objective.deadline = start_ + budget.seconds;
  objective.limit_work(budget.work);
  search_held();
}

void Search::search_held() {
  constexpr int kRounds = 2, kFine = 64, kCoarse = 16;  // postures of a round: valleys are narrow
  constexpr std::size_t kBest = 3;                      // evaluated by the goal
  constexpr double kApart = 0.1;
  const std::optional<Candidate> known = objective_.held();
  if (budget_.hold <= 0 || !known) return;
  held_ = *known;
  objective_.set_grace(kGrace);
  if (!(held_.value < kNoMotion)) evaluate_held(held_);
  objective_.set_grace(0);
  if (!objective_.may_hold_others()) return;
  // The peak of postures over the box, then of some around the best; the best that lie apart by the goal.
  const auto in_time = [&] { return seconds() < budget_.hold * budget_.seconds; };
  const auto allowed = [&](int postures) { return budget_.hold * expected_total() > postures && in_time(); };
  const int count = allowed(kRounds * kFine) ? kFine : kCoarse;
  std::array<Candidate, kFine> buffer;
  const auto postures = std::span(buffer).first(std::size_t(count));
  Archive best(kBest, kApart);
  for (int round = 0; round < kRounds && allowed((round + 1) * count); ++round) {
    objective_.draw_postures(round, postures);
    evaluate(postures, Goal::kPeak);
    for (const Candidate& p : postures)
      if (p.value < kNoMotion) best.add(p);
  }
  for (const Candidate& p : best)
    if (&p == best.begin() || in_time()) evaluate_held(p);
}

/// Evaluates a posture to hold by the goal, unless its peak is the goal and known.
void Search::evaluate_held(Candidate p) {
  p.bound = held_.value;
  if (objective_.goal() != Goal::kPeak || p.value >= kNoMotion) evaluate({&p, 1});
  if (p < held_) held_ = p;
}

/// Evaluates the screened motions by the goal, where nothing better than holding is known.
void Search::evaluate_screened(double deadline) {
  objective_.deadline = deadline;
  if (contenders_.empty()) objective_.set_grace(kGrace);
  for (Candidate p : screened_) {
    if (best().value < held_.value || p.value >= best().value) continue;
    p.bound = best().value;
    play({&p, 1});
  }
  objective_.set_grace(0);
}

double Search::expected_total() const {
  constexpr double kInLanes = 10;  // a landing in lanes takes a tenth of the time
  return std::min(double(budget_.motions), kInLanes * budget_.seconds / objective_.landing_time());
}

double Search::share() const {
  const double time = std::isfinite(budget_.seconds) ? seconds() / budget_.seconds : 0;
  return std::min(1.0, std::max(time, double(spent()) / double(budget_.motions)));
}

std::size_t Search::allowed(std::size_t motions) const {
  const long left = std::max(0L, budget_.motions - spent());
  return scattered() ? (left > 0 ? motions : 0) : std::min(motions, std::size_t(left));
}

void Search::evaluate(std::span<Candidate> points, Fidelity fidelity) {
  const std::size_t n = allowed(points.size());
  for (Candidate& p : points.subspan(n)) p.value = kNoMotion;
  if (n == 0) return;
  play(points.first(n), fidelity);
  report_progress();
}

void Search::report_progress() const {
  if (!on_progress) return;
  constexpr double kMilli = 1e3;
  if (budget_.motions < kUnbounded)
    on_progress(spent(), budget_.motions);
  else if (std::isfinite(budget_.seconds))
    on_progress(long(kMilli * seconds()), long(kMilli * budget_.seconds));
}

void Search::play(std::span<Candidate> points, Fidelity fidelity) {
  objective_.evaluate(points, fidelity);
  const bool exact = objective_.exact(fidelity);
  Candidate& screened = screened_[fidelity.goal == Goal::kRobust];
  for (const Candidate& p : points) {
    if (p.value > p.bound) continue;
    if (exact)
      record(p);
    else if (p < screened)
      screened = p;
  }
}

void Search::record(const Candidate& p) {
  const bool better = p.value < best().value;
  if (!contenders_.add(p) || !better) return;
  if (p.value < milestone_ * (1 - budget_.tolerance)) milestone_ = p.value, milestone_motions_ = motions();
  if (progress_ && progress_->size() < progress_->capacity())
    progress_->push_back({motions(), objective_.landings(), seconds(), p.value});
}

std::span<Candidate> Search::contenders(std::span<Candidate, Archive::kMost> buffer) const {
  std::size_t n = contenders_.size();
  std::copy(contenders_.begin(), contenders_.end(), buffer.begin());
  const auto is_held = [&](const Candidate& p) { return p.u == held_.u; };
  if (held_.value < kNoMotion && std::none_of(contenders_.begin(), contenders_.end(), is_held)) buffer[n++] = held_;
  return buffer.first(n);
}

Candidate Search::judge(double accuracy, double deadline) {
  objective_.limit_work(scattered() ? kUnbounded : kCheckWork);
  evaluate_screened(deadline);
  objective_.deadline = deadline;
  const Candidate best = scattered() ? judge_scattered() : judge_exactly(accuracy);
  return held_ < best && valid(held_) && objective_.interrupted() ? held_ : best;
}

/// The best contender over the judging drops, whose value is the promised one; kNoMotion where it breaks the limits in
/// more drops than the measure allows.
Candidate Search::judge_scattered() {
  for (const Candidate& p : {screened_[1], screened_[0]})
    if (contenders_.empty()) contenders_.add(p);
  std::array<Candidate, Archive::kMost> buffer;
  const std::span<Candidate> found = contenders(buffer);
  Candidate best = found.empty() ? centre_ : found[0];
  const bool has_judging = objective_.has_judging();
  bool judged = false;
  for (Candidate p : found) {
    if (!has_judging || objective_.interrupted()) break;
    p.bound = judged ? best.value : kNoMotion;
    objective_.evaluate_judging({&p, 1});
    if (p.value < kNoMotion && (!judged || p < best)) best = p, judged = true;
  }
  if (!valid(best)) best.value = kNoMotion;
  return best;
}

/// Evaluates the contenders at a tight accuracy, then verifies them.
Candidate Search::judge_exactly(double accuracy) {
  constexpr double kJump = 1e-3;
  std::array<Candidate, Archive::kMost> buffer, reevaluated;
  const std::span<Candidate> found = contenders(buffer);
  if (found.empty()) return centre_;
  objective_.limit_work(kCheckWork);
  const double search_accuracy = objective_.accuracy();
  objective_.set_accuracy(objective_.tight_accuracy());
  contenders_.clear();
  // The box of a tolerant peak fills the lanes.
  const std::size_t batch = objective_.goal() == Goal::kPeak ? 4 : 1;
  std::copy(found.begin(), found.end(), reevaluated.begin());
  for (std::size_t i = 0; i < found.size() && found[i].value < best().value && !objective_.interrupted(); i += batch) {
    const auto part = std::span(reevaluated).subspan(i, std::min(batch, found.size() - i));
    for (Candidate& p : part) p.bound = best().value;
    play(part);
  }
  if (best().value > found[0].value * (1 + kJump)) step_back(found[0]);
  objective_.set_accuracy(search_accuracy);
  objective_.limit_work(kCheckWork);
  // The original values where no contender could be followed in lanes, or none was reached.
  Candidate out = centre_;
  for (Candidate p :
       contenders_.empty() ? std::span<const Candidate>(found) : std::span(contenders_.begin(), contenders_.end())) {
    if (p.value >= out.value) break;
    p.value = std::max(p.value, objective_.verified(p, accuracy, out.value));
    out = std::min(out, p);
  }
  return out;
}

/// Steps back from a cliff: a population around the former best, sigma from 1e-2 to 1e-7 of the box, that converges
/// where the peak does not jump.
void Search::step_back(const Candidate& edge) {
  constexpr int kGenerations = 80;
  constexpr double kConverged = 1e-8;
  Random random(seed, 0x5e77);
  std::array<Candidate, 24> population, trials;
  for (Candidate& p : population) p = perturbed(edge, std::pow(10.0, random.uniform(-7, -2)), random);
  play(population);
  for (int n = 0; n < kGenerations && spread(population) > kConverged && !objective_.interrupted(); ++n)
    evolve([this](std::span<Candidate> p) { play(p); }, random, population, trials, {});
}

}  // namespace ukemi::landing
