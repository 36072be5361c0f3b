// TOML files with other values.
#include "common/toml_edit.hpp"

#include <catch2/catch.hpp>

#include "test/folder.hpp"

using namespace ukemi;
using namespace test;

TEST_CASE("toml edit: values change where they stand, everything else stays") {
  const File f(
      "scene.toml",
      "# café\nrobot = \"a.toml\"\n\n[floor]  # ground\nstiffness = 2e4   # N/m\nfriction=0.8\n"
      "[verdict]\nx = \"weak\"\n\n[uncertainty]\ncovariance = [\n  [1, 2],\n  [2, 3],\n]\n[drop]\npitch_deg = 0 # é\n"
      "[[contact]]\nname = \"a\"\npad = { thickness = 0.01, stiffness = 5 }\n[[contact]]\nname = \"b\"\n");
  TomlEdit e(f.path);
  e.set({"floor"}, "stiffness", 20000);  // as it stands
  e.set({"floor"}, "friction", 0.625);
  e.set({"floor"}, "exponent", 1.25);
  e.set({"drop"}, "pitch_deg", 1.5);
  e.set({}, "robot", "b.toml");
  e.set({"contact", "0", "pad"}, "thickness", 0.02);
  e.set({"contact", "0", "pad"}, "damping", 3);
  e.set({"contact", "1"}, "friction", 1);
  e.remove_table("verdict"), e.remove_table("uncertainty"), e.remove_table("none");
  CHECK(e.text() ==
        "# café\nrobot = \"b.toml\"\n\n[floor]  # ground\nexponent = 1.25\nstiffness = 2e4   # N/m\nfriction=0.625\n"
        "[drop]\npitch_deg = 1.5 # é\n"
        "[[contact]]\nname = \"a\"\npad = { thickness = 0.02, stiffness = 5, damping = 3 }\n[[contact]]\n"
        "friction = 1\nname = \"b\"\n");
  e.remove({"contact", "0", "pad"}, "stiffness"), e.remove({"floor"}, "exponent"), e.remove({"floor"}, "none");
  e.remove({"contact", "0"}, "pad");
  CHECK(e.text() ==
        "# café\nrobot = \"b.toml\"\n\n[floor]  # ground\nstiffness = 2e4   # N/m\nfriction=0.625\n"
        "[drop]\npitch_deg = 1.5 # é\n"
        "[[contact]]\nname = \"a\"\n[[contact]]\nfriction = 1\nname = \"b\"\n");
  CHECK(e.text_at({}, "robot") == "b.toml");
  CHECK_FALSE(e.has({"floor"}, "exponent"));
}

TEST_CASE("toml edit: what cannot be written is refused and changes nothing") {
  const File f("scene.toml", "floor.stiffness = 3\n[drop]\nheight = 1\n");
  TomlEdit e(f.path);
  const std::string before = e.text();
  CHECK_THAT(refusal([&] { e.set({"floor"}, "friction", 1); }), Catch::Matchers::Contains("[NAME]"));
  CHECK_THAT(refusal([&] { e.set({"robot"}, "friction", 1); }), Catch::Matchers::Contains("no such table"));
  CHECK(e.text() == before);
}
