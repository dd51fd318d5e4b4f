#include "runtime/buffers/texture.h"
#include "runtime/buffers/transparency.h"
#include "runtime/core/error.h"
#include "runtime/io/gltf_attribute.h"
#include "runtime/io/gltf_material_writer.h"
#include "runtime/io/mesh_writers.h"
#include "runtime/io/vertex_split.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

namespace frustum {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF holds little-endian numbers");

constexpr int float_component = 5126, uint_component = 5125;
constexpr std::size_t block_bytes = std::size_t{1} << 20,
                      poll_rows = std::size_t{1} << 16;  // between two polls

// From a mesh to the JSON and the bytes of a glTF file. Bytes are those of the columns where they are f32
// already.
class Writer {
 public:
  Writer(const Mesh& mesh, const SaveRequest& request, Context& ctx)
      : mesh_(with_materials(split_corners(mesh, ctx), ctx)), request_(request), ctx_(ctx) {}

  void run(bool binary, PartialFile& to) {
    describe();
    if (binary)
      write_glb(to);
    else
      write_gltf(to);
  }

 private:
  // Faces that are seen through need a material that says so, and faces without a number have the first one.
  static Mesh with_materials(Mesh mesh, Context& ctx) {
    const bool some = mesh.materials && !mesh.materials->materials.empty();
    const auto opaque = opaque_faces(mesh);
    const bool needs =
        mesh.faces() != 0 && (opaque.empty() || std::find(opaque.begin(), opaque.end(), 0) != opaque.end());
    if (mesh.faces() == 0 || (!some && !needs)) return mesh;
    if (!some) mesh.materials = std::make_shared<const MaterialSet>(MaterialSet{{Material{}}});
    if (some && mesh.find("material") != nullptr) return mesh;
    ctx.claim(sizeof(std::uint32_t) * mesh.faces());
    auto column = Column::make<std::uint32_t>("material", Domain::face, mesh.faces());
    std::fill_n(column->values<std::uint32_t>().data(), mesh.faces(), 0u);
    return mesh.with(std::move(column));
  }

  // ----- numbers

  std::size_t add_view(std::string_view bytes, std::optional<int> target) {
    Json view = {{"buffer", 0}, {"byteOffset", size_}, {"byteLength", bytes.size()}};
    if (target) view["target"] = *target;
    views_.push_back(std::move(view));
    pieces_.push_back(bytes);
    size_ += bytes.size();
    if (size_ % 4 == 0) return views_.size() - 1;  // numbers are of 4 bytes, pictures of any
    pieces_.push_back(std::string_view("\0\0\0", 4 - size_ % 4));
    size_ += 4 - size_ % 4;
    return views_.size() - 1;
  }

  std::size_t add_picture(std::string png) {
    auto kept = std::make_shared<std::string>(std::move(png));
    kept_.push_back(kept);
    return add_view(*kept, std::nullopt);
  }

  template <class T>
  std::string_view keep(std::vector<T> values) {
    const std::size_t bytes = values.size() * sizeof(T);
    auto kept = std::make_shared<std::vector<T>>(std::move(values));
    kept_.push_back(kept);
    return {reinterpret_cast<const char*>(kept->data()), bytes};
  }

  std::size_t add_accessor(Json accessor) {
    accessors_.push_back(std::move(accessor));
    return accessors_.size() - 1;
  }

  // The numbers of a real column as f32; `flip`: 1 - v of the second.
  std::string_view floats(const Column& c, bool flip) {
    if (c.kind() == NumberKind::f32 && !flip) return {static_cast<const char*>(c.data()), c.bytes()};
    const std::size_t numbers = c.rows() * static_cast<std::size_t>(c.width());
    ctx_.claim(sizeof(float) * numbers);
    std::vector<float> out;
    out.reserve(numbers);
    for (std::size_t i = 0; i < c.rows(); ++i) {
      if (i % poll_rows == 0) ctx_.poll();
      for (int k = 0; k < c.width(); ++k)
        out.push_back(static_cast<float>(flip && k == 1 ? 1 - c.number(i, k) : c.number(i, k)));
    }
    return keep(std::move(out));
  }

