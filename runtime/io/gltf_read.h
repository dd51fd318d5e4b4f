// Elements of accessors as rows of reals or indices.
#pragma once

#include "nodes/kernels/parallel.h"
#include "runtime/io/gltf_data.h"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace frustum::gltf {

template <class C>
C load(const char* from) {
  C v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

// The value of a stored component (glTF 2.0, 3.6.2.2): normalised integers are c / most, and at least -1.
template <class To, class C>
To component_value(C c, [[maybe_unused]] bool normalized) {
  if constexpr (std::is_floating_point_v<To> && std::is_integral_v<C>) {
    const To v = static_cast<To>(c);
    return normalized ? std::max(v / static_cast<To>(std::numeric_limits<C>::max()), To(-1)) : v;
  } else {
    return static_cast<To>(c);
  }
}

template <class Body>
void with_component(Component c, Body&& body) {
  switch (c) {
    case Component::i8: return body(std::int8_t{});
    case Component::u8: return body(std::uint8_t{});
    case Component::i16: return body(std::int16_t{});
    case Component::u16: return body(std::uint16_t{});
    case Component::u32: return body(std::uint32_t{});
    case Component::f32: return body(float{});
  }
}

// Elements [begin, end) of an accessor of width n, without its sparse ones.
template <class To, int n>
void read_block(const Accessor& a, std::size_t begin, std::size_t end, To* out) {
  if (a.first == nullptr) {
    std::fill_n(out + begin * n, (end - begin) * n, To(0));
    return;
  }
  with_component(a.component, [&]<class C>(C) {
    if constexpr (std::is_same_v<C, To>) {
      if (a.stride == sizeof(C) * n) {
        std::memcpy(out + begin * n, a.first + begin * a.stride, (end - begin) * a.stride);
        return;
      }
    }
    const char* from = a.first + begin * a.stride;
    for (std::size_t i = begin; i < end; ++i, from += a.stride)
      for (std::size_t k = 0; k < n; ++k)
        out[i * n + k] = component_value<To>(load<C>(from + k * sizeof(C)), a.normalized);
  });
}

// Replaces the sparse elements. Throws NodeError where an index lies outside.
template <class To, int n>
void read_sparse(const Accessor& a, const FilePath& file, To* out) {
  const Accessor::Sparse& s = *a.sparse;
  with_component(s.index, [&]<class I>(I) {
    with_component(a.component, [&]<class C>(C) {
      for (std::size_t i = 0; i < s.count; ++i) {
        const auto at = static_cast<std::size_t>(load<I>(s.indices + i * sizeof(I)));
        if (at >= a.count) fail(file, a.path, "a sparse index names none of its elements");
        for (std::size_t k = 0; k < n; ++k)
          out[at * n + k] = component_value<To>(load<C>(s.values + (i * n + k) * sizeof(C)), a.normalized);
      }
    });
  });
}

// All elements, packed, in parallel; then finish(begin, end) for blocks of them, while they are in the cache.
template <class To, int n, class Finish>
void read_rows(const Accessor& a, const FilePath& file, To* out, const Finish& finish) {
  const auto blocks = [&](const auto& body) {
    kernels::parallel_blocks(a.count, kernels::usual_block, body);
  };
  if (!a.sparse)
    return blocks([&](std::size_t begin, std::size_t end) {
      read_block<To, n>(a, begin, end, out);
      finish(begin, end);
    });
  blocks([&](std::size_t begin, std::size_t end) { read_block<To, n>(a, begin, end, out); });
  read_sparse<To, n>(a, file, out);
  blocks(finish);
}

}  // namespace frustum::gltf
