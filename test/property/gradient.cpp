// The gradients of landing/derivatives/gradient.hpp against difference quotients of `peak_acceleration`, which knows
// nothing of them.
#include "landing/derivatives/gradient.hpp"

#include <catch2/catch.hpp>

#include "common/actuator.hpp"
#include "common/random.hpp"
#include "landing/model/release.hpp"
#include "landing/model/scene_file.hpp"
#include "test/quotient.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

constexpr std::uint64_t kSeed = 20250711;
constexpr SimulateOptions kTight{.accuracy = 1e-13};
constexpr double kExact = 1e-7;   // what the gradients are held to
constexpr double kSure = 1e-7;    // quotients that are not known to this say nothing: too near a kink
constexpr double kSmooth = 1e-2;  // left and right quotients over 1e-6 differ by less unless there is a kink
constexpr const char* kFloors[] = {"paper", "paper_rough_a", "paper_rough_b", "paper_soft"};

/// A landing whose numbers can be moved.
struct Case {
  Scene scene;
  SeaParameters<double> sea;
  Motion motion{};
  double absent = 0;  ///< what the motion does not have

  double& at(int parameter) {
    const std::array<double*, kParameters> all = {&motion.phi_i,
                                                  &motion.phi_f,
                                                  &motion.duration,
                                                  &motion.bumps[0],
                                                  &motion.bumps[1],
                                                  &motion.bumps[2],
                                                  &motion.bumps[3],
                                                  &motion.gain_p,
                                                  &motion.gain_d,
                                                  motion.reposition ? &motion.reposition->to : &absent,
                                                  &scene.drop.height,
                                                  &scene.drop.forward_speed,
                                                  &scene.drop.pitch,
                                                  &scene.floor->stiffness,
                                                  &scene.floor->damping_normal,
                                                  &scene.floor->damping_tangential,
                                                  &sea.k_p,
                                                  &sea.k_d,
                                                  &sea.k_sea,
                                                  &sea.c_sea,
                                                  &sea.i_motor};
    return *all[std::size_t(parameter)];
  }
  /// Size of a parameter: 1 for lengths, angles and times, else its own.
  double unit(int parameter) {
    const double x = std::abs(at(parameter));
    return parameter < int(Parameter::kStiffness) || x == 0 ? 1 : x;
  }
  Case moved(int parameter, double by) const {
    Case c = *this;
    c.at(parameter) += by;
    return c;
  }
  double peak(const SimulateOptions& options = kTight) const {
    return peak_acceleration(scene, sea, motion, options).peak;
  }
  PeakGradients<kQuinticParameters> quintic_gradient(int most = 4) const {
    return quintic_peaks(scene, sea, motion, kTight, most);
  }
  PeakGradients<kParameters> gradient(int most = 4) const { return all_gradients(scene, sea, motion, kTight, most); }
};

Case on_floor(const std::string& floor) {
  return {read_scene(UKEMI_DATASETS "/scenes/" + floor + ".toml"),
          read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea};
}
Motion draw(const Scene& scene, std::uint64_t i) {
  Random r(kSeed, i);
  const auto [phi, duration] = scene.search;
  return {r.uniform(phi[0], phi[1]), r.uniform(phi[0], phi[1]), r.uniform(duration[0], duration[1])};
}

/// A gradient against difference quotients, each times its parameter's unit, as parts of the gradient's size.
struct Comparison {
  double difference = 0;  ///< largest of |d - quotient|
  double doubt = 0;       ///< largest error of a quotient
  double kink = 0;        ///< largest difference of a quotient from the left and the right
};
template <int P, class F>
Comparison compare(Case c, const Eigen::Matrix<double, P, 1>& d, F&& value) {
  Comparison out;
  const double middle = value(c);
  double size = 0;
  for (int k = 0; k < P; ++k) size = std::max(size, std::abs(d[k]) * c.unit(k));
  for (int k = 0; k < P; ++k) {
    const double unit = c.unit(k);
    const auto f = [&](double x) { return value(c.moved(k, x)); };
    const Quotient q = central(unit, kSure, f);
    constexpr double kNear = 1e-6;
    const double kink = (f(kNear * unit) - 2 * middle + f(-kNear * unit)) / kNear;
    out.difference = std::max(out.difference, std::abs(d[k] - q.value) * unit / size);
    out.doubt = std::max(out.doubt, q.error * unit / size);
    out.kink = std::max(out.kink, std::abs(kink) / size);
  }
  return out;
}
const auto kPeak = [](const Case& c) { return c.peak(); };

}  // namespace

