// What a fit says of its terms: errors and verdicts, in whatever order they were fitted.
#include "identify/estimate/estimates.hpp"

#include <catch2/catch.hpp>

using namespace ukemi::identify;

TEST_CASE("a constant's errors and verdict are its own, in whatever order the constants were fitted") {
  // Of the table a, b; a is known to 1 % and b to a fifth: the variances of `fitted` are the other way round.
  const Estimate a{.name = "a", .value = 10'000, .std = {}}, b{.name = "b", .value = 10, .std = {}},
      along{.name = "c", .value = 1, .std = {}};
  Estimates out;
  out.parameters = {a, b}, out.nuisance = {along}, out.half_width = 2;
  out.fitted = {"b", "a", "c"};
  set_errors(Eigen::Vector3d(1, 50 * 50, 0.25).asDiagonal(), out);
  CHECK(*out.parameters[0].std == 50);
  CHECK(out.parameters[0].verdict == Identifiability::kTrusted);
  CHECK(*out.parameters[1].std == 1);
  CHECK(out.parameters[1].verdict == Identifiability::kWeak);
  CHECK(*out.nuisance[0].std == 0.5);
  CHECK(out.nuisance[0].verdict == Identifiability::kFitted);
}

TEST_CASE(
    "a constant that is no longer identifiable once its errors are wider is warned of, and one that is again is not") {
  Estimates out;
  out.parameters = {{.name = "a", .value = 10, .std = {}}}, out.fitted = {"a"}, out.half_width = 2;
  set_errors(Eigen::MatrixXd::Constant(1, 1, 1e-4), out);
  using enum Wording::Interval;
  for (const auto interval : {kRelative, kAbsolute}) {
    update_errors(Eigen::MatrixXd::Constant(1, 1, 400), 2, interval, out);
    CHECK(out.parameters[0].verdict == Identifiability::kNotIdentifiable);
    REQUIRE(out.warnings.size() == 1);
    CHECK(out.warnings[0].find("a is not identifiable: the 95 % interval is 40") == 0);  // 40, or 400 %
    update_errors(Eigen::MatrixXd::Constant(1, 1, 900), 2, interval, out);
    REQUIRE(out.warnings.size() == 1);
    CHECK(out.warnings[0].find("is 60") != std::string::npos);
    update_errors(Eigen::MatrixXd::Constant(1, 1, 1e-4), 2, interval, out);
    CHECK(out.warnings.empty());
  }
}
