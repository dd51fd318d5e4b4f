#include "runtime/io/gltf_material.h"

#include "nodes/kernels/elementary.h"
#include "runtime/buffers/texture.h"
#include "runtime/core/error.h"
#include "runtime/io/gltf_material_writer.h"
#include "runtime/io/image_files.h"
#include "runtime/io/image_texture.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

namespace frustum::gltf {
namespace {

struct Wraps {
  Wrap u = Wrap::repeat, v = Wrap::repeat;
  auto operator<=>(const Wraps&) const = default;
};

// How a picture becomes a texture.
struct Use {
  Wraps wraps;
  bool opaque = true;
  double alpha_cutoff = 0;
  auto operator<=>(const Use&) const = default;
};

// A texture of the document: which picture, repeated how.
struct Source {
  std::size_t image;
  Use use;
};

// What one material takes from pictures; filled in when they are decoded.
struct Wishes {
  std::optional<Source> color;
  std::optional<std::size_t> roughness;  // image whose mean green and blue scale roughness and metalness
  double metallic = 1, roughness_factor = 1;
  glm::dvec3 base{1};
  double alpha = 1;       // of the base colour
  bool is_metal = false;  // without a look at pictures
  double dielectric = 0.04;
  double specular = 1;           // KHR_materials_specular: what that is scaled by
  glm::dvec3 specular_color{1};  // so, and at most to 1

  glm::dvec3 dielectric_f0() const {
    glm::dvec3 f0 = dielectric * specular_color;
    for (glm::length_t k = 0; k < 3; ++k) f0[k] = std::min(f0[k], 1.0) * specular;
    return f0;
  }
};

void set_lobe(Material& m, const glm::dvec3& f0, double alpha) {
  constexpr double most = 1024;  // narrower lobes of lights without size are smaller than pixels
  const double a2 = alpha * alpha;
  m.shininess = a2 > 2 / (most + 2) ? std::round(2 / a2 - 2) : most;
  m.specular = f0 * ((m.shininess + 2) / 8);
}

void set_metallic_roughness(Material& m, const Wishes& w, double mean_metallic, double mean_roughness) {
  const double metallic = w.metallic * mean_metallic, roughness = w.roughness_factor * mean_roughness;
  const glm::dvec3 f0 = w.dielectric_f0();
  m.diffuse = w.base * ((1 - metallic) * (1 - std::max({f0.x, f0.y, f0.z})));
  set_lobe(m, f0 * (1 - metallic) + w.base * metallic, roughness * roughness);
}

class Reader {
 public:
  Reader(const Object& document, const FilePath& file, Data& data, bool textures, Notes& notes, Context& ctx)
      : file_(file),
        data_(data),
        with_textures_(textures),
        notes_(notes),
        ctx_(ctx),
        materials_(document.objects("materials")),
        textures_(document.objects("textures")),
        images_(document.objects("images")),
        samplers_(document.objects("samplers")) {}

  FileMaterials run(std::span<const std::size_t> used) {
    FileMaterials out;
    for (const std::size_t i : used) out.set.materials.push_back(material(materials_[i]));
    decode();
    for (std::size_t i = 0; i < used.size(); ++i) {
      finish(materials_[used[i]], wishes_[i], out.set.materials[i]);
      out.opacity.push_back(wishes_[i].alpha);
    }
    return out;
  }

 private:
  Material material(const Object& o) {
    Material m{.name = o.text("name").value_or("")};
    m.two_sided = o.boolean("doubleSided").value_or(false);
    Wishes w;
    if (const auto glossy = o.extension("KHR_materials_pbrSpecularGlossiness"))
      specular_glossiness(*glossy, m, w);
    else
      metallic_roughness(o, m, w);
    emission(o, m);
    if (o.extension("KHR_materials_unlit")) {
      m.unlit = true;
      m.diffuse = w.base, m.specular = glm::dvec3(0), m.emission = glm::dvec3(0);
      w.roughness = {};
    }
    alpha(o, w);
    const bool came_back = own_numbers(o, m, w);
    if (w.is_metal && !came_back && !m.unlit) note_metal(o);
    note_the_rest(o);
    wishes_.push_back(w);
    return m;
  }

  static void base_color(const Object& o, const char* key, Wishes& w) {
    const auto c = o.numbers<4>(key).value_or(std::array{1.0, 1.0, 1.0, 1.0});
    for (const double v : c)
      if (!(v >= 0 && v <= 1)) o.fail(fmt::format("{} must lie in [0, 1]", key));
    w.base = {c[0], c[1], c[2]}, w.alpha = c[3];
  }
  static double share(const Object& o, const char* key) {
    const double v = o.number(key, 1);
    if (!(v >= 0 && v <= 1)) o.fail_at(key, "this must lie in [0, 1]");
    return v;
  }

