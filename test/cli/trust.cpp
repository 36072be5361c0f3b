// ukemi identify --strict, --diagnose, --profile: what scripts read, and what they are told.
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const Arguments kAll = Arguments{"identify"} + impact_trials() + Arguments{"--rig", kRig};

/// The first of the shipped trials, its angle cut short 20 ms after the hit began: too little for five constants.
std::string cut_short(const Folder& f) {
  std::istringstream in(read(kTrial1));
  std::string text, line;
  for (int row = 0; row < 76 && std::getline(in, line); ++row) text += line + "\n";
  return f.write("short.csv", text);
}

}  // namespace

TEST_CASE("identify --strict: exit 0 where every constant is trusted") {
  const Folder f;
  const Result r = done(f, kAll + kOut + Arguments{"--strict"});
  const Json s = summary(f);
  CHECK(s["trusted"] == true);
  for (const char* k : {"k_p", "k_d", "k_sea", "c_sea", "i_motor"}) CHECK(s["parameters"][k]["verdict"] == "trusted");
  CHECK_THAT(r.out, Contains("trusted"));
  CHECK_THAT(r.out, Contains("these trials tell least apart"));
  CHECK_THAT(s["weakest"]["text"].get<std::string>(), Contains("these trials tell least apart"));
  CHECK(s["weakest"]["relative_change"].size() == 5);
  CHECK(s["weakest"]["noise"] == Approx(5e-4).epsilon(0.05));
  const Json& d = s["diagnostics"];
  CHECK(d["level"] == 0.01);
  CHECK(d["whiteness"]["rejected"] == false);
  CHECK(d["normality"]["rejected"] == false);
  REQUIRE(d["missing_terms"].size() >= 1);
  CHECK(d["missing_terms"][0]["term"] == "friction");
  CHECK(d["missing_terms"][0]["missed"] == false);
  CHECK_FALSE(d.contains("ladder"));  // not asked for
  CHECK_FALSE(d.contains("leave_one_out"));
  CHECK_THAT(read(f.at("out/report.html")), Contains("How far to trust it"));
}

TEST_CASE("identify says what the rig's errors add, and what to measure better") {
  const Folder f;
  const std::string exact = read(kRig), first = "exact = true";
  f.write("rig.toml", replaced(exact, first, "delay = 0.002"));
  const auto with = [&](const std::string& rig, const std::string& out) {
    Arguments all = kAll;
    *std::find(all.begin(), all.end(), kRig) = rig;
    const Result r = run(all + Arguments{"-o", out}, f.at(""));
    INFO(r.err);
    REQUIRE(r.code == 0);
    return r;
  };
  const Result plain = with(kRig, "plain"), doubted = with("rig.toml", "doubted");
  const Json a = summary(f, "plain"), b = summary(f, "doubted");
  CHECK_THAT(plain.out, Contains("errors of the rig") && Contains("none, exact"));
  CHECK_THAT(doubted.out,
             Contains("inertia 1 %, length 0.5 %, force_gain 1 %, encoder_gain 0.1 %, delay 2 ms, filter 1 ms") &&
                 Contains("share of the variance") && Contains("--nuisance "));
  CHECK(b["rig_errors"]["delay"] == 0.002);
  CHECK(b["rig_errors"]["time_shift"] == 0);
  CHECK(a["error_budget"]["k_d"]["noise"] == 1);
  for (const char* k : {"k_p", "k_d", "k_sea", "c_sea", "i_motor"}) {
    CHECK(a["parameters"][k]["std"] == a["parameters"][k]["std_noise"]);
    CHECK(b["parameters"][k]["std_noise"] == a["parameters"][k]["std"]);
    CHECK(b["parameters"][k]["std"] > b["parameters"][k]["std_noise"]);
    double sum = 0;
    for (const Json& share : b["error_budget"][k]) sum += share.get<double>();
    CHECK(sum == Approx(1));
  }
  CHECK_THAT(read(f.at("doubted/report.html")), Contains("Where the errors come from"));
  CHECK_FALSE(read(f.at("plain/report.html")).find("Where the errors come from") != std::string::npos);
}

