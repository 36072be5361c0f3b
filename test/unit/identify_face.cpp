// Whatever the public functions of identify are given, they answer or throw InputError, soon: each number of each
// struct in turn is NaN, infinite, negative and far out of range, each column too short and too long.
#include <chrono>
#include <functional>
#include <limits>

#include "identify/design/design.hpp"
#include "identify/logs/force_log.hpp"
#include "identify/trust/identification.hpp"
#include "identify/trust/prediction.hpp"
#include "test/impact.hpp"

using namespace test;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
constexpr double kBad[] = {kNan, kInf, -kInf, -1, 0, 1e300, -1e300};

/// Calls; true where it threw InputError. Anything else that it throws fails the test, and so does a wait.
bool refused(const std::function<void()>& call) {
  const auto start = std::chrono::steady_clock::now();
  const std::string said = refusal(call);
  CHECK((said.empty() || said.size() > 8));
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
  return !said.empty();
}

/// What an answer says: numbers, or why there are none.
void check_honest(const Fit& f) {
  if (!f.converged) {
    CHECK(!f.message.empty());
    return;
  }
  CHECK(std::isfinite(f.rms));
  CHECK(std::isfinite(f.cost));
  for (const Estimate& e : f.parameters) CHECK(std::isfinite(e.value));
}

/// Everything that the functions take, sound.
struct Inputs {
  Rig rig = test::rig();
  Trial trial;
  SeaParameters<double> sea = test::truth();
  FitOptions options{.restarts = 0, .max_iterations = 4};
  ForceLog force{"force.csv", {}, {}};

  Inputs() {
    trial.file = "hit.csv";
    for (int i = 0; i < 80; ++i) {
      const double t = 0.002 * i, s = (t - 0.01) / 0.016;
      trial.t.push_back(t), trial.force.push_back(s > 0 && s < 1 ? 60 * std::sin(3.14159265 * s) : 0);
    }
    std::vector<double> none;
    REQUIRE(rollout<double>(rig, sea, {}, PreparedTrial(trial), {}, trial.phi, none) == RolloutStatus::kDone);
    force.t = trial.t, force.force = trial.force;
  }

  void run() const {
    check_honest(predict(rig, {trial}, sea, options));
    const Fit f = fit(rig, {trial}, sea, sea, options);
    check_honest(f);
    if (f.converged) (void)test_residuals({rig, {trial}, options}, f);
    (void)with_nearer_force(rig, {trial}, sea, options);
  }
};

using Place = std::function<void(Inputs&, double)>;

/// Every number that a caller may set.
std::vector<std::pair<std::string, Place>> places() {
  std::vector<std::pair<std::string, Place>> out = {
      {"rig.length", [](auto& in, double x) { in.rig.length = x; }},
      {"rig.inertia", [](auto& in, double x) { in.rig.inertia = x; }},
      {"rig.tau_max", [](auto& in, double x) { in.rig.tau_max = x; }},
      {"rig.gear_ratio", [](auto& in, double x) { in.rig.gear_ratio = x; }},
      {"rig.speed_max", [](auto& in, double x) { in.rig.speed_max = x; }},
      {"rig.motor_torque_max", [](auto& in, double x) { in.rig.motor_torque_max = x; }},
      {"rig.gravity.moment", [](auto& in, double x) { in.rig.gravity.moment = x; }},
      {"rig.gravity.hanging", [](auto& in, double x) { in.rig.gravity.hanging = x; }},
      {"rig.drive.limit", [](auto& in, double x) { in.rig.drive.limit = x; }},
      {"rig.drive.rate", [](auto& in, double x) { in.rig.drive.rate = x; }},
      {"rig.drive.control_delay", [](auto& in, double x) { in.rig.drive.control_delay = x; }},
      {"rig.drive.velocity_filter", [](auto& in, double x) { in.rig.drive.velocity_filter = x; }},
      {"sea.k_p", [](auto& in, double x) { in.sea.k_p = x; }},
      {"sea.k_d", [](auto& in, double x) { in.sea.k_d = x; }},
      {"sea.k_sea", [](auto& in, double x) { in.sea.k_sea = x; }},
      {"sea.c_sea", [](auto& in, double x) { in.sea.c_sea = x; }},
      {"sea.i_motor", [](auto& in, double x) { in.sea.i_motor = x; }},
      {"sea.tau_max", [](auto& in, double x) { in.sea.tau_max = x; }},
      {"trial.t[0]", [](auto& in, double x) { in.trial.t[0] = x; }},
      {"trial.t[9]", [](auto& in, double x) { in.trial.t[9] = x; }},
      {"trial.phi", [](auto& in, double x) { in.trial.phi[9] = x; }},
      {"trial.force", [](auto& in, double x) { in.trial.force[9] = x; }},
      {"trial.phi_ref", [](auto& in, double x) { in.trial.phi_ref.assign(in.trial.t.size(), x); }},
      {"trial.phi_motor", [](auto& in, double x) { in.trial.phi_motor = in.trial.phi, in.trial.phi_motor[9] = x; }},
      {"trial.torque", [](auto& in, double x) { in.trial.torque = in.trial.phi, in.trial.torque[9] = x; }},
      {"trial.force_smooth", [](auto& in, double x) { in.trial.force_smooth = x; }},
      {"trial.force_noise", [](auto& in, double x) { in.trial.force_noise = x; }},
      {"trial.force_rest", [](auto& in, double x) { in.trial.force_rest = x; }},
      {"options.huber", [](auto& in, double x) { in.options.huber = x; }},
      {"options.accuracy", [](auto& in, double x) { in.options.accuracy = x; }},
      {"options.max_step", [](auto& in, double x) { in.options.max_step = x; }},
      {"options.escape", [](auto& in, double x) { in.options.escape = x; }},
      {"options.prior", [](auto& in, double x) { in.options.terms.priors = {{"k_sea", x, 1}}; }},
      {"options.prior.std", [](auto& in, double x) { in.options.terms.priors = {{"k_sea", 65, x}}; }},
      {"options.lower", [](auto& in, double x) { in.options.terms.lower["k_p"] = x; }},
      {"options.upper", [](auto& in, double x) { in.options.terms.upper["k_p"] = x; }},
      {"options.starts.apart", [](auto& in, double x) { in.options.starts.apart = x; }},
      {"options.starts.spread", [](auto& in, double x) { in.options.starts.spread = x; }},
      {"options.starts.accuracy", [](auto& in, double x) { in.options.starts.accuracy = x; }},
      {"options.starts.fit_steps", [](auto& in, double x) { in.options.starts.fit_steps = x; }}};
  for (const RigErrorKey& k : rig_error_keys())
    out.emplace_back(std::string("rig.errors.") + k.key, [at = k.at](auto& in, double x) { in.rig.errors.*at = x; });
  for (const ActuatorConstant& c : optional_constants())
    out.emplace_back(std::string("sea.") + c.key, [at = c.at](auto& in, double x) { in.sea.*at = x; });
  return out;
}

}  // namespace

