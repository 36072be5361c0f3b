// What other programs read: --export.
#include <catch2/catch.hpp>
#include <cmath>
#include <regex>
#include <set>
#include <sstream>

#include "common/degrees.hpp"
#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;
using ukemi::kDegree;

namespace {

const Arguments kSimulate = {"simulate", kPaper, "--actuator", kTable2, "--no-report", "-o", "out"};

struct Point {
  double t, phi, dphi, ddphi;
};
/// The points of a JointTrajectory as these files write it, each key once and in its place.
std::vector<Point> points_of(const std::string& yaml) {
  const std::string number = "(-?[0-9]+\\.[0-9]+(?:e[-+][0-9]+)?)";  // as YAML 1.1 has it
  const std::regex point("- positions: \\[" + number + "\\]\n  velocities: \\[" + number + "\\]\n  accelerations: \\[" +
                         number + "\\]\n  time_from_start: \\{sec: ([0-9]+), nanosec: ([0-9]{1,9})\\}\n");
  std::vector<Point> out;
  std::string rest = yaml.substr(yaml.find("points:\n") + 8);
  for (std::smatch m; std::regex_search(rest, m, point, std::regex_constants::match_continuous); rest = m.suffix())
    out.push_back({std::stod(m[4]) + 1e-9 * std::stod(m[5]), std::stod(m[1]), std::stod(m[2]), std::stod(m[3])});
  CHECK(rest.empty());
  return out;
}

/// Rows of a CSV file, `#` lines left out; names from its header.
struct Rows {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
  explicit Rows(const std::string& text) {
    std::istringstream in(text);
    for (std::string line, cell; std::getline(in, line);) {
      if (line[0] == '#') continue;
      std::istringstream cells(line);
      const bool header = names.empty();
      if (!header) rows.emplace_back();
      while (std::getline(cells, cell, ',')) header ? names.push_back(cell) : rows.back().push_back(std::stod(cell));
    }
  }
};

/// The quintic of both points, by Bernstein's form: its six control values follow from values and derivatives.
double spline(const std::vector<Point>& points, double t) {
  std::size_t k = 1;
  while (k + 1 < points.size() && t > points[k].t) ++k;
  const Point &a = points[k - 1], &b = points[k];
  const double h = b.t - a.t, s = (t - a.t) / h;
  double c[6];
  c[0] = a.phi, c[1] = c[0] + a.dphi * h / 5, c[2] = 2 * c[1] - c[0] + a.ddphi * h * h / 20;
  c[5] = b.phi, c[4] = c[5] - b.dphi * h / 5, c[3] = 2 * c[4] - c[5] + b.ddphi * h * h / 20;
  for (int n = 5; n > 0; --n)  // de Casteljau
    for (int i = 0; i < n; ++i) c[i] += s * (c[i + 1] - c[i]);
  return c[0];
}

/// The largest distance of the spline from the rows of motion.csv from t = 0 on.
double misfit(const std::vector<Point>& points, const Rows& motion) {
  double worst = 0;
  for (const auto& row : motion.rows)
    if (row[0] >= 0) worst = std::max(worst, std::abs(spline(points, row[0]) - row[1]));
  return worst;
}

}  // namespace

TEST_CASE("export: a JointTrajectory gives the motion by a quintic spline") {
  const Folder f;
  const Arguments optimize = {"optimize",    kPaper,     "--actuator", kTable2,  "--evaluations",
                              "200",         "--export", "ros2",       "--rate", "5000",
                              "--no-report", "-o",       "out"};
  done(f, optimize);
  std::string yaml = read(f.at("out/motion_ros2.yaml"));
  CHECK_THAT(yaml, Contains("joint_names: [\"knee\"]\n") && Contains("# 2 points: the motion itself") &&
                       Contains("After the last point its position is held."));
  CHECK(points_of(yaml).size() == 2);
  CHECK(misfit(points_of(yaml), Rows(read(f.at("out/motion.csv")))) < 1e-8);  // 1 ns
  CHECK(!fs::exists(f.at("out/reposition_ros2.yaml")));

  done(f, optimize + Arguments{"--bumps", "4", "--release-phi", "-45", "--release-from", "0.1", "--joint", "leg/knee"});
  yaml = read(f.at("out/motion_ros2.yaml"));
  std::vector<Point> points = points_of(yaml);
  CHECK_THAT(yaml, Contains("joint_names: [\"leg/knee\"]\n") && Contains("the motion within 0.0001 rad"));
  CHECK(points.size() > 2);
  CHECK(points.size() < 20);
  const Rows motion(read(f.at("out/motion.csv")));
  CHECK(points.front().t > 0);  // the controller goes on from its own reference: here that of the expected touchdown
  const auto touchdown = std::find_if(motion.rows.begin(), motion.rows.end(), [](auto& row) { return row[0] >= 0; });
  points.insert(points.begin(), {0, (*touchdown)[1], 0, 0});
  CHECK(misfit(points, motion) < 1e-4);
  const std::vector<Point> air = points_of(read(f.at("out/reposition_ros2.yaml")));
  REQUIRE(air.size() == 3);
  CHECK(air[1].t == 0.1);
  CHECK(air[0].phi == Approx(-45 / 57.29577951308232));
  for (const auto& row : motion.rows)
    if (row[0] < 0 && row[3] <= air[2].t) CHECK(std::abs(spline(air, row[3]) - row[1]) < 1e-8);
}

