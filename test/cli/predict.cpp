// ukemi predict: its verdict, as a script reads it.
#include <catch2/catch.hpp>

#include "common/csv.hpp"
#include "test/cli/refused.hpp"
#include "test/cli/robot_log.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const std::string kHeldOut = dataset("impact_validation/trial_9.csv"), kRig9 = dataset("rigs/paper.toml");
Arguments predict(const std::string& actuator) {
  return Arguments{"predict", kHeldOut, "--rig", kRig9, "--actuator", actuator, "--strict", "--no-report"} + kOut;
}

}  // namespace

TEST_CASE("predict: a held-out trial holds on the identified actuator, with a band, another actuator's does not") {
  const Folder f;
  Arguments fit = {"identify"};
  for (int i = 1; i <= 8; ++i) fit.push_back(dataset("impact/trial_" + std::to_string(i) + ".csv"));
  REQUIRE(run(fit + Arguments{"--rig", kRig9, "--no-report", "-o", "fit"}, f.at("")).code == 0);
  const Result good = run(predict("fit/actuator.toml"), f.at(""));
  INFO(good.out + good.err);
  CHECK(good.code == 0);
  CHECK_THAT(good.out, Contains("the prediction holds"));
  CHECK(summary(f)["verdict"] == "holds");
  CHECK(summary(f)["factor"].get<double>() <= 1);
  CHECK(summary(f)["by_noise_alone"] == false);
  CHECK(summary(f)["trials"][0]["verdict"] == "holds");
  CHECK_THAT(read(f.at("out/fit.csv")), Contains("trial,t,phi,phi_sim,residual,band\n"));

  const Result bad = run(predict(dataset("actuators/x8-9_nominal.toml")), f.at(""));
  CHECK(bad.code == 1);
  CHECK_THAT(bad.err, Contains("does not hold") && Contains("no covariance"));
  CHECK(summary(f)["verdict"] == "does not hold");
  CHECK(summary(f)["by_noise_alone"] == true);
}

TEST_CASE("predict: --start-angle is an angle in rad, or fit") {
  const Arguments plain = {"predict", kHeldOut, "--rig", kRig9, "--actuator", kTable2};
  check_refused(Folder(), plain + Arguments{"--start-angle", "10"} + kOut,
                {"--start-angle: '10': ", "2 pi rad, or fit"});
  check_refused(Folder(), plain + Arguments{"--start-angle", "fits"} + kOut, {"--start-angle: 'fits': "});
  const Folder f;
  const Result r = done(f, plain + Arguments{"--start-angle", "fit", "--no-report"} + kOut);
  CHECK(summary(f)["nuisance"]["initial_angle"].size() == 1);
  CHECK(std::abs(summary(f)["nuisance"]["initial_angle"][0]["value"].get<double>()) < 1e-3);
  done(f, plain + Arguments{"--start-angle", "0.2", "--no-report"} + kOut);
  CHECK(summary(f)["verdict"] == "does not hold");
}

TEST_CASE("predict: friction does not carry over on the measured flexible drive, and the prediction says so") {
  const auto output = lab_file("flexible_drive/p_output_050.csv"), motor = lab_file("flexible_drive/p_motor_270.csv");
  if (!output || !motor) return;
  // Fitted to the run that feeds back the load cart, predicting the one that feeds back the motor cart.
  const Folder f;
  const std::string head = "[rig]\nlength = 1\ninertia_joint = 1\n[drive]\ncommand_limit = 8\n";
  f.write("output.toml", head + "command_gain = 50\nfeedback = \"output\"\n");
  f.write("motor.toml", head + "command_gain = 270\nfeedback = \"motor\"\n");
  const std::string columns = "t=t_s,phi=0.001*x2_mm,phi_motor=0.001*x1_mm,phi_ref=0.001*xr_mm";
  (void)run({"identify", *output, "--rig", "output.toml", "--columns", columns, "--nuisance",
             "friction,output_friction,viscous,output_viscous", "--no-report", "-o", "fit"},
            f.at(""));
  const Result r = run(Arguments{"predict", *motor, "--rig", "motor.toml", "--columns", columns, "--actuator",
                                 "fit/actuator.toml", "--strict", "--no-report"} +
                           kOut,
                       f.at(""));
  INFO(r.out + r.err);
  CHECK(r.code == 1);
  CHECK(summary(f)["verdict"] == "does not hold");
}

