#include "landing/plan/body_objective.hpp"

#include <algorithm>

#include "common/parallel.hpp"
#include "landing/body/load.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/search/population.hpp"

namespace ukemi::landing {

BodyObjective::BodyObjective(const BodyScene& scene, const BodySpace& space, const BodyGoals& goals,
                             const Common& options, double held_value)
    : Objective(options),
      scene_(scene),
      space_(space),
      goals_(goals),
      nominal_(nominal_drop(scene)),
      held_value_(held_value) {
  const double before = watch.seconds();
  (void)peak_acceleration(scene, held_posture(scene), {.accuracy = options.accuracy, .over = over()});
  landing_time_ = watch.seconds() - before;
}

const BodyGoal& BodyObjective::goal_of(Fidelity fidelity) const {
  if (exact(fidelity)) return goals_.search;
  if (fidelity.goal != Goal::kRobust) return nominal_;
  const std::vector<BodyDrop>& drops = goals_.search.drops;
  if (few_.drops.size() != fidelity.drops)
    few_ = {.measure = goals_.search.measure,
            .drops = {drops.begin(), drops.begin() + long(fidelity.drops)},
            .share = goals_.search.share};
  return few_;
}

void BodyObjective::evaluate(std::span<Candidate> points, Fidelity fidelity) {
  const BodyGoal& goal = goal_of(fidelity);
  std::vector<Valuation> motions;
  motions.reserve(points.size());
  for (const Candidate& p : points) motions.emplace_back(goal, motion(p), p.bound);
  play(motions, scene_.robot, accuracy(), threads(), over());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].value = motions[i].value(), points[i].first_contact = motions[i].first_contact();
    landings_ += motions[i].played(), flights_ += motions[i].flew();
  }
  motions_ += long(points.size());
  if (goal.single() && exact(fidelity) && scene_.limited() && !goals_.judge.single()) check_limits(points);
}

void BodyObjective::check_limits(std::span<Candidate> points) {
  std::vector<Candidate*> better;
  for (Candidate& p : points)
    if (p.value <= p.bound && p.value < lowest_) better.push_back(&p);
  std::vector<Valuation> motions;
  for (const Candidate* p : better) motions.emplace_back(goals_.judge, motion(*p), kNoMotion);
  play(motions, scene_.robot, accuracy(), threads(), over());
  for (std::size_t i = 0; i < better.size(); ++i)
    if (motions[i].value() < kNoMotion)
      lowest_ = std::min(lowest_, better[i]->value);
    else
      better[i]->value = kNoMotion;
}

double BodyObjective::verified(const Candidate& p, double accuracy, double) {
  const Judged result = judged(goals_.judge, motion(p), accuracy, threads(), over());
  if (!(result.value < kNoMotion) && interrupted()) return 0;
  return result.keeps_limits ? result.value : kNoMotion;
}

void BodyObjective::evaluate_judging(std::span<Candidate> points) {
  for (Candidate& p : points) {
    const Judged result = judged(goals_.judge, motion(p), accuracy(), threads(), over());
    p.value = result.keeps_limits ? result.value : kNoMotion;
  }
}

std::optional<Candidate> BodyObjective::held() const {
  if (scene_.release) return std::nullopt;
  return Candidate{space_.unit(held_posture(scene_)), held_value_};
}

void BodyObjective::draw_postures(int round, std::span<Candidate> postures) const {
  constexpr double kAround = 0.1;  // sigma, as a fraction of the box
  Random random(std::uint64_t(round) + 1);
  const Candidate best = *std::min_element(postures.begin(), postures.end());
  for (Candidate& p : postures) {
    p = round == 0 ? random_point(random, dimension()) : perturbed(best, kAround, random);
    p.u = space_.held(p.u);
  }
}

namespace {

/// Peaks with derivatives of a drop; with more than one drop fewer of each.
int rows_of(const BodyGoal& goal) { return goal.single() ? 6 : 2; }

/// Peaks that a goal is the largest of, each by its rating, the largest first.
std::vector<std::pair<double, const BodyPeakGradient*>> rated_peaks(const BodyScene& scene, const BodyGradients& g) {
  std::vector<std::pair<double, const BodyPeakGradient*>> out;
  if (!rated(scene))
    for (const BodyPeakGradient& p : g.peaks) out.emplace_back(1, &p);
  for (std::size_t i = 0; i < g.loads.size(); ++i)
    for (const BodyPeakGradient& p : g.loads[i])
      if (!scene.loads[i].limit) out.emplace_back(scene.loads[i].rating, &p);
  std::erase_if(out, [](const auto& row) { return !row.second->d.allFinite(); });
  std::stable_sort(out.begin(), out.end(), [](const auto& one, const auto& other) {
    return one.second->value / one.first > other.second->value / other.first;
  });
  return out;
}

}  // namespace

int BodyObjective::gradient_rows(Fidelity fidelity) const {
  const BodyGoal& goal = goal_of(fidelity);
  return goal.worst() && !scene_.limited() ? rows_of(goal) * int(goal.counted) : 0;
}

void BodyObjective::linearise(const Coordinates& u, Fidelity fidelity, std::span<double> peaks,
                              std::span<double> gradient) {
  const BodyGoal& goal = goal_of(fidelity);
  const auto n = std::size_t(dimension()), per_drop = std::size_t(rows_of(goal));
  const std::vector<BodyParameter> parameters = space_.parameters();
  const BodyMotion motion = space_.motion(u);
  std::fill(peaks.begin(), peaks.end(), 0.0), std::fill(gradient.begin(), gradient.end(), 0.0);
  parallel_for(int(goal.counted), threads(), [&](int k) {
    const BodyDrop& drop = goal.drops[std::size_t(k)];
    const BodyGradients g =
        gradients(drop.scene, drop.played(motion), parameters, {.accuracy = accuracy(), .over = over()}, int(per_drop));
    const auto found = rated_peaks(drop.scene, g);
    for (std::size_t i = 0; i < std::min(found.size(), per_drop); ++i) {
      const auto [rating, peak] = found[i];
      const std::size_t row = std::size_t(k) * per_drop + i;
      peaks[row] = peak->value / rating;
      for (std::size_t j = 0; j < n; ++j)
        gradient[row * n + j] = peak->d[long(j)] * (variables()[j].upper - variables()[j].lower) / rating;
    }
  });
  constexpr long kMotions = 50, kAtOnce = 8;  // of lanes; derivatives at once
  const long cost = kMotions * ((long(n) + kAtOnce - 1) / kAtOnce);
  motions_ += cost, landings_ += cost * long(goal.counted);
}

}  // namespace ukemi::landing
