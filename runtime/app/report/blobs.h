// Numbers inside a page: byte planes, deflated, in base64. runtime/app/report/codec.js is the other half.
#pragma once

#include "runtime/core/diagnostic.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace frustum::report {

// The arrays of one page, each a <script> element that is data and is decoded when it is first shown.
class Blobs {
 public:
  // Adds the numbers; gives {"blob": index, "kind": "f32" | "f64" | "u32", "count": n}. The bytes are written least
  // significant plane first (all first bytes, then all second ones ...), which deflates neighbouring floats well.
  Json add(std::span<const float> values);
  Json add(std::span<const double> values);
  Json add(std::span<const std::uint32_t> values);

  std::string html() const;  // the elements, in order

 private:
  template <class T>
  Json add_bytes(std::span<const T> values, const char* kind);
  std::vector<std::string> base64_;
};

}  // namespace frustum::report
