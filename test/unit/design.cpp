// Which hit to try next: information, criteria, safety, the search.
#include "identify/design/design.hpp"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/error.hpp"
#include "test/impact.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;

namespace {

const std::vector<int> kAll = {0, 1, 2, 3, 4};

std::vector<Trial> trials(std::initializer_list<int> which) {
  std::vector<Trial> out;
  for (const int i : which) out.push_back(shipped(i));
  return out;
}
Knowledge weak() { return knowledge_of(rig(), table2_sea(), kAll, trials({1, 2}), kNoise); }
/// The same estimate, its error bars `times` as wide.
Knowledge wider(Knowledge k, double times) {
  k.information /= times * times;
  return k;
}
DesignOptions quick() {
  DesignOptions o;
  o.log.noise = kNoise;
  o.peaks = 8, o.widths = 3;
  return o;
}
/// Largest |phi_1| of a hit; none where the link escapes.
std::optional<double> reach(const SeaParameters<double>& sea, const Hit& hit) {
  const Fit f = predict(rig(), {blank_log(hit, {.rate = 4000, .noise = kNoise})}, sea);
  if (f.trials[0].status != RolloutStatus::kDone) return std::nullopt;
  double largest = 0;
  for (const double phi : f.trials[0].phi) largest = std::max(largest, std::abs(phi));
  return largest;
}

/// The strongest hit of 20 ms that stays within an angle at the estimate [N].
double strongest(const SeaParameters<double>& sea, double angle) {
  double stays = 100, goes = 400;
  while (goes - stays > 0.05) {
    const double peak = 0.5 * (stays + goes);
    (reach(sea, {peak, 0.020}).value_or(kEscape) < angle ? stays : goes) = peak;
  }
  return stays;
}

void check_refused(const DesignOptions& o, const std::string& text) {
  CHECK_THROWS_WITH(o.validate(), Catch::Matchers::Contains(text));
}

}  // namespace

TEST_CASE("the information of the trials in hand is the inverse of the fit's covariance") {
  const auto logs = trials({1, 2, 3, 4});
  const Fit f = fit(rig(), logs, table2_sea(), limited());
  REQUIRE(f.converged);
  long n = 0;
  for (const Trial& t : logs) n += long(t.measurements());
  const double sigma = std::sqrt(f.cost / double(n - kConstants));
  const Knowledge k = knowledge_of(rig(), f.sea, kAll, logs, sigma);
  const Eigen::VectorXd half = half_widths(k.information, k.measurements);
  const auto covariance = covariance_of(k.information);
  REQUIRE(covariance);
  const auto u = constants(f.sea);
  for (std::size_t i = 0; i < kConstants; ++i) {
    INFO(f.parameters[i].name);
    CHECK(half[long(i)] == Approx(f.half_width * *f.parameters[i].std / u[i]).epsilon(1e-6));
    for (std::size_t j = 0; j < kConstants; ++j)
      CHECK((*covariance)(long(i), long(j)) * u[i] * u[j] ==
            Approx(f.covariance(long(i), long(j))).epsilon(1e-5).margin(1e-16));
  }

  // The same from the actuator file that the fit would write; a part of it where a part was fitted.
  Actuator file;
  file.sea = f.sea;
  file.uncertain = f.fitted;
  file.covariance = f.covariance;
  const auto read = knowledge_of(file);
  REQUIRE(read);
  CHECK(read->constants == kAll);
  CHECK(read->information.isApprox(k.information, 1e-5));
  file.uncertain = {"i_motor", "k_d"};
  file.covariance = Eigen::Matrix2d{{1e-8, 0}, {0, 1e-6}};
  const auto part = knowledge_of(file);
  REQUIRE(part);
  CHECK(part->constants == std::vector<int>{1, 4});
  CHECK(part->information(0, 0) == Approx(u[1] * u[1] / 1e-6));
  CHECK(part->information(1, 1) == Approx(u[4] * u[4] / 1e-8));
  file.uncertain.clear();
  CHECK_FALSE(knowledge_of(file));
}

