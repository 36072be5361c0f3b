// How drops scatter: points, normal numbers, measures and their standard errors, files of drops; Sobol's indices.
#include <Eigen/Core>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "common/csv.hpp"
#include "common/random.hpp"
#include "landing/judge/sobol_indices.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/model/scatter_file.hpp"
#include "landing/scatter/drop_file.hpp"
#include "landing/scatter/measure.hpp"
#include "landing/scatter/sampler.hpp"
#include "landing/scatter/sobol.hpp"
#include "test/folder.hpp"
#include "test/paper.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;
using Catch::Matchers::Contains;

namespace {

/// Every number of [scatter], none of them round.
Scatter every_scatter() {
  Scatter out;
  double x = 0.0123;
  for (const ScatterTerm& t : kScatterTerms)
    if (!t.of_links) out.*t.deviation = x *= 1.1;
  return out;
}

Actuator correlated() {
  Actuator a = table2();
  a.uncertain = {"k_sea", "k_p", "i_motor"};
  a.covariance = Eigen::Matrix3d{{4, 1.5, 0}, {1.5, 1, 1e-4}, {0, 1e-4, 1e-6}};
  return a;
}

using Kind = Measure::Kind;

double deviation(const std::vector<double>& x) {
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / double(x.size());
  double sum = 0;
  for (const double v : x) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / double(x.size() - 1));
}

}  // namespace

TEST_CASE("Sobol points: every power of two of them has one in each slice of every coordinate, also scrambled") {
  constexpr int kDimension = 7;
  for (const std::uint64_t seed : {1u, 2u, 77u}) {
    const ScrambledSobol sobol(kDimension, seed);
    for (long count = 1; count <= 1024; count *= 2) {
      const std::vector<double> points = sobol.points(count);
      REQUIRE(points.size() == std::size_t(count * kDimension));
      for (std::size_t k = 0; k < kDimension; ++k) {
        std::set<long> slices;
        for (std::size_t i = k; i < points.size(); i += kDimension) {
          CHECK((points[i] > 0 && points[i] < 1));
          slices.insert(long(points[i] * double(count)));
        }
        CHECK(long(slices.size()) == count);  // so the origin, scrambled, is among them
      }
    }
  }
}

TEST_CASE("Sobol points: the same seed, the same points, from any of them on, and others from another seed") {
  const ScrambledSobol sobol(3, 5);
  const std::vector<double> all = sobol.points(100);
  CHECK(all == ScrambledSobol(3, 5).points(100));
  CHECK(all != ScrambledSobol(3, 6).points(100));
  for (const long first : {1L, 2L, 37L, 64L}) {
    const std::vector<double> rest = sobol.points(100 - first, first);
    CHECK(std::equal(rest.begin(), rest.end(), all.begin() + 3 * first, all.end()));
  }
}

TEST_CASE("a drop on another floor than the scene's has no verdicts of it") {
  Scene scene = paper();
  scene.verdicts = {{"stiffness", "trusted"}};
  const DropModel model(scene, every_scatter());
  CHECK(model.even(2, 1)[0].scene.verdicts.empty());
  const File f("drops.csv", "stiffness\n5000\n");
  CHECK(read_drops(f.path, scene, table2().sea)[0].scene.verdicts.empty());
}

TEST_CASE("a normal number that is cut at three") {
  CHECK(truncated_normal(0.5) == Approx(0).margin(1e-15));
  CHECK(truncated_normal(0) == Approx(-3));
  CHECK(truncated_normal(1) == Approx(3));
  constexpr int kCount = 100'000;
  std::vector<double> x;
  for (int i = 0; i < kCount; ++i) x.push_back(truncated_normal((i + 0.5) / kCount));
  CHECK(std::is_sorted(x.begin(), x.end()));
  CHECK(deviation(x) == Approx(0.98658).epsilon(1e-4));
}