TEST_CASE("face: a number that cannot be is refused, any other is answered soon") {
  const Inputs sound;
  sound.run();
  for (const auto& [name, set] : places())
    for (const double bad : kBad) {
      INFO(name << " = " << bad);
      Inputs in = sound;
      set(in, bad);
      const bool thrown = refused([&] { in.run(); });
      const bool no_limit =
          bad == kInf && (name == "sea.tau_max" || name == "options.escape" || name == "options.upper" ||
                          name == "rig.drive.limit" || name == "rig.drive.rate");
      if (!no_limit && !std::isfinite(bad) && !(name == "options.lower" && bad == -kInf)) CHECK(thrown);
    }
}

TEST_CASE("face: columns of unequal length, too few samples and no trial are refused") {
  const Inputs sound;
  const std::pair<const char*, std::vector<double> Trial::*> columns[] = {{"t", &Trial::t},
                                                                          {"phi", &Trial::phi},
                                                                          {"force", &Trial::force},
                                                                          {"force_t", &Trial::force_t},
                                                                          {"phi_ref", &Trial::phi_ref},
                                                                          {"phi_motor", &Trial::phi_motor},
                                                                          {"torque", &Trial::torque},
                                                                          {"command", &Trial::command}};
  for (const auto& [name, column] : columns)
    for (const std::size_t size : {std::size_t(1), sound.trial.t.size() - 1, sound.trial.t.size() + 1}) {
      INFO(name << " of " << size);
      Inputs in = sound;
      (in.trial.*column).assign(size, 0.0);
      for (std::size_t i = 0; i < size; ++i) (in.trial.*column)[i] = 0.002 * double(i);
      CHECK(refused([&] { in.run(); }));
      CHECK(refused([&] { (void)PreparedTrial(in.trial); }));
    }
  CHECK(refused([&] { (void)predict(sound.rig, {Trial{}}, sound.sea); }));
  CHECK(refused([&] { (void)fit(sound.rig, {Trial{}}, sound.sea, sound.sea); }));
  CHECK(refused([&] { (void)fit(sound.rig, {}, sound.sea, sound.sea); }));
  CHECK(refused([&] { (void)identify::identify({sound.rig, {}, sound.options}, sound.sea, sound.sea); }));
  const Fit f = fit(sound.rig, {sound.trial}, sound.sea, sound.sea, sound.options);
  CHECK(refused([&] { (void)test_residuals({sound.rig, {sound.trial, sound.trial}, sound.options}, f); }));
  CHECK(refused([&] { (void)score_of({sound.rig, {}, sound.options}, f); }));
  CHECK(refused([&] { (void)profile({sound.rig, {sound.trial}, sound.options}, f, "k_sea", {.points = 4}); }));
  const std::vector<Nuisance<double>> two(2);
  CHECK(refused([&] { (void)predict(sound.rig, {sound.trial}, sound.sea, sound.options, two); }));
  for (const int bad : {-1, -1000}) {
    FitOptions o = sound.options;
    o.restarts = bad;
    CHECK(refused([&] { o.validate(); }));
    o = sound.options, o.explore = bad;
    CHECK(refused([&] { o.validate(); }));
    o = sound.options, o.threads = bad;
    CHECK(refused([&] { o.validate(); }));
    o = sound.options, o.max_iterations = bad;
    CHECK(refused([&] { o.validate(); }));
    o = sound.options, o.starts.draws = bad;
    CHECK(refused([&] { o.validate(); }));
  }
}

