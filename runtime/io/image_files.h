// Picture files. The library behind this (OpenImageIO) is a module that is opened at the first use.
#pragma once

#include "runtime/core/raster.h"
#include "runtime/core/sink.h"

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum {

// Opens the library now, which costs some 200 ms, and tells whether it is open. Throws
// WorldError("no_image_module").
void open_image_module();
bool image_module_is_open();

// A picture as its file says it: planes in the file's order, colours not converted.
struct ImageFile {
  // Planes: f32, u32 for 32-bit unsigned channels. "R" "G" "B" "A" are colour, a grey picture has R = G =
  // B; other names are the file's, with components in lower case ("N.X" is "N.x"). The window is the file's
  // data window, upright as its metadata says. color_space: what the file says, else srgb for 8 and 16-bit
  // numbers, lin_rec709 for real ones; empty without R, G, B. alpha: premultiplied where there is an A;
  // files that store it straight are multiplied, in their own colour space.
  Raster raster;
  Rect display_window;
  std::string format;  // "png"
  std::vector<std::pair<std::string, std::string>> metadata = {};
};

// Reads one subimage of a file, whole. `name` is what messages call the file.
// Throws WorldError("cannot_read_file"), WorldError("out_of_memory"), NodeError("malformed_file") for a
// file that is no picture, is truncated or lies about its size.
ImageFile read_image(const std::string& path, std::string_view name, int subimage = 0);

// The same of a picture file in memory, told by its content (PNG, JPEG, WebP, OpenEXR, HDR, TIFF, BMP), but for
// its alpha, which says here what the file says: colours stored straight stay so (Alpha::straight).
ImageFile read_image_bytes(std::string_view bytes, std::string_view name);

// Extensions of the files that open_image_sink writes, without dots.
std::vector<std::string> writable_extensions();

// A picture file that takes bands from top to bottom, in memory of the order of a band. It is written under
// a temporary name in its folder (made where it is missing) and renamed by finish(); without that it is
// removed. The bytes depend on the pixels and the request alone: no date is written.
//
//   format     layers and planes                       bits (the first is the usual one)
//   exr        any; layer and plane become "N.X"        0: half for colours, float for other reals;
//                                                       16: half, 32: float; u32 stays
//   png        1 of 1 plane, R G B or R G B A           8, 16; alpha is stored straight
//   tif, tiff  1 of 1 plane, R G B or R G B A           16, 8, 32 (float)
//   jpg, jpeg  1 of 1 plane or R G B; A is left out     8; compression "quality:1" to "quality:100" (98)
//   hdr        1 of R G B; A is left out                32 (shared exponent)
//
// Integers are round(v 2^bits - v) of v cut to [0, 1], NaN gives 0; half keeps what is finite finite
// (+-65504). exr keeps region and display window; other formats hold the region alone. All but TIFF and HDR
// keep the name of the colour space. Throws NodeError("unknown_format", "format_cannot_hold", "bad_bits",
// "unknown_compression"), WorldError("cannot_write_file"); write() and finish() throw the latter, as when a
// disk is full.
std::unique_ptr<Sink> open_image_sink(const SinkRequest&);

}  // namespace frustum
