#include "runtime/io/gltf.h"

#include "nodes/kernels/predicates.h"
#include "nodes/kernels/vector.h"
#include "runtime/core/error.h"
#include "runtime/io/first_row.h"
#include "runtime/io/gltf_file.h"
#include "runtime/io/gltf_material.h"
#include "runtime/io/gltf_normals.h"
#include "runtime/io/gltf_primitive.h"
#include "runtime/io/gltf_read.h"
#include "runtime/io/gltf_scene.h"
#include "runtime/io/printable.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <cmath>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <type_traits>

namespace frustum {
namespace {

using namespace gltf;

// One primitive of one instance, and where its vertices and faces go. Primitives that differ in faces and material only
// have their vertices once, with the first of them: exporters give all materials of a mesh one vertex buffer.
struct Part {
  const Primitive* primitive;
  Placement world;
  bool mirrored, moved;
  bool shares;  // its vertices are those of the part before
  std::size_t vertex, face;
};

template <class R>
class Assembler {
 public:
  Assembler(std::string_view bytes, const FilePath& file, bool textures, Context& ctx)
      : file_(file),
        ctx_(ctx),
        textures_(textures),
        size_(bytes.size()),
        source_(gltf::open(bytes, file)),
        document_(*source_.json, "", file),
        data_(document_, file, source_.binary),
        materials_(document_.objects("materials")) {}

  GltfScene run() {
    Flattened scene = flatten(document_, notes_);
    list_parts(scene.instances);
    check_size();
    GltfScene out;
    for (NamedCamera& c : scene.cameras)
      out.views.push_back({std::move(c.node), std::move(c.name), c.camera});
    out.lights.lights = std::move(scene.lights);
    Mesh& m = out.mesh;
    m.columns = {triangles(), positions()};
    m.columns.push_back(normals(m));
    for (const std::uint32_t set : uv_sets_) m.columns.push_back(uv_column(set));
    if (color_width_ != 0) m.columns.push_back(color_width_ == 3 ? colors<3>() : colors<4>());
    for (const auto& [name, width] : own_widths_) m.columns.push_back(own_column(name, width));
    add_materials(m);
    report();
    return out;
  }

 private:
  using Vec2 = glm::vec<2, R>;
  using Vec3 = glm::vec<3, R>;

  // ----- what there is

  void list_parts(const std::vector<Instance>& instances) {
    const auto meshes = document_.objects("meshes");
    const auto used = document_.texts("extensionsUsed");
    const bool quantized = std::find(used.begin(), used.end(), "KHR_mesh_quantization") != used.end();
    primitives_.resize(meshes.size());
    std::vector<char> read(meshes.size(), 0);
    for (const Instance& instance : instances) {
      auto& of = primitives_[instance.mesh];
      if (std::exchange(read[instance.mesh], char{1}) == 0)
        of = read_primitives(meshes[instance.mesh], file_, data_, materials_.size(), quantized, notes_);
      const Primitive* before = nullptr;
      for (const Primitive& p : of) {
        const bool shares = before != nullptr && before->same_vertices(p) &&
                            (!p.color || alpha_counts(*before) == alpha_counts(p));
        add_part(p, instance.world_from_mesh, shares);
        before = &p;
      }
    }
  }

  void add_part(const Primitive& p, const Placement& world, bool shares) {
    const auto& l = world.linear;
    const bool moved = l != glm::dmat3(1) || world.translation != glm::dvec3(0);
    const std::size_t vertex = shares ? parts_.back().vertex : vertices_;
    parts_.push_back(
        {&p, world, kernels::determinant_sign(l[0], l[1], l[2]) < 0, moved, shares, vertex, faces_});
    if (!shares) vertices_ += p.vertices();
    faces_ += p.triangles();
    if (!p.normal) facets_ += p.triangles();
    if (p.color) color_width_ = std::max(color_width_, p.color->width == 4 && alpha_counts(p) ? 4 : 3);
    for (const auto& [set, accessor] : p.uv) uv_sets_.insert(set);
    for (const auto& [name, accessor] : p.own) {
      const auto [known, fresh] = own_widths_.try_emplace(name, accessor.width);
      if (fresh)
        own_width_ += accessor.width;
      else if (known->second != accessor.width)
        notes_.add(p.path, fmt::format("has {} numbers of '{}' a vertex, and others {}: they are left out",
                                       accessor.width, printable(name, 80), known->second));
    }
    if (std::max(vertices_, faces_) > std::size_t{1} << 40) check_size();  // long before the sums overflow
  }

