#include "runtime/io/gltf_material_writer.h"

#include "runtime/buffers/texture.h"
#include "runtime/io/mesh_writers.h"
#include "runtime/io/texture_png.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace frustum::gltf {
namespace {

Json color(const glm::dvec3& c) { return {c.x, c.y, c.z}; }

double cutoff_of(const Material& m) {
  const auto* pyramid = m.texture ? std::get_if<MipPyramid>(&m.texture->source) : nullptr;
  return pyramid != nullptr ? pyramid->alpha_cutoff : 0;
}

int wrap_code(Wrap w) { return w == Wrap::clamp ? 33071 : w == Wrap::mirror ? 33648 : 10497; }

// offset, rotation and scale of KHR_texture_transform for a map of our coordinates; null where it is none of these.
std::optional<Json> transform_of(const glm::dmat3& texture_from_uv) {
  glm::dmat3 flip(1);
  flip[1] = {0, -1, 0}, flip[2] = {0, 1, 1};
  const glm::dmat3 down = flip * texture_from_uv * flip;  // columns (c sx, -s sx), (s sy, c sy), the offset
  const double sx = std::hypot(down[0].x, down[0].y);
  const double c = sx > 0 ? down[0].x / sx : 1, s = sx > 0 ? -down[0].y / sx : 0;
  const double sy = s * down[1].x + c * down[1].y;
  const double shear = std::hypot(down[1].x - s * sy, down[1].y - c * sy);
  if (!(shear <= 1e-12 * (std::abs(sx) + std::abs(sy)))) return {};
  return Json{{"offset", {down[2].x, down[2].y}}, {"rotation", std::atan2(s, c)}, {"scale", {sx, sy}}};
}

class Writer {
 public:
  Writer(const AddPicture& add, const SaveRequest& request) : add_(add), request_(request) {}

  Json material(const Material& m, std::optional<double> opacity) {
    const Surface surface = surface_of(m);
    if (surface.limited)
      warn_left_out(request_, "glTF",
                    fmt::format("the light that material '{}' sends back beyond what falls on it", m.name));
    const glm::dvec3& base = surface.base;
    const double cutoff = cutoff_of(m);
    Json pbr = {{"baseColorFactor", {base.x, base.y, base.z, cutoff > 0 ? 1 : opacity.value_or(1)}},
                {"metallicFactor", surface.metallic},
                {"roughnessFactor", surface.roughness}};
    if (m.texture) add_texture(m, pbr);
    Json out = {
        {"name", m.name}, {"pbrMetallicRoughness", std::move(pbr)}, {"extras", {{"frustum", ours(m)}}}};
    if (m.two_sided) out["doubleSided"] = true;
    if (cutoff > 0)
      out["alphaMode"] = "MASK", out["alphaCutoff"] = cutoff;
    else if (opacity)
      out["alphaMode"] = "BLEND";
    add_emission(m, out);
    if (m.unlit) out["extensions"][use("KHR_materials_unlit")] = Json::object();
    add_specular(surface, out);
    return out;
  }

  void finish(Json& document) {
    if (!images_.empty()) {
      document["images"] = std::move(images_);
      document["samplers"] = std::move(samplers_);
      document["textures"] = std::move(textures_);
    }
    if (!used_.empty()) document["extensionsUsed"] = used_;
  }

 private:
  const std::string& use(const char* extension) { return *used_.insert(extension).first; }

  static Json ours(const Material& m) {
    return {{"ambient", color(m.ambient)},
            {"diffuse", color(m.diffuse)},
            {"model", choices(m.model)[static_cast<std::size_t>(m.model)].second},
            {"specular", color(m.specular)},
            {"shininess", m.shininess}};
  }

  void add_specular(const Surface& surface, Json& out) {
    if (surface.specular == glm::dvec3(1)) return;
    Json& specular = out["extensions"][use("KHR_materials_specular")];
    if (surface.specular == glm::dvec3(0))
      specular["specularFactor"] = 0;
    else
      specular["specularColorFactor"] = color(surface.specular);
  }

