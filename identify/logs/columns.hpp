// The map from a file's columns to quantities in SI units: names, unit suffixes, scales, signs.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/csv.hpp"

namespace ukemi::identify {

/// What a column holds; its name's suffix says in which unit: time _ms; angle and rate _deg, _mrad; force _N, _kN;
/// torque _Nm, _mNm; acceleration _g, 9.80665 m/s^2; length _mm; command as it is.
enum class Quantity { kTime, kAngle, kRate, kForce, kTorque, kAcceleration, kLength, kCommand };

struct Column {
  std::string name;
  Quantity quantity;
};

/// The column of a file that holds a quantity.
struct Source {
  std::string column;  ///< name in the file
  double scale = 1;    ///< to SI, sign included
};

/// Reads the quantities of a table by name, or by a map "t=Time,phi=-defl_deg,force=0.001*Fy,...".
class ColumnMap {
 public:
  /// `option` is named in errors. Throws InputError on an item that is not NAME=COLUMN, a name that is not among
  /// `known` (nearest given), and a scale that is 0 or not finite.
  ColumnMap(const std::string& option, const std::string& map, std::vector<Column> known);

  /// Whether a column of the file is named by the map or by a known name.
  bool wants(const std::string& column) const;
  /// The possible column names of every quantity that is neither in `table` nor in the map.
  std::vector<std::string> missing_from(const CsvTable& table) const;
  /// Index in `table` of the column that holds `name`, with its scale in `source`; -1 where there is none. Throws
  /// InputError where two columns hold it, and where the map names a column that is not there.
  int find(const CsvTable& table, const std::string& name, Source& source) const;
  /// The number [SI] that the map gives `name` instead of a column of `table`, if any.
  std::optional<double> constant(const CsvTable& table, const std::string& name) const;

 private:
  std::vector<Source> candidates(const std::string& name) const;
  std::vector<Column> known_;
  std::map<std::string, Source> mapped_;
};

/// Notes on columns that are not read and resemble a missing quantity. Throws InputError where only the case differs.
std::vector<std::string> near_misses(const CsvTable& table, const ColumnMap& map);

}  // namespace ukemi::identify
