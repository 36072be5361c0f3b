// The page's engine: answers requests of the page's script, both JSON. Stateless: a request holds all its files and
// numbers.
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/files.hpp"
#include "landing/model/motion_space.hpp"
#include "tools/program/json.hpp"
#include "tools/report/landing_sentence.hpp"
#include "tools/web/lander.hpp"
#include "tools/web/scene_numbers.hpp"

namespace ukemi::tools {

namespace {

constexpr const char* kMotionFile = "motion.toml";

Json json_of(const SceneNumber& n) {
  return {{"name", n.name},
          {"words", n.words},
          {"unit", n.unit},
          {"value", n.value},
          {"low", n.low},
          {"high", n.high},
          {"logarithmic", n.logarithmic}};
}
/// The adjustable numbers with their values in the files.
Json opened(const Lander& lander, const std::string& scene) {
  Json out = {{"hold", lander.hold_arguments()}, {"numbers", Json::array()}, {"motion", Json::array()}};
  for (const SceneNumber& n : scene_numbers(scene, lander.drop_keys())) out["numbers"].push_back(json_of(n));
  const landing::MotionValues held = lander.hold_values();
  const std::vector<landing::Variable> variables = lander.variables();
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const landing::Variable& v = variables[k];
    out["motion"].push_back(
        {{"name", v.name}, {"unit", v.unit}, {"low", v.lower}, {"high", v.upper}, {"value", held[int(k)]}});
  }
  return out;
}

landing::MotionValues values_of(const Json& list) {
  landing::Coordinates out(long(list.size()));
  for (std::size_t k = 0; k < list.size(); ++k) out[long(k)] = list[k].get<double>();
  return out;
}

/// Landings of a motion (null: the held posture) and of the held posture.
Json landed(const Lander& lander, const Json& motion) {
  const Played held = lander.held();
  Json out = {{"held", held.peak}, {"landings", Json::array()}};
  if (motion.is_null()) {
    out["peak"] = held.peak, out["failure"] = held.failure, out["sentence"] = landing_sentence(held.peak, std::nan(""));
    out["landings"].push_back(held.animation), out["doubts"] = held.doubts;
    return out;
  }
  write_file(kMotionFile, lander.motion_toml(values_of(motion)));
  const Played played = lander.play(kMotionFile);
  out["peak"] = played.peak, out["failure"] = played.failure;
  out["sentence"] = landing_sentence(played.peak, held.failure.empty() ? held.peak : std::nan(""));
  out["landings"] = {played.animation, held.animation}, out["doubts"] = played.doubts;
  return out;
}

/// The motion that a search of `seconds` finds, or null.
Json planned(const Lander& lander, const Json& request) {
  const Json& from = request["motion"];
  const auto best =
      lander.plan(request["seconds"].get<double>(), from.is_null() ? lander.hold_values() : values_of(from));
  return {{"motion", best ? Json(std::vector<double>(best->begin(), best->end())) : Json()}};
}

Json saved(const Lander& lander, const std::string& scene, const Json& motion) {
  return {{"scene", whole_scene(scene)}, {"motion", motion.is_null() ? "" : lander.motion_toml(values_of(motion))}};
}

/// {"files": {PATH: TEXT}, "scene": PATH, "actuator": PATH, "numbers": {NAME: VALUE}, "motion": [VALUE ...] or null,
///  "do": "open", "land", "plan" with "seconds", "save"}.
Json answer(const Json& request) {
  for (const auto& [path, text] : request["files"].items()) write_file(path, text.get<std::string>());
  const std::string scene = request["scene"], what = request["do"];
  write_file(scene, with_numbers(scene, request["numbers"].get<std::map<std::string, double>>()));
  const std::unique_ptr<Lander> lander = read_lander(scene, request["actuator"]);
  if (what == "open") return opened(*lander, scene);
  if (what == "plan") return planned(*lander, request);
  if (what == "save") return saved(*lander, scene, request["motion"]);
  return landed(*lander, request["motion"]);
}

}  // namespace

}  // namespace ukemi::tools

/// The answer to a request, valid until the next call; {"error": "FILE:LINE:COLUMN: ..."} for a bad file.
extern "C" const char* ukemi_answer(const char* request) {
  using ukemi::tools::Json;
  static std::string text;
  try {
    std::filesystem::create_directories("/a/b/c/scenes");  // so deep that relative paths may lead upwards
    std::filesystem::current_path("/a/b/c/scenes");
    text = ukemi::tools::answer(Json::parse(request)).dump();
  } catch (const std::exception& e) {
    text = Json({{"error", e.what()}}).dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  return text.c_str();
}
