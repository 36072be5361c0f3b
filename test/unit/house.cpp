// The house: the direction of the includes, the top level.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace fs = std::filesystem;

namespace {

std::string room_of(const fs::path& file) {
  const auto folder = file.parent_path();
  return folder.begin() == folder.end() ? "" : folder.generic_string();
}

/// The rooms and what each may include, as the page of the architecture lists them.
std::map<std::string, std::set<std::string>> rooms() {
  std::map<std::string, std::set<std::string>> out;
  std::ifstream in(fs::path(UKEMI_SOURCE) / "tools/docs/architecture.md");
  std::string line;
  while (std::getline(in, line) && line != "```rooms") {
  }
  const std::regex room("([a-z/_]+):(.*)");
  for (std::smatch m; std::getline(in, line) && line != "```";)
    if (std::regex_match(line, m, room)) {
      auto& targets = out[m[1]];
      std::istringstream words(m[2]);
      // What follows the rooms is the room's thought.
      for (std::string word; words >> word && (word.find('/') != word.npos || word == "common");) targets.insert(word);
    }
  return out;
}

bool reaches(const std::map<std::string, std::set<std::string>>& rooms, const std::string& from, const std::string& to,
             std::set<std::string>& seen) {
  if (!seen.insert(from).second) return false;
  for (const std::string& next : rooms.at(from))
    if (next == to || reaches(rooms, next, to, seen)) return true;
  return false;
}

}  // namespace

TEST_CASE("includes follow the arrows that the page of the architecture draws") {
  const auto allowed = rooms();
  REQUIRE(allowed.size() > 15);
  for (const auto& [room, targets] : allowed)
    for (const std::string& target : targets) {
      INFO(room << " -> " << target);
      REQUIRE(allowed.count(target) == 1);
      std::set<std::string> seen;
      CHECK_FALSE(reaches(allowed, target, room, seen));
    }
  const std::regex own("^\\s*#\\s*include\\s*\"([a-z_/0-9.]+)\""), system("^\\s*#\\s*include\\s*<([^>]+)>");
  std::map<std::string, std::set<std::string>> used;
  for (const std::string top : {"common", "identify", "landing", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(UKEMI_SOURCE) / top)) {
      const fs::path path = fs::relative(entry.path(), UKEMI_SOURCE);
      if (path.extension() != ".hpp" && path.extension() != ".cpp") continue;
      const std::string room = room_of(path);
      INFO(path);
      REQUIRE(allowed.count(room) == 1);
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) {
        std::smatch m;
        INFO(line);
        if (std::regex_search(line, m, own)) {
          const std::string target = room_of(m[1].str());
          if (target != room) CHECK(allowed.at(room).count(target) == 1), used[room].insert(target);
        }
        if (!std::regex_search(line, m, system)) continue;
        const std::string header = m[1];
        // The solvers are private: Ceres to one file of identify, NLopt to one of landing; the Jet is a scalar for all.
        if (header.rfind("ceres/", 0) == 0 && header != "ceres/jet.h") CHECK(path.filename() == "least_squares.cpp");
        if (header.rfind("nlopt", 0) == 0) CHECK(path.filename() == "nlopt_solver.cpp");
        if (header.rfind("CLI/", 0) == 0 || header.rfind("nlohmann/", 0) == 0) CHECK(top == "tools");
        if (header.rfind("pugixml", 0) == 0) CHECK(path == "tools/program/gains.cpp");
        if (header.rfind("toml++/", 0) == 0) CHECK(path.filename() == "toml.cpp");
      }
    }
  for (const auto& [room, targets] : allowed) {
    INFO("arrows that nothing follows, from " << room);
    CHECK(used[room] == targets);
  }
}

TEST_CASE("the top level has no strangers") {
  const std::set<std::string> known = {"CMakeLists.txt", "CMakePresets.json",
                                       "README.md",      "CHANGELOG.md",
                                       "LICENSE",        "common",
                                       "identify",       "landing",
                                       "test",           "datasets",
                                       "tools",          "build",
                                       "ukemi-out"};  // the last two are made, and ignored by git
  for (const auto& entry : fs::directory_iterator(UKEMI_SOURCE)) {
    const std::string name = entry.path().filename().string();
    if (name[0] == '.') continue;
    INFO(name);
    CHECK(known.count(name) == 1);
  }
}
