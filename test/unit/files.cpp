// What the readers promise: every malformed input is located and told its rule; what is written reads back exactly.
#include <Eigen/Core>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <sstream>

#include "common/actuator.hpp"
#include "common/actuator_constants.hpp"
#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/files.hpp"
#include "common/toml.hpp"
#include "identify/logs/hits.hpp"
#include "identify/logs/trial.hpp"
#include "identify/logs/trial_checks.hpp"
#include "identify/rig/rig.hpp"
#include "landing/model/scene_file.hpp"
#include "test/folder.hpp"

using namespace ukemi;
using namespace test;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

/// Files and folders below a folder.
std::set<std::string> names(const Folder& f) {
  std::set<std::string> out;
  for (const auto& [name, bytes] : f.content()) out.insert(name);
  return out;
}

std::string csv_error(const std::string& text) {
  const Folder f;
  return error_of(f, [&] { read_csv(f.write("a.csv", text)); });
}

}  // namespace

// ---- names

TEST_CASE("nearest names the key that was meant, and none where none is near") {
  CHECK(nearest("stifness", {"damping_normal", "stiffness"}) == "stiffness");
  CHECK(nearest("kp", {"k_d", "k_p", "k_sea"}) == "k_p");
  CHECK(nearest("k_p", {"k_d", "kp"}) == "kp");
  CHECK(nearest("k_sea", {"c_sea", "k_sae"}) == "k_sae");
  CHECK(nearest("pitch", {"height", "pitch_deg"}) == "pitch_deg");
  CHECK(nearest("temperature", {"k_p", "stiffness"}).empty());
  CHECK(nearest("k_p", {}).empty());
  CHECK(hint("k_dd", {"k_d", "k_sea"}) == " (did you mean \"k_d\"?)");
  CHECK(hint("temperature", {"k_d"}).empty());
}

TEST_CASE("a value in a message stays on one line and is cut") {
  CHECK(quoted("a\nb\x01") == "'a\\nb\\x01'");
  CHECK(quoted(std::string(100, 'x')) == "'" + std::string(40, 'x') + "...'");
  CHECK(Location{"a.csv", 3, 7}.text() == "a.csv:3:7");
  CHECK(Location{"a.csv", 3, 0}.text() == "a.csv:3");
  CHECK(Location{"a.csv", 0, 0}.text() == "a.csv");
}

// ---- CSV

TEST_CASE("a CSV file is read whatever its separator, line ends, comments and byte order mark") {
  const Folder f;
  const auto check = [&](const std::string& text) {
    const CsvTable t = read_csv(f.write("a.csv", text));
    REQUIRE(t.header == std::vector<std::string>{"t", "phi"});
    CHECK(t.columns == std::vector<std::vector<double>>{{0, 0.5}, {-1.25, 2e-3}});
    CHECK(t.find("phi") == 1);
    CHECK(t.find("force") == -1);
  };
  SECTION("comma") { check("t,phi\n0,-1.25\n0.5,2e-3\n"); }
  SECTION("semicolon") { check("t;phi\n0;-1.25\n0.5;2e-3\n"); }
  SECTION("tab") { check("t\tphi\n0\t-1.25\n0.5\t2e-3\n"); }
  SECTION("blanks about cells, a leading plus") { check(" t , phi \n 0 , -1.25 \n +0.5 ,\t2e-3 \n"); }
  SECTION("comments and empty lines") { check("# a\n\n#b,c\nt,phi\n  # d\n0,-1.25\n\n0.5,2e-3\n# e\n"); }
  SECTION("CRLF") { check("# a\r\nt,phi\r\n0,-1.25\r\n0.5,2e-3\r\n"); }
  SECTION("byte order mark") { check("\xEF\xBB\xBFt,phi\n0,-1.25\n0.5,2e-3\n"); }
  SECTION("quoted names") { check("\"t\",\"phi\"\n0,-1.25\n0.5,2e-3\n"); }
  SECTION("no line end at the end") { check("t,phi\n0,-1.25\n0.5,2e-3"); }
}