TEST_CASE("identify --robot: the rig of Eq. 5 is a robot of one link, and its constants are those of --rig") {
  const Folder f;
  Arguments trials = {"identify"};
  for (int i = 1; i <= 8; ++i) trials.push_back(dataset("impact/trial_" + std::to_string(i) + ".csv"));
  done(f, trials + Arguments{"--rig", kRig, "-o", "rig"});
  const Arguments constants = {"k_p", "k_d", "k_sea", "c_sea", "i_motor"};
  std::string free;
  for (const std::string& c : constants) free += (free.empty() ? "drive.arm." : ",drive.arm.") + c;
  const std::string at_once = "drive.arm.control_delay=0,drive.arm.velocity_filter=0";
  const Arguments as_robot = trials + Arguments{"--robot",   dataset("robots/one_link.toml"),
                                                "--columns", "push_hit_x=force,phi_arm=phi,phi_ref_arm=0",
                                                "--free",    free};
  done(f, as_robot + Arguments{"--errors", at_once, "-o", "robot"});
  const Json rig = summary(f, "rig")["parameters"], robot = summary(f, "robot")["parameters"];
  for (const std::string& c : constants) {
    const Json &a = rig[c], &b = robot["drive.arm." + c];
    const double std = a["std"];
    INFO(c << " " << a.dump() << " " << b.dump());
    const double own = b["std"];
    CHECK(std::abs(b["value"].get<double>() - a["value"].get<double>()) < 0.3 * own);
    CHECK(own > 0.99 * std);  // how each trial starts is fitted too
    CHECK(a["verdict"] == "trusted");
    CHECK(b["verdict"] == "trusted");
  }
  // What the fit promises of a trial that it has not seen; the file that was given promises nothing.
  const Arguments unseen = {"predict", kHeldOut, "--columns", "push_hit_x=force,phi_arm=phi,phi_ref_arm=0", "--robot"};
  CHECK_THAT(read(f.at("robot/robot.toml")), Contains("\n[identified]\norder = [\"drive.arm.k_p\", "));
  CHECK_THAT(done(f, unseen + Arguments{"robot/robot.toml"} + kOut).out, Contains("within the 95 % band"));
  CHECK(summary(f)["outputs"]["phi_arm"]["within_band"].get<double>() == Approx(0.95).margin(0.03));
  CHECK_THAT(read(f.at("out/fit.csv")), Contains("trial,t,output,measured,simulated,residual,used,band\n"));
  done(f, unseen + Arguments{dataset("robots/one_link.toml")} + kOut);
  CHECK_FALSE(summary(f)["outputs"]["phi_arm"].contains("within_band"));
  CHECK_THAT(read(f.at("out/fit.csv")), Contains("trial,t,output,measured,simulated,residual,used\n"));
  done(f, {"robot", "robot/robot.toml", "-o", "shown"});  // [identified] is in nobody's way
  const Arguments two = {"identify",
                         dataset("impact/trial_1.csv"),
                         dataset("impact/trial_2.csv"),
                         "--robot",
                         dataset("robots/one_link.toml"),
                         "--columns",
                         "push_hit_x=force,phi_arm=phi,phi_ref_arm=0"};
  CHECK_THAT(done(f, two + Arguments{"--free", free, "--per-run", "drive.arm.k_d", "-o", "own"}).out,
             Contains("drive.arm.k_d@2") && Contains("@2: " + two[2]));
  CHECK(summary(f, "own")["runs"].size() == 2);
  check_refused(f, two + Arguments{"--free", free, "--per-run", "link.arm.mass"} + kOut, {"--per-run: ", "not fitted"});
  check_refused(f, trials + Arguments{"--rig", kRig, "--per-run", "k_d"} + kOut, {"--per-run: --robot is needed"});
  // A link that is known within 20 % only: what is in its units follows, and is not trusted any more.
  const Result r = done(f, as_robot + Arguments{"--errors", "link.arm.mass=0.16," + at_once, "-o", "within"});
  CHECK_THAT(r.out, Contains("(--errors): robot.link.arm.mass 0.16 kg"));
  const Json within = summary(f, "within");
  CHECK(within["error_budget"]["drive.arm.i_motor"]["robot.link.arm.mass"].get<double>() > 0.9);
  CHECK(within["parameters"]["drive.arm.i_motor"]["std"].get<double>() >
        10 * robot["drive.arm.i_motor"]["std"].get<double>());
  // As it comes the drive may be as late as a rig's: what it would move is most of the error of k_d.
  CHECK_THAT(done(f, as_robot + Arguments{"-o", "late"}).out, Contains("(--errors): drive.arm.control_delay 0.001 s"));
  const Json late = summary(f, "late");
  CHECK(late["error_budget"]["drive.arm.k_d"]["drive.arm.control_delay"].get<double>() > 0.5);
  const Json of_k_d = late["parameters"]["drive.arm.k_d"];
  CHECK(of_k_d["std"].get<double>() > 3 * of_k_d["std_noise"].get<double>());
  check_refused(f, as_robot + Arguments{"--errors", "drive.arm.k_p=1"} + kOut, {"--errors: ", "is fitted"});
  check_refused(f, as_robot + Arguments{"--errors", "link.arm.mass=-1"} + kOut, {"--errors: ", "at least 0"});
  check_refused(f, as_robot + Arguments{"--errors", "link.arm.mas=1"} + kOut, {"--errors: ", "robot.link.arm.mass"});
  check_refused(f, trials + Arguments{"--rig", kRig, "--errors", "k_p=1"} + kOut, {"--errors: --robot is needed"});
}

