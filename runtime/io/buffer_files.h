// Whole buffers as files: meshes, tables, numbers and whatever else flows between nodes.
#pragma once

#include "runtime/core/buffer.h"
#include "runtime/core/context.h"
#include "runtime/core/sink.h"

#include <string>
#include <vector>

namespace frustum {

// Extensions of the files that a whole buffer of a kind can be saved as, without dots.
std::vector<std::string> saved_as(const BufferType& kind);

// Cells of JSON as one line of a CSV file (RFC 4180) with its end; numbers in the shortest text that reads back
// to the same value, null as an empty cell.
std::string csv_row(const Json& cells);

// Writes the buffer in the format of the path's extension, under a temporary name that is renamed when the
// file is whole.
//
//   .ply .obj .glb .gltf   a mesh (mesh_writers.h)
//   .exr                   fragments, one list a pixel: deep scanlines (deep_files.h)
//   .csv                   the table form: RFC 4180 with a line of column names; numbers in the shortest text
//                          that reads back to the same value
//   .json                  {"format": "frustum.buffer/1", "type", "graph", "summary", "columns", "rows",
//                          "total"}: the last three where there is a table form
//
// Rows are written in blocks: memory does not grow with the table. What meshes need beside is claimed of `ctx`, which
// is polled every few milliseconds (not while a deep file is written). Throws NodeError("unknown_format",
// "format_cannot_hold", "memory"), WorldError("cannot_write_file"), Cancelled; no file is left then.
void save_buffer_file(const Buffer& buffer, const SaveRequest& request, Context& ctx);

}  // namespace frustum
