// Points and vectors for the tests of nodes/vector, and an arithmetic in which they can be checked.
#pragma once

#include "nodes/vector.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "tests/support/run_node.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

namespace frustum::test {

__extension__ using Quad = __float128;

inline Ref<Points> points(std::vector<glm::dvec3> p) {
  return std::make_shared<const Points>(Points{std::move(p)});
}
inline Ref<Vectors> vectors(std::vector<glm::dvec3> v) {
  return std::make_shared<const Vectors>(Vectors{std::move(v)});
}
inline double ulp(double x) { return std::nextafter(std::fabs(x), INFINITY) - std::fabs(x); }

inline glm::dvec3 random_row(std::mt19937_64& random, double size = 1) {
  std::uniform_real_distribution<double> in(-size, size);
  const double x = in(random), y = in(random), z = in(random);
  return {x, y, z};
}

}  // namespace frustum::test
