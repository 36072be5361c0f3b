// ukemi atlas as a user calls it: shards, kills, what another run left.
#include <catch2/catch.hpp>
#include <regex>
#include <sstream>

#include "test/cli/refused.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

const Arguments kAtlas = {"atlas", kPaper,        "--actuator", kTable2,         "--height", "0.3:0.6:4", "--speed",
                          "0:1:3", "--pitch-deg", "0:30:4",     "--evaluations", "150",      "--quiet"};
constexpr std::size_t kDrops = 4 * 3 * 4;

/// atlas.csv without its # lines.
std::string table(const Folder& f, const std::string& folder) {
  std::istringstream in(read(f.at(folder + "/atlas.csv")));
  std::string out;
  for (std::string line; std::getline(in, line);)
    if (line[0] != '#') out += line + "\n";
  return out;
}

/// The program with SIGKILL after so many seconds; 0 where it was done before.
int killed_after(double seconds, const Arguments& arguments, const Folder& f) {
  std::string command = "cd " + shell_quoted(f.at("")) + " && exec timeout -s KILL " + std::to_string(seconds) + " " +
                        shell_quoted(UKEMI_PROGRAM);
  for (const std::string& a : arguments) command += " " + shell_quoted(a);
  return std::system((command + " >/dev/null 2>&1").c_str());
}

}  // namespace

TEST_CASE("atlas: shards put together are the single run, byte for byte, whatever the threads") {
  const Folder f;
  done(f, kAtlas + Arguments{"--threads", "1", "-o", "one"});
  done(f, kAtlas + Arguments{"--threads", "7", "-o", "seven"});
  for (const std::string k : {"1", "2", "3"}) done(f, kAtlas + Arguments{"--shard", k + "/3", "-o", "s" + k});
  CHECK(summary(f, "s2")["shard"] == "2/3");
  CHECK(summary(f, "s2")["drops"] < kDrops);
  done(f, {"atlas", "--merge", "s3", "s1", "s2", "-o", "all", "--quiet"});
  CHECK(table(f, "one") == table(f, "seven"));
  CHECK(table(f, "one") == table(f, "all"));
  const std::string rows = table(f, "one");
  CHECK(std::count(rows.begin(), rows.end(), '\n') == kDrops + 1);
  CHECK(read(f.at("one/atlas.bin")) == read(f.at("all/atlas.bin")));
  CHECK(summary(f, "all")["safest"] == summary(f, "one")["safest"]);
  CHECK(summary(f, "one")["planned"] == kDrops);
  // A merged atlas may be merged again; a part is no whole.
  done(f, {"atlas", "--merge", "all", "s1", "-o", "again", "--quiet"});
  const Arguments merge = {"atlas", "--merge"};
  check_refused(f, merge + Arguments{"s1", "s2"} + kOut, {"--merge: ", "drops are in none of the folders"});
  done(f, kAtlas + Arguments{"--shard", "1/3", "--seed", "2", "-o", "other"});
  check_refused(f, merge + Arguments{"s1", "other"} + kOut, {"other/atlas.bin: a part of another atlas"});
  check_refused(f, merge + Arguments{"s1", "none"} + kOut, {"none/atlas.bin: no such file"});
  check_refused(f, merge + Arguments{"s1", "s2", "s3", "-o", "s1"}, {"s1/atlas.bin: this run would write over it"});
  std::string changed = read(f.at("s1/scene.toml"));
  changed.replace(changed.find("link_length = 0.3"), 17, "link_length = 0.4");
  f.write("s1/scene.toml", changed);
  check_refused(f, merge + Arguments{"s1", "s2", "s3"} + kOut, {"s1/scene.toml: ", "not those of the atlas"});
}

