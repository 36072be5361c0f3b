// The house: the direction of the includes, the top level, where the pages lead.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <vector>

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

/// README, the changelog and every page of tools/docs.
std::vector<fs::path> pages() {
  const fs::path source(UKEMI_SOURCE);
  std::vector<fs::path> out = {source / "README.md", source / "CHANGELOG.md"};
  for (const auto& entry : fs::directory_iterator(source / "tools/docs"))
    if (entry.path().extension() == ".md") out.push_back(entry.path());
  return out;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What the regex's first group finds in a text.
std::vector<std::string> found(const std::string& text, const char* regex) {
  const std::regex r(regex);
  std::vector<std::string> out;
  for (std::sregex_iterator i(text.begin(), text.end(), r), end; i != end; ++i) out.push_back((*i)[1]);
  return out;
}

/// The anchors that a page's headings give: lower case, blanks as '-', letters, digits and '-' alone.
std::set<std::string> anchors(const std::string& page) {
  std::set<std::string> out;
  for (const std::string& heading : found("\n" + page, "\n#+ ([^\n]*)")) {
    std::string anchor;
    for (const char c : heading)
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == ' ' || c == '_')
        anchor += c == ' ' ? '-' : char(std::tolower(static_cast<unsigned char>(c)));
    out.insert(anchor);
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

/// First lines, with their file, of functions and blocks with more than `most` lines. A function is laid out so that
/// its last line is a brace in the column of its first one.
std::vector<std::string> longer_than(int most, const fs::path& file) {
  std::vector<std::string> out;
  std::istringstream lines(text_of(file));
  std::array<std::pair<int, std::string>, 3> first;  // of column 0 and 2: number and text of the last line there
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::size_t column = line.find_first_not_of(' ');
    if (column != 0 && column != 2) continue;
    auto& [begin, text] = first[column];
    if (line.substr(column) == "}" && number - begin >= most) out.push_back(file.generic_string() + ": " + text);
    if (line[column] != '}') begin = number, text = line;
  }
  return out;
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
          if (target == room) continue;
          CHECK(allowed.at(room).count(target) == 1);
          used[room].insert(target);
        }
        if (!std::regex_search(line, m, system)) continue;
        const std::string header = m[1];
        // The solvers are private: Ceres to one file of identify, NLopt to one of landing; its dual numbers come by
        // one.
        if (header == "ceres/jet.h")
          CHECK(path == "common/jet.hpp");
        else if (header.rfind("ceres/", 0) == 0)
          CHECK(path.filename() == "least_squares.cpp");
        if (header.rfind("ukemi/", 0) == 0) CHECK(room == "tools/examples");
        if (header.rfind("nlopt", 0) == 0) CHECK(path.filename() == "nlopt_solver.cpp");
        if (header.rfind("CLI/", 0) == 0 || header.rfind("nlohmann/", 0) == 0) CHECK(top == "tools");
        if (header.rfind("toml++/", 0) == 0) CHECK(path.filename() == "toml_parser.hpp");
      }
    }
  for (const auto& [room, targets] : allowed) {
    INFO("arrows that nothing follows, from " << room);
    CHECK(used[room] == targets);
  }
}

TEST_CASE("what is installed includes nothing that is not") {
  const fs::path source(UKEMI_SOURCE);
  std::set<std::string> parts;
  int headers = 0;
  for (const std::string& list :
       found(text_of(source / "tools/cmake/public_headers.cmake"), "\n *\"[a-z_/]+:((?: [a-z_/]+)+)\"")) {
    ++headers;
    for (const std::string& part : found(list, " ([a-z_/]+)")) parts.insert(part + ".hpp");
  }
  CHECK(headers > 20);
  CHECK(headers <= 25);
  for (const std::string& part : parts) {
    INFO(part);
    REQUIRE(fs::exists(source / part));
    const std::string text = text_of(source / part);
    for (const std::string& other : found(text, "#include \"([^\"]+)\"")) {
      INFO(other);
      CHECK(parts.count(other) == 1);
    }
    CHECK(found(text, "#include <((?:ceres|nlopt|boost|Eigen|fmt|toml\\+\\+|experimental)[^>]*)>").empty());
  }
}

TEST_CASE("no test's name is cut short by what runs it") {
  // CTest takes a ';' for the end of a name: such a test is never found, and counts as passed.
  const std::regex cut("TEST_CASE\\(\\s*\"[^\"]*;");
  long tests = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(UKEMI_SOURCE) / "test")) {
    if (entry.path().extension() != ".cpp") continue;
    INFO(entry.path());
    const std::string text = text_of(entry.path());
    CHECK_FALSE(std::regex_search(text, cut));
    tests += std::regex_search(text, std::regex("TEST_CASE\\("));
  }
  CHECK(tests > 30);
}

TEST_CASE("no function has more than 60 lines") {
  constexpr int kMost = 60;
  for (const char* const part : {"common", "identify", "landing", "tools"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(UKEMI_SOURCE) / part))
      if (const auto kind = entry.path().extension(); kind == ".hpp" || kind == ".cpp")
        CHECK(longer_than(kMost, entry.path()) == std::vector<std::string>{});
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

TEST_CASE("every link and every path of the pages leads somewhere") {
  REQUIRE(pages().size() > 10);
  for (const fs::path& page : pages()) {
    INFO(page);
    const std::string text = text_of(page), prose = std::regex_replace(text, std::regex("\n    [^\n]*"), "");
    for (const std::string& link : found(prose, "\\]\\(([^)\\s]+)\\)")) {
      if (link.rfind("http", 0) == 0) continue;
      INFO(link);
      const std::size_t hash = std::min(link.find('#'), link.size());
      const fs::path target = hash == 0 ? page : page.parent_path() / link.substr(0, hash);
      CHECK(fs::exists(target));
      if (hash < link.size()) CHECK(anchors(text_of(target)).count(link.substr(hash + 1)) == 1);
    }
    // Files anywhere in the text, folders between backticks.
    for (const char* path : {"(?:^|[^\\w/.-])((?:common|identify|landing|tools|test|datasets)/[\\w./-]+\\.[a-z]+)\\b",
                             "`((?:common|identify|landing|tools|test|datasets)(?:/[\\w.-]+)+/?)`"})
      for (const std::string& file : found(text, path)) {
        INFO(file);
        CHECK(fs::exists(fs::path(UKEMI_SOURCE) / file));
      }
  }
}

TEST_CASE("the page on playing a plan shows the code of its example") {
  const auto unindented = [](const std::string& text) {
    return std::regex_replace("\n" + text, std::regex("\n +"), "\n");
  };
  const fs::path tools = fs::path(UKEMI_SOURCE) / "tools";
  const std::string example = unindented(text_of(tools / "examples/play.cpp"));
  const std::vector<std::string> blocks = found(text_of(tools / "docs/play.md"), "```cpp\n([^`]*)```");
  CHECK(blocks.size() == 2);
  for (const std::string& block : blocks) {
    INFO(block);
    CHECK(example.find(unindented(block)) != example.npos);
  }
}

TEST_CASE("README is read in five minutes, and every page of tools/docs is reached from it") {
  const std::string readme = text_of(fs::path(UKEMI_SOURCE) / "README.md");
  CHECK(std::count(readme.begin(), readme.end(), '\n') <= 150);
  for (const auto& entry : fs::directory_iterator(fs::path(UKEMI_SOURCE) / "tools/docs"))
    if (entry.path().extension() == ".md") {
      INFO(entry.path());
      CHECK(readme.find("tools/docs/" + entry.path().filename().string()) != readme.npos);
    }
}