TEST_CASE("a hit and its mirror tell the same, half the noise tells four times as much") {
  const HitLog log{.noise = kNoise};
  const Trial there = blank_log({200, 0.015}, log), back = blank_log({-200, 0.015}, log);
  const auto a = information_of(rig(), table2_sea(), kAll, there, kNoise),
             b = information_of(rig(), table2_sea(), kAll, back, kNoise),
             c = information_of(rig(), table2_sea(), kAll, there, kNoise / 2);
  REQUIRE((a && b && c));
  CHECK(a->isApprox(*b, 1e-9));
  CHECK(c->isApprox(4 * *a, 1e-12));
  double impulse = 0;
  for (const double f : there.force) impulse += f / log.rate;
  CHECK(impulse == Approx(200 * 0.015 * 2 / M_PI).epsilon(0.01));
  CHECK(there.samples() == 1001);
}

TEST_CASE("the criteria in closed form: the worst constant, the mean axis, the longest axis") {
  Eigen::MatrixXd information = Eigen::Vector2d(4, 25).asDiagonal();
  CHECK(criterion_value(Criterion::kWorst, information) == Approx(0.5));
  CHECK(criterion_value(Criterion::kD, information) == Approx(std::sqrt(0.5 * 0.2)));
  CHECK(criterion_value(Criterion::kE, information) == Approx(0.5));
  information = Eigen::Matrix2d{{2, 1}, {1, 2}};  // eigenvalues 1 and 3, variances 2/3
  CHECK(criterion_value(Criterion::kWorst, information) == Approx(std::sqrt(2.0 / 3)));
  CHECK(criterion_value(Criterion::kD, information) == Approx(std::pow(3, -0.25)));
  CHECK(criterion_value(Criterion::kE, information) == Approx(1));
  information = Eigen::Matrix2d{{1, 1}, {1, 1}};
  for (const auto c : {Criterion::kWorst, Criterion::kD, Criterion::kE})
    CHECK(criterion_value(c, information) == std::numeric_limits<double>::infinity());
  CHECK(half_widths(Eigen::Vector2d(4, 25).asDiagonal(), 0)[0] == Approx(1.96 * 0.5).epsilon(1e-4));
}

TEST_CASE("a hit that the estimate alone admits but that may go too far, or escape, is never proposed") {
  const Knowledge k = wider(weak(), 10);  // 2 to 7 % either way
  DesignOptions o = quick();
  SECTION("too far") {
    const Hit hit{strongest(k.sea, 0.995 * o.budget.angle), 0.020};
    const double angle = reach(k.sea, hit).value();
    CHECK(angle < o.budget.angle);
    const HitSafety s = safety_of(rig(), k, hit, o);
    CHECK(s.outcome == HitSafety::Outcome::kTooFar);
    CHECK(s.angle == Approx(angle).epsilon(1e-3));
    CHECK(s.worst_angle > o.budget.angle);
    CHECK(safety_of(rig(), weak(), hit, o).safe());  // where more is known
  }
  SECTION("escapes") {
    o.budget.angle = 3;
    o.budget.peak = 400;
    const Hit hit{strongest(k.sea, o.budget.angle), 0.020};
    CHECK(reach(k.sea, hit).value() < o.budget.angle);
    CHECK(safety_of(rig(), k, hit, o).outcome == HitSafety::Outcome::kEscapes);
  }
  // Whatever is proposed, fresh draws of the ellipsoid's surface keep the rule.
  const Design d = design(rig(), k, o);
  REQUIRE(d.status == Design::Status::kDone);
  CHECK(d.too_far + d.escaping > 0);
  const Eigen::MatrixXd root = covariance_of(k.information)->llt().matrixL();
  for (const ProposedHit& h : d.hits) {
    CHECK(h.safety.safe());
    CHECK(h.safety.worst_angle <= o.budget.angle);
    for (std::uint64_t draw = 0; draw < 200; ++draw) {
      Random random(4711, draw);
      Eigen::VectorXd z(kConstants);
      for (double& x : z) x = random.normal();
      const Eigen::VectorXd relative = std::sqrt(11.07) * (root * z.normalized());
      auto u = constants(k.sea);
      for (std::size_t i = 0; i < kConstants; ++i) u[i] *= 1 + relative[long(i)];
      SeaParameters<double> sea = k.sea;
      set_constants(sea, u);
      const auto angle = reach(sea, h.hit);
      INFO("draw " << draw << ", hit of " << h.hit.peak << " N, " << h.hit.width << " s");
      REQUIRE(angle);
      CHECK(*angle <= o.budget.angle);
    }
  }
}

