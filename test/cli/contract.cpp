// The contract for scripts: files, keys, columns, exit codes, and the same bytes with any number
// of threads.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <set>
#include <sstream>

#include "test/cli/program.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const Arguments kConstants = {"k_p", "k_d", "k_sea", "c_sea", "i_motor"};
const std::string kTrial9 = dataset("impact_validation/trial_9.csv");

const Arguments kIdentify = Arguments{"identify"} + impact_trials() + Arguments{"--rig", kRig};
const Arguments kSimulate = {"simulate", kPaper, "--actuator", kTable2, "--hold", "-45"};
const Arguments kOptimize = {"optimize", kPaper, "--actuator", kTable2, "--evaluations", "600"};

std::set<std::string> files(const Folder& f, const std::string& folder = "out") {
  std::set<std::string> out;
  for (const auto& [name, bytes] : f.content(folder)) out.insert(name);
  return out;
}

void check_keys(const Json& j, const Arguments& keys) {
  for (const std::string& k : keys) {
    INFO("key " << k);
    CHECK(j.contains(k));
  }
}

using Cells = std::vector<std::string>;

Cells split(const std::string& text, char separator) {
  Cells out;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find(separator, begin)) != std::string::npos; begin = end + 1)
    out.push_back(text.substr(begin, end - begin));
  out.push_back(text.substr(begin));
  return out;
}

/// A CSV that the program wrote: its `#` lines, its header, its rows by column.
struct Table {
  std::string comments, header;
  std::vector<Cells> rows;
  Cells names;

  explicit Table(const std::string& text) {
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
      if (line.rfind("#", 0) == 0) {
        comments += line + "\n";
      } else if (header.empty()) {
        header = line;
        names = split(line, ',');
      } else {
        rows.push_back(split(line, ','));
        if (rows.back().size() != names.size()) throw std::runtime_error("a row of another length: " + line);
      }
    }
  }
  std::size_t index(const std::string& name) const {
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end()) throw std::runtime_error("no column " + name);
    return std::size_t(it - names.begin());
  }
  Cells texts(const std::string& name) const {
    Cells out;
    for (const Cells& r : rows) out.push_back(r[index(name)]);
    return out;
  }
  /// Every cell must be a finite number.
  std::vector<double> numbers(const std::string& name) const {
    std::vector<double> out;
    for (const std::string& s : texts(name)) {
      std::size_t end = 0;
      out.push_back(std::stod(s, &end));
      if (end != s.size() || !std::isfinite(out.back()))
        throw std::runtime_error("column " + name + ": no number: " + s);
    }
    return out;
  }
};

Table table(const Folder& f, const std::string& path) { return Table(read(f.at(path))); }

/// `key = NUMBER` of a TOML text.
double toml_number(const std::string& text, const std::string& key) {
  const std::size_t i = text.find("\n" + key + " = ");
  if (i == std::string::npos) throw std::runtime_error("no key " + key);
  return std::stod(text.substr(i + key.size() + 4));
}

bool increasing(const std::vector<double>& t, bool strictly) {
  for (std::size_t i = 1; i < t.size(); ++i)
    if (strictly ? !(t[i] > t[i - 1]) : !(t[i] >= t[i - 1])) return false;
  return true;
}

/// A folder's files without what may differ between runs: the provenance blocks and the time_s fields.
std::map<std::string, std::string> without_provenance(const Folder& f, const std::string& folder) {
  std::map<std::string, std::string> out;
  for (auto [name, text] : f.content(folder)) {
    if (name == "summary.json") {
      Json j = Json::parse(text);
      j.erase("provenance");
      j.erase("time_s");
      if (j.contains("evidence")) j["evidence"].erase("time_s");
      text = j.dump(1);
    } else if (name == "report.html") {
      text = text.substr(0, text.find("<h2>Provenance</h2>"));
    } else {
      std::istringstream in(text);
      std::string kept;
      for (std::string line; std::getline(in, line) && line != "[provenance]";)
        if (line.rfind("#", 0) != 0) kept += line + "\n";
      text = kept;
    }
    if (name == "solvers.csv" || name == "progress.csv") {
      const Table t(text);
      text = t.header + "\n";
      for (Cells row : t.rows) {
        row[t.index("time_s")] = "";
        for (const std::string& cell : row) text += cell + ",";
        text += "\n";
      }
    }
    out[name] = text;
  }
  return out;
}

/// The same command with one and with other numbers of threads.
void check_threads(const Arguments& arguments, const Arguments& others = {"2"}) {
  const Folder f;
  done(f, arguments + Arguments{"--threads", "1", "-o", "one"});
  const auto one = without_provenance(f, "one");
  CHECK(one.size() > 2);
  for (const std::string& threads : others) {
    done(f, arguments + Arguments{"--threads", threads, "-o", "more"});
    const auto more = without_provenance(f, "more");
    CHECK(files(f, "one") == files(f, "more"));
    for (const auto& [name, text] : one) {
      INFO(threads << " threads: " << name);
      const bool same = more.count(name) && more.at(name) == text;
      CHECK(same);
      CHECK(text.size() > 20);
    }
  }
}

/// The paper's scene, followed for so short that a search is cheap.
std::string short_scene(const Folder& f) { return f.write("short.toml", read(kPaper) + "\n[run]\nt_end = 0.42\n"); }

}  // namespace

// ---- identify, predict

