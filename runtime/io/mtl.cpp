#include "runtime/io/mtl.h"

#include "nodes/kernels/reflectance.h"
#include "runtime/core/error.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/image_files.h"
#include "runtime/io/image_texture.h"
#include "runtime/io/mtl_parse.h"
#include "runtime/io/near_path.h"
#include "runtime/io/obj_cursor.h"
#include "runtime/io/printable.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

namespace frustum {
namespace {

using mtl::Counts;
using mtl::Library;
using mtl::Told;
using mtl::Written;
using obj::Cursor;

bool is_there(const FilePath& file) {
  std::error_code none;
  return std::filesystem::is_regular_file(file.resolved, none);
}

// Words of a line, where "\\ " is a blank within one.
std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> out;
  for (Cursor in(line); in.skip_blanks(), !in.done();) {
    const bool joined = !out.empty() && out.back().ends_with('\\');
    if (!joined) out.emplace_back();
    if (joined) out.back().back() = ' ';
    out.back() += in.word();
  }
  return out;
}

// The files that a line of mtllib names: it as one name if there is such a file, else one for each word.
std::vector<std::string> file_names(std::string_view line, const FilePath& obj) {
  const auto whole = near_path(obj, line);
  if (line.find_first_of(" \t") == std::string_view::npos || (whole && is_there(*whole)))
    return {std::string(line)};
  return words_of(line);
}

class Materials {
 public:
  Materials(const FilePath& obj, bool textured, Context& ctx) : obj_(obj), textured_(textured), ctx_(ctx) {}

  void read(std::string_view name) {
    if (!seen_.insert(std::string(name)).second) return;
    const auto file = near_path(obj_, name);
    if (!file)
      return warn("unsafe_path", fmt::format("{}: mtllib '{}' leaves the folder of the file; it is not read",
                                             obj_.written, printable(name, 80)));
    if (!is_there(*file))
      return warn("missing_material_file",
                  fmt::format("{}: there is no file {}", obj_.written, printable(file->written, 80)));
    const FileBytes bytes(*file);
    Told told;
    mtl::parse(bytes.text(), *file, library_, told);
    if (!told.skipped.empty())
      warn("statements_skipped", fmt::format("{}: skipped {}", file->written, list(told.skipped)));
    if (!told.held.empty())
      warn("values_held", fmt::format("{}: a material cannot have {}; it has the nearest value it can",
                                      told.held_at, list(told.held)));
  }

  Material find(std::string_view name) {
    Material out{.name = std::string(name)};
    const auto at = library_.find(name);
    if (at == library_.end()) {
      missing_ += !name.empty();
      return out;
    }
    const Written& w = at->second;
    out.diffuse = w.kd.value_or(out.diffuse);
    if (w.ka)
      for (glm::length_t k = 0; k < 3; ++k) {
        const double ratio = (*w.ka)[k] / out.diffuse[k];
        out.ambient[k] = out.diffuse[k] > 0 && std::isfinite(ratio) ? ratio : 1;
      }
    if (w.illum == 2) out.specular = w.ks.value_or(glm::dvec3(0));
    out.shininess = w.ns.value_or(out.shininess);
    out.emission = w.ke.value_or(glm::dvec3(0));
    if (!w.map_kd.empty() && textured_) out.texture = texture(w);
    if (out.texture) {
      out.texture_from_uv[0][0] = w.scale.x, out.texture_from_uv[1][1] = w.scale.y;
      out.texture_from_uv[2] = {w.offset, 1};
    }
    note_energy(out);
    return out;
  }

  double opacity(std::string_view name) const {
    const auto at = library_.find(name);
    return at == library_.end() ? 1 : at->second.d.value_or(1 - at->second.tr.value_or(0));
  }

  void finish(bool any_library) {
    if (missing_ != 0 && any_library)
      warn("missing_material",
           fmt::format("{}: {} materials are in no material file; they have the default values", obj_.written,
                       missing_));
    if (bright_ != 0)
      warn("makes_energy",
           fmt::format(
               "{}: {} materials send back more light than falls on them; '{}' sends back {:.3g} of it",
               obj_.written, bright_, printable(brightest_, 80), most_reflected_));
  }

