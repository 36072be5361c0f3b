// What a fit estimates: terms by their names, their bounds and priors.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace ukemi::identify {

struct Term;

/// What is known of a term beforehand: normal about `value`, counted like one more measurement.
struct Prior {
  std::string term;
  double value, std;  ///< in the term's unit; std > 0
};

/// Which terms of a table are fitted, within which bounds and with which priors.
struct Choice {
  std::vector<std::string> free;               ///< constants that are fitted, in this order; the others stay as given
  std::vector<std::string> nuisance;           ///< nuisance terms that are fitted
  std::map<std::string, double> lower, upper;  ///< override the table's; at least 0 where those are
  std::vector<Prior> priors;                   ///< of fitted terms

  bool fits(const std::string& term) const;
  void remove(const std::string& term);  ///< fits a nuisance term no longer, and drops its prior
  double lower_of(const Term& term) const;
  double upper_of(const Term& term) const;
};

/// Index of a term in a table; throws InputError "WHAT: no such term".
std::size_t index_of(const std::vector<const Term*>& table, const std::string& what, const std::string& name);
/// Names, bounds and priors. Throws InputError.
void validate(const std::vector<const Term*>& table, const Choice& choice);

/// A choice and its table of terms.
template <class T>
struct Terms : Choice {
  std::shared_ptr<const std::vector<T>> table;

  /// Throws InputError where there is no such term.
  const T& operator[](const std::string& name) const { return (*table)[index_of(pointers(), "term", name)]; }
  void validate() const { identify::validate(pointers(), *this); }  ///< throws InputError

 private:
  std::vector<const Term*> pointers() const {
    std::vector<const Term*> out;
    for (const T& t : *table) out.push_back(&t);
    return out;
  }
};

}  // namespace ukemi::identify