TEST_CASE("identify writes its files and keys, and finds the constants the trials were made with") {
  const Folder f;
  const Result r = done(f, kIdentify + Arguments{"-o", "out"});
  CHECK(files(f) == std::set<std::string>{"actuator.toml", "fit.csv", "report.html", "summary.json"});
  for (const std::string& name : kConstants) CHECK_THAT(r.out, Contains(name));

  const Json s = summary(f);
  check_keys(s, {"parameters", "nuisance", "rms", "cost", "converged", "iterations", "identifiable", "warnings",
                 "trials", "time_s", "provenance"});
  CHECK(s["converged"] == true);
  CHECK(s["identifiable"] == true);
  CHECK(s["iterations"] > 0);
  CHECK(s["time_s"] > 0);
  CHECK(s["warnings"].is_array());
  CHECK(s["nuisance"] == Json::object());
  CHECK(s["rms"].get<double>() == Approx(5e-4).epsilon(0.03));  // the noise that was put on
  const std::vector<double> truth = {50, 1, 65, 1.6, 0.085};    // Table 2 of the paper
  const Arguments units = {"Nm/rad", "Nm/(rad/s)", "Nm/rad", "Nm/(rad/s)", "kg m^2"};
  REQUIRE(s["parameters"].size() == kConstants.size());
  for (std::size_t i = 0; i < kConstants.size(); ++i) {
    INFO(kConstants[i]);
    const Json& p = s["parameters"][kConstants[i]];
    check_keys(p, {"value", "std", "ci95", "unit", "at_bound", "free"});
    const double value = p["value"], std = p["std"];
    CHECK(std > 0);
    CHECK(std < 0.01 * value);
    CHECK(std::abs(value - truth[i]) < 4 * std);
    REQUIRE(p["ci95"].size() == 2);
    CHECK(p["ci95"][0].get<double>() == Approx(value - 1.96 * std).epsilon(1e-4));
    CHECK(p["ci95"][1].get<double>() == Approx(value + 1.96 * std).epsilon(1e-4));
    CHECK(p["unit"] == units[i]);
    CHECK(p["at_bound"] == false);
    CHECK(p["free"] == true);
  }
  REQUIRE(s["trials"].size() == 8);
  for (std::size_t m = 0; m < 8; ++m) {
    CHECK(s["trials"][m]["file"] == impact_trials()[m]);
    CHECK(s["trials"][m]["samples"] == 1001);
    CHECK(s["trials"][m]["rms"].get<double>() == Approx(5e-4).epsilon(0.1));
  }

  // fit.csv: residual = phi_sim - phi, and `cost` is the plain sum of its squares.
  const Table fit = table(f, "out/fit.csv");
  CHECK(fit.header == "trial,t,phi,phi_sim,residual");
  REQUIRE(fit.rows.size() == 8 * 1001);
  CHECK(fit.rows.front()[0] == "1");
  CHECK(fit.rows.back()[0] == "8");
  const auto phi = fit.numbers("phi"), sim = fit.numbers("phi_sim"), residual = fit.numbers("residual");
  double sum = 0, largest = 0;
  for (std::size_t i = 0; i < phi.size(); ++i) {
    sum += residual[i] * residual[i];
    largest = std::max(largest, std::abs(sim[i] - phi[i] - residual[i]));
  }
  CHECK(largest < 1e-15);
  CHECK(s["cost"].get<double>() == Approx(sum).epsilon(1e-9));
  CHECK(s["rms"].get<double>() == Approx(std::sqrt(sum / (8 * 1001))).epsilon(1e-9));

  // actuator.toml: the same numbers, the rig's torque limit and feedback.
  const std::string actuator = read(f.at("out/actuator.toml"));
  for (const std::string& name : kConstants)
    CHECK(toml_number(actuator, name) == s["parameters"][name]["value"].get<double>());
  CHECK(toml_number(actuator, "tau_max") == 20);
  CHECK_THAT(actuator, Contains("feedback = \"output\"") && Contains("[uncertainty]") && Contains("[provenance]"));
  CHECK_THAT(actuator, Contains("order = [\"k_p\", \"k_d\", \"k_sea\", \"c_sea\", \"i_motor\"]") &&
                           Contains("std = [") && Contains("ci95 = [[") && Contains("covariance = ["));
  CHECK_THAT(read(f.at("out/report.html")), Contains("<html") && Contains("<svg") && Contains("</html>"));

  // The other verbs accept the file, and it explains a trial that it has not seen.
  done(f, {"simulate", kPaper, "--actuator", "out/actuator.toml", "--hold", "-45", "-o", "landing"});
  CHECK(summary(f, "landing")["peak_acceleration"].get<double>() == Approx(466.17).epsilon(0.01));
  done(f, {"predict", kTrial9, "--rig", kRig, "--actuator", "out/actuator.toml", "-o", "check"});
  const Json p = summary(f, "check");
  CHECK(p["rms"].get<double>() == Approx(5e-4).epsilon(0.1));
  REQUIRE(p["trials"].size() == 1);
  CHECK(p["trials"][0]["file"] == kTrial9);
  for (const std::string& name : kConstants) {
    CHECK(p["parameters"][name]["free"] == false);
    CHECK(p["parameters"][name]["std"].is_null());
    CHECK(p["parameters"][name]["value"] == s["parameters"][name]["value"]);
  }
  for (const char* name : {"fit.csv", "report.html", "summary.json"}) CHECK(files(f, "check").count(name) == 1);
  CHECK(table(f, "check/fit.csv").rows.size() == 1001);

  // It starts a fit of fewer constants; the others stay where they are.
  done(f, {"identify", kTrial1, "--rig", kRig, "--start", "out/actuator.toml", "--free", "k_sea", "--nuisance",
           "initial_angle", "-o", "one"});
  const Json one = summary(f, "one");
  CHECK(one["parameters"]["k_sea"]["free"] == true);
  CHECK(one["parameters"]["k_p"]["free"] == false);
  CHECK(one["parameters"]["k_p"]["std"].is_null());
  CHECK(one["parameters"]["k_p"]["value"] == s["parameters"]["k_p"]["value"]);
  CHECK(one["nuisance"].contains("initial_angle"));
  CHECK_THAT(read(f.at("one/actuator.toml")), Contains("order = [\"k_sea\"]"));
}

TEST_CASE("predict does without phi and tells the motion") {
  const Folder f;
  f.write("hit.csv", "t,force\n0,0\n0.01,100\n0.02,0\n0.05,0\n");
  done(f, {"predict", "hit.csv", "--rig", kRig, "--actuator", kTable2, "-o", "out"});
  const Table fit = table(f, "out/fit.csv");
  CHECK(fit.header == "trial,t,phi,phi_sim,residual,band");
  CHECK(fit.texts("phi") == Cells(4, ""));
  CHECK(fit.texts("residual") == Cells(4, ""));
  CHECK(std::abs(fit.numbers("phi_sim").back()) > 1e-3);
}

TEST_CASE("a rig without a torque limit leaves it to the actuator, and the output says so") {
  const Folder f;
  f.write("rig.toml", replaced(read(kRig), "tau_max = 20", "# "));
  const Arguments identify = {"identify", kTrial1, "--rig", "rig.toml"};
  CHECK_THAT(done(f, identify + Arguments{"-o", "a"}).out, Contains("no limit"));
  CHECK_THROWS(toml_number(read(f.at("a/actuator.toml")), "tau_max"));
  CHECK_THAT(done(f, identify + Arguments{"--start", kTable2, "-o", "b"}).out, Contains("20 Nm (actuator)"));
  CHECK(toml_number(read(f.at("b/actuator.toml")), "tau_max") == 20);
}

TEST_CASE("an actuator file is read by the other verbs whatever the trials were called") {
  const Folder f;
  fs::create_directory(f.at("a b"));
  for (const std::string& name :
       {std::string("quote\"d.csv"), std::string("a b/back\\slash.csv"), std::string("gr\xC3\xBC\xC3\x9F.csv")})
    fs::copy_file(kTrial1, f.at(name));
  SECTION("blanks, quotes, backslashes") {
    done(f, {"identify", "quote\"d.csv", "a b/back\\slash.csv", "gr\xC3\xBC\xC3\x9F.csv", "--rig", kRig, "-o", "out"});
  }
  SECTION("the same trial twice") { done(f, {"identify", kTrial1, kTrial1, "--rig", kRig, "-o", "out"}); }
  SECTION("a name that is not UTF-8") {
    fs::copy_file(kTrial1, f.at("gr\xFC\xDF.csv"));
    done(f, {"identify", "gr\xFC\xDF.csv", "--rig", kRig, "-o", "out"});
  }
  done(f, {"simulate", kPaper, "--actuator", "out/actuator.toml", "--hold", "-45", "-o", "landing"});
  CHECK(summary(f, "landing")["peak_acceleration"].get<double>() == Approx(466.17).epsilon(0.02));
}

// ---- simulate

