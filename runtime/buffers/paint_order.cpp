#include "runtime/buffers/paint_order.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

using kernels::Cut;

std::string text_of(const Cut& c) {
  switch (c.kind) {
    case Cut::Kind::plane: return fmt::format("{} the plane of face {}", c.low ? "before" : "behind", c.of);
    case Cut::Kind::side:
      return fmt::format("{} side {} of face {}", c.low ? "within" : "without", c.of % 4, c.of / 4);
    case Cut::Kind::column: return fmt::format("{} of x = {} px", c.low ? "left" : "right", c.of);
    case Cut::Kind::row: return fmt::format("{} y = {} px", c.low ? "above" : "below", c.of);
  }
  return {};
}

struct PaintOrderOps {
  static std::size_t bytes(const PaintOrder& o) {
    return sizeof o + o.pieces.size() * sizeof o.pieces[0] + o.cuts.size() * sizeof o.cuts[0];
  }
  static void hash(const PaintOrder& o, Hasher& h) {
    h.value(o.front_to_back).value(o.faces).value(std::uint64_t{o.pieces.size()});
    for (const auto& p : o.pieces) h.value(p.face).value(p.cuts);
    for (const Cut& c : o.cuts) h.value(c.kind).value(c.low).value(c.of);
  }
  static Health health(const PaintOrder&) { return {}; }
  static Json summary(const PaintOrder& o) {
    return {{"pieces", o.pieces.size()},
            {"faces", o.faces},
            {"cuts", o.cuts.size()},
            {"painted", o.front_to_back ? "front to back" : "back to front"}};
  }
  static Json table(const PaintOrder& o, std::size_t first, std::size_t count) {
    return json_table({"face", "cuts"}, o.pieces.size(), first, count, [&](std::size_t i) {
      const auto& p = o.pieces[i];
      std::string cuts;
      for (std::uint32_t k = 0; k < p.cuts; ++k)
        cuts += (k == 0 ? "" : ", ") + text_of(o.cuts[p.first_cut + k]);
      return Json::array({p.face, cuts});
    });
  }
};

}  // namespace

template <>
const BufferType& buffer_type<PaintOrder>() {
  static const BufferType type = make_buffer_type<PaintOrder, PaintOrderOps>(
      "paint_order", "Faces, or pieces of them, in the order in which they are painted.", "#8f86a3");
  return type;
}

}  // namespace frustum
