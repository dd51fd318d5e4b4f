// A buffer as a file: pixels through the same sinks as a run's outputs, tables as CSV.
#pragma once

#include "runtime/core/buffer.h"
#include "runtime/core/context.h"
#include "runtime/core/sink.h"

#include <optional>
#include <string>
#include <vector>

namespace frustum {

// One sample of every pixel, as a raster without a pattern. A raster with one value a pixel is returned as
// it is.
Raster one_sample(const Raster& raster, int sample);

// Writes all planes as one layer; the raster has one value a pixel. Warns of linear colours in a format that
// shows its numbers as they are. Throws WorldError where the file cannot be made, NodeError where the format
// cannot hold the planes, Cancelled where `ctx` is cancelled, and leaves no file then.
void save_raster(const Raster& raster, const std::string& path, const FileWarning& warn = {},
                 const Context& ctx = {});

// The pixels of an image file. Throws WorldError where it cannot be read.
Raster load_raster(const std::string& path);

// What a file holds: a mesh where its extension is that of a mesh format, else the pixels of an image. Throws
// WorldError where it cannot be read, NodeError where it is malformed.
Buffer load_buffer(const std::string& path);

// The table of a .csv file (RFC 4180), {"columns", "rows"}: cells that read as numbers are numbers, "nan" and
// the like and the rest are texts. Throws NodeError("malformed_file") for a row of another length or an open
// quote.
Json csv_table(const std::string& path);

// The extensions of the files that save_buffer() makes of a kind of buffer; `whole`: of those alone that hold all of it,
// every sample of its pixels too.
std::vector<std::string> forms_of(const BufferType& kind, bool whole);

// For saving the buffer: polls `cancel` (may be null), and refuses what together with the buffer is more than `memory`
// bytes (0: no limit).
Context saving_context(const Buffer& buffer, const CancelFlag* cancel, std::uint64_t memory);

// Pixels (the given sample of each; the first, with a warning where there are more and they have colours, if
// none is given) to an image file, and any buffer to a file of its kind: a mesh to .ply, .obj, .glb or .gltf,
// what has a table form to .csv, everything to .json. Throws NodeError("unknown_format") where it is none of
// these, NodeError("memory") and Cancelled as save_buffer_file does.
void save_buffer(const Buffer& buffer, const std::string& path, Context& ctx, std::optional<int> sample = {},
                 const FileWarning& warn = {});

}  // namespace frustum
