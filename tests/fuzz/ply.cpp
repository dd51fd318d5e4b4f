// PLY files, text and binary.
#include "runtime/io/ply.h"

#include "tests/fuzz/support/check.h"
#include "tests/fuzz/support/target.h"

namespace frustum::fuzz {
namespace {

void read(std::string_view input) { read_mesh(read_ply, input, {"input.ply", "input.ply"}); }
const Registered ply({"ply", read, {1 << 20, 1024}});

}  // namespace
}  // namespace frustum::fuzz