TEST_CASE("a CSV file's header is found behind comments of any length, and no more is read than that takes") {
  const Folder f;
  using Names = std::vector<std::string>;
  for (const int length : {0, 4000, 4094, 4095, 5000, 100'000}) {
    std::string comment = "# " + std::string(std::size_t(length), 'x') + "\n";
    if (length == 100'000) comment += comment + comment;
    CHECK(csv_header(f.write("a.csv", comment + "\"t\"; phi\n0;1\n")) == Names{"t", "phi"});
    CHECK(csv_header(f.write("a.csv", comment + "t,phi")) == Names{"t", "phi"});
    CHECK(csv_header(f.write("a.csv", comment)).empty());
  }
  CHECK(csv_header(f.write("a.csv", "t,phi\n" + std::string(5000, '0') + '\0')) == Names{"t", "phi"});
  CHECK(error_of(f, [&] { csv_header(f.write("a.csv", "t,t\n")); }) ==
        "a.csv:1:3: column 't': the header names it twice");
}

TEST_CASE("a CSV cell knows where it stands in its file") {
  const Folder f;
  const CsvTable t = read_csv(f.write("a.csv", "# a\nt,  phi\n\n0, 1\n10,22\n"));
  CHECK(t.header_line == 2);
  CHECK(t.header_column == std::vector<long>{1, 5});
  CHECK(t.line == std::vector<long>{4, 5});
  CHECK(t.at(1, 0).text() == f.at("a.csv") + ":4:4");
  CHECK(t.at(1, 1).text() == f.at("a.csv") + ":5:4");
}

TEST_CASE("each malformed CSV file is refused where the fault stands, with the rule") {
  SECTION("text") { CHECK(csv_error("t,phi\n0,1\n1, abc\n") == "a.csv:3:4: column 'phi': 'abc': a number is needed"); }
  SECTION("a number with a tail") {
    CHECK_THAT(csv_error("t,phi\n0,1.5rad\n"), StartsWith("a.csv:2:3: column 'phi': '1.5rad': "));
  }
  SECTION("decimal comma") { CHECK_THAT(csv_error("t;phi\n0;0,5\n"), StartsWith("a.csv:2:3: column 'phi': '0,5': ")); }
  SECTION("two signs") { CHECK_THAT(csv_error("t,phi\n0,+-5\n"), StartsWith("a.csv:2:3: column 'phi': '+-5': ")); }
  SECTION("NaN") { CHECK(csv_error("t,phi\n0,nan\n") == "a.csv:2:3: column 'phi': 'nan': a finite number is needed"); }
  SECTION("infinity") {
    CHECK(csv_error("t,phi\n-inf,0\n") == "a.csv:2:1: column 't': '-inf': a finite number is needed");
  }
  SECTION("beyond a double") {
    CHECK_THAT(csv_error("t,phi\n0,1e999\n"), StartsWith("a.csv:2:3: column 'phi': '1e999': "));
  }
  SECTION("more cells") {
    CHECK(csv_error("t,phi\n0,1,7\n") == "a.csv:2:5: '7': more cells than the header's 2 columns");
  }
  SECTION("fewer cells") { CHECK(csv_error("t,phi\n0,1\n1\n") == "a.csv:3:1: 1 cells: the header has 2 columns"); }
  SECTION("a name twice") { CHECK_THAT(csv_error("t,phi,t\n0,1,2\n"), StartsWith("a.csv:1:7: column 't': ")); }
  SECTION("no bytes") { CHECK_THAT(csv_error(""), StartsWith("a.csv: the file is empty: ")); }
  SECTION("comments only") { CHECK_THAT(csv_error("# a\n# b\n"), StartsWith("a.csv: the file is empty: ")); }
  SECTION("no rows") { CHECK_THAT(csv_error("# a\nt,phi\n"), StartsWith("a.csv:2: no rows: ")); }
  SECTION("a NUL") { CHECK(csv_error(std::string("t,phi\n0,\0\n", 10)) == "a.csv:2:3: byte 0x00: not a text file"); }
  SECTION("a long line") {
    CHECK(csv_error("t,phi\n" + std::string(2 << 20, '1')) == "a.csv:2:1048577: the line is longer than 1048576 bytes");
  }
}

TEST_CASE("an empty CSV cell is NaN, a column that is not wanted may hold text") {
  const Folder f;
  const CsvTable t = read_csv(f.write("a.csv", "t,note,phi\n0,hello,\n1,nan,2\n"),
                              [](const std::string& name) { return name != "note"; });
  REQUIRE(t.columns[2].size() == 2);
  CHECK(std::isnan(t.columns[2][0]));
  CHECK(t.columns[2][1] == 2);
  CHECK(t.columns[1].empty());
  CHECK(t.rows() == 2);
}

TEST_CASE("a CSV column that is asked for as text keeps its cells, and where they stand") {
  const Folder f;
  const CsvTable t = read_csv(f.write("a.csv", "t,note,other\n0, hello ,x\n1,,y\n"),
                              [](const std::string& name) { return name != "other"; }, NanCells::kRefused, {"note"});
  CHECK(t.texts == std::vector<std::vector<std::string>>{{}, {"hello", ""}, {}});
  CHECK(t.columns[0] == std::vector<double>{0, 1});
  CHECK(t.columns[1].empty());
  CHECK(t.at(1, 0).text() == f.at("a.csv") + ":2:4");
}

TEST_CASE("what CsvWriter writes reads back to the last bit") {
  std::vector<double> values = {0.0,
                                -0.0,
                                0.1,
                                1.0 / 3,
                                std::numbers::pi,
                                1e21,
                                123456789.125,
                                -1e-7,
                                5e-324,
                                std::numeric_limits<double>::min(),
                                std::numeric_limits<double>::max()};
  std::mt19937_64 random(1);
  while (values.size() < 2000) {
    const double x = std::bit_cast<double>(std::uint64_t(random()));
    if (std::isfinite(x)) values.push_back(x);
  }
  CsvWriter w;
  w.comment("one\ntwo");
  w.header({"i", "x", "name"});
  for (std::size_t i = 0; i < values.size(); ++i) w.cell(long(i)).cell(values[i]).cell("text").end_row();
  CHECK_THAT(w.text(), StartsWith("# one\n# two\ni,x,name\n0,0,text\n"));
  const Folder f;
  const CsvTable t = read_csv(f.write("a.csv", w.text()), [](const std::string& n) { return n != "name"; });
  REQUIRE(t.rows() == values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    CHECK(t.columns[0][i] == double(i));
    CHECK(std::bit_cast<std::uint64_t>(t.columns[1][i]) == std::bit_cast<std::uint64_t>(values[i]));
  }
}

TEST_CASE("CsvWriter writes the shortest numbers and leaves a cell empty for none") {
  CsvWriter w;
  w.row({0.1, std::nan(""), 1e-3, std::numeric_limits<double>::infinity()});
  CHECK(w.text() == "0.1,,0.001,\n");
  CHECK(shortest(0.1) == "0.1");
  CHECK(shortest(20) == "20");
}

// ---- files

TEST_CASE("a file is written whole or not at all") {
  const Folder f;
  SECTION("it makes the folder, replaces what was there and leaves no temporary name") {
    write_file(f.at("a/b/c.txt"), "first, and longer\n");
    write_file(f.at("a/b/c.txt"), "second\n");
    CHECK(read(f.at("a/b/c.txt")) == "second\n");
    CHECK(names(f) == std::set<std::string>{"a", "a/b", "a/b/c.txt"});
  }
  SECTION("below a regular file nothing can be written") {
    f.write("file", "kept");
    CHECK_THAT(error_of(f, [&] { write_file(f.at("file/out.txt"), "x"); }), StartsWith("file"));
    CHECK(read(f.at("file")) == "kept");
    CHECK(names(f) == std::set<std::string>{"file"});
  }
  SECTION("a folder of that name stays, and no temporary name beside it") {
    fs::create_directories(f.at("out/inside"));
    CHECK_THAT(error_of(f, [&] { write_file(f.at("out"), "x"); }), StartsWith("out: cannot be written: "));
    CHECK(names(f) == std::set<std::string>{"out", "out/inside"});
  }
}

TEST_CASE("asking whether a folder can be written leaves nothing behind") {
  const Folder f;
  f.write("file", "x");
  CHECK_NOTHROW(require_writable_folder(f.at("a/b")));
  CHECK_THAT(error_of(f, [&] { require_writable_folder(f.at("file/out")); }),
             StartsWith("file/out: ") && Contains("not a folder"));
  CHECK(names(f) == std::set<std::string>{"file"});
}

TEST_CASE("a file that is no text is refused with its place") {
  const Folder f;
  CHECK(error_of(f, [&] { read_text_file(f.at("none")); }) == "none: no such file");
  fs::create_directory(f.at("folder"));
  CHECK(error_of(f, [&] { read_text_file(f.at("folder")); }) == "folder: is a folder: a file is needed");
  f.write("bytes", "ab\nc\x07");
  CHECK(error_of(f, [&] { read_text_file(f.at("bytes")); }) == "bytes:2:2: byte 0x07: not a text file");
  f.write("long", "12345\n123456\n");
  CHECK(error_of(f, [&] { read_text_file(f.at("long"), 5); }) == "long:2:6: the line is longer than 5 bytes");
  CHECK(read_text_file(f.at("long"), 6) == "12345\n123456\n");
}

TEST_CASE("the checksum is FNV-1a with 64 bits") {  // test vectors of its authors
  CHECK(checksum("") == "cbf29ce484222325");
  CHECK(checksum("a") == "af63dc4c8601ec8c");
  CHECK(checksum("foobar") == "85944171f73967e8");
}

// ---- TOML

namespace {

/// The error of asking a TOML text for what `ask` wants, then for nothing more.
template <class Ask>
std::string toml_error(const std::string& text, Ask&& ask) {
  const Folder f;
  f.write("a.toml", text);
  return error_of(f, [&] {
    TomlFile file(f.at("a.toml"));
    ask(file);
    file.finish();
  });
}
std::string number_error(const std::string& text, const Range& range = Range::positive()) {
  return toml_error(text, [&](TomlFile& file) { file.require("rig").number("length", range); });
}
std::string angle_error(const std::string& text) {
  return toml_error(text, [&](TomlFile& file) { file.require("drop").angle("pitch"); });
}

}  // namespace

TEST_CASE("a TOML number is asked for with its rule") {
  CHECK(number_error("[rig]\nlength = 0.3\n") == "no error");
  CHECK(number_error("[rig]\nlength = 3\n") == "no error");
  CHECK(number_error("[rig]\r\nlength = 3\r\n") == "no error");
  CHECK(number_error("\xEF\xBB\xBF[rig]\nlength = 3\n") == "no error");
  SECTION("missing table") {
    CHECK(number_error("[rigg]\nlength = 1\n") == "a.toml: the table [rig] is missing (there is [rigg])");
  }
  SECTION("empty file") { CHECK(number_error("") == "a.toml: the table [rig] is missing"); }
  SECTION("a key where the table should be") {
    CHECK_THAT(number_error("\nrig = 3\n"),
               StartsWith("a.toml:2:7: 'rig': '3': ") && Contains("table [rig] is needed"));
  }
  SECTION("missing key") {
    CHECK(number_error("\n[rig]\nlenght = 1\n") == "a.toml:2:1: [rig] the key 'length' is missing (there is 'lenght')");
  }
  SECTION("unknown key") {
    CHECK(number_error("[rig]\nlength = 1\n  lengthh = 2\n") ==
          "a.toml:3:3: unknown key 'lengthh' in [rig] (did you mean \"length\"?)");
  }
  SECTION("unknown table") {
    CHECK(number_error("[rig]\nlength = 1\n[rik]\n") == "a.toml:3:2: unknown table 'rik' (did you mean \"rig\"?)");
  }
  SECTION("a key outside of its table") {
    CHECK(number_error("length = 1\n[rig]\nlength = 1\n") ==
          "a.toml:1:1: unknown key 'length' (it belongs into [rig])");
  }
  SECTION("text") {
    CHECK(number_error("[rig]\nlength = \"1\"\n") == "a.toml:2:10: [rig] length: ''1'': a number is needed");
  }
  SECTION("boolean") {
    CHECK(number_error("[rig]\nlength = true\n") == "a.toml:2:10: [rig] length: 'true': a number is needed");
  }
  SECTION("array") { CHECK_THAT(number_error("[rig]\nlength = [1]\n"), StartsWith("a.toml:2:10: [rig] length: ")); }
  SECTION("NaN") {
    CHECK(number_error("[rig]\nlength = nan\n") == "a.toml:2:10: [rig] length: nan: a finite number is needed");
  }
  SECTION("infinity") {
    CHECK(number_error("[rig]\nlength = inf\n") == "a.toml:2:10: [rig] length: inf: a finite number is needed");
  }
  SECTION("negative") {
    CHECK(number_error("[rig]\nlength = -0.3\n") == "a.toml:2:10: [rig] length: -0.3: must be above 0");
  }
  SECTION("zero, open range") {
    CHECK(number_error("[rig]\nlength = 0\n") == "a.toml:2:10: [rig] length: 0: must be above 0");
  }
  SECTION("zero, closed range") { CHECK(number_error("[rig]\nlength = 0\n", Range::non_negative()) == "no error"); }
  SECTION("syntax") { CHECK_THAT(number_error("[rig]\nlength = = 1\n"), StartsWith("a.toml:2:10: ")); }
  SECTION("a key twice") { CHECK_THAT(number_error("[rig]\nlength = 1\nlength = 2\n"), StartsWith("a.toml:3:")); }
  SECTION("a key with a line end in its name stays one line") {
    const std::string e = number_error("[rig]\nlength = 1\n\"a\\nb\" = 2\n");
    CHECK_THAT(e, StartsWith("a.toml:3:1: unknown key"));
    CHECK(e.find('\n') == std::string::npos);
  }
}

TEST_CASE("a TOML angle is in radians, or in degrees where its key says so") {
  const Folder f;
  TomlFile file(f.write("a.toml", "[drop]\na = 1.5\nb_deg = 90\nr = [-1.5, 0]\ns_deg = [-90, 180]\n"));
  TomlSection s = file.require("drop");
  CHECK(s.angle("a") == 1.5);
  CHECK(s.angle("b") == Approx(std::numbers::pi / 2).epsilon(1e-15));
  CHECK(s.optional_angle_pair("r") == std::array{-1.5, 0.0});
  const auto pair = s.optional_angle_pair("s");
  REQUIRE(pair);
  CHECK((*pair)[0] == Approx(-std::numbers::pi / 2).epsilon(1e-15));
  CHECK((*pair)[1] == Approx(std::numbers::pi).epsilon(1e-15));
  CHECK(!s.optional_angle("c"));
  CHECK_NOTHROW(file.finish());

  CHECK(angle_error("[drop]\npitch = 18\n") ==
        "a.toml:2:9: [drop] pitch: 18: an angle in radians beyond 2 pi; for degrees name the key 'pitch_deg'");
  CHECK(angle_error("[drop]\npitch = -6.28\n") == "no error");
  CHECK(angle_error("[drop]\npitch_deg = 720\n") == "no error");
  CHECK_THAT(angle_error("[drop]\npitch = 0\npitch_deg = 0\n"),
             StartsWith("a.toml:3:13: [drop] pitch_deg: given beside 'pitch'"));
  CHECK_THAT(angle_error("[drop]\nheight = 1\n"),
             StartsWith("a.toml:1:1: [drop] ") && Contains("pitch_deg") && Contains("missing"));
}

TEST_CASE("TOML texts, choices, lists and matrices are checked") {
  const auto ask = [](auto&& f) {
    return [f](TomlFile& file) {
      auto s = file.require("a");
      f(s);
    };
  };
  const auto pair = ask([](TomlSection& s) { s.numbers("m", 2, Range::positive()); });
  CHECK(toml_error("[a]\nm = [1, 2]\n", pair) == "no error");
  CHECK_THAT(toml_error("[a]\nm = [1]\n", pair),
             StartsWith("a.toml:2:5: [a] m: ") && Contains("2 numbers in [ ] are needed"));
  CHECK_THAT(toml_error("[a]\nm = 1\n", pair), StartsWith("a.toml:2:5: [a] m: '1': 2 numbers"));
  CHECK_THAT(toml_error("[a]\nm = [1, -2]\n", pair), Contains("[a] m: -2: must be above 0"));
  CHECK_THAT(toml_error("[a]\n", pair), StartsWith("a.toml:1:1: [a] the key 'm' is missing"));
  const auto choice = ask([](TomlSection& s) { s.optional_choice("c", {"output", "motor"}); });
  CHECK(toml_error("[a]\nc = \"motor\"\n", choice) == "no error");
  CHECK(toml_error("[a]\nc = \"moter\"\n", choice) ==
        "a.toml:2:5: [a] c: 'moter': one of \"output\", \"motor\" is needed");
  CHECK(toml_error("[a]\nc = 3\n", choice) == "a.toml:2:5: [a] c: '3': a text in quotes is needed");
  const auto texts = ask([](TomlSection& s) { s.optional_texts("l"); });
  CHECK(toml_error("[a]\nl = [\"x\"]\n", texts) == "no error");
  CHECK_THAT(toml_error("[a]\nl = [1]\n", texts), Contains("a text in quotes is needed"));
  const auto matrix = ask([](TomlSection& s) { s.optional_matrix("m"); });
  CHECK(toml_error("[a]\nm = [[1, 2], [3, 4]]\n", matrix) == "no error");
  CHECK_THAT(toml_error("[a]\nm = [[1, 2], [3]]\n", matrix), Contains("a square matrix is needed"));
  CHECK_THAT(toml_error("[a]\nm = [[1, 2], [3, \"x\"]]\n", matrix), Contains("a number is needed"));
}

// ---- actuator files

namespace {

const std::string kActuator = "[actuator]\nname = \"a\"\nk_p = 50\nk_d = 1\nk_sea = 65\nc_sea = 1.6\ni_motor = 0.085\n";

std::string actuator_error(const std::string& text) {
  const Folder f;
  return error_of(f, [&] { read_actuator(f.write("a.toml", text)); });
}

}  // namespace

TEST_CASE("an actuator file holds its constants, what it does not name is absent") {
  const Folder f;
  const Actuator a = read_actuator(f.write("a.toml", kActuator));
  CHECK(a.name == "a");
  CHECK(constants(a.sea) == std::array<double, kConstants>{50, 1, 65, 1.6, 0.085});
  CHECK(std::isinf(a.sea.tau_max));
  CHECK(a.sea.friction == 0);
  CHECK(a.sea.k_sea_cubic == 0);
  CHECK(a.sea.control_delay == 0);
  CHECK(a.sea.velocity_filter == 0);
  CHECK(a.sea.feedback == Feedback::kOutput);
  CHECK(!a.speed_max);
  CHECK(a.verdicts.empty());
  CHECK(a.uncertain.empty());
  CHECK(!a.standard_error("k_p"));
}

TEST_CASE(
    "how late a drive is stands in the rig or in the actuator, and a rig that says nothing else is driven by Eq. 3") {
  const Folder f;
  const std::string head = "[rig]\nlength = 0.3\ninertia_joint = 0.024\n[drive]\n";
  const auto rig = [&](const std::string& drive) { return identify::read_rig(f.write("rig.toml", head + drive)); };
  using Kind = identify::Drive::Kind;
  CHECK(rig("").drive.kind == Kind::kCommand);
  const identify::Rig late = rig("control_delay = 1e-3\nvelocity_filter = 0.005\n");
  CHECK(late.drive.kind == Kind::kGains);
  const Actuator a = read_actuator(f.write("a.toml", kActuator + "control_delay = 0.002\n"));
  CHECK(a.sea.control_delay == 0.002);
  CHECK(late.mounted(a.sea).control_delay == 1e-3);
  CHECK(late.mounted(a.sea).velocity_filter == 0.005);
  CHECK(rig("").mounted(a.sea).control_delay == 0.002);
  CHECK(rig("control_delay = 1e-3\ncommand_gain = 3\n").drive.kind == Kind::kController);
  CHECK(rig("control_delay = 1e-3\ncommand_rate = 3\n").drive.kind == Kind::kCommand);
  CHECK_THAT(error_of(f, [&] { (void)rig("control_delay = -1e-3\n"); }),
             Contains("rig.toml:5:17") && Contains("control_delay") && Contains("from 0 to 0.1 s"));
  CHECK_THAT(actuator_error(kActuator + "velocity_filter = 0.2\n"), Contains("from 0 to 0.1 s"));
}

TEST_CASE("an actuator reads back from its file to the last bit, covariance and ratings included") {
  Actuator a;
  a.name = "a \"quoted\" \\ name";
  a.sea = {50.1, 1.0 / 3, 65.3, 1.7, 0.1 + 0.2, 20.5, 0.07, -12.3, Feedback::kMotor, 0.03};
  a.sea.control_delay = 1.0 / 700, a.sea.velocity_filter = 0.004;
  a.speed_max = 3.14;
  a.verdicts = {{"k_p", "trusted"}, {"k_d", "at its bound"}, {"i_motor", "not identifiable"}};
  a.uncertain = {"k_p", "friction"};
  a.covariance = Eigen::Matrix2d{{0.04, -1.0 / 700}, {-1.0 / 700, 1e-6}};
  a.provenance = {{"command", "ukemi identify \"a b\" C:\\x\nmore"}, {"seed", "1"}};
  const Folder f;
  write_file(f.at("a.toml"), to_toml(a, 2.0));
  const Actuator b = read_actuator(f.at("a.toml"));
  CHECK(b.name == a.name);
  CHECK(constants(b.sea) == constants(a.sea));
  CHECK(b.sea.tau_max == a.sea.tau_max);
  CHECK(b.sea.friction == a.sea.friction);
  CHECK(b.sea.k_sea_cubic == a.sea.k_sea_cubic);
  CHECK(b.sea.control_delay == a.sea.control_delay);
  CHECK(b.sea.velocity_filter == a.sea.velocity_filter);
  CHECK(b.sea.feedback == Feedback::kMotor);
  CHECK(b.sea.viscous == a.sea.viscous);
  CHECK(b.verdicts == a.verdicts);
  CHECK(b.speed_max == a.speed_max);
  CHECK(b.uncertain == a.uncertain);
  CHECK(b.covariance == a.covariance);
  CHECK(*b.standard_error("k_p") == Approx(0.2).epsilon(1e-15));
  CHECK(*b.standard_error("friction") == Approx(1e-3).epsilon(1e-15));
  CHECK(!b.standard_error("k_d"));

  // The standard errors and intervals beside the covariance are of the same numbers.
  TomlFile file(f.at("a.toml"));
  TomlSection s = *file.optional("uncertainty");
  const auto std = s.numbers("std", 2, Range::non_negative());
  CHECK(std[0] == Approx(0.2).epsilon(1e-15));
  const auto ci = s.optional_matrix("ci95");
  REQUIRE(ci);
  CHECK((*ci)[0][0] == Approx(50.1 - 0.4).epsilon(1e-15));
  CHECK((*ci)[0][1] == Approx(50.1 + 0.4).epsilon(1e-15));
  CHECK((*ci)[1][0] == Approx(0.07 - 0.002).epsilon(1e-14));
}

TEST_CASE("an actuator file is refused where a constant breaks its rule") {
  CHECK(actuator_error(kActuator) == "no error");
  CHECK(actuator_error(replaced(kActuator, "k_p = 50", "k_p = 0")) == "no error");
  CHECK(actuator_error(replaced(kActuator, "k_p = 50", "k_p = -1")) ==
        "a.toml:3:7: [actuator] k_p: -1: must be at least 0");
  CHECK(actuator_error(replaced(kActuator, "0.085", "0")) == "a.toml:7:11: [actuator] i_motor: 0: must be above 0");
  CHECK_THAT(actuator_error(replaced(kActuator, "name = \"a\"\n", "")), Contains("'name' is missing"));
  CHECK_THAT(actuator_error(replaced(kActuator, "k_d = 1\n", "")), Contains("the key 'k_d' is missing"));
  CHECK_THAT(actuator_error(kActuator + "tau_mx = 3\n"),
             StartsWith("a.toml:8:1: ") && Contains("did you mean \"tau_max\"?"));
  CHECK_THAT(actuator_error(kActuator + "tau_max = -3\n"), Contains("tau_max: -3: must be at least 0"));
  CHECK_THAT(actuator_error(kActuator + "tau_max = 0x14\n"), Contains("a decimal number is needed"));
  CHECK_THAT(actuator_error(kActuator + "motor_torque_max = 0\n"), Contains("motor_torque_max: 0: must be above 0"));
  CHECK_THAT(actuator_error(kActuator + "feedback = \"both\"\n"), Contains("one of \"output\", \"motor\" is needed"));
}

TEST_CASE("an actuator's [uncertainty] is validated by whoever reads the file") {
  const auto error = [](const std::string& table) { return actuator_error(kActuator + "[uncertainty]\n" + table); };
  CHECK(error("order = [\"k_p\", \"k_d\"]\ncovariance = [[1, 0], [0, 1]]\n") == "no error");
  SECTION("order alone") {
    CHECK_THAT(error("order = [\"k_p\"]\n"), Contains("both 'order' and 'covariance' are needed"));
  }
  SECTION("not symmetric") {
    CHECK_THAT(error("order = [\"k_p\", \"k_d\"]\ncovariance = [[1, 0.5], [0.1, 1]]\n"),
               Contains("0.1 in row 2, column 1, and 0.5 in row 1, column 2: a symmetric matrix is needed"));
  }
  SECTION("sizes differ") {
    CHECK_THAT(error("order = [\"k_p\"]\ncovariance = [[1, 0], [0, 1]]\n"), Contains("2 rows: 'order' names 1"));
  }
  SECTION("negative variance") {
    CHECK_THAT(error("order = [\"k_p\"]\ncovariance = [[-1]]\n"), Contains("variance below 0"));
  }
  SECTION("a constant that does not exist") {
    CHECK_THAT(error("order = [\"kp\"]\ncovariance = [[1]]\n"), StartsWith("a.toml:9:") && Contains("k_p"));
  }
  SECTION("an unknown key") {
    CHECK_THAT(error("order = [\"k_p\"]\ncovariance = [[1]]\ncovarianze = 3\n"),
               StartsWith("a.toml:11:1: ") && Contains("did you mean \"covariance\"?"));
  }
}

TEST_CASE("each constant of the struct has one key of the file") {
  SeaParameters<double> sea{};
  std::set<std::string> keys;
  SeaParameters<double>::for_each(sea, sea, [&](double& constant, double) {
    std::vector<const char*> own;
    for (const ActuatorConstant& c : actuator_constants())
      if (&(sea.*c.at) == &constant) own.push_back(c.key);
    REQUIRE(own.size() == 1);
    keys.insert(own[0]);
  });
  CHECK(keys.size() == actuator_constants().size());
}

TEST_CASE("whatever an actuator's file may hold the library takes, and what the file may not it refuses") {
  Actuator a;
  a.name = "a", a.sea = {50, 1, 65, 1.6, 0.085, 20};
  a.speed_max = 5, a.motor_torque_max = 30;
  for (const ActuatorConstant& c : optional_constants()) a.sea.*c.at = c.range.holds(0.05) ? 0.05 : c.absent;
  a.uncertain = uncertain_constants();
  CHECK(a.uncertain.size() == kConstants + 1 + optional_constants().size());
  a.covariance = 1e-6 * Eigen::MatrixXd::Identity(long(a.uncertain.size()), long(a.uncertain.size()));
  const File f("a.toml", to_toml(a));
  const Actuator b = read_actuator(f.path);
  CHECK(b.uncertain == a.uncertain);
  CHECK_NOTHROW(validate(b));
  a.motor_torque_max = -30;
  CHECK_THROWS_WITH(validate(a), "motor_torque_max: -30: must be above 0");
  a.motor_torque_max = 30, a.uncertain.back() = "speed_max";
  CHECK_THROWS_WITH(validate(a), StartsWith("order: 'speed_max': not a constant of the actuator"));
}

TEST_CASE("a range holds its ends unless it is open below, and no number that is not finite") {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Range part{-1, 1, false, ""}, open{-1, 1, true, ""};
  CHECK((part.holds(-1) && part.holds(0) && part.holds(1)));
  CHECK((!open.holds(-1) && open.holds(0) && open.holds(1)));
  CHECK((!part.holds(-1.1) && !part.holds(1.1)));
  CHECK((!Range::positive().holds(0) && Range::non_negative().holds(0) && Range::any().holds(-1e300)));
  for (const double x : {kInfinity, -kInfinity, std::nan("")})
    for (const Range& r : {part, open, Range::any(), Range::positive(), Range::non_negative()}) CHECK(!r.holds(x));
}

TEST_CASE("doubted is what is neither trusted nor fixed") {
  const Verdicts all = {{"k_p", "trusted"}, {"k_d", "weak"}, {"k_sea", "fixed"}, {"c_sea", "at its bound"}};
  CHECK(doubted(all) == Verdicts{all[1], all[3]});
  CHECK(doubts(all) == "k_d is weak, c_sea is at its bound");
  CHECK(doubts({}).empty());
}

// ---- rigs

TEST_CASE("a rig's inertia is given about the joint, or as mass and inertia about its centre") {
  const Folder f;
  const identify::Rig a = identify::read_rig(f.write("a.toml", "[rig]\nlength = 0.3\ninertia_joint = 0.024225\n"));
  CHECK(a.length == 0.3);
  CHECK(a.inertia == 0.024225);
  CHECK((!a.tau_max && !a.gear_ratio && !a.feedback));
  const identify::Rig b =
      identify::read_rig(f.write("b.toml",
                                 "[rig]\nlength = 0.3\nmass = 0.806\ninertia_com = 6.09e-3\ntau_max = 20\ngear_ratio = "
                                 "100\nfeedback = \"motor\"\n"));
  CHECK(b.inertia == Approx(0.024225).epsilon(1e-14));  // Table 1 of [1]: 6.09e-3 + 0.806 * 0.15^2
  CHECK(b.tau_max == 20.0);
  CHECK(b.gear_ratio == 100.0);
  CHECK(b.feedback == Feedback::kMotor);

  const auto error = [&](const std::string& keys) {
    return error_of(f, [&] { identify::read_rig(f.write("c.toml", "[rig]\n" + keys)); });
  };
  CHECK_THAT(error("length = 0.3\ninertia_joint = 1\nmass = 1\n"),
             StartsWith("c.toml:3:17: ") && Contains("one of the two forms"));
  CHECK_THAT(error("length = 0.3\nmass = 1\n"), Contains("mass and inertia_com, is needed"));
  CHECK_THAT(error("length = 0.3\n"), StartsWith("c.toml:1:1: ") && Contains("inertia_joint"));
  CHECK_THAT(error("inertia_joint = 1\n"), Contains("the key 'length' is missing"));
  CHECK_THAT(error("length = 300\ninertia_joint = 1\n"),
             StartsWith("c.toml:2:10: ") && Contains("length: 300: ") && Contains("lengths are in m"));
  CHECK_THAT(error("length = 0.3\ninertia_joint = 1\ngear_ratio = 0\n"), Contains("gear_ratio: 0: must be above 0"));
}

TEST_CASE("a rig's errors: parts, percentages, seconds, exact is alone") {
  const Folder f;
  const std::string rig = "[rig]\nlength = 0.3\ninertia_joint = 1\n";
  const auto errors = [&](const std::string& keys) { return identify::read_rig(f.write("a.toml", rig + keys)).errors; };
  const identify::RigErrors stated = errors("[errors]\ninertia = \"2.5%\"\nlength = 0.01\ndelay = 2e-3\nfilter = 0\n"),
                            defaults = errors(""), exact = errors("[errors]\nexact = true\n");
  CHECK(stated.inertia == 0.025);
  CHECK(stated.length == 0.01);
  CHECK(stated.delay == 2e-3);
  CHECK(stated.filter == 0);
  CHECK(stated.force_gain == defaults.force_gain);
  CHECK(defaults.inertia == 0.01);
  CHECK(defaults.length == 0.005);
  CHECK(defaults.force_gain == 0.01);
  CHECK(defaults.encoder_gain == 0.001);
  CHECK((defaults.delay == 1e-3 && defaults.filter == 1e-3 && defaults.time_shift == 0));
  for (const identify::RigErrorKey& k : identify::rig_error_keys()) CHECK(exact.*k.at == 0);

  const auto error = [&](const std::string& keys) { return error_of(f, [&] { errors("[errors]\n" + keys); }); };
  CHECK_THAT(error("exact = true\ninertia = 0.01\n"), StartsWith("a.toml:6:") && Contains("beside exact = true"));
  CHECK_THAT(error("exact = 1\n"), StartsWith("a.toml:5:9: ") && Contains("true or false"));
  CHECK_THAT(error("delay = -1\n"), StartsWith("a.toml:5:9: ") && Contains("delay: -1: must be at least 0"));
  CHECK_THAT(error("delay = \"1%\"\n"), Contains("a number is needed"));
  for (const char* bad : {"\"-1%\"", "\"1\"", "\"1 kg%\"", "\"%\"", "\"nan%\"", "\"\"", "-0.1", "true"}) {
    INFO(bad);
    CHECK_THAT(error("inertia = " + std::string(bad) + "\n"), StartsWith("a.toml:5:11: [errors] inertia: "));
  }
  CHECK_THAT(error("inertiaa = 1\n"), StartsWith("a.toml:5:1: ") && Contains("did you mean \"inertia\"?"));
}

// ---- scenes and motions

namespace {

const std::string kScene =
    "[robot]\ngravity = 0\nlink_length = 0.3\nmass = [0.8, 0.9]\ninertia_com = [6e-3, 7e-3]\n[drop]\nheight = "
    "0.4\npitch_deg = 18\n";

landing::Scene scene_of(const std::string& text) {
  const Folder f;
  return landing::read_scene(f.write("fall.toml", text));
}
std::string scene_error(const std::string& text) {
  const Folder f;
  return error_of(f, [&] { landing::read_scene(f.write("a.toml", text)); });
}

}  // namespace

TEST_CASE("what a scene does not name is an absent term") {
  const landing::Scene s = scene_of(kScene);
  CHECK(s.name == "fall");
  CHECK(s.robot.link_length == 0.3);
  CHECK(s.robot.mass[0] == 0.8);
  CHECK(s.robot.mass[1] == 0.9);
  CHECK(s.robot.inertia_com[1] == 7e-3);
  CHECK(s.robot.gravity == 0);
  CHECK(s.contacts == std::array<bool, landing::kPoints>{});
  CHECK(!s.floor);
  CHECK(!s.touches());
  CHECK(s.drop.height == 0.4);
  CHECK(s.drop.pitch == Approx(18 * kDegree).epsilon(1e-15));
  CHECK(s.drop.forward_speed == 0);
  CHECK(s.drop.pitch_rate == 0);
  CHECK(!s.t_end);
  // The defaults that cli.md names: Table 3 of [1] and how exactly the robot plays a motion.
  CHECK(s.search.phi[0] == Approx(-90 * kDegree).epsilon(1e-15));
  CHECK(s.search.phi[1] == 0);
  CHECK(s.search.duration == std::array{0.1, 1.0});
  CHECK(s.execution.phi == Approx(0.2 * kDegree).epsilon(1e-15));
  CHECK(s.execution.duration == 0.002);
}

TEST_CASE("a scene's optional terms are read") {
  const std::string floor =
      "[floor]\nstiffness = 6880\ndamping_normal = 123\ndamping_tangential = 0.19\nsource = \"x\"\n";
  const landing::Scene s = scene_of(
      replaced(kScene, "gravity = 0\n", "gravity = 9.81\ncontacts = [\"foot\"]\n") +
      "pitch_rate = 0.5\nforward_speed = -1\n" + floor +
      "[search]\nphi = [-1, 1]\nduration = [0.2, 0.3]\n[execution]\nphi_deg = 1\nduration = 0\n[run]\nt_end = 2\n");
  CHECK(s.robot.gravity == 9.81);
  CHECK(s.contacts[landing::kFoot]);
  CHECK(!s.contacts[landing::kHip]);
  CHECK(!s.contacts[landing::kKnee]);
  REQUIRE(s.floor);
  CHECK(s.floor->stiffness == 6880);
  CHECK(s.floor->damping_tangential == 0.19);
  CHECK(s.floor_source == "x");
  CHECK(s.touches());
  CHECK(s.drop.pitch_rate == 0.5);
  CHECK(s.drop.forward_speed == -1);
  CHECK(s.search.phi == std::array{-1.0, 1.0});
  CHECK(s.search.duration == std::array{0.2, 0.3});
  CHECK(s.execution.phi == Approx(kDegree).epsilon(1e-15));
  CHECK(s.execution.duration == 0);
  CHECK(s.t_end == 2.0);
  CHECK(!scene_of(kScene + floor).touches());  // a floor that no point may touch
}

TEST_CASE("a scene is refused where it breaks a rule") {
  CHECK(scene_error(kScene) == "no error");
  SECTION("no robot") {
    CHECK(scene_error("[drop]\nheight = 1\npitch = 0\n") == "a.toml: the table [robot] is missing");
  }
  SECTION("no drop") {
    CHECK(scene_error(kScene.substr(0, kScene.find("[drop]"))) == "a.toml: the table [drop] is missing");
  }
  SECTION("no gravity: 0 is allowed, absence is not") {
    CHECK(scene_error(replaced(kScene, "gravity = 0\n", "")) == "a.toml:1:1: [robot] the key 'gravity' is missing");
  }
  SECTION("negative mass") {
    CHECK_THAT(scene_error(replaced(kScene, "0.8,", "-0.8,")),
               StartsWith("a.toml:4:") && Contains("mass: -0.8: must be above 0"));
  }
  SECTION("a link in mm") {
    CHECK(scene_error(replaced(kScene, "link_length = 0.3", "link_length = 300")) ==
          "a.toml:3:15: [robot] link_length: 300: must be above 0 and at most 10: lengths are in m");
  }
  SECTION("one mass") {
    CHECK_THAT(scene_error(replaced(kScene, "[0.8, 0.9]", "0.8")), Contains("2 numbers in [ ] are needed"));
  }
  SECTION("below the floor") {
    CHECK_THAT(scene_error(replaced(kScene, "= 0.4", "= -0.4")), Contains("height: -0.4: must be at least 0"));
  }
  SECTION("degrees for radians") {
    CHECK(scene_error(replaced(kScene, "pitch_deg", "pitch")) ==
          "a.toml:8:9: [drop] pitch: 18: an angle in radians beyond 2 pi; for degrees name the key 'pitch_deg'");
  }
  SECTION("a point that is none") {
    CHECK_THAT(scene_error(replaced(kScene, "[robot]\n", "[robot]\ncontacts = [\"foot\", \"kneee\"]\n")),
               StartsWith("a.toml:2:12: ") && Contains("'kneee'") && Contains("did you mean \"knee\"?"));
  }
  SECTION("half a floor") {
    CHECK_THAT(scene_error(kScene + "[floor]\nstiffness = 1\ndamping_normal = 1\n"),
               StartsWith("a.toml:9:1: ") && Contains("'damping_tangential' is missing"));
  }
  SECTION("an empty range of angles") {
    CHECK_THAT(scene_error(kScene + "[search]\nphi_deg = [0, -90]\n"),
               StartsWith("a.toml:10:11: ") && Contains("low < high"));
  }
  SECTION("an empty range of durations") {
    CHECK_THAT(scene_error(kScene + "[search]\nduration = [1, 1]\n"),
               StartsWith("a.toml:10:12: ") && Contains("low < high"));
  }
  SECTION("a negative tolerance") {
    CHECK_THAT(scene_error(kScene + "[execution]\nphi_deg = -1\n"),
               StartsWith("a.toml:10:11: ") && Contains("at least 0"));
  }
  SECTION("a run of no time") {
    CHECK_THAT(scene_error(kScene + "[run]\nt_end = 0\n"), Contains("t_end: 0: must be above 0"));
  }
  SECTION("an unknown key") {
    CHECK_THAT(
        scene_error(kScene + "forward_sped = 1\n"),
        StartsWith("a.toml:9:1: unknown key 'forward_sped' in [drop]") && Contains("did you mean \"forward_speed\"?"));
  }
  SECTION("an unknown table") { CHECK_THAT(scene_error(kScene + "[flor]\n"), Contains("did you mean \"floor\"?")); }
}

TEST_CASE("a motion reads back from its file, in degrees or in radians") {
  const Folder f;
  const landing::Motion m{-27.2 * kDegree, -82.4 * kDegree, 0.169};
  const std::string text = landing::to_toml(m, "one\ntwo");
  CHECK_THAT(text, StartsWith("# one\n# two\n[motion]\n"));
  const landing::Motion a = landing::read_motion(f.write("a.toml", text));
  CHECK(a.phi_i == Approx(m.phi_i).epsilon(1e-15));
  CHECK(a.phi_f == Approx(m.phi_f).epsilon(1e-15));
  CHECK(a.duration == m.duration);
  const landing::Motion b =
      landing::read_motion(f.write("b.toml", "[motion]\nphi_i = -0.5\nphi_f_deg = -90\nduration = 1\n"));
  CHECK(b.phi_i == -0.5);
  CHECK(b.phi_f == Approx(-90 * kDegree).epsilon(1e-15));
  const auto error = [&](const std::string& t) {
    return error_of(f, [&] { landing::read_motion(f.write("c.toml", t)); });
  };
  CHECK_THAT(error("[motion]\nphi_i = -45\nphi_f = -1\nduration = 1\n"),
             StartsWith("c.toml:2:9: ") && Contains("'phi_i_deg'"));
  CHECK_THAT(error("[motion]\nphi_i = 0\nphi_f = 0\nduration = 0\n"), Contains("duration: 0: must be above 0"));
  CHECK_THAT(error("[motion]\nphi_i = 0\nphi_f = 0\nduraton = 1\n"),
             Contains("'duration' is missing (there is 'duraton')"));
}

// ---- trials

namespace {

identify::Trial trial_of(const std::string& text, const identify::TrialOptions& options = {}) {
  const Folder f;
  return identify::read_trial(f.write("a.csv", text), options);
}
std::string trial_error(const std::string& text, const identify::TrialOptions& options = {}) {
  const Folder f;
  return error_of(f, [&] { identify::read_trial(f.write("a.csv", text), options); });
}
void check_near(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i] == Approx(b[i]).epsilon(1e-15).margin(1e-300));
}
identify::TrialOptions columns(const std::string& text) {
  identify::TrialOptions o;
  o.columns = text;
  return o;
}
identify::TrialOptions gear(double ratio) {
  identify::TrialOptions o;
  o.gear_ratio = ratio;
  return o;
}
identify::TrialOptions multi_turn() {
  identify::TrialOptions o;
  o.angles = identify::TrialOptions::Angles::kMultiTurn;
  return o;
}
identify::TrialOptions without_phi() {
  identify::TrialOptions o;
  o.require_phi = false;
  return o;
}

}  // namespace

