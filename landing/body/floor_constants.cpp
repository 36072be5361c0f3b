#include "landing/body/floor_constants.hpp"

#include <algorithm>

namespace ukemi::landing {

double* contact_constant(ContactPoint& c, const std::string& key) {
  for (const LawConstant& constant : kLawConstants)
    if (key == constant.key) return &(c.law.*constant.at);
  for (const PadConstant& constant : kPadConstants)
    if (key == constant.key && c.pad) return &((*c.pad).*constant.at);
  return nullptr;
}

std::vector<std::string> floor_constant_names(const Robot& robot) {
  std::vector<std::string> out(kContactKeys.begin(), kContactKeys.end());
  out.push_back("pitch");
  for (const ContactPoint& c : robot.contacts)
    for (const char* const key : kContactKeys) out.push_back(c.name + "." + key);
  return out;
}

std::vector<double*> floor_constants(BodyScene& scene, const std::string& name) {
  if (name == "pitch") return {&scene.drop.pitch};
  std::vector<double*> out;
  const std::size_t dot = name.find('.');
  const std::string key = dot == std::string::npos ? name : name.substr(dot + 1);
  for (ContactPoint& c : scene.robot.contacts) {
    const bool selected = dot == std::string::npos
                              ? std::find(c.own_keys.begin(), c.own_keys.end(), key) == c.own_keys.end()
                              : name[0] == '*' || c.name == name.substr(0, dot);
    if (double* const x = selected ? contact_constant(c, key) : nullptr) out.push_back(x);
  }
  return out;
}

}  // namespace ukemi::landing
