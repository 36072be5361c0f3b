// Man pages and bash completion: nothing in them that --help does not say, nothing missing.
#include <cctype>
#include <fstream>
#include <regex>
#include <set>

#include "test/cli/program.hpp"

using namespace cli;
using Catch::Matchers::Contains;

namespace {

std::set<std::string> options(const std::string& text) {
  const std::regex option("(?:^|[^-\\w])(--[a-z][a-z-]*)");
  std::set<std::string> out;
  for (std::sregex_iterator i(text.begin(), text.end(), option), end; i != end; ++i) out.insert((*i)[1]);
  return out;
}

std::string upper(std::string text) {
  for (char& c : text) c = char(std::toupper(c));
  return text;
}

/// What bash proposes for the last word.
std::set<std::string> proposed(const Folder& f, const std::string& words, int last) {
  f.write("ask.sh", "source ukemi.bash\nCOMP_WORDS=(" + words + ")\nCOMP_CWORD=" + std::to_string(last) +
                        "\n_ukemi\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
  const std::string command = "cd " + shell_quoted(f.at("")) + " && bash ask.sh > said 2> wrong";
  CHECK(std::system(command.c_str()) == 0);
  CHECK(read(f.at("wrong")).empty());
  std::set<std::string> out;
  std::ifstream in(f.at("said"));
  for (std::string line; std::getline(in, line);) out.insert(line);
  return out;
}

}  // namespace

TEST_CASE("each verb has a man page with the options of its help") {
  if (std::system("command -v help2man >/dev/null") != 0) {
    WARN("skipped: no help2man");
    return;
  }
  const Folder f;
  const std::string make = shell_quoted(dataset("../tools/cmake/manual.sh")) + " " + shell_quoted(UKEMI_PROGRAM) + " " +
                           shell_quoted(f.at("pages"));
  REQUIRE(std::system(make.c_str()) == 0);
  const std::string help = run({"--help"}, f.at("")).out;
  CHECK(help.find("manual") == help.npos);  // it is for packages
  const std::regex verb("\n  ([a-z]+) {2,}");
  int verbs = 0;
  for (std::sregex_iterator i(help.begin(), help.end(), verb), end; i != end; ++i, ++verbs) {
    const std::string name = (*i)[1];
    INFO(name);
    const std::string page = read(f.at("pages/ukemi-" + name + ".1")), said = run({name, "--help"}, f.at("")).out;
    const auto plain = [](const std::string& troff) {
      return std::regex_replace(std::regex_replace(troff, std::regex("\\\\f."), " "), std::regex("\\\\-"), "-");
    };
    CHECK(options(plain(page)) == options(said));
    CHECK_THAT(page, Contains(".TH UKEMI-" + upper(name) + " ") && Contains("\nukemi\\-" + name + " \\- "));
    CHECK_THAT(page, Contains(".SH SYNOPSIS\n.B ukemi\n\\fI\\," + name + " \\/\\fR[\\fI\\,OPTIONS\\/\\fR]"));
    CHECK_THAT(read(f.at("pages/ukemi.1")), Contains("\n.TP\n" + name + "\n"));
  }
  CHECK(verbs > 10);
  CHECK(options(read(f.at("pages/ukemi-bench-scenes.1"))).empty());  // "-" is written so that troff prints it
  int pages = 0;
  for (const auto& [name, text] : f.content("pages")) {
    INFO(name);
    if (!name.ends_with(".1")) continue;
    ++pages;
    CHECK(text.find("\n.TH UKEMI") != text.npos);
    CHECK_THAT(text, Contains(".SH OPTIONS"));
  }
  CHECK(pages > verbs + 1);  // and those of bench
}

TEST_CASE("bash completes verbs, options and files") {
  const Folder f;
  done(f, {"manual", "."});
  CHECK(proposed(f, "ukemi o", 1) == std::set<std::string>{"optimize"});
  CHECK(proposed(f, "ukemi bench sc", 2) == std::set<std::string>{"scenes"});
  CHECK(proposed(f, "ukemi optimize scene.toml --rob", 3) == std::set<std::string>{"--robust"});
  CHECK(proposed(f, "ukemi risk --rob", 2) == std::set<std::string>{""});
  CHECK(proposed(f, "ukemi optimize ukemi.b", 2) == std::set<std::string>{"ukemi.bash"});
  CHECK(proposed(f, "ukemi manu", 1) == std::set<std::string>{""});
}