TEST_CASE("simulate writes its files and keys") {
  const Folder f;
  done(f, kSimulate + Arguments{"-o", "out"});
  CHECK(files(f) == std::set<std::string>{"contacts.csv", "report.html", "summary.json", "trajectory.csv"});
  const Json s = summary(f);
  check_keys(s, {"peak_acceleration", "peak_time", "error_estimate", "sensitive", "peaks", "contacts", "end",
                 "energy_residual", "time_s", "provenance"});
  CHECK(s["peak_acceleration"].get<double>() == Approx(466.17).epsilon(1e-4));  // 466 in the paper
  CHECK(s["error_estimate"] < 1e-6);
  CHECK(s["sensitive"] == false);
  CHECK(s["end"] == "rest");
  CHECK(s["energy_residual"] < 1e-6);
  const Arguments order = {"foot", "knee", "hip", "knee", "foot"};  // Fig. 6 of the paper
  REQUIRE(s["contacts"].size() == order.size());
  REQUIRE(s["peaks"].size() == order.size());
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    CHECK(s["contacts"][i]["point"] == order[i]);
    CHECK(s["peaks"][i]["n"] == i + 1);
    CHECK(s["peaks"][i]["contact"] == order[i]);
    CHECK(s["peaks"][i]["t"] >= s["contacts"][i]["t"]);
    largest = std::max(largest, s["peaks"][i]["acceleration"].get<double>());
  }
  CHECK(largest == s["peak_acceleration"].get<double>());
  CHECK(s["peaks"][2]["t"] == s["peak_time"]);

  const Table c = table(f, "out/contacts.csv");
  CHECK(c.header == "point,t_touchdown,t_liftoff,peak_force,peak_acc");
  CHECK(c.texts("point") == order);
  const auto touchdown = c.numbers("t_touchdown"), force = c.numbers("peak_force"), acc = c.numbers("peak_acc");
  const auto liftoff = c.texts("t_liftoff");
  CHECK(increasing(touchdown, false));
  CHECK(std::count(liftoff.begin(), liftoff.end(), "") > 0);  // at rest some point still touches
  for (std::size_t i = 0; i < touchdown.size(); ++i) {
    CHECK(touchdown[i] == s["contacts"][i]["t"].get<double>());
    if (!liftoff[i].empty()) CHECK(std::stod(liftoff[i]) > touchdown[i]);
    CHECK(force[i] > 0);
    CHECK(acc[i] == s["peaks"][i]["acceleration"].get<double>());
  }
}

TEST_CASE("a trajectory has a row every 1/HZ and both limits of each event") {
  const Folder f;
  const double rate = GENERATE(1000.0, 250.0);
  done(f, kSimulate + Arguments{"-o", "out"} +
              (rate == 1000 ? Arguments{} : Arguments{"--rate", "250"}));  // 1000 is the default
  const Json s = summary(f);
  const Table t = table(f, "out/trajectory.csv");
  CHECK(t.header ==
        "t,x_0,y_0,phi_0,phi_1,phi_m,dx_0,dy_0,dphi_0,dphi_1,dphi_m,ddx_0,ddy_0,acc,tau_sea,phi_ref,"
        "f_hip_x,f_hip_y,f_knee_x,f_knee_y,f_foot_x,f_foot_y");
  const auto time = t.numbers("t");
  CHECK(time.front() == 0);
  CHECK(increasing(time, false));
  std::size_t grid = 0, pairs = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (i + 1 < time.size() && time[i + 1] == time[i]) {
      ++pairs, ++i;
      CHECK((i + 1 == time.size() || time[i + 1] > time[i]));  // two, not three
    } else if (std::abs(time[i] - double(grid) / rate) < 1e-12) {
      ++grid;
    } else {
      INFO("a lone row off the grid, t = " << time[i]);
      CHECK(i + 1 == time.size());
    }
  }
  CHECK(double(grid) == Approx(std::floor(s["t_end"].get<double>() * rate) + 1).margin(1.01));
  CHECK(pairs >= s["contacts"].size());

  // At a touchdown the left limit has no force at the point yet; the right one has.
  const auto acc = t.numbers("acc"), ddx = t.numbers("ddx_0"), ddy = t.numbers("ddy_0"), ref = t.numbers("phi_ref");
  for (const Json& contact : s["contacts"]) {
    const std::string point = contact["point"];
    INFO(point << " at " << contact["t"]);
    const auto force = t.numbers("f_" + point + "_y");
    const auto at = std::find(time.begin(), time.end(), contact["t"].get<double>());
    REQUIRE(at != time.end());
    const std::size_t i = std::size_t(at - time.begin());
    REQUIRE(i + 1 < time.size());
    CHECK(time[i + 1] == time[i]);
    CHECK(force[i] == 0);
    CHECK(force[i + 1] > 0);
  }
  double largest = 0, mismatch = 0;
  for (std::size_t i = 0; i < acc.size(); ++i) {
    largest = std::max(largest, acc[i]);
    mismatch = std::max(mismatch, std::abs(acc[i] - std::hypot(ddx[i], ddy[i])) / (1 + acc[i]));
    CHECK(ref[i] == Approx(-M_PI / 4).epsilon(1e-14));
  }
  CHECK(mismatch < 1e-14);
  CHECK(largest == Approx(s["peak_acceleration"].get<double>()).epsilon(1e-9));  // it stands at the hip's touchdown
}

TEST_CASE("a landing that is refused is exit 1, with its reason, what was computed is kept and marked") {
  const Folder f;
  f.write("rock.toml", replaced(read(kPaper), "6880", "1e30"));
  const Result r = run({"simulate", "rock.toml", "--actuator", kTable2, "--hold", "-45", "-o", "out"}, f.at(""));
  CHECK(r.code == 1);
  CHECK_THAT(r.err, Contains("refused") && Contains(" at t = 0.28"));
  CHECK(files(f) == std::set<std::string>{"contacts.csv", "report.html", "summary.json", "trajectory.csv"});
  const Json s = summary(f);
  CHECK(s["end"] == "failed");
  CHECK_THAT(s["warnings"].at(0).get<std::string>(), Contains("refused"));
}

TEST_CASE("a prediction that diverges is exit 1, and no residual is made up for it") {
  const Folder f;
  f.write("wild.toml", "[actuator]\nname = \"wild\"\nk_p = 5000\nk_d = 0\nk_sea = 65\nc_sea = 0\ni_motor = 0.001\n");
  f.write("rig.toml", replaced(read(kRig), "tau_max = 20", "# "));
  const Result r = run({"predict", kTrial1, "--rig", "rig.toml", "--actuator", "wild.toml", "-o", "out"}, f.at(""));
  CHECK(r.code == 1);
  CHECK_THAT(r.err, Contains("trial_1.csv"));
  const Json s = summary(f);
  CHECK(s["converged"] == false);
  CHECK(s["rms"].is_null());
  CHECK(s["trials"][0]["rms"].is_null());
}

// ---- optimize

