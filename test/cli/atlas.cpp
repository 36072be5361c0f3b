// ukemi atlas as a user calls it: shards, kills, what another run left.
#include <catch2/catch.hpp>
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
  check_refused(f, {"atlas", kPaper, "--merge", "a", "-o", "out"}, {"--merge: SCENE has no say"});
}