  void add_emission(const Material& m, Json& out) {
    const double most = std::max({m.emission.x, m.emission.y, m.emission.z});
    if (!(most > 0)) return;
    const double strength = std::max(most, 1.0);
    out["emissiveFactor"] = color(m.emission / strength);
    if (strength > 1)
      out["extensions"][use("KHR_materials_emissive_strength")] = {{"emissiveStrength", strength}};
  }

  void add_texture(const Material& m, Json& pbr) {
    const auto* pyramid = std::get_if<MipPyramid>(&m.texture->source);
    if (pyramid == nullptr || pyramid->levels.empty())
      return warn_left_out(request_, "glTF", fmt::format("the checkerboard of material '{}'", m.name));
    Json info = {{"index", number_of(*m.texture, *pyramid)}};
    if (m.uv_set != 0) info["texCoord"] = m.uv_set;
    if (m.texture_from_uv != glm::dmat3(1)) {
      if (const auto t = transform_of(m.texture_from_uv))
        info["extensions"][use("KHR_texture_transform")] = *t;
      else
        warn_left_out(request_, "glTF", fmt::format("the shear of the texture of material '{}'", m.name));
    }
    pbr["baseColorTexture"] = std::move(info);
  }

  std::size_t number_of(const Texture& texture, const MipPyramid& pyramid) {
    const auto [at, fresh] = numbers_.try_emplace(&texture, textures_.size());
    if (!fresh) return at->second;
    TexturePng png = texture_png(pyramid, request_.path);
    if (png.clipped) warn_left_out(request_, "glTF", "colours of texels outside [0, 1]");
    textures_.push_back({{"source", images_.size()}, {"sampler", samplers_.size()}});
    samplers_.push_back({{"wrapS", wrap_code(pyramid.wrap_u)}, {"wrapT", wrap_code(pyramid.wrap_v)}});
    images_.push_back({{"bufferView", add_(std::move(png.bytes))}, {"mimeType", "image/png"}});
    return at->second;
  }

  const AddPicture& add_;
  const SaveRequest& request_;
  Json images_ = Json::array(), samplers_ = Json::array(), textures_ = Json::array();
  std::map<const Texture*, std::size_t> numbers_;
  std::set<std::string> used_;
};

}  // namespace

Surface surface_of(const Material& m) {
  constexpr double usual = 0.04;  // F0 of an index of 1.5
  Surface out;
  const auto held = [&](double v) {
    out.limited = out.limited || !(v >= 0 && v <= 1);
    return std::clamp(v, 0.0, 1.0);
  };
  const double shininess = std::max(m.shininess, 0.0);
  out.roughness = std::sqrt(std::sqrt(2 / (shininess + 2)));
  glm::dvec3 f0(0);
  for (glm::length_t k = 0; k < 3 && !m.unlit && m.model != Reflection::lambert; ++k)
    f0[k] = held(8 * m.specular[k] / (shininess + 2));
  const double most = std::max({f0.x, f0.y, f0.z});
  if (most > 0 && m.diffuse == glm::dvec3(0)) {
    out.base = f0, out.metallic = 1;
    return out;
  }
  for (glm::length_t k = 0; k < 3; ++k) out.base[k] = m.diffuse[k] == 0 ? 0 : held(m.diffuse[k] / (1 - most));
  if (!m.unlit && f0 != glm::dvec3(usual)) out.specular = f0 / usual;
  return out;
}

void write_materials(std::span<const Material> materials, std::span<const std::optional<double>> opacity,
                     const AddPicture& add, const SaveRequest& request, Json& document) {
  Writer writer(add, request);
  for (std::size_t i = 0; i < materials.size(); ++i)
    document["materials"].push_back(writer.material(materials[i], opacity[i]));
  writer.finish(document);
}

}  // namespace frustum::gltf
