// Tables of numbers: read with every malformed cell located, written with provenance in `#` lines.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"

namespace ukemi {

/// Longest interval between two samples of a log [s]: beyond it another log begins, or the clock was set.
inline constexpr double kLongestGap = 1e5;

/// A time that cannot follow those before it.
struct TimeFault {
  std::size_t at;
  std::string rule;
};
/// The first of `t` [s] that is not finite, does not increase, or is kLongestGap or more after the one before.
std::optional<TimeFault> time_fault(const std::vector<double>& t);
/// Throws InputError "WHAT[i]: value: rule" where there is one, or fewer than two times.
void require_times(const std::string& what, const std::vector<double>& t);

/// The columns of a file as numbers, with the location of each cell. An empty cell is NaN.
struct CsvTable {
  std::string file;
  std::vector<std::string> header;              ///< column names, trimmed
  std::vector<std::vector<double>> columns;     ///< columns[c][row]; every value finite unless the cell is empty
  std::vector<std::vector<std::string>> texts;  ///< texts[c][row] of the columns that are read as text
  std::vector<long> line;                       ///< line of each row in the file
  std::vector<std::vector<long>> column_of;     ///< byte column of each cell, [c][row]
  std::vector<long> header_column;              ///< byte column of each name in the header line
  long header_line = 0;

  std::size_t rows() const { return line.size(); }
  /// Index of a column, or -1.
  int find(const std::string& name) const;
  /// Index of a column; throws InputError where the table lacks it.
  int require(const std::string& name) const;
  Location at(int column, std::size_t row) const { return {file, line[row], column_of[column][row]}; }
  /// Throws InputError where a cell of the column is empty.
  void require_full(int column) const;
  /// Throws InputError where `t`, the column in seconds, has a time_fault.
  void require_increasing(int column, const std::vector<double>& t) const;
  /// Columns that are not `read` and look like one of `missing`: their index, and the hint that says which.
  std::vector<std::pair<std::size_t, std::string>> near_misses(const std::function<bool(const std::string& name)>& read,
                                                               const std::vector<std::string>& missing) const;
  /// Throws InputError at the name of a column that is not read.
  [[noreturn]] void refuse_unread(std::size_t column, const std::string& hint) const;
};

/// kAsEmpty takes "nan" for an empty cell: some programs export it for "no value".
enum class NanCells { kRefused, kAsEmpty };

/// Reads a CSV file: header, then rows of numbers; `#` lines are comments; comma, semicolon or tab, as in the
/// header. Throws InputError, with file:line:column, on: a missing, unreadable or empty file; NUL or control bytes
/// ("not a text file"); a line beyond 1 MiB; a repeated column name; a row with another number of cells; text, NaN or
/// infinity where a number is needed; no rows. Only the columns that `wanted` accepts are parsed (empty: all); others
/// may hold text, which is kept where `texts` names the column.
CsvTable read_csv(const std::string& path, const std::function<bool(const std::string& name)>& wanted = {},
                  NanCells nan = NanCells::kRefused, const std::vector<std::string>& texts = {});
/// The column names, read without the rest of the file; empty where it has no header. Throws as read_csv.
std::vector<std::string> csv_header(const std::string& path);

/// Builds a CSV text: comment lines, header, rows. Numbers are the shortest that read back exactly; NaN is an empty
/// cell.
class CsvWriter {
 public:
  void comment(const std::string& text);  ///< every line of `text` after "# "
  void header(const std::vector<std::string>& names);
  CsvWriter& cell(const std::string& text);
  CsvWriter& cell(const char* text) { return cell(std::string(text)); }
  CsvWriter& cell(double value);
  CsvWriter& cell(long value);
  CsvWriter& cell(int value) { return cell(long(value)); }
  void end_row();
  void row(const std::vector<double>& values);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  bool first_ = true;
};

/// Shortest text that reads back as the same double; "nan", "inf", "-inf" for the others.
std::string shortest(double value);

}  // namespace ukemi
