#include <algorithm>
#include <charconv>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>
#include <unordered_set>
#include <vector>

#include "common/error.hpp"
#include "common/files.hpp"
#include "tools/program/trials.hpp"

namespace ukemi::tools {

namespace {

constexpr std::size_t kLargestGains = 16 << 20;

Location location(const std::string& path, const std::string& text, std::ptrdiff_t offset) {
  const auto end = text.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ptrdiff_t(text.size()));
  const auto line_start = std::find(std::make_reverse_iterator(end), text.rend(), '\n').base();
  return {path, 1 + long(std::count(text.begin(), end, '\n')), 1 + long(end - line_start)};
}

/// "30 30 inf": a value a module; what is no finite number stays text.
Json values(const char* text) {
  Json out = Json::array();
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    double v = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v);
    const bool whole = error == std::errc() && end == word.data() + word.size();
    out.push_back(whole && std::isfinite(v) ? Json(v) : Json(word));
  }
  return out;
}

std::vector<pugi::xml_node> elements(pugi::xml_node parent) {
  std::vector<pugi::xml_node> out;
  for (const pugi::xml_node n : parent.children())
    if (n.type() == pugi::node_element) out.push_back(n);
  return out;
}

/// Adds a member for each element, as `value` has it; each name once. In a time that grows with their number: an
/// ordered object looks for a key from its start.
template <class Place, class Value>
void add_members(Json& object, const std::vector<pugi::xml_node>& from, const Place& place, const Value& value) {
  auto& members = object.get_ref<Json::object_t&>();
  std::unordered_set<std::string> names;
  for (const auto& member : members) names.insert(member.first);
  for (const pugi::xml_node element : from) {
    if (!names.insert(element.name()).second)
      throw InputError(place(element), "<" + std::string(element.name()) + ">: given twice: once is needed");
    members.Container::emplace_back(element.name(), value(element));
  }
}

}  // namespace

Json read_gains(const std::string& path) {
  const std::string text = read_text_file(path, 1 << 20, kLargestGains + 1);
  if (text.size() > kLargestGains)
    throw InputError({path}, "gains of at most " + std::to_string(kLargestGains) + " bytes are read");
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) throw InputError(location(path, text, parsed.offset), std::string("no XML: ") + parsed.description());
  const pugi::xml_node root = document.document_element();
  if (std::string(root.name()) != "group_gains")
    throw InputError(location(path, text, root.offset_debug()),
                     "<" + std::string(root.name()) + ">: HEBI gains are headed <group_gains>");
  Json out = {{"file", path}};
  const auto place = [&](pugi::xml_node n) { return location(path, text, n.offset_debug()); };
  const auto gain = [](pugi::xml_node n) { return values(n.text().get()); };
  add_members(out, elements(root), place, [&](pugi::xml_node controller) {
    const std::vector<pugi::xml_node> gains = elements(controller);
    if (gains.empty()) return gain(controller);
    Json of_controller = Json::object();
    add_members(of_controller, gains, place, gain);
    return of_controller;
  });
  return out;
}

}  // namespace ukemi::tools