  std::size_t add_column(const Column& c, bool flip, bool bounds) {
    const std::string_view bytes = floats(c, flip);
    Json accessor = {{"bufferView", add_view(bytes, 34962)},
                     {"componentType", float_component},
                     {"count", c.rows()},
                     {"type", c.width() == 1 ? "SCALAR" : fmt::format("VEC{}", c.width())}};
    if (bounds) {
      Json low = Json::array(), high = Json::array();
      const auto width = static_cast<std::size_t>(c.width());
      for (std::size_t k = 0; k < width; ++k) {
        float least = std::numeric_limits<float>::infinity(), most = -least;
        for (std::size_t i = 0; i < c.rows(); ++i) {
          if (i % poll_rows == 0) ctx_.poll();
          float v;
          std::memcpy(&v, bytes.data() + 4 * (i * width + k), 4);
          least = std::min(least, v), most = std::max(most, v);
        }
        low.push_back(least), high.push_back(most);
      }
      accessor["min"] = std::move(low), accessor["max"] = std::move(high);
    }
    return add_accessor(std::move(accessor));
  }

  // ----- what there is

  static std::string attribute_name(const Column& c) {
    if (c.name() == "position") return "POSITION";
    if (c.name() == "normal") return "NORMAL";
    if (c.name() == "color") return "COLOR_0";
    if (c.name() == "uv") return "TEXCOORD_0";
    if (is_coordinates(c)) return "TEXCOORD_" + c.name().substr(2);
    return gltf::attribute_of(c.name());
  }

  // uv, uv1, uv2 ...
  static bool is_coordinates(const Column& c) {
    return c.name().starts_with("uv") && c.width() == 2 &&
           c.name().find_first_not_of("0123456789", 2) == std::string::npos;
  }

  Json attributes() {
    Json out = Json::object();
    for (const Ref<Column>& c : mesh_.columns) {
      const bool is_real = c->kind() == NumberKind::f32 || c->kind() == NumberKind::f64;
      const std::string name = attribute_name(*c);
      if (c->domain() == Domain::vertex && is_real && !out.contains(name)) {
        if (name[0] == '_' && gltf::column_of(name) != c->name())
          warn_left_out(request_, "glTF",
                        fmt::format("the name of column '{}', which is {} there", c->name(), name));
        out[name] = add_column(*c, is_coordinates(*c), c->name() == "position");
      } else if (c->name() != "triangle" && c->name() != "material" && c->name() != transparency_column) {
        warn_left_out(request_, "glTF", fmt::format("column '{}'", c->name()));
      }
    }
    return out;
  }

  // Indices of the faces of each material, in the order of the faces; without materials, all at once.
  void add_primitives(const Json& attributes) {
    const Column* material = mesh_.materials ? mesh_.find("material") : nullptr;
    const auto triangles = mesh_.triangles();
    if (triangles.empty()) {  // points
      primitives_.push_back({{"attributes", attributes}, {"mode", 0}});
      return;
    }
    if (material == nullptr) {
      add_primitive(attributes, {reinterpret_cast<const char*>(triangles.data()), triangles.size_bytes()},
                    {});
      return;
    }
    const auto number = material->values<std::uint32_t>();
    std::vector<std::size_t> sizes(mesh_.materials->materials.size(), 0);
    for (const std::uint32_t m : number) ++sizes[m];
    ctx_.claim(triangles.size_bytes());
    std::vector<std::vector<glm::uvec3>> groups(sizes.size());
    for (std::size_t m = 0; m < groups.size(); ++m) groups[m].reserve(sizes[m]);
    ctx_.poll();
    for (std::size_t f = 0; f < triangles.size(); ++f) groups[number[f]].push_back(triangles[f]);
    for (std::size_t m = 0; m < groups.size(); ++m)
      if (!groups[m].empty()) add_primitive(attributes, keep(std::move(groups[m])), m);
  }

  void add_primitive(const Json& attributes, std::string_view indices, std::optional<std::size_t> material) {
    const std::size_t accessor = add_accessor({{"bufferView", add_view(indices, 34963)},
                                               {"componentType", uint_component},
                                               {"count", indices.size() / 4},
                                               {"type", "SCALAR"}});
    Json primitive = {{"attributes", attributes}, {"indices", accessor}};
    if (material) primitive["material"] = *material;
    primitives_.push_back(std::move(primitive));
  }

  // By material that of its faces; nothing where all of them are opaque. glTF has one for each material.
  std::vector<std::optional<double>> opacities() const {
    const auto& materials = mesh_.materials->materials;
    const auto of = mesh_.at("material").values<std::uint32_t>();
    const auto opaque = opaque_faces(mesh_);
    const auto opacity = opacities_of<double>(mesh_);
    std::vector<std::optional<double>> out(materials.size()), first(materials.size());
    std::vector<std::uint8_t> differs(materials.size(), 0);
    for (std::size_t f = 0; f < of.size(); ++f) {
      const double here = opacity.empty() ? 1 : opacity[f];
      if (!first[of[f]]) first[of[f]] = here;
      if (*first[of[f]] != here) differs[of[f]] = 1;
      if (opaque.empty() || opaque[f] == 0) out[of[f]] = first[of[f]];
    }
    for (std::size_t m = 0; m < materials.size(); ++m) {
      const auto* pyramid =
          materials[m].texture ? std::get_if<MipPyramid>(&materials[m].texture->source) : nullptr;
      const bool masked = pyramid != nullptr && pyramid->alpha_cutoff > 0 && out[m] && *out[m] < 1;
      if (differs[m] == 0 && !masked) continue;
      warn_left_out(request_, "glTF",
                    fmt::format("the opacities of faces of material '{}'", materials[m].name));
      if (out[m]) out[m] = 1;
    }
    return out;
  }