TEST_CASE("optimize writes its files and keys, and its motion does what the summary says") {
  const Folder f;
  done(f, kOptimize + Arguments{"-o", "out", "--rate", "500"});
  CHECK(files(f) == std::set<std::string>{"motion.csv", "motion.toml", "progress.csv", "report.html", "solvers.csv",
                                          "summary.json"});
  const Json s = summary(f);
  check_keys(s, {"motion", "peak_acceleration", "tolerant_peak", "contacts", "hold", "reduction", "ratings",
                 "evaluations", "solver", "time_s", "seed", "provenance"});
  check_keys(s["motion"], {"phi_i_deg", "phi_f_deg", "duration"});
  check_keys(s["hold"], {"phi_deg", "peak_acceleration", "peak", "tolerant_peak", "within_limits"});
  const double peak = s["peak_acceleration"], held = s["hold"]["peak_acceleration"], duration = s["motion"]["duration"];
  CHECK(held < 466.17);  // at -45 deg
  CHECK(peak < held);
  CHECK(s["tolerant_peak"].get<double>() >= peak);
  CHECK(s["reduction"].get<double>() == Approx(1 - peak / held).epsilon(1e-12));
  CHECK(s["evaluations"] <= 600);
  CHECK(s["seed"] == 1);
  CHECK(s["solver"].is_string());
  CHECK(s["ratings"]["tau_max"] == 20);
  for (const char* key : {"phi_i_deg", "phi_f_deg"}) {
    CHECK(s["motion"][key] >= -90.0 - 1e-12);
    CHECK(s["motion"][key] <= 1e-12);
  }
  CHECK(duration >= 0.1);
  CHECK(duration <= 1.0);

  const Table m = table(f, "out/motion.csv");
  CHECK(m.header == "t,phi_ref,dphi_ref");
  CHECK_THAT(m.comments, Contains("t = 0 at the detected first touchdown"));
  const auto t = m.numbers("t"), phi = m.numbers("phi_ref"), rate = m.numbers("dphi_ref");
  CHECK(t.front() == 0);
  CHECK(t.back() == duration);
  CHECK(increasing(t, true));
  for (std::size_t i = 0; i + 1 < t.size(); ++i) CHECK(t[i] == Approx(double(i) / 500).margin(1e-12));
  CHECK(phi.front() * 180 / M_PI == Approx(s["motion"]["phi_i_deg"].get<double>()).margin(1e-10));
  CHECK(phi.back() * 180 / M_PI == Approx(s["motion"]["phi_f_deg"].get<double>()).margin(1e-10));
  CHECK(rate.front() == Approx(0).margin(1e-12));
  CHECK(rate.back() == Approx(0).margin(1e-12));
  CHECK(*std::max_element(rate.begin(), rate.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) != 0);

  const Table solvers = table(f, "out/solvers.csv");
  CHECK(solvers.header == "solver,evaluations,time_s,best");
  REQUIRE(solvers.rows.size() == 1);
  CHECK(solvers.numbers("best")[0] == peak);

  // Played back, the motion file gives the same peak and the same contacts.
  const std::string motion = read(f.at("out/motion.toml"));
  CHECK(toml_number(motion, "duration") == duration);
  done(f, {"simulate", kPaper, "--actuator", kTable2, "--motion", "out/motion.toml", "-o", "played"});
  const Json played = summary(f, "played");
  CHECK(played["peak_acceleration"].get<double>() == Approx(peak).epsilon(1e-6));
  CHECK(played["contacts"].size() == s["contacts"].size());
}

TEST_CASE("optimize: bumps, landing gains and the move in the air are written, read back and told") {
  const Folder f;
  done(f, {"optimize", kPaper, "--actuator", kTable2, "--bumps", "2", "--landing-gains", "0.5:2", "--release-phi",
           "-45", "--release-from", "0.1", "--evaluations", "600", "-o", "out"});
  const Json s = summary(f);
  CHECK(s["motion"]["bumps_deg"].size() == 4);
  check_keys(s["motion"], {"gain_p", "gain_d", "reposition"});
  CHECK(s["motion"]["reposition"]["phi_deg"].get<double>() == Approx(-45));
  check_keys(s["limit"], {"jump", "first_contact"});
  const Table m = table(f, "out/motion.csv");
  CHECK_THAT(m.comments, Contains("Rows with t < 0 are the move in the air"));
  CHECK_THAT(m.comments, Contains("From t = 0 on K_p times"));
  const auto t = m.numbers("t"), phi = m.numbers("phi_ref");
  CHECK(t.front() < -0.1);
  CHECK(increasing(t, true));
  CHECK(phi.front() * 180 / M_PI == Approx(-45));
  for (std::size_t i = 1; i < phi.size(); ++i) CHECK(std::abs(phi[i] - phi[i - 1]) < 0.2);
  done(f, {"simulate", kPaper, "--actuator", kTable2, "--motion", "out/motion.toml", "-o", "played"});
  CHECK(summary(f, "played")["peak_acceleration"].get<double>() ==
        Approx(s["peak_acceleration"].get<double>()).epsilon(1e-6));
}

TEST_CASE("ratings: a faster motor lands no harder") {
  const Folder f;
  done(f, {"ratings", kPaper, "--actuator", kTable2, "--motor-speed", "3:9:3", "--evaluations", "300", "-o", "out"});
  CHECK(files(f) == std::set<std::string>{"ratings.csv", "report.html", "summary.json"});
  const Table r = table(f, "out/ratings.csv");
  const auto speed = r.numbers("motor_speed"), peak = r.numbers("peak"), tolerant = r.numbers("tolerant_peak");
  REQUIRE(speed == std::vector<double>{3, 6, 9});
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(tolerant[i] >= peak[i]);
    if (i > 0) CHECK(peak[i] <= peak[i - 1]);
    if (i > 0) CHECK(tolerant[i] <= tolerant[i - 1]);
  }
}

namespace {
const std::string kQuintic = "[motion]\nphi_i_deg = -24.4\nphi_f_deg = -85\nduration = 0.261\n";
}  // namespace

TEST_CASE("risk writes its files and keys, and its drops are replayed to their peaks") {
  const Folder f;
  f.write("motion.toml", kQuintic);
  const Arguments paper = {kPaper, "--actuator", kTable2, "--motion", "motion.toml"};
  const Result r = done(f, Arguments{"risk"} + paper + Arguments{"--samples", "500", "--forbid", "hip", "-o", "out"});
  CHECK(files(f) == std::set<std::string>{"histogram.csv", "report.html", "risk.csv", "sobol.csv", "summary.json"});
  CHECK_THAT(r.out, Contains("What matters most: pitch") && Contains("below holding's"));
  const Json s = summary(f);
  for (const char* which : {"peak", "held"}) {
    check_keys(s[which], {"mean", "mean_std", "median", "q90", "q99", "cvar90", "max", "samples"});
    CHECK(s[which]["samples"] == 500);
  }
  CHECK(s["peak"]["mean"].get<double>() == Approx(215).epsilon(0.02));
  CHECK(s["held"]["mean"].get<double>() == Approx(464).epsilon(0.02));
  CHECK(s["scatter"] == "pitch_deg=1,height=0.01,forward_speed=0.03");
  CHECK(s["scatter_assumed"] == true);
  CHECK(warned(s, "is assumed"));
  CHECK(s["failed"] == 0);
  check_keys(s["forbidden"]["hip"], {"drops", "share"});
  check_keys(s["ratings"], {"speed_max", "motor_torque_max"});
  check_keys(s["contacts"][0], {"contact", "point", "drops", "share"});
  check_keys(s["sobol"], {"pitch", "height", "forward_speed"});
  check_keys(s["sobol"]["pitch"], {"first", "first_ci95", "total", "total_ci95"});
  CHECK(table(f, "out/sobol.csv").header == "name,first,first_low,first_high,total,total_low,total_high");

  const Table bins = table(f, "out/histogram.csv");
  CHECK(bins.header == "lower,upper,count,count_held");
  const auto counts = bins.numbers("count");
  CHECK(std::accumulate(counts.begin(), counts.end(), 0.0) == 500);

  const Table worst = table(f, "out/risk.csv");
  CHECK(worst.header == "row,peak,height,forward_speed,pitch_deg");
  REQUIRE(worst.rows.size() == 100);
  CHECK(worst.numbers("peak")[0] == s["peak"]["max"]);
  for (const int row : {1, 50, 100}) {
    done(f, Arguments{"simulate"} + paper +
                Arguments{"--drop-from", "out/risk.csv:" + std::to_string(row), "-o", "replayed"});
    CHECK(summary(f, "replayed")["peak_acceleration"].get<double>() ==
          Approx(worst.numbers("peak")[std::size_t(row - 1)]).epsilon(1e-3));
  }
  // The worst drops as if they had been measured.
  done(f, Arguments{"risk"} + paper + Arguments{"--drops", "out/risk.csv", "-o", "measured"});
  const Json again = summary(f, "measured");
  CHECK(again["peak"]["samples"] == 100);
  CHECK(again["peak"]["max"].get<double>() == Approx(s["peak"]["max"].get<double>()).epsilon(1e-3));
  CHECK(again["scatter"].is_null());
  CHECK(again["sobol"].empty());
}