TEST_CASE("identify --robot: sensors of the rig as a robot are those of --rig, and stand in the robot's file") {
  const Folder f;
  const Arguments trials = {"identify", dataset("impact/trial_1.csv"), dataset("impact/trial_2.csv")};
  done(f, trials +
              Arguments{"--rig", kRig, "--nuisance", "initial_angle,initial_rate,force_bias,time_shift", "-o", "rig"});
  const Arguments constants = {"k_p", "k_d", "k_sea", "c_sea", "i_motor"};
  const std::string sensors = "sensor.push_hit_x.bias,sensor.time_shift";
  std::string free = sensors;
  for (const std::string& c : constants) free += ",drive.arm." + c;
  done(f, trials + Arguments{"--robot", dataset("robots/one_link.toml"), "--columns",
                             "push_hit_x=force,phi_arm=phi,phi_ref_arm=0", "--free", free, "--per-run", sensors, "-o",
                             "robot"});
  const Json rig = summary(f, "rig"), fit = summary(f, "robot")["parameters"];
  const auto near = [&](const std::string& name, double value) {
    INFO(name << " " << fit[name].dump() << ", rig " << value);
    // How the spring is strained at the start is fitted too: it moves by less than what that leaves open.
    CHECK(std::abs(fit[name]["value"].get<double>() - value) < fit[name]["std"].get<double>());
  };
  for (const std::string& c : constants) near("drive.arm." + c, rig["parameters"][c]["value"]);
  for (std::size_t run : {0, 1}) {
    const Json &bias = rig["nuisance"]["force_bias"][run], &shift = rig["nuisance"]["time_shift"][run];
    const std::string at = "@" + std::to_string(run + 1);
    near("sensor.push_hit_x.bias" + at, -bias["value"].get<double>());  // the rig's is what a log lacks
    near("sensor.time_shift" + at, shift["value"]);
    CHECK(fit["sensor.push_hit_x.bias" + at]["std"].get<double>() == Approx(bias["std"].get<double>()).epsilon(0.1));
  }
  const std::string file = read(f.at("robot/robot.toml"));
  CHECK_THAT(file, Contains("\n[sensor.push_hit_x]\nbias = ") && Contains("\n[sensor]\ntime_shift = "));
  done(f, {"predict", kHeldOut, "--columns", "push_hit_x=force,phi_arm=phi,phi_ref_arm=0", "--robot",
           "robot/robot.toml", "-o", "predicted"});
  done(f, {"robot", "robot/robot.toml", "-o", "shown"});
  f.write("odd.toml", file + "\n[sensor.phi_leg]\ngain = 1\n");
  check_refused(f, {"robot", "odd.toml", "-o", "odd"}, {"odd.toml:", "phi_leg"});
}

