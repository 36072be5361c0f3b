#include "landing/search/planner.hpp"

#include <algorithm>
#include <utility>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/model/release.hpp"
#include "landing/search/auto_search.hpp"
#include "landing/search/deadline.hpp"
#include "landing/search/population.hpp"

namespace ukemi::landing {

double verification_time(double budget, double landing) {
  return std::min(0.45 * budget, std::max(kTightLanding * landing, std::clamp(0.05 * budget, 0.003, 0.1)));
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

/// A measured number, and what it may be.
struct Measured {
  double value, lower, upper;
  const char* rule;
};
const char* fault_of(std::span<const Measured> numbers) {
  for (const Measured& m : numbers)
    if (!(m.value >= m.lower && m.value <= m.upper)) return m.rule;
  return nullptr;
}

constexpr double kFull = 6.283185307179586, kFast = 1e3;  // [rad], [m/s] or [rad/s]

/// Which number of a drop, or of the deadline, cannot be; null: none.
const char* fault_of(const Drop& d, double deadline) {
  return fault_of(std::array<Measured, 6>{
      {{d.height, 0, 1e4, "height: 0 to 1e4 m is needed"},
       {d.forward_speed, -kFast, kFast, "forward_speed: at most 1e3 m/s either way is needed"},
       {d.pitch, -kFull, kFull, "pitch: at most 2 pi rad either way is needed"},
       {d.pitch_rate, -kFast, kFast, "pitch_rate: at most 1e3 rad/s either way is needed"},
       {d.vertical_speed, -kFast, kFast, "vertical_speed: at most 1e3 m/s either way is needed"},
       {deadline, std::numeric_limits<double>::min(), std::numeric_limits<double>::max(),
        "deadline: above 0 s and finite is needed"}}});
}
const char* fault_of(const FallState& s) {
  return fault_of(std::array<Measured, 3>{{{s.phi, -kFull, kFull, "phi: at most 2 pi rad either way is needed"},
                                           {s.rate, -kFast, kFast, "rate: at most 1e3 rad/s either way is needed"},
                                           {s.elapsed, 0, 1e3, "elapsed: 0 to 1e3 s is needed"}}});
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
  std::shared_ptr<ReferenceSpace> in_air;  ///< the same, where it is ours to change
  Options options;
  std::shared_ptr<Robust> robust;  ///< for Goal::kRobust: its drops lie about the one that is planned for
  std::vector<Drop> beside;        ///< each drop, less the planned one
  Objective objective;
  AutoSearch search;
  std::optional<MotionValues> last;          ///< the last plan, the end of its move in the air counted from release
  std::array<MotionValues, kStarts> starts;  ///< see `start`
  std::size_t given = 0;                     ///< how many of them the next plan starts from
};

Planner::Search::Search(const Scene& s, std::shared_ptr<const MotionSpace> motions, const Options& o)
    : scene(s),
      space(std::move(motions)),
      options(o),
      robust(robust_of(s, o)),
      objective(scene, *space, {.goal = o.goal, .accuracy = o.accuracy, .limits = o.limits, .robust = robust}) {
  if (!robust) return;
  objective.reserve_scattered(AutoSearch::kAtOnce);
  for (const ScatteredDrop& d : robust->drops)
    beside.push_back({.height = d.scene.drop.height - scene.drop.height,
                      .forward_speed = d.scene.drop.forward_speed - scene.drop.forward_speed,
                      .pitch = d.scene.drop.pitch - scene.drop.pitch,
                      .pitch_rate = d.scene.drop.pitch_rate - scene.drop.pitch_rate});
}

/// The drops about the scene's.
void Planner::Search::scatter() {
  for (std::size_t k = 0; k < beside.size(); ++k) {
    const Drop& planned = scene.drop;
    const Drop& offset = beside[k];
    robust->drops[k].scene.drop = {std::max(0.0, planned.height + offset.height),
                                   planned.forward_speed + offset.forward_speed, planned.pitch + offset.pitch,
                                   planned.pitch_rate + offset.pitch_rate, planned.vertical_speed};
  }
}

/// From the places of `starts`, which are then spent.
Plan Planner::Search::plan(double deadline, std::uint64_t seed) {
  std::array<Coordinates, kStarts> places;
  for (std::size_t i = 0; i < given; ++i) places[i] = space->unit(starts[i]);
  objective.watch.restart();
  scatter();
  const long before = objective.motions();
  const double seconds = deadline - verification_time(deadline, objective.landing_time());
  landing::Search spent(objective, {.seconds = seconds}, seed);
  spent.hints = std::span(places).first(std::exchange(given, 0));
  if (!spent.hints.empty() || last) {  // no answer is worse than what is known
    Candidate known{spent.hints.empty() ? space->unit(*last) : spent.hints[0]};
    spent.evaluate({&known, 1});
  }
  search.run(spent);
  const long searched = objective.motions() - before;
  const Candidate best = spent.judge(options.verified, deadline);
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
  if (const char* wrong = fault_of(drop, deadline)) return refused(wrong);
  Search& s = *search_;
  s.scene.drop = drop;
  return s.plan(deadline, seed);
}

void Planner::start(std::span<const MotionValues> values) {
  search_->given = std::min(values.size(), kStarts);
  std::copy_n(values.begin(), search_->given, search_->starts.begin());
}

Plan Planner::plan(const FallState& state, double deadline, std::uint64_t seed) {
  Search& s = *search_;
  if (!s.in_air || !s.scene.release)
    throw InputError("planner: the scene has no [release]: it is needed for a plan in the air");
  const double fallen = state.vertical_speed.value_or(-s.scene.robot.gravity * state.elapsed);
  const Drop drop{state.height, state.forward_speed, state.pitch, state.pitch_rate, fallen};
  for (const char* wrong : {fault_of(state), fault_of(drop, deadline)})
    if (wrong) return refused(wrong);
  s.scene.drop = drop;
  s.scene.release = Release{state.phi, state.rate, deadline};
  if (!(fall_time(s.scene) > deadline)) return {.status = Plan::Status::kFloorFirst};
  s.in_air->release(s.scene);
  // The last plan goes on where it was: its move ends when it would have.
  const int to = s.in_air->dimension() - 1;
  if (s.given > 0)
    s.last = s.starts[0];  // where nothing is found, the next plan begins there
  else if (s.last)
    start(*s.last);
  for (std::size_t i = 0; i < s.given; ++i) s.starts[i][to] -= state.elapsed;
  const Plan out = s.plan(deadline, seed);
  if (out.found()) (*s.last)[to] += state.elapsed;
  return out;
}

}  // namespace ukemi::landing
