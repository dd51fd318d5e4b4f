#pragma once
// "Output i is the sum over j of w_ij input_j": the one path on which clipping, tessellation, subdivision and
// resampling carry attributes. Topology makes the weights; applying them knows nothing of it.
// Source: OpenSubdiv's stencil tables.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <type_traits>
#include <vector>

#include "nodes/kernels/parallel.h"

namespace frustum::kernels {

// Rows of (source, weight) pairs. In each row the first source is the one the others are measured from; a
// weight of zero still reads its source, so leave such pairs out.
class Stencils {
 public:
  void reserve(std::size_t rows, std::size_t pairs) {
    ends_.reserve(rows);
    sources_.reserve(pairs);
    weights_.reserve(pairs);
  }
  // Adds a pair to the row under way.
  void pair(std::uint32_t source, double weight) {
    sources_.push_back(source);
    weights_.push_back(weight);
  }
  void end_row() { ends_.push_back(static_cast<std::uint32_t>(sources_.size())); }
  // A row that repeats one source.
  void copy_row(std::uint32_t source) {
    pair(source, 1);
    end_row();
  }
  void append(const Stencils& more) {
    const auto offset = static_cast<std::uint32_t>(sources_.size());
    for (const auto end : more.ends_) ends_.push_back(offset + end);
    sources_.insert(sources_.end(), more.sources_.begin(), more.sources_.end());
    weights_.insert(weights_.end(), more.weights_.begin(), more.weights_.end());
  }

  std::size_t rows() const { return ends_.size(); }
  std::span<const std::uint32_t> sources(std::size_t row) const {
    return {sources_.data() + begin(row), length(row)};
  }
  std::span<const double> weights(std::size_t row) const {
    return {weights_.data() + begin(row), length(row)};
  }

 private:
  std::size_t begin(std::size_t row) const { return row == 0 ? 0 : ends_[row - 1]; }
  std::size_t length(std::size_t row) const { return ends_[row] - begin(row); }

  std::vector<std::uint32_t> ends_, sources_;
  std::vector<double> weights_;
};

namespace stencil_detail {
template <class T>
struct Wide {
  using type = double;
};
template <glm::length_t n, class T>
struct Wide<glm::vec<n, T>> {
  using type = glm::vec<n, double>;
};
constexpr std::size_t rows_per_task = 2048;
}  // namespace stencil_detail

// Applies rows whose weights sum to 1: out[i] = x_0 + sum w_j (x_j - x_0), in double, rounded once. Equal
// inputs come back bit for bit, however far from the origin; an empty row gives zero. T is float, double or a
// glm vector of them. Requires out.size() = rows, sources < in.size(); `out` must not overlap `in`. Rows are
// independent: any number of threads writes the same bytes.
template <class T>
void apply_affine(const Stencils& stencils, std::span<const T> in, std::span<T> out) {
  using Wide = typename stencil_detail::Wide<T>::type;
  parallel_blocks(out.size(), stencil_detail::rows_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) {
      const auto source = stencils.sources(i);
      const auto weight = stencils.weights(i);
      if (source.empty()) {
        out[i] = T(0);
        continue;
      }
      const Wide base(in[source[0]]);
      Wide sum(0);
      for (std::size_t j = 1; j < source.size(); ++j) sum += (Wide(in[source[j]]) - base) * weight[j];
      out[i] = T(base + sum);
    }
  });
}

// Applies rows of any weights, such as those of derivatives: out[i] = sum w_j x_j, in double, rounded once.
template <class T>
void apply_linear(const Stencils& stencils, std::span<const T> in, std::span<T> out) {
  using Wide = typename stencil_detail::Wide<T>::type;
  parallel_blocks(out.size(), stencil_detail::rows_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) {
      const auto source = stencils.sources(i);
      const auto weight = stencils.weights(i);
      Wide sum(0);
      for (std::size_t j = 0; j < source.size(); ++j) sum += Wide(in[source[j]]) * weight[j];
      out[i] = T(sum);
    }
  });
}

// For columns that cannot be mixed (numbers of things): the source of largest weight, the first of equals. An
// empty row gives zero.
template <class T>
void apply_largest(const Stencils& stencils, std::span<const T> in, std::span<T> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto source = stencils.sources(i);
    const auto weight = stencils.weights(i);
    std::size_t best = 0;
    for (std::size_t j = 1; j < source.size(); ++j)
      if (weight[j] > weight[best]) best = j;
    out[i] = source.empty() ? T(0) : in[source[best]];
  }
}

}  // namespace frustum::kernels
