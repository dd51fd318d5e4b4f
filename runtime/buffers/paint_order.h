// In which order faces, or pieces of them, are to be painted.
#pragma once

#include "nodes/kernels/paint_pieces.h"
#include "runtime/core/buffer.h"

#include <cstdint>
#include <vector>

namespace frustum {

// Of the faces of a mesh in screen space, found by an algorithm that puts them in order; visibility.paint
// paints it. Every sample of a face lies in at most one of its pieces.
struct PaintOrder {
  std::vector<kernels::OrderedPiece> pieces;  // first to last
  std::vector<kernels::Cut> cuts;             // of all pieces
  bool front_to_back = false;                 // what is painted first stays, instead of what is painted last
  std::uint32_t faces = 0;                    // of the mesh it is for

  kernels::PaintScene scene() const { return {pieces, cuts, front_to_back}; }
  void add(const kernels::Piece& piece) {
    pieces.push_back(
        {piece.face, static_cast<std::uint32_t>(cuts.size()), static_cast<std::uint32_t>(piece.cuts.size())});
    cuts.insert(cuts.end(), piece.cuts.begin(), piece.cuts.end());
  }
};

template <>
const BufferType& buffer_type<PaintOrder>();

}  // namespace frustum