TEST_CASE("gradient: the largest peak is the landing's") {
  const auto floor = GENERATE(from_range(std::begin(kFloors), std::end(kFloors)));
  Case c = on_floor(floor);
  for (std::uint64_t i = 0; i < 20; ++i) {
    c.motion = draw(c.scene, 1000 + i);
    const LandingPeak p = peak_acceleration(c.scene, c.sea, c.motion, {.accuracy = 1e-12});
    const auto g = quintic_peaks(c.scene, c.sea, c.motion, {.accuracy = 1e-12}, 3);
    INFO(floor << ", seed " << kSeed << ", draw " << i);
    REQUIRE(g.end == p.end);
    REQUIRE(g.peaks.size() == 3);
    CHECK(g.peaks[0].value == Approx(p.peak).epsilon(1e-8));
    CHECK(g.peaks[0].t == Approx(p.t_peak).epsilon(1e-8));
    CHECK(g.peaks[0].contact == p.peak_contact);
    CHECK(g.peaks[0].value >= g.peaks[1].value);
    CHECK(g.peaks[1].value >= g.peaks[2].value);
  }
}

TEST_CASE("gradient: by the motion, against difference quotients") {
  constexpr int kDraws = 10;
  int compared = 0, skipped = 0;
  for (const char* floor : kFloors)
    for (std::uint64_t i = 0; i < kDraws; ++i) {
      Case c = on_floor(floor);
      c.motion = draw(c.scene, i);
      const auto g = c.quintic_gradient();
      INFO(floor << ", seed " << kSeed << ", draw " << i);
      REQUIRE(!g.peaks.empty());
      const Comparison by = compare(c, g.peaks[0].d, kPeak);
      if (by.doubt > kSure || by.kink > kSmooth) {
        ++skipped;
        continue;
      }
      ++compared;
      CHECK(by.difference < kExact);
    }
  CHECK(compared >= 38);
  CHECK(skipped <= 2);
}

TEST_CASE("gradient: by bumps, gains and the move in the air, through release, touchdowns and gains") {
  constexpr int kDraws = 12;
  int compared = 0, interrupted = 0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    Case c = on_floor(kFloors[i % 4]);
    c.motion = draw(c.scene, 300 + i);
    Random r(kSeed, 400 + i);
    for (double& b : c.motion.bumps) b = r.uniform(-0.6, 0.6);
    c.motion.gain_p = r.uniform(0.5, 2), c.motion.gain_d = r.uniform(0.5, 2);
    const double from = r.uniform(0.02, 0.1), fall = fall_time(c.scene);
    const bool cut_off = i % 3 == 0;  // the floor comes first
    c.motion.reposition = Reposition{r.uniform(-1.2, -0.4), i % 4 == 1 ? r.uniform(-1, 1) : 0, from,
                                     cut_off ? fall + r.uniform(0.02, 0.1) : from + r.uniform(0.08, 0.15)};
    if (i % 2) c.scene.detection_delay = 0.006;
    const auto g = motion_peaks(c.scene, c.sea, c.motion, kTight, 4);
    INFO("seed " << kSeed << ", draw " << i);
    REQUIRE(!g.peaks.empty());
    CHECK(g.peaks[0].value == Approx(c.peak()).epsilon(1e-8));
    const Comparison by = compare(c, g.peaks[0].d, kPeak);
    if (by.doubt > kSure || by.kink > kSmooth) continue;
    ++compared, interrupted += cut_off;
    CHECK(by.difference < kExact);
  }
  CHECK(compared >= 9);
  CHECK(interrupted >= 2);
}

TEST_CASE("gradient: by all parameters, against difference quotients") {
  const auto floor = GENERATE(from_range(std::begin(kFloors), std::end(kFloors)));
  Case c = on_floor(floor);
  for (std::uint64_t i = 0; i < 2; ++i) {
    c.motion = draw(c.scene, 100 + i);
    const auto g = c.gradient();
    const auto m = c.quintic_gradient();
    INFO(floor << ", seed " << kSeed << ", draw " << i);
    REQUIRE(!g.peaks.empty());
    const Comparison by = compare(c, g.peaks[0].d, kPeak);
    CAPTURE(by.kink);
    CHECK(by.doubt < kSure);
    CHECK(by.difference < kExact);
    CHECK((g.peaks[0].d.head<3>() - m.peaks[0].d).norm() < 1e-7 * m.peaks[0].d.norm());
  }
}