TEST_CASE("export: what a motion has beside its reference is said") {
  const Folder f;
  f.write("motion.toml", "[motion]\nphi_i_deg = -27\nphi_f_deg = -82\nduration = 0.169\ngain_p = 0.5\n");
  done(f, kSimulate + Arguments{"--motion", "motion.toml", "--export", "ros2"});
  const std::string yaml = read(f.at("out/motion_ros2.yaml"));
  CHECK_THAT(yaml, Contains("Not in this message: from its start on K_p times 0.5 and K_d times 1."));
  CHECK(points_of(yaml)[1].t == 0.169);
}

TEST_CASE("export: PlotJuggler gets one header, numbers alone, and a time that rises") {
  const Folder f;
  done(f, kSimulate + Arguments{"--hold", "-45", "--export", "plotjuggler,ros2"});
  const std::string text = read(f.at("out/plotjuggler.csv"));
  CHECK(text.find('#') == text.npos);
  CHECK(text.substr(0, text.find('\n')).find(' ') == text.npos);  // its reader would take blanks for separators
  const Rows rows(text), trajectory(read(f.at("out/trajectory.csv")));
  REQUIRE(rows.names.size() == trajectory.names.size());
  CHECK(std::set<std::string>(rows.names.begin(), rows.names.end()).size() == rows.names.size());
  CHECK(rows.names[0] == "time[s]");
  for (const std::string& name : rows.names) CHECK(name.back() == ']');
  REQUIRE(rows.rows.size() == trajectory.rows.size());
  int events = 0;
  for (std::size_t i = 1; i < rows.rows.size(); ++i) {
    if (!(rows.rows[i][0] > rows.rows[i - 1][0])) FAIL("time does not rise in row " << i);
    if (std::vector<double>(rows.rows[i].begin() + 1, rows.rows[i].end()) !=
        std::vector<double>(trajectory.rows[i].begin() + 1, trajectory.rows[i].end()))
      FAIL("another row " << i);
    if (std::abs(rows.rows[i][0] - trajectory.rows[i][0]) > 1e-12) FAIL("another time in row " << i);
    events += trajectory.rows[i][0] == trajectory.rows[i - 1][0];
  }
  CHECK(events > 5);
  CHECK(fs::exists(f.at("out/motion_ros2.yaml")));
  CHECK(summary(f)["files"].size() == 5);
  done(f, kSimulate + Arguments{"--hold", "-45"});  // and the next run takes them away
  CHECK(!fs::exists(f.at("out/plotjuggler.csv")));
}

TEST_CASE("export: what is no format or no name is refused") {
  const Folder f;
  check_refused(f, kSimulate + Arguments{"--hold", "-45", "--export", "ros"}, {"--export: 'ros': ros2 or plotjuggler"});
  check_refused(f, kSimulate + Arguments{"--hold", "-45", "--export", "ros2", "--joint", "a b"}, {"--joint: 'a b': "});
}

