// Painting pieces of faces in an order that somebody has found: the last one painted, or the first, is seen.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "nodes/kernels/fill_triangles.h"
#include "nodes/kernels/paint_pieces.h"

namespace frustum {

// Paints `order` over faces of `mesh`. Keeps the spans it is given; their owner outlives it. Painting is const:
// many threads may paint at once.
template <std::floating_point R>
class PiecePainter {
 public:
  //   order  of pieces whose faces are < mesh.face.size(); only the first `count` are painted
  //   claim  called with bytes of memory before they are taken; may throw
  PiecePainter(const kernels::ScreenMesh<R>& mesh, const kernels::SamplePositions& pattern,
               kernels::PixelRect window, kernels::DepthOrder depths, const kernels::PaintScene& order,
               std::size_t count, const std::function<void(std::uint64_t)>& claim)
      : scene_{mesh, pattern, nullptr, depths}, order_(order) {
    if (claim)
      claim(mesh.face.size() * (sizeof(kernels::ScreenFace) + sizeof(std::uint32_t)) +
            count * sizeof(std::uint32_t));
    bins_ = kernels::bin_triangles(mesh, pattern, window, claim);
    faces_ = kernels::screen_faces(mesh, scene_.sign());
    find_pieces(std::min(count, order.pieces.size()));
  }

  const kernels::TriangleBins& bins() const { return bins_; }

  // Fills `id` and `z` (the depth that fill_triangles gives this face) at every sample of `rect`, or no_face
  // and the far depth. A pure function of (x, y, sample). Cost: that of fill_triangles, and sorting the pieces
  // of each bin.
  void fill(kernels::PixelRect rect, kernels::PlaneView<std::uint32_t> id, kernels::PlaneView<R> z) const;

 private:
  // The pieces of each face, ascending.
  void find_pieces(std::size_t count) {
    first_.assign(scene_.mesh.face.size() + 1, 0);
    for (std::size_t i = 0; i < count; ++i) ++first_[order_.pieces[i].face + 1];
    for (std::size_t f = 1; f < first_.size(); ++f) first_[f] += first_[f - 1];
    rank_.resize(count);
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < count; ++i)
      rank_[next[order_.pieces[i].face]++] = static_cast<std::uint32_t>(i);
  }

  void paint(const kernels::OrderedPiece& piece, kernels::PixelRect box, kernels::PixelRect rect,
             kernels::PlaneView<std::uint32_t> id, kernels::PlaneView<R> z) const;
  void paint_sample(const kernels::ScreenTriangle<R>& t, const kernels::OrderedPiece& piece, int sample,
                    kernels::PixelRect box, kernels::PixelRect rect, kernels::PlaneView<std::uint32_t> id,
                    kernels::PlaneView<R> z) const;

  bool holds(const kernels::OrderedPiece& piece, const glm::dvec2& p) const {
    const auto cuts = order_.cuts.subspan(piece.first_cut, piece.cuts);
    return std::all_of(cuts.begin(), cuts.end(), [&](const kernels::Cut& c) {
      return kernels::on_side(c, faces_[piece.face].depth, faces_, p);
    });
  }

  // Whether `face` at `depth` is to be seen where `there` at `depth_there` was painted before it.
  bool covers(std::uint32_t face, R depth, std::uint32_t there, R depth_there) const {
    if (there == kernels::no_face) return true;
    const double apart = std::fabs(static_cast<double>(depth) - static_cast<double>(depth_there));
    if (apart > faces_[face].depth.band + faces_[there].depth.band) return !order_.front_to_back;
    if (depth != depth_there) return depth < depth_there;
    const auto source = [&](std::uint32_t f) {
      return std::pair(scene_.mesh.origin.empty() ? f : scene_.mesh.origin[f], f);
    };
    return source(face) < source(there);
  }

  kernels::FillScene<R> scene_;
  kernels::PaintScene order_;
  kernels::TriangleBins bins_;
  std::vector<kernels::ScreenFace> faces_;
  std::vector<std::uint32_t> first_;  // per face its first entry in rank_, and the end
  std::vector<std::uint32_t> rank_;   // indices of pieces
};

template <std::floating_point R>
void PiecePainter<R>::paint_sample(const kernels::ScreenTriangle<R>& t, const kernels::OrderedPiece& piece,
                                   int sample, kernels::PixelRect box, kernels::PixelRect rect,
                                   kernels::PlaneView<std::uint32_t> id, kernels::PlaneView<R> z) const {
  const kernels::SamplePositions& pattern = scene_.pattern;
  for (int y = box.y0; y < box.y1; ++y) {
    std::uint32_t* id_row = id.row(sample, y - rect.y0) - rect.x0;
    R* z_row = z.row(sample, y - rect.y0) - rect.x0;
    for (int x = box.x0; x < box.x1; ++x) {
      const std::size_t i = pattern.index(sample, x, y);
      const std::int32_t ox = pattern.x[i], oy = pattern.y[i];
      const auto inside = [&](const kernels::Edge& e) {
        return kernels::Edge::covers(e.at_pixel(x, y), e.at_offset(ox, oy));
      };
      if (!inside(t.edge[0]) || !inside(t.edge[1]) || !inside(t.edge[2])) continue;
      if (piece.cuts > 0 &&
          !holds(piece, {x + ox * (1.0 / kernels::sample_unit), y + oy * (1.0 / kernels::sample_unit)}))
        continue;
      const R depth = t.depth.at(x, y, ox, oy);
      if (!covers(piece.face, depth, id_row[x], z_row[x])) continue;
      z_row[x] = depth;
      id_row[x] = piece.face;
    }
  }
}

template <std::floating_point R>
void PiecePainter<R>::paint(const kernels::OrderedPiece& piece, kernels::PixelRect box,
                            kernels::PixelRect rect, kernels::PlaneView<std::uint32_t> id,
                            kernels::PlaneView<R> z) const {
  const auto t = kernels::screen_triangle(scene_.mesh, piece.face, scene_.sign());
  if (!t) return;
  for (int s = 0; s < scene_.pattern.samples; ++s) paint_sample(*t, piece, s, box, rect, id, z);
}

template <std::floating_point R>
void PiecePainter<R>::fill(kernels::PixelRect rect, kernels::PlaneView<std::uint32_t> id,
                           kernels::PlaneView<R> z) const {
  const int width = rect.x1 - rect.x0, height = rect.y1 - rect.y0;
  for (int s = 0; s < scene_.pattern.samples; ++s)
    for (int y = 0; y < height; ++y) {
      std::fill_n(id.row(s, y), width, kernels::no_face);
      std::fill_n(z.row(s, y), width, scene_.sign() * scene_.far());
    }
  std::vector<std::pair<std::uint32_t, const kernels::BinEntry*>> here;  // rank, and where its face lies
  kernels::each_bin_of(
      bins_, rect,
      [&](kernels::PixelRect part, glm::ivec2 corner, std::span<const kernels::BinEntry> entries) {
        here.clear();
        for (const kernels::BinEntry& e : entries)
          for (std::uint32_t k = first_[e.face]; k < first_[e.face + 1]; ++k)
            if (!kernels::box_in(part, corner, e).empty()) here.emplace_back(rank_[k], &e);
        std::sort(here.begin(), here.end());
        for (const auto& [rank, entry] : here)
          paint(order_.pieces[rank], kernels::box_in(part, corner, *entry), rect, id, z);
      });
  if (scene_.sign() > 0) return;
  for (int s = 0; s < scene_.pattern.samples; ++s)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) z.row(s, y)[x] *= scene_.sign();
}

}  // namespace frustum