  void metallic_roughness(const Object& o, Material& m, Wishes& w) {
    if (const auto ior = o.extension("KHR_materials_ior")) {
      const double n = ior->number("ior", 1.5);
      if (n != 0 && !(n >= 1)) ior->fail_at("ior", "this must be 0, or 1 and more");
      w.dielectric = n == 0 ? 1 : (n - 1) * (n - 1) / ((n + 1) * (n + 1));
    }
    if (const auto specular = o.extension("KHR_materials_specular")) read_specular(o, *specular, w);
    if (const auto pbr = o.object("pbrMetallicRoughness")) {
      base_color(*pbr, "baseColorFactor", w);
      w.metallic = share(*pbr, "metallicFactor"), w.roughness_factor = share(*pbr, "roughnessFactor");
      if (const auto t = pbr->object("baseColorTexture")) use_color_texture(*t, m, w);
      if (const auto t = pbr->object("metallicRoughnessTexture")) {
        notes_.add(o.path(), "has a metallic-roughness texture, which counts as its mean");
        if (const auto source = texture(*t)) w.roughness = source->image;
      }
    }
    w.is_metal = w.metallic > 0 && !w.roughness;
    set_metallic_roughness(m, w, 1, 1);
  }

  void read_specular(const Object& o, const Object& specular, Wishes& w) {
    w.specular = share(specular, "specularFactor");
    const auto c = specular.numbers<3>("specularColorFactor").value_or(std::array{1.0, 1.0, 1.0});
    for (const double v : c)
      if (!(v >= 0)) specular.fail_at("specularColorFactor", "this must not be negative");
    w.specular_color = {c[0], c[1], c[2]};
    if (specular.has("specularTexture") || specular.has("specularColorTexture"))
      notes_.add(o.path(), "has a specular texture, which is left out");
  }

  void note_metal(const Object& o) {
    notes_.add(o.path(), "is metal, which shows highlights but mirrors no surroundings");
  }

  void specular_glossiness(const Object& o, Material& m, Wishes& w) {
    base_color(o, "diffuseFactor", w);
    const auto s = o.numbers<3>("specularFactor").value_or(std::array{1.0, 1.0, 1.0});
    for (const double v : s)
      if (!(v >= 0 && v <= 1)) o.fail_at("specularFactor", "this must lie in [0, 1]");
    const double rough = 1 - share(o, "glossinessFactor");
    const double most = std::max({s[0], s[1], s[2]});
    constexpr double brightest_dielectric = 0.2;  // diamond has 0.17
    w.is_metal = most > brightest_dielectric;
    m.diffuse = w.base * (1 - most);
    set_lobe(m, {s[0], s[1], s[2]}, rough * rough);
    if (const auto t = o.object("diffuseTexture")) use_color_texture(*t, m, w);
    if (o.has("specularGlossinessTexture"))
      notes_.add(o.path(), "has a specular-glossiness texture, which is left out");
  }

  void emission(const Object& o, Material& m) {
    const auto e = o.numbers<3>("emissiveFactor").value_or(std::array{0.0, 0.0, 0.0});
    double strength = 1;
    if (const auto x = o.extension("KHR_materials_emissive_strength"))
      strength = x->number("emissiveStrength", 1);
    for (const double v : {e[0], e[1], e[2], strength})
      if (!(v >= 0)) o.fail("emission must not be negative");
    if (o.has("emissiveTexture"))
      notes_.add(o.path(), "has an emissive texture: its emission is left out");
    else
      m.emission = glm::dvec3(e[0], e[1], e[2]) * strength;
    if (!std::isfinite(m.emission.x + m.emission.y + m.emission.z))
      o.fail("its emission is larger than any number");
  }

  // What gltf_material_writer wrote beside the colours that other programs read, if those are still the same.
  static bool own_numbers(const Object& o, Material& m, const Wishes& w) {
    if (!o.has_object("extras") || !o.object("extras")->has_object("frustum"))
      return false;  // they may be anything
    const auto ours = o.object("extras")->object("frustum");
    Material n = m;
    const auto take = [&](const char* key, glm::dvec3& to) {
      const auto v = ours->numbers<3>(key);
      if (!v) return;
      for (const double c : *v)
        if (!(c >= 0)) ours->fail_at(key, "this must not be negative");
      to = {(*v)[0], (*v)[1], (*v)[2]};
    };
    take("ambient", n.ambient), take("diffuse", n.diffuse), take("specular", n.specular);
    n.shininess = ours->number("shininess", m.shininess);
    if (!(n.shininess >= 0 && n.shininess <= 1e6)) ours->fail_at("shininess", "this must lie in [0, 1e6]");
    const std::string model = ours->text("model").value_or("blinn");
    for (const auto& [value, name] : choices(n.model))
      if (model == name) n.model = value;
    const Surface written = surface_of(n);
    const bool same = written.base == w.base && written.metallic == w.metallic &&
                      written.roughness == w.roughness_factor &&
                      written.specular == w.specular * w.specular_color;
    if (same) m = n;
    return same;
  }

