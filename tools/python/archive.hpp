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
  template <class T>
  void number(const T& x) {
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
    std::memcpy(&x, bytes_.data() + position_, sizeof x);
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

template <class A, class T>
void serialize(A& a, T& x);

/// Reads or writes a value: a number, or a struct by its fields; specialised for other types here and in parts.hpp.
template <class T>
struct Serializer {
  template <class A, class X>
  static void apply(A& a, X& x) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      a.number(x);
    else
      for_each_field(x, [&a](auto& field) { serialize(a, field); });
  }
};

template <>
struct Serializer<std::string> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    const std::size_t n = a.size(x.size());
    if constexpr (A::kReading) x.assign(n, ' ');
    for (auto& c : x) a.number(c);
  }
};
template <class T>
struct Serializer<std::vector<T>> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    const std::size_t n = a.size(x.size());
    if constexpr (A::kReading) x = std::vector<T>(n);
    for (auto& item : x) serialize(a, item);
  }
};
template <>
struct Serializer<std::vector<bool>> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    const std::size_t n = a.size(x.size());
    if constexpr (A::kReading) x.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      bool bit = A::kReading ? false : bool(x[i]);
      a.number(bit);
      if constexpr (A::kReading) x[i] = bit;
    }
  }
};
template <class T, std::size_t N>
struct Serializer<std::array<T, N>> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    for (auto& item : x) serialize(a, item);
  }
};
template <class T, class U>
struct Serializer<std::pair<T, U>> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    serialize(a, x.first), serialize(a, x.second);
  }
};
template <class K, class V>
struct Serializer<std::map<K, V>> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    std::vector<std::pair<K, V>> items(x.begin(), x.end());
    serialize(a, items);
    if constexpr (A::kReading) x = X(items.begin(), items.end());
  }
};
template <class T>
struct Serializer<std::optional<T>> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    bool present = x.has_value();
    a.number(present);
    if constexpr (A::kReading) {
      x.reset();
      if (present) x.emplace(T{});
    }
    if (present) serialize(a, *x);
  }
};
template <class T>
struct Serializer<std::shared_ptr<const T>> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    std::optional<T> value;
    if (!A::kReading && x) value = *x;
    serialize(a, value);
    if constexpr (A::kReading) x = value ? std::make_shared<const T>(std::move(*value)) : nullptr;
  }
};
template <class T, int R, int C, int O, int MR, int MC>
struct Serializer<Eigen::Matrix<T, R, C, O, MR, MC>> {
  template <class A, class X>
  static void apply(A& a, X& x) {
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
};
template <>
struct Serializer<DenseMatrix> {
  template <class A, class X>
  static void apply(A& a, X& x) {
    Eigen::MatrixXd m = x;
    serialize(a, m);
    if constexpr (A::kReading) x = m;
  }
};
/// Callbacks, which monitor or stop a call, are not serialised.
template <class R, class... P>
struct Serializer<std::function<R(P...)>> {
  template <class A, class X>
  static void apply(A&, X&) {}
};

template <class A, class T>
void serialize(A& a, T& x) {
  Serializer<std::remove_const_t<T>>::apply(a, x);
}

/// A value as bytes.
template <class T>
std::string bytes_of(const T& x, Writer::Purpose purpose) {
  Writer out(purpose);
  serialize(out, x);
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
