#include "landing/search/planner.hpp"

#include <algorithm>
#include <utility>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/model/release.hpp"
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
                                           {s.gone, 0, 1e3, "gone: 0 to 1e3 s is needed"}}});
}
Plan refused(const char* wrong) { return {.status = Plan::Status::kBadInput, .wrong = wrong}; }
}  // namespace

const char* name(Plan::Status status) {
  constexpr std::array<const char*, 4> kNames = {"found", "nothing", "floor_first", "bad_input"};
  return kNames[std::size_t(status)];
}

Planner::Planner(const Scene& scene, std::shared_ptr<const MotionSpace> space, const Options& options)
    : scene_(scene),
      space_(std::move(space)),
      options_(options),
      robust_(robust_of(scene, options)),
      objective_(scene_, *space_,
                 {.goal = options.goal, .accuracy = options.accuracy, .limits = options.limits, .robust = robust_}) {
  if (!robust_) return;
  objective_.reserve_scattered(AutoSearch::kAtOnce);
  for (const ScatteredDrop& d : robust_->drops)
    beside_.push_back({.height = d.scene.drop.height - scene.drop.height,
                       .forward_speed = d.scene.drop.forward_speed - scene.drop.forward_speed,
                       .pitch = d.scene.drop.pitch - scene.drop.pitch,
                       .pitch_rate = d.scene.drop.pitch_rate - scene.drop.pitch_rate});
}

/// The drops about the scene's.
void Planner::scatter() {
  for (std::size_t k = 0; k < beside_.size(); ++k) {
    const Drop& planned = scene_.drop;
    const Drop& by = beside_[k];
    robust_->drops[k].scene.drop = {std::max(0.0, planned.height + by.height), planned.forward_speed + by.forward_speed,
                                    planned.pitch + by.pitch, planned.pitch_rate + by.pitch_rate,
                                    planned.vertical_speed};
  }
}

Plan Planner::plan(const Drop& drop, double deadline, std::uint64_t seed) {
  if (const char* wrong = fault_of(drop, deadline)) return refused(wrong);
  scene_.drop = drop;
  const Plan out = search(deadline, seed);
  if (out.found() && in_air_ && scene_.release) last_ = in_air_->values_of(out.motion);
  return out;
}

void Planner::start(std::span<const Coordinates> values) {
  given_ = std::min(values.size(), kStarts);
  std::copy_n(values.begin(), given_, starts_.begin());
}

Plan Planner::search(double deadline, std::uint64_t seed) {
  std::array<Coordinates, kStarts> places;
  for (std::size_t i = 0; i < given_; ++i) places[i] = space_->unit(starts_[i]);
  objective_.watch.restart();
  scatter();
  const long before = objective_.motions();
  Search search(objective_, {.seconds = deadline - verification_time(deadline, objective_.landing_time())}, seed);
  search.hints = std::span(places).first(std::exchange(given_, 0));
  search_.run(search);
  const long searched = objective_.motions() - before;
  const Candidate best = search.judge(options_.verified, deadline);
  const Play play = objective_.play(best);
  return {best.value < kNoMotion ? Plan::Status::kFound : Plan::Status::kNothing,
          play.motion,
          play.sea,
          best.value,
          searched,
          space_->edges(space_->values(best.u))};
}

Plan Planner::plan(const FallState& s, double deadline, std::uint64_t seed) {
  if (!in_air_ || !scene_.release)
    throw InputError("planner: the scene has no [release]: it is needed for a plan in the air");
  const double fallen = s.vertical_speed.value_or(-scene_.robot.gravity * s.gone);
  const Drop drop{s.height, s.forward_speed, s.pitch, s.pitch_rate, fallen};
  for (const char* wrong : {fault_of(s), fault_of(drop, deadline)})
    if (wrong) return refused(wrong);
  scene_.drop = drop;
  scene_.release = Release{s.phi, s.rate, deadline};
  if (!(fall_time(scene_) > deadline)) return {.status = Plan::Status::kFloorFirst};
  in_air_->release(scene_);
  // The last plan goes on where it was: its move ends when it would have.
  const int to = in_air_->dimension() - 1;
  if (given_ > 0)
    last_ = starts_[0];  // where nothing is found, the next plan begins there
  else if (last_)
    start(*last_);
  for (std::size_t i = 0; i < given_; ++i) starts_[i][to] -= s.gone;
  const Plan out = search(deadline, seed);
  if (out.found()) last_ = in_air_->values_of(out.motion), (*last_)[to] += s.gone;
  return out;
}

}  // namespace ukemi::landing
