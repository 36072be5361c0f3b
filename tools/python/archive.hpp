// Any struct of the libraries as bytes and back, by its fields: to compare two, and to pickle one.
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
#include <tuple>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/uncertainty.hpp"
#include "tools/python/fields.hpp"

namespace ukemi::python {

/// Collects bytes. Compared are values: -0 is 0, and a NaN is a NaN whatever its bits.
class Writer {
 public:
  enum class Purpose { kKeep, kCompare };
  static constexpr bool kReads = false;
  explicit Writer(Purpose purpose) : compare_(purpose == Purpose::kCompare) {}

  bool compares() const { return compare_; }
  template <class T>
  void number(const T& x) {
    T kept = x;
    if constexpr (std::is_floating_point_v<T>) {
      if (compare_ && x == 0) kept = 0;
      if (compare_ && std::isnan(x)) kept = std::numeric_limits<T>::quiet_NaN();
    }
    bytes_.append(reinterpret_cast<const char*>(&kept), sizeof kept);
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

/// Takes them back. Throws InputError where they end too early.
class Reader {
 public:
  static constexpr bool kReads = true;
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  bool compares() const { return false; }
  template <class T>
  void number(T& x) {
    require(sizeof x);
    std::memcpy(&x, bytes_.data() + at_, sizeof x);
    at_ += sizeof x;
  }
  /// Of something that has at least a byte for each.
  std::size_t size(std::size_t) {
    std::size_t n = 0;
    number(n);
    require(n);
    return n;
  }
  bool done() const { return at_ == bytes_.size(); }

 private:
  void require(std::size_t n) const {
    if (n > bytes_.size() - at_) throw InputError("pickle: its bytes end too early: it is of another build");
  }
  const std::string& bytes_;
  std::size_t at_ = 0;
};

template <class A, class T>
void carry(A& a, T& x);

/// How a type goes that is no struct of plain fields; specialised by what follows and in parts.hpp.
template <class T>
struct Carry {
  template <class A, class X>
  static void go(A& a, X& x) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      a.number(x);
    else
      for_each_field(x, [&a](auto& field) { carry(a, field); });
  }
};

template <>
struct Carry<std::string> {
  template <class A, class X>
  static void go(A& a, X& x) {
    const std::size_t n = a.size(x.size());
    if constexpr (A::kReads) x.assign(n, ' ');
    for (auto& c : x) a.number(c);
  }
};
template <class T>
struct Carry<std::vector<T>> {
  template <class A, class X>
  static void go(A& a, X& x) {
    const std::size_t n = a.size(x.size());
    if constexpr (A::kReads) x = std::vector<T>(n);
    for (auto& item : x) carry(a, item);
  }
};
template <>
struct Carry<std::vector<bool>> {
  template <class A, class X>
  static void go(A& a, X& x) {
    const std::size_t n = a.size(x.size());
    if constexpr (A::kReads) x.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      bool bit = A::kReads ? false : bool(x[i]);
      a.number(bit);
      if constexpr (A::kReads) x[i] = bit;
    }
  }
};
template <class T, std::size_t N>
struct Carry<std::array<T, N>> {
  template <class A, class X>
  static void go(A& a, X& x) {
    for (auto& item : x) carry(a, item);
  }
};
template <class T, class U>
struct Carry<std::pair<T, U>> {
  template <class A, class X>
  static void go(A& a, X& x) {
    carry(a, x.first), carry(a, x.second);
  }
};
template <class K, class V>
struct Carry<std::map<K, V>> {
  template <class A, class X>
  static void go(A& a, X& x) {
    std::vector<std::pair<K, V>> items(x.begin(), x.end());
    carry(a, items);
    if constexpr (A::kReads) x = X(items.begin(), items.end());
  }
};
template <class T>
struct Carry<std::optional<T>> {
  template <class A, class X>
  static void go(A& a, X& x) {
    bool there = x.has_value();
    a.number(there);
    if constexpr (A::kReads) {
      x.reset();
      if (there) x.emplace(T{});
    }
    if (there) carry(a, *x);
  }
};
template <class T>
struct Carry<std::shared_ptr<const T>> {
  template <class A, class X>
  static void go(A& a, X& x) {
    std::optional<T> value;
    if (!A::kReads && x) value = *x;
    carry(a, value);
    if constexpr (A::kReads) x = value ? std::make_shared<const T>(std::move(*value)) : nullptr;
  }
};
template <class T, int R, int C, int O, int MR, int MC>
struct Carry<Eigen::Matrix<T, R, C, O, MR, MC>> {
  template <class A, class X>
  static void go(A& a, X& x) {
    Eigen::Index rows = x.rows(), columns = x.cols();
    a.number(rows), a.number(columns);
    if constexpr (A::kReads) {
      const auto fits = [](Eigen::Index n, int fixed, int most) {
        return n >= 0 && (fixed == Eigen::Dynamic || n == fixed) && (most == Eigen::Dynamic || n <= most);
      };
      if (!fits(rows, R, MR) || !fits(columns, C, MC) || rows > (1 << 24) || columns > (1 << 24))
        throw InputError("pickle: a matrix of a size that it cannot have: it is of another build");
      x.resize(rows, columns);
    }
    for (Eigen::Index i = 0; i < x.size(); ++i) a.number(x.data()[i]);
  }
};
template <>
struct Carry<DenseMatrix> {
  template <class A, class X>
  static void go(A& a, X& x) {
    Eigen::MatrixXd m = x;
    carry(a, m);
    if constexpr (A::kReads) x = m;
  }
};
/// What watches or stops a call is no part of its result.
template <class R, class... P>
struct Carry<std::function<R(P...)>> {
  template <class A, class X>
  static void go(A&, X&) {}
};

template <class A, class T>
void carry(A& a, T& x) {
  Carry<std::remove_const_t<T>>::go(a, x);
}

/// Both for one purpose.
template <class T>
std::string bytes_of(const T& x, Writer::Purpose purpose) {
  Writer out(purpose);
  carry(out, x);
  return out.bytes();
}
template <class T>
T value_of_bytes(const std::string& bytes) {
  T out{};
  Reader in(bytes);
  carry(in, out);
  if (!in.done()) throw InputError("pickle: bytes are left over: it is of another build");
  return out;
}

}  // namespace ukemi::python
