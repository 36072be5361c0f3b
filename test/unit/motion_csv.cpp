// A motion from the rows that a robot plays (landing/model/motion_csv.hpp).
#include "landing/model/motion_csv.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/csv.hpp"
#include "landing/model/motion.hpp"
#include "landing/model/scene_file.hpp"
#include "test/folder.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace test;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

const double kNever = std::numeric_limits<double>::infinity();
const Motion kPlain{-0.47, -1.44, 0.1693};
const Motion kShaped{-0.47, -1.44, 0.1693, {0.12, -0.05, 0.03, 0.004}};

/// A motion with a move in the air that takes so long.
Motion moved(double duration) {
  Motion m = kShaped;
  m.reposition = Reposition{-0.785, 0, 0.1, 0.1 + duration};
  return m;
}

Motion again(const Motion& m, double start = kNever, double rate = 1000) {
  const Folder f;
  return read_motion(f.write("motion.csv", to_csv(rows_of(m, start, rate), "who wrote it")));
}

/// The largest difference of two motions that start at the same time, in every number of theirs.
double difference(const Motion& a, const Motion& b) {
  double most = std::max({std::abs(a.phi_i - b.phi_i), std::abs(a.phi_f - b.phi_f), std::abs(a.duration - b.duration),
                          std::abs(a.gain_p - b.gain_p), std::abs(a.gain_d - b.gain_d)});
  for (std::size_t k = 0; k < kMaxBumps; ++k) most = std::max(most, std::abs(a.bumps[k] - b.bumps[k]));
  if (a.reposition.has_value() != b.reposition.has_value()) return kNever;
  if (a.reposition)
    most = std::max({most, std::abs(a.reposition->phi - b.reposition->phi),
                     std::abs(a.reposition->rate - b.reposition->rate),
                     std::abs(a.reposition->from - b.reposition->from), std::abs(a.reposition->to - b.reposition->to)});
  return most;
}

/// A CSV with its cells as so many digits behind the point.
std::string rounded(const MotionRows& rows, int digits) {
  const double unit = std::pow(10, digits);
  MotionRows out = rows;
  for (auto* column : {&out.t, &out.phi, &out.dphi})
    for (double& x : *column) x = std::round(x * unit) / unit;
  return to_csv(out, "");
}

}  // namespace

TEST_CASE("a motion is recovered from its rows") {
  CHECK(difference(again(kPlain), kPlain) == 0);
  CHECK(!has_bumps(again(kPlain)));
  CHECK(difference(again(kShaped), kShaped) < 1e-12);
  CHECK(difference(again(kShaped, kNever, 37.7), kShaped) < 1e-12);  // six rows, unevenly
  CHECK(difference(again(kShaped, kNever, 1e5), kShaped) < 1e-12);
  Motion m = kShaped;
  m.gain_p = 0.3, m.gain_d = 2.25;
  CHECK(difference(again(m), m) < 1e-12);
}

TEST_CASE("so is its move in the air, whether the touchdown comes after it or in it") {
  CHECK(difference(again(moved(0.15), 0.29), moved(0.15)) < 1e-11);
  CHECK(difference(again(moved(0.19), 0.29), moved(0.19)) < 1e-11);  // ends with the touchdown
  CHECK(difference(again(moved(0.30), 0.29), moved(0.30)) < 1e-10);  // cut at two thirds
  Motion m = moved(0.15);
  m.reposition->rate = 0.7, m.gain_p = 0.5;
  CHECK(difference(again(m, 0.29), m) < 1e-11);
  m.phi_i = m.reposition->phi;  // stands in the air
  const Motion stood = again(m, 0.29);
  CHECK(stood.phi_i == m.phi_i);
  CHECK(peak_reference_rate(stood) == Approx(peak_reference_rate(m)).epsilon(1e-9));
}

TEST_CASE("a release rate alone is kept, and a reference that stands is one") {
  Motion m = kPlain;
  m.reposition = Reposition{kPlain.phi_i, 0.7, 0.3, 0.5};
  const Motion a = again(m, 0.2);  // the touchdown comes before the move
  REQUIRE(a.reposition);
  CHECK(a.reposition->rate == 0.7);
  CHECK(a.release_phi() == kPlain.phi_i);
  const Motion held = again({-0.5, -0.5, 0.2});
  CHECK(!moves(held));
  CHECK(held.phi_i == -0.5);
}