TEST_CASE("identify --strict: exit 1 where a constant is not trusted, with every file written") {
  const Folder f;
  const Arguments command = {"identify", cut_short(f), "--rig", kRig, "--start", kTable2};
  REQUIRE(run(command + kOut, f.at("")).code == 0);
  const Json s = summary(f);
  CHECK(s["trusted"] == false);
  CHECK(s["parameters"]["k_p"]["verdict"] != "trusted");
  const Result r = run(command + kOut + Arguments{"--strict"}, f.at(""));
  CHECK(r.code == 1);
  for (const char* name : {"actuator.toml", "fit.csv", "summary.json", "report.html"})
    CHECK(fs::exists(f.at(std::string("out/") + name)));
  CHECK_THAT(r.err, Contains("these trials "));
}

TEST_CASE("identify --diagnose: a term with a prior is left out of the models that lack it") {
  const Folder f;
  done(f, {"identify", dataset("impact/trial_4.csv"), dataset("impact/trial_8.csv"), "--rig", kRig, "--nuisance",
           "friction", "--prior", "friction=0.3:0.3", "--diagnose", "-o", "out"});
}

TEST_CASE("identify --diagnose: the ladder and each trial left out") {
  const Folder f;
  const Arguments command =
      Arguments{"identify", dataset("impact/trial_4.csv"), dataset("impact/trial_8.csv"), "--rig", kRig, "--diagnose"};
  const Result r = done(f, command + kOut + Arguments{"--figures", "svg"});
  for (const char* figure : {"ladder.svg", "weakest.svg", "constants.svg"}) CHECK(fs::exists(f.at("out/") + figure));
  const Json d = summary(f)["diagnostics"];
  CHECK(d["ladder"]["preferred"] == "plain");
  CHECK(d["ladder"]["plain_rejected"] == false);
  REQUIRE(d["ladder"]["rungs"].size() >= 2);
  for (const Json& rung : d["ladder"]["rungs"])
    for (const char* key : {"name", "converged", "terms", "rms", "bic", "p", "held_out_rms"}) CHECK(rung.contains(key));
  REQUIRE(d["leave_one_out"].size() == 2);
  for (const Json& l : d["leave_one_out"]) {
    CHECK(l["disagrees"] == false);
    CHECK(l["shift"].size() == 5);
    CHECK(l["held_out_rms"] == Approx(5e-4).epsilon(0.1));
  }
  CHECK_THAT(read(f.at("out/report.html")), Contains("Model ladder"));
}

TEST_CASE("identify --profile: a file, an interval, a plot") {
  const Folder f;
  const Result r = run(
      Arguments{"identify", dataset("impact/trial_4.csv"), "--rig", kRig, "--profile", "k_sea,c_sea"} + kOut, f.at(""));
  INFO(r.err);
  REQUIRE(r.code == 0);
  const Json p = summary(f)["diagnostics"]["profile"];
  CHECK(p.size() == 2);
  for (const char* k : {"k_sea", "c_sea"}) {
    const double low = p[k]["ci95"][0], high = p[k]["ci95"][1], width = high - low;
    CHECK(width > 0);
    CHECK(low == Approx(p[k]["linear"][0].get<double>()).margin(0.1 * width));
    CHECK(high == Approx(p[k]["linear"][1].get<double>()).margin(0.1 * width));
  }
  const std::string csv = read(f.at("out/profile.csv"));
  CHECK_THAT(csv, Contains("\nconstant,value,rise,threshold\n"));
  CHECK(std::count(csv.begin(), csv.end(), '\n') > 50);
  CHECK_THAT(read(f.at("out/report.html")), Contains("Profile likelihood of k_sea"));
  CHECK_THAT(r.out, Contains("k_sea by profile likelihood, 95 %: "));
}

TEST_CASE("identify: bad constants to profile") {
  const Folder f;
  check_refused(f, kAll + kOut + Arguments{"--profile", "k_see"}, {"--profile: 'k_see': ", "k_sea"});
  const Arguments start = {"--start", kTable2};
  check_refused(f, kAll + kOut + start + Arguments{"--free", "k_p,k_d", "--profile", "k_sea"},
                {"--profile: k_sea: it is not among the --free constants"});
  check_refused(f, kAll + kOut + start + Arguments{"--free", "k_p", "--profile", "k_p"},
                {"--profile: k_p: no other constant is free to follow it"});
}
