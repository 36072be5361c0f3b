#include "common/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "common/files.hpp"
#include "common/text.hpp"

namespace ukemi {

namespace {

constexpr std::size_t kLongestLine = 1 << 20;

std::string_view trim(std::string_view s) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!s.empty() && blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && blank(s.back())) s.remove_suffix(1);
  return s;
}

char separator_of(std::string_view header) {
  char separator = ',';
  std::size_t count = 0;
  for (const char c : {',', ';', '\t'}) {
    std::size_t n = 0;
    for (const char x : header) n += x == c;
    if (n > count) separator = c, count = n;
  }
  return separator;
}

/// Calls visit(cell, byte column) for each cell of a line.
template <class Visit>
void for_cells(std::string_view line, char separator, Visit&& visit) {
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    const std::string_view raw = line.substr(begin, end - begin), cell = trim(raw);
    visit(cell, long(cell.empty() ? begin : cell.data() - line.data()) + 1);
    if (end == line.size()) return;
    begin = end + 1;
  }
}

bool is_nan(std::string_view cell) {
  return cell.size() == 3 && (cell[0] | 32) == 'n' && (cell[1] | 32) == 'a' && (cell[2] | 32) == 'n';
}

double parse_number(std::string_view cell, const Location& where, const std::string& column) {
  std::string_view digits = cell;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-' && digits[1] != '+') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const auto fail = [&](const char* rule) {
    throw InputError(where, fmt::format("column '{}': {}: {}", column, quoted(std::string(cell)), rule));
  };
  if (error == std::errc::result_out_of_range) fail("the number is out of range");
  if (error != std::errc() || end != digits.data() + digits.size()) fail("a number is needed");
  if (!std::isfinite(value)) fail("a finite number is needed");
  return value;
}

/// Iterates over the lines that are neither blank nor a comment.
struct Lines {
  std::string_view text;
  std::size_t begin = 0;  ///< of the next line; size() + 1 after a last line without a line break
  long number = 0;

  bool next(std::string_view& line) {
    while (begin < text.size()) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      line = text.substr(begin, end - begin);
      begin = end + 1;
      if (++number == 1 && line.substr(0, 3) == "\xEF\xBB\xBF") line.remove_prefix(3);
      if (!trim(line).empty() && trim(line).front() != '#') return true;
    }
    return false;
  }
};

/// Reads the column names into `table`; returns the separator.
char read_header(std::string_view line, long number, CsvTable& table) {
  const char separator = separator_of(line);
  table.header_line = number;
  std::unordered_set<std::string> names;
  for_cells(line, separator, [&](std::string_view cell, long column) {
    if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
    const std::string name(cell);
    if (!names.insert(name).second)
      throw InputError({table.file, number, column}, "column " + quoted(name) + ": the header names it twice");
    table.header.push_back(name);
    table.header_column.push_back(column);
  });
  return separator;
}

}  // namespace

int CsvTable::find(const std::string& name) const {
  for (std::size_t i = 0; i < header.size(); ++i)
    if (header[i] == name) return int(i);
  return -1;
}

int CsvTable::require(const std::string& name) const {
  const int c = find(name);
  if (c < 0) throw InputError({file, header_line}, "column '" + name + "': missing" + hint(name, header));
  return c;
}

std::vector<std::pair<std::size_t, std::string>> CsvTable::near_misses(
    const std::function<bool(const std::string& name)>& read, const std::vector<std::string>& missing) const {
  std::vector<std::pair<std::size_t, std::string>> out;
  for (std::size_t c = 0; c < header.size(); ++c)
    if (std::string suggestion = read(header[c]) ? "" : hint(header[c], missing); !suggestion.empty())
      out.emplace_back(c, std::move(suggestion));
  return out;
}

void CsvTable::refuse_unread(std::size_t column, const std::string& hint) const {
  throw InputError({file, header_line, header_column[column]},
                   "column " + quoted(header[column]) + ": it is not read" + hint);
}

void CsvTable::require_full(int column) const {
  const auto c = std::size_t(column);
  for (std::size_t i = 0; i < rows(); ++i)
    if (std::isnan(columns[c][i]))
      throw InputError(at(column, i), "column '" + header[c] + "': empty: a number is needed");
}

void CsvTable::require_increasing(int column, const std::vector<double>& t) const {
  if (const auto fault = time_fault(t))
    throw InputError(at(column, fault->at), fmt::format("column 't': {}: {}", shortest(t[fault->at]), fault->rule));
}

