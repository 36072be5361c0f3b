// The face of the landing libraries: every field of what is handed in set to what it must not be, one at a time, and
// every public entry called with it. Each returns within seconds, or throws InputError; a number that comes back is
// one.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "common/actuator_constants.hpp"
#include "common/checks.hpp"
#include "common/stopwatch.hpp"
#include "landing/atlas/atlas.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/atlas/two_link_atlas.hpp"
#include "landing/derivatives/gradient.hpp"
#include "landing/drops/drop_rollout.hpp"
#include "landing/judge/answer.hpp"
#include "landing/judge/risk.hpp"
#include "landing/judge/survey.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/scene_file.hpp"
#include "test/folder.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using test::refusal;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
constexpr double kWrong[] = {kNaN, kInfinity, -kInfinity, -1, 1e300};
constexpr long kWrongCounts[] = {-1, 0, std::numeric_limits<long>::min(), std::numeric_limits<long>::max()};

/// All that the entries are called with.
struct Input {
  Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  Actuator actuator = read_actuator(UKEMI_DATASETS "/actuators/table2.toml");
  Motion motion{-0.5, -1.2, 0.2};
  SimulateOptions simulate;
  double rate = 10;
  BatchOptions batch;
  Scatter scatter = Scatter::assumed();
  DropModel::Options drops;
  RiskOptions risk{.samples = 64};
  MapOptions map{.cells = {2, 2, 2}, .polished = 1};
  EvidenceOptions evidence{.accuracy = 1e-6, .work = 1000};  // its first landing
  UnderScatterOptions under{.samples = 16};
  RobustOptions robust{.measure = Measure{}, .samples = 16, .judging = 16};
  std::vector<double> times{0, 0.1, 0.3};
  Input() {
    // A run that whirls, or a fall that never ends, is bounded by its steps here, as it is by default.
    simulate.max_steps = batch.max_steps = 2000;
    map.monitor.stop =
        evidence.monitor.stop = [watch = Stopwatch(Stopwatch::Time::kWall)] { return watch.seconds() > 2; };
    under.monitor.stop = risk.monitor.stop = map.monitor.stop;
    scene.joint = std::array{-2.5, 0.5};
    scene.detection_delay = 0.001;
    motion.reposition = Reposition{-0.6, 0, 0.05, 0.15};
    motion.bumps = {0.1, 0, 0, 0};
  }
};

using Number = std::pair<const char*, std::function<double&(Input&)>>;
#define UKEMI_FIELD(field)                               \
  {                                                      \
#field, [](Input & x) -> double& { return x.field; } \
  }

std::vector<Number> numbers() {
  std::vector<Number> out = {UKEMI_FIELD(scene.robot.mass[0]),
                             UKEMI_FIELD(scene.robot.mass[1]),
                             UKEMI_FIELD(scene.robot.inertia_com[0]),
                             UKEMI_FIELD(scene.robot.inertia_com[1]),
                             UKEMI_FIELD(scene.robot.link_length),
                             UKEMI_FIELD(scene.robot.gravity),
                             UKEMI_FIELD(scene.floor->stiffness),
                             UKEMI_FIELD(scene.floor->damping_normal),
                             UKEMI_FIELD(scene.floor->damping_tangential),
                             UKEMI_FIELD(scene.drop.height),
                             UKEMI_FIELD(scene.drop.forward_speed),
                             UKEMI_FIELD(scene.drop.pitch),
                             UKEMI_FIELD(scene.drop.pitch_rate),
                             UKEMI_FIELD(scene.drop.vertical_speed),
                             UKEMI_FIELD(scene.detection_delay),
                             UKEMI_FIELD(scene.joint->at(0)),
                             UKEMI_FIELD(scene.joint->at(1)),
                             UKEMI_FIELD(scene.search.phi[0]),
                             UKEMI_FIELD(scene.search.phi[1]),
                             UKEMI_FIELD(scene.search.duration[0]),
                             UKEMI_FIELD(scene.search.duration[1]),
                             UKEMI_FIELD(scene.execution.phi),
                             UKEMI_FIELD(scene.execution.duration),
                             UKEMI_FIELD(motion.phi_i),
                             UKEMI_FIELD(motion.phi_f),
                             UKEMI_FIELD(motion.duration),
                             UKEMI_FIELD(motion.bumps[0]),
                             UKEMI_FIELD(motion.gain_p),
                             UKEMI_FIELD(motion.gain_d),
                             UKEMI_FIELD(motion.reposition->phi),
                             UKEMI_FIELD(motion.reposition->rate),
                             UKEMI_FIELD(motion.reposition->from),
                             UKEMI_FIELD(motion.reposition->to),
                             UKEMI_FIELD(simulate.accuracy),
                             UKEMI_FIELD(simulate.abandon_above),
                             UKEMI_FIELD(simulate.max_step),
                             UKEMI_FIELD(simulate.limits.motor_speed),
                             UKEMI_FIELD(simulate.limits.motor_torque),
                             UKEMI_FIELD(simulate.limits.joint[0]),
                             UKEMI_FIELD(simulate.limits.joint[1]),
                             UKEMI_FIELD(simulate.limits.reference_rate),
                             UKEMI_FIELD(rate),
                             UKEMI_FIELD(batch.accuracy),
                             UKEMI_FIELD(batch.limits.motor_speed),
                             UKEMI_FIELD(drops.inflate),
                             UKEMI_FIELD(map.accuracy),
                             UKEMI_FIELD(map.tight),
                             UKEMI_FIELD(evidence.accuracy),
                             UKEMI_FIELD(under.penalty),
                             UKEMI_FIELD(under.rate),
                             UKEMI_FIELD(under.measure.level),
                             UKEMI_FIELD(robust.inflate),
                             UKEMI_FIELD(robust.penalty),
                             UKEMI_FIELD(robust.measure->level),
                             UKEMI_FIELD(times[1]),
                             UKEMI_FIELD(actuator.sea.k_p),
                             UKEMI_FIELD(actuator.sea.k_d),
                             UKEMI_FIELD(actuator.sea.k_sea),
                             UKEMI_FIELD(actuator.sea.c_sea),
                             UKEMI_FIELD(actuator.sea.i_motor),
                             UKEMI_FIELD(actuator.sea.tau_max)};
  for (const ActuatorConstant& c : optional_constants())
    out.push_back({c.key, [at = c.at](Input& x) -> double& { return x.actuator.sea.*at; }});
  for (const ScatterTerm& t : kScatterTerms)
    out.push_back({t.name, [at = t.deviation](Input& x) -> double& { return x.scatter.*at; }});
  return out;
}

