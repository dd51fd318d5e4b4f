// Materials of OBJ files.
#pragma once

#include "runtime/core/context.h"
#include "runtime/core/param.h"
#include "runtime/io/file_materials.h"

#include <functional>
#include <span>
#include <string_view>

namespace frustum {

// The materials of `names` out of the MTL files that an OBJ file names, in that order; those that no file has
// keep their name and the default values.
//
//   libraries   what follows mtllib, a line each: one file name with blanks in it, else several
//   obj         the file that names them: what relative paths start from
//   textured    whether the mesh has texture coordinates: without them no texture is read
//
// MTL           here
// Kd            diffuse, linear Rec.709 (the format says nothing of a space)
// Ka            ambient, which here scales the diffuse colour: Ka / Kd; 1 where that is no number (Kd is 0) and
//               where there is no Ka
// Ks, Ns, Ke    specular, shininess, emission
// illum         1: no specular; 2, and none: Blinn; others are reported
// map_Kd        texture in its file's own space, its alpha left out; -s and -o scale and move it, -clamp on
//               ends it at its borders, -mm and the rest are reported
// d, Tr        opacity d, or 1 - Tr where there is no d (programs do not agree on Tr); outside [0, 1] reported
// map_* and whatever else has no counterpart is counted (warning "statements_skipped"). Colours below 0 and Ns
// outside [0, 1e6] are held there ("values_held"); Kd and Ks that send back more light than falls in are kept
// ("makes_energy").
//
// A file that is missing, absolute or climbs out of the folder of the OBJ is not read and said so: warnings
// "missing_material_file", "missing_texture_file", "unsafe_path"; "missing_material" for names. A file named
// twice is read once. Throws NodeError("malformed_file") with file:line for what is no number or no MTL at
// all.
FileMaterials read_materials(std::span<const std::string_view> libraries, const FilePath& obj,
                             std::span<const std::string_view> names, bool textured, Context& ctx);

// Calls `visit` for every file that read_materials could read for the OBJ text: for keys of caches.
void visit_obj_files(std::string_view text, const FilePath& obj,
                     const std::function<void(const FilePath&)>& visit);

}  // namespace frustum
