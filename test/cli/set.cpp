// --set KEY=VALUE: the answer of the file that has the value, a file of it, and what is refused.
#include <catch2/catch.hpp>

#include <sstream>

#include "test/cli/refused.hpp"

using namespace cli;

namespace {

const std::string kHopper = dataset("scenes/hopper.toml");

/// The hopper's scene and its robot with [command], in a folder.
void write_hopper(const Folder& f, const std::string& name, const std::string& scene, const std::string& robot) {
  f.write(name + "_robot.toml", robot);
  f.write(name + ".toml", replaced(scene, "\"../robots/hopper.toml\"", "\"" + name + "_robot.toml\""));
}
/// A CSV file without its comments.
std::string rows_of(const std::string& csv) {
  std::string out, line;
  for (std::istringstream in(csv); std::getline(in, line);)
    if (!line.starts_with("#")) out += line + "\n";
  return out;
}
/// All of a summary but what differs from run to run.
Json numbers(const Folder& f, const std::string& folder) {
  Json out = summary(f, folder);
  for (const char* key : {"provenance", "time_s", "map_time_s", "files"}) out.erase(key);
  return out;
}

}  // namespace

TEST_CASE("set: --set gives what the edited file gives, bit for bit, and keeps a file that runs as it is") {
  const Folder f;
  const std::string scene = read(kHopper),
                    robot = read(dataset("robots/hopper.toml")) +
                            "\n[command.knee]\ntorque_gain = 0.7\n[stop.knee]\nphi_deg = [-360, -12]\nstiffness = "
                            "700\ndamping = 2\n";
  write_hopper(f, "scene", scene, robot);
  std::string edited_robot = replaced(replaced(robot, "k_p = 50", "k_p = 61.3"), "phi_deg = [-360, -12]",
                                      "phi_deg = [-350, -31.7]"),
              edited_scene = replaced(replaced(scene, "friction = 0.8", "friction = 0.37"), "hold_deg = -70 }",
                                      "hold_deg = -63.1 }");
  write_hopper(f, "edited", edited_scene, edited_robot);
  const Arguments set = {"--set", "drive.hip.k_p=61.3",  "--set", "stop.knee.phi_deg=-350:-31.7",
                         "--set", "floor.friction=0.37", "--set", "search.knee.hold_deg=-63.1"};
  const auto same = [&](const Arguments& verb, const Arguments& more, const char* rows) {
    INFO(verb[0]);
    done(f, verb + Arguments{"scene.toml"} + more + set + Arguments{"--no-report", "-o", "set"});
    done(f, verb + Arguments{"edited.toml"} + more + Arguments{"--no-report", "-o", "edited"});
    CHECK(numbers(f, "set") == numbers(f, "edited"));
    CHECK(rows_of(read(f.at(std::string("set/") + rows))) == rows_of(read(f.at(std::string("edited/") + rows))));
    done(f, verb + Arguments{"set/set_scene.toml"} + more + Arguments{"--no-report", "-o", "again"});
    CHECK(numbers(f, "again") == numbers(f, "edited"));
  };
  same({"simulate"}, {}, "trajectory.csv");
  const Arguments ends = {"--set", "drive.hip.k_p=61.3",        "--set", "stop.knee.low_deg=-350",
                          "--set", "stop.knee.high_deg=-31.7",  "--set", "floor.friction=0.37",
                          "--set", "search.knee.hold_deg=-63.1"};
  done(f, Arguments{"simulate", "scene.toml"} + ends + Arguments{"--no-report", "-o", "ends"});
  CHECK(numbers(f, "ends") == numbers(f, "edited"));
  same({"optimize"}, {"--evaluations", "200"}, "motion.csv");
  same({"risk"}, {"--hold", "hip=35,knee=-70", "--samples", "100"}, "histogram.csv");
  same({"map"}, {"--vary", "phi_f_knee:4"}, "map.csv");
}