TEST_CASE("risk: where nothing scatters every quantile is the nominal peak, and it says so") {
  const Folder f;
  const Arguments hold = {kPaper, "--actuator", kTable2, "--hold", "-50"};
  const Result r = done(f, Arguments{"risk"} + hold + Arguments{"--scatter", "pitch_deg=0", "-o", "out"});
  CHECK_THAT(r.out, Contains("Nothing scatters"));
  done(f, Arguments{"simulate"} + hold + Arguments{"-o", "nominal"});
  const double nominal = summary(f, "nominal")["peak_acceleration"];
  const Json s = summary(f);
  for (const char* key : {"mean", "median", "q90", "q99", "cvar90", "max"}) {
    INFO(key);
    CHECK(s["peak"][key].get<double>() == Approx(nominal).epsilon(1e-3));
  }
  CHECK(s["scatter"] == "");
  CHECK(s["scatter_assumed"] == false);
  CHECK(s["sobol"].empty());
}

TEST_CASE(
    "risk: the scene's scatter, the actuator's and that of the execution, and a warning where holding is better") {
  const Folder f;
  f.write("motion.toml", "[motion]\nphi_i_deg = 0\nphi_f_deg = -90\nduration = 0.9\n");
  const std::string scene = f.write("scene.toml", read(kPaper) + "\n[scatter]\npitch_deg = 0.5\nstiffness = \"10%\"\n");
  const std::string actuator =
      f.write("actuator.toml",
              read(kTable2) + "\n[uncertainty]\norder = [\"k_p\", \"k_sea\"]\ncovariance = [[1, 0.5], [0.5, 4]]\n");
  done(f, {"risk", scene, "--actuator", actuator, "--motion", "motion.toml", "--inflate", "2", "--inexact", "--samples",
           "300", "-o", "out"});
  const Json s = summary(f);
  CHECK(s["scatter"] == "pitch_deg=0.5,stiffness=10%");
  CHECK(s["scatter_assumed"] == false);
  check_keys(s["sobol"], {"pitch", "stiffness", "actuator", "execution"});
  CHECK(table(f, "out/risk.csv").header ==
        "row,peak,pitch_deg,stiffness,k_p,k_sea,phi_i_off_deg,phi_f_off_deg,duration_off");
  const bool worse = s["peak"]["cvar90"].get<double>() > s["held"]["cvar90"].get<double>();
  CHECK(warned(s, "is worse than that of the reference held at -45 deg") == worse);
  CHECK(worse);
}

TEST_CASE("risk: drops that cannot be followed are told and left out") {
  const Folder f;
  f.write("drops.csv", "height,stiffness\n0.4,6880\n0.4,1e25\n0.3,6880\n");
  done(f, {"risk", kPaper, "--actuator", kTable2, "--hold", "-50", "--drops", "drops.csv", "-o", "out"});
  CHECK(summary(f)["failed"] == 1);
  CHECK(summary(f)["peak"]["samples"] == 2);
  CHECK(warned(summary(f), "1 of 3 drops could not be followed"));
  const std::string untouched =
      f.write("untouched.toml", replaced(read(kPaper), "contacts = [\"hip\", \"knee\", \"foot\"]", "contacts = []"));
  CHECK(run({"risk", untouched, "--actuator", kTable2, "--hold", "-50", "--samples", "100", "-o", "none"}, f.at(""))
            .code == 1);
  CHECK(files(f, "none") == std::set<std::string>{"summary.json"});
  CHECK(summary(f, "none")["peak"]["mean"].is_null());
}

TEST_CASE("risk: the same bytes with any number of threads") {
  const Folder f;
  check_threads(
      {"risk", kPaper, "--actuator", kTable2, "--motion", f.write("motion.toml", kQuintic), "--samples", "3000"},
      {"2", "7"});
}

TEST_CASE("joint stops: refused by the search, told by simulate") {
  const Folder f;
  const std::string scene = f.write("stops.toml", read(kPaper) + "\n[joint]\nphi_deg = [-60, -10]\n");
  done(f, {"optimize", scene, "--actuator", kTable2, "--evaluations", "600", "-o", "out"});
  const Json ratings = summary(f)["ratings"];
  CHECK(ratings["phi_1_deg"][0].get<double>() >= -60);
  CHECK(ratings["phi_1_deg"][1].get<double>() <= -10);
  const Result r = done(f, {"simulate", scene, "--actuator", kTable2, "--hold", "-59", "-o", "held"});
  CHECK_THAT(r.err, Contains("the joint leaves its stops"));
}

TEST_CASE("optimize warns where the robot could not follow") {
  const Folder f;
  const std::string slow = f.write("slow.toml", replaced(read(kNominal), "speed_max = 3.14", "speed_max = 0.14"));
  const Result r = done(f, {"optimize", kPaper, "--actuator", slow, "--evaluations", "200", "-o", "out", "--quiet"});
  CHECK_THAT(r.err, Contains("could not follow") && Contains("0.14 rad/s"));
  CHECK(summary(f)["ratings"]["speed_max"] == 0.14);
}

// ---- compare

TEST_CASE("compare tells the constants apart, and with trials and a scene what that means") {
  const Folder f;
  done(f, kIdentify + Arguments{"-o", "fit"});
  const Arguments compare = {"compare", "--nominal", kNominal, "--identified", "fit/actuator.toml"};
  const Json fit = summary(f, "fit");
  const auto check_parameters = [&](const Json& s) {
    REQUIRE(s["parameters"].size() == kConstants.size());
    for (const std::string& name : kConstants) {
      INFO(name);
      const Json& p = s["parameters"][name];
      check_keys(p, {"nominal", "identified", "difference", "z", "inside_ci95"});
      const double nominal = p["nominal"], identified = p["identified"], std = fit["parameters"][name]["std"];
      CHECK(nominal == toml_number(read(kNominal), name));
      CHECK(identified == fit["parameters"][name]["value"].get<double>());
      CHECK(p["difference"].get<double>() == Approx(identified - nominal).epsilon(1e-12));
      CHECK(p["z"].get<double>() == Approx((identified - nominal) / std).epsilon(1e-9));
      CHECK(p["inside_ci95"] == false);
    }
    CHECK(table(f, "out/parameters.csv").texts("parameter") == kConstants);
  };
  SECTION("the constants alone") {
    done(f, compare + Arguments{"-o", "out"});
    CHECK(files(f) == std::set<std::string>{"parameters.csv", "report.html", "summary.json"});
    check_parameters(summary(f));
  }
  SECTION("a constant that was not fitted has no interval to be inside of") {
    done(f, {"compare", "--nominal", kNominal, "--identified", kTable2, "-o", "out"});
    const Json p = summary(f)["parameters"]["k_p"];
    CHECK(p["difference"] == -10);
    CHECK(p["z"].is_null());
    CHECK(p["inside_ci95"].is_null());
  }
  SECTION("the truth is inside most intervals") {
    done(f, {"compare", "--nominal", kTable2, "--identified", "fit/actuator.toml", "-o", "out"});
    const Json parameters = summary(f)["parameters"];
    for (const auto& [name, p] : parameters.items()) {
      INFO(name);
      const Json& ci = fit["parameters"][name]["ci95"];
      CHECK(p["inside_ci95"] == (ci[0] <= p["nominal"] && p["nominal"] <= ci[1]));
    }
  }
  SECTION("trials") {
    done(f, compare + Arguments{"--trials", kTrial1, kTrial9, "--rig", kRig, "-o", "out"});
    const Json s = summary(f);
    check_parameters(s);
    REQUIRE(s["residuals"].size() == 2);
    CHECK(s["residuals"][0]["file"] == kTrial1);
    CHECK(s["residuals"][0]["identified"] == fit["trials"][0]["rms"]);
    CHECK(s["residuals"][1]["file"] == kTrial9);
    CHECK(s["residuals"][1]["identified"].get<double>() == Approx(5e-4).epsilon(0.1));
    CHECK(s["residuals"][1]["nominal"] > 5e-3);
  }
  SECTION("a scene") {
    done(f, compare + Arguments{"--scene", short_scene(f), "-o", "out"});
    const Json s = summary(f);
    check_parameters(s);
    const Json& p = s["peaks"];
    for (const char* motion : {"nominal_motion", "identified_motion"})
      for (const char* actuator : {"nominal", "identified"}) CHECK(p[motion][actuator] > 9.8);
    // Under its own actuator a best motion is the best of the two.
    CHECK(p["nominal_motion"]["nominal"] <= p["identified_motion"]["nominal"]);
    CHECK(p["identified_motion"]["identified"] <= p["nominal_motion"]["identified"]);
    CHECK_THAT(read(f.at("out/report.html")), Contains("<svg"));
  }
}

