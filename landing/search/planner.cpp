#include "landing/search/planner.hpp"

#include <algorithm>
#include <utility>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/model/release.hpp"
#include "landing/search/auto_search.hpp"
#include "landing/search/deadline.hpp"
#include "landing/search/measured_range.hpp"
#include "landing/search/population.hpp"
#include "landing/search/two_link_objective.hpp"

namespace ukemi::landing {

double verification_time(double budget, double landing) {
  return std::min(0.45 * budget, std::max(kTightCost * landing, std::clamp(0.05 * budget, 0.003, 0.1)));
}

void check_deadline(double deadline) {
  if (!(deadline > 0)) throw InputError("deadline: " + shortest(deadline) + " s: above 0 is needed");
}

namespace {
std::shared_ptr<Robust> robust_of(const Scene& scene, const Planner::Options& options) {
  if (options.goal != Goal::kRobust) return nullptr;
  const auto& o = options.under_scatter;
  check_count("planner: drops", o.drops, 1, 4096);
  auto out = std::make_shared<Robust>();
  out->measure = o.measure, out->penalty = o.penalty;
  out->drops = DropModel(scene, o.scatter).even(o.drops, 1);
  return out;
}

Plan refused(const char* wrong) { return {.status = Plan::Status::kBadInput, .wrong = wrong}; }
}  // namespace

const char* name(Plan::Status status) {
  constexpr std::array<const char*, 4> kNames = {"found", "nothing", "floor_first", "bad_input"};
  return kNames[std::size_t(status)];
}

/// The scene, the motions, and all the memory that a search needs.
struct Planner::Search {
  Search(const Scene& s, std::shared_ptr<const MotionSpace> motions, const Options& o);
  void scatter();
  Plan plan(double deadline, std::uint64_t seed);

  Scene scene;
  std::shared_ptr<const MotionSpace> space;
  std::shared_ptr<ReferenceSpace> in_air;  ///< `space` where it can be released in the air; else null
  Options options;
  std::shared_ptr<Robust> robust;  ///< for Goal::kRobust: its drops scatter about the planned one
  std::vector<Drop> offsets;       ///< of each drop from the planned one
  TwoLinkObjective objective;
  AutoSearch search;
  std::optional<MotionValues> last;          ///< the last plan, the end of its move in the air counted from release
  std::array<MotionValues, kStarts> starts;  ///< see `start`
  std::size_t start_count = 0;               ///< of `starts`, for the next plan
};

Planner::Search::Search(const Scene& s, std::shared_ptr<const MotionSpace> motions, const Options& o)
    : scene(s),
      space(std::move(motions)),
      options(o),
      robust(robust_of(s, o)),
      objective(scene, *space, {.goal = o.goal, .accuracy = o.accuracy, .limits = o.limits, .robust = robust}) {
  if (!robust) return;
  objective.reserve_scattered(AutoSearch::kMaxBatch);
  for (const ScatteredDrop& d : robust->drops)
    offsets.push_back({.height = d.scene.drop.height - scene.drop.height,
                       .forward_speed = d.scene.drop.forward_speed - scene.drop.forward_speed,
                       .pitch = d.scene.drop.pitch - scene.drop.pitch,
                       .pitch_rate = d.scene.drop.pitch_rate - scene.drop.pitch_rate});
}

/// Moves the drops to the scene's.
void Planner::Search::scatter() {
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    const Drop& planned = scene.drop;
    const Drop& offset = offsets[k];
    robust->drops[k].scene.drop = {std::max(0.0, planned.height + offset.height),
                                   planned.forward_speed + offset.forward_speed, planned.pitch + offset.pitch,
                                   planned.pitch_rate + offset.pitch_rate, planned.vertical_speed};
  }
}

/// Plans from `starts`, which are cleared.
Plan Planner::Search::plan(double deadline, std::uint64_t seed) {
  std::array<Coordinates, kStarts> units;
  for (std::size_t i = 0; i < start_count; ++i) units[i] = space->unit(starts[i]);
  objective.watch.restart();
  scatter();
  const long before = objective.motions();
  const double seconds = deadline - verification_time(deadline, objective.landing_time());
  landing::Search task(objective, {.seconds = seconds}, seed);
  task.warm_starts = std::span(units).first(std::exchange(start_count, 0));
  if (!task.warm_starts.empty() || last) {  // no answer is worse than these
    Candidate known{task.warm_starts.empty() ? space->unit(*last) : task.warm_starts[0]};
    task.evaluate({&known, 1});
  }
  search.run(task);
  const long searched = objective.motions() - before;
  const Candidate best = task.judge(options.verified, deadline);
  if (best.value < kNoMotion) last = space->values(best.u);
  const DrivenMotion play = objective.play(best);
  return {best.value < kNoMotion ? Plan::Status::kFound : Plan::Status::kNothing,
          play.motion,
          play.sea,
          best.value,
          searched,
          space->edges(space->values(best.u))};
}

Planner::Planner(const Scene& scene, std::shared_ptr<const MotionSpace> space, const Options& options)
    : search_(std::make_unique<Search>(scene, std::move(space), options)) {}
Planner::Planner(const Scene& scene, const SeaParameters<double>& sea, const Options& options) {
  auto space = std::make_shared<ReferenceSpace>(scene, sea);
  search_ = std::make_unique<Search>(scene, space, options);
  search_->in_air = std::move(space);
}
Planner::~Planner() = default;

Plan Planner::plan(const Drop& drop, double deadline, std::uint64_t seed) {
  for (const char* wrong : {fault_of(drop), fault_of_deadline(deadline)})
    if (wrong) return refused(wrong);
  Search& s = *search_;
  s.scene.drop = drop;
  return s.plan(deadline, seed);
}

void Planner::start(std::span<const MotionValues> values) {
  search_->start_count = std::min(values.size(), kStarts);
  std::copy_n(values.begin(), search_->start_count, search_->starts.begin());
}

Plan Planner::plan(const FallState& state, double deadline, std::uint64_t seed) {
  Search& s = *search_;
  if (!s.in_air || !s.scene.release)
    throw InputError("planner: the scene has no [release]: it is needed for a plan in the air");
  const double vertical_speed = state.vertical_speed.value_or(-s.scene.robot.gravity * state.elapsed);
  const Drop drop{state.height, state.forward_speed, state.pitch, state.pitch_rate, vertical_speed};
  for (const char* wrong : {fault_of_joint(state.phi, state.rate), fault_of_elapsed(state.elapsed), fault_of(drop),
                            fault_of_deadline(deadline)})
    if (wrong) return refused(wrong);
  s.scene.drop = drop;
  s.scene.release = Release{state.phi, state.rate, deadline};
  if (!(fall_time(s.scene) > deadline)) return {.status = Plan::Status::kFloorFirst};
  s.in_air->release(s.scene);
  // The move of the last plan ends at the same time after release.
  const int move_end = s.in_air->dimension() - 1;
  if (s.start_count > 0)
    s.last = s.starts[0];  // where nothing is found, the next plan begins there
  else if (s.last)
    start(*s.last);
  for (std::size_t i = 0; i < s.start_count; ++i) s.starts[i][move_end] -= state.elapsed;
  const Plan out = s.plan(deadline, seed);
  if (out.found()) (*s.last)[move_end] += state.elapsed;
  return out;
}

}  // namespace ukemi::landing