TEST_CASE("export: of a robot of links one message holds every driven joint, one file every row") {
  const Folder f;
  const std::string three = dataset("scenes/three_links.toml");
  f.write("motion.toml",
          "[motion.hip]\nphi_i_deg = 20\nphi_f_deg = -40\nduration = 0.3\n"
          "[motion.knee]\nphi_i_deg = -60\nphi_f_deg = -80\nduration = 0.2\ngain_d = 0.5\n"
          "[reposition.knee]\nphi_deg = -45\nfrom = 0.05\nto = 0.2\n");
  done(f, {"simulate", three, "--motion", "motion.toml", "--export", "ros2,plotjuggler", "--no-report", "-o", "out"});
  const std::string yaml = read(f.at("out/motion_ros2.yaml")), air = read(f.at("out/reposition_ros2.yaml"));
  CHECK_THAT(yaml, Contains("joint_names: [\"hip\", \"knee\"]\n") && Contains("# 2 points: the motion itself") &&
                       Contains("of knee K_p times 1 and K_d times 0.5."));
  // The union of the times 0.2 and 0.3; the knee stands at -80 deg from 0.2 s on, the hip is in its quintic there.
  const std::regex points(
      "- positions: \\[(.*), -1.396263401595463.*\\]\n  velocities: \\[(.*), 0.0\\]\n.*\n  time_from_start: \\{sec: 0, "
      "nanosec: 200000000\\}\n- positions: \\[-0.698131700797731.*, -1.396263401595463.*\\]\n  velocities: "
      "\\[0.0, 0.0\\]\n.*\n  time_from_start: \\{sec: 0, nanosec: 300000000\\}\n$");
  std::smatch m;
  REQUIRE(std::regex_search(yaml, m, points));
  const double s = 2.0 / 3, range = -60 / 57.29577951308232;
  CHECK(std::stod(m[1]) ==
        Approx(20 / 57.29577951308232 + range * s * s * s * (10 - 15 * s + 6 * s * s)).epsilon(1e-9));
  CHECK(std::stod(m[2]) == Approx(range / 0.3 * 30 * s * s * (1 - s) * (1 - s)).epsilon(1e-9));
  CHECK_THAT(air, Contains("nanosec: 50000000}") && Contains("nanosec: 200000000}") &&
                      Contains("positions: [0.3490658503988659, -0.7853981633974483]"));
  const std::string text = read(f.at("out/plotjuggler.csv"));
  CHECK(text.find('#') == text.npos);
  const Rows rows(text), trajectory(read(f.at("out/trajectory.csv")));
  REQUIRE(rows.names.size() == trajectory.names.size());
  CHECK(std::set<std::string>(rows.names.begin(), rows.names.end()).size() == rows.names.size());
  CHECK(std::find(rows.names.begin(), rows.names.end(), "joints/knee/reference[rad]") != rows.names.end());
  REQUIRE(rows.rows.size() == trajectory.rows.size());
  for (std::size_t i = 1; i < rows.rows.size(); ++i)
    if (!(rows.rows[i][0] > rows.rows[i - 1][0])) FAIL("time does not rise in row " << i);
  done(f, {"optimize", three, "--evaluations", "40", "--export", "ros2", "--no-report", "-o", "best"});
  CHECK_THAT(read(f.at("best/motion_ros2.yaml")), Contains("joint_names: [\"hip\", \"knee\"]\n"));
  check_refused(f, {"simulate", three, "--export", "ros2", "--joint", "leg"},
                {"--joint: 'leg': ", "one driven joint", "hip, knee"});
}

TEST_CASE("export: a message has the robot's own joint names, signs and zeros, and no other file has") {
  const Folder f;
  std::string robot = read(dataset("robots/three_links.toml"));
  for (int k = 0; k < 2; ++k) robot = replaced(robot, "\"../actuators/table2.toml\"", "\"table2.toml\"");
  f.write("table2.toml", read(kTable2));
  robot = replaced(robot, "joint = \"hip\"", "joint = \"hip\"\nq = { name = \"l-hip\", sign = -1, zero_deg = 90 }");
  f.write("robot.toml", robot);
  f.write("scene.toml", replaced(read(dataset("scenes/three_links.toml")), "robot = \"../robots/three_links.toml\"",
                                 "robot = \"robot.toml\""));
  f.write("motion.toml",
          "[motion.hip]\nphi_i_deg = 20\nphi_f_deg = -40\nduration = 0.3\n"
          "[motion.knee]\nphi_i_deg = -60\nphi_f_deg = -80\nduration = 0.3\n");
  const Arguments play = {"--motion", "motion.toml", "--export", "ros2", "--no-report", "-o"};
  done(f, Arguments{"simulate", "scene.toml"} + play + Arguments{"own"});
  done(f, Arguments{"simulate", dataset("scenes/three_links.toml")} + play + Arguments{"plain"});
  const std::string own = read(f.at("own/motion_ros2.yaml"));
  CHECK_THAT(own, Contains("joint_names: [\"l-hip\", \"knee\"]\n") && Contains("q = 1.57079632679489") &&
                      Contains(" rad - phi of l-hip"));
  const std::regex ends("positions: \\[([^,]*), ([^,]*)\\]");
  const auto numbers = [&](const std::string& yaml) {
    std::vector<std::array<double, 2>> out;
    for (std::sregex_iterator i(yaml.begin(), yaml.end(), ends), none; i != none; ++i)
      out.push_back({std::stod((*i)[1]), std::stod((*i)[2])});
    return out;
  };
  const auto q = numbers(own), phi = numbers(read(f.at("plain/motion_ros2.yaml")));
  REQUIRE(q.size() == phi.size());
  REQUIRE(q.size() == 2);
  for (std::size_t k = 0; k < q.size(); ++k) {
    CHECK(q[k][0] == Approx(90 * kDegree - phi[k][0]).epsilon(1e-12));
    CHECK(q[k][1] == phi[k][1]);
  }
  CHECK(Rows(read(f.at("own/trajectory.csv"))).rows == Rows(read(f.at("plain/trajectory.csv"))).rows);
  f.write("robot.toml", replaced(robot, "sign = -1", "sign = 0"));
  check_refused(f, Arguments{"simulate", "scene.toml", "-o", "bad"}, {"sign: 0: 1 or -1 is needed"});
}
