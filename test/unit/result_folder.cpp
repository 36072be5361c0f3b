// A folder of results is of one run: whatever it held before, and whenever the program is killed.
#include "common/result_folder.hpp"

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <random>
#include <set>
#include <sstream>

#include "common/parallel.hpp"
#include "test/folder.hpp"

using namespace ukemi;
using namespace test;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> kNames = {"a.csv", "b.csv", "hit_#.csv", "report.html"};
using Files = std::map<std::string, std::string>;

/// The results of run i: which files there are, and what is in each, tells i; so does the summary, which names them.
Files results(int i) {
  const std::string mark = std::to_string(i) + "\n" + std::string(20'000, 'x');
  Files files = {{"a.csv", mark}};
  if (i % 2 == 0) files["b.csv"] = mark;
  for (int k = 1; k <= i % 5; ++k) files["hit_" + std::to_string(k) + ".csv"] = mark;
  std::string summary = std::to_string(i) + "\n";
  for (const auto& [name, content] : files) summary += name + "\n";
  files["summary.json"] = summary;
  return files;
}

/// What stands in the folder under the names of results.
Files held(const Folder& f, const std::string& name = "out") {
  Files out;
  for (const auto& [file, content] : f.content(name))
    if (ResultFolder(f.at("other"), kNames).owns(file)) out[file] = content;
  return out;
}

/// Which run the folder is of, all of it; -1 if of none.
int run_of(const Files& files) {
  if (files.count("summary.json") == 0) return -1;
  const int i = std::stoi(files.at("summary.json"));
  return files == results(i) ? i : -1;
}

/// Replaces the results over and over, in a process of its own that is killed after `delay` [us].
void kill_while_replacing(const Folder& f, int delay) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    try {
      for (int i = 1;; ++i) ResultFolder(f.at("out"), kNames).replace(results(i));
    } catch (...) {
    }
    ::_exit(1);
  }
  ::usleep(useconds_t(delay));
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  REQUIRE(WIFSIGNALED(status));
}

std::set<std::string> names_in(const Folder& f) {
  std::set<std::string> out;
  for (const auto& entry : fs::directory_iterator(f.at(""))) out.insert(entry.path().filename());
  return out;
}

int kills() {
  const char* given = std::getenv("UKEMI_KILLS");
  return given ? std::stoi(given) : 60;
}

}  // namespace

TEST_CASE("results replace the earlier ones of the names, all of them, and nothing else") {
  const Folder f;
  const ResultFolder out(f.at("a/out"), kNames);
  CHECK(!fs::exists(f.at("a")));
  out.replace(results(4));
  CHECK(run_of(held(f, "a/out")) == 4);
  SECTION("in a folder of results") { out.replace(results(5)); }
  SECTION("beside what is another's") {
    f.write("a/out/notes.txt", "mine");
    f.write("a/out/hit_a.csv", "mine"), f.write("a/out/hit_1_b.csv", "mine"), f.write("a/out/hit_.csv", "mine");
    fs::create_directories(f.at("a/out/deeper"));
    f.write("a/out/deeper/a.csv", "mine");
    out.replace(results(5));
    for (const char* name : {"notes.txt", "hit_a.csv", "hit_1_b.csv", "hit_.csv", "deeper/a.csv"})
      CHECK(read(f.at(std::string("a/out/") + name)) == "mine");
  }
  SECTION("where the program was started") {
    const fs::path before = fs::current_path();
    fs::current_path(f.at("a/out"));
    ResultFolder(".", kNames).replace(results(5));
    CHECK(fs::exists("summary.json"));  // the folder itself is still there
    fs::current_path(before);
  }
  SECTION("with a slash behind its name") {
    ResultFolder(f.at("a/out/"), kNames).replace(results(5));
    ResultFolder(f.at("a/new/"), kNames).replace(results(5));
    CHECK(run_of(held(f, "a/new")) == 5);
    fs::remove_all(f.at("a/new"));
  }
  SECTION("through a link") {
    fs::create_symlink("out", f.at("a/link"));
    ResultFolder(f.at("a/link"), kNames).replace(results(5));
    CHECK(fs::is_symlink(f.at("a/link")));
    fs::remove(f.at("a/link"));
  }
  CHECK(run_of(held(f, "a/out")) == 5);
  std::set<std::string> left;
  for (const auto& entry : fs::directory_iterator(f.at("a"))) left.insert(entry.path().filename());
  CHECK(left == std::set<std::string>{"out"});
  CHECK(!fs::exists(f.at("a/out/.ukemi-commit")));
}

TEST_CASE("what an earlier program left on its way is finished: its names on disk stay what they are") {
  const Folder f;
  ResultFolder(f.at("out"), kNames).replace(results(0));
  fs::create_directory(f.at("out/.ukemi-commit"));
  for (const auto& [name, content] : results(1)) f.write("out/.ukemi-commit/" + name, content);
  f.write("out/.ukemi-commit/.gone", "b.csv\n");
  const ResultFolder next(f.at("out"), kNames);
  CHECK(run_of(held(f)) == 1);
  CHECK(f.content("out").size() == results(1).size());
}

TEST_CASE("an exchanged folder keeps its rights") {
  const Folder f;
  const ResultFolder out(f.at("out"), kNames);
  out.replace(results(1));
  fs::permissions(f.at("out"), fs::perms(02750));
  out.replace(results(2));
  CHECK((fs::status(f.at("out")).permissions() & fs::perms(07777)) == fs::perms(02750));
  CHECK(run_of(held(f)) == 2);
}