TEST_CASE("a trial's columns are found by name, in any order, what it lacks is absent") {
  const identify::Trial t = trial_of("phi,note,force,t\n0.1,x,5,0\n0.2,y,6,0.5\n");
  CHECK(t.t == std::vector<double>{0, 0.5});
  CHECK(t.phi == std::vector<double>{0.1, 0.2});
  CHECK(t.force == std::vector<double>{5, 6});
  CHECK((t.phi_ref.empty() && t.dphi_ref.empty() && t.phi_motor.empty()));
  CHECK(t.samples() == 2);
  CHECK(t.measurements() == 2);
}

TEST_CASE("a trial's suffixes convert to SI units") {
  const identify::Trial t = trial_of(
      "t_ms,phi_deg,force,phi_ref_deg,dphi_ref_deg,phi_motor_deg\n0,90,1,-45,180,3\n250,180,2,45,-90,6\n", gear(3));
  check_near(t.t, {0, 0.25});
  check_near(t.phi, {90 * kDegree, 180 * kDegree});
  check_near(t.phi_ref, {-45 * kDegree, 45 * kDegree});
  check_near(t.dphi_ref, {180 * kDegree, -90 * kDegree});
  check_near(t.phi_motor, {1 * kDegree, 2 * kDegree});  // at the gear's output side
  CHECK(t.measurements() == 4);
}

