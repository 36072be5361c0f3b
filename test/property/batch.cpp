// Landings in SIMD lanes: the same equations, the same landings, and lanes that know nothing of each other.
#include <catch2/catch.hpp>

#include "common/degrees.hpp"
#include "common/random.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/lanes/batch_source.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;

namespace {

Motion draw(const Scene& scene, std::uint64_t seed, int i) {
  Random r(seed, std::uint64_t(i));
  const auto [phi, duration] = scene.search;
  return {r.uniform(phi[0], phi[1]), r.uniform(phi[0], phi[1]), r.uniform(duration[0], duration[1])};
}

std::vector<InstructionSet> sets() {
  std::vector<InstructionSet> out;
  for (int s = 0; s <= int(widest_instruction_set()); ++s) out.push_back(InstructionSet(s));
  return out;
}

bool same(const LandingPeak& a, const LandingPeak& b) {
  bool contacts = a.contacts.size() == b.contacts.size();
  for (int i = 0; contacts && i < a.contacts.size(); ++i) contacts = a.contacts[i] == b.contacts[i];
  return contacts && a.peak == b.peak && a.t_peak == b.t_peak && a.t_end == b.t_end && a.end == b.end &&
         a.peak_contact == b.peak_contact;
}

/// The peaks of cases; checks that they do not depend on the order of the cases or on the threads.
std::vector<LandingPeak> checked_peaks(const std::vector<BatchCase>& cases, InstructionSet set) {
  const std::vector<BatchCase> turned(cases.rbegin(), cases.rend());
  std::vector<LandingPeak> forward(cases.size()), backward(cases.size()), threaded(cases.size());
  batch_peaks(cases, forward, {}, 1, set);
  batch_peaks(turned, backward, {}, 1, set);
  batch_peaks(cases, threaded, {}, 3, set);
  CHECK(std::equal(forward.begin(), forward.end(), backward.rbegin(), same));
  CHECK(std::equal(forward.begin(), forward.end(), threaded.begin(), same));
  return forward;
}

}  // namespace

TEST_CASE("batch: every instruction set gives the scalar path's peaks") {
  const auto floor = GENERATE("paper", "paper_rough_a", "paper_rough_b", "paper_soft");
  const Scene scene = scene_of(floor);
  const SeaParameters<double> sea = table2_sea();
  constexpr int kMotions = 300;
  std::vector<BatchCase> cases;
  for (int i = 0; i < kMotions; ++i) cases.push_back({&scene, &sea, draw(scene, 5, i)});
  std::vector<LandingPeak> peaks(kMotions), tight;
  for (const BatchCase& c : cases) tight.push_back(peak_acceleration(scene, sea, c.motion, {.accuracy = 1e-11}));
  for (const InstructionSet set : sets())
    for (const double accuracy : {1e-5, 1e-7}) {
      batch_peaks(cases, peaks, {.accuracy = accuracy}, 1, set);
      int off = 0, other = 0, other_end = 0;
      for (int i = 0; i < kMotions; ++i) {
        const auto& p = peaks[std::size_t(i)];
        const LandingPeak& exact = tight[std::size_t(i)];
        REQUIRE(!no_landing(p.end));
        other_end += p.end != exact.end;  // at rest, or by its time limit: one comes to rest after 9 of its 10 s
        off += std::abs(p.peak - exact.peak) > 10 * accuracy * exact.peak;
        other += p.peak_contact != exact.peak_contact;
      }
      INFO(floor << ", " << kInstructionSetNames[std::size_t(set)] << ", accuracy " << accuracy << ": " << off
                 << " off by more than 10 accuracies, " << other << " at another contact");
      CHECK(other_end <= 1);
      CHECK(off <= kMotions / 100);  // those whose peak stands on a cliff
      CHECK(other <= kMotions / 100);
    }
}

TEST_CASE("batch: neighbours, threads, mixed scenes and eight lanes for four change nothing") {
  const Scene paper = scene_of("paper"), hard = scene_of("hard");
  const SeaParameters<double> sea = table2_sea();
  SeaParameters<double> soft = sea;
  soft.k_sea = 30, soft.tau_max = 5;
  std::vector<BatchCase> cases;
  for (int i = 0; i < 600; ++i) cases.push_back({i % 3 ? &paper : &hard, i % 2 ? &sea : &soft, draw(paper, 3, i)});
  std::vector<LandingPeak> four;
  for (const InstructionSet set : sets()) {
    const std::vector<LandingPeak> forward = checked_peaks(cases, set);
    std::vector<LandingPeak> one(1);
    if (set == InstructionSet::kAvx2) four = forward;
    if (set > InstructionSet::kAvx2)  // they round alike
      CHECK(std::equal(forward.begin(), forward.end(), four.begin(), same));
    for (std::size_t i = 0; i < 20; ++i) {
      batch_peaks({&cases[i], 1}, one, {}, 1, set);
      CHECK(same(one[0], forward[i]));
    }
  }
}

