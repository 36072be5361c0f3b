// The shipped scenes, and the actuator of Table 2 that lands in them.
#pragma once

#include <string>

#include "common/actuator.hpp"
#include "landing/model/scene_file.hpp"

namespace test {

inline ukemi::landing::Scene scene_of(const std::string& name) {
  return ukemi::landing::read_scene(UKEMI_DATASETS "/scenes/" + name + ".toml");
}
inline ukemi::landing::Scene paper() { return scene_of("paper"); }

inline ukemi::Actuator table2() { return ukemi::read_actuator(UKEMI_DATASETS "/actuators/table2.toml"); }
/// Its constants alone.
inline ukemi::SeaParameters<double> table2_sea() { return table2().sea; }

}  // namespace test
