// Robots that are none: each refused with its place and the rule.
#include <catch2/catch.hpp>

#include "landing/body/body_scene.hpp"
#include "landing/model/motion.hpp"
#include "landing/model/scene_file.hpp"
#include "test/folder.hpp"

using namespace ukemi::landing;
using Catch::Matchers::Contains;

namespace {

const std::string kGood = R"([robot]
gravity = 9.81
[[robot.link]]
name = "body"
mass = 1
inertia_com = 0.01
[[robot.link]]
name = "leg"
parent = "body"
joint = "hip"
mass = 1
inertia_com = 0.01
[[robot.contact]]
name = "foot"
link = "leg"
at = [0.3, 0]
[drive.hip]
kind = "geared"
k_p = 50
k_d = 1
i_motor = 0.01
[floor]
stiffness = 1000
damping_normal = 10
[drop]
height = 0.1
pitch_deg = 0
[search]
hip = { phi_deg = [-90, 0] }
)";

/// The good scene with another text in a place.
std::string with(const std::string& from, const std::string& to) { return test::replaced(kGood, from, to); }
void refused(const std::string& text, const std::string& place, const std::string& rule) {
  const test::Folder f;
  const std::string path = f.write("leg.toml", text);
  INFO(text);
  try {
    (void)read_body_scene(path);
    FAIL("it was taken");
  } catch (const ukemi::InputError& e) {
    CHECK_THAT(e.what(), Contains("leg.toml:" + place));
    CHECK_THAT(e.what(), Contains(rule));
  }
}

}  // namespace

TEST_CASE("legs: bad robots are refused with their place and the rule") {
  const test::Folder f;
  CHECK(read_body_scene(f.write("leg.toml", kGood)).robot.joints[0].name == "hip");
  refused(with("parent = \"body\"", "parent = \"bodi\""), "9:10: ", "did you mean \"body\"?");
  refused(with("parent = \"body\"\njoint = \"hip\"\n", ""), "", "has none, and");
  refused(with("name = \"body\"", "name = \"body\"\nparent = \"leg\"\njoint = \"x\""),
          "5:10: ", "every link has a parent");
  refused(with("name = \"leg\"\nparent = \"body\"",
               "name = \"a\"\nparent = \"leg\"\njoint = \"ankle\"\nmass = 1\ninertia_com = 1\n[[robot.link]]\nname = "
               "\"leg\"\nparent = \"a\""),
          "9:10: ", "hang in a circle");
  refused(with("mass = 1\n", "mass = 0\n"), "5:8: ", "must be above 0");
  refused(with("inertia_com = 0.01\n", "inertia_com = -1\n"), "6:15: ", "must be above 0");
  refused(with("joint = \"hip\"\n", ""), "7:1: ", "the key 'joint' is missing");
  refused(with("name = \"leg\"", "name = \"body\""), "8:8: ", "the name is given twice");
  refused(with("name = \"leg\"", "name = \"my leg\""), "8:8: ", "letters, digits and _");
  refused(with("link = \"leg\"", "link = \"legs\""), "15:8: ", "did you mean \"leg\"?");
  refused(with("[drive.hip]", "[drive.hop]"), "10:9: ", "a table [drive.hip], or --actuator hip=FILE");
  refused(with("k_p = 50\n", ""), "17:1: ", "the key 'k_p' is missing");
  refused(with("k_d = 1", "kd = 1"), "17:1: ", "the key 'k_d' is missing (there is 'kd')");
  refused(with("kind = \"geared\"", "kind = \"gear\""), "18:8: ", "\"geared\", \"passive\"");
  refused(with("i_motor = 0.01", "i_motor = 0.01\ncontrol_delay = 0.001"), "22:1: ", "unknown key 'control_delay'");
  refused(with("gravity = 9.81", "gravity = 9.81\nbase = \"pinned\""),
          "3:8: ", "its pin_height above the floor is needed");
  refused(with("gravity = 9.81", "gravity = 9.81\nbase = \"pinned\"\npin_height = 1"),
          "28:10: ", "a pinned robot is not dropped");
  refused(with("gravity = 9.81", "gravity = 9.81\nbase = \"rail\"\nrail = { load_friction = 2 }"), "4:26: ", "0 to 1");
  refused(with("height = 0.1", "height = 0.1\npitch_rate = 1") + "[detection]\ndelay = 1\n", "32:9: ", "at most 0.1 s");
  refused(with("at = [0.3, 0]", "at = [0.3]"), "16:6: ", "2 numbers in [ ] are needed");
  refused(with("at = [0.3, 0]", "friction = 0.5"), "", "with friction it must be above 0");
  refused(with("damping_normal = 10", "damping_normal = 10\nslope_deg = 95"), "25:13: ", "between -90 and 90");
  refused(with("phi_deg = [-90, 0]", "phi_deg = [0, -90]"), "29:19: ", "the range is empty");
  refused(with("hip = {", "hop = {"), "29:1: ", "unknown key 'hop'");
  refused(with("[drop]", "[stop]"), "", "[drop] is missing");
  refused(kGood + "[release]\nfrom = 0.1\n", "", "a table [release.hip] is needed: the joint is driven");
  refused(kGood + "[release]\nfrom = -0.1\nhip = { phi_deg = 1 }\n", "", "must be at least 0");
  refused(kGood + "[release.hip]\nrate_deg = 1\n", "", "'phi_deg' is missing");
  refused(kGood + "[release]\nhip = { phi_deg = 1 }\nhop = { phi_deg = 1 }\n", "", "unknown key 'hop'");
  refused(kGood + "[joint.hip]\nphi_deg = [1, 0]\n", "", "the range is empty");
  refused(with("at = [0.3, 0]", "at = 0.1"), "16:6: ", "'0.1': 2 numbers in [ ] are needed");
  refused(kGood + "[stop.hip]\nphi_deg = [10, -10]\nstiffness = 1\n", "", "phi_deg: [10, -10]: two ends are needed");
  refused(kGood + "[stop.rail]\ns = [0, 1]\nstiffness = 1\n", "", "[stop.rail]: base = \"rail\" is needed");
}