 private:
  static std::string list(const Counts& counts) {
    std::vector<std::string> out;
    for (const auto& [what, n] : counts) out.push_back(fmt::format("{} x {}", n, what));
    out.resize(std::min<std::size_t>(out.size(), 20));
    return fmt::format("{}", fmt::join(out, ", "));
  }

  void note_energy(const Material& m) {
    const glm::dvec3 sent = m.diffuse + m.specular * kernels::blinn_reflectance(m.shininess);
    const double share = std::max({sent.r, sent.g, sent.b});
    if (!(share > 1)) return;
    ++bright_;
    if (share > most_reflected_) most_reflected_ = share, brightest_ = m.name;
  }

  void warn(std::string code, std::string message) { ctx_.warn(std::move(code), std::move(message)); }

  Ref<Texture> texture(const Written& w) {
    const auto file = near_path(obj_, w.map_kd);
    if (!file) {
      warn("unsafe_path", fmt::format("{}: '{}' leaves the folder of the OBJ file; it is not read",
                                      w.map_place, printable(w.map_kd, 80)));
      return nullptr;
    }
    const auto [at, fresh] = textures_.try_emplace({file->resolved, w.clamp});
    if (!fresh) return at->second;
    if (!is_there(*file)) {
      warn("missing_texture_file",
           fmt::format("{}: there is no file {}", w.map_place, printable(file->written, 80)));
      return nullptr;
    }
    const Wrap wrap = w.clamp ? Wrap::clamp : Wrap::repeat;
    at->second = make_texture(picture(*file, w), {.wrap_u = wrap, .wrap_v = wrap, .opaque = true}, ctx_);
    return at->second;
  }

  static Raster picture(const FilePath& file, const Written& w) {
    try {
      return read_image(file.resolved, file.written).raster;
    } catch (const NodeError& e) {
      throw NodeError(e.code, fmt::format("{}: map_Kd: {}", w.map_place, e.what()), e.part);
    } catch (const WorldError& e) {
      throw WorldError(e.code, fmt::format("{}: map_Kd: {}", w.map_place, e.what()));
    }
  }

  const FilePath& obj_;
  bool textured_;
  Context& ctx_;
  std::set<std::string> seen_;
  Library library_;
  std::map<std::pair<std::string, bool>, Ref<Texture>> textures_;
  std::uint64_t missing_ = 0, bright_ = 0;  // bright: materials that make energy
  double most_reflected_ = 1;
  std::string brightest_;
};

}  // namespace

FileMaterials read_materials(std::span<const std::string_view> libraries, const FilePath& obj,
                             std::span<const std::string_view> names, bool textured, Context& ctx) {
  Materials materials(obj, textured, ctx);
  for (const std::string_view line : libraries)
    for (const std::string& name : file_names(line, obj)) materials.read(name);
  FileMaterials out;
  for (const std::string_view name : names) {
    out.set.materials.push_back(materials.find(name));
    out.opacity.push_back(materials.opacity(name));
  }
  materials.finish(!libraries.empty());
  return out;
}

void visit_obj_files(std::string_view text, const FilePath& obj,
                     const std::function<void(const FilePath&)>& visit) {
  std::set<std::string> seen;
  const auto once = [&](const std::optional<FilePath>& file) {
    const bool fresh = file && seen.insert(file->resolved).second;
    if (fresh) visit(*file);
    return fresh && is_there(*file);
  };
  for (std::size_t at = 0; (at = text.find("mtllib", at)) != std::string_view::npos;) {
    Cursor in(text.substr(at += 6));
    in.skip_blanks();
    for (const std::string& name : file_names(in.rest_of_line(), obj)) {
      const auto file = near_path(obj, name);
      if (!once(file)) continue;
      try {
        Library library;
        Told told;
        const FileBytes bytes(*file);
        mtl::parse(bytes.text(), *file, library, told);
        for (const auto& [material, written] : library) once(near_path(obj, written.map_kd));
      } catch (const std::runtime_error&) {  // the node that reads it says what is wrong
      }
    }
  }
}

}  // namespace frustum