TEST_CASE("set: every number of trade, ranges of a search, and a robot alone") {
  const Folder f;
  const std::string scene = read(kHopper), robot = read(dataset("robots/hopper.toml"));
  write_hopper(f, "scene", scene, robot);
  const auto peaks = [&](const Arguments& arguments, const std::string& to = "out") {
    done(f, Arguments{"simulate"} + arguments + Arguments{"--no-report", "-o", to});
    return summary(f, to)["peaks"];
  };
  const Json as_it_is = peaks({"scene.toml"});
  for (const char* one : {"drive.*.k_p=30", "robot.link.shank.mass=0.5", "robot.link.shank.length=0.25",
                          "robot.contact.foot.at.along=0.18", "robot.contact.*.damping_normal=40", "robot.gravity=3",
                          "robot.rail.viscous=20", "floor.stiffness=5000", "drop.height=0.1"}) {
    INFO(one);
    const Json set = peaks({"scene.toml", "--set", one});
    CHECK(set != as_it_is);
    CHECK(peaks({"out/set_scene.toml"}, "again") == set);
  }
  // What trade tries is what is set.
  done(f, {"trade", "scene.toml", "--vary", "robot.link.shank.length=0.2:0.25:2", "--evaluations", "100", "--no-report",
           "-o", "trade"});
  done(f, {"optimize", "scene.toml", "--set", "robot.link.shank.length=0.25", "--evaluations", "100", "--no-report",
           "-o", "plan"});
  CHECK(summary(f, "trade")["points"].back()["held"].get<double>() ==
        Approx(summary(f, "plan")["hold"]["peak_acceleration"].get<double>()).epsilon(1e-12));
  // A robot alone, with what a plan needs.
  std::string alone = robot;
  for (std::size_t at = 0; (at = alone.find("[[robot.contact]]", at)) != std::string::npos; at += 20)
    alone.insert(at + 17, "\nstiffness = 20000\ndamping_normal = 120");
  f.write("alone.toml", alone);
  f.write("by_hand.toml", alone +
                              "\n[search]\nduration = [0.2, 0.5]\nhip = { phi_deg = [10, 80], hold_deg = 40 }\n"
                              "[search.knee]\nphi_deg = [-120, -20]\n[joint.knee]\nphi_deg = [-130, -5]\n");
  const Arguments plan = {"--height", "0.2", "--evaluations", "200", "--no-report", "-o"};
  done(f, Arguments{"optimize", "alone.toml", "--set", "search.hip.phi_deg=10:80", "--set", "search.hip.hold_deg=40",
                    "--set", "search.knee.phi_deg=-120:-20", "--set", "search.duration=0.2:0.5", "--set",
                    "joint.knee.phi_deg=-130:-5"} +
              plan + Arguments{"set"});
  done(f, Arguments{"optimize", "by_hand.toml"} + plan + Arguments{"hand"});
  CHECK(numbers(f, "set") == numbers(f, "hand"));
  done(f, {"optimize", "set/set_scene.toml", "--evaluations", "200", "--no-report", "-o", "again"});
  CHECK(summary(f, "again")["peak_acceleration"] == summary(f, "set")["peak_acceleration"]);
}

TEST_CASE("set: what there is not, or cannot be, is refused in a line") {
  const Folder f;
  const auto refused = [&](const std::string& set, const std::vector<std::string>& texts) {
    INFO(set);
    std::vector<std::string> all = {"--set"};
    all.insert(all.end(), texts.begin(), texts.end());
    check_refused(f, {"simulate", kHopper, "--set", set, "-o", "out"}, all);
  };
  refused("drive.hip.kp=3", {"drive.hip.kp", "did you mean"});
  refused("drive.elbow.k_p=3", {"drive.elbow.k_p", "no number of this robot"});
  refused("drive.hip.k_sea=3", {"drive.hip.k_sea", "no number of this robot"});
  refused("stop.knee.high_deg=3", {"stop.knee.high_deg", "no number of this robot"});
  refused("drive.hip.k_p=-1", {"hopper.toml:", "k_p", "-1", "must be at least 0"});
  refused("drive.hip.k_p=stiff", {"drive.hip.k_p", "stiff"});
  refused("drive.hip.k_p", {"'drive.hip.k_p': KEY=VALUE is needed"});
  refused("stop.knee.phi_deg=-90:-20", {"stop.knee.phi_deg: the robot's file has no [stop.knee]"});
  refused("search.hip.phi_deg=30", {"search.hip.phi_deg", "30"});
  refused("search.hip.phi_deg=30:10", {"search.hip.phi_deg", "30:10"});
  refused("search.elbow.phi_deg=1:2", {"search.elbow.phi_deg", "search.hip.phi_deg"});
  refused("robot.link.shank.length=-1", {"robot.link.shank.length", "above 0"});
  refused("joint.hip=1:2", {"joint.hip"});
  refused("robot.contact.foot.pad.stiffness=100", {"pad"});
  // A drive in a file of its own: the line shows the way, which is one.
  const std::string robot = read(dataset("robots/hopper.toml")), table2 = read(dataset("actuators/table2.toml"));
  const std::size_t hip = robot.find("[drive.hip]"), knee = robot.find("[drive.knee]");
  REQUIRE((hip != std::string::npos && hip < knee));
  write_hopper(f, "scene", read(kHopper),
               robot.substr(0, hip) + "[drive.hip]\nfile = \"hip.toml\"\n" + robot.substr(knee));
  f.write("hip.toml", table2), f.write("copy.toml", replaced(table2, "k_p = ", "k_p = 1"));
  check_refused(f, {"simulate", "scene.toml", "--set", "drive.hip.k_p=30", "-o", "out"},
                {"--set: drive.hip.k_p: its drive stands in 'hip.toml'", "--actuator hip=COPY"});
  const auto end = [&](const Arguments& more) {
    done(f, Arguments{"simulate", "scene.toml", "--no-report", "-o", "out"} + more);
    return summary(f)["t_end"].get<double>();
  };
  CHECK(end({"--actuator", "hip=copy.toml"}) != end({}));
  check_refused(f,
                {"simulate", dataset("scenes/paper.toml"), "--actuator", dataset("actuators/table2.toml"), "--hold",
                 "-45", "--set", "drop.height=1", "-o", "out"},
                {"--set: of robots of links"});
}