TEST_CASE("option --columns renames, converts by the file's own suffix and flips signs") {
  const identify::Trial t =
      trial_of("Time_ms,defl_deg,Fy,t\n0,90,1,7\n10,-90,2,8\n", columns("t=Time_ms,phi=-defl_deg,force=-Fy"));
  check_near(t.t, {0, 0.01});
  check_near(t.phi, {-90 * kDegree, 90 * kDegree});
  check_near(t.force, {-1, -2});

  const std::string text = "Time,phi,force\n0,0,1\n1,0,1\n";
  CHECK_THAT(trial_error(text, columns("t=Tme")),
             StartsWith("a.csv:1: no column 'Tme'") && Contains("did you mean \"Time\"?"));
  CHECK_THAT(trial_error(text, columns("time=Time")), StartsWith("--columns: 'time': one of t, phi, "));
  CHECK_THAT(trial_error(text, columns("Time")), StartsWith("--columns: 'Time': NAME=COLUMN is needed"));
  CHECK_THAT(trial_error(text, columns("t=")), StartsWith("--columns: 't=': NAME=COLUMN is needed"));
}

TEST_CASE("a column that a trial needs is asked for by name") {
  CHECK_THAT(trial_error("time,phi,force\n0,0,0\n1,0,0\n"), StartsWith("a.csv:1: no column 't'"));
  CHECK_THAT(trial_error("# x\nt,phii,force\n0,0,0\n1,0,0\n"),
             StartsWith("a.csv:2: no column 'phi' (did you mean \"phii\"?)"));
  CHECK_THAT(trial_error("t,phi,forse\n0,0,0\n1,0,0\n"),
             Contains("at least one excitation") && Contains("did you mean \"forse\"?"));
  CHECK_THAT(trial_error("t,phi,force,dphi_ref\n0,0,0,0\n1,0,0,0\n"), StartsWith("a.csv:1: no column 'phi_ref'"));
  CHECK_THAT(trial_error("t,phi,phi_deg,force\n0,0,0,0\n1,0,0,0\n"),
             StartsWith("a.csv:1:7: ") && Contains("'phi' is given twice"));
  CHECK(trial_of("t,phi_ref\n0,0\n1,0\n", without_phi()).phi.empty());  // predict can do without phi
  CHECK(trial_of("t,phi,phi_ref\n0,0,0.1\n1,0,0.2\n").phi_ref == std::vector<double>{0.1, 0.2});
}

