// The contact constants of a robot of links by name, for calibrate and a scene's [uncertainty] and [verdict].
#pragma once

#include <array>
#include <string>
#include <vector>

#include "landing/body/body_scene.hpp"

namespace ukemi::landing {

/// A constant of a contact law by its key in files.
struct LawConstant {
  const char* key;
  double ContactLaw::*at;
};
inline constexpr std::array<LawConstant, 7> kLawConstants = {
    {{"stiffness", &ContactLaw::stiffness},
     {"damping_normal", &ContactLaw::damping_normal},
     {"damping_tangential", &ContactLaw::damping_tangential},
     {"stiffness_tangential", &ContactLaw::stiffness_tangential},
     {"friction", &ContactLaw::friction},
     {"exponent", &ContactLaw::exponent},
     {"dissipation", &ContactLaw::dissipation}}};

struct PadConstant {
  const char* key;
  double Pad::*at;
};
inline constexpr std::array<PadConstant, 3> kPadConstants = {
    {{"pad_stiffness", &Pad::stiffness}, {"pad_damping", &Pad::damping}, {"pad_thickness", &Pad::thickness}}};
/// The keys of all constants of a contact: its law's, then its pad's.
inline constexpr auto kContactKeys = [] {
  std::array<const char*, kLawConstants.size() + kPadConstants.size()> out{};
  std::size_t n = 0;
  for (const LawConstant& constant : kLawConstants) out[n++] = constant.key;
  for (const PadConstant& constant : kPadConstants) out[n++] = constant.key;
  return out;
}();
/// The constant of a contact by its key; null for an unknown key, or for a pad's if there is no pad.
double* contact_constant(ContactPoint& contact, const std::string& key);

/// All names: KEY (of every contact without its own), "pitch", CONTACT.KEY (of one contact); KEY of kContactKeys.
std::vector<std::string> floor_constant_names(const Robot& robot);
/// Pointers to the scene's numbers of a name, or of *.KEY (every contact); empty for unknown names and missing pads.
std::vector<double*> floor_constants(BodyScene& scene, const std::string& name);

}  // namespace ukemi::landing
