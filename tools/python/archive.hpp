// Serialisation of the libraries' structs by their fields, for comparison and pickles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/uncertainty.hpp"
#include "tools/python/fields.hpp"

namespace ukemi::python {

/// Serialises into bytes. For comparison -0 becomes 0, and all NaNs become one.
class Writer {
 public:
  enum class Purpose { kPickle, kCompare };
  static constexpr bool kReading = false;
  explicit Writer(Purpose purpose) : compare_(purpose == Purpose::kCompare) {}

  bool compares() const { return compare_; }
  /// A number, or anything else that its bytes are.
  template <class T>
  void number(const T& x) {
    static_assert(std::is_trivially_copyable_v<T>);
    T stored = x;
    if constexpr (std::is_floating_point_v<T>) {
      if (compare_ && x == 0) stored = 0;
      if (compare_ && std::isnan(x)) stored = std::numeric_limits<T>::quiet_NaN();
    }
    bytes_.append(reinterpret_cast<const char*>(&stored), sizeof stored);
  }
  std::size_t size(std::size_t n) {
    number(n);
    return n;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  bool compare_;
  std::string bytes_;
};

/// Deserialises. Throws InputError where the bytes end too early.
class Reader {
 public:
  static constexpr bool kReading = true;
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  bool compares() const { return false; }
  template <class T>
  void number(T& x) {
    require(sizeof x);
    std::memcpy(static_cast<void*>(&x), bytes_.data() + position_, sizeof x);
    position_ += sizeof x;
  }
  /// Size of a container whose elements take at least one byte each.
  std::size_t size(std::size_t) {
    std::size_t n = 0;
    number(n);
    require(n);
    return n;
  }
  bool done() const { return position_ == bytes_.size(); }

 private:
  void require(std::size_t n) const {
    if (n > bytes_.size() - position_) throw InputError("pickle: its bytes end too early: it is of another build");
  }
  const std::string& bytes_;
  std::size_t position_ = 0;
};

/// Reads or writes a value: a number, or a struct by its fields. Overloaded for other types here and in parts.hpp.
template <class A, class T>
void serialize(A& a, T& x) {
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
    a.number(x);
  else
    for_each_field(x, [&a](auto& field) { serialize(a, field); });
}
/// As a type that it converts to and from.
template <class As, class A>
void serialize_as(A& a, auto& x) {
  As value = x;
  serialize(a, value);
  if constexpr (A::kReading) x = value;
}

template <class A>
void serialize(A& a, std::string& x) {
  const std::size_t n = a.size(x.size());
  if constexpr (A::kReading) x.assign(n, ' ');
  for (char& c : x) a.number(c);
}
template <class A, class T>
void serialize(A& a, std::vector<T>& x) {
  const std::size_t n = a.size(x.size());
  if constexpr (A::kReading) x = std::vector<T>(n);
  for (T& item : x) serialize(a, item);
}
template <class A>
void serialize(A& a, std::vector<bool>& x) {
  const std::size_t n = a.size(x.size());
  if constexpr (A::kReading) x.resize(n);
  for (auto&& item : x) {
    bool bit = item;
    a.number(bit);
    if constexpr (A::kReading) item = bit;
  }
}
template <class T, std::size_t N>
void serialize(auto& a, std::array<T, N>& x) {
  for (T& item : x) serialize(a, item);
}
template <class T, class U>
void serialize(auto& a, std::pair<T, U>& x) {
  serialize(a, x.first), serialize(a, x.second);
}
template <class A, class K, class V>
void serialize(A& a, std::map<K, V>& x) {
  std::vector<std::pair<K, V>> items(x.begin(), x.end());
  serialize(a, items);
  if constexpr (A::kReading) x = std::map<K, V>(items.begin(), items.end());
}
template <class A, class T>
void serialize(A& a, std::optional<T>& x) {
  bool present = x.has_value();
  a.number(present);
  if constexpr (A::kReading) {
    x.reset();
    if (present) x.emplace(T{});
  }
  if (present) serialize(a, *x);
}
template <class A, class T>
void serialize(A& a, std::shared_ptr<const T>& x) {
  std::optional<T> value;
  if (!A::kReading && x) value = *x;
  serialize(a, value);
  if constexpr (A::kReading) x = value ? std::make_shared<const T>(std::move(*value)) : nullptr;
}
template <class A, class T, int R, int C, int O, int MR, int MC>
void serialize(A& a, Eigen::Matrix<T, R, C, O, MR, MC>& x) {
  Eigen::Index rows = x.rows(), columns = x.cols();
  a.number(rows), a.number(columns);
  if constexpr (A::kReading) {
    const auto fits = [](Eigen::Index n, int fixed, int maximum) {
      return n >= 0 && (fixed == Eigen::Dynamic || n == fixed) && (maximum == Eigen::Dynamic || n <= maximum);
    };
    if (!fits(rows, R, MR) || !fits(columns, C, MC) || rows > (1 << 24) || columns > (1 << 24))
      throw InputError("pickle: a matrix of a size that it cannot have: it is of another build");
    x.resize(rows, columns);
  }
  for (Eigen::Index i = 0; i < x.size(); ++i) a.number(x.data()[i]);
}
void serialize(auto& a, DenseMatrix& x) { serialize_as<Eigen::MatrixXd>(a, x); }
/// Callbacks, which monitor or stop a call, are not serialised.
template <class R, class... P>
void serialize(auto&, std::function<R(P...)>&) {}

/// A value as bytes.
template <class T>
std::string bytes_of(const T& x, Writer::Purpose purpose) {
  Writer out(purpose);
  serialize(out, const_cast<T&>(x));  // which a Writer only reads
  return out.bytes();
}
template <class T>
T value_of_bytes(const std::string& bytes) {
  T out{};
  Reader in(bytes);
  serialize(in, out);
  if (!in.done()) throw InputError("pickle: bytes are left over: it is of another build");
  return out;
}

}  // namespace ukemi::python