TEST_CASE("a trial's faults are located") {
  CHECK(trial_error("t,phi,force\n0,0,0\n1,,0\n") == "a.csv:3:3: column 'phi': empty: a number is needed");
  CHECK(trial_error("t,phi,force\n0,0,0\n1,nan,0\n") == "a.csv:3:3: column 'phi': 'nan': a finite number is needed");
  CHECK(trial_error("t,phi,force\n0,0,0\n") == "a.csv:2: one row: at least two samples are needed");
  CHECK(trial_error("phi,t,force\n0,0,0\n0,2,0\n# x\n0, 1,0\n") ==
        "a.csv:5:4: column 't': 1: time must increase; 2 stands before it");
  CHECK(trial_error("phi,t,force\n0,0,0\n0,2,0\n0,2,0\n") ==
        "a.csv:4:3: column 't': 2: time must increase; 2 stands before it");
  CHECK(trial_of("phi,t,force\n0,-1,0\n0,2,0\n0,2.001,0\n").samples() == 3);  // uneven sampling is fine
}

TEST_CASE("an angle beyond 2 pi is refused with a hint, unless it is meant") {
  const std::string text = "t,phi,force\n0,0,0\n1,20,0\n";
  CHECK_THAT(trial_error(text), StartsWith("a.csv:3:3: column 'phi': 20: ") && Contains("are these degrees?") &&
                                    Contains("--columns phi=0.017453292519943295*phi") && Contains("--multi-turn"));
  CHECK(trial_of(text, {.columns = "phi=0.017453292519943295*phi"}).phi[1] == Approx(20 * kDegree));
  CHECK(trial_of(text, multi_turn()).phi == std::vector<double>{0, 20});
  CHECK(trial_of("t,phi_deg,force\n0,0,0\n1,20,0\n").phi[1] == Approx(20 * kDegree));
  CHECK_THAT(trial_error("t,phi_deg,force\n0,0,0\n1,400,0\n"),  // it is in degrees: nothing to rename
             StartsWith("a.csv:3:3: column 'phi_deg': 400: ") && Contains("beyond 2 pi rad; --multi-turn"));
  CHECK_THAT(trial_error("t,phi,phi_ref\n0,0,-7\n1,0,0\n"), StartsWith("a.csv:2:5: column 'phi_ref': -7: "));
  // A rate may be large, and so may a motor's angle before its gear.
  CHECK(trial_of("t,phi,phi_ref,dphi_ref\n0,0,0,50\n1,0,0,0\n").dphi_ref[0] == 50);
  const std::string motor = "t,phi,force,phi_motor\n0,0,0,0\n1,0,0,100\n";
  CHECK(trial_of(motor, gear(50)).phi_motor == std::vector<double>{0, 2});
  CHECK_THAT(trial_error(motor), StartsWith("a.csv:3:7: column 'phi_motor': 100: "));
}