TEST_CASE("identify --robot of a scene: its floor comes along into robot.toml, whatever was fitted") {
  const Folder f;
  const std::string scene = dataset("scenes/hopper.toml");
  done(f, {"simulate", scene, "--height", "0.1", "--rate", "500", "--no-report", "-o", "fall"});
  f.write("log.csv", as_log(read(f.at("fall/trajectory.csv")), 1e-3));
  for (const std::string free : {"drive.hip.k_p", "drive.hip.k_p,robot.contact.foot.stiffness"}) {
    done(f, {"identify", "log.csv", "--robot", scene, "--free", free, "--no-report", "-o", "fit"});
    CHECK(summary(f, "fit")["parameters"]["drive.hip.k_p"]["value"].get<double>() == Approx(50).epsilon(0.02));
    done(f, {"predict", "log.csv", "--robot", "fit/robot.toml", "--no-report", "-o", "again"});
    for (const std::string output : {"phi_hip", "phi_knee"})
      CHECK(summary(f, "again")["outputs"][output]["rms"].get<double>() ==
            Approx(summary(f, "fit")["outputs"][output]["rms"].get<double>()).epsilon(0.01));
    const std::string robot = read(f.at("fit/robot.toml"));
    CHECK_THAT(robot, Contains("friction = 0.8") && Contains("damping_normal = 120"));
    const auto peak = [&](const std::string& of, const std::string& to) {
      done(f, {"simulate", of, "--hold", "hip=35,knee=-70", "--height", "0.1", "--no-report", "-o", to});
      return summary(f, to)["peak_acceleration"].get<double>();
    };
    CHECK(peak("fit/robot.toml", "of_robot") == Approx(peak(scene, "of_scene")).epsilon(0.02));
  }
  const std::string leg = read(dataset("robots/hopper.toml"));
  f.write("leg.toml", leg);
  const Arguments next = {"--free", "drive.hip.k_p", "--no-report"};
  check_refused(f, Arguments{"identify", "log.csv", "--robot", "leg.toml"} + next + kOut,
                {"leg.toml: contact slider has no stiffness"});
  check_refused(f, Arguments{"design", "--robot", "leg.toml", "--next", "log.csv", "--noise", "phi=1e-3"} + next + kOut,
                {"leg.toml: contact slider has no stiffness"});
  f.write("slope.toml", replaced(replaced(read(scene), "friction = 0.8", "slope_deg = 5\nfriction = 0.8"),
                                 "robot = \"../robots/hopper.toml\"", "robot = \"leg.toml\""));
  check_refused(f, Arguments{"identify", "log.csv", "--robot", "slope.toml"} + next + kOut, {"slope_deg"});
}

