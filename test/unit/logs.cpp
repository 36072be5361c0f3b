// Logs as laboratories have them: HEBI's binary and its CSV export, forces in files of their own, units by suffix.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "identify/logs/force_log.hpp"
#include "identify/logs/hebi_trial.hpp"
#include "identify/logs/log_check.hpp"
#include "identify/logs/trial_checks.hpp"
#include "test/folder.hpp"
#include "test/unit/hebi_bytes.hpp"

using namespace ukemi;
using namespace ukemi::identify;
using namespace test;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

namespace {

std::string hebilog_error(const std::string& bytes) {
  const File f("a.hebilog", bytes);
  return error_of(f.folder, [&] { read_hebilog(f.path); });
}
HebiLog hebilog(const std::string& bytes) { return read_hebilog(File("a.hebilog", bytes).path); }
HebiLog hebi_csv(const std::string& text) { return read_hebi_csv(File("a.csv", text).path); }

constexpr double kGear = 100;

/// 10 ms apart: an info record, then feedback.
std::string two_modules(int samples) {
  std::string out = hebi_bytes::header(2) + hebi_bytes::unknown();
  for (int i = 0; i < samples; ++i)
    for (int m = 0; m < 2; ++m) {
      const float position = 0.1f * float(m) + 0.001f * float(i);
      const hebi_bytes::Sample s{10'000 * i + 100 * m, position, position + 1, 200 - kGear * i, m};
      out += i == 0 ? hebi_bytes::info(s, m ? "Knee" : "Hip", "Leg") : hebi_bytes::feedback(s);
    }
  return out;
}

/// A log of one module at these stamps [us], positions counting 0, 1 mrad, ...; commands as given, none where short.
HebiLog log_at(const std::vector<std::int64_t>& stamps, const std::vector<float>& commands = {}) {
  std::string out = hebi_bytes::header(1);
  for (std::size_t i = 0; i < stamps.size(); ++i)
    out += hebi_bytes::feedback({stamps[i], 0.001f * float(i), i < commands.size() ? commands[i] : hebi_bytes::kNaN,
                                 kGear * 0.001 * double(i)});
  return hebilog(out);
}
bool has_note(const Trial& t, const std::string& note) {
  return std::find(t.notes.begin(), t.notes.end(), note) != t.notes.end();
}

}  // namespace

TEST_CASE("hebilog: modules, info records and samples are read") {
  const HebiLog log = hebilog(two_modules(5));
  REQUIRE(log.modules.size() == 2);
  CHECK(log.notes.empty());
  const HebiModule& knee = log.modules[1];
  CHECK(knee.name == "Knee");
  CHECK(knee.family == "Leg");
  CHECK(knee.port == 101);
  CHECK(knee.address == "10.0.0.1");
  CHECK(knee.spring_constant.value() == 40);
  CHECK(knee.position_gains.value().k_p.value() == 0.5);
  CHECK(knee.effort_gains.value().k_d.value() == Approx(0.001));
  REQUIRE(knee.t.size() == 5);
  CHECK(knee.t[0] == Approx(100e-6));  // from the log's first stamp
  CHECK(knee.t[4] == Approx(0.0401));
  CHECK(knee.position[4] == Approx(0.104));
  CHECK(knee.position_command[4] == Approx(1.104));
  CHECK(std::isnan(knee.velocity_command[4]));
  CHECK(knee.effort[4] == Approx(-0.4));
  CHECK(knee.deflection[4] == Approx(0.01));
  CHECK(knee.motor_position[0] == Approx(200));
  CHECK(knee.motor_position[4] == Approx(-200));  // negative turns too
}

TEST_CASE("hebilog: each inconsistency is an error with its byte") {
  using namespace hebi_bytes;
  const std::string good = two_modules(3);
  const auto with = [&](std::size_t at, char byte) {
    std::string bytes = good;
    bytes[at] = byte;
    return hebilog_error(bytes);
  };
  CHECK(hebilog_error("") == "a.hebilog: byte 0: the file is empty: the header of a .hebilog is needed");
  CHECK(hebilog_error(good.substr(0, 5)) == "a.hebilog: byte 5: the file ends inside its header");
  CHECK(with(0, 0) == "a.hebilog: byte 0: 0x00b1: a record of a .hebilog starts with 0x73b1");
  CHECK(with(3, 1) == "a.hebilog: byte 2: record type 1: a .hebilog starts with its header, type 2");
  CHECK_THAT(with(4, 1), StartsWith("a.hebilog: byte 4: 16777218 modules: the file has room for "));
  CHECK(with(24, 0) == "a.hebilog: byte 24: 0x00b1: a record of a .hebilog starts with 0x73b1");
  CHECK(with(27, 3) == "a.hebilog: byte 26: record type 3: 1, 4 or 5 is needed");
  CHECK(with(44, 9) == "a.hebilog: byte 40: module 9.0.0.1:100: the file's header does not list it");
  CHECK_THAT(with(51, 0), StartsWith("a.hebilog: byte 48: length ") && EndsWith("it must be 2 more"));
  CHECK(hebilog_error(header(1)) == "a.hebilog: byte 16: the file ends before its first whole feedback record");
  CHECK(hebilog_error(header(0) + unknown()) == "a.hebilog: byte 4: 0 modules: at least one is needed");
  const std::size_t payload = 16 + 26;  // of the first record behind the header of one module
  const auto of_payload = [&](const std::string& bytes) { return hebilog_error(header(1) + record({0, 0}, bytes, 1)); };
  CHECK(of_payload("\x5A\x7F") ==
        "a.hebilog: byte " + std::to_string(payload) + ": a protobuf field runs over its message's end");
  CHECK(of_payload(std::string(11, '\xFF')) ==
        "a.hebilog: byte " + std::to_string(payload) + ": a protobuf varint of more than 10 bytes");
  CHECK(of_payload("\x08\x80") ==
        "a.hebilog: byte " + std::to_string(payload + 1) + ": a protobuf varint runs over its message's end");
  CHECK_THAT(of_payload("\x0B"), EndsWith("protobuf wire type 3: 0, 1, 2 or 5 is needed"));
  CHECK_THAT(of_payload(message(11, message(9, number(1, 3)))), EndsWith("field 1: a 32-bit float is needed"));
  CHECK_THAT(of_payload(number(11, 3)), EndsWith("field 11: a submessage is needed"));
}

TEST_CASE("hebilog: a file that ends inside its last record keeps the whole ones before it") {
  const std::string good = two_modules(3);
  const HebiLog whole = hebilog(good), cut = hebilog(good.substr(0, good.size() - 1));
  CHECK(whole.modules[1].t.size() == 3);
  CHECK(cut.modules[0].t.size() == 3);
  CHECK(cut.modules[1].t.size() == 2);
  REQUIRE(cut.notes.size() == 1);
  CHECK_THAT(cut.notes[0], StartsWith("the file ends inside its last record (byte "));
}

TEST_CASE("hebilog: thousands of flipped bits and cuts are refused with their byte, or read") {
  const std::string good = two_modules(20);
  const Folder folder;
  std::mt19937_64 random(20261121);
  int refused = 0, read = 0;
  std::string complaint;
  for (int round = 0; round < 6000 && complaint.empty(); ++round) {
    std::string bytes = good;
    for (int flips = round % 4; flips > 0; --flips) bytes[random() % bytes.size()] ^= char(1 << random() % 8);
    if (round % 4 == 0 || round % 8 == 1) bytes.resize(random() % bytes.size());
    const std::string path = folder.write("a.hebilog", bytes);
    HebiLog log;
    try {
      log = read_hebilog(path);
    } catch (const InputError& e) {
      ++refused;
      if (std::string(e.what()).find(": byte ") == std::string::npos) complaint = e.what();
      continue;
    }
    ++read;
    std::size_t samples = 0;
    for (const HebiModule& m : log.modules) samples += m.t.size();
    if (samples > bytes.size() / 26) complaint = "more samples than the file has bytes for";
    for (const char* module : {"1", "2"}) {
      try {
        const Trial t = hebi_trial(log, {.module = module, .gear_ratio = kGear});
        for (std::size_t i = 0; i < t.samples(); ++i) {
          if (!std::isfinite(t.phi[i]) || !std::isfinite(t.phi_ref[i])) complaint = "an angle that is no number";
          if (i > 0 && !(t.t[i] > t.t[i - 1])) complaint = "time that does not increase";
        }
      } catch (const InputError&) {
      }
    }
  }
  CHECK(complaint == "");
  CHECK(refused > 1000);
  CHECK(read > 1000);
}

TEST_CASE("hebi: one module of several is chosen by name, family and name, or number") {
  const HebiLog log = hebilog(two_modules(3));
  CHECK(choose_module(log, "Knee").port == 101);
  CHECK(choose_module(log, "Leg/Hip").port == 100);
  CHECK(choose_module(log, "2").port == 101);
  const auto error = [](const HebiLog& l, const std::string& module) {
    return refusal([&] { choose_module(l, module); });
  };
  const std::string list = "1 'Hip' of 'Leg' (10.0.0.1:100); 2 'Knee' of 'Leg' (10.0.0.1:101)";
  CHECK_THAT(error(log, ""), EndsWith("2 modules: --module NAME or number is needed: " + list));
  CHECK_THAT(error(log, "Ankle"), EndsWith("--module: 'Ankle': no such module; the log has " + list));
  CHECK_THAT(error(log, "3"), Contains("no such module"));
  HebiLog twins = log;
  twins.modules[0].name = "Knee", twins.modules[0].family = "Arm";
  CHECK_THAT(error(twins, "Knee"), Contains("2 modules are called so"));
  CHECK(choose_module(twins, "Arm/Knee").port == 100);
  twins.modules[1].t.clear();  // listed, and never heard of
  CHECK(choose_module(twins, "").port == 100);
}

TEST_CASE("hebi: duplicate stamps, disorder, gaps and NaN commands are handled and counted") {
  SECTION("a clean log") {
    const Trial t = hebi_trial(log_at({0, 10'000, 20'000}, {1, 2, 3}), {});
    CHECK(t.t == std::vector<double>{0, 0.01, 0.02});
    CHECK(t.phi_ref == std::vector<double>{1, 2, 3});
    CHECK(t.phi_motor.empty());
    CHECK(t.notes == std::vector<std::string>{"the motor's position is not used: the rig names no gear_ratio"});
  }
  SECTION("duplicates: the same stamp, and one 0.02 ms later") {
    const Trial t = hebi_trial(log_at({0, 10'000, 10'000, 20'000, 20'020, 30'000}), {});
    CHECK(t.t == std::vector<double>{0, 0.01, 0.02, 0.03});
    CHECK(t.phi[3] == Approx(0.005));
    CHECK(has_note(t, "2 duplicate stamps dropped"));
  }
  SECTION("a gap") {
    const Trial t = hebi_trial(log_at({0, 10'000, 20'000, 58'000, 68'000}), {});
    CHECK(t.samples() == 5);
    CHECK(has_note(t, "1 gap longer than 3 nominal intervals of 10 ms, the longest 38 ms"));
  }
  SECTION("stamps that go back within a second are sorted") {
    const Trial t = hebi_trial(log_at({0, 20'000, 10'000, 30'000}), {});
    CHECK(t.t == std::vector<double>{0, 0.01, 0.02, 0.03});
    CHECK(t.phi[1] == Approx(0.002));
    CHECK(has_note(t, "1 stamp out of order sorted"));
  }
  SECTION("stamps that go back further are refused") {
    const HebiLog log = log_at({0, 2'000'000, 10'000});
    CHECK_THROWS_WITH(hebi_trial(log, {}), Contains("a.hebilog: sample 3: its stamp 0.01 s stands 1.99 s before"));
  }
  SECTION("NaN commands before the first, and later") {
    const float none = hebi_bytes::kNaN;
    const Trial t = hebi_trial(log_at({0, 10'000, 20'000, 30'000, 40'000}, {none, none, 2, none, 3}), {});
    CHECK(t.phi_ref == std::vector<double>{0, 0, 2, 2, 3});
    CHECK(has_note(t, "2 NaN commands before the first command: held at the first position"));
    CHECK(has_note(t, "1 NaN command after the first: the last command is held"));
  }
  SECTION("no command at all") {
    const Trial t = hebi_trial(log_at({0, 10'000}), {});
    CHECK(has_note(t, "no position command in the log: the reference is held at the first position"));
    CHECK_THROWS_WITH(require_excitation(t), Contains("a.hebilog: no excitation: no force and a reference that stays"));
  }
  SECTION("a position that is no number") {
    HebiLog log = log_at({0, 10'000, 20'000});
    log.modules[0].position[1] = std::nan("");
    const Trial t = hebi_trial(log, {});
    CHECK(t.samples() == 2);
    CHECK(has_note(t, "1 sample without time or position dropped"));
  }
  SECTION("one sample") {
    CHECK_THROWS_WITH(hebi_trial(log_at({5, 5, 5}), {}), Contains("1 sample: at least two samples"));
    CHECK_THROWS_WITH(hebi_trial(log_at({0}), {}), Contains("1 sample: at least two samples"));
  }
  SECTION("an angle beyond 2 pi") {
    HebiLog log = log_at({0, 10'000});
    log.modules[0].position[1] = 7;
    CHECK_THROWS_WITH(hebi_trial(log, {}), Contains("sample 2: position: 7 rad: ") && Contains("--multi-turn"));
    CHECK(hebi_trial(log, {.angles = TrialOptions::Angles::kMultiTurn}).phi[1] == 7);
  }
}

TEST_CASE("hebi: the motor's angle is divided by the gear ratio and counted from the output") {
  HebiLog log = log_at({0, 10'000, 20'000});
  for (double& x : log.modules[0].motor_position) x += 55;  // switched on elsewhere
  const Trial t = hebi_trial(log, {.gear_ratio = kGear});
  REQUIRE(t.phi_motor.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(t.phi_motor[i] == Approx(0.001 * double(i)).margin(1e-7));
  CHECK(has_note(t,
                 "the motor's position counts from where it was switched on: moved by -0.55 rad to the output's "
                 "median"));
}

TEST_CASE("hebi: the vendor's CSV export, whatever its case and index") {
  const auto check = [](const std::string& text) {
    const HebiLog log = hebi_csv(text);
    REQUIRE(log.modules.size() == 2);
    CHECK(log.modules[0].t == std::vector<double>{0, 0.01});
    CHECK(log.modules[1].t == std::vector<double>{0, 0.01});
    CHECK(log.modules[1].position == std::vector<double>{3, 4});
    CHECK(std::isnan(log.modules[1].position_command[0]));
    CHECK(log.modules[1].position_command[1] == 6);
    CHECK(std::isnan(log.modules[0].motor_position[0]));
    CHECK(choose_module(log, "2").position[0] == 3);
  };
  check("time,position1,position2,positionCmd1,positionCmd2\n0,1,3,nan,NaN\n0.01,2,4,5,6\n");
  check("Time,Position_1,Position_2,PositionCmd_1,PositionCmd_2\n0,1,3,nan,\n0.01,2,4,5,6\n");
  check("time,position(1),position(2),position_cmd(1),positionCommand(2)\n0,1,3,nan,NAN\n0.01,2,4,5,6\n");

  const HebiLog one = hebi_csv("time,position,velocity,effort,deflection,motorPosition,name\n0,1,2,3,4,5,x\n");
  REQUIRE(one.modules.size() == 1);
  CHECK(one.modules[0].deflection[0] == 4);
  CHECK(one.modules[0].motor_position[0] == 5);

  const File twice("a.csv", "time,position,Position\n0,1,2\n"), text("a.csv", "time,position\n0,x\n");
  CHECK(error_of(twice.folder, [&] { read_hebi_csv(twice.path); }) ==
        "a.csv:1:15: column 'Position': this field is given twice");
  CHECK(error_of(text.folder, [&] { read_hebi_csv(text.path); }) ==
        "a.csv:2:3: column 'position': 'x': a number is needed");

  CHECK(is_hebi_csv(File("a.csv", "time,position_1\n0,1\n").path));
  CHECK_FALSE(is_hebi_csv(File("a.csv", "t,phi,force\n0,1,2\n").path));
  CHECK_FALSE(is_hebi_csv(File("a.csv", "t,time,position,phi\n0,1,2,3\n").path));
  CHECK_FALSE(is_hebi_csv(File("a.csv", "time,phi,force\n0,1,2\n").path));
  CHECK(is_hebilog(File("a.hebilog", "").path));
  CHECK(is_hebilog(File("log.bin", two_modules(1)).path));
  CHECK_FALSE(is_hebilog(File("a.csv", "t,phi,force\n0,1,2\n").path));
}

TEST_CASE("hebi: a real log, read in place") {
  const auto path = lab_file("hebi/exampleLog.hebilog");
  if (!path) return;
  const HebiLog log = read_hebilog(*path);
  REQUIRE(log.modules.size() == 1);
  CHECK(log.notes.empty());
  const HebiModule& m = log.modules[0];
  CHECK(m.name == "Test Module");
  CHECK(m.family == "My Family");
  CHECK(m.address == "10.10.10.195");
  CHECK(m.t.size() == 1050);
  CHECK(m.spring_constant.value() == 40.0);
  CHECK(m.position_gains.value().k_p.value() == 0.5);
  // The module computes its effort from the deflection: 40 Nm/rad, to the floats' rounding.
  for (std::size_t i = 0; i < m.t.size(); ++i)
    CHECK(std::abs(m.effort[i] + 40.0 * m.deflection[i]) < 1e-5 * std::abs(m.effort[i]) + 1e-9);

  const Trial t = hebi_trial(log, {.gear_ratio = 272.222});  // X5-1
  CHECK(t.t.back() == Approx(9.99).epsilon(1e-3));
  CHECK(has_note(t, "1 NaN command before the first command: held at the first position"));
  CHECK(std::any_of(t.notes.begin(), t.notes.end(),
                    [](const std::string& n) { return n.find("duplicate stamp") != std::string::npos; }));
  // Motor and output move as one, but for the spring and the motor's coarse sensor (a sixth of a turn: 3.8 mrad).
  REQUIRE(t.phi_motor.size() == t.samples());
  double largest = 0;
  for (std::size_t i = 0; i < t.samples(); ++i) largest = std::max(largest, std::abs(t.phi_motor[i] - t.phi[i]));
  CHECK(largest < 0.015);
}

TEST_CASE("a column's unit is in its suffix, or in a scale of the map") {
  const auto trial = [](const std::string& text, const std::string& columns = {}) {
    return read_trial(File("a.csv", text).path, {.columns = columns});
  };
  const Trial a = trial("t_ms,phi_mrad,force_kN\n0,500,1\n10,-250,2\n");
  CHECK(a.t[1] == Approx(0.01));
  CHECK(a.phi[1] == Approx(-0.25));
  CHECK(a.force[1] == Approx(2000));
  CHECK(trial("t,phi,force_N\n0,0,1\n1,0,2\n").force[1] == 2);
  const std::string text = "t,defl,Fy,F_kN,2*x\n0,1,1000,5,7\n1,2,2000,6,8\n";
  const Trial b = trial(text, "phi=-0.5*defl,force=0.001*Fy");
  CHECK(b.phi == std::vector<double>{-0.5, -1});
  CHECK(b.force[1] == Approx(2));
  CHECK(trial(text, "phi=defl,force=-4.44822*Fy").force[0] == Approx(-4448.22));
  CHECK(trial(text, "phi=defl,force=0.5*F_kN").force[0] == Approx(2500));  // on top of the suffix
  CHECK_THROWS_WITH(trial(text, "phi=defl,force=0*Fy"), "--columns: '0*Fy': a finite scale other than 0 is needed");
  CHECK_THROWS_WITH(trial(text, "phi=defl,force=2*Fz"), Contains("no column 'Fz'"));
  CHECK_THROWS_WITH(trial("t,phi,force,force_kN\n0,0,1,1\n1,0,1,1\n"), Contains("'force' is given twice"));
}

TEST_CASE("an encoder's rates stand for angles that were not logged") {
  const Trial t = read_trial(File("a.csv", "t,dphi_deg,dphi_motor,phi_ref\n0,5,9,0\n0.1,180,4,1\n0.3,-90,-2,1\n").path,
                             {.gear_ratio = 2});
  REQUIRE(t.phi.size() == 3);
  CHECK(t.phi[0] == 0);
  CHECK(t.phi[1] == Approx(0.1 * std::numbers::pi));
  CHECK(t.phi[2] == Approx(0.1 * std::numbers::pi - 0.2 * std::numbers::pi / 2));
  CHECK(t.phi_motor == std::vector<double>{0, 0.1 * 2, 0.1 * 2 + (0.3 - 0.1) * -1});
  CHECK(t.notes.size() == 2);
  const Trial both = read_trial(File("b.csv", "t,phi,dphi,phi_ref\n0,0.5,5,0\n0.1,0.25,7,1\n").path);
  CHECK(both.phi == std::vector<double>{0.5, 0.25});  // the angle itself counts
  CHECK(both.notes.empty());
}

TEST_CASE("a trial without excitation is refused, two with the same content are known") {
  Trial t{.file = "still.csv", .t = {0, 1}, .phi = {0, 0}, .force = {0, 0}};
  CHECK_THROWS_WITH(require_excitation(t),
                    "still.csv: no excitation: a force of 0 throughout and no reference: a force "
                    "or a moving reference is needed");
  t.phi_ref = {0.2, 0.2};
  CHECK_THROWS_WITH(require_excitation(t), Contains("a force of 0 throughout and a reference that stays"));
  t.phi_ref = {0.2, 0.3};
  CHECK_NOTHROW(require_excitation(t));
  t.phi_ref.clear(), t.force = {0, 1};
  CHECK_NOTHROW(require_excitation(t));

  Trial other = t;
  other.file = "other.csv";
  CHECK(same_content(t, other));
  other.phi[1] = 1e-9;
  CHECK_FALSE(same_content(t, other));
  t.phi[1] = std::numeric_limits<double>::quiet_NaN();  // a cell that is empty
  CHECK_FALSE(same_content(t, other));
  other.phi = t.phi;
  CHECK(same_content(t, other));
}

namespace {

/// A hit of 20 ms and `peak` newton at `onset`, sampled at 1 / dt from `begin` to `end`.
ForceLog hit(double peak, double onset, double begin, double end, double dt) {
  ForceLog log{"force.csv", {}, {}};
  for (int i = 0; begin + dt * i <= end; ++i) {
    const double t = begin + dt * i, x = (t - onset) / 0.02;
    log.t.push_back(t);
    log.force.push_back(x > 0 && x < 1 ? peak * std::sin(std::numbers::pi * x) : 0);
  }
  return log;
}
const Rig kRig{.length = 0.3, .inertia = 0.024225, .tau_max = {}, .gear_ratio = {}, .feedback = {}};

/// phi of a link held by a spring of 50 Nm/rad and damped, under `force`: close to a rig for its first 20 ms.
Trial struck(const ForceLog& force, double noise) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, noise);
  Trial trial{.file = "hit.csv"};
  double phi = 0, rate = 0;
  for (std::size_t i = 0; i < force.t.size(); ++i) {
    trial.t.push_back(force.t[i]);
    trial.phi.push_back(phi + normal(random));
    const int inner = 20;
    for (int k = 0; k < inner && i + 1 < force.t.size(); ++k) {
      const double dt = (force.t[i + 1] - force.t[i]) / inner;
      const double f = force.force[i] + (force.force[i + 1] - force.force[i]) * (k + 0.5) / inner;
      rate += dt * (kRig.length * std::cos(phi) * f - 50 * phi - 1 * rate) / kRig.inertia;
      phi += dt * rate;
    }
  }
  return trial;
}

}  // namespace

TEST_CASE("force log: its own clock is found from the onsets, to a millisecond") {
  for (const double peak : {30.0, -100.0, 400.0}) {
    INFO("peak " << peak);
    Trial trial = struck(hit(peak, 0.3, 0, 1, 1e-3), 5e-4);
    ForceLog log = hit(peak, 0.3, 0.1, 0.6, 1e-4);  // 10 kHz, begins later
    for (double& t : log.t) t += 123.4;             // and counts from another instant
    for (double& f : log.force) f += 0.5;           // with an offset
    const double shift = attach_force(trial, log, kRig, ForceClock::kOwn);
    CHECK(shift == Approx(-123.4).margin(1e-3));
    CHECK(trial.force == log.force);
    REQUIRE(trial.force_t.size() == log.t.size());
    CHECK(trial.force_t[7] == log.t[7] + shift);
    REQUIRE(trial.notes.size() == 1);
    CHECK_THAT(trial.notes[0], StartsWith("the force in force.csv covers 0.") && EndsWith("taken as 0 outside"));
  }
}

TEST_CASE("logs: times count from the first row, whatever the recorder's clock") {
  const auto csv = [](double origin, const char* column) {
    std::string out = std::string("t,") + column + "\n";
    for (int i = 0; i < 40; ++i) out += fmt::format("{:.6f},{}\n", origin + 0.01 * i, i % 7);
    return out;
  };
  constexpr double k1970 = 1.7e9;
  const File plain("a.csv", csv(0, "phi_ref")), late("b.csv", csv(k1970, "phi_ref"));
  const Trial a = read_trial(plain.path, {.require_phi = false}), b = read_trial(late.path, {.require_phi = false});
  CHECK(a.t_origin == 0);
  CHECK(b.t_origin == k1970);
  REQUIRE(b.t.size() == a.t.size());
  for (std::size_t i = 0; i < a.t.size(); ++i) CHECK(b.t[i] == Approx(a.t[i]).margin(3e-7));  // half a unit of 1.7e9

  // One clock for both files: the force begins 5 ms before the angle.
  const File force("f.csv", csv(k1970 - 0.005, "force"));
  const ForceLog log = read_force_log(force.path);
  CHECK(log.t.front() == 0);
  CHECK(log.t_origin == k1970 - 0.005);
  Trial shared = b;
  CHECK(attach_force(shared, log, kRig, ForceClock::kShared) == 0);
  CHECK(shared.force_t.front() == Approx(-0.005).margin(3e-7));
  CHECK(b.clock_time(0.25) == "1700000000.25");
  Trial apart = a;
  CHECK_THROWS_WITH(attach_force(apart, log, kRig, ForceClock::kShared), Contains("from 1699999999.995 to "));

  Trial again = a;
  for (double& t : again.t) t += 12;
  again.force_t = {11.5, 12.5};
  count_from_first(again);
  CHECK(again.t.front() == 0);
  CHECK(again.force_t == std::vector<double>{-0.5, 0.5});
  CHECK(again.t_origin == 12);
}

TEST_CASE("logs: what is said of a time is by the file's own clock") {
  constexpr double k1970 = 1.7e9;
  Trial trial;
  trial.file = "a.csv", trial.t_origin = k1970;
  for (int i = 0; i < 100; ++i)
    if (i < 40 || i >= 50) trial.t.push_back(0.01 * i);
  trial.phi.assign(trial.t.size(), 0.0), trial.phi_ref = trial.phi;
  const LogCheck check = check_logs({trial});
  REQUIRE(check.warnings.size() == 1);
  CHECK_THAT(check.warnings[0], EndsWith("the longest of 110 ms at 1700000000.39 s"));
  ForceLog log{"f.csv", {0, 0.1, 0.2}, {0, 5, 0}, k1970 + 0.3};
  attach_force(trial, log, kRig, ForceClock::kShared);
  CHECK(trial.notes ==
        std::vector<std::string>{"the force in f.csv covers 1700000000.3 to 1700000000.5 s of 1700000000 "
                                 "to 1700000000.99 s: taken as 0 outside"});
}

TEST_CASE("logs: a gap of 1e5 s is refused with its place") {
  const File gap("gap.csv", "t,force,phi\n0,1,0\n0.01,2,0\n100000.02,3,0\n");
  CHECK_THROWS_WITH(read_trial(gap.path),
                    EndsWith("gap.csv:4:1: column 't': 100000.02: less than 100000 s after the time "
                             "before it, 0.01, is needed"));
  CHECK_THROWS_WITH(read_force_log(gap.path), Contains("gap.csv:4:1: ") && Contains("less than 100000 s"));
}

TEST_CASE("logs: a column of which only the case is wrong is an error, one that looks like a missing one is noted") {
  const auto read = [](const std::string& header) {
    const File file("x.csv", header + "\n0,1,0\n0.01,2,0\n");
    return read_trial(file.path, {.require_phi = false});
  };
  CHECK_THROWS_WITH(read("t,force,PHI"), EndsWith("x.csv:1:9: column 'PHI': it is not read (did you mean \"phi\"?)"));
  CHECK_THROWS_WITH(read("t,force,Phi_Deg"), EndsWith("(did you mean \"phi_deg\"?)"));
  CHECK(read("t,force,phi_motr").notes ==
        std::vector<std::string>{"column 'phi_motr' is not read (did you mean \"phi_motor\"?)"});
  CHECK(read("t,force,temperature").notes.empty());
  const File both("y.csv", "t,T,force,phi\n0,20,1,0\n0.01,21,2,0\n");
  CHECK(read_trial(both.path).notes.empty());  // t is there: T is a temperature
}

TEST_CASE("force log: a shared clock is kept, logs that do not overlap are refused with both ranges") {
  Trial trial = struck(hit(100, 0.3, 0, 1, 1e-3), 0);
  const Trial before = trial;
  ForceLog log = hit(100, 0.3, 0, 1, 1e-4);
  CHECK(attach_force(trial, log, kRig, ForceClock::kShared) == 0);
  CHECK(trial.force_t == log.t);
  CHECK(trial.notes.empty());
  CHECK_THROWS_WITH(attach_force(trial, log, kRig, ForceClock::kShared),
                    "hit.csv: a force in the trial beside the force log force.csv: one of them is needed");
  for (double& t : log.t) t += 5;
  trial = before;
  CHECK_THROWS_WITH(attach_force(trial, log, kRig, ForceClock::kShared),
                    Contains("force.csv: the force runs from 5 to ") && Contains("hit.csv from 0 to ") &&
                        Contains("they do not overlap") && Contains("--force-clock own"));
}

TEST_CASE("force log: a reference that moves too is noted where the clock is the force's own") {
  const ForceLog log = hit(100, 0.3, 0, 1, 1e-3);
  Trial trial = struck(log, 0);
  trial.phi_ref.assign(trial.samples(), 0);
  Trial moving = trial;
  moving.phi_ref.back() = 0.1;
  attach_force(trial, log, kRig, ForceClock::kOwn);
  attach_force(moving, log, kRig, ForceClock::kOwn);
  CHECK(trial.notes.empty());
  REQUIRE(moving.notes.size() == 1);
  CHECK_THAT(moving.notes[0], StartsWith("the reference moves too: "));
}

TEST_CASE("force log: without an onset there is no alignment") {
  Trial trial = struck(hit(100, 0.3, 0, 1, 1e-3), 0);
  CHECK_THROWS_WITH(attach_force(trial, hit(0, 0.3, 0, 1, 1e-3), kRig, ForceClock::kOwn),
                    "force.csv: the force never leaves its rest: without an onset the clocks cannot be aligned");
  std::fill(trial.phi.begin(), trial.phi.end(), 0.25);
  CHECK_THROWS_WITH(attach_force(trial, hit(100, 0.3, 0, 1, 1e-3), kRig, ForceClock::kOwn),
                    "hit.csv: the angle never leaves its rest: without an onset the clocks cannot be aligned");
}

TEST_CASE("force log: columns, units and faults as in a trial") {
  const auto read = [](const std::string& text, const std::string& columns = {}) {
    return read_force_log(File("f.csv", text).path, columns);
  };
  const ForceLog log = read("Time_ms;Fy;Fz\n0;1;x\n0.5;-2;x\n", "t=Time_ms,force=-2*Fy");
  CHECK(log.t == std::vector<double>{0, 0.0005});
  CHECK(log.force == std::vector<double>{-2, 4});
  CHECK(read("t,force_kN\n0,1\n1,2\n").force[1] == 2000);
  CHECK_THROWS_WITH(read("t,F\n0,1\n1,2\n"), Contains("f.csv:1: no column 'force'"));
  CHECK_THROWS_WITH(read("t,force\n0,1\n0,2\n"), Contains("f.csv:3:1: column 't': 0: time must increase"));
  CHECK_THROWS_WITH(read("t,force\n0,1\n"), Contains("f.csv:2: one row"));
  CHECK_THROWS_WITH(read("t,force\n0,\n1,2\n"), Contains("f.csv:2:3: column 'force': empty"));
  CHECK_THROWS_WITH(read("t,force\n0,1\n1,2\n", "phi=x"),
                    Contains("--force-columns: 'phi': one of t, force is needed"));
}

TEST_CASE("a force on times of its own is resampled, 0 outside") {
  const Trial t{.file = "", .t = {0, 1, 2, 3}, .force = {10, 20}, .force_t = {0.5, 2.5}};
  CHECK(force_at_samples(t) == std::vector<double>{0, 12.5, 17.5, 0});
}
