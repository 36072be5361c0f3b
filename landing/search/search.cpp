#include "landing/search/search.hpp"

#include <algorithm>

#include "landing/search/population.hpp"

namespace ukemi::landing {

namespace {
constexpr std::size_t kContenders = 12;  ///< contenders that an answer is chosen from
constexpr double kSame = 1e-3;           ///< of the box: of neighbours only the best is kept
constexpr double kLast = 3e-3;  ///< processor time for an answer where there is none yet, however late it is [s]
}  // namespace

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
      none_{objective.space().centre()},
      contenders_(kContenders, kSame),
      held_(none_),
      screened_{none_, none_} {
  objective.deadline = start_ + budget.seconds;
  objective.grant(budget.work);
  hold();
}

void Search::hold() {
  constexpr int kRounds = 2, kMany = 64, kFew = 16;  // postures: the best one's valley is narrow
  constexpr std::size_t kJudged = 3;
  constexpr double kApart = 0.1;
  const Scene& scene = objective_.scene();
  const MotionSpace& space = objective_.space();
  auto [low, high] = scene.search.phi;
  const auto holding = [&](double phi) { return Candidate{space.place(*space.holding(phi))}; };
  if (budget_.hold <= 0 || !space.holding(low)) return;
  held_ = holding(held_angle(scene));
  objective_.grant_time(kLast);
  judge_held(held_);
  objective_.grant_time(0);
  if (scene.release) return;
  // Postures on a grid by the peak, then between the best one's neighbours; the best few that lie apart are judged.
  const auto allowed = [&](int postures) { return budget_.hold * most() > postures; };
  const int count = allowed(kRounds * kMany) ? kMany : kFew;
  std::array<Candidate, kMany> memory;
  const auto postures = std::span(memory).first(std::size_t(count));
  Archive best(kJudged, kApart);
  for (int round = 0; round < kRounds && allowed((round + 1) * count); ++round) {
    const double step = (high - low) / (count - 1), from = low;
    for (int i = 0; i < count; ++i) postures[std::size_t(i)] = holding(from + i * step);
    evaluate(postures, Goal::kPeak);
    for (const Candidate& p : postures)
      if (p.value < kNoMotion) best.add(p);
    const auto lowest = std::min_element(postures.begin(), postures.end());
    const double phi = from + double(lowest - postures.begin()) * step;
    low = std::max(low, phi - step), high = std::min(high, phi + step);
  }
  for (const Candidate& p : best) judge_held(p);
}

/// Judges a posture to hold, which may have been played for its peak already.
void Search::judge_held(Candidate p) {
  p.bound = held_.value;
  if (objective_.options().goal != Goal::kPeak || p.value >= kNoMotion) evaluate({&p, 1});
  if (p < held_) held_ = p;
}

/// Plays what was only screened, where nothing that was played is better than holding.
void Search::play_screened(double deadline) {
  objective_.deadline = deadline;
  if (contenders_.empty()) objective_.grant_time(kLast);
  for (Candidate p : screened_) {
    if (best().value < held_.value || p.value >= best().value) continue;
    p.bound = best().value;
    play({&p, 1});
  }
  objective_.grant_time(0);
}

double Search::most() const {
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
  report();
}

void Search::report() const {
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
      keep(p);
    else if (p < screened)
      screened = p;
  }
}

void Search::keep(const Candidate& p) {
  const bool better = p.value < best().value;
  if (!contenders_.add(p) || !better) return;
  if (p.value < milestone_ * (1 - budget_.tolerance)) milestone_ = p.value, milestone_motions_ = motions();
  if (progress_ && progress_->size() < progress_->capacity())
    progress_->push_back({motions(), objective_.landings(), seconds(), p.value});
}

std::span<Candidate> Search::contenders(std::span<Candidate, Archive::kMost> memory) const {
  std::size_t n = contenders_.size();
  std::copy(contenders_.begin(), contenders_.end(), memory.begin());
  const auto is_held = [&](const Candidate& p) { return p.u == held_.u; };
  if (held_.value < kNoMotion && std::none_of(contenders_.begin(), contenders_.end(), is_held)) memory[n++] = held_;
  return memory.first(n);
}

Candidate Search::judge(double accuracy, double deadline) {
  objective_.grant(scattered() ? kUnbounded : kCheckWork);
  play_screened(deadline);
  objective_.deadline = deadline;
  const Candidate best = scattered() ? judge_scattered() : judge_exactly(accuracy);
  return held_ < best && stands(held_) && objective_.late() ? held_ : best;
}

/// The best contender over the drops that judge: its value is what is promised. kNoMotion where it breaks the limits in
/// more drops than the measure allows.
Candidate Search::judge_scattered() {
  for (const Candidate& p : {screened_[1], screened_[0]})
    if (contenders_.empty()) contenders_.add(p);
  std::array<Candidate, Archive::kMost> memory;
  const std::span<Candidate> found = contenders(memory);
  Candidate best = found.empty() ? none_ : found[0];
  const bool judges = !objective_.options().robust->judging.empty();
  bool judged = false;
  for (Candidate p : found) {
    if (!judges || objective_.late()) break;
    p.bound = judged ? best.value : kNoMotion;
    objective_.judge_scattered({&p, 1});
    if (p.value < kNoMotion && (!judged || p < best)) best = p, judged = true;
  }
  if (!stands(best)) best.value = kNoMotion;
  return best;
}

/// The contenders in the lanes at 1e-9, then by the scalar path.
Candidate Search::judge_exactly(double accuracy) {
  constexpr double kFallen = 1e-3, kTight = 1e-9;
  std::array<Candidate, Archive::kMost> memory, again;
  const std::span<Candidate> found = contenders(memory);
  if (found.empty()) return none_;
  objective_.grant(kCheckWork);
  const double searched = objective_.accuracy();
  objective_.set_accuracy(kTight);
  contenders_.clear();
  // A tolerant peak fills the lanes by itself.
  const std::size_t at_once = objective_.options().goal == Goal::kPeak ? 4 : 1;
  std::copy(found.begin(), found.end(), again.begin());
  for (std::size_t i = 0; i < found.size() && found[i].value < best().value && !objective_.late(); i += at_once) {
    const auto part = std::span(again).subspan(i, std::min(at_once, found.size() - i));
    for (Candidate& p : part) p.bound = best().value;
    play(part);
  }
  if (best().value > found[0].value * (1 + kFallen)) step_back(found[0]);
  objective_.set_accuracy(searched);
  objective_.grant(kCheckWork);
  // Where nothing was followed in the lanes, or the deadline came before, what was found is judged.
  Candidate out = none_;
  for (Candidate p :
       contenders_.empty() ? std::span<const Candidate>(found) : std::span(contenders_.begin(), contenders_.end())) {
    if (p.value >= out.value) break;
    p.value = std::max(p.value, objective_.verified(objective_.play(p), accuracy, out.value));
    out = std::min(out, p);
  }
  return out;
}

/// Steps back from a cliff: a population about the place where the best seemed to be, from a hundredth of the box
/// down to its rounding, that converges where the peak does not jump.
void Search::step_back(const Candidate& edge) {
  constexpr int kGenerations = 80;
  constexpr double kConverged = 1e-8;
  Random random(seed, 0x5e77);
  std::array<Candidate, 24> population, trials;
  for (Candidate& p : population) p = beside(edge, std::pow(10.0, random.uniform(-7, -2)), random);
  play(population);
  for (int n = 0; n < kGenerations && spread(population) > kConverged && !objective_.late(); ++n)
    evolve([this](std::span<Candidate> p) { play(p); }, random, population, trials, {});
}

}  // namespace ukemi::landing