TEST_CASE("identify --robot: what is named twice, not read, or says nothing is told") {
  const Folder f;
  const std::string robot = dataset("robots/one_link.toml");
  std::string good = "t,phi_arm,phi_ref_arm,torque_arm,push_hit_x\n", odd = "t,phi_arm,phi_ref_Arm,push_hit_x\n",
              near = "t,phi_arm,phi_ref_arn,push_hit_x\n", off = "t,phi_arm,phi_ref_arm,on_arm,push_hit_x\n",
              plain = "t,phi_arm,phi_ref_arm,push_hit_x\n";
  ukemi::Random random(20261127, 4);
  for (int k = 0; k < 400; ++k) {
    const double t = 0.002 * k, phi = 0.3 * std::sin(7 * t) + 5e-4 * random.normal(), ref = 0.4 * std::sin(7 * t + 0.1);
    good += fmt::format("{},{:.9g},{:.9g},0,0\n", t, phi, ref);
    for (std::string* text : {&odd, &near, &plain}) *text += fmt::format("{},{:.9g},{:.9g},0\n", t, phi, ref);
    off += fmt::format("{},{:.9g},{:.9g},{},0\n", t, phi, ref, k == 3 ? 2 : 1);
  }
  f.write("good.csv", good), f.write("odd.csv", odd), f.write("near.csv", near), f.write("off.csv", off);
  f.write("plain.csv", plain);
  const auto identify = [&](const Arguments& logs, const Arguments& more = {}) {
    return Arguments{"identify"} + logs + Arguments{"--robot", robot, "--free", "drive.arm.k_p,drive.arm.k_d"} + more +
           Arguments{"--no-report"} + kOut;
  };
  const Result r = run(identify({"good.csv"}), f.at(""));
  CHECK_THAT(r.err, Contains("column 'torque_arm': the same in every row, it is left out"));
  CHECK_FALSE(summary(f)["outputs"].contains("torque_arm"));
  CHECK_THAT(run(identify({"near.csv"}), f.at("")).err, Contains("column 'phi_ref_arn' is not read (did you mean"));
  check_refused(f, identify({"odd.csv"}), {"odd.csv:1:", "'phi_ref_Arm'", "did you mean \"phi_ref_arm\"?"});
  check_refused(f, identify({"off.csv"}), {"off.csv:5:", "on_arm", "from 0 to 1"});
  CHECK_THAT(run(identify({"plain.csv", "./plain.csv"}), f.at("")).err, Contains("'./plain.csv' is given twice"));
  f.write("copy.csv", plain);
  CHECK_THAT(run(identify({"plain.csv", "copy.csv"}), f.at("")).err,
             Contains("'plain.csv' and 'copy.csv' have the same content: they count twice"));
  std::string gap = "t,phi_arm,phi_ref_arm,push_hit_x,y_arm\n";
  for (int k = 0; k < 400; ++k)
    if (k < 100 || k >= 140) gap += fmt::format("{},{:.9g},0,0,{}\n", 0.002 * k, 1e-3 * random.normal(), 0.1 * k);
  f.write("gap.csv", gap);
  CHECK_THAT(run(identify({"gap.csv"}), f.at("")).err,
             Contains("1 gap, the widest of 0.082 s at 0.198 s, where a row takes 0.002 s") &&
                 Contains("column 'y_arm' is not read: trials have places of the base of a free robot alone"));
  check_refused(f, {"predict", "plain.csv", "--robot", robot, "--strict", "-o", "bad"}, {"--strict: it has no effect"});
  // What a fit did not trust is told by what takes its robot.
  CHECK_THAT(read(f.at("out/robot.toml")), Contains("constants = [\"drive.arm.k_p\"") && Contains("verdicts = ["));
  const std::string hopper = read(dataset("robots/hopper.toml"));
  f.write("hopper.toml", hopper +
                             "\n[identified]\nconstants = [\"robot.rail.friction\", \"robot.link.thigh.mass\"]\n"
                             "verdicts = [\"not identifiable\", \"trusted\"]\n");
  f.write("scene.toml", replaced(read(dataset("scenes/hopper.toml")), "robot = \"../robots/hopper.toml\"",
                                 "robot = \"hopper.toml\""));
  CHECK_THAT(done(f, {"simulate", "scene.toml", "--no-report", "-o", "sim"}).err,
             Contains("not trusted by the fit that wrote it: robot.rail.friction is not identifiable; what follows"));
  f.write("hopper.toml", hopper + "\n[identified]\nconstants = [\"a\"]\nverdicts = []\n");
  check_refused(f, {"simulate", "scene.toml", "-o", "bad"}, {"0 verdicts: 'constants' names 1"});
  const auto twice = [&](const std::string& option, const std::string& list) {
    check_refused(f, identify({"plain.csv"}, {option, list}), {option.substr(2), "twice"});
  };
  twice("--prior", "drive.arm.k_p=20:1,drive.arm.k_p=60:1"), twice("--lower", "drive.arm.k_p=1,drive.arm.k_p=2");
  twice("--errors", "link.arm.mass=0.1,robot.link.arm.mass=0.2"), twice("--columns", "phi_arm=a,phi_arm=b");
  check_refused(f, identify({"plain.csv"}, {"--pieces", "none.csv"}), {"--pieces: 'none.csv'", "a file that is there"});
  const auto with_prior = [&](const std::string& k_p) {
    return run({"identify", dataset("impact/trial_1.csv"), "--robot", robot, "--columns",
                "push_hit_x=force,phi_arm=phi,phi_ref_arm=0", "--free",
                "drive.arm.k_p,drive.arm.k_d,drive.arm.k_sea,drive.arm.c_sea,drive.arm.i_motor", "--prior",
                "drive.arm.k_p=" + k_p, "--no-report", "-o", "far"},
               f.at(""))
        .err;
  };
  const std::string contradict = ": logs and prior contradict";
  CHECK_THAT(with_prior("70:1"), Contains("standard deviations from its prior, 70 with 1" + contradict));
  // One that is wrong and holds the constant where it says.
  CHECK_THAT(with_prior("70:1e-5"), Contains("standard deviations from its prior, 70 with 1e-05" + contradict));
  CHECK_THAT(with_prior("50:1e-5"), !Contains(contradict));
}