TEST_CASE("a folder under the name of a result is refused before any work") {
  const Folder f;
  fs::create_directories(f.at("out/a.csv"));
  f.write("out/a.csv/kept", "kept");
  CHECK(error_of(f, [&] { ResultFolder(f.at("out"), kNames); }) ==
        "out/a.csv: is a folder: the results need this name for a file");
  CHECK(read(f.at("out/a.csv/kept")) == "kept");
}

TEST_CASE("an input among the results is told by any of its names") {
  const Folder f;
  const ResultFolder out(f.at("out"), kNames);
  out.replace(results(2));
  f.write("out/notes.csv", "x"), f.write("apart.csv", "x");
  fs::create_symlink("out/b.csv", f.at("link.csv"));
  fs::create_hard_link(f.at("out/b.csv"), f.at("hard.csv"));
  fs::create_symlink("out", f.at("folder"));
  const auto error = [&](const std::string& path) {
    return error_of(f, [&] {
      const ReadWatch watch([&](const ReadFile& file) { out.refuse_as_input(file); });
      read_text_file(f.at(path));
    });
  };
  for (const char* path : {"out/b.csv", "link.csv", "hard.csv", "folder/b.csv", "out/../out/b.csv"})
    CHECK(error(path) ==
          std::string(path) + ": this run would write over it, as out/b.csv: another output folder is needed");
  CHECK(error("out/notes.csv") == "no error");
  CHECK(error("apart.csv") == "no error");
}

TEST_CASE("what is watched is the bytes that were read") {
  const Folder f;
  f.write("a", "foobar");
  std::vector<ReadFile> seen, inner;
  {
    const ReadWatch watch([&](const ReadFile& file) { seen.push_back(file); });
    read_binary_file(f.at("a"));
    read_binary_file(f.at("a"), 2);  // not to its end
    const ReadWatch deeper([&](const ReadFile& file) { inner.push_back(file); });
    read_text_file(f.at("a"));
  }
  read_text_file(f.at("a"));
  REQUIRE(seen.size() == 1);
  CHECK(inner.size() == 1);
  CHECK(seen[0].path == f.at("a"));
  CHECK(seen[0].checksum == "85944171f73967e8");
}

TEST_CASE("results that cannot be written leave the earlier ones as they were") {
  const Folder f;
  ResultFolder(f.at("out"), kNames).replace(results(1));
  if (GENERATE(false, true)) f.write("out/notes.txt", "mine");
  const auto before = f.content();
  // A limit on the length of a file stands for a full disk.
  struct rlimit limit {};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &limit) == 0);
  const rlim_t all = limit.rlim_cur;
  limit.rlim_cur = 10'000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &limit) == 0);
  const std::string error = error_of(f, [&] { ResultFolder(f.at("out"), kNames).replace(results(4)); });
  limit.rlim_cur = all;
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
  CHECK(error == "out/a.csv: cannot be written: File too large");
  const bool untouched = f.content() == before;
  CHECK(untouched);
}

TEST_CASE("a kill at any moment leaves a folder of one run, the next run clears away what else it left") {
  std::mt19937 random(7);
  SECTION("a folder of results alone is exchanged in one step") {
    const Folder f;
    ResultFolder(f.at("out"), kNames).replace(results(0));
    int beside = 0;
    for (int k = 0; k < kills(); ++k) {
      kill_while_replacing(f, 200 + int(random() % 8000));
      INFO("kill " << k);
      REQUIRE(run_of(held(f)) >= 0);
      beside += names_in(f).size() > 1;
    }
    ResultFolder(f.at("out"), kNames).replace(results(3));
    CHECK(run_of(held(f)) == 3);
    CHECK(names_in(f) == std::set<std::string>{"out"});
    WARN(beside << " of " << kills() << " kills left a folder beside, for the next run to take away");
  }
  SECTION(
      "beside other files the new set is whole first; where it is moving there is no summary, and the next run ends "
      "it") {
    const Folder f;
    ResultFolder(f.at("out"), kNames).replace(results(0));
    f.write("out/notes.txt", "mine");
    int moving = 0;
    for (int k = 0; k < kills(); ++k) {
      kill_while_replacing(f, 200 + int(random() % 8000));
      INFO("kill " << k);
      const bool whole = run_of(held(f)) >= 0;
      if (!whole) REQUIRE(fs::exists(f.at("out/.ukemi-commit")));
      if (!whole && fs::exists(f.at("out/.ukemi-commit/summary.json"))) REQUIRE(!fs::exists(f.at("out/summary.json")));
      moving += !whole;
      ResultFolder(f.at("out"), kNames);  // a next run that fails on its input
      REQUIRE(run_of(held(f)) >= 0);
      REQUIRE(read(f.at("out/notes.txt")) == "mine");
    }
    ResultFolder(f.at("out"), kNames).replace(results(3));
    CHECK(run_of(held(f)) == 3);
    CHECK(names_in(f) == std::set<std::string>{"out"});
    CHECK(f.content("out").size() == results(3).size() + 1);
    WARN(moving << " of " << kills() << " kills found the new set on its way");
  }
}

TEST_CASE("work goes on with the threads that could be started") {
#ifdef __SANITIZE_ADDRESS__
  WARN("skipped: a sanitizer needs more memory than a limit leaves");
#else
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    std::ifstream in("/proc/self/statm");
    rlim_t pages = 0;
    in >> pages;
    const rlim_t room = pages * rlim_t(::sysconf(_SC_PAGESIZE)) + (rlim_t(20) << 20);  // two stacks' worth
    const struct rlimit limit { room, room };
    if (::setrlimit(RLIMIT_AS, &limit) != 0) ::_exit(2);
    std::vector<int> done(10'000);
    parallel_for(int(done.size()), 500, [&](int i) { ++done[std::size_t(i)]; });
    ::_exit(done == std::vector<int>(done.size(), 1) ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  REQUIRE(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
#endif
}