TEST_CASE("the shortest pulse of a force is counted in samples") {
  const auto pulse = [](std::vector<double> force) {
    identify::Trial t;
    t.force = std::move(force);
    t.t.resize(t.force.size());
    return identify::shortest_pulse(t);
  };
  CHECK(pulse({0, 1, 1, 1, 0, 0, -5, -5, 0}) == 2);
  CHECK(pulse({0, 0, 1, 5, 5, 5}) == 4);                // it may last to the end
  CHECK(pulse({0.2, 0, 5, 5, 5, 0, 0.24, 0, 0}) == 3);  // below 5 % of the largest is no pulse
  CHECK(pulse({0.26, 0, 5, 5, 5, 0}) == 1);
  CHECK(pulse({0, 0, 0}) == 0);
  CHECK(pulse({}) == 0);
}

TEST_CASE("the noise of a log is told from its slow motion") {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, 5e-4);
  std::vector<double> noise(4000), moving(4000), still(4000, 0.25);
  for (std::size_t i = 0; i < noise.size(); ++i) {
    noise[i] = normal(random);
    moving[i] = noise[i] + 0.3 * std::sin(2 * std::numbers::pi * 5 * 0.001 * double(i)) +
                double(i);  // 5 Hz at 1 kHz, and a drift
  }
  CHECK(identify::noise_level(noise) == Approx(5e-4).epsilon(0.05));
  CHECK(identify::noise_level(moving) == Approx(5e-4).epsilon(0.05));
  CHECK(identify::noise_level(still) == 0);
  CHECK(identify::noise_level({1, 2, 3}) == 0);
}

TEST_CASE("the noise of a quantised log is its step over sqrt(12)") {
  constexpr double kStep = 2 * std::numbers::pi / 4096;  // a 12 bit encoder
  std::vector<double> ramp(1000);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = kStep * std::floor(0.07 * double(i));
  CHECK(identify::noise_level(ramp) == Approx(kStep / std::sqrt(12.0)).epsilon(1e-9));
}
