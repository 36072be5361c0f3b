// Writes the simulated impact trials of datasets/impact*. Simulated: no robot was hit.
//
//     make_trials FOLDER      (the project's datasets/ folder; run once, the files are shipped)
//
// The rig of Eq. 5 with Table 2 and tau_max = 20 Nm, integrated by the classical Runge-Kutta method at 1e-5 s with the
// clamp of Eq. 2 applied as it is: another method and a finer step than the fit uses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/csv.hpp"
#include "common/files.hpp"
#include "common/random.hpp"

namespace {

constexpr double kP = 50, kD = 1, kSea = 65, cSea = 1.6, iMotor = 0.085, tauMax = 20;  // Table 2; tau_max: Table 1
constexpr double length = 0.3, inertia = 0.024225;                                     // datasets/rigs/paper.toml
constexpr double kDuration = 1, kRate = 1000, kStep = 1e-5, kNoise = 5e-4;
constexpr std::uint64_t kSeed = 20261121;

struct Hit {
  double force, duration, start;  // [N], [s], [s]
};

double half_sine(const Hit& h, double t) {
  const double s = (t - h.start) / h.duration;
  return s > 0 && s < 1 ? h.force * std::sin(std::numbers::pi * s) : 0;
}

struct State {
  double phi, phi_m, omega, omega_m;
};

State rhs(const State& y, double force) {
  const double tau = std::clamp(kSea * (y.phi_m - y.phi) + cSea * (y.omega_m - y.omega), -tauMax, tauMax);
  const double motor = -kP * y.phi - kD * y.omega;
  return {y.omega, y.omega_m, (tau + length * std::cos(y.phi) * force) / inertia, (motor - tau) / iMotor};
}
State plus(const State& y, double h, const State& d) {
  return {y.phi + h * d.phi, y.phi_m + h * d.phi_m, y.omega + h * d.omega, y.omega_m + h * d.omega_m};
}

enum class Force { kSampled, kContinuous };

void write(const std::string& path, const Hit& hit, Force kind, std::uint64_t index) {
  const int rows = int(kDuration * kRate) + 1, per_row = int(std::lround(1 / (kRate * kStep)));
  std::vector<double> force;
  for (int i = 0; i < rows; ++i) force.push_back(std::round(1e4 * half_sine(hit, i / kRate)) / 1e4);
  const auto f = [&](int row, double fraction) {
    if (kind == Force::kContinuous) return half_sine(hit, (row + fraction) / kRate);
    const auto r = std::size_t(row);
    return row + 1 < rows ? force[r] + fraction * (force[r + 1] - force[r]) : force[r];
  };
  State y{};
  double largest = 0, torque = 0;
  ukemi::Random random(kSeed, index);
  ukemi::CsvWriter csv;
  csv.comment("SIMULATED impact trial, not a measurement. Written by tools/data/make_trials.cpp, seed " +
              std::to_string(kSeed) + ".");
  csv.comment(fmt::format(
      "Rig of Eq. 5: length {} m, inertia_joint {} kg m^2. Actuator (Table 2): k_p {} k_d {} k_sea {} c_sea {} "
      "i_motor {}; tau_max {} Nm (Table 1).",
      length, inertia, kP, kD, kSea, cSea, iMotor, tauMax));
  csv.comment(fmt::format("Half-sine hit of {} N, {} ms at t = {} s; {}.", hit.force, hit.duration * 1e3, hit.start,
                          kind == Force::kSampled
                              ? "the rig is driven by the sampled force, linear between samples"
                              : "the rig is driven by the continuous half-sine, sampled afterwards"));
  csv.comment(fmt::format("Angle noise: normal, sigma {} rad. Units: s, N, rad.", kNoise));
  csv.header({"t", "force", "phi"});
  for (int row = 0; row < rows; ++row) {
    csv.row({row / kRate, force[std::size_t(row)], std::round(1e8 * (y.phi + kNoise * random.normal())) / 1e8});
    for (int k = 0; k < per_row && row + 1 < rows; ++k) {
      const double a = double(k) / per_row, b = (k + 0.5) / per_row, c = (k + 1.0) / per_row;
      const State k1 = rhs(y, f(row, a)), k2 = rhs(plus(y, kStep / 2, k1), f(row, b)),
                  k3 = rhs(plus(y, kStep / 2, k2), f(row, b)), k4 = rhs(plus(y, kStep, k3), f(row, c));
      y = plus(plus(plus(plus(y, kStep / 6, k1), kStep / 3, k2), kStep / 3, k3), kStep / 6, k4);
      largest = std::max(largest, std::abs(y.phi));
      torque = std::max(torque, std::abs(kSea * (y.phi_m - y.phi) + cSea * (y.omega_m - y.omega)));
    }
  }
  ukemi::write_file(path, csv.text());
  fmt::print("{}: {} N, {} ms, {:.2f} N s, largest angle {:.3f} rad, largest spring torque {:.1f} Nm{}\n", path,
             hit.force, hit.duration * 1e3, 2 / std::numbers::pi * hit.force * hit.duration, largest, torque,
             torque > tauMax ? " (limited)" : "");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: make_trials FOLDER\n");
    return 2;
  }
  const std::string folder = argv[1];
  const Hit hits[] = {{30, 0.020, 0.0504},  {60, 0.015, 0.0507},  {100, 0.020, 0.0502}, {150, 0.010, 0.0505},
                      {150, 0.020, 0.0508}, {200, 0.015, 0.0501}, {250, 0.012, 0.0506}, {300, 0.010, 0.0503}};
  std::uint64_t index = 0;
  for (const Hit& h : hits) {
    const std::string name = fmt::format("trial_{}.csv", ++index);
    write(folder + "/impact/" + name, h, Force::kSampled, index);
    write(folder + "/impact_continuous/" + name, h, Force::kContinuous, 100 + index);
  }
  write(folder + "/impact_validation/trial_9.csv", {180, 0.014, 0.0505}, Force::kSampled, 9);
}
