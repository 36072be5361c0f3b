// Risk of a motion of a robot of links over scattered drops, compared with the held posture.
#pragma once

#include <memory>
#include <optional>

#include "landing/judge/risk.hpp"
#include "landing/plan/body_drops.hpp"

namespace ukemi::landing {

struct BodyRiskOptions {
  long samples = 10'000;           ///< number of drops: scrambled Sobol points; 1 to 10,000,000
  std::optional<Scatter> scatter;  ///< see scatter_for
  BodyDropModel::Options drops;
  std::shared_ptr<const std::vector<BodyDrop>> measured;  ///< played instead of drawn ones
  std::uint64_t seed = 1;
  int threads = 0;        ///< 0: all cores; without influence on the results
  Monitor monitor;        ///< progress in landings; a result that it stops covers the drops played until then
  void validate() const;  ///< throws InputError
};

struct BodyRisk : PeakRisk {
  std::optional<Scatter> scatter;  ///< absent: measured drops
  bool assumed = false;            ///< neither the options nor the scene have a scatter
  struct Drop {
    BodyDrop drop;
    double peak;  ///< [m/s^2]
  };
  std::vector<Drop> worst;  ///< at most Risk::kWorst, the worst first
};

/// Plays a motion, and the held posture, over the drops of a scene; for Sobol's indices about as many landings again.
/// Events are exceeded ratings of joints and of loads. Same inputs and seed, same results. Throws
/// InputError as BodyDropModel and `simulate`. Tests: test/legs/scatter.cpp.
[[nodiscard]] BodyRisk body_risk(const BodyScene& scene, const BodyMotion& motion, const BodyRiskOptions& options = {});

}  // namespace ukemi::landing