TEST_CASE("measures of a few peaks, by hand") {
  std::vector<double> ten(10), fifteen(15);
  std::iota(ten.begin(), ten.end(), 1), std::iota(fifteen.begin(), fifteen.end(), 1);
  std::reverse(fifteen.begin(), fifteen.end());
  CHECK(Measure{Kind::kMean}.of(ten) == Approx(5.5));
  CHECK(Measure{Kind::kCvar, 0.9}.of(ten) == Approx(10));
  CHECK(Measure{Kind::kCvar, 0.8}.of(ten) == Approx(9.5));
  CHECK(Measure{Kind::kCvar, 0.9}.of(fifteen) == Approx((15 + 0.5 * 14) / 1.5));  // half of the second
  CHECK(Measure{Kind::kQuantile, 0.9}.of(ten) == 9);
  CHECK(Measure{Kind::kQuantile, 0.9}.of(fifteen) == 14);
  CHECK(Measure{Kind::kQuantile, 0.5}.of(fifteen) == 8);
  CHECK(Measure{Kind::kWorst}.of(fifteen) == 15);
  std::vector<double> none;
  CHECK(std::isnan(Measure{Kind::kMean}.of(none)));
  CHECK(distribution(none).samples == 0);
  const Distribution d = distribution(ten);
  CHECK(d.samples == 10);
  CHECK(d.max == 10);
  CHECK(d.q90.value == 9);
  CHECK(d.mean.standard_error == Approx(deviation(ten) / std::sqrt(10.0)));
}

TEST_CASE("standard errors are those of drops drawn again and again") {
  constexpr int kSamples = 400, kRepeats = 2000;
  for (const Measure& m : {Measure{Kind::kMean}, Measure{Kind::kCvar, 0.9}, Measure{Kind::kQuantile, 0.5},
                           Measure{Kind::kQuantile, 0.9}}) {
    INFO(m.name() << " " << m.level);
    std::vector<double> values;
    double told = 0;
    for (int r = 0; r < kRepeats; ++r) {
      Random random(3, std::uint64_t(r));
      std::vector<double> x;
      for (int i = 0; i < kSamples; ++i) x.push_back(-std::log(1 - random.uniform()));  // skewed
      const Estimated e = estimated(m, x);
      values.push_back(e.value), told += e.standard_error / kRepeats;
    }
    CHECK(told == Approx(deviation(values)).epsilon(0.06));
  }
  CHECK(std::isnan(estimated({Kind::kWorst}, std::vector<double>{1, 2, 3}).standard_error));
}

TEST_CASE("a covariance that is none is refused, one that is scatters the constants so") {
  Actuator a = table2();
  a.uncertain = {"k_p", "k_d"};
  a.covariance = Eigen::Matrix2d{{1, 2}, {2, 1}};
  CHECK_THROWS_WITH(DropModel(paper(), Scatter{}, a, {}), Contains("positive semidefinite"));
  a.covariance = Eigen::Matrix2d{{1, 1}, {1, 1}};
  CHECK_NOTHROW(DropModel(paper(), Scatter{}, a, {}));

  const DropModel model(paper(), Scatter{}, correlated(), {.inflate = 2});
  REQUIRE(model.sampler().groups().size() == 1);
  CHECK(model.sampler().groups()[0].name == "actuator");
  CHECK(model.dimension() == 3);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const std::vector<ScatteredDrop> drops = model.even(4096, 1);
  for (const ScatteredDrop& d : drops) {
    const Eigen::Vector3d x(d.constants[2], d.constants[0], d.constants[4]);  // k_sea, k_p, i_motor
    sum += x * x.transpose() / double(drops.size());
  }
  const Eigen::MatrixXd known = correlated().covariance, expected = 4 * std::pow(0.98658, 2) * known;
  const Eigen::Vector3d scale = expected.diagonal().cwiseSqrt();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) CHECK(std::abs(sum(i, j) - expected(i, j)) < 0.02 * scale[i] * scale[j]);
}