TEST_CASE("face: a prediction by an actuator, or from a state, that cannot be is refused") {
  const Inputs sound;
  const auto predicted = [&](const std::function<void(Actuator&, InitialState&)>& spoil) {
    Actuator actuator;
    actuator.sea = sound.sea, actuator.uncertain = {"k_p", "tau_max"};
    actuator.covariance = 0.01 * Eigen::Matrix2d::Identity();
    InitialState start{InitialState::Kind::kGiven, 0.1};
    spoil(actuator, start);
    return identify::predict({sound.rig, {sound.trial}, sound.options}, actuator, start);
  };
  CHECK(predicted([](auto&, auto&) {}).fit.converged);
  CHECK(refused([&] { (void)predicted([](Actuator& a, auto&) { a.uncertain = {"k_p"}; }); }));
  CHECK(refused([&] { (void)predicted([](Actuator& a, auto&) { a.uncertain[1] = "kp"; }); }));
  CHECK(refused([&] { (void)predicted([](Actuator& a, auto&) { a.covariance(0, 1) = kNan; }); }));
  CHECK(refused([&] { (void)predicted([](Actuator& a, auto&) { a.sea.i_motor = kNan; }); }));
  CHECK(refused([&] { (void)predicted([](auto&, InitialState& s) { s.angle = kNan; }); }));
}

TEST_CASE("face: a force log, a rollout, a least-squares problem and a design that cannot be are refused") {
  const Inputs sound;
  for (const double bad : {kNan, kInf, -kInf}) {
    INFO(bad);
    ForceLog log = sound.force;
    log.force[5] = bad;
    Trial bare = sound.trial;
    bare.force.clear();
    CHECK(refused([&] { (void)attach_force(bare, log, sound.rig, ForceClock::kShared); }));
    log = sound.force, log.t[5] = bad;
    CHECK(refused([&] { (void)attach_force(bare, log, sound.rig, ForceClock::kOwn); }));
    log = sound.force, log.t.pop_back();
    CHECK(refused([&] { (void)attach_force(bare, log, sound.rig, ForceClock::kOwn); }));
    std::vector<double> phi, phi_m;
    const PreparedTrial prepared(sound.trial);
    CHECK(refused([&] { (void)rollout<double>(sound.rig, sound.sea, {}, prepared, {.accuracy = bad}, phi, phi_m); }));
    CHECK(refused([&] { (void)rollout<double>(sound.rig, sound.sea, {}, prepared, {.max_step = bad}, phi, phi_m); }));
    CHECK(refused([&] { (void)solve({.globals = {{"x", "", bad, 0, 1, 1}}}, {}); }));
    CHECK(refused([&] { (void)solve({.globals = {{"x", "", 0, 0, 1, bad}}}, {}); }));
    CHECK(refused([&] { (void)solve({.globals = {{"x", "", 0, 0, 1, 1}}, .priors = {{1, bad, 1}}}, {}); }));
    const std::vector<int> all = {0, 1, 2, 3, 4};
    const Knowledge known = knowledge_of(sound.rig, sound.sea, all, {sound.trial}, 1e-4);
    CHECK(refused([&] { (void)knowledge_of(sound.rig, sound.sea, all, {sound.trial}, bad); }));
    const auto refuses = [&](const std::function<void(Rig&, Knowledge&, DesignOptions&)>& spoil) {
      Rig rig = sound.rig;
      Knowledge k = known;
      DesignOptions o{.log = {.noise = 1e-3}, .draws = 4};
      spoil(rig, k, o);
      CHECK(refused([&] { (void)design(rig, k, o); }));
      CHECK(refused([&] { (void)safety_of(rig, k, {20, 0.015}, o); }));
      CHECK(refused([&] { (void)check(rig, k, {}, {{20, 0.015}}, o, 1); }));
    };
    refuses([&](Rig& rig, auto&, auto&) { rig.inertia = bad; });
    refuses([&](auto&, Knowledge& k, auto&) { k.sea.k_p = bad; });
    refuses([&](auto&, Knowledge& k, auto&) { k.information(1, 1) = bad; });
    refuses([&](auto&, Knowledge& k, auto&) { k.constants = {0, 9}; });
    refuses([&](auto&, Knowledge& k, auto&) { k.constants.pop_back(); });
    refuses([&](auto&, auto&, DesignOptions& o) { o.log.rate = bad; });
    refuses([&](auto&, auto&, DesignOptions& o) { o.log.duration = bad; });
    refuses([&](auto&, auto&, DesignOptions& o) { o.budget.peak = bad; });
    refuses([&](auto&, auto&, DesignOptions& o) { o.budget.angle = bad; });
    CHECK(refused([&] { (void)blank_log({bad, 0.01}, {}); }));
    CHECK(refused([&] { (void)blank_log({10, bad}, {}); }));
    CHECK(refused([&] { (void)blank_log({10, 0.01}, {.rate = bad}); }));
  }
}
