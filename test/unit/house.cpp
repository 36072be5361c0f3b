// The house: the direction of the includes, the top level.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

namespace fs = std::filesystem;

TEST_CASE("includes follow the arrows: Eigen -> common -> {identify, landing} -> tools") {
  const std::map<std::string, std::set<std::string>> allowed = {{"common", {"common"}},
                                                                {"identify", {"common", "identify"}},
                                                                {"landing", {"common", "landing"}},
                                                                {"tools", {"common", "identify", "landing", "tools"}}};
  const std::regex own("^\\s*#\\s*include\\s*\"([a-z_]+)/"), system("^\\s*#\\s*include\\s*<([^>]+)>");
  int seen = 0;
  for (const auto& [folder, targets] : allowed)
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(UKEMI_SOURCE) / folder)) {
      const fs::path& path = entry.path();
      if (path.extension() != ".hpp" && path.extension() != ".cpp") continue;
      ++seen;
      std::ifstream in(path);
      for (std::string line; std::getline(in, line);) {
        std::smatch m;
        INFO(path << ": " << line);
        if (std::regex_search(line, m, own)) CHECK(targets.count(m[1]) == 1);
        if (!std::regex_search(line, m, system)) continue;
        const std::string header = m[1];
        // The solvers are private: Ceres to identify's sources, NLopt to one file of landing; the Jet is a scalar for
        // all.
        if (header.rfind("ceres/", 0) == 0 && header != "ceres/jet.h") CHECK(path.filename() == "least_squares.cpp");
        if (header.rfind("nlopt", 0) == 0) CHECK(path.filename() == "nlopt_solver.cpp");
        if (header.rfind("CLI/", 0) == 0 || header.rfind("nlohmann/", 0) == 0) CHECK(folder == "tools");
        if (header.rfind("pugixml", 0) == 0) CHECK(path == fs::path(UKEMI_SOURCE) / "tools/gains.cpp");
        if (header.rfind("toml++/", 0) == 0) CHECK(path.filename() == "toml.cpp");
      }
    }
  CHECK(seen > 40);
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