TEST_CASE("every constant whose error is known scatters, and stays within its range") {
  Actuator a = table2();
  a.sea.friction = 0.3, a.sea.control_delay = 1e-3, a.sea.tau_max = 30;
  a.uncertain = {"friction", "tau_max", "control_delay"};
  a.covariance = Eigen::MatrixXd(Eigen::Vector3d(0.04, 4, 1e-6).asDiagonal());
  const DropModel model(paper(), Scatter{}, a, {});
  CHECK(model.dimension() == 3);
  const DrivenMotion planned{{-0.4, -1.4, 0.26}, a.sea};
  double sum = 0, square = 0, least = 1, least_delay = 1;
  constexpr int kDrops = 1024;
  for (const ScatteredDrop& d : model.even(kDrops, 1)) {
    const SeaParameters<double> sea = d.played(planned).sea;
    sum += (sea.tau_max - 30) / kDrops, square += std::pow(sea.tau_max - 30, 2) / kDrops;
    least = std::min(least, sea.friction), least_delay = std::min(least_delay, sea.control_delay);
    CHECK(sea.k_p == a.sea.k_p);
  }
  CHECK(std::abs(sum) < 0.02);
  CHECK(std::sqrt(square) == Approx(2 * 0.98658).epsilon(0.01));
  CHECK(least == 0);
  CHECK(least_delay == 0);
}

TEST_CASE("a scatter goes through its file and its text") {
  Scene s = paper();
  CHECK_FALSE(read_scene(File("scene.toml", to_toml(s, "")).path).scatter);
  for (const Scatter& scatter : {every_scatter(), Scatter::assumed(), Scatter{}}) {
    s.scatter = scatter;
    const auto read = read_scene(File("scene.toml", to_toml(s, "")).path).scatter;
    REQUIRE(read);
    for (const ScatterTerm& t : kScatterTerms) {
      INFO(t.name);
      CHECK((*read).*t.deviation == Approx(scatter.*t.deviation).epsilon(1e-10));
      if (scatter.any())
        CHECK(parse_scatter("", text_of(scatter)).*t.deviation == Approx(scatter.*t.deviation).epsilon(1e-10));
    }
  }
}

TEST_CASE("drops go through their file, whatever scatters") {
  const Scene scene = paper();
  const Actuator actuator = correlated();
  const DropModel model(scene, every_scatter(), actuator, {.inexact = true});
  const std::vector<ScatteredDrop> drops = model.independent(50, 1);
  const std::vector<DropColumn> columns = scattered_columns(drops, scene, actuator.sea);
  CHECK(columns.size() == 16);  // all but K_d and C_SEA
  CsvWriter csv;
  csv.comment("made up");
  std::vector<std::string> header = {"row", "remark"};
  for (const DropColumn& c : columns) header.push_back(c.name);
  csv.header(header);
  for (const ScatteredDrop& d : drops) {
    csv.cell(1).cell("x");
    for (const DropColumn& c : columns) csv.cell(c.of(numbers(d, actuator.sea)) / c.unit);
    csv.end_row();
  }
  const File f("drops.csv", csv.text());
  const std::vector<ScatteredDrop> read = read_drops(f.path, scene, actuator.sea);
  REQUIRE(read.size() == drops.size());
  const DrivenMotion planned{{-0.4, -1.4, 0.26}, actuator.sea};
  for (std::size_t i = 0; i < read.size(); ++i) {
    const DropNumbers was = numbers(drops[i], actuator.sea), is = numbers(read[i], actuator.sea);
    for (const DropColumn& c : columns) CHECK(c.of(is) == Approx(c.of(was)).epsilon(1e-12).margin(1e-12));
    const Eigen::Matrix<double, kDrivenNumbers, 1> played = numbers(drops[i].played(planned));
    CHECK((numbers(read[i].played(planned)) - played).cwiseAbs().maxCoeff() < 1e-9);
  }
  CHECK(scattered_columns(std::vector<ScatteredDrop>{{.scene = scene}}, scene, actuator.sea).empty());
}

