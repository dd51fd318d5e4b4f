// What mesh readers and their tests say to each other: bytes in, columns, messages and warnings out.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/param.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::test {

using ReadMesh = Mesh (*)(std::string_view, const FilePath&, Context&);

struct Reading {
  Mesh mesh;
  std::vector<std::string> warnings;  // codes
};

inline Reading read_with(ReadMesh read, std::string_view bytes, const std::string& name,
                         Precision precision = Precision::single) {
  Context ctx;
  ctx.precision = precision;
  Reading out{read(bytes, {name, name}, ctx), {}};
  EXPECT_EQ(out.mesh.validate(), "");
  for (const auto& [code, text] : ctx.warnings()) out.warnings.push_back(code);
  return out;
}

// The message of the NodeError that reading ends with; "" where it does not.
inline std::string problem_with(ReadMesh read, std::string_view bytes, const std::string& name) {
  try {
    Context ctx;
    read(bytes, {name, name}, ctx);
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "malformed_file");
    return e.what();
  }
  return "";
}

template <class T>
std::vector<T> values(const Mesh& m, std::string_view column) {
  const auto v = m.at(column).template values<T>();
  return {v.begin(), v.end()};
}

// The bytes of numbers one after another, as a binary file stores them.
class Bytes {
 public:
  explicit Bytes(bool big_endian = false) : swap_(big_endian != (std::endian::native == std::endian::big)) {}
  template <class T>
  Bytes& add(T v) {
    std::string b(sizeof(T), '\0');
    std::memcpy(b.data(), &v, sizeof(T));
    if (swap_) std::reverse(b.begin(), b.end());
    text += b;
    return *this;
  }
  template <class T, class... More>
  Bytes& add(T v, More... more) {
    add(v);
    return add(more...);
  }
  std::string text;

 private:
  bool swap_;
};

}  // namespace frustum::test
