#include "tools/report/page/origin.hpp"

#include <fmt/format.h>

#include <boost/crc.hpp>
#include <cstdint>
#include <sstream>

#include "tools/report/page/page.hpp"

namespace ukemi::tools {

namespace {

std::string svg_with(std::string svg, const std::string& text) {
  const std::size_t root = svg.find("<svg");
  if (root == std::string::npos) return svg;
  std::string words;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) words += escaped(line) + "\n";
  svg.insert(svg.find('>', root) + 1, "\n<metadata>" + words + "</metadata>");
  return svg.insert(root + 4, " style=\"color:black;background:white\"");
}

std::string big_endian(std::uint32_t n) {
  std::string out;
  for (const int shift : {24, 16, 8, 0}) out += char(n >> shift & 0xff);
  return out;
}

/// Inserts an iTXt chunk after IHDR: length, type, data, CRC of type and data (PNG, 2nd edition, 5.3 and 11.3.4.5).
std::string png_with(std::string png, const std::string& text) {
  constexpr std::size_t kSignature = 8, kHeader = 25;
  if (png.size() < kSignature + kHeader || png.compare(kSignature + 4, 4, "IHDR") != 0) return png;
  const std::string keyword("Comment\0\0\0\0\0", 12);  // not compressed, no language
  const std::string chunk = "iTXt" + keyword + text;
  boost::crc_32_type sum;
  sum.process_bytes(chunk.data(), chunk.size());
  return png.insert(kSignature + kHeader,
                    big_endian(std::uint32_t(chunk.size() - 4)) + chunk + big_endian(sum.checksum()));
}

/// The rest of the line after the last occurrence of a key; empty: none.
std::string last_value(const std::string& pdf, const std::string& key) {
  const std::size_t at = pdf.rfind(key);
  if (at == std::string::npos) return {};
  const std::size_t from = at + key.size();
  return pdf.substr(from, pdf.find('\n', from) - from);
}

/// Appends an incremental update that replaces the document information object (PDF 1.5, 3.4.5).
std::string pdf_with(std::string pdf, const std::string& text) {
  const std::string size = last_value(pdf, "/Size "), root = last_value(pdf, "/Root "),
                    info = last_value(pdf, "/Info "), prev = last_value(pdf, "startxref\n");
  const bool has_table = !prev.empty() && prev.find_first_not_of("0123456789") == std::string::npos &&
                         pdf.compare(std::min(pdf.size(), std::size_t(std::stoul(prev))), 4, "xref") == 0;
  if (size.empty() || root.empty() || info.empty() || !has_table) return pdf;
  // Keywords are not UTF-16, so that only ASCII is portable: any other character becomes "?".
  std::string keywords;
  for (const unsigned char c : text)
    if (c < 0x80 || c >= 0xc0) keywords += fmt::format("{:02x}", c < 0x80 ? c : '?');
  const std::string number = info.substr(0, info.find(' '));
  const std::size_t object = pdf.size();
  pdf += fmt::format("{} 0 obj\n<< /Producer (gnuplot, cairo) /Keywords <{}> >>\nendobj\n", number, keywords);
  const std::size_t table = pdf.size();
  pdf += fmt::format(
      "xref\n{} 1\n{:010} 00000 n \ntrailer\n<< /Size {}\n   /Root {}\n   /Info {}\n   /Prev {}\n>>\n"
      "startxref\n{}\n%%EOF\n",
      number, object, size, root, info, prev, table);
  return pdf;
}

}  // namespace

std::string with_origin(const std::string& name, std::string content, const std::string& text) {
  if (name.ends_with(".svg")) return svg_with(std::move(content), text);
  if (name.ends_with(".png")) return png_with(std::move(content), text);
  return name.ends_with(".pdf") ? pdf_with(std::move(content), text) : content;
}

}  // namespace ukemi::tools