  // Vertices of opaque materials have no opacity, whatever the file says; a cutoff is that of a texture.
  bool alpha_counts(const Primitive& p) {
    if (!p.material || alpha_mode(materials_[*p.material]) == AlphaMode::opaque) return false;
    const Object& material = materials_[*p.material];
    if (alpha_mode(material) == AlphaMode::blend || has_color_texture(material)) return true;
    notes_.add(material.path(), "has alphaMode MASK and no texture: the opacity of vertices is left out");
    return false;
  }

  void check_size() const {
    const double numbers = static_cast<double>(vertices_) *
                           (6.0 + color_width_ + own_width_ + 2.0 * static_cast<double>(uv_sets_.size()));
    const double bytes =
        numbers * sizeof(R) + static_cast<double>(faces_) * (facets_ != 0 ? 16 + 9.0 * sizeof(R) : 16.0);
    if (bytes > 0x1p26 + 256.0 * static_cast<double>(size_ + data_.bytes()))
      throw NodeError(
          "too_large",
          fmt::format("{}: its instances make {} vertices and {} triangles, more than 256 times what "
                      "its {} bytes hold",
                      file_.written, vertices_, faces_, size_ + data_.bytes()));
    if (std::max(vertices_, 3 * faces_) > std::size_t{1} << 31)
      throw NodeError("too_large", fmt::format("{} has more than 2^31 corners or vertices", file_.written));
  }

  // ----- columns

  Ref<Column> triangles() {
    auto column = Column::make<glm::uvec3>("triangle", Domain::face, faces_);
    auto* out = column->template values<glm::uvec3>().data();
    for (const Part& p : parts_) {
      ctx_.poll();
      if (p.primitive->triangles() != 0) fill_triangles(p, &out[p.face].x);
    }
    return column;
  }

  void fill_triangles(const Part& p, std::uint32_t* out) const {
    const Primitive& from = *p.primitive;
    const auto base = static_cast<std::uint32_t>(p.vertex);
    const bool list = from.mode == Primitive::Mode::triangles;
    if (list && from.index && from.index->is_packed()) return fill_list(p, out);
    const auto index = std::make_unique_for_overwrite<std::uint32_t[]>(from.corners());
    read_indices(from, index.get());
    const bool strip = from.mode == Primitive::Mode::strip;
    kernels::parallel_blocks(from.triangles(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        // glTF 2.0, 3.7.2.1
        const std::array<std::size_t, 3> at = list    ? std::array{3 * t, 3 * t + 1, 3 * t + 2}
                                              : strip ? std::array{t, t + 1 + t % 2, t + 2 - t % 2}
                                                      : std::array{t + 1, t + 2, std::size_t{0}};
        put(out + 3 * t, base, index[at[0]], index[at[1]], index[at[2]], p.mirrored);
      }
    });
  }

  // The usual case goes from the file to the column in one pass.
  void fill_list(const Part& p, std::uint32_t* out) const {
    const Primitive& from = *p.primitive;
    const auto base = static_cast<std::uint32_t>(p.vertex);
    std::atomic<bool> wrong{false};
    with_component(from.index->component, [&]<class C>(C) {
      if constexpr (std::is_unsigned_v<C>) {
        kernels::parallel_blocks(from.triangles(), kernels::usual_block,
                                 [&](std::size_t begin, std::size_t end) {
                                   const char* at = from.index->first + 3 * begin * sizeof(C);
                                   std::uint32_t greatest = 0;
                                   for (std::size_t k = 3 * begin; k < 3 * end; ++k, at += sizeof(C)) {
                                     const std::uint32_t v = load<C>(at);
                                     greatest = std::max(greatest, v);
                                     out[k] = base + v;
                                   }
                                   if (greatest >= from.vertices()) wrong = true;
                                   for (std::size_t t = begin; t < end && p.mirrored; ++t)
                                     std::swap(out[3 * t + 1], out[3 * t + 2]);
                                 });
      }
    });
    if (!wrong) return;
    const auto index = std::make_unique_for_overwrite<std::uint32_t[]>(from.corners());
    read_indices(from, index.get());  // says which
  }