  void alpha(const Object& o, Wishes& w) {
    const AlphaMode mode = alpha_mode(o);
    const double cutoff = o.number("alphaCutoff", 0.5);
    if (!(cutoff >= 0)) o.fail_at("alphaCutoff", "this must not be negative");
    if (mode != AlphaMode::mask && o.has("alphaCutoff"))
      notes_.add(o.path(), "has an alphaCutoff without alphaMode MASK: it counts for nothing");
    // Whatever the alpha, a cutoff of 0 leaves all of it.
    const bool tests = mode == AlphaMode::mask && cutoff > 0, reached = cutoff <= w.alpha;
    if (w.color) {
      w.color->use.opaque = !tests && mode != AlphaMode::blend;
      if (tests) w.color->use.alpha_cutoff = reached ? cutoff / w.alpha : 2;
    }
    if (mode != AlphaMode::blend) w.alpha = w.color || !tests || reached ? 1 : 0;
  }

  void note_the_rest(const Object& o) {
    if (o.has("normalTexture")) notes_.add(o.path(), "has a normal texture, which is left out");
    if (o.has("occlusionTexture")) notes_.add(o.path(), "has an occlusion texture, which is left out");
    static const std::set<std::string> known = {"KHR_materials_pbrSpecularGlossiness", "KHR_materials_ior",
                                                "KHR_materials_emissive_strength", "KHR_materials_specular",
                                                "KHR_materials_unlit"};
    if (const auto extensions = o.object("extensions"))
      for (const std::string& name : extensions->keys())
        if (!known.contains(name)) notes_.add(o.path(), fmt::format("has {}, which is left out", name));
  }

  // Which coordinates a texture takes and how they move, in our (u, v) with v up.
  void use_color_texture(const Object& info, Material& m, Wishes& w) {
    w.color = texture(info);
    if (!w.color) return;
    std::uint64_t set = info.integer("texCoord", 0);
    if (const auto t = info.extension("KHR_texture_transform")) {
      set = t->integer("texCoord", set);
      const auto offset = t->numbers<2>("offset").value_or(std::array{0.0, 0.0}),
                 scale = t->numbers<2>("scale").value_or(std::array{1.0, 1.0});
      const double angle = t->number("rotation", 0), c = kernels::cos(angle), s = kernels::sin(angle);
      // offset rotation scale, on (u, 1 - v). The rotation turns as the example of the extension's text does;
      // the matrix there has the other sign.
      glm::dmat3 down(1), flip(1);
      down[0] = {c * scale[0], -s * scale[0], 0};
      down[1] = {s * scale[1], c * scale[1], 0};
      down[2] = {offset[0], offset[1], 1};
      flip[1] = {0, -1, 0}, flip[2] = {0, 1, 1};
      m.texture_from_uv = flip * down * flip;
      for (glm::length_t k = 0; k < 9; ++k)
        if (!std::isfinite(m.texture_from_uv[k / 3][k % 3]))
          t->fail("it moves coordinates beyond all numbers");
    }
    if (set > 15) info.fail(fmt::format("texture coordinates {}: at most 16 sets are read", set));
    m.uv_set = static_cast<std::uint32_t>(set);
  }

  Wrap wrap(const Object& sampler, const char* key) {
    switch (sampler.integer(key, 10497)) {
      case 33071: return Wrap::clamp;
      case 33648: return Wrap::mirror;
      case 10497: return Wrap::repeat;
      default: sampler.fail_at(key, "this must be 33071, 33648 or 10497");
    }
  }

  // The picture of a texture, where it has one that can be read.
  std::optional<Source> texture(const Object& info) {
    const auto at = info.index("index", "textures", textures_.size());
    if (!at) info.fail("there is no \"index\"");
    const Object& t = textures_[*at];
    Source source{};
    auto image = t.index("source", "images", images_.size());
    if (const auto webp = t.extension("EXT_texture_webp"); webp && !image)
      image = webp->index("source", "images", images_.size());
    if (!image) {
      notes_.add(t.path(), "has no picture of a kind that is read");
      return {};
    }
    source.image = *image;
    if (const auto s = t.index("sampler", "samplers", samplers_.size())) {
      const Object& sampler = samplers_[*s];
      source.use.wraps = {wrap(sampler, "wrapS"), wrap(sampler, "wrapT")};
      if (sampler.integer("magFilter", 9729) == 9728)
        notes_.add(sampler.path(),
                   "asks for nearest texels: how textures are filtered is texture.sample's choice");
    }
    if (!with_textures_) return {};
    return source;
  }