TEST_CASE("every criterion finds the set that is best by its own measure, within the budget") {
  const Knowledge k = weak();
  std::vector<Design> found;
  const std::vector<Criterion> criteria = {Criterion::kWorst, Criterion::kD, Criterion::kE};
  for (const Criterion c : criteria) {
    DesignOptions o = quick();
    o.criterion = c;
    o.hits = 3;
    found.push_back(design(rig(), k, o));
    const Design& d = found.back();
    REQUIRE(d.status == Design::Status::kDone);
    REQUIRE(d.hits.size() == 3);
    CHECK((d.after.array() < d.before.array()).all());
    CHECK(d.size_after < d.size_before);
    CHECK(d.hits[0].hit.peak > 0);
    CHECK(d.hits[1].hit.peak < 0);
    Eigen::MatrixXd sum = k.information;
    for (const ProposedHit& h : d.hits) {
      CHECK(std::abs(h.hit.peak) <= o.budget.peak);
      CHECK(h.hit.width >= o.budget.min_width);
      CHECK(h.hit.width <= o.budget.max_width);
      sum += h.information;
    }
    CHECK(sum.isApprox(d.information, 1e-12));
    REQUIRE_FALSE(d.runners_up.empty());
    double before = d.size_after;
    for (const RunnerUp& r : d.runners_up) {
      CHECK(r.size >= before * (1 - 1e-9));
      CHECK(r.hits.size() == 3);
      before = r.size;
    }
  }
  for (std::size_t i = 0; i < criteria.size(); ++i)
    for (const Design& other : found)
      CHECK(found[i].size_after <= 1.005 * criterion_value(criteria[i], other.information));
}

TEST_CASE("the proposal does not depend on the number of threads") {
  DesignOptions o = quick();
  const Design one = design(rig(), weak(), o);
  o.threads = 3;
  const Design three = design(rig(), weak(), o);
  REQUIRE(one.hits.size() == three.hits.size());
  for (std::size_t i = 0; i < one.hits.size(); ++i) {
    CHECK(one.hits[i].hit.peak == three.hits[i].hit.peak);
    CHECK(one.hits[i].hit.width == three.hits[i].hit.width);
  }
  CHECK(one.size_after == three.size_after);
}

TEST_CASE("where nothing can be proposed the design says why") {
  DesignOptions o = quick();
  o.budget.angle = 1e-3;
  const Design none = design(rig(), weak(), o);
  CHECK(none.status == Design::Status::kNoSafeHit);
  CHECK(none.hits.empty());
  CHECK_THAT(none.message, Catch::Matchers::Contains("no hit of this budget is safe"));
  CHECK(none.too_far + none.escaping == none.candidates);
  CHECK(none.after == none.before);

  Trial still = blank_log({100, 0.02}, {.noise = kNoise});
  std::fill(still.force.begin(), still.force.end(), 0);
  const Design unknown = design(rig(), knowledge_of(rig(), table2_sea(), kAll, {still}, kNoise), quick());
  CHECK(unknown.status == Design::Status::kNotDetermined);
  CHECK_THAT(unknown.message, Catch::Matchers::Contains("not determined"));
}

TEST_CASE("bad budgets are refused") {
  const auto with = [](auto&& change) {
    DesignOptions o = quick();
    change(o);
    return o;
  };
  check_refused(with([](auto& o) { o.budget.peak = -1; }), "peak: -1: must be above 0 N");
  check_refused(with([](auto& o) { o.budget.min_width = 0; }), "width: 0: must be above 0 s");
  check_refused(with([](auto& o) { o.budget.max_width = 0.005; }), "width: 0.005: the longest pulse");
  check_refused(with([](auto& o) { o.budget.angle = 4; }), "angle: 4: must lie between 0 and pi rad");
  check_refused(with([](auto& o) { o.log.rate = 500; }), "rate: 500: a pulse of 0.01 s needs at least 8 samples");
  check_refused(with([](auto& o) { o.log.duration = 0.06; }), "duration: 0.06: the log must go on");
  check_refused(with([](auto& o) { o.log.noise = 0; }), "noise: 0: must be above 0 rad");
  check_refused(with([](auto& o) { o.hits = 0; }), "hits: 0: must lie between 1 and 20");
}
