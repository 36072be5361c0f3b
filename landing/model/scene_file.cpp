#include "landing/model/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/toml.hpp"
#include "common/uncertainty_file.hpp"
#include "landing/model/motion.hpp"
#include "landing/model/motion_csv.hpp"
#include "landing/model/release.hpp"
#include "landing/model/scatter_file.hpp"

namespace ukemi::landing {

namespace {

/// A range [low, high] of at least one value.
template <class Pair>
std::array<double, 2> nonempty_range(const TomlSection& section, const std::string& key, const Pair& v) {
  if (!(v[0] < v[1])) section.fail(key, "the range is empty: [low, high] with low < high is needed");
  return {v[0], v[1]};
}

/// Reads [motion], [release], [joint], [uncertainty], [verdict], [scatter], [detection], which the paper's scene lacks.
void read_further_tables(TomlFile& file, Scene& scene) {
  if (auto motion = file.optional("motion")) scene.freedom = read_freedom(*motion);
  if (auto joint = file.optional("joint"))
    if (const auto stops = joint->optional_angle_pair("phi")) scene.joint = nonempty_range(*joint, "phi_deg", *stops);
  if (auto release = file.optional("release")) {
    scene.release = Release{release->angle("phi"), release->optional_rate("rate").value_or(0),
                            release->optional_number("from", Range::non_negative()).value_or(0)};
    if (const auto wrong = release_fault(scene)) release->fail(wrong->key, wrong->message);
  }
  if (auto uncertainty = file.optional("uncertainty"))
    scene.uncertainty = read_uncertainty(*uncertainty, {kUncertainNames.begin(), kUncertainNames.end()}, "the scene");
  scene.verdicts = read_verdicts(file, {kUncertainNames.begin(), kUncertainNames.end()});
  if (auto scatter = file.optional("scatter")) scene.scatter = read_scatter(*scatter, false);
  if (auto detection = file.optional("detection")) {
    constexpr double kMaxDelay = 0.1;  // [s]
    scene.detection_delay = detection->optional_number("delay", Range::non_negative()).value_or(0);
    if (scene.detection_delay > kMaxDelay)
      detection->fail("delay", shortest(scene.detection_delay) + " s: at most " + shortest(kMaxDelay) + " s is needed");
  }
}

}  // namespace

Freedom read_freedom(TomlSection& motion) {
  Freedom out;
  out.bumps = int(motion.optional_count("bumps", 0, kMaxBumps).value_or(0));
  if (const auto bump = motion.optional_angle_pair("bump")) out.bump = nonempty_range(motion, "bump_deg", *bump);
  if (const auto gains = motion.optional_numbers("landing_gains", 2, Range::non_negative()))
    out.gains = nonempty_range(motion, "landing_gains", *gains);
  return out;
}

std::optional<ReleaseFault> release_fault(const Scene& scene) {
  if (!scene.release) return std::nullopt;
  const Release& r = *scene.release;
  const auto angle = [](double x) { return shortest(std::round(x / kDegree * 1e9) / 1e9); };
  if (scene.joint && !(r.phi >= (*scene.joint)[0] && r.phi <= (*scene.joint)[1]))
    return ReleaseFault{"phi_deg", fmt::format("{} deg: an angle within the joint's stops, {} to {} deg, is needed",
                                               angle(r.phi), angle((*scene.joint)[0]), angle((*scene.joint)[1]))};
  if (const double fall = fall_time(scene); is_ballistic(scene.drop, r.rate) && !(r.from < fall))
    return ReleaseFault{
        "from", fmt::format("{} s: a time before the first touchdown, at {:.6g} s, is needed", shortest(r.from), fall)};
  return std::nullopt;
}

TwoLinkTable read_two_link(TomlSection& robot) {
  TwoLinkTable out;
  out.robot.link_length = robot.number("link_length", Range::link_length());
  const auto mass = robot.numbers("mass", 2, Range::positive());
  const auto inertia = robot.numbers("inertia_com", 2, Range::positive());
  out.robot.mass = {mass[0], mass[1]};
  out.robot.inertia_com = {inertia[0], inertia[1]};
  out.robot.gravity = robot.number("gravity", Range::non_negative());
  if (const auto points = robot.optional_texts("contacts")) {
    const std::vector<std::string> known(kPointNames.begin(), kPointNames.end());
    for (const std::string& p : *points) {
      const auto it = std::find(known.begin(), known.end(), p);
      if (it == known.end()) robot.fail("contacts", one_of(p, known));
      out.contacts[std::size_t(it - known.begin())] = true;
    }
  }
  return out;
}

Scene read_scene(const std::string& path) {
  TomlFile file(path);
  Scene scene;
  scene.name = std::filesystem::path(path).stem().string();

  constexpr const char* kLinks =
      "a robot of links: `ukemi simulate`, `optimize`, `risk`, `compare`, `map`, `trade` and `robot` take it; here the "
      "paper's two links are needed, link_length, mass and inertia_com";
  if (file.optional_text("robot")) throw InputError(Location{path}, std::string("robot: ") + kLinks);
  TomlSection robot = file.require("robot");
  if (robot.has("link")) robot.fail("link", kLinks);
  const TwoLinkTable links = read_two_link(robot);
  scene.robot = links.robot, scene.contacts = links.contacts;

  if (auto floor = file.optional("floor")) {
    scene.floor = Floor<double>{floor->number("stiffness", Range::positive()),
                                floor->number("damping_normal", Range::non_negative()),
                                floor->number("damping_tangential", Range::non_negative())};
    scene.floor_source = floor->optional_text("source").value_or("");
  }

  TomlSection drop = file.require("drop");
  scene.drop.height = drop.number("height", {0, 1e4, false, "at least 0 and at most 1e4"});
  scene.drop.forward_speed = drop.optional_number("forward_speed", Range::any()).value_or(0);
  scene.drop.pitch = drop.angle("pitch");
  scene.drop.pitch_rate = drop.optional_number("pitch_rate", Range::any()).value_or(0);

  if (auto search = file.optional("search")) {
    if (const auto phi = search->optional_angle_pair("phi"))
      scene.search.phi = nonempty_range(*search, "phi_deg", *phi);
    if (const auto d = search->optional_numbers("duration", 2, Range::positive()))
      scene.search.duration = nonempty_range(*search, "duration", *d);
  }
  if (auto execution = file.optional("execution")) scene.execution = read_execution(*execution);
  if (auto run = file.optional("run")) scene.t_end = run->optional_number("t_end", Range::positive());
  read_further_tables(file, scene);
  file.finish();
  return scene;
}

Motion read_motion(const std::string& path) {
  if (std::filesystem::path(path).extension() == ".csv") return read_motion_csv(path);
  TomlFile file(path);
  TomlSection s = file.require("motion");
  auto move = file.optional("reposition");
  const char* const joint = kPointNames[kKnee];
  auto knee_table = s.optional_section(joint);  // as in motions of robots of links
  const Motion motion =
      knee_table ? read_motion(*knee_table, move ? move->optional_section(joint) : std::nullopt) : read_motion(s, move);
  if (auto p = file.optional("provenance")) p->accept_all();
  file.finish();
  return motion;
}

namespace {

/// An angle of a motion, at most a turn either way.
double joint_angle(TomlSection& s, const std::string& key) {
  constexpr double kTurn = 360;  // [deg]
  const double phi = s.angle(key);
  if (s.has(key + "_deg") && std::abs(phi) > kTurn * kDegree)
    s.fail(key + "_deg", fmt::format("{:.10g}", phi * kDegrees) + ": degrees from -360 to 360 are needed");
  return phi;
}

}  // namespace

Motion read_motion(TomlSection& s, std::optional<TomlSection> r) {
  Motion motion{joint_angle(s, "phi_i"), joint_angle(s, "phi_f"), s.number("duration", Range::positive())};
  const std::vector<double> bumps = s.optional_list("bumps_deg", kMaxBumps, Range::any());
  for (std::size_t k = 0; k < bumps.size(); ++k) motion.bumps[k] = bumps[k] * kDegree;
  motion.gain_p = s.optional_number("gain_p", Range::non_negative()).value_or(1);
  motion.gain_d = s.optional_number("gain_d", Range::non_negative()).value_or(1);
  if (!r) return motion;
  motion.reposition = Reposition{joint_angle(*r, "phi"), r->optional_rate("rate").value_or(0),
                                 r->number("from", Range::non_negative()), r->number("to", Range::positive())};
  if (!(motion.reposition->to > motion.reposition->from))
    r->fail("to", shortest(motion.reposition->to) + " s: later than `from` is needed");
  return motion;
}

namespace {

std::string pair(double a, double b) { return "[" + shortest(a) + ", " + shortest(b) + "]"; }

/// Appends "key = value  # unit" to a text.
struct LineWriter {
  std::string& text;
  void operator()(const char* key, const std::string& value, const char* unit) const {
    text += fmt::format("{} = {}  # {}\n", key, value, unit);
  }
};

/// Text of the tables that the paper's scene has not, which follow [run].
std::string further_tables(const Scene& s) {
  std::string text;
  const LineWriter line{text};
  if (s.freedom.bumps > 0 || s.freedom.gains) {
    text += "\n[motion]\n";
    line("bumps", std::to_string(s.freedom.bumps), "shape terms");
    line("bump_deg", pair(s.freedom.bump[0] * kDegrees, s.freedom.bump[1] * kDegrees), "deg");
    if (s.freedom.gains) line("landing_gains", pair((*s.freedom.gains)[0], (*s.freedom.gains)[1]), "factors");
  }
  if (s.joint) {
    text += "\n[joint]\n";
    line("phi_deg", pair((*s.joint)[0] * kDegrees, (*s.joint)[1] * kDegrees), "deg");
  }
  if (s.release) {
    text += "\n[release]\n";
    line("phi_deg", shortest(s.release->phi * kDegrees), "deg");
    line("rate_deg", shortest(s.release->rate * kDegrees), "deg/s");
    line("from", shortest(s.release->from), "s");
  }
  if (s.detection_delay > 0) {
    text += "\n[detection]\n";
    line("delay", shortest(s.detection_delay), "s");
  }
  if (s.uncertainty) {
    std::string names;
    for (const std::string& name : s.uncertainty->order) names += (names.empty() ? "\"" : ", \"") + name + "\"";
    text += "\n[uncertainty]\norder = [" + names + "]\n" + covariance_lines(s.uncertainty->covariance);
  }
  if (s.scatter) text += "\n[scatter]  # standard deviations\n" + toml_lines(*s.scatter);
  return text;
}

}  // namespace

std::string to_toml(const Scene& s, const std::string& comments) {
  CsvWriter head;
  head.comment(comments);
  std::string points;
  for (int j = 0; j < kPoints; ++j)
    if (s.contacts[j]) points += (points.empty() ? "\"" : ", \"") + std::string(kPointNames[j]) + "\"";
  std::string text = head.text() + "[robot]\n";
  const LineWriter line{text};
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
  return text + further_tables(s) + verdict_table(s.verdicts);
}

std::string to_toml(const Motion& m, const std::string& comments) {
  CsvWriter head;
  head.comment(comments);
  return head.text() + motion_tables(m);
}

std::string motion_tables(const Motion& m, const std::string& joint) {
  const std::string suffix = joint.empty() ? "" : "." + joint;
  std::string text = fmt::format("[motion{}]\nphi_i_deg = {}\nphi_f_deg = {}\nduration = {}  # s\n", suffix,
                                 shortest(m.phi_i * kDegrees), shortest(m.phi_f * kDegrees), shortest(m.duration));
  if (has_bumps(m)) {
    std::string bumps;
    for (const double b : m.bumps) bumps += (bumps.empty() ? "" : ", ") + shortest(b * kDegrees);
    text += "bumps_deg = [" + bumps + "]\n";
  }
  if (m.gain_p != 1 || m.gain_d != 1)
    text += fmt::format("gain_p = {}  # factor of K_p from the start of the landing motion on\ngain_d = {}  # of K_d\n",
                        shortest(m.gain_p), shortest(m.gain_d));
  if (const auto& r = m.reposition)
    text += fmt::format(
        "\n[reposition{}]\nphi_deg = {}  # at release\nrate_deg = {}\nfrom = {}  # s from release\nto = {}\n", suffix,
        shortest(r->phi * kDegrees), shortest(r->rate * kDegrees), shortest(r->from), shortest(r->to));
  return text;
}

}  // namespace ukemi::landing
