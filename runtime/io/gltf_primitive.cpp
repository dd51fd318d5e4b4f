#include "runtime/io/gltf_primitive.h"

#include "runtime/io/gltf_attribute.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace frustum::gltf {
namespace {

constexpr std::uint32_t most_uv_sets = 16;

class Reader {
 public:
  Reader(const FilePath& file, Data& data, std::size_t materials, bool quantized, Notes& notes)
      : file_(file), data_(data), materials_(materials), quantized_(quantized), notes_(notes) {}

  std::optional<Primitive> read(const Object& o) {
    const std::uint64_t mode = o.integer("mode", 4);
    if (mode > 6) o.fail_at("mode", "this must be 0 to 6");
    if (mode < 4) {
      notes_.add(o.path(), "is of points or lines, which are left out");
      return {};
    }
    if (o.extension("KHR_draco_mesh_compression"))
      o.fail("it is compressed by KHR_draco_mesh_compression, which is not read");
    const auto attributes = o.object("attributes");
    if (!attributes) o.fail("there are no \"attributes\"");
    if (!attributes->has("POSITION")) {
      notes_.add(o.path(), "has no positions and is left out");
      return {};
    }
    Primitive p;
    p.path = o.path(), p.mode = static_cast<Primitive::Mode>(mode);
    p.material = o.index("material", "materials", materials_);
    for (const std::string& name : attributes->keys()) read_attribute(*attributes, name, p);
    if (const auto at = o.index("indices", "accessors", data_.accessors())) p.index = indices(*at);
    if (p.mode == Primitive::Mode::triangles && p.corners() % 3 != 0)
      o.fail(fmt::format("{} {} are no whole triangles", p.corners(), p.index ? "indices" : "vertices"));
    if (o.has("targets")) notes_.add(o.path(), "has morph targets, which are left out");
    return p;
  }

 private:
  void read_attribute(const Object& attributes, const std::string& name, Primitive& p) {
    const auto accessor = [&] {
      Accessor a = data_.accessor(*attributes.index(name, "accessors", data_.accessors()));
      const std::size_t vertices = position_count(attributes);
      if (a.count != vertices)
        attributes.fail_at(name,
                           fmt::format("{} has {} elements, and POSITION {}", a.path, a.count, vertices));
      return a;
    };
    const auto wanted = [&](const Accessor& a, bool right, std::string_view what) {
      if (!right) attributes.fail_at(name, fmt::format("{} must be {}", a.path, what));
    };
    if (name == "POSITION") {
      p.position = accessor();
      wanted(p.position, p.position.width == 3 && (is_float(p.position) || is_quantized(p.position)),
             "VEC3 of floats");
    } else if (name == "NORMAL") {
      p.normal = accessor();
      wanted(*p.normal, p.normal->width == 3 && (is_float(*p.normal) || is_quantized(*p.normal)),
             "VEC3 of floats");
    } else if (name == "COLOR_0") {
      p.color = accessor();
      wanted(*p.color, p.color->width >= 3 && (is_float(*p.color) || is_share(*p.color)),
             "VEC3 or VEC4 of floats or normalised unsigned bytes or shorts");
    } else if (const auto set = set_of(name, "TEXCOORD_"); set && *set < most_uv_sets) {
      const Accessor a = accessor();
      wanted(a, a.width == 2 && (is_float(a) || is_share(a) || is_quantized(a)),
             "VEC2 of floats or normalised unsigned bytes or shorts");
      p.uv.emplace(*set, a);
    } else if (const std::string column = column_of(name); !column.empty()) {
      const std::size_t at = *attributes.index(name, "accessors", data_.accessors());
      const bool numbers = !data_.is_matrix(at) && !p.own.contains(column);
      const Accessor a = numbers ? accessor() : Accessor{};
      if (numbers && a.component != Component::u32)  // which 3.7.2.1 forbids
        p.own.emplace(column, a);
      else
        notes_.add(p.path, fmt::format("has the attribute {}, which is left out", name));
    } else if (name == "TANGENT") {
      notes_.add(p.path, "has tangents, which are left out");
    } else if (name != "JOINTS_0" && name != "WEIGHTS_0") {  // a skin is noted where it stands
      notes_.add(p.path, fmt::format("has the attribute {}, which is left out", name));
    }
  }

  std::size_t position_count(const Object& attributes) {
    return data_.accessor(*attributes.index("POSITION", "accessors", data_.accessors())).count;
  }

  Accessor indices(std::size_t at) {
    Accessor a = data_.accessor(at);
    const bool whole =
        a.component == Component::u8 || a.component == Component::u16 || a.component == Component::u32;
    if (a.width != 1 || !whole || a.normalized)
      fail(file_, a.path, "indices must be SCALAR of unsigned bytes, shorts or ints");
    return a;
  }

  static bool is_float(const Accessor& a) { return a.component == Component::f32; }
  static bool is_share(const Accessor& a) {
    return a.normalized && (a.component == Component::u8 || a.component == Component::u16);
  }
  bool is_quantized(const Accessor& a) const {
    return quantized_ && a.component != Component::u32 && a.component != Component::f32;
  }
  static std::optional<std::uint32_t> set_of(std::string_view name, std::string_view prefix) {
    if (!name.starts_with(prefix)) return {};
    name.remove_prefix(prefix.size());
    std::uint32_t set = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), set);
    if (error != std::errc() || end != name.data() + name.size()) return {};
    return set;
  }

  const FilePath& file_;
  Data& data_;
  std::size_t materials_;
  bool quantized_;
  Notes& notes_;
};

template <class Key>
bool same(const std::map<Key, Accessor>& a, const std::map<Key, Accessor>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.first == y.first && x.second.path == y.second.path;
  });
}

bool same(const std::optional<Accessor>& a, const std::optional<Accessor>& b) {
  return a.has_value() == b.has_value() && (!a || a->path == b->path);
}

}  // namespace

bool Primitive::same_vertices(const Primitive& other) const {
  return position.path == other.position.path && same(normal, other.normal) && same(color, other.color) &&
         same(uv, other.uv) && same(own, other.own);
}

std::vector<Primitive> read_primitives(const Object& mesh, const FilePath& file, Data& data,
                                       std::size_t materials, bool quantized, Notes& notes) {
  Reader reader(file, data, materials, quantized, notes);
  std::vector<Primitive> out;
  for (const Object& o : mesh.objects("primitives"))
    if (auto p = reader.read(o)) out.push_back(std::move(*p));
  return out;
}

}  // namespace frustum::gltf
