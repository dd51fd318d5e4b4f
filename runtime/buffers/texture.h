// A colour for every (u, v): a checkerboard by formula, or a pyramid of images.
#pragma once

#include "runtime/buffers/image.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

namespace frustum {

// border: transparent black beyond the picture.
enum class Wrap : std::uint8_t { repeat, clamp, mirror, border };
constexpr auto choices(Wrap) {
  return std::array{std::pair{Wrap::repeat, "repeat"}, std::pair{Wrap::clamp, "clamp"},
                    std::pair{Wrap::mirror, "mirror"}, std::pair{Wrap::border, "border"}};
}

// Squares of side 1/scale in u and v; `even` where floor(scale u) + floor(scale v) is even.
struct Checker {
  double scale = 8;
  glm::dvec3 even{1}, odd{0};
};

// Level 0 is the image; each further level halves both sides (rounding down, at least 1) by exact area
// averages. Texel rows are RGBA, linear light, premultiplied; row 0 is v = 1 (the top of the picture).
struct MipPyramid {
  // Numbers are f32, or binary16 (nodes/kernels/half.h): of all levels of a pyramid alike.
  struct Level {
    int width = 0, height = 0;
    std::vector<float> rgba;                    // height x width x 4
    std::vector<std::uint16_t> half_rgba = {};  // instead of rgba

    std::size_t size() const { return rgba.size() + half_rgba.size(); }  // of numbers
    float number(std::size_t i) const;
    std::vector<float> numbers(std::size_t first, std::size_t count) const;
    std::size_t bytes() const {
      return rgba.size() * sizeof(float) + half_rgba.size() * sizeof(std::uint16_t);
    }
  };
  std::vector<Level> levels;
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  // Above 0: where the opacity that is looked up, times that of the vertices, is below it nothing is there, and
  // elsewhere the surface is opaque. 0: what lies behind shows by that opacity.
  double alpha_cutoff = 0;
};

// Immutable once published. Materials share textures and meshes share materials, so digest and health of the
// texels are found once for each texture, however many buffers it is part of; call them on published textures
// only.
class Texture {
 public:
  Texture(std::variant<Checker, MipPyramid> from);

  std::variant<Checker, MipPyramid> source;

  std::size_t bytes() const;
  Digest digest() const;
  Health health() const;

 private:
  struct Memo;
  std::shared_ptr<Memo> memo_;
};

template <>
const BufferType& buffer_type<Texture>();

}  // namespace frustum