std::optional<TimeFault> time_fault(const std::vector<double>& t) {
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i])) return TimeFault{i, "a finite number is needed"};
    if (i == 0) continue;
    if (!(t[i] > t[i - 1]))
      return TimeFault{i, fmt::format("time must increase; {} stands before it", shortest(t[i - 1]))};
    if (t[i] - t[i - 1] >= kLongestGap)
      return TimeFault{
          i, fmt::format("less than {:g} s after the time before it, {}, is needed", kLongestGap, shortest(t[i - 1]))};
  }
  return std::nullopt;
}

void require_times(const std::string& what, const std::vector<double>& t) {
  if (t.size() < 2) throw InputError(fmt::format("{}: {} values: at least two are needed", what, t.size()));
  if (const auto fault = time_fault(t))
    throw InputError(fmt::format("{}[{}]: {}: {}", what, fault->at, shortest(t[fault->at]), fault->rule));
}

std::vector<std::string> csv_header(const std::string& path) {
  CsvTable table;
  table.file = path;
  for (std::size_t at_most = 1 << 12;; at_most *= 8) {
    const std::string text = read_text_file(path, kLongestLine, at_most);
    const bool whole = text.size() < at_most;
    Lines lines{text};
    std::string_view line;
    if (lines.next(line) && (whole || lines.begin <= text.size())) read_header(line, lines.number, table);
    if (whole || !table.header.empty()) return table.header;
  }
}

CsvTable read_csv(const std::string& path, const std::function<bool(const std::string& name)>& wanted, NanCells nan,
                  const std::vector<std::string>& texts) {
  const std::string text = read_text_file(path, kLongestLine);
  CsvTable table;
  table.file = path;
  Lines lines{text};
  std::string_view line;
  if (!lines.next(line)) throw InputError({path}, "the file is empty: a header line with column names is needed");
  const char separator = read_header(line, lines.number, table);
  std::vector<bool> as_text, as_number;
  for (const std::string& name : table.header) {
    as_text.push_back(std::find(texts.begin(), texts.end(), name) != texts.end());
    as_number.push_back(!as_text.back() && (!wanted || wanted(name)));
  }
  table.columns.resize(table.header.size());
  table.texts.resize(table.header.size());
  table.column_of.resize(table.header.size());
  while (lines.next(line)) {
    const long number = lines.number;
    std::size_t c = 0;
    for_cells(line, separator, [&](std::string_view cell, long column) {
      if (c >= table.header.size())
        throw InputError({path, number, column}, fmt::format("{}: more cells than the header's {} columns",
                                                             quoted(std::string(cell)), table.header.size()));
      if (as_number[c]) {
        const bool empty = cell.empty() || (nan == NanCells::kAsEmpty && is_nan(cell));
        table.columns[c].push_back(empty ? std::numeric_limits<double>::quiet_NaN()
                                         : parse_number(cell, {path, number, column}, table.header[c]));
      } else if (as_text[c]) {
        table.texts[c].emplace_back(cell);
      }
      if (as_number[c] || as_text[c]) table.column_of[c].push_back(column);
      ++c;
    });
    if (c != table.header.size())
      throw InputError({path, number, 1}, fmt::format("{} cells: the header has {} columns", c, table.header.size()));
    table.line.push_back(number);
  }
  if (table.line.empty()) throw InputError({path, table.header_line}, "no rows: at least one row of numbers is needed");
  return table;
}

std::string shortest(double value) { return fmt::format("{}", value); }

void CsvWriter::comment(const std::string& text) {
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin || end < text.size()) text_ += "# " + shown(text.substr(begin, end - begin)) + "\n";
    begin = end + 1;
  }
}
void CsvWriter::header(const std::vector<std::string>& names) {
  for (const std::string& n : names) cell(n);
  end_row();
}
CsvWriter& CsvWriter::cell(const std::string& text) {
  if (!first_) text_ += ',';
  first_ = false;
  text_ += text;
  return *this;
}
CsvWriter& CsvWriter::cell(double value) { return cell(std::isfinite(value) ? shortest(value) : std::string()); }
CsvWriter& CsvWriter::cell(long value) { return cell(std::to_string(value)); }
void CsvWriter::end_row() { text_ += '\n', first_ = true; }
void CsvWriter::row(const std::vector<double>& values) {
  for (const double v : values) cell(v);
  end_row();
}

}  // namespace ukemi
