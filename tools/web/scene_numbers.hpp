// The adjustable numbers of a scene's drop and floor, for the page.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace ukemi::tools {

/// An adjustable number of [drop] or [floor].
struct SceneNumber {
  std::string name;   ///< "drop.height", "drop.pitch_deg"
  std::string words;  ///< "drop height"
  std::string unit;
  double value, low, high;
  bool logarithmic;  ///< whether its slider is; the value is then above 0
};

/// Adjustable numbers of a scene file: of [drop] the keys `drop_keys`, of [floor] those in the file.
std::vector<SceneNumber> scene_numbers(const std::string& scene, const std::vector<std::string>& drop_keys);
/// The file's text with changed numbers; comments and order stay.
std::string with_numbers(const std::string& scene, const std::map<std::string, double>& numbers);
/// A self-contained scene: its text with the robot's and drives' files inserted. The unchanged text where their
/// notation does not allow that.
std::string whole_scene(const std::string& scene);

}  // namespace ukemi::tools