using Count = std::pair<const char*, std::function<void(Input&, long)>>;
#define UKEMI_COUNT(field)                                            \
  {                                                                   \
#field, [](Input & x, long n) { x.field = decltype(x.field)(n); } \
  }

std::vector<Count> counts() {
  return {UKEMI_COUNT(simulate.max_steps), UKEMI_COUNT(batch.max_steps), UKEMI_COUNT(risk.samples),
          UKEMI_COUNT(map.cells[0]),       UKEMI_COUNT(map.polished),    UKEMI_COUNT(evidence.tolerance_samples),
          UKEMI_COUNT(under.samples),      UKEMI_COUNT(robust.samples),  UKEMI_COUNT(robust.judging),
          UKEMI_COUNT(scene.freedom.bumps)};
}

/// A public entry. What it returns is judged by it: false for a number that looks like an answer and is none.
struct Entry {
  const char* name;
  std::function<bool(Input&)> call;
  bool long_call = false;  ///< it plays hundreds of landings: asked with NaN alone
};
bool good(const LandingPeak& l) { return no_landing(l.end) || l.end == End::kStopped || std::isfinite(l.peak); }
bool good(const Distribution& d) { return d.samples == 0 || !std::isnan(d.mean.value); }

std::vector<LandingPeak> in_lanes(Input& x, std::size_t peaks) {
  const BatchCase one{&x.scene, &x.actuator.sea, x.motion};
  std::vector<LandingPeak> out(peaks);
  batch_peaks({&one, 1}, out, x.batch);
  return out;
}

std::vector<Entry> entries() {
  return {
      {"peak_acceleration",
       [](Input& x) { return good(peak_acceleration(x.scene, x.actuator.sea, x.motion, x.simulate)); }},
      {"simulate", [](Input& x) { return good(simulate(x.scene, x.actuator.sea, x.motion, x.simulate, x.rate)); }},
      {"first_touchdown", [](Input& x) { return !std::isnan(first_touchdown(x.scene, x.actuator.sea, x.motion)); }},
      {"batch_peaks", [](Input& x) { return good(in_lanes(x, 1)[0]); }},
      {"quintic_peaks",
       [](Input& x) {
         const auto found = quintic_peaks(x.scene, x.actuator.sea, x.motion, x.simulate, 2);
         return found.end == End::kFailed || found.peaks.empty() || std::isfinite(found.peaks[0].value);
       }},
      {"roll_drop",
       [](Input& x) {
         const DropRollout r = roll_drop(x.scene, x.actuator.sea, x.motion, x.times, x.simulate);
         return !r.complete || std::isfinite(r.value[kAcc].back());
       }},
      {"risk",
       [](Input& x) {
         const DropModel model(x.scene, x.scatter, x.actuator, x.drops);
         return good(risk(model, x.actuator, x.motion, x.risk).peaks);
       }},
      {"under_scatter",
       [](Input& x) {
         const DropModel model(x.scene, x.scatter, x.actuator, x.drops);
         const ReferenceSpace space(x.scene, x.actuator.sea);
         return good(under_scatter(model, space, {x.motion, x.actuator.sea}, x.under).planned);
       },
       true},
      {"robust_goal",
       [](Input& x) {
         return !robust_goal(DropModel(x.scene, x.scatter, x.actuator, x.drops), x.robust, 1)->drops.empty();
       }},
      {"map_peaks",
       [](Input& x) {
         const PeakMap map = map_peaks(x.scene, ReferenceSpace(x.scene, x.actuator.sea), x.map);
         return map.grid.size() >= 2;
       }},
      {"evidence",
       [](Input& x) {
         x.motion.reposition.reset();
         return !std::isnan(evidence(x.scene, x.actuator.sea, x.motion, x.evidence).peak);
       }},
      {"touchdown_limit",
       [](Input& x) {
         const TouchdownLimit l = touchdown_limit(x.scene, x.actuator.sea);
         return !l.found || std::isfinite(l.jump);
       },
       true},
  };
}

