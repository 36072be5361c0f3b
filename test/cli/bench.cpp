// What `ukemi bench optimizers` leaves, and what it takes from earlier runs.
#include <catch2/catch.hpp>

#include "test/cli/refused.hpp"

using namespace cli;

namespace {

const Arguments kBench = {"bench", "optimizers", "--times", "0.005", "--no-report"};

/// The rows, without the comments and the header.
std::string rows(const Folder& f, const std::string& path) {
  std::string text = read(f.at(path));
  return text.substr(text.find("scene,objective"));
}

}  // namespace

TEST_CASE("bench optimizers: what earlier runs searched is taken from their files, and not searched again") {
  const Folder f;
  done(f, kBench + Arguments{"--solvers", "random,auto", "-o", "one"});
  done(f, kBench + Arguments{"--solvers", "random", "--seed", "2", "-o", "two"});
  const Arguments with = {"--with", "one/optimizers.csv", "two/optimizers.csv"};
  // The same solvers and seed: the same rows to the last digit, times included.
  done(f, kBench + Arguments{"--solvers", "random,auto", "-o", "same"} + with);
  CHECK(rows(f, "same/optimizers.csv") == rows(f, "one/optimizers.csv"));
  CHECK(summary(f, "same")["peak"] == summary(f, "one")["peak"]);
  // Both seeds of one solver, added up.
  const Result both = done(f, kBench + Arguments{"--solvers", "random", "--seeds", "2", "-o", "both"} + with);
  CHECK_THAT(both.err, Catch::Matchers::Contains("40 searches, 40 from earlier runs"));
  const Json gaps = summary(f, "both")["peak"]["gaps"]["random"];
  REQUIRE(gaps.size() == 1);
  CHECK(gaps[0] > 0);
  const std::string ranges = read(f.at("both/gaps.csv"));
  CHECK_THAT(ranges, Catch::Matchers::Contains("scene,objective,solver,budget_s,seeds,median,least,largest\n"
                                               "paper,peak,random,0.005,2,"));
}

TEST_CASE("a bench without -o writes to ./ukemi-out/bench-NAME") {
  const Folder f;
  fs::create_directory(f.at("ukemi-out"));
  for (const std::string name : {"identify", "integrators", "optimizers", "scenes", "stability"}) {
    // A file where the folder would be: the bench refuses before any work.
    const std::string folder = "ukemi-out/bench-" + name;
    f.write(folder, "");
    check_refused(f, {"bench", name}, {folder + ": the output folder cannot be made"});
  }
}

TEST_CASE("bench optimizers: a file of earlier runs that is none is refused where it stands") {
  const Folder f;
  const auto check = [&](const std::string& text, const std::vector<std::string>& texts) {
    f.write("a.csv", text);
    check_refused(f, kBench + Arguments{"--with", "a.csv", "-o", "out"}, texts);
  };
  check("scene,objective,solver,budget_s,seed,value\nmoon,peak,auto,1,1,170\n", {"a.csv:2:1: 'moon': ", "paper"});
  check("scene,objective,solver,budget_s,seed,value\npaper,low,auto,1,1,170\n", {"a.csv:2:7: 'low': ", "tolerant"});
  check("scene,objective,solver,budget_s,seed,value\npaper,peak,auto,1,,170\n", {"a.csv:2:19: ", "'seed'", "empty"});
  check("scene,objective,solver,budget_s,seed,value\npaper,peak,auto,1,1.5,170\n", {"a.csv:2:19: ", "1.5", "whole"});
  check("scene,objective,solver,budget_s,seed\npaper,peak,auto,1,1\n", {"a.csv:1: ", "'value'", "missing"});
  check_refused(f, kBench + Arguments{"--with", "none.csv", "-o", "out"}, {"none.csv"});
}