TEST_CASE("atlas: killed again and again it loses no cell that was finished, and ends as if nothing had been") {
  const Folder f;
  done(f, kAtlas + Arguments{"-o", "whole"});
  constexpr std::size_t kBegin = 24, kEntry = 152;
  std::size_t kept = 0, kills = 0;
  for (int n = 0; n < 100 && kept < kDrops; ++n) {
    const std::string after = std::to_string(0.03 + 0.013 * (n * 7 % 11));
    if (killed_after(0.03 + 0.013 * (n * 7 % 11), kAtlas + Arguments{"--threads", "1", "-o", "out"}, f) == 0) break;
    ++kills;
    if (fs::exists(f.at("out/atlas.bin"))) break;  // killed when all was written
    const std::string journal = f.at("out/atlas.part");
    const std::size_t bytes = fs::exists(journal) ? fs::file_size(journal) : 0;
    const std::size_t now = bytes < kBegin ? 0 : (bytes - kBegin) / kEntry;
    CHECK(now >= kept);
    kept = now;
  }
  CHECK(kills > 2);
  done(f, kAtlas + Arguments{"-o", "out"});
  CHECK(summary(f)["resumed"] >= kept);
  CHECK(table(f, "out") == table(f, "whole"));
  CHECK(read(f.at("out/atlas.bin")) == read(f.at("whole/atlas.bin")));
  CHECK_FALSE(fs::exists(f.at("out/atlas.part")));
  done(f, kAtlas + Arguments{"-o", "out"});  // there is nothing left to do
  CHECK(summary(f)["resumed"] == kDrops);
  CHECK(table(f, "out") == table(f, "whole"));
}

TEST_CASE("atlas: Ctrl-C keeps what is finished, and the next run goes on from there") {
  const Folder f;
  Arguments args = kAtlas;
  args[11] = "4000";  // evaluations
  const Interrupted r = interrupted_after(1, args + Arguments{"-o", "out"}, f.at(""));
  CHECK(r.code == 130);
  CHECK(r.seconds < 1.5);
  CHECK(summary(f)["interrupted"] == true);
  CHECK(fs::exists(f.at("out/atlas.part")));
  CHECK_FALSE(fs::exists(f.at("out/atlas.bin")));
  const long planned = summary(f)["planned"];
  CHECK(std::size_t(planned) < kDrops);
  done(f, args + Arguments{"-o", "out"});
  CHECK(summary(f)["resumed"] == planned);
  done(f, args + Arguments{"-o", "whole"});
  CHECK(table(f, "out") == table(f, "whole"));
}

