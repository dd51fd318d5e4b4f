// Small values that flow like any buffer, and may stand in a graph as literals: {"value": 3}.
#pragma once

#include "runtime/core/buffer.h"

#include <glm/mat4x4.hpp>

#include <string>
#include <vector>

namespace frustum {

struct Number {
  double value = 0;
};

// Acts on column vectors; written row by row.
struct Matrix {
  glm::dmat4 value{1};
};

// Named columns of equal length; what nodes that explain themselves give out.
struct Table {
  struct Column {
    std::string name;
    std::string unit = {};
    std::vector<double> numbers = {};
    std::vector<std::string> texts = {};  // either numbers or texts
  };
  std::vector<Column> columns;
  std::size_t rows() const;
};

template <>
const BufferType& buffer_type<Number>();
template <>
const BufferType& buffer_type<Matrix>();
template <>
const BufferType& buffer_type<Table>();

}  // namespace frustum
