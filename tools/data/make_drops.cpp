// Writes the simulated drops of datasets/drops. Simulated: no robot was dropped.
//
//     make_drops FOLDER      (the project's datasets/ folder; run once, the files are shipped)
//
// Each drop is `simulate` at a tolerance of 1e-12 with added noise: code other than the rollout that calibrate fits.
// The floor of the drops of the hopper, a robot of links, differs from that of its scene.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "common/actuator.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/files.hpp"
#include "common/random.hpp"
#include "landing/body/body_run.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/run/simulate.hpp"

namespace {

using namespace ukemi;
using namespace ukemi::landing;

constexpr double kRate = 1000, kDuration = 1;
constexpr double kNoiseAcc = 2, kNoisePlace = 5e-4, kNoiseAngle = 0.2;  // m/s^2, m, deg
constexpr std::uint64_t kSeed = 20261122;
constexpr Floor<double> kFloor{6000, 110, 40};  // the true constants
constexpr double kPitch = -8 / kDegrees;

double rounded(double x, double digit) { return std::round(x / digit) * digit; }

void write(const std::string& path, Scene scene, const SeaParameters<double>& sea, double height, const Motion& motion,
           std::uint64_t index) {
  scene.floor = kFloor, scene.drop.pitch = kPitch, scene.drop.height = height, scene.t_end = kDuration;
  const Landing landing =
      simulate(scene, sea, motion, {.accuracy = 1e-12, .rest = SimulateOptions::Rest::kIgnore}, kRate);
  Random random(kSeed, index);
  CsvWriter csv;
  csv.comment(fmt::format("SIMULATED by ukemi, not measured. Written by tools/data/make_drops.cpp, seed {}.", kSeed));
  csv.comment(
      fmt::format("Robot: datasets/scenes/paper.toml; actuator: Table 2. Dropped from {} m at {} m/s, pitch {} "
                  "deg; played: {} to {} deg in {} s.",
                  height, scene.drop.forward_speed, rounded(kPitch * kDegrees, 1e-9),
                  rounded(motion.phi_i * kDegrees, 1e-9), rounded(motion.phi_f * kDegrees, 1e-9), motion.duration));
  csv.comment(fmt::format("Truth: stiffness {} N/m, damping_normal {} N/(m/s), damping_tangential {} N/(m/s).",
                          kFloor.stiffness, kFloor.damping_normal, kFloor.damping_tangential));
  csv.comment(fmt::format("Noise: normal, sigma {} m/s^2, {} m, {} deg. Units: s from release, m/s^2, m, deg.",
                          kNoiseAcc, kNoisePlace, kNoiseAngle));
  csv.header({"t", "acc", "x_0", "y_0", "phi_0_deg"});
  long row = 0;
  for (const Sample& s : landing.trajectory) {
    if (std::abs(s.t * kRate - double(row)) > 1e-6) continue;  // one of the two rows of an event
    csv.cell(fmt::format("{:.3f}", double(row++) / kRate));
    csv.cell(fmt::format("{:.2f}", s.acc + kNoiseAcc * random.normal()));
    csv.cell(fmt::format("{:.5f}", s.x0 + kNoisePlace * random.normal()));
    csv.cell(fmt::format("{:.5f}", s.y0 + kNoisePlace * random.normal()));
    csv.cell(fmt::format("{:.3f}", s.phi0 * kDegrees + kNoiseAngle * random.normal()));
    csv.end_row();
  }
  write_file(path, csv.text());
  fmt::print("{}: {} rows, peak {:.1f} m/s^2, {} touchdowns\n", path, row, landing.peak, landing.touches.size());
}

// --- the hopper ---

constexpr double kHopperDuration = 0.6, kNoiseHopper = 1;  // s, m/s^2
/// The true constants of its floor.
constexpr ContactLaw kHopperLaw{.stiffness = 16000,
                                .damping_normal = 150,
                                .damping_tangential = 45,
                                .stiffness_tangential = 14000,
                                .friction = 0.45};

/// Writes a drop with hip and knee held at these angles.
void write_hopper(const std::string& path, BodyScene scene, double height, double hip_deg, double knee_deg,
                  std::uint64_t index) {
  scene.drop.height = height, scene.t_end = kHopperDuration;
  for (ContactPoint& c : scene.robot.contacts) c.law = kHopperLaw;
  scene.search[0].hold = hip_deg * kDegree, scene.search[1].hold = knee_deg * kDegree;
  const BodyLanding landing =
      simulate(scene, held_posture(scene), {.accuracy = 1e-12, .rest = SimulateOptions::Rest::kIgnore}, kRate);
  Random random(kSeed, index);
  CsvWriter csv;
  csv.comment(fmt::format("SIMULATED by ukemi, not measured. Written by tools/data/make_drops.cpp, seed {}.", kSeed));
  csv.comment(fmt::format("Robot: datasets/robots/hopper.toml, dropped from {} m, held at hip {}, knee {} deg.", height,
                          hip_deg, knee_deg));
  csv.comment(
      fmt::format("Truth: stiffness {} N/m, damping_normal {} N/(m/s), friction {}, stiffness_tangential {} "
                  "N/m, damping_tangential {} N/(m/s).",
                  kHopperLaw.stiffness, kHopperLaw.damping_normal, kHopperLaw.friction, kHopperLaw.stiffness_tangential,
                  kHopperLaw.damping_tangential));
  csv.comment(fmt::format("Noise: normal, sigma {} m/s^2, {} m, {} deg. Units: s from release, m/s^2, m, deg.",
                          kNoiseHopper, kNoisePlace, kNoiseAngle));
  csv.header({"t", "acc", "y_slider", "phi_hip_deg", "phi_knee_deg"});
  long row = 0;
  for (const BodySample& s : landing.trajectory) {
    if (std::abs(s.t * kRate - double(row)) > 1e-6) continue;  // one of the two rows of an event
    csv.cell(fmt::format("{:.3f}", double(row++) / kRate));
    csv.cell(fmt::format("{:.2f}", s.acc + kNoiseHopper * random.normal()));
    csv.cell(fmt::format("{:.5f}", s.y[0] + kNoisePlace * random.normal()));
    csv.cell(fmt::format("{:.3f}", s.phi[0] * kDegrees + kNoiseAngle * random.normal()));
    csv.cell(fmt::format("{:.3f}", s.phi[1] * kDegrees + kNoiseAngle * random.normal()));
    csv.end_row();
  }
  write_file(path, csv.text());
  fmt::print("{}: {} rows, peak {:.1f} m/s^2, {} touchdowns\n", path, row, landing.peak, landing.touches.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: make_drops FOLDER\n");
    return 2;
  }
  const std::string folder = argv[1];
  const Scene scene = read_scene(folder + "/scenes/paper.toml");
  const SeaParameters<double> sea = read_actuator(folder + "/actuators/table2.toml").sea;
  const Motion held = read_motion(folder + "/drops/hold.toml"), bent = read_motion(folder + "/drops/bend.toml");
  write(folder + "/drops/drop_1.csv", scene, sea, 0.4, held, 1);
  write(folder + "/drops/drop_2.csv", scene, sea, 0.25, held, 2);
  write(folder + "/drops/drop_3.csv", scene, sea, 0.4, bent, 3);
  write(folder + "/drops/validation.csv", scene, sea, 0.32, bent, 4);
  const BodyScene hopper = read_body_scene(folder + "/scenes/hopper.toml");
  write_hopper(folder + "/drops/hopper_1.csv", hopper, 0.3, 35, -70, 5);
  write_hopper(folder + "/drops/hopper_2.csv", hopper, 0.2, 60, -70, 6);
  write_hopper(folder + "/drops/hopper_3.csv", hopper, 0.15, 10, -60, 7);
  write_hopper(folder + "/drops/hopper_4.csv", hopper, 0.25, 50, -80, 8);
}
