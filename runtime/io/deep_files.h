// Deep pictures: EXR files with lists of fragments instead of pixels.
#pragma once

#include "runtime/buffers/fragments.h"
#include "runtime/core/context.h"
#include "runtime/core/sink.h"

#include <string>
#include <string_view>

namespace frustum {

// Reads one part of a deep EXR file, by scanlines or by tiles (level 0), whole. Channels are f32 (half is widened) and
// u32, "N.X" is "N.x"; fragments are in the order of the file.
//   ctx  told of bytes before they are taken, and polled
// What the file says of the number of fragments is not believed beyond what its bytes can hold: deflate, the tightest
// of the compressions, makes at most 1032 bytes of one. Throws WorldError("cannot_read_file"), NodeError(
// "malformed_file") for what is no EXR, is truncated or lies, NodeError("not_deep") for ordinary pictures.
Fragments read_deep_file(const std::string& path, std::string_view name, int part, Context& ctx);

// Writes one list a pixel as deep EXR scanlines: f32 and f64 as float, u32 as uint, "N.x" as "N.X"; compression "zips".
// f64 is rounded to the nearest float. Throws NodeError("format_cannot_hold") for lists of several samples a pixel,
// WorldError("cannot_write_file"); polls and claims as reading does.
void write_deep_file(const Fragments& fragments, const SaveRequest& request, Context& ctx);

}  // namespace frustum
