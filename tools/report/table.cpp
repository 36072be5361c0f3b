#include "tools/report/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ukemi::tools {

std::string Format::operator()(const Json& v) const {
  if (words_) return words_(v.is_null() ? std::nan("") : v.get<double>());
  if (v.is_null() || (v.is_number_float() && std::isnan(v.get<double>()))) return "";
  const fmt::basic_runtime<char> format = fmt::runtime(format_);
  if (v.is_number_float()) return fmt::format(format, v.get<double>());
  if (v.is_number()) return fmt::format(format, v.get<long>());
  if (v.is_boolean()) return v.get<bool>() ? "yes" : "no";
  return fmt::format(format, v.get<std::string>());
}

std::string with_error(double value, double error) {
  if (!(error > 0) || !std::isfinite(error)) return fmt::format("{:.6g} ± {:.2g}", value, error);
  const int digits = 1 - int(std::floor(std::log10(error)));  // decimals; negative: round to tens, hundreds, ...
  const double step = std::pow(10.0, -digits);
  const auto text = [&](double x) {
    return std::abs(digits) > 6 ? fmt::format("{:.6g}", std::round(x / step) * step)
                                : fmt::format("{:.{}f}", std::round(x / step) * step, std::max(0, digits));
  };
  return text(value) + " ± " + text(error);
}

Json Table::object(std::size_t row) const {
  Json out = Json::object();
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (const std::string& key = names_[i].json; !key.empty())
      out[Json::json_pointer("/" + key)] =
          rows_[row][i].is_number_float() ? number(rows_[row][i].get<double>()) : rows_[row][i];
  return out;
}
Json Table::objects() const {
  Json out = Json::array();
  for (std::size_t row = 0; row < rows_.size(); ++row) out.push_back(object(row));
  return out;
}
Json Table::keyed() const {
  Json out;
  for (std::size_t row = 0; row < rows_.size(); ++row) out[rows_[row].front().get<std::string>()] = object(row);
  return out;
}

std::string Table::csv(const Run& run, const std::string& comment) const {
  CsvWriter csv = run.csv();
  if (!comment.empty()) csv.comment(comment);
  std::vector<std::string> header;
  for (const Names& h : names_)
    if (!h.csv.empty()) header.push_back(h.csv);
  csv.header(header);
  for (const std::vector<Json>& row : rows_) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i].csv.empty()) continue;
      const Json& v = row[i];
      if (v.is_number_float())
        csv.cell(v.get<double>());
      else if (v.is_number())
        csv.cell(v.get<long>());
      else
        csv.cell(v.is_null() ? "" : v.is_string() ? v.get<std::string>() : v.dump());
    }
    csv.end_row();
  }
  return csv.text();
}

std::vector<std::size_t> Table::columns() const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const auto shows = [&](const std::vector<Json>& row) { return !names_[i].format(row[i]).empty(); };
    if (!names_[i].words.empty() && (rows_.empty() || std::any_of(rows_.begin(), rows_.end(), shows))) out.push_back(i);
  }
  return out;
}
std::vector<std::string> Table::headings() const {
  std::vector<std::string> out;
  for (const std::size_t i : columns()) out.push_back(names_[i].words);
  return out;
}
std::vector<std::vector<std::string>> Table::shown() const {
  const std::vector<std::size_t> columns = this->columns();
  std::vector<std::vector<std::string>> out;
  for (const std::vector<Json>& row : rows_) {
    out.emplace_back();
    for (const std::size_t i : columns) out.back().push_back(names_[i].format(row[i]));
  }
  return out;
}
Table Table::transposed() const {
  Table out;
  out.names_ = {{"", "", "quantity", {}}, {"", "", "value", {}}};
  const std::vector<std::string> names = headings(), values = shown().front();
  for (std::size_t i = 0; i < names.size(); ++i) out.rows_.push_back({names[i], values[i]});
  return out;
}

namespace {
/// Number of characters of a UTF-8 text.
std::size_t length(const std::string& text) {
  return std::size_t(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}
}  // namespace

std::vector<std::string> Table::lines() const {
  std::vector<std::vector<std::string>> cells = shown();
  cells.insert(cells.begin(), headings());
  std::vector<std::size_t> width(cells.front().size(), 0);
  std::vector<bool> left;  // texts are left-aligned, numbers right-aligned
  for (const std::size_t i : columns()) left.push_back(!rows_.empty() && rows_.front()[i].is_string());
  for (const auto& row : cells)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], length(row[i]));
  std::vector<std::string> out;
  for (const auto& row : cells) {
    out.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i)
      out.back() += fmt::format(fmt::runtime(left[i] ? "{:<{}}  " : "{:>{}}  "), row[i], width[i]);
    out.back().erase(out.back().find_last_not_of(' ') + 1);
  }
  return out;
}
std::string Table::line(std::size_t row) const {
  const std::vector<std::string> names = headings(), values = shown()[row];
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) out += fmt::format("{}{} {}", i == 0 ? "" : "; ", names[i], values[i]);
  return out;
}

void say(const Table& table, const Run& run) {
  for (const std::string& line : table.lines()) run.say(line);
}

}  // namespace ukemi::tools
