#include "tools/report/page/page.hpp"

#include <array>
#include <cctype>
#include <map>

#include "common/text.hpp"
#include "tools/report/page/assets.hpp"

namespace ukemi::tools {

std::string escaped(const std::string& text) {
  static const std::map<char, std::string> marks = {
      {'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string out;
  for (const char c : shown(text)) out += marks.contains(c) ? marks.at(c) : std::string(1, c);
  return out;
}

std::string printed(std::string text) {
  const std::string square = "²";
  for (std::size_t at = 1; (at = text.find("^2", at)) != std::string::npos;)
    if (std::isalpha(static_cast<unsigned char>(text[at - 1])))
      text.replace(at, 2, square), at += square.size();
    else
      at += 2;
  return text;
}

std::string prose(const std::string& text) { return escaped(printed(text)); }

std::string json_block(const std::string& id, const std::string& json) {
  std::string safe;
  for (const char c : json) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return "<script type=\"application/json\" id=\"" + escaped(id) + "\">" + safe + "</script>\n";
}

namespace {

/// Hexadecimal digits as base64, the notation of hashes in a Content-Security-Policy.
std::string base64(const std::string& hex) {
  static constexpr std::array<char, 65> kDigits = {"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"};
  std::string out;
  unsigned bits = 0;
  int bit_count = 0;
  for (const char c : hex) {
    bits = bits << 4 | unsigned(c <= '9' ? c - '0' : c - 'a' + 10), bit_count += 4;
    for (; bit_count >= 6; bit_count -= 6) out += kDigits[bits >> (bit_count - 6) & 63U];
  }
  if (bit_count > 0) out += kDigits[bits << (6 - bit_count) & 63U];
  while (out.size() % 4 != 0) out += '=';
  return out;
}

}  // namespace

std::string page(const std::string& title, const std::string& body) {
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
         "img-src data:; script-src 'sha256-" +
         base64(kScriptSha256) +
         "'\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
         escaped(title) + "</title>\n<style>\n" + kStyle + "</style></head>\n<body><main>\n<h1>" + escaped(title) +
         "</h1>\n" + body + "</main>\n<script>" + kScript + "</script>\n</body></html>\n";
}

}  // namespace ukemi::tools
