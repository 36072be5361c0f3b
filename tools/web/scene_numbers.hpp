// The numbers of a scene's drop and floor, as the page turns them and as it saves them.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ukemi::tools {

/// A number of [drop] or [floor] that the page can turn.
struct SceneNumber {
  std::string name;   ///< "drop.height", "drop.pitch_deg"
  std::string words;  ///< "drop height"
  std::string unit;
  double value, low, high;
  bool logarithmic;  ///< its slider; the value is above 0
};

/// Those of a scene file. `drop_keys`: keys of [drop] that the robot has; of [floor] those that the file gives.
std::vector<SceneNumber> scene_numbers(const std::string& scene, const std::vector<std::string>& drop_keys);
/// The file's text with other numbers; comments and order stay.
std::string with_numbers(const std::string& scene, const std::map<std::string, double>& numbers);
/// The text of a scene that needs no other file: the robot's file and the drives' files are written into it. Where
/// these are written in a way that cannot be joined, the scene's own text.
std::string whole_scene(const std::string& scene);

}  // namespace ukemi::tools