TEST_CASE("atlas: of a robot of links shards, kills and Ctrl-C leave what a single run leaves") {
  const Folder f;
  const Arguments hopper = {"atlas",  dataset("scenes/hopper.toml"), "--height", "0.1:0.5:9", "--evaluations", "1500",
                            "--quiet"};
  constexpr std::size_t kHeights = 9;
  done(f, hopper + Arguments{"--threads", "1", "-o", "one"});
  done(f, hopper + Arguments{"--threads", "3", "-o", "three"});
  CHECK(table(f, "one") == table(f, "three"));
  CHECK(summary(f, "one")["planned"] == kHeights);
  CHECK_THAT(table(f, "one"), Contains("phi_i_hip_deg,phi_f_hip_deg,phi_i_knee_deg,phi_f_knee_deg,duration,goal"));
  for (const std::string k : {"1", "2"}) done(f, hopper + Arguments{"--shard", k + "/2", "-o", "s" + k});
  done(f, {"atlas", "--merge", "s2", "s1", "-o", "deep/all", "--quiet"});
  CHECK(table(f, "one") == table(f, "deep/all"));
  CHECK(read(f.at("one/atlas.bin")) == read(f.at("deep/all/atlas.bin")));
  done(f, {"simulate", "deep/all/scene.toml", "-o", "sim", "--quiet"});  // its robot is found from there
  const Interrupted r = interrupted_after(0.4, hopper + Arguments{"--threads", "1", "-o", "out"}, f.at(""));
  CHECK(r.code == 130);
  CHECK(fs::exists(f.at("out/atlas.part")));
  const std::size_t begun = summary(f)["planned"];
  CHECK(begun < kHeights);
  if (killed_after(0.2, hopper + Arguments{"--threads", "1", "-o", "out"}, f) != 0)
    CHECK(fs::exists(f.at("out/atlas.part")));
  done(f, hopper + Arguments{"-o", "out"});
  CHECK(std::size_t(summary(f)["resumed"]) >= begun);
  CHECK(table(f, "out") == table(f, "one"));
  CHECK(read(f.at("out/atlas.bin")) == read(f.at("one/atlas.bin")));

  // Asked between its drops: a motion that plays, better than holding.
  done(f, {"atlas", "--ask", "one", "--height", "0.33", "-o", "asked", "--quiet"});
  const Json asked = summary(f, "asked");
  CHECK(asked["inside"] == true);
  CHECK(asked["peak_acceleration"] < asked["hold"]["peak_acceleration"]);
  done(f, {"simulate", dataset("scenes/hopper.toml"), "--motion", "asked/motion.toml", "-o", "played", "--quiet"});
  done(f, {"atlas", "--ask", "one", "--height", "0.9", "-o", "far", "--quiet"});
  CHECK(summary(f, "far")["inside"] == false);
  CHECK((summary(f, "far")["holds"] || summary(f, "far")["planned_for"] != summary(f, "asked")["planned_for"]));
  check_refused(f, {"atlas", "--ask", "one", "--height", "0.3", "--pitch-deg", "20", "-o", "bad"},
                {"pitch: a robot on a rail keeps the pitch of its scene"});
  check_refused(f, {"atlas", "--ask", "one", "--speed", "2", "-o", "bad"}, {"speed: the base of this robot has no"});
  check_refused(f,
                {"atlas", dataset("scenes/three_links.toml"), "--height", "0.3:0.5:2", "--speed", "0:1:2",
                 "--pitch-deg", "0:4000:2", "-o", "bad"},
                {"pitch: 0 to 4000 deg: within 360 deg"});

  // What is damaged is refused, by its name.
  std::string bytes = read(f.at("s1/atlas.bin"));
  bytes[700] = char(bytes[700] ^ 1);
  f.write("s1/atlas.bin", bytes);
  check_refused(f, {"atlas", "--merge", "s1", "s2", "-o", "bad"},
                {"s1/atlas.bin: its bytes are not those of its checksum"});
  f.write("one/atlas.bin", read(f.at("three/atlas.bin")).substr(0, 1000));
  check_refused(f, {"atlas", "--ask", "one", "-o", "bad"}, {"one/atlas.bin: 1000 bytes: its header says"});
  check_refused(f, {"atlas", "--ask", "three", "-o", "three"}, {"three/scene.toml: this run would write over it"});
}

