// The paper's robot and its scenes as a robot of links: thigh and shank, joined by the knee.
#pragma once

#include <array>

#include "landing/body/body_run.hpp"
#include "landing/model/constants.hpp"

namespace ukemi::landing {

/// The robot, with a knee that has no drive yet; the contact points that may touch get this law.
Robot by_links(const TwoLink<double>& robot, const std::array<bool, kPoints>& contacts, const ContactLaw& law);

/// A landing of the paper's robot as one of links. Its inputs must be valid.
class TwoLinkLanding {
 public:
  TwoLinkLanding();
  TwoLinkLanding(const Scene& s, const SeaParameters<double>& sea, const Motion& m, const Limits& limits = {})
      : TwoLinkLanding() {
    set_scene(s), set_limits(limits), set_drive(sea, m);
  }
  /// The scene; limits are to be set again. Reuses its memory where the same points may touch.
  void set_scene(const Scene& s);
  /// Limits become loads of the scene that end a run.
  void set_limits(const Limits& limits);
  void set_drive(const SeaParameters<double>& sea, const Motion& m);

  /// The outcome of the landing, with the numbers of the paper's points.
  LandingPeak outcome(const RunEnd& run) const;
  /// The number of a contact of the robot of links; -1: -1.
  int point(int contact) const;

  BodyScene scene;
  BodyMotion motion{Motion{}};

 private:
  std::array<bool, kPoints> contacts_{true, true, true};  ///< the points that scene.robot has
  double reference_rate_ = std::numeric_limits<double>::infinity();
  int rate_load_ = -1;  ///< index of the load that limits the rate of the reference; -1: none
};

/// Landings of this thread, whose memory is reused: 0..7 are for lanes.
inline constexpr int kReusedLandings = 9;
TwoLinkLanding& reused_landing(int i);

}  // namespace ukemi::landing