TEST_CASE("batch: landings of robots with other contacts change nothing by their order or the threads") {
  const Scene paper = scene_of("paper");
  Scene foot = paper;
  foot.contacts = {false, true, true};
  const SeaParameters<double> sea = table2_sea();
  std::vector<BatchCase> cases;
  for (int i = 0; i < 300; ++i) cases.push_back({i % 4 ? &foot : &paper, &sea, draw(paper, 7, i)});
  for (const InstructionSet set : sets()) (void)checked_peaks(cases, set);
}

TEST_CASE("batch: landings that only some kernels hold change nothing by their order or the threads") {
  const Scene paper = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  SeaParameters<double> other = sea;
  other.feedback = Feedback::kMotor;
  std::vector<BatchCase> cases;
  for (int i = 0; i < 600; ++i) cases.push_back({&paper, i % 5 ? &sea : &other, draw(paper, 4, i)});
  const double scalar = peak_acceleration(paper, other, cases[0].motion).peak;
  for (const InstructionSet set : sets()) CHECK(checked_peaks(cases, set)[0].peak == Approx(scalar).epsilon(1e-3));
}

TEST_CASE("batch: friction on the output is followed as closely as risk promises") {
  // The case that was found: at 1e-5 the peak was one of the errors of the joint's rate, 35.4 for 31.8.
  Scene scene = scene_of("paper");
  scene.floor = Floor<double>{523.2, 16.25, 0.0151};
  scene.drop = {.height = 0.1562, .forward_speed = 1.654, .pitch = 26.04 * kDegree};
  scene.t_end = 2.14;
  SeaParameters<double> sea{50, 1, 40.2, 1.6, 0.01817};
  sea.output_friction = 1.56, sea.spring_loss = 0.302, sea.k_sea_cubic = 107.4, sea.feedback = Feedback::kMotor;
  Motion motion{-61.28 * kDegree, -71.95 * kDegree, 0.2844};
  motion.reposition = Reposition{-78.68 * kDegree, 0, 0.1139, 0.2332};
  std::vector<Scene> pitched(8, scene);
  std::vector<BatchCase> cases;
  for (std::size_t i = 0; i < pitched.size(); ++i) {
    pitched[i].drop.pitch += (double(i) - 3.5) * 0.1 * kDegree;
    cases.push_back({&pitched[i], &sea, motion});
  }
  std::vector<LandingPeak> peaks(cases.size());
  batch_peaks(cases, peaks, {.accuracy = 1e-5});
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const double exact = peak_acceleration(pitched[i], sea, motion, {.accuracy = 1e-11}).peak;
    CHECK(peaks[i].peak == Approx(exact).epsilon(1e-3));
    CHECK(peak_acceleration(pitched[i], sea, motion, {.accuracy = 1e-5}).peak == Approx(exact).epsilon(1e-3));
  }
}

// Such landings begin with chatter, which lanes hand over: on paper_soft most. Where it does not end they are refused.
// On `tilted` the foot leaves the floor as soon as it touches, without end.
TEST_CASE("batch: a robot that is released on the floor lands in lanes as in the scalar path") {
  const SeaParameters<double> sea = table2_sea();
  for (const char* name : {"paper", "paper_soft", "straight", "hard"}) {
    Scene scene = scene_of(name);
    scene.drop.height = 0, scene.drop.pitch_rate = 0;
    const bool chatters = name == std::string("paper_soft") || name == std::string("hard");
    std::vector<BatchCase> cases;
    for (int i = 0; i < (chatters ? 8 : 40); ++i) cases.push_back({&scene, &sea, draw(scene, 13, i)});
    std::vector<LandingPeak> peaks(cases.size()), exacts;
    for (const BatchCase& c : cases) exacts.push_back(peak_acceleration(scene, sea, c.motion, {.accuracy = 1e-11}));
    for (const InstructionSet set : sets()) {
      batch_peaks(cases, peaks, {.accuracy = 1e-6}, 1, set);
      int off = 0, refused = 0;
      for (std::size_t i = 0; i < cases.size(); ++i) {
        const LandingPeak& exact = exacts[i];
        INFO(name << ", motion " << i);
        if (peaks[i].end == End::kFailed || exact.end == End::kFailed) {
          ++refused;
          continue;
        }
        REQUIRE(peaks[i].end == exact.end);
        CHECK(peaks[i].contacts.first() == Approx(0).margin(1e-6));
        off += std::abs(peaks[i].peak / exact.peak - 1) > 1e-3;
      }
      CHECK(off <= 1);  // one may stand on a cliff
      INFO(name << ": " << refused << " refused");
      CHECK(refused <= (chatters ? 7 : 0));
    }
  }
}

TEST_CASE("batch: a drive that loses the joint says so, in lanes and in the scalar path") {
  const Scene scene = scene_of("paper");
  SeaParameters<double> weak = table2_sea();
  weak.tau_max = 3;
  const Motion held{-45 * kDegree, -45 * kDegree, 1};
  const SeaParameters<double> sea = table2_sea();
  const std::vector<BatchCase> cases{{&scene, &weak, held}, {&scene, &sea, held}};
  std::vector<LandingPeak> peaks(2);
  batch_peaks(cases, peaks, {});
  CHECK(peaks[0].joint_lost);
  CHECK(peak_acceleration(scene, weak, held).joint_lost);
  CHECK_FALSE(peaks[1].joint_lost);
  CHECK_FALSE(peak_acceleration(scene, sea, held).joint_lost);
}