  // ----- pictures

  struct Picture {
    std::unique_ptr<UriBytes> own;
    std::string_view bytes;
    std::string name;
    std::optional<Raster> raster;
    std::set<Use> uses;
    bool is_mean = false;
    double mean_green = 1, mean_blue = 1;
  };

  void find_bytes(std::size_t image, Picture& p) {
    const Object& o = images_[image];
    p.name = fmt::format("{}: {}", file_.written, o.path());
    if (const auto uri = o.text("uri")) {
      p.own = std::make_unique<UriBytes>(file_, *uri, o.path());
      p.bytes = p.own->bytes();
      if (!uri->starts_with("data:")) p.name = fmt::format("{} ({})", p.name, *uri);
      return;
    }
    const auto view = o.index("bufferView", "bufferViews", data_.views());
    if (!view) o.fail("it has neither a uri nor a bufferView");
    p.bytes = data_.view(*view).bytes;
  }

  void decode() {
    for (const Wishes& w : wishes_) {
      if (w.color) pictures_[w.color->image].uses.insert(w.color->use);
      if (w.roughness) pictures_[*w.roughness].is_mean = true;
    }
    std::vector<std::pair<const std::size_t, Picture>*> all;
    for (auto& entry : pictures_) {
      find_bytes(entry.first, entry.second);
      all.push_back(&entry);
    }
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
      Picture& p = all[i]->second;
      p.raster = read_image_bytes(p.bytes, p.name).raster;
      if (p.is_mean) find_means(p);
    });
    for (auto* entry : all)
      for (const Use& use : entry->second.uses)
        made_[{entry->first, use}] = make_texture(as_srgb(*entry->second.raster),
                                                  {.wrap_u = use.wraps.u,
                                                   .wrap_v = use.wraps.v,
                                                   .alpha_cutoff = use.alpha_cutoff,
                                                   .opaque = use.opaque},
                                                  ctx_);
  }

  // Whatever a picture says of its colours, base colour is sRGB (glTF 2.0, 3.9.2).
  static Raster as_srgb(const Raster& from) {
    Frame f = from.frame();
    if (f.color_space == "srgb" || f.color_space == "lin_rec709" || f.color_space.empty()) return from;
    f.color_space = "srgb";
    const Raster to(std::move(f));
    copy(from.view(), to.view());
    return to;
  }

  static void find_means(Picture& p) {
    const Frame& f = p.raster->frame();
    const auto green = f.find("G"), blue = f.find("B");
    const auto mean = [&](std::optional<int> plane) {
      if (!plane || f.window.empty()) return 1.0;
      double sum = 0;
      for (int y = f.window.y0; y < f.window.y1; ++y) {
        const float* row = p.raster->view().row<const float>(*plane, 0, y);
        double line = 0;
        for (int x = 0; x < f.window.width(); ++x) line += static_cast<double>(row[x]);
        sum += line;
      }
      return sum / static_cast<double>(f.window.area());
    };
    p.mean_green = mean(green), p.mean_blue = mean(blue);
  }

  void finish(const Object& o, const Wishes& w, Material& m) {
    if (w.color) m.texture = made_.at({w.color->image, w.color->use});
    if (!w.roughness) return;
    const Picture& p = pictures_.at(*w.roughness);
    set_metallic_roughness(m, w, p.mean_blue, p.mean_green);
    if (w.metallic * p.mean_blue > 0.5) note_metal(o);
  }

  const FilePath& file_;
  Data& data_;
  bool with_textures_;
  Notes& notes_;
  Context& ctx_;
  std::vector<Object> materials_, textures_, images_, samplers_;
  std::vector<Wishes> wishes_;
  std::map<std::size_t, Picture> pictures_;
  std::map<std::pair<std::size_t, Use>, Ref<Texture>> made_;
};

}  // namespace

AlphaMode alpha_mode(const Object& material) {
  const std::string mode = material.text("alphaMode").value_or("OPAQUE");
  if (mode == "OPAQUE") return AlphaMode::opaque;
  if (mode == "MASK") return AlphaMode::mask;
  if (mode != "BLEND") material.fail_at("alphaMode", "this must be OPAQUE, MASK or BLEND");
  return AlphaMode::blend;
}

bool has_color_texture(const Object& material) {
  if (const auto glossy = material.extension("KHR_materials_pbrSpecularGlossiness"))
    return glossy->has("diffuseTexture");
  const auto pbr = material.object("pbrMetallicRoughness");
  return pbr && pbr->has("baseColorTexture");
}

FileMaterials read_materials(const Object& document, const FilePath& file, Data& data,
                             std::span<const std::size_t> used, bool textures, Notes& notes, Context& ctx) {
  return Reader(document, file, data, textures, notes, ctx).run(used);
}

}  // namespace frustum::gltf