// ---- the common options

TEST_CASE("option --json: stdout carries one JSON object, the summary, and nothing else") {
  const Folder f;
  const std::vector<Arguments> commands = {kIdentify,
                                           kSimulate,
                                           {"predict", kTrial9, "--rig", kRig, "--actuator", kTable2},
                                           {"optimize", kPaper, "--actuator", kTable2, "--evaluations", "50"},
                                           {"compare", "--nominal", kNominal, "--identified", kTable2}};
  for (const Arguments& c : commands) {
    INFO(c[0]);
    const Result r = done(f, c + Arguments{"--json", "-o", c[0]});
    Json j;
    REQUIRE_NOTHROW(j = Json::parse(r.out));
    CHECK(j.is_object());
    CHECK(j == summary(f, c[0]));
  }
}

TEST_CASE("option --json: a failure tells its summary too") {
  const Folder f;
  f.write("rock.toml", replaced(read(kPaper), "6880", "1e30"));
  const Result r = run({"simulate", "rock.toml", "--actuator", kTable2, "--hold", "-45", "--json"}, f.at(""));
  CHECK(r.code == 1);
  REQUIRE(Json::accept(r.out));
  CHECK(Json::parse(r.out)["end"] == "failed");
  CHECK_THAT(r.err, Contains("warning"));
}

TEST_CASE("optimize: both objectives, limits, a deadline, and every solver side by side") {
  const Folder f;
  const Arguments base = {"optimize", kPaper, "--actuator", kTable2};
  done(f, base + Arguments{"--objective", "tolerant", "--evaluations", "300", "-o", "tolerant"});
  const Json t = summary(f, "tolerant");
  CHECK(t["objective"] == "tolerant");
  CHECK(t["tolerant_peak"].get<double>() < 260);
  CHECK(t["evaluations"] == 300);
  CHECK(t["landings"].get<long>() > 300);

  done(f, base + Arguments{"--respect-ratings", "--evaluations", "2000", "-o", "rated"});
  const Json r = summary(f, "rated")["ratings"];
  CHECK(r["peak_reference_rate"].get<double>() <= 3.14);
  CHECK(r["motor_speed"].get<double>() <= 3.14 * 1.01);  // limits are kept where steps end
  CHECK(r["motor_torque"].get<double>() <= 20 * 1.01);

  done(f, base + Arguments{"--forbid", "hip", "--evaluations", "2000", "-o", "off"});
  const Json off = summary(f, "off")["contacts"];
  for (const Json& c : off) CHECK(c["point"] != "hip");

  done(f, base + Arguments{"--deadline", "0.2", "-o", "soon"});
  CHECK(summary(f, "soon")["peak_acceleration"].get<double>() < 466);

  done(f, base + Arguments{"--solver", "compare", "--evaluations", "60", "-o", "all"});
  const Table all = table(f, "all/solvers.csv");
  CHECK(all.rows.size() == 16);
  const std::vector<double> best = all.numbers("best");
  CHECK(summary(f, "all")["peak_acceleration"].get<double>() ==
        Approx(*std::min_element(best.begin(), best.end())).epsilon(1e-9));

  const Result none =
      run(base + Arguments{"--forbid", "hip,knee,foot", "--evaluations", "200", "-o", "none"}, f.at(""));
  CHECK(none.code == 1);
  CHECK_THAT(none.err, Contains("no motion of the search range was found that keeps the limits"));
  CHECK(summary(f, "none")["motion"].is_null());
  done(f, base + Arguments{"--evaluations", "1", "-o", "one"});
  CHECK(summary(f, "one")["evaluations"] == 1);
}

namespace {
/// The paper's scene on a floor where one landing takes tens of thousands of steps.
std::string stiff_floor(const Folder& f) {
  return f.write("stiff.toml", replaced(read(kPaper), "stiffness = 6880", "stiffness = 1e9"));
}
}  // namespace

TEST_CASE(
    "optimize --deadline: the answer is there in time, evidence is left out unless asked for, and its time said") {
  const Folder f;
  const Arguments paper = {"optimize", kPaper, "--actuator", kTable2, "--no-report", "--quiet", "--deadline", "1"};
  done(f, paper + Arguments{"-o", "soon"});
  const Json soon = summary(f, "soon");
  CHECK_FALSE(soon.contains("evidence"));
  CHECK(soon["tolerant_sampled"]["samples"] == 0);
  CHECK(soon["tolerant_sampled"]["worst"].is_null());
  CHECK(soon["verified"] == true);
  done(f, paper + Arguments{"--evidence", "-o", "asked"});
  const Json asked = summary(f, "asked");
  CHECK(asked["evidence"]["complete"] == true);
  CHECK(asked["evidence"]["time_s"] > 0);
  CHECK(asked["tolerant_sampled"]["samples"] == 2000);
  // A stiff floor: an answer or the reason for none, by a deadline that any landing of it may exceed. What other
  // programs take of the machine is allowed for; a landing alone took 10 s and more.
  const std::string stiff = stiff_floor(f);
  for (const char* deadline : {"0.05", "0.3"}) {
    const Result r =
        run({"optimize", stiff, "--actuator", kTable2, "--no-report", "--deadline", deadline, "-o", "stiff"}, f.at(""));
    const Json s = summary(f, "stiff");
    INFO(deadline << " s: " << s["time_s"] << " s; " << r.err);
    CHECK(s["time_s"].get<double>() < std::stod(deadline) + 1);
    if (r.code == 1) CHECK_THAT(r.err, Contains("no motion could be followed in the"));
  }
}

TEST_CASE("optimize: however short the deadline, a posture to hold is the answer, with its peak") {
  const Folder f;
  for (const char* goal : {"peak", "tolerant"})
    for (const char* deadline : {"0.001", "0.003", "0.01"}) {
      const Result r = done(f, {"optimize", kPaper, "--actuator", kTable2, "--no-report", "--objective", goal,
                                "--deadline", deadline, "-o", "soon"});
      CHECK_THAT(r.out, !Contains("nan"));
      const Json s = summary(f, "soon");
      CHECK((s["contacts"].is_null() == Contains("its landing was not played").match(r.out)));
      INFO(goal << ", " << deadline << " s: " << s.dump());
      // -45 deg held, to a search's accuracy: 466.2, within its execution box 468.0.
      if (goal == std::string("peak"))
        CHECK(s["peak_acceleration"].get<double>() < 1.01 * 466.2);
      else
        CHECK(s["tolerant_peak"].get<double>() < 1.01 * 468.0);
    }
}