TEST_CASE("atlas: of a robot of links it says which axes the base has, and keeps its scene as files") {
  const Folder f;
  const std::string hopper = dataset("scenes/hopper.toml"), links = dataset("scenes/three_links.toml");
  const Arguments atlas = {"atlas", hopper, "--height", "0.1:0.5:3", "--evaluations", "100", "--quiet"};
  check_refused(f, {"atlas", hopper, "-o", "out"}, {"--height: LO:HI:N is needed"});
  check_refused(f, atlas + Arguments{"--speed", "0:1:2"} + kOut, {"atlas: speed: the base", "no forward speed"});
  check_refused(f, atlas + Arguments{"--pitch-deg", "0:1:2"} + kOut, {"atlas: pitch: a robot on a rail"});
  check_refused(f, atlas + Arguments{"--bumps", "1"} + kOut, {"--bumps", "[motion]"});
  check_refused(f, atlas + Arguments{"--actuator", "knee=" + kTable2} + kOut,
                {"--actuator: ", "has a drive in its file"});
  check_refused(f, {"atlas", links, "--height", "0.1:0.5:3", "-o", "out"}, {"--speed: LO:HI:N is needed"});
  check_refused(f, atlas + Arguments{"--robust", "mean", "--scatter", "forward_speed=0.1"} + kOut,
                {"scatter: forward_speed", "this base"});
  f.write("free.toml", std::regex_replace(read(hopper), std::regex("\"\\.\\./robots"), "\"" + dataset("robots")) +
                           "\n[motion]\nbumps = 4\n");
  check_refused(f, {"atlas", "free.toml", "--height", "0.1:0.5:3", "-o", "out"}, {"13 variables", "at most 12"});
  done(f, atlas + Arguments{"--robust", "mean", "--samples", "16", "-o", "robust"});
  CHECK(summary(f, "robust")["goal"] == "mean");
  // A drive that the files leave open goes with the scene.
  std::string robot = read(dataset("robots/three_links.toml"));
  f.write("robot.toml", robot.substr(0, robot.find("[drive.")));
  std::string scene = read(links);
  f.write("scene.toml", scene.replace(scene.find("../robots/three_links.toml\"\n\n"), 26, "robot.toml"));
  done(f,
       {"atlas", "scene.toml", "--actuator", "hip=" + kTable2, "--actuator", "knee=" + kTable2, "--height", "0.3:0.5:2",
        "--speed", "0.5:0.7:2", "--pitch-deg", "10:20:2", "--evaluations", "60", "--quiet", "-o", "a/b"});
  CHECK_THAT(read(f.at("a/b/scene.toml")), Contains("[drive.hip]") && Contains("[drive.knee]"));
  done(f, {"atlas", "--ask", "a/b", "--height", "0.4", "--speed", "0.6", "-o", "asked", "--quiet"});
  CHECK(summary(f, "asked")["inside"] == true);
}

TEST_CASE("atlas: asked, that of the paper's robot answers too") {
  const Folder f;
  done(f, kAtlas + Arguments{"-o", "out"});
  done(f,
       {"atlas", "--ask", "out", "--height", "0.45", "--speed", "0.6", "--pitch-deg", "18", "-o", "asked", "--quiet"});
  CHECK(summary(f, "asked")["inside"] == true);
  CHECK(summary(f, "asked")["peak_acceleration"] < summary(f, "asked")["hold"]["peak_acceleration"]);
  check_refused(f, {"atlas", "--ask", "out", kPaper, "-o", "bad"}, {"--ask: SCENE"});
  check_refused(f, {"atlas", "--ask", "out", "--height", "-1", "-o", "bad"}, {"height"});
  check_refused(f, {"atlas", "--ask", "none", "-o", "bad"}, {"none/scene.toml: no such file"});
}

TEST_CASE("atlas: bad input is refused, and nothing is written") {
  const Folder f;
  const auto with = [&](std::size_t at, const std::string& text) {
    Arguments a = kAtlas;
    a[at] = text;
    return a + kOut;
  };
  check_refused(f, with(5, "0.3:0.1:4"), {"--height: '0.3:0.1:4'"});
  check_refused(f, with(5, "-0.3:0.1:4"), {"height", "at least 0 m"});
  check_refused(f, with(7, "0:1"), {"--speed: '0:1'", "LO:HI:N"});
  check_refused(f, with(9, "x:1:2"), {"--pitch-deg: 'x'"});
  check_refused(f, with(11, "0"), {"evaluations: 0"});
  for (const char* shard : {"0/2", "3/2", "1/99"})
    check_refused(f, kAtlas + Arguments{"--shard", shard} + kOut, {"shard"});
  check_refused(f, kAtlas + Arguments{"--shard", "2"} + kOut, {"--shard: '2'", "K/N"});
  check_refused(f, kAtlas + Arguments{"--scatter", "height=0.1"} + kOut, {"--scatter: without --robust"});
  check_refused(f, kAtlas + Arguments{"--robust", "best"} + kOut, {"--robust: 'best'"});
  check_refused(f, {"atlas", kPaper, "-o", "out"}, {"SCENE and --actuator are needed"});
  check_refused(f, {"atlas", kPaper, "--merge", "a", "-o", "out"}, {"--merge: SCENE has no effect"});
}