TEST_CASE("rows that were rounded are a motion still, and get no shape terms from it") {
  const Folder f;
  const Motion plain = read_motion(f.write("a.csv", rounded(rows_of(kPlain, kNever, 1000), 6)));
  CHECK(!has_bumps(plain));
  CHECK(difference(plain, kPlain) < 1e-3);  // the last row is at 0.169
  Motion m = moved(0.15);
  m.duration = 0.169;
  MotionRows rows = rows_of(m, 0.29, 1000);
  CHECK(difference(read_motion(f.write("b.csv", rounded(rows, 6))), m) < 1e-4);
  // Rows that hold the end add nothing.
  for (int i = 1; i < 50; ++i)
    rows.t.push_back(m.duration + i * 1e-3), rows.phi.push_back(m.phi_f), rows.dphi.push_back(0);
  CHECK(difference(read_motion(f.write("c.csv", to_csv(rows, ""))), m) < 1e-11);
}

TEST_CASE("rows that are no such motion are refused, each with its place") {
  const Folder f;
  const auto error = [&](const MotionRows& rows) {
    return error_of(f, [&] { (void)read_motion(f.write("m.csv", to_csv(rows, ""))); });
  };
  MotionRows rows = rows_of(kShaped, kNever, 1000);
  rows.phi[80] += 2e-3;
  CHECK_THAT(error(rows), StartsWith("m.csv:84:6: column 'phi_ref': ") && Contains("rad from the nearest motion") &&
                              Contains("at most 0.0001 rad is needed"));
  rows = rows_of(kShaped, kNever, 1000);
  for (double& x : rows.dphi) x *= 57.3;
  CHECK_THAT(error(rows), Contains("column 'dphi_ref'") && Contains("at most 0.01 rad/s is needed"));
  rows = rows_of(kPlain, kNever, 1000);
  for (std::size_t i = 0; i < rows.t.size(); ++i) {  // a straight line
    rows.phi[i] = kPlain.phi_i + (kPlain.phi_f - kPlain.phi_i) * rows.t[i] / kPlain.duration;
    rows.dphi[i] = i + 1 < rows.t.size() ? (kPlain.phi_f - kPlain.phi_i) / kPlain.duration : 0;
  }
  CHECK_THAT(error(rows), Contains("rad from the nearest motion"));
  rows = rows_of(moved(0.15), 0.29, 1000);
  rows.phi[50] += 2e-3;
  CHECK_THAT(error(rows), Contains("column 'phi_ref'") && Contains("from the nearest motion"));
  CHECK_THAT(error(rows_of(kPlain, kNever, 20)),
             Contains("column 't': 3 row(s) inside the landing motion: at least 5"));
  CHECK_THAT(error(rows_of(moved(0.15), 0.1031, 1000)), Contains("row(s) inside the move in the air: at least 5"));
}

TEST_CASE("columns of a motion that cannot be are refused") {
  const Folder f;
  const auto error = [&](const std::string& text) {
    return error_of(f, [&] { (void)read_motion(f.write("m.csv", text)); });
  };
  CHECK_THAT(error("t,phi_ref\n0,1\n"), StartsWith("m.csv:1: column 'dphi_ref': missing"));
  CHECK_THAT(error("t,phi_ref,dphi_ref\n0.001,1,0\n"), StartsWith("m.csv:2:1: column 't': no row has t = 0"));
  CHECK_THAT(error("t,phi_ref,dphi_ref\n-1,1,0\n"), StartsWith("m.csv:2:1: column 't': no row has t = 0"));
  CHECK_THAT(error("t,phi_ref,dphi_ref\n0,1,0\n0,1,0\n"), StartsWith("m.csv:3:1: column 't': 0: time must increase"));
  CHECK_THAT(error("t,phi_ref,dphi_ref\n0,-45,0\n"), StartsWith("m.csv:2:3: column 'phi_ref': -45 rad: at most 2 pi"));
  CHECK_THAT(error("t,phi_ref,dphi_ref\n-0.1,1,0\n0,1,0\n"), Contains("needs the column 't_from_release'"));
  CHECK_THAT(error("t,phi_ref,dphi_ref,t_from_release\n-0.1,1,0,0.1\n0,1,0,0.3\n"),
             StartsWith("m.csv:3:7: column 't_from_release': 0.3: "));
  CHECK_THAT(error("t,phi_ref,dphi_ref,t_from_release\n-0.1,1,0,-0.1\n0,1,0,0\n"), Contains("-0.1: at least 0"));
  CHECK_THAT(error("t,phi_ref,dphi_ref,gain_p\n0,1,0,2\n1,1,0,3\n"), StartsWith("m.csv:3:7: column 'gain_p': 3: 2"));
  CHECK_THAT(error("t,phi_ref,dphi_ref,gain_p\n0,1,0,-2\n"), Contains("-2: at least 0 is needed"));
}
