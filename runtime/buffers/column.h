// Attributes as columns: one named array of numbers for all the vertices, corners or faces of a mesh.
#pragma once

#include "runtime/core/archive.h"
#include "runtime/core/buffer.h"
#include "runtime/core/error.h"
#include "runtime/core/space.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace frustum {

enum class Domain : std::uint8_t { vertex, corner, face, mesh };
std::string_view name_of(Domain);

enum class NumberKind : std::uint8_t { f32, f64, i32, u32 };
std::string_view name_of(NumberKind);
constexpr std::size_t bytes_of(NumberKind k) { return k == NumberKind::f64 ? 8 : 4; }

// The number inside a column element and how many of them: float -> (f32, 1), glm::dvec3 -> (f64, 3).
template <class T>
struct Element {
  using number = T;
  static constexpr int width = 1;
};
template <glm::length_t n, class T, glm::qualifier q>
struct Element<glm::vec<n, T, q>> {
  using number = T;
  static constexpr int width = n;
};
template <class T>
constexpr NumberKind number_kind_of = std::is_same_v<T, float>          ? NumberKind::f32
                                      : std::is_same_v<T, double>       ? NumberKind::f64
                                      : std::is_same_v<T, std::int32_t> ? NumberKind::i32
                                                                        : NumberKind::u32;

// A column is immutable once it is part of a published mesh, and shared by every mesh that did not change it.
class Column {
 public:
  // `rows` elements of type T (a number or a glm vector of them), not initialised: the maker fills
  // `values<T>()`.
  template <class T>
  static std::shared_ptr<Column> make(std::string_view name, Domain domain, std::size_t rows,
                                      Space space = Space::none) {
    using E = Element<T>;
    return std::make_shared<Column>(name, domain, number_kind_of<typename E::number>, E::width, rows, space);
  }
  template <class T>
  static std::shared_ptr<Column> make(std::string_view name, Domain domain, std::span<const T> from,
                                      Space space = Space::none) {
    auto c = make<T>(name, domain, from.size(), space);
    std::copy(from.begin(), from.end(), c->template values<T>().begin());
    return c;
  }
  Column(std::string_view name, Domain, NumberKind, int width, std::size_t rows, Space = Space::none);
  // Over storage that is there already: at least rows x width numbers, on a 64-byte boundary.
  Column(std::string_view name, Domain, NumberKind, int width, std::size_t rows, Space,
         std::shared_ptr<void> storage);

  const std::string& name() const { return name_; }
  Domain domain() const { return domain_; }
  NumberKind kind() const { return kind_; }
  int width() const { return width_; }
  std::size_t rows() const { return rows_; }
  Space space() const { return space_; }
  std::size_t bytes() const { return rows_ * static_cast<std::size_t>(width_) * bytes_of(kind_); }
  const void* data() const { return data_.get(); }
  void* data() { return data_.get(); }

  // The elements, where T is what is stored; throws std::logic_error otherwise.
  template <class T>
  std::span<const T> values() const {
    require(number_kind_of<typename Element<T>::number>, Element<T>::width);
    return {static_cast<const T*>(data_.get()), rows_};
  }
  template <class T>
  std::span<T> values() {
    require(number_kind_of<typename Element<T>::number>, Element<T>::width);
    return {static_cast<T*>(data_.get()), rows_};
  }
  template <class T>
  bool holds() const {
    return kind_ == number_kind_of<typename Element<T>::number> && width_ == Element<T>::width;
  }
  double number(std::size_t row, int component) const;

  // The same storage under another name or in another space.
  Ref<Column> renamed(std::string_view name, Space space) const;

  // Counted once for each storage: every mesh that shares the column asks again. Call it on published
  // columns only.
  Health health() const;
  void hash(Hasher&) const;
  void save(ArchiveWriter&) const;
  static Ref<Column> load(ArchiveReader&);

 private:
  struct HealthMemo;
  Health count_health() const;
  void require(NumberKind, int width) const;

  std::string name_;
  Domain domain_;
  NumberKind kind_;
  int width_;
  std::size_t rows_;
  Space space_;
  std::shared_ptr<void> data_;
  std::shared_ptr<HealthMemo> health_;
};

// A real column in the precision R: itself, or widened from f32 to f64. Narrowing throws
// NodeError("narrowing"): it is a decision of the graph's author, never silent.
Ref<Column> as_precision(Ref<Column> column, NumberKind real);
template <class R>
Ref<Column> as_real(Ref<Column> column) {
  return as_precision(std::move(column), number_kind_of<R>);
}

}  // namespace frustum
