// Text from outside on its way to a message, a report or a file.
#include "common/text.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "common/toml.hpp"
#include "test/folder.hpp"

using namespace ukemi;
using namespace test;

TEST_CASE("what is shown is one printable line of UTF-8, and stays when it is shown again") {
  CHECK(shown("plain, Gr\xC3\xBC\xC3\x9F, \xE5\x8F\x97\xE8\xBA\xAB, \xF0\x9F\xA4\x96 \\n") ==
        "plain, Gr\xC3\xBC\xC3\x9F, \xE5\x8F\x97\xE8\xBA\xAB, \xF0\x9F\xA4\x96 \\n");
  CHECK(shown("a\nb\r\tc\x1b[0m\x7f") == "a\\nb\\r\\tc\\x1b[0m\\x7f");
  CHECK(shown(std::string("\0", 1)) == "\\x00");
  CHECK(shown("\xC2\x9B\xE2\x80\xA8\xE2\x80\xAE\xE2\x81\xA6") == "\\u009b\\u2028\\u202e\\u2066");
  // No UTF-8: a lone byte, a cut one, too long a form, a surrogate, beyond the last.
  CHECK(shown("\xFC \xC3") == "\\xfc \\xc3");
  CHECK(shown("\xC0\xAF\xE0\x80\xAF") == "\\xc0\\xaf\\xe0\\x80\\xaf");
  CHECK(shown("\xED\xA0\x80\xF4\x90\x80\x80") == "\\xed\\xa0\\x80\\xf4\\x90\\x80\\x80");
  for (int a = 0; a < 256; ++a)
    for (int b = 0; b < 256; ++b) {
      const std::string once = shown(std::string{char(a), char(b)});
      REQUIRE(shown(once) == once);
      for (const char c : once) REQUIRE((static_cast<unsigned char>(c) >= 32 && c != 127));
    }
}

TEST_CASE("an error is one line whatever the file is called") {
  CHECK(std::string(InputError({"a\nb.csv", 3, 7}, "x").what()) == "a\\nb.csv:3:7: x");
  const std::string most(39, 'x'), umlaut = "\xC3\xBC";
  CHECK(quoted(most + umlaut + "yy") == "'" + most + umlaut + "...'");
}

TEST_CASE("a text between the quotes of a TOML file reads back as it was") {
  const Folder f;
  for (const std::string& text :
       {std::string("a \"b\" \\ c\n\r\t\x1b\x7f"), std::string("Gr\xC3\xBC\xC3\x9F \xE2\x80\xAE"),
        std::string("\xC2\x9B"), std::string("\0", 1), std::string()}) {
    TomlFile file(f.write("a.toml", "[a]\ntext = \"" + toml_text(text) + "\"\n"));
    CHECK(file.require("a").text("text") == text);
  }
  CHECK(toml_text("gr\xFC") == "gr\\\\xfc");
}

TEST_CASE("an argument as a shell takes it back") {
  CHECK(shell_quoted("datasets/rigs/paper.toml") == "datasets/rigs/paper.toml");
  CHECK(shell_quoted("") == "''");
  for (const std::string& text : {std::string("a b"), std::string("it's"), std::string("$(x) `y` \\ \"z\""),
                                  std::string("\\n stays"), std::string("two\nlines' \\ \x1b"), std::string("\xFC")}) {
    const Folder f;
    f.write("say.sh", "printf %s " + shell_quoted(text));
    REQUIRE(std::system(("bash " + f.at("say.sh") + " > " + f.at("said")).c_str()) == 0);
    CHECK(read(f.at("said")) == text);
  }
}
