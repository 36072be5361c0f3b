#include "landing/search.hpp"

#include <algorithm>

#include "common/random.hpp"

namespace ukemi::landing {

Search::Search(Objective& objective, const Budget& budget, std::uint64_t seed_, std::vector<Progress>* progress)
    : seed(seed_),
      objective_(objective),
      budget_(budget),
      start_(Objective::Clock::now()),
      first_motion_(objective.motions()),
      progress_(progress) {
  objective.deadline = budget.seconds < 1e6 ? start_ + std::chrono::duration_cast<Objective::Clock::duration>(
                                                           std::chrono::duration<double>(budget.seconds))
                                            : Objective::Clock::time_point::max();
}

double Search::share() const {
  const double time = budget_.seconds < 1e6 ? seconds() / budget_.seconds : 0;
  return std::min(1.0, std::max(time, double(motions()) / double(budget_.motions)));
}

void Search::evaluate(std::span<Point3> points) { evaluate(points, objective_.options().goal); }

void Search::evaluate(std::span<Point3> points, Goal goal) {
  const auto n = std::size_t(std::clamp<long>(budget_.motions - motions(), 0, long(points.size())));
  for (Point3& p : points.subspan(n)) p.value = kNoMotion;
  if (n == 0) return;
  objective_.evaluate(points.first(n), goal);
  if (tell) tell(motions(), budget_.motions);
  if (goal != objective_.options().goal) return;
  for (const Point3& p : points.first(n))
    if (p.value <= p.bound && p.value < few_.back().value) keep(p);
}

void Search::keep(const Point3& p) {
  const bool better = p.value < few_[0].value;
  std::size_t i = few_.size() - 1;
  for (; i > 0 && p.value < few_[i - 1].value; --i) few_[i] = few_[i - 1];
  few_[i] = p;
  if (better && progress_ && progress_->size() < progress_->capacity())
    progress_->push_back({motions(), objective_.landings(), seconds(), p});
}

Point3 Search::settle(double accuracy, Objective::Clock::time_point deadline) {
  constexpr double kFallen = 1e-3, kTight = 1e-9;
  constexpr std::size_t kBack = 24;  // motions at a time on the way back from an edge
  if (few_[0].value >= kNoMotion) return few_[0];
  objective_.deadline = deadline;
  const double searched = objective_.accuracy();
  objective_.set_accuracy(kTight);
  const std::array<Point3, 12> found = few_;
  const auto play = [&](std::span<Point3> points) {
    objective_.evaluate(points, objective_.options().goal);
    for (const Point3& p : points)
      if (p.value <= p.bound && p.value < few_.back().value) keep(p);
  };
  few_.fill({});
  std::array<Point3, 3> first = {found[0], found[1], found[2]};
  for (Point3& p : first) p.bound = kNoMotion;
  play(first);
  const double wanted = found[0].value * (1 + kFallen);
  if (few_[0].value > wanted) {
    Random random(seed, 0x5e77);
    std::array<Point3, kBack> points;
    for (double size = 1e-6; size < 1e-2 && few_[0].value > wanted && !objective_.late(); size *= 4) {
      for (Point3& p : points) {
        p = found[std::size_t(random.uniform() * 4)];
        for (double& u : p.u) u = std::clamp(u + size * random.uniform(-1, 1), 0.0, 1.0);
        p.bound = few_[0].value;
      }
      play(points);
    }
  }
  objective_.set_accuracy(searched);
  Point3 best;
  for (const Point3& p : few_) {
    if (p.value >= best.value) break;
    Point3 tight = p;
    tight.value = objective_.verified(objective_.motion(p), accuracy, best.value);
    if (tight.value < best.value) best = tight;
  }
  return best;
}

}  // namespace ukemi::landing
