#include "runtime/core/raster.h"

#include "runtime/core/error.h"
#include "runtime/core/pages.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <vector>

namespace frustum {
namespace {

std::size_t storage_bytes(const Frame& f) {
  // 2^31 x 2^31 pixels of 16 samples do not fit 64 bits: what wraps around would be a small raster.
  std::size_t values = static_cast<std::size_t>(padded_row(f.window.width())), sum = 0;
  bool fits = !__builtin_mul_overflow(values, static_cast<std::size_t>(f.window.height()), &values) &&
              !__builtin_mul_overflow(values, static_cast<std::size_t>(f.samples()), &values);
  for (const Plane& p : f.planes) {
    std::size_t bytes = 0;
    fits = fits && !__builtin_mul_overflow(values, bytes_of(p.kind), &bytes) &&
           !__builtin_add_overflow(sum, bytes, &sum);
  }
  if (!fits) throw WorldError("out_of_memory", "a raster of more than 2^64 bytes");
  return sum;
}

Pages pages_for(const Frame& f, Contents contents) {
  const std::size_t size = storage_bytes(f);
  try {
    return Pages(size, contents);
  } catch (const std::bad_alloc&) {
    throw WorldError("out_of_memory", "no memory for a raster of " + std::to_string(size) + " bytes");
  }
}

// Sets all bytes of a rectangle of every plane that a tile stores.
void blank(const Tile& tile, const Rect& r) {
  if (r.empty()) return;
  const Tile part = tile.part(r);
  const auto& planes = part.frame().planes;
  const auto width = static_cast<std::size_t>(r.width());
  for (int p = 0; p < static_cast<int>(planes.size()); ++p) {
    if (!part.has(p)) continue;
    for (int s = 0; s < part.samples(); ++s)
      for (int y = r.y0; y < r.y1; ++y) switch (planes[static_cast<std::size_t>(p)].kind) {
          case PlaneKind::f32: std::fill_n(part.row<float>(p, s, y), width, 0.0F); break;
          case PlaneKind::f64: std::fill_n(part.row<double>(p, s, y), width, 0.0); break;
          case PlaneKind::u32: std::fill_n(part.row<std::uint32_t>(p, s, y), width, ~0U); break;
        }
  }
}

}  // namespace

void blank_around(const Tile& tile, const Rect& inner) {
  const Rect& all = tile.rect();
  if (inner.empty()) return blank(tile, all);
  blank(tile, {all.x0, all.y0, all.x1, inner.y0});
  blank(tile, {all.x0, inner.y0, inner.x0, inner.y1});
  blank(tile, {inner.x1, inner.y0, all.x1, inner.y1});
  blank(tile, {all.x0, inner.y1, all.x1, all.y1});
}

struct Raster::Storage {
  Frame frame;
  Pages pages;
  std::vector<std::byte*> planes;

  Storage(Frame f, Contents contents) : frame(std::move(f)), pages(pages_for(frame, contents)) {
    const auto values = static_cast<std::size_t>(padded_row(frame.window.width())) *
                        static_cast<std::size_t>(frame.window.height()) *
                        static_cast<std::size_t>(frame.samples());
    std::byte* next = pages.data();
    for (const Plane& p : frame.planes) {
      planes.push_back(next);
      if (next != nullptr) next += values * bytes_of(p.kind);
    }
  }
};

Raster::Raster(Frame frame, Contents contents)
    : storage_(std::make_shared<const Storage>(std::move(frame), contents)) {}

const Frame& Raster::frame() const { return storage_->frame; }
std::size_t Raster::bytes() const { return storage_->pages.size(); }

Tile Raster::view() const {
  const Frame& f = storage_->frame;
  const std::ptrdiff_t row = padded_row(f.window.width());
  return {&f, f.window, f.window, row, row * f.window.height(), storage_->planes};
}

double Raster::value(int plane, int sample, int x, int y) const {
  switch (frame().planes[static_cast<std::size_t>(plane)].kind) {
    case PlaneKind::f32: return at<float>(plane, sample, x, y);
    case PlaneKind::f64: return at<double>(plane, sample, x, y);
    case PlaneKind::u32: return at<std::uint32_t>(plane, sample, x, y);
  }
  return 0;
}

void copy(const Tile& from, const Tile& to) {
  const Rect r = intersection(from.rect(), to.rect());
  if (r.empty()) return;
  const Tile a = from.part(r), b = to.part(r);
  const auto& planes = a.frame().planes;
  for (int p = 0; p < static_cast<int>(planes.size()); ++p) {
    if (!a.has(p) || !b.has(p)) continue;
    const PlaneKind kind = planes[static_cast<std::size_t>(p)].kind;
    const std::size_t row_bytes = static_cast<std::size_t>(r.width()) * bytes_of(kind);
    for (int s = 0; s < a.samples(); ++s)
      for (int y = r.y0; y < r.y1; ++y) switch (kind) {
          case PlaneKind::f32: std::memcpy(b.row<float>(p, s, y), a.row<float>(p, s, y), row_bytes); break;
          case PlaneKind::f64: std::memcpy(b.row<double>(p, s, y), a.row<double>(p, s, y), row_bytes); break;
          case PlaneKind::u32:
            std::memcpy(b.row<std::uint32_t>(p, s, y), a.row<std::uint32_t>(p, s, y), row_bytes);
            break;
        }
  }
}

}  // namespace frustum
