#include <algorithm>
#include <charconv>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>

#include "common/error.hpp"
#include "common/files.hpp"
#include "tools/trials.hpp"

namespace ukemi::tools {

namespace {

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

}  // namespace

Json read_gains(const std::string& path) {
  const std::string text = read_text_file(path);
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) throw InputError(location(path, text, parsed.offset), std::string("no XML: ") + parsed.description());
  const pugi::xml_node root = document.document_element();
  if (std::string(root.name()) != "group_gains")
    throw InputError(location(path, text, root.offset_debug()),
                     "<" + std::string(root.name()) + ">: HEBI gains are headed <group_gains>");
  Json out = {{"file", path}};
  for (const pugi::xml_node controller : root.children()) {
    if (controller.type() != pugi::node_element) continue;
    const bool block = controller.find_child([](pugi::xml_node n) { return n.type() == pugi::node_element; });
    if (!block) {
      out[controller.name()] = values(controller.text().get());
      continue;
    }
    for (const pugi::xml_node gain : controller.children())
      if (gain.type() == pugi::node_element) out[controller.name()][gain.name()] = values(gain.text().get());
  }
  return out;
}

}  // namespace ukemi::tools