TEST_CASE("legs: without [floor] contacts touch by their own laws, all of them or none") {
  const test::Folder f;
  const std::string floor = "[floor]\nstiffness = 1000\ndamping_normal = 10\n",
                    two =
                        "[[robot.contact]]\nname = \"top\"\n"
                        "link = \"body\"\n",
                    own = "at = [0.3, 0]\nstiffness = 800\ndamping_normal = 5";
  CHECK_FALSE(read_body_scene(f.write("leg.toml", with(floor, ""))).floor);
  const std::string all = test::replaced(with(floor, ""), "at = [0.3, 0]", own);
  const BodyScene scene = read_body_scene(f.write("leg.toml", all));
  CHECK(scene.floor);
  CHECK(scene.robot.contacts[0].law.stiffness == 800);
  refused(test::replaced(all, "[drive.hip]", two + "[drive.hip]"), "", "contact top has no stiffness");
}

TEST_CASE("legs: the release and the stops of each joint are read") {
  const test::Folder f;
  const BodyScene scene = read_body_scene(
      f.write("leg.toml", std::string(kGood) + "[release]\nfrom = 0.1\nhip = { phi_deg = -90, rate = 0.5 }\n" +
                              "[joint.hip]\nphi_deg = [-90, 180]\n"));
  REQUIRE(scene.release);
  CHECK(scene.release->from == 0.1);
  CHECK(scene.release->joints[0].phi == Approx(-1.5707963267948966));
  CHECK(scene.release->joints[0].rate == 0.5);
  REQUIRE(scene.loads.size() == 1);
  CHECK(scene.loads[0].name == "hip.angle");
  CHECK(scene.loads[0].phi[1] == Approx(3.141592653589793));
  const BodyMotion held = held_posture(scene);
  CHECK(held[0].release_phi() == scene.release->joints[0].phi);
  CHECK(held[0].release_rate() == 0.5);
  CHECK_FALSE(moves(held[0]));
}

TEST_CASE("legs: links that are too many, and a robot of links where two are needed") {
  std::string many = kGood;
  for (int i = 0; i < 7; ++i)
    many += "[[robot.link]]\nname = \"l" + std::to_string(i) + "\"\nparent = \"leg\"\njoint = \"j" + std::to_string(i) +
            "\"\nmass = 1\ninertia_com = 1\n";
  refused(many, "", "9 links: at most 8");
  const test::Folder f;
  CHECK_THROWS_WITH(read_scene(f.write("leg.toml", kGood)), Contains("leg.toml:3:1: ") && Contains("`ukemi simulate`"));
  CHECK_THROWS_WITH(read_scene(f.write("other.toml", "robot = \"leg.toml\"\n")), Contains("a robot of links"));
}