/// Calls one entry with what `change` has made of a good input.
void ask(const Entry& entry, const std::string& what, const std::function<void(Input&)>& change) {
  Input x;
  change(x);
  const Stopwatch watch(Stopwatch::Time::kWall);
  std::string wrong;
  try {
    if (!entry.call(x)) wrong = "a number that is none";
  } catch (const InputError& e) {
    if (std::string(e.what()).empty()) wrong = "no words";
  } catch (const std::exception& e) {
    wrong = std::string("another error: ") + e.what();
  }
  if (watch.seconds() > 10) wrong += " after " + std::to_string(watch.seconds()) + " s";
  INFO(entry.name << " with " << what);
  CHECK(wrong == "");
}

}  // namespace

TEST_CASE("face: no number of what is handed in makes a public entry hang, crash or answer with no number") {
  for (const Entry& entry : entries()) {
    ask(entry, "nothing wrong", [](Input&) {});
    for (const auto& [name, field] : numbers())
      for (const double wrong : kWrong)
        if (!entry.long_call || std::isnan(wrong))
          ask(entry, name + (" = " + std::to_string(wrong)), [&](Input& x) { field(x) = wrong; });
    for (const auto& [name, set] : counts())
      for (const long wrong : kWrongCounts)
        ask(entry, name + (" = " + std::to_string(wrong)), [&](Input& x) { set(x, wrong); });
  }
}

TEST_CASE("face: what is refused is named") {
  using Catch::Matchers::Contains;
  const auto of = [](const std::function<void(Input&)>& change, const Entry& entry) {
    Input x;
    change(x);
    return refusal([&] { (void)entry.call(x); });
  };
  const std::vector<Entry> all = entries();
  for (const std::size_t e : {0u, 1u, 3u}) {  // the scalar path, with its report, and lanes
    CHECK_THAT(of([](Input& x) { x.actuator.sea.tau_max = -1; }, all[e]), Contains("tau_max: -1: must be at least 0"));
    CHECK_THAT(of([](Input& x) { x.motion.reposition->to = 0.01; }, all[e]), Contains("reposition.to: 0.01 s: later"));
    CHECK_THAT(of([](Input& x) { x.simulate.accuracy = x.batch.accuracy = 1e3; }, all[e]), Contains("accuracy: 1000"));
  }
  CHECK_THAT(of([](Input& x) { x.simulate.max_step = kNaN; }, all[0]), Contains("max_step: nan"));
  CHECK_THAT(refusal([] {
               Input x;
               (void)in_lanes(x, 0);
             }),
             Contains("0 peaks: 1 are needed"));
  // Names that are unknown, and a covariance that is none.
  const auto uncertain = [&](const std::string& name, std::array<double, 4> c) {
    return of(
        [&](Input& x) {
          x.scene.uncertainty = Uncertainty{{"stiffness", name}, Eigen::Matrix2d{{c[0], c[1]}, {c[2], c[3]}}};
          x.actuator.uncertain = {"k_p", "k_d"}, x.actuator.covariance = x.scene.uncertainty->covariance;
        },
        all[6]);
  };
  CHECK(uncertain("pitch", {1, 0, 0, 1e-4}) == "");
  CHECK_THAT(uncertain("stifness", {1, 0, 0, 1}), Contains("'stifness': not a constant of the scene"));
  CHECK_THAT(uncertain("pitch", {1, 0.5, 0.1, 1}), Contains("a symmetric matrix is needed"));
  CHECK_THAT(uncertain("pitch", {1, kNaN, kNaN, 1}), Contains("finite"));
  std::vector<double> one{1, 2}, two{1, 2, 3};
  CHECK_THAT(refusal([&] { (void)sobol_indices(one, two, {}, 1); }), Contains("all must be as many"));
  const DropModel model(Input().scene, Scatter::assumed());
  CHECK_THAT(refusal([&] { (void)model.drop(one); }), Contains("2 coordinates: 3 are needed"));
  CHECK_THAT(refusal([&] { (void)model.even(-1, 1); }), Contains("drops: -1"));
  std::vector<AtlasCell> cells(3);
  AtlasOptions atlas;
  atlas.grid.axes = {{{0.3, 0.5, 2}, {0.4, 0.8, 2}, {0.1, 0.2, 2}}};
  CHECK_THAT(refusal([&] { plan_atlas(TwoLinkAtlas(Input().scene, Input().actuator), atlas, cells); }),
             Contains("3 cells: 8"));
}
