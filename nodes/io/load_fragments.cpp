#include "nodes/io/load_fragments.h"

#include "nodes/io.h"
#include "runtime/core/node_type.h"
#include "runtime/io/deep_files.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  FilePath file;
  int subimage = 0;
};
struct Outputs {
  Ref<Fragments> fragments;
};

void check(const Params& p) {
  if (p.file.empty()) throw NodeError("no_file", "no file is named", at_param("file"));
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  std::uint64_t unsorted = 0;
  Fragments f = in_order_of_depth(read_deep_file(p.file.resolved, p.file.written, p.subimage, ctx), unsorted);
  ctx.count("fragments", f.count());
  if (unsorted > 0)
    ctx.warn("fragments_sorted",
             fmt::format("{}: the fragments of {} pixels were not in the order of Z, and are now",
                         p.file.written, unsorted));
  if (const std::uint64_t n = overlapping_lists(f); n > 0)
    ctx.warn("fragments_overlap",
             fmt::format("{}: the fragments of {} pixels overlap in depth; each counts whole, at its front",
                         p.file.written, n));
  return {std::make_shared<const Fragments>(std::move(f))};
}

}  // namespace

NodeType nodes::io_load_fragments() {
  return node("io.load_fragments", run)
      .doc("Reads a deep EXR picture, by scanlines or tiles: every pixel's list of fragments.")
      .cite("Kainz 2013, Technical introduction to OpenEXR 2.0 (deep data)")
      .param("file", &Params::file,
             "A deep EXR file; its channels keep their names, colours their file's space.")
      .param("subimage", &Params::subimage, "Which part of a file that holds several pictures, from 0.",
             {.range = at_least(0)})
      .check(check)
      .output("fragments", &Outputs::fragments, "One list a pixel, from the nearest to the farthest Z.");
}

}  // namespace frustum
