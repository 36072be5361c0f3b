#include "landing/model/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "common/csv.hpp"
#include "common/toml.hpp"

namespace ukemi::landing {

Scene read_scene(const std::string& path) {
  TomlFile file(path);
  Scene scene;
  scene.name = std::filesystem::path(path).stem().string();

  TomlSection robot = file.require("robot");
  scene.robot.link_length = robot.number("link_length", Range::positive());
  const auto mass = robot.numbers("mass", 2, Range::positive());
  const auto inertia = robot.numbers("inertia_com", 2, Range::positive());
  scene.robot.mass = {mass[0], mass[1]};
  scene.robot.inertia_com = {inertia[0], inertia[1]};
  scene.robot.gravity = robot.number("gravity", Range::non_negative());
  if (const auto points = robot.optional_texts("contacts")) {
    const std::vector<std::string> known(kPointNames.begin(), kPointNames.end());
    for (const std::string& p : *points) {
      const auto it = std::find(known.begin(), known.end(), p);
      if (it == known.end()) robot.fail("contacts", one_of(p, known));
      scene.contacts[std::size_t(it - known.begin())] = true;
    }
  }

  if (auto floor = file.optional("floor")) {
    scene.floor = Floor<double>{floor->number("stiffness", Range::positive()),
                                floor->number("damping_normal", Range::non_negative()),
                                floor->number("damping_tangential", Range::non_negative())};
    scene.floor_source = floor->optional_text("source").value_or("");
  }

  TomlSection drop = file.require("drop");
  scene.drop.height = drop.number("height", Range::non_negative());
  scene.drop.forward_speed = drop.optional_number("forward_speed", Range::any()).value_or(0);
  scene.drop.pitch = drop.angle("pitch");
  scene.drop.pitch_rate = drop.optional_number("pitch_rate", Range::any()).value_or(0);

  if (auto search = file.optional("search")) {
    if (const auto phi = search->optional_angle_pair("phi")) {
      scene.search.phi = *phi;
      if (!((*phi)[0] < (*phi)[1]))
        search->fail("phi_deg", "the range is empty: [low, high] with low < high is needed");
    }
    if (const auto d = search->optional_numbers("duration", 2, Range::positive())) {
      scene.search.duration = {(*d)[0], (*d)[1]};
      if (!((*d)[0] < (*d)[1])) search->fail("duration", "the range is empty: [low, high] with low < high is needed");
    }
  }
  if (auto execution = file.optional("execution")) {
    if (const auto phi = execution->optional_angle("phi")) {
      scene.execution.phi = *phi;
      if (*phi < 0) execution->fail("phi_deg", shortest(*phi) + ": must be at least 0");
    }
    if (const auto d = execution->optional_number("duration", Range::non_negative())) scene.execution.duration = *d;
  }
  if (auto run = file.optional("run")) scene.t_end = run->optional_number("t_end", Range::positive());
  file.finish();
  return scene;
}

Motion read_motion(const std::string& path) {
  TomlFile file(path);
  TomlSection s = file.require("motion");
  const Motion motion{s.angle("phi_i"), s.angle("phi_f"), s.number("duration", Range::positive())};
  if (auto p = file.optional("provenance")) p->accept_all();
  file.finish();
  return motion;
}

std::string to_toml(const Scene& s, const std::string& comments) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  CsvWriter head;
  head.comment(comments);
  std::string points;
  for (int j = 0; j < kPoints; ++j)
    if (s.contacts[j]) points += (points.empty() ? "\"" : ", \"") + std::string(kPointNames[j]) + "\"";
  std::string text = head.text() + "[robot]\n";
  const auto line = [&](const char* key, const auto& value, const char* unit) {
    text += fmt::format("{} = {}  # {}\n", key, value, unit);
  };
  const auto pair = [](double a, double b) { return "[" + shortest(a) + ", " + shortest(b) + "]"; };
  line("gravity", shortest(s.robot.gravity), "m/s^2");
  text += "contacts = [" + points + "]\n";
  line("link_length", shortest(s.robot.link_length), "m");
  line("mass", pair(s.robot.mass[0], s.robot.mass[1]), "kg");
  line("inertia_com", pair(s.robot.inertia_com[0], s.robot.inertia_com[1]), "kg m^2");
  if (s.floor) {
    text += "\n[floor]\n";
    line("stiffness", shortest(s.floor->stiffness), "N/m");
    line("damping_normal", shortest(s.floor->damping_normal), "N/(m/s)");
    line("damping_tangential", shortest(s.floor->damping_tangential), "N/(m/s)");
    if (!s.floor_source.empty()) text += "source = \"" + toml_text(s.floor_source) + "\"\n";
  }
  text += "\n[drop]\n";
  line("height", shortest(s.drop.height), "m");
  line("forward_speed", shortest(s.drop.forward_speed), "m/s");
  line("pitch_deg", shortest(s.drop.pitch * kDegrees), "deg");
  line("pitch_rate", shortest(s.drop.pitch_rate), "rad/s");
  text += "\n[search]\n";
  line("phi_deg", pair(s.search.phi[0] * kDegrees, s.search.phi[1] * kDegrees), "deg");
  line("duration", pair(s.search.duration[0], s.search.duration[1]), "s");
  text += "\n[execution]\n";
  line("phi_deg", shortest(s.execution.phi * kDegrees), "deg");
  line("duration", shortest(s.execution.duration), "s");
  if (s.t_end) {
    text += "\n[run]\n";
    line("t_end", shortest(*s.t_end), "s");
  }
  return text;
}

std::string to_toml(const Motion& m, const std::string& comments) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  CsvWriter head;
  head.comment(comments);
  return head.text() + fmt::format("[motion]\nphi_i_deg = {}\nphi_f_deg = {}\nduration = {}  # s\n",
                                   shortest(m.phi_i * kDegrees), shortest(m.phi_f * kDegrees), shortest(m.duration));
}

}  // namespace ukemi::landing