TEST_CASE("optimize: a search of very long landings ends at its bound of work and says so") {
  const Folder f;
  const std::string jammed = f.write("jammed.toml", replaced(read(kTable2), "c_sea = 1.6", "c_sea = 1e9"));
  const Result none =
      run({"optimize", kPaper, "--actuator", jammed, "--evaluations", "200", "--no-report", "-o", "none"}, f.at(""));
  CHECK(none.code == 1);
  CHECK_THAT(none.err, Contains("could be followed") && Contains("ended at its bound of work"));
  const Result stiff =
      done(f, {"optimize", stiff_floor(f), "--actuator", kTable2, "--evaluations", "40", "--no-report", "-o", "stiff"});
  CHECK_THAT(stiff.err, Contains("evidence is left out; --evidence plays it"));
  CHECK(summary(f, "stiff")["evidence"]["complete"] == false);
  CHECK(summary(f, "stiff")["evidence"]["one_degree"].is_null());
}

TEST_CASE(
    "optimize, map, risk, compare, calibrate, demo: Ctrl-C ends them soon, and what is finished is kept and marked") {
  const Folder f;
  const std::vector<std::pair<std::string, Arguments>> verbs = {
      {"optimize", {kPaper, "--actuator", kTable2, "--evaluations", "4000000"}},
      {"optimize", {stiff_floor(f), "--actuator", kTable2, "--evaluations", "4000000"}},
      {"map", {kPaper, "--actuator", kTable2}},
      {"risk", {kPaper, "--actuator", kTable2, "--hold", "-45", "--samples", "1000000"}},
      {"compare", {"--nominal", kNominal, "--identified", kTable2, "--scene", kPaper}},
      {"demo", {}}};
  for (const auto& [verb, arguments] : verbs) {
    INFO(verb);
    Interrupted r;
    double wait = 0.7;
    do {  // again where a busy machine had not yet started the program when the signal came
      r = interrupted_after(wait, Arguments{verb} + arguments + Arguments{"--no-report", "-o", "out"}, f.at(""));
      wait *= 2;
    } while (r.err.empty() && wait < 6);
    CHECK(r.code == 130);
    CHECK_THAT(r.err, Contains("interrupted"));
    CHECK(r.seconds < wait / 2 + 2.3);  // 0.5 s after the signal on a machine of its own
    if (verb != "demo") CHECK(summary(f)["interrupted"] == true);
  }
}

TEST_CASE("optimize --respect-ratings needs both ratings, --forbid is checked where the robot is not exact") {
  const Folder f;
  const std::string table2 = read(kTable2);
  const auto refused = [&](const std::string& from, const std::string& missing) {
    const std::string actuator = f.write("unrated.toml", replaced(table2, from, ""));
    const Result r = run({"optimize", kPaper, "--actuator", actuator, "--respect-ratings", "-o", "bad"}, f.at(""));
    CHECK(r.code == 2);
    CHECK_THAT(r.err, Contains("respect-ratings: ") && Contains("gives no " + missing) &&
                          Contains("both speed_max and motor_torque_max are needed"));
    CHECK(!fs::exists(f.at("bad")));
  };
  refused("speed_max = 3.14", "speed_max");
  refused("motor_torque_max = 20", "motor_torque_max");
  CHECK_THAT(run({"optimize", kPaper, "--actuator", f.at("unrated.toml"), "--respect-ratings"}, f.at("")).err,
             Contains("its tau_max = 20 limits the spring: motor_torque_max = 20, if that is the motor's"));

  // Held at the middle of the range the hip touches in every drop: that is no way out.
  const Result off =
      done(f, {"optimize", kPaper, "--actuator", kTable2, "--forbid", "hip", "--evaluations", "2000", "-o", "off"});
  CHECK_THAT(off.out, Contains("held at -45 deg: mean 1000"));
  const Json s = summary(f, "off"), hip = s["forbidden"]["hip"];
  CHECK(hip["of"] == 15);
  CHECK(hip["samples"] == 2000);
  bool warned = false;
  for (const auto& w : s["warnings"])
    warned = warned || w.get<std::string>().find("--forbid holds for the exact motion alone") != std::string::npos;
  CHECK(warned == (hip["box"].get<int>() + hip["sampled"].get<int>() > 0));
  done(f, {"optimize", kPaper, "--actuator", kTable2, "--forbid", "hip", "--objective", "tolerant", "--evaluations",
           "1000", "-o", "tolerant"});
  CHECK(summary(f, "tolerant")["forbidden"]["hip"]["box"] == 0);
}

TEST_CASE("optimize warns of a pitch off by 1 deg and of the floor's damping, beside the held reference") {
  const Folder f;
  const Result r = done(f, {"optimize", kPaper, "--actuator", kTable2, "--objective", "tolerant", "-o", "out"});
  const Json e = summary(f)["evidence"];
  const double off = e["pitch_one_degree"];
  CHECK_THAT(r.err, Contains(fmt::format("{:.4g} with the pitch off by 1 deg", off)) &&
                        Contains("the floor's damping off by 10 %") && Contains("; held at -33.7 deg it is 216.6"));
  // The motion, played at either pitch.
  double worst = 0;
  for (const char* pitch : {"pitch_deg = 17.0", "pitch_deg = 19.0"}) {
    f.write("off.toml", replaced(read(kPaper), "pitch_deg = 18.0", pitch));
    done(f, {"simulate", "off.toml", "--actuator", kTable2, "--motion", "out/motion.toml", "-o", "off"});
    worst = std::max(worst, Json::parse(read(f.at("off/summary.json")))["peak_acceleration"].get<double>());
  }
  CHECK(off == Approx(worst).epsilon(1e-3));
  CHECK(e["damping_ten_percent"] > 188);
  CHECK_THAT(read(f.at("out/report.html")), Contains("the pitch off by 1 deg"));
}

TEST_CASE("map writes the grid, its basins and what they are worth") {
  const Folder f;
  done(f, {"map", kPaper, "--actuator", kTable2, "--grid", "8,7,5", "--polish", "3", "-o", "out"});
  CHECK(files(f) == std::set<std::string>{"basins.csv", "map.csv", "report.html", "summary.json"});
  const Table grid = table(f, "out/map.csv");
  CHECK(grid.rows.size() == 8 * 7 * 5);
  CHECK(grid.header == "phi_i_deg,phi_f_deg,duration,peak,peak_contact,contacts");
  const std::vector<double> peaks = grid.numbers("peak"), contact = grid.numbers("peak_contact");
  const Cells contacts = grid.texts("contacts");
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    CHECK(contact[i] >= 1);
    CHECK(contact[i] <= double(contacts[i].size()));
  }
  const Json s = summary(f);
  check_keys(s, {"grid", "landings", "failed", "map_time_s", "basins", "provenance"});
  REQUIRE(s["basins"].size() >= 1);
  double last = 0;
  for (const Json& b : s["basins"]) {
    const double peak = b["peak_acceleration"];
    CHECK(peak >= last);
    CHECK(b["tolerant_peak"].get<double>() >= peak);
    for (const char* off : {"one_degree", "ten_milliseconds", "one_centimetre"})
      CHECK(b[off].get<double>() >= 0.9 * peak);
    last = peak;
  }
  CHECK(s["basins"][0]["peak_acceleration"].get<double>() <= *std::min_element(peaks.begin(), peaks.end()));
  CHECK(run({"map", kPaper, "--actuator", kTable2, "--grid", "8,7", "-o", "bad"}, f.at("")).code == 2);
  CHECK(run({"map", kPaper, "--actuator", kTable2, "--grid", "8,1,5", "-o", "bad"}, f.at("")).code == 2);
  CHECK(!fs::exists(f.at("bad")));
}