TEST_CASE("gradient: every kind of peak and every term") {
  Case c = on_floor("paper");
  c.motion = {-0.9, -0.4, 0.25};
  PeakKind kind = PeakKind::kRightLimit;
  SECTION("hardly any damper: the peak lies inside a contact") {
    c.scene.floor->damping_normal = 1, kind = PeakKind::kInside;
  }
  SECTION("a run cut off while the force rises: the peak is a left limit") {
    c.scene.floor->damping_normal = 1, c.scene.t_end = 0.291, kind = PeakKind::kLeftLimit;
  }
  SECTION("thrown with a pitch rate: the flight is integrated") { c.scene.drop.pitch_rate = -2; }
  SECTION("a constant motion, which a change makes move") { c.motion = {-0.9, -0.9, 0.25}; }
  SECTION("a torque limit that acts") { c.sea.tau_max = 6; }
  SECTION("no torque at all") { c.sea.tau_max = 0; }
  SECTION("friction and a stiffening spring") {
    c.sea.friction = 0.3, c.sea.k_sea_cubic = 50;
    c.sea.output_friction = 0.2, c.sea.friction_asymmetry = 0.3, c.sea.breakaway = 0.5;
  }
  SECTION("motor-side feedback") { c.sea.feedback = Feedback::kMotor; }
  const auto g = c.gradient();
  REQUIRE(!g.peaks.empty());
  CHECK(g.peaks[0].kind == kind);
  CHECK(g.peaks[0].value == Approx(c.peak()).epsilon(1e-8));
  const Comparison by = compare(c, g.peaks[0].d, kPeak);
  CHECK(by.doubt < kSure);
  CHECK(by.difference < kExact);
}

TEST_CASE("gradient: at a kink of f each of the two peaks has the slope of its side") {
  const auto same = [](const auto& a, const auto& b) { return a.contact == b.contact && a.kind == b.kind; };
  int kinks = 0;
  for (std::uint64_t line = 0; line < 20 && kinks < 2; ++line) {
    Case c = on_floor(kFloors[line % 4]);
    c.motion = draw(c.scene, 200 + line);
    const auto at = [&](double phi_f, double accuracy) {
      c.motion.phi_f = phi_f;
      return quintic_peaks(c.scene, c.sea, c.motion, {.accuracy = accuracy}, 2).peaks;
    };
    // Along phi_F: where do the two largest peaks change places?
    constexpr int kGrid = 40;
    double low = 0, high = 0;
    auto left = at(c.scene.search.phi[0], 1e-9);
    for (int i = 1; i <= kGrid && high == low; ++i) {
      const double a = c.motion.phi_f,
                   b = c.scene.search.phi[0] + (c.scene.search.phi[1] - c.scene.search.phi[0]) * i / kGrid;
      const auto right = at(b, 1e-9);
      if (same(left[0], right[1]) && same(left[1], right[0]))
        low = a, high = b;
      else
        left = right;
    }
    if (high == low) continue;
    while (high - low > 1e-15) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      (same(at(middle, kTight.accuracy)[0], left[0]) ? low : high) = middle;
    }
    const auto peaks = at(low, kTight.accuracy);
    INFO("seed " << kSeed << ", line " << line << ", phi_F " << low);
    REQUIRE(same(peaks[0], left[0]));
    REQUIRE(same(peaks[1], left[1]));
    if (peaks[0].value - peaks[1].value > 1e-10 * peaks[0].value) continue;  // a jump, not a kink
    ++kinks;
    const double size = peaks[0].d.cwiseAbs().maxCoeff();
    for (int k = 0; k < kQuinticParameters; ++k) {
      const auto f = [&](double x) { return c.moved(k, x).peak(); };
      const Quotient before = one_sided(-1, 1, f), behind = one_sided(1, 1, f);
      const double slope[] = {peaks[0].d[k], peaks[1].d[k]};
      CAPTURE(k, before.error, behind.error);
      CHECK(std::max(before.error, behind.error) < kSure * size);
      CHECK(std::abs(before.value - std::min(slope[0], slope[1])) < kExact * size);
      CHECK(std::abs(behind.value - std::max(slope[0], slope[1])) < kExact * size);
      if (k == int(Parameter::kPhiF)) CHECK(slope[0] < slope[1]);
    }
  }
  CHECK(kinks == 2);
}
