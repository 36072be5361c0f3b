// Reading and writing of [uncertainty] and [verdict].
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/toml.hpp"
#include "common/uncertainty.hpp"
#include "common/verdict.hpp"

namespace ukemi {

/// The faulty key and its fault, see `check` of common/checks.hpp; both empty where there is none.
std::pair<std::string, std::string> fault_of(const Uncertainty& uncertainty, const std::vector<std::string>& known,
                                             const std::string& owner);
/// `order` and `covariance`; each name once and one of `known`, which are constants of `owner`. Throws InputError with
/// file:line:column.
Uncertainty read_uncertainty(TomlSection& section, const std::vector<std::string>& known, const std::string& owner);
/// The TOML text of the key `covariance`.
std::string covariance_lines(const DenseMatrix& covariance);

/// Verdicts of [verdict]; keys are some of `constants`, the result in their order. Empty where there is no such table.
/// Throws InputError with file:line:column.
Verdicts read_verdicts(TomlFile& file, const std::vector<std::string>& constants);
/// The TOML text of [verdict]; empty where there is no verdict.
std::string verdict_table(const Verdicts& verdicts);

}  // namespace ukemi