TEST_CASE("option --quiet: nothing on stderr but warnings, --no-report: no report") {
  const Folder f;
  const std::vector<Arguments> commands = {{"identify", kTrial1, "--rig", kRig},
                                           {"predict", kTrial9, "--rig", kRig, "--actuator", kTable2},
                                           kSimulate,
                                           {"compare", "--nominal", kNominal, "--identified", kTable2}};
  for (const Arguments& c : commands) {
    INFO(c[0]);
    CHECK(done(f, c + Arguments{"-o", "loud"}).err != "");
    CHECK(done(f, c + Arguments{"--quiet", "--no-report", "-o", c[0]}).err == "");
    CHECK(files(f, c[0]).count("report.html") == 0);
    CHECK(files(f, c[0]).count("summary.json") == 1);
  }
  const Result r = done(f, kOptimize + Arguments{"--quiet", "--no-report", "-o", "optimize"});
  std::istringstream lines(r.err);
  for (std::string line; std::getline(lines, line);) CHECK_THAT(line, Contains("warning"));
  CHECK(files(f, "optimize") ==
        std::set<std::string>{"motion.csv", "motion.toml", "progress.csv", "solvers.csv", "summary.json"});
}

TEST_CASE("without -o the results are in ./ukemi-out/VERB of the working directory") {
  const Folder f;
  fs::create_directory(f.at("data"));
  fs::create_directory(f.at("work"));
  fs::copy_file(kTrial1, f.at("data/trial.csv"));
  fs::copy_file(kRig, f.at("data/rig.toml"));
  const Result r = run({"identify", "../data/trial.csv", "--rig", "../data/rig.toml"}, f.at("work"));
  REQUIRE(r.code == 0);
  CHECK(files(f, "work/ukemi-out") == std::set<std::string>{"identify", "identify/actuator.toml", "identify/fit.csv",
                                                            "identify/report.html", "identify/summary.json"});
  CHECK(summary(f, "work/ukemi-out/identify")["trials"][0]["file"] == "../data/trial.csv");
  CHECK(files(f, "data").size() == 2);  // nothing beside the inputs
}

TEST_CASE("the same inputs and seed give the same bytes with any number of threads") {
  SECTION("identify") { check_threads(kIdentify); }
  SECTION("simulate") { check_threads(kSimulate); }
  SECTION("optimize") { check_threads(kOptimize); }
  SECTION("optimize --robust") {
    check_threads({"optimize", kPaper, "--actuator", kTable2, "--robust", "cvar", "--evaluations", "8000"});
  }
  SECTION("compare") {
    const Folder f;
    check_threads({"compare", "--nominal", kNominal, "--identified", kTable2, "--scene", short_scene(f)});
  }
}

TEST_CASE("optimize tells the motion under scatter, and what a robust plan promises") {
  const Folder f;
  const Result r = done(f, {"optimize", kPaper, "--actuator", kTable2, "--robust", "quantile:0.8", "--evaluations",
                            "10000", "-o", "robust"});
  CHECK_THAT(r.out,
             Contains("under scatter (pitch_deg=1,height=0.01,forward_speed=0.03; assumed; 10000 fresh drops)") &&
                 Contains("held at -45 deg: mean 464") && Contains("promised"));
  const Json robust = summary(f, "robust")["robust"], scatter = summary(f, "robust")["scatter"];
  CHECK(robust["measure"] == "quantile:0.8");
  CHECK(robust["fresh"]["samples"] == 10'000);
  CHECK(robust["optimism"] == Approx(robust["fresh"]["measured"].get<double>() / robust["promised"].get<double>() - 1));
  CHECK(scatter["assumed"] == true);
  CHECK(scatter["planned"]["mean"] == robust["fresh"]["mean"]);
  CHECK(scatter["held"]["cvar90"] > scatter["best_posture"]["mean"]);

  // A plan for the one drop is worse, in the worst tenth, than doing nothing: the program says so.
  const Result plain = done(f, {"optimize", kPaper, "--actuator", kTable2, "--evaluations", "4000", "-o", "plain"});
  CHECK_THAT(plain.err, Contains("doing nothing is safer"));
  CHECK(!summary(f, "plain").contains("robust"));

  // Nothing scatters: the plan for the scene's own drop, to the last digit.
  done(f, kOptimize + Arguments{"-o", "one_drop"});
  const Result still = done(f, kOptimize + Arguments{"--robust", "mean", "--scatter", "height=0", "-o", "still"});
  CHECK_THAT(still.out, Contains("nothing scatters"));
  CHECK(summary(f, "still")["motion"] == summary(f, "one_drop")["motion"]);
}

TEST_CASE("every output carries its provenance: version, command, seed, time, a checksum of each input") {
  const Folder f;
  const auto check = [&](const Arguments& command, const Arguments& inputs) {
    done(f, command + Arguments{"--seed", "7", "-o", command[0]});
    const Json p = summary(f, command[0])["provenance"];
    CHECK(p["seed"] == "7");
    CHECK_THAT(p["command"].get<std::string>(), Contains("ukemi " + command[0]) && Contains("--seed 7"));
    for (const auto& [name, text] : f.content(command[0])) {
      INFO(command[0] << "/" << name);
      const auto carries = [bytes = text](const std::string& what) { return bytes.find(what) != std::string::npos; };
      CHECK(carries("ukemi 0."));
      CHECK(carries("--seed 7"));
      CHECK(carries(p["time"].get<std::string>().substr(0, 10)));
      for (const std::string& input : inputs) {
        INFO(input);
        REQUIRE(p.contains("checksum " + input));
        CHECK(carries("checksum " + input));
        CHECK(carries(p["checksum " + input].get<std::string>()));
      }
    }
  };
  SECTION("identify") {
    check({"identify", kTrial1, kTrial9, "--rig", kRig, "--start", kTable2}, {kTrial1, kTrial9, kRig, kTable2});
  }
  SECTION("predict") { check({"predict", kTrial9, "--rig", kRig, "--actuator", kTable2}, {kTrial9, kRig, kTable2}); }
  SECTION("simulate") { check(kSimulate, {kPaper, kTable2}); }
  SECTION("optimize") { check({"optimize", kPaper, "--actuator", kTable2, "--evaluations", "50"}, {kPaper, kTable2}); }
  SECTION("compare") {
    check({"compare", "--nominal", kNominal, "--identified", kTable2, "--trials", kTrial1, "--rig", kRig},
          {kNominal, kTable2, kTrial1, kRig});
  }
}

TEST_CASE("each verb's help shows its options and an example, so does the program its exit codes") {
  const Folder f;
  CHECK_THAT(done(f, {"--help"}).out, Contains("Exit codes") && Contains("identify") && Contains("simulate"));
  for (const char* verb : {"identify", "predict", "simulate", "optimize", "risk", "compare", "design", "demo"}) {
    INFO(verb);
    const Result r = done(f, {verb, "--help"});
    CHECK_THAT(r.out, Contains(std::string("Example: ukemi ") + verb) && Contains("--json") && Contains("--threads"));
    CHECK(r.err == "");
  }
  CHECK_THAT(done(f, {"--version"}).out, Contains("ukemi 0."));
  CHECK(f.content().empty());
}
