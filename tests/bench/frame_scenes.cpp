#include "tests/bench/frame_scenes.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace frustum::bench {
namespace {

struct Vertices {
  std::vector<glm::vec3> position, normal;
  std::vector<glm::vec2> uv;
  std::vector<glm::uvec3> face;

  std::uint32_t add(glm::vec3 p, glm::vec3 n, glm::vec2 t) {
    position.push_back(p), normal.push_back(n), uv.push_back(t);
    return static_cast<std::uint32_t>(position.size() - 1);
  }
  Ref<Mesh> mesh() const {
    Mesh mesh;
    mesh.columns = {
        Column::make("triangle", Domain::face, std::span<const glm::uvec3>(face)),
        Column::make("position", Domain::vertex, std::span<const glm::vec3>(position), Space::world),
        Column::make("normal", Domain::vertex, std::span<const glm::vec3>(normal), Space::world),
        Column::make("uv", Domain::vertex, std::span<const glm::vec2>(uv))};
    return std::make_shared<const Mesh>(std::move(mesh));
  }
};

constexpr glm::dvec3 screen_eye{0, 0, 3};

// The point at (x, y) of the view, each in [-1, 1], `distance` in front of an eye at screen_eye that looks along -z.
glm::vec3 unproject(double x, double y, double distance) {
  const double high = std::tan(fov_y_deg * std::numbers::pi / 360) * distance;
  return glm::dvec3(x * high * width / height, y * high, screen_eye.z - distance);
}

}  // namespace

FrameScene torus(int columns, int rows) {
  Vertices v;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double a = 2 * std::numbers::pi * i / columns, b = 2 * std::numbers::pi * j / rows;
      const glm::dvec3 out(std::cos(b) * std::cos(a), std::sin(b), -std::cos(b) * std::sin(a));
      v.add(0.7 * glm::dvec3(std::cos(a), 0, -std::sin(a)) + 0.3 * out, out,
            {static_cast<float>(i) / static_cast<float>(columns),
             static_cast<float>(j) / static_cast<float>(rows)});
    }
  const auto edge = static_cast<std::uint32_t>(columns);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j)
    for (std::uint32_t i = 0; i < edge; ++i) {
      const std::uint32_t p = j * (edge + 1) + i, q = p + edge + 1;
      v.face.insert(v.face.end(), {{p, p + 1, q + 1}, {p, q + 1, q}});
    }
  return {v.mesh(), {0, 1.2, 2.2}, true};
}

FrameScene soup() {
  constexpr int count = 100'000, depth_complexity = 8;
  // The view is 4 large, a triangle in a circle of radius r 3 sqrt(3) / 4 r^2.
  const double radius = std::sqrt(4.0 * depth_complexity / count / (3 * std::numbers::sqrt3 / 4));
  std::mt19937 bits(7);
  // Not std::uniform_real_distribution: its numbers differ between libraries.
  const auto uniform = [&](double from, double to) {
    return from + (to - from) * 0x1p-32 * static_cast<double>(bits());
  };
  Vertices v;
  for (int t = 0; t < count; ++t) {
    const double x = uniform(-1, 1), y = uniform(-1, 1), depth = uniform(2, 4);
    const double turn = uniform(0, 2 * std::numbers::pi);
    glm::uvec3 face{};
    for (int k = 0; k < 3; ++k) {
      const double angle = turn + 2 * std::numbers::pi * k / 3, c = std::cos(angle), s = std::sin(angle);
      const glm::vec3 p = unproject(x + radius * c, y + radius * s, depth + uniform(-0.1, 0.1));
      face[k] = v.add(p, {0, 0, 1}, glm::dvec2(0.5 + 0.5 * c, 0.5 + 0.5 * s));
    }
    v.face.push_back(face);
  }
  return {v.mesh(), screen_eye, false};
}

FrameScene layers() {
  constexpr int count = 8;
  Vertices v;
  for (int layer = 0; layer < count; ++layer) {
    const double depth = 4 - 2.0 * layer / (count - 1);
    std::uint32_t q[4];
    for (int k = 0; k < 4; ++k) {
      const double x = k == 1 || k == 2 ? 1 : -1, y = k > 1 ? 1 : -1;
      q[k] = v.add(unproject(x, y, depth), {0, 0, 1}, glm::dvec2(8 * (x + 1), 4.5 * (y + 1)));
    }
    v.face.insert(v.face.end(), {{q[0], q[1], q[2]}, {q[0], q[2], q[3]}});
  }
  return {v.mesh(), screen_eye, false};
}

}  // namespace frustum::bench