namespace {

/// A log of a simulated drop, with the force of the foot under another name and scaled.
void write_log(const Folder& f, const std::string& name, const std::string& force, double scale) {
  const ukemi::CsvTable drop = ukemi::read_csv(f.at("drop/trajectory.csv"));
  const auto at = [&](const char* column, std::size_t row) {
    return drop.columns[std::size_t(drop.require(column))][row];
  };
  std::string out = "t,phi_hip,phi_knee,phi_ref_hip,phi_ref_knee," + force + "\n";
  for (std::size_t k = 0; k < drop.rows(); k += 2)
    if (k == 0 || at("t", k) > at("t", k - 2))
      out += fmt::format("{},{},{},{},{},{}\n", at("t", k), at("phi_hip", k), at("phi_knee", k), at("phi_ref_hip", k),
                         at("phi_ref_knee", k), scale * at("f_foot_y", k));
  f.write(name, out);
}

}  // namespace

TEST_CASE("predict --robot: forces of contacts that are misnamed, missing, turned or of another unit are told") {
  const Folder f;
  const std::string hopper = dataset("scenes/hopper.toml");
  done(f, {"simulate", hopper, "--no-report", "-o", "drop"});
  write_log(f, "good.csv", "f_foot_y", 1);
  write_log(f, "kilo.csv", "f_foot_y_kN", 1e-3);
  const auto told = [&](const Arguments& logs) {
    return done(f, Arguments{"predict"} + logs +
                       Arguments{"--robot", hopper, "--nuisance", "none", "--no-report", "-o", "out"})
        .err;
  };
  for (const std::string right : {"good.csv", "kilo.csv"}) {
    const std::string err = told({right});
    for (const char* doubt : {"is not read", "0 in every row", "sign turned", "are they in N"})
      CHECK_THAT(err, !Contains(doubt));
  }
  for (const std::string name : {"f_toe_y", "force_foot"}) {
    write_log(f, "named.csv", name, 1);
    CHECK_THAT(told({"named.csv"}),
               Contains("column '" + name + "' is not read: the force on a contact is f_CONTACT_x"));
  }
  write_log(f, "near.csv", "f_fot_y", 1);
  CHECK_THAT(told({"near.csv"}), Contains("column 'f_fot_y' is not read (did you mean \"f_foot_y\"?)") &&
                                     !Contains("the force on a contact is"));
  write_log(f, "zero.csv", "f_foot_y", 0);
  CHECK_THAT(told({"zero.csv"}), Contains("column 'f_foot_y': the same in every row, it is left out"));
  CHECK_THAT(told({"good.csv", "zero.csv"}), Contains("zero.csv: column 'f_foot_y': 0 in every row"));
  write_log(f, "turned.csv", "f_foot_y", -1);
  CHECK_THAT(told({"turned.csv"}),
             Contains("column 'f_foot_y': down to -") && Contains("is its sign turned?") && !Contains("are they in N"));
  for (const double scale : {1e-3, 1e3}) {
    write_log(f, "scaled.csv", "f_foot_y", scale);
    CHECK_THAT(told({"scaled.csv"}), Contains("the forces of contacts (f_foot_y) come to") &&
                                         Contains("the robot weighs 22.3 N: are they in N?") &&
                                         Contains("f_foot_y_kN"));
  }
}
