// The shape of a raster: which pixels, how many samples in each, which planes of numbers. No pixel data here.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

template <class T>
using Ref = std::shared_ptr<const T>;

// Pixels with x0 <= x < x1 and y0 <= y < y1, y down; empty where x0 >= x1 or y0 >= y1.
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool operator==(const Rect&) const = default;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  int width() const { return std::max(0, x1 - x0); }
  int height() const { return std::max(0, y1 - y0); }
  std::int64_t area() const { return std::int64_t{width()} * height(); }
  bool contains(int x, int y) const { return x0 <= x && x < x1 && y0 <= y && y < y1; }
  bool contains(const Rect& r) const {
    return r.empty() || (x0 <= r.x0 && r.x1 <= x1 && y0 <= r.y0 && r.y1 <= y1);
  }
  Rect grown(int margin) const { return {x0 - margin, y0 - margin, x1 + margin, y1 + margin}; }
};

inline Rect intersection(const Rect& a, const Rect& b) {
  const Rect r{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
  return r.empty() ? Rect{} : r;
}

// The smallest rectangle around both; an empty one adds nothing.
inline Rect hull(const Rect& a, const Rect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

// Where the samples of a pixel lie: offsets from its top left corner in units of 2^-12 px, each in [0, 4096).
// The pattern repeats every `period` pixels in x and y; 1 means the same samples in every pixel.
struct SamplePattern {
  int samples = 1;
  int period = 1;
  std::vector<std::uint16_t> x{2048}, y{2048};  // [sample][y mod period][x mod period]

  std::size_t index(int sample, int px, int py) const {
    const int u = px & (period - 1),
              v = py & (period - 1);  // period is a power of two; right for negative px, py too
    return (static_cast<std::size_t>(sample) * static_cast<std::size_t>(period) +
            static_cast<std::size_t>(v)) *
               static_cast<std::size_t>(period) +
           static_cast<std::size_t>(u);
  }
};

enum class PlaneKind : std::uint8_t { f32, f64, u32 };

constexpr std::size_t bytes_of(PlaneKind kind) { return kind == PlaneKind::f64 ? 8 : 4; }

template <class T>
constexpr PlaneKind plane_kind_of = std::is_same_v<T, float>    ? PlaneKind::f32
                                    : std::is_same_v<T, double> ? PlaneKind::f64
                                                                : PlaneKind::u32;

// One plane of numbers. Names follow the field's EXR usage: "R" "G" "B" "A", "Z", "id", "N.x", "uv.u".
struct Plane {
  std::string name;
  PlaneKind kind = PlaneKind::f32;
  bool operator==(const Plane&) const = default;
};

using PlaneList = std::vector<Plane>;

enum class Alpha : std::uint8_t { none, straight, premultiplied };

// What the maker of pixels knows of them before it makes them. A copy of it says nothing: who copies a frame
// fills it with other pixels.
struct OwnFact {
  bool holds = false;

  OwnFact(bool known = false) : holds(known) {}
  OwnFact(const OwnFact&) noexcept {}
  OwnFact(OwnFact&&) noexcept = default;
  OwnFact& operator=(const OwnFact&) noexcept {
    holds = false;
    return *this;
  }
  OwnFact& operator=(OwnFact&&) noexcept = default;
};

struct Frame {
  Rect window = {};                 // absolute pixels; row 0 on top
  Ref<SamplePattern> pattern = {};  // null: one value a pixel
  PlaneList planes = {};
  std::string color_space = {};  // a name of the colour configuration; empty for data that is no colour
  Alpha alpha = Alpha::none;
  OwnFact white = {};  // R, G, B and A are 1 wherever A is not 0: who scales by them need not read them

  int samples() const { return pattern ? pattern->samples : 1; }
  std::optional<int> find(std::string_view plane) const {
    for (std::size_t i = 0; i < planes.size(); ++i)
      if (planes[i].name == plane) return static_cast<int>(i);
    return std::nullopt;
  }
  // Bytes of one pixel with all its samples and planes.
  std::size_t bytes_per_pixel() const {
    std::size_t sum = 0;
    for (const Plane& p : planes) sum += bytes_of(p.kind);
    return sum * static_cast<std::size_t>(samples());
  }
};

}  // namespace frustum
