// Claims about what readers give: meshes that can be worked with, problems that can be shown.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/diagnostic.h"
#include "runtime/core/param.h"

#include <functional>
#include <string>
#include <string_view>

namespace frustum::fuzz {

// Throws Finding unless columns fit each other, indices lie in range, positions and normals are finite, normals have
// unit length, and statistics, digest and table can be made.
void check_mesh(const Mesh&);

// Throws Finding unless a code is snake_case, and a sentence is not empty and no longer than some terminals' pages.
void check_sentence(std::string_view code, std::string_view sentence);

// Problems with a text of `file`: sentences, places inside the text, and both forms in which they are printed.
void check_problems(const Diagnostics&, const std::string& file, std::string_view text);

// Runs a reader. That it ends with a NodeError or a WorldError which names the file, or the one beside it that it
// names, is as good as a result; out of memory is not.
void reading(const FilePath& file, const std::function<void(Context&)>& read, std::string_view beside = {});

// Reads a mesh in single or double precision, which an input's length decides.
void read_mesh(Mesh (*read)(std::string_view, const FilePath&, Context&), std::string_view input,
               const FilePath&, std::string_view beside = {});

}  // namespace frustum::fuzz