  void describe() {
    Json asset = {{"version", "2.0"}};
    for (const auto& [key, value] : request_.metadata) {
      if (key == "Software")
        asset["generator"] = value;
      else
        asset["extras"][key] = value;
    }
    json_ = {{"asset", std::move(asset)}, {"scene", 0}};
    if (mesh_.vertices() == 0) {  // glTF has no accessor of nothing
      json_["scenes"] = {Json::object()};
      return;
    }
    add_primitives(attributes());
    json_["scenes"] = {{{"nodes", {0}}}};
    json_["nodes"] = {{{"mesh", 0}}};
    json_["meshes"] = {{{"primitives", primitives_}}};
    if (mesh_.materials && mesh_.find("material") != nullptr) {
      gltf::write_materials(
          mesh_.materials->materials, opacities(),
          [this](std::string png) { return add_picture(std::move(png)); }, request_, json_);
    }
    json_["accessors"] = accessors_;
    json_["bufferViews"] = views_;
    if (size_ > std::numeric_limits<std::uint32_t>::max() / 2)
      throw NodeError("format_cannot_hold",
                      fmt::format("{}: {} bytes are more than a glTF file holds here", request_.path, size_));
    json_["buffers"] = {{{"byteLength", size_}}};
  }

  // ----- files

  static std::string text(const Json& j) { return j.dump(-1, ' ', false, Json::error_handler_t::replace); }

  static std::string word(std::size_t v) {
    const auto n = static_cast<std::uint32_t>(v);
    std::string out(4, '\0');
    std::memcpy(out.data(), &n, 4);
    return out;
  }

  void write_glb(PartialFile& to) {
    std::string json = text(json_);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::size_t body = size_ != 0 ? 8 + size_ : 0;
    to.add("glTF" + word(2) + word(12 + 8 + json.size() + body) + word(json.size()) + "JSON" + json);
    if (body != 0) to.add(word(size_) + std::string("BIN\0", 4));
    for (const std::string_view p : pieces_)
      for (std::size_t at = 0; at < p.size(); at += block_bytes) {
        to.add(p.substr(at, block_bytes));
        to.check();
        ctx_.poll();
      }
  }

  void write_gltf(PartialFile& to) {
    std::string json = text(json_);
    if (size_ == 0) return to.add(json);
    // The bytes go where their address is written: it is not made in memory.
    const std::string mark = fmt::format("\"buffers\":[{{\"byteLength\":{}", size_);
    const std::size_t at = json.rfind(mark) + mark.size();
    to.add(json.substr(0, at) + ",\"uri\":\"data:application/octet-stream;base64,");
    write_base64(to);
    to.add("\"" + json.substr(at));
  }

  void write_base64(PartialFile& to) const {
    static constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    std::uint32_t bits = 0;
    int held = 0;
    for (const std::string_view p : pieces_)
      for (const char c : p) {
        bits = bits << 8 | static_cast<unsigned char>(c);
        if (++held < 3) continue;
        for (int shift = 18; shift >= 0; shift -= 6) out += digits[bits >> shift & 63];
        bits = 0, held = 0;
        if (out.size() < block_bytes) continue;
        to.add(out);
        to.check();
        ctx_.poll();
        out.clear();
      }
    if (held == 1) (out += digits[bits >> 2 & 63]) += digits[bits << 4 & 63], out += "==";
    if (held == 2)
      ((out += digits[bits >> 10 & 63]) += digits[bits >> 4 & 63]) += digits[bits << 2 & 63], out += "=";
    to.add(out);
  }

  Mesh mesh_;
  const SaveRequest& request_;
  Context& ctx_;
  Json json_, views_ = Json::array(), accessors_ = Json::array(), primitives_ = Json::array();
  std::vector<std::string_view> pieces_;
  std::vector<std::shared_ptr<void>> kept_;
  std::size_t size_ = 0;
};

}  // namespace

void write_gltf(const Mesh& mesh, bool binary, const SaveRequest& request, PartialFile& to, Context& ctx) {
  Writer(mesh, request, ctx).run(binary, to);
}

}  // namespace frustum