TEST_CASE("a file of drops is refused with its place") {
  const Scene scene = paper();
  const auto refused = [&](const std::string& text, const std::string& words, const Scene& of) {
    const File f("drops.csv", text);
    CHECK_THROWS_WITH(read_drops(f.path, of, table2().sea), Contains(words));
  };
  refused("pitch_deg,height\n18,0.4\n18,-0.1\n", "drops.csv:3:4: 'height': -0.1: must be at least 0", scene);
  refused("stiffness\n0\n", "drops.csv:2:1: 'stiffness': 0: must be above 0", scene);
  refused("i_motor\n0\n", "'i_motor': 0: must be above 0", scene);
  refused("height,pitch_deg\n0.4,\n", "drops.csv:2:5: ", scene);
  refused("height\nhigh\n", "drops.csv:2:1: ", scene);
  refused("row,angle\n1,18\n", "drops.csv:1: no column of a drop", scene);
  refused("height,pitch\n0.4,-0.3\n", "drops.csv:1:8: column 'pitch': it is not read (did you mean \"pitch_deg\"?)",
          scene);
  refused("height,pich_deg\n0.4,18\n", "column 'pich_deg': it is not read (did you mean \"pitch_deg\"?)", scene);
  Scene no_floor = scene;
  no_floor.floor.reset();
  refused("height,stiffness\n0.4,7000\n", "drops.csv:1:8: 'stiffness': the scene has no [floor]", no_floor);
  const File f("drops.csv", "remark,height\nlow,0.3\nhigh,0.5\n");
  const std::vector<ScatteredDrop> drops = read_drops(f.path, scene, table2().sea);
  REQUIRE(drops.size() == 2);
  CHECK(drops[1].scene.drop.height == 0.5);
  CHECK(drops[1].scene.drop.pitch == scene.drop.pitch);
}

namespace {

/// Ishigami and Homma 1990, a = 7, b = 0.1.
double ishigami(const double* u) {
  const auto x = [&](int k) { return std::numbers::pi * (2 * u[k] - 1); };
  return std::sin(x(0)) + 7 * std::pow(std::sin(x(1)), 2) + 0.1 * std::pow(x(2), 4) * std::sin(x(0));
}

/// Its values at n base points, as sobol_indices takes them.
struct KnownPeaks {
  std::vector<double> a, b;
  std::vector<std::vector<double>> ab{3};

  KnownPeaks(long n, std::uint64_t seed) {
    const std::vector<double> points = ScrambledSobol(6, seed).points(n);
    for (std::size_t i = 0; i < points.size(); i += 6) {
      const double* u = &points[i];
      a.push_back(ishigami(u)), b.push_back(ishigami(u + 3));
      for (std::size_t g = 0; g < 3; ++g) {
        double mixed[3] = {u[0], u[1], u[2]};
        mixed[g] = u[3 + g];
        ab[g].push_back(ishigami(mixed));
      }
    }
  }
};

}  // namespace

TEST_CASE("Sobol indices of Ishigami's function") {
  constexpr double kFirst[3] = {0.3139, 0.4424, 0}, kTotal[3] = {0.5576, 0.4424, 0.2437};
  KnownPeaks v(8192, 1);
  const std::vector<SobolIndex> found = sobol_indices(v.a, v.b, v.ab, 1, 1);
  REQUIRE(found.size() == 3);
  for (std::size_t g = 0; g < 3; ++g) {
    CHECK(found[g].first.value == Approx(kFirst[g]).margin(0.01));
    CHECK(found[g].total.value == Approx(kTotal[g]).margin(0.01));
    for (const auto& [i, truth] : {std::pair{found[g].first, kFirst[g]}, {found[g].total, kTotal[g]}}) {
      CHECK(i.low < i.value);
      CHECK(i.high > i.value);
      CHECK((i.low < truth && i.high > truth));
      CHECK(i.high - i.low < 0.1);
    }
  }
  SECTION("threads do not change them") {
    const std::vector<SobolIndex> again = sobol_indices(v.a, v.b, v.ab, 1, 3);
    for (std::size_t g = 0; g < 3; ++g) {
      CHECK(again[g].first.low == found[g].first.low);
      CHECK(again[g].total.high == found[g].total.high);
    }
  }
  SECTION("a base point with a value that there is not is left out") {
    v.ab[1][5] = std::numeric_limits<double>::infinity();
    v.a[9] = std::numeric_limits<double>::quiet_NaN();
    CHECK(sobol_indices(v.a, v.b, v.ab, 1, 1)[0].first.value == Approx(0.3139).margin(0.01));
  }
  SECTION("where nothing varies there are none") {
    const std::vector<double> flat(16, 3.0);
    const std::vector<std::vector<double>> ab(2, flat);
    for (const SobolIndex& i : sobol_indices(flat, flat, ab, 1, 1)) CHECK(std::isnan(i.total.value));
  }
}
