#include "landing/search.hpp"

#include <algorithm>

namespace ukemi::landing {

Search::Search(Objective& objective, const Budget& budget, std::uint64_t seed_)
    : seed(seed_),
      objective_(objective),
      budget_(budget),
      start_(Objective::Clock::now()),
      first_motion_(objective.motions()) {
  constexpr std::size_t kKept = 4096;
  progress.reserve(kKept);
  objective.deadline = budget.seconds < 1e6
                           ? start_ + std::chrono::duration_cast<Objective::Clock::duration>(
                                          std::chrono::duration<double>(budget.seconds))
                           : Objective::Clock::time_point::max();
}

double Search::share() const {
  const double time = budget_.seconds < 1e6 ? seconds() / budget_.seconds : 0;
  return std::min(1.0, std::max(time, double(motions()) / double(budget_.motions)));
}

void Search::evaluate(std::span<Point3> points) {
  const auto n = std::size_t(std::clamp<long>(budget_.motions - motions(), 0, long(points.size())));
  for (Point3& p : points.subspan(n)) p.value = kNoMotion;
  if (n == 0) return;
  objective_.evaluate(points.first(n));
  for (const Point3& p : points.first(n))
    if (p.value <= p.bound && p.value < few_.back().value) keep(p);
}

void Search::keep(const Point3& p) {
  const bool better = p.value < few_[0].value;
  std::size_t i = few_.size() - 1;
  for (; i > 0 && p.value < few_[i - 1].value; --i) few_[i] = few_[i - 1];
  few_[i] = p;
  if (better && progress.size() < progress.capacity())
    progress.push_back({motions(), objective_.landings(), seconds(), p});
}

Point3 Search::verified_best(double accuracy) const {
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
