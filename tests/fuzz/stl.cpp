// STL files, text and binary.
#include "runtime/io/stl.h"

#include "tests/fuzz/support/check.h"
#include "tests/fuzz/support/target.h"

namespace frustum::fuzz {
namespace {

void read(std::string_view input) { read_mesh(read_stl, input, {"input.stl", "input.stl"}); }
const Registered stl({"stl", read, {1 << 20, 1024}});

}  // namespace
}  // namespace frustum::fuzz