  static void put(std::uint32_t* out, std::uint32_t base, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                  bool mirrored) {
    out[0] = base + a, out[1] = base + (mirrored ? c : b), out[2] = base + (mirrored ? b : c);
  }

  // Checked against the number of vertices.
  void read_indices(const Primitive& p, std::uint32_t* out) const {
    FirstRow wrong;
    const auto check = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (out[i] >= p.vertices()) return wrong.offer(i);
    };
    if (p.index)
      read_rows<std::uint32_t, 1>(*p.index, file_, out, check);
    else
      for (std::size_t i = 0; i < p.corners(); ++i) out[i] = static_cast<std::uint32_t>(i);
    if (const auto row = wrong.row())
      fail(file_, p.index->path,
           fmt::format("index {} is vertex {}, and {} has {} vertices", *row, out[*row], p.position.path,
                       p.vertices()));
  }

  Ref<Column> positions() {
    auto column = Column::make<Vec3>("position", Domain::vertex, vertices_, Space::world);
    auto* all = column->template values<Vec3>().data();
    for (const Part& p : parts_) {
      ctx_.poll();
      if (p.shares) continue;
      Vec3* out = all + p.vertex;
      FirstRow wrong;
      read_rows<R, 3>(p.primitive->position, file_, &out->x, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && p.moved; ++i)
          out[i] = Vec3(p.world.linear * glm::dvec3(out[i]) + p.world.translation);
        R sum = 0;  // x - x is 0, or NaN where x is not finite
        for (std::size_t i = begin; i < end; ++i)
          sum += (out[i].x - out[i].x) + (out[i].y - out[i].y) + (out[i].z - out[i].z);
        if (sum == R(0)) return;
        for (std::size_t i = begin; i < end; ++i)
          if (!std::isfinite(out[i].x) || !std::isfinite(out[i].y) || !std::isfinite(out[i].z))
            return wrong.offer(i);
      });
      if (const auto row = wrong.row())
        fail(file_, p.primitive->position.path, fmt::format("position {} is not finite", *row));
    }
    return column;
  }

  // ----- normals

  // Normals of one part, by vertex. Those without a length become 0; returns how many.
  std::size_t vertex_normals(const Part& p, Vec3* out) const {
    std::atomic<std::size_t> none{0};
    const bool turned = p.world.linear != glm::dmat3(1);
    const glm::dmat3 matrix = normal_matrix(p.world, p.mirrored);
    read_rows<R, 3>(*p.primitive->normal, file_, &out->x, [&](std::size_t begin, std::size_t end) {
      std::size_t zeros = 0;
      for (std::size_t i = begin; i < end; ++i) {
        const R square = out[i].x * out[i].x + out[i].y * out[i].y + out[i].z * out[i].z;
        // As unit as floats are: kept bit for bit.
        if (!turned && square > R(1 - 0x1p-20) && square < R(1 + 0x1p-20)) continue;
        const glm::dvec3 n = turned ? matrix * glm::dvec3(out[i]) : glm::dvec3(out[i]);
        const auto unit = kernels::normalized(n);
        if (!unit) ++zeros;
        out[i] = unit ? Vec3(*unit) : Vec3(0);
      }
      none += zeros;
    });
    return none;
  }

  // The end of the faces of all parts that share the vertices of parts_[i].
  std::size_t end_of_faces(std::size_t i) const {
    while (i + 1 < parts_.size() && parts_[i + 1].shares) ++i;
    return parts_[i].face + parts_[i].primitive->triangles();
  }

  // The area-weighted mean of the faces around, up to `end_face`, where a normal is 0; up where that is 0 too.
  void mend(const Part& p, std::size_t end_face, std::span<const glm::uvec3> triangle,
            std::span<const Vec3> position, Vec3* out) const {
    const std::size_t n = p.primitive->vertices();
    std::vector<glm::dvec3> sum(n, glm::dvec3(0));
    for (std::size_t f = p.face; f < end_face; ++f) {
      const glm::dvec3 normal = face_cross(triangle[f], position);
      for (glm::length_t c = 0; c < 3; ++c) sum[triangle[f][c] - p.vertex] += normal;
    }
    for (std::size_t i = 0; i < n; ++i)
      if (out[i] == Vec3(0)) out[i] = Vec3(kernels::normalized_or(sum[i], glm::dvec3(0, 0, 1)));
  }

  static glm::dvec3 face_cross(const glm::uvec3& t, std::span<const Vec3> position) {
    const glm::dvec3 a(position[t.x]);
    return kernels::cross(glm::dvec3(position[t.y]) - a, glm::dvec3(position[t.z]) - a);
  }

  Ref<Column> normals(const Mesh& m) {
    const auto triangle = m.triangles();
    const auto position = m.at("position").template values<Vec3>();
    const bool by_corner = facets_ != 0;
    auto column = Column::make<Vec3>("normal", by_corner ? Domain::corner : Domain::vertex,
                                     by_corner ? 3 * faces_ : vertices_);
    auto* all = column->template values<Vec3>().data();
    std::vector<Vec3> own;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      ctx_.poll();
      const Part& p = parts_[i];
      const Primitive& from = *p.primitive;
      if (from.normal && !p.shares) {
        if (by_corner) own.resize(from.vertices());
        Vec3* out = by_corner ? own.data() : all + p.vertex;
        const std::size_t none = vertex_normals(p, out);
        if (none != 0) mend(p, end_of_faces(i), triangle, position, out);
        mended_ += none;
      }
      if (!by_corner) continue;
      kernels::parallel_blocks(
          from.triangles(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = p.face + begin; f < p.face + end; ++f) {
              const Vec3 flat =
                  from.normal
                      ? Vec3(0)
                      : Vec3(kernels::normalized_or(face_cross(triangle[f], position), glm::dvec3(0, 0, 1)));
              for (glm::length_t c = 0; c < 3; ++c)
                all[3 * f + static_cast<std::size_t>(c)] =
                    from.normal ? own[triangle[f][c] - p.vertex] : flat;
            }
          });
    }
    return column;
  }

  // ----- the rest

  Ref<Column> uv_column(std::uint32_t set) {
    auto column = Column::make<Vec2>(uv_column_name(set), Domain::vertex, vertices_);
    auto* all = column->template values<Vec2>().data();
    for (const Part& p : parts_) {
      if (p.shares) continue;
      Vec2* out = all + p.vertex;
      const auto at = p.primitive->uv.find(set);
      if (at == p.primitive->uv.end()) {
        std::fill_n(out, p.primitive->vertices(), Vec2(0));
        continue;
      }
      read_rows<R, 2>(at->second, file_, &out->x, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) out[i].y = R(1) - out[i].y;
      });
    }
    return column;
  }

  // 0 where a primitive has no such attribute. Vectors are not turned: nothing says that they are directions.
  Ref<Column> own_column(const std::string& name, int width) {
    auto column = std::make_shared<Column>(name, Domain::vertex, number_kind_of<R>, width, vertices_);
    for (const Part& p : parts_) {
      if (p.shares) continue;
      ctx_.poll();
      R* out = static_cast<R*>(column->data()) + p.vertex * static_cast<std::size_t>(width);
      const auto at = p.primitive->own.find(name);
      if (at == p.primitive->own.end() || at->second.width != width) {
        std::fill_n(out, p.primitive->vertices() * static_cast<std::size_t>(width), R(0));
        continue;
      }
      const auto read = [&]<int n>(std::integral_constant<int, n>) {
        if (n == width) read_rows<R, n>(at->second, file_, out, [](std::size_t, std::size_t) {});
      };
      read(std::integral_constant<int, 1>()), read(std::integral_constant<int, 2>());
      read(std::integral_constant<int, 3>()), read(std::integral_constant<int, 4>());
    }
    return column;
  }

  template <int width>
  Ref<Column> colors() {
    using Color = glm::vec<width, R>;
    auto column = Column::make<Color>("color", Domain::vertex, vertices_);
    auto* all = column->template values<Color>().data();
    for (const Part& p : parts_) {
      if (p.shares) continue;
      Color* out = all + p.vertex;
      const auto& from = p.primitive->color;
      if (!from)
        std::fill_n(out, p.primitive->vertices(), Color(1));
      else if (from->width == 3)
        read_colors<3>(*from, false, out);
      else
        read_colors<4>(*from, alpha_counts(*p.primitive), out);
    }
    return column;
  }

  template <int has, class Color>
  void read_colors(const Accessor& from, bool alpha_counts, Color* out) const {
    if constexpr (has == Color::length()) {
      read_rows<R, has>(from, file_, &out->x, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; has == 4 && i < end && !alpha_counts; ++i) out[i][has - 1] = 1;
      });
    } else {
      std::vector<glm::vec<has, R>> rows(from.count);
      read_rows<R, has>(from, file_, &rows.data()->x, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          out[i] = Color(1);
          for (glm::length_t k = 0; k < 3; ++k) out[i][k] = rows[i][k];
        }
      });
    }
  }

  void add_materials(Mesh& m) {
    std::vector<std::size_t> used;
    constexpr std::uint32_t unknown = ~std::uint32_t{0};
    std::vector<std::uint32_t> number(materials_.size(), unknown);
    bool bare = false;
    for (const Part& p : parts_) {
      const auto material = p.primitive->material;
      bare = bare || !material;
      if (!material || number[*material] != unknown) continue;
      number[*material] = static_cast<std::uint32_t>(used.size());
      used.push_back(*material);
    }
    if (used.empty()) return;
    FileMaterials from = read_materials(document_, file_, data_, used, textures_, notes_, ctx_);
    const auto usual = static_cast<std::uint32_t>(from.set.materials.size());
    if (bare) from.set.materials.emplace_back(), from.opacity.push_back(1);
    auto column = Column::make<std::uint32_t>("material", Domain::face, faces_);
    auto* out = column->template values<std::uint32_t>().data();
    for (const Part& p : parts_)
      std::fill_n(out + p.face, p.primitive->triangles(),
                  p.primitive->material ? number[*p.primitive->material] : usual);
    const std::span<const std::uint32_t> of(out, faces_);
    m.columns.push_back(std::move(column));
    if (auto clear = transparency_by_material<R>(of, from.opacity)) m.columns.push_back(std::move(clear));
    check_coordinates(used, from.set);
    m.materials = std::make_shared<const MaterialSet>(std::move(from.set));
  }

  // A texture whose faces have no coordinates shows one texel.
  void check_coordinates(std::span<const std::size_t> used, MaterialSet& set) {
    for (std::size_t i = 0; i < used.size(); ++i) {
      Material& material = set.materials[i];
      if (!material.texture || uv_sets_.contains(material.uv_set)) continue;
      notes_.add(materials_[used[i]].path(),
                 "has a texture, and no face texture coordinates for it: it is left out");
      material.texture = nullptr;
    }
  }

  void report() {
    ctx_.count("triangles", faces_);
    ctx_.count("vertices", vertices_);
    ctx_.count("instances", parts_.size());
    notes_.report(file_, ctx_);
    if (facets_ != 0)
      ctx_.warn("normals_computed",
                fmt::format("{}: {} triangles have no normals, and are flat", file_.written, facets_));
    if (mended_ != 0)
      ctx_.warn("normals_computed",
                fmt::format("{}: {} normals have no length; each is the mean of the faces around",
                            file_.written, mended_));
    if (faces_ == 0) ctx_.warn("no_faces", fmt::format("{} has no faces", file_.written));
  }

  const FilePath& file_;
  Context& ctx_;
  bool textures_;
  std::size_t size_;
  gltf::File source_;
  Object document_;
  Data data_;
  std::vector<Object> materials_;
  Notes notes_;
  std::vector<std::vector<Primitive>> primitives_;  // by mesh
  std::vector<Part> parts_;
  std::size_t vertices_ = 0, faces_ = 0, facets_ = 0, mended_ = 0;  // facets: faces without normals
  std::set<std::uint32_t> uv_sets_;
  std::map<std::string, int> own_widths_;
  int color_width_ = 0, own_width_ = 0;  // own: their sum
};

}  // namespace

GltfScene read_gltf(std::string_view bytes, const FilePath& file, bool textures, Context& ctx) {
  try {
    return ctx.real([&]<class R>() { return Assembler<R>(bytes, file, textures, ctx).run(); });
  } catch (const std::bad_alloc&) {
    throw WorldError("out_of_memory", fmt::format("no memory for the scene of {}", file.written));
  }
}

Mesh read_gltf_mesh(std::string_view bytes, const FilePath& file, Context& ctx) {
  Mesh m = read_gltf(bytes, file, true, ctx).mesh;
  for (Ref<Column>& c : m.columns)
    if (c->name() == "position") c = c->renamed("position", Space::object);
  return m;
}

}  // namespace frustum