TEST_CASE("batch: a landing is abandoned above its bound and only there") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  std::vector<BatchCase> cases;
  for (int i = 0; i < 400; ++i) cases.push_back({&scene, &sea, draw(scene, 9, i)});
  std::vector<LandingPeak> full(cases.size()), bounded(cases.size());
  batch_peaks(cases, full, {});
  for (BatchCase& c : cases) c.abandon_above = 450;
  batch_peaks(cases, bounded, {});
  int abandoned = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (full[i].peak > 450) {
      CHECK(bounded[i].end == End::kAbandoned);
      CHECK(bounded[i].peak > 450);
      CHECK(bounded[i].peak <= full[i].peak);
      CHECK(bounded[i].t_end <= full[i].t_end);
      ++abandoned;
    } else {
      CHECK(same(full[i], bounded[i]));
    }
  }
  CHECK(abandoned > 100);
}

TEST_CASE("batch: limits end a landing where they are first broken, as in the scalar path") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  std::vector<BatchCase> cases;
  for (int i = 0; i < 300; ++i) cases.push_back({&scene, &sea, draw(scene, 21, i)});
  Limits hip, rated;
  hip.forbidden[kHip] = true;
  rated.motor_speed = 6, rated.motor_torque = 30;
  for (const Limits& limits : {hip, rated}) {
    std::vector<LandingPeak> peaks(cases.size());
    batch_peaks(cases, peaks, {.accuracy = 1e-7, .limits = limits});
    int broken = 0, differ = 0;
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const LandingPeak p = peak_acceleration(scene, sea, cases[i].motion, {.accuracy = 1e-7, .limits = limits});
      broken += peaks[i].end == End::kBroken;
      differ += (peaks[i].end == End::kBroken) != (p.end == End::kBroken);
      if (peaks[i].end != End::kBroken)
        for (int k = 0; k < peaks[i].contacts.size(); ++k) CHECK_FALSE(limits.forbidden[peaks[i].contacts[k]]);
    }
    CHECK(broken > 30);
    CHECK(broken < 290);
    CHECK(differ <= 3);  // limits are looked at where steps end, and the paths' steps differ
  }
}

TEST_CASE("batch: what lanes cannot do goes to the scalar path") {
  Scene stiff = scene_of("paper"), empty = stiff, spinning = stiff;
  stiff.floor->stiffness = 1e9, stiff.floor->damping_normal = 1e5;
  empty.floor.reset();
  spinning.drop.pitch_rate = 2;
  const SeaParameters<double> sea = table2_sea();
  SeaParameters<double> rubbing = sea;
  rubbing.friction = 0.3, rubbing.feedback = Feedback::kMotor;
  const Motion m{-0.5, -1, 0.2};
  const std::vector<BatchCase> cases = {
      {&stiff, &sea, m}, {&empty, &sea, m}, {&spinning, &sea, m}, {&spinning, &rubbing, m}, {&empty, &rubbing, m}};
  std::vector<LandingPeak> peaks(cases.size());
  batch_peaks(cases, peaks, {.accuracy = 1e-7});
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const LandingPeak p = peak_acceleration(*cases[i].scene, *cases[i].sea, m, {.accuracy = 1e-9});
    INFO(i);
    CHECK(peaks[i].end == p.end);
    CHECK(peaks[i].peak == Approx(p.peak).epsilon(1e-5));
  }
}

TEST_CASE("batch: a source that is over ends the run, whatever is under way") {
  const Scene scene = scene_of("paper");
  const SeaParameters<double> sea = table2_sea();
  struct Endless : BatchSource {
    bool next(int lane, BatchCase& c) override {
      ++begun;
      c = {scene, sea, motion[lane] = draw(*scene, 31, begun)};
      return true;
    }
    void done(int lane, const LandingPeak& peak) override { ended.push_back({motion[lane], peak}); }
    bool over() override { return ++asked == 20; }
    const Scene* scene;
    const SeaParameters<double>* sea;
    int begun = 0, asked = 0;
    std::array<Motion, lanes(InstructionSet::kAvx512)> motion;
    std::vector<std::pair<Motion, LandingPeak>> ended;
  };
  for (const InstructionSet set : sets()) {
    Endless source;
    source.scene = &scene, source.sea = &sea;
    run_batch(source, scene, sea, {}, set);
    CHECK(source.asked == 20);
    CHECK(!source.ended.empty());
    CHECK(source.begun == int(source.ended.size()) + lanes(set));  // those under way are not reported
    for (const auto& [motion, peak] : source.ended) {
      const std::vector<BatchCase> one{{&scene, &sea, motion}};
      std::vector<LandingPeak> alone(1);
      batch_peaks(one, alone, {}, 1, set);
      CHECK(same(peak, alone[0]));
    }
  }
}
