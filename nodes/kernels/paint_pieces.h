// Pieces of faces in an order, as they are handed from who finds it to who paints it.
#pragma once

#include <cstdint>
#include <span>

#include "nodes/kernels/face_piece.h"

namespace frustum::kernels {

// A piece in an order: its face, and its cuts [first_cut, first_cut + cuts) of the order's list.
struct OrderedPiece {
  std::uint32_t face, first_cut, cuts;
  bool operator==(const OrderedPiece&) const = default;
};

// What is painted, nothing owned. Front to back, what is painted first stays; else what is painted last.
struct PaintScene {
  std::span<const OrderedPiece> pieces;
  std::span<const Cut> cuts;
  bool front_to_back = false;
};

}  // namespace frustum::kernels
