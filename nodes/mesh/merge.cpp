#include "nodes/mesh/merge.h"

#include "nodes/mesh.h"
#include "runtime/buffers/mesh_faces.h"
#include "runtime/buffers/mesh_parts.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <cstring>
#include <map>
#include <numeric>

namespace frustum {
namespace {

struct Inputs {
  std::vector<Ref<Mesh>> meshes;
};
struct Params {};
struct Outputs {
  Ref<Mesh> mesh;
};

// What the columns of one name become, over all parts.
struct Shape {
  std::string name;
  Domain domain;
  NumberKind kind;
  int width;
  Space space;
};

bool is_real(NumberKind k) { return k == NumberKind::f32 || k == NumberKind::f64; }
bool on_surface(Domain d) { return d == Domain::vertex || d == Domain::corner; }

void join(Shape& s, const Column& c) {
  const auto differ = [&](std::string_view what) {
    return NodeError("columns_differ",
                     fmt::format("column '{}' has {} in different meshes: rename or drop one", s.name, what));
  };
  if (c.width() != s.width) throw differ(fmt::format("{} and {} components", s.width, c.width()));
  if (c.kind() != s.kind) {
    if (!is_real(c.kind()) || !is_real(s.kind))
      throw differ(fmt::format("{} and {} numbers", name_of(s.kind), name_of(c.kind())));
    s.kind = NumberKind::f64;
  }
  if (c.domain() != s.domain) {
    if (!on_surface(c.domain()) || !on_surface(s.domain))
      throw differ(fmt::format("domains {} and {}", name_of(s.domain), name_of(c.domain())));
    s.domain = Domain::corner;
  }
  if (c.space() == Space::world) s.space = Space::world;
}

std::vector<Shape> shapes_of(const std::vector<Ref<Mesh>>& parts) {
  std::vector<Shape> shapes;
  for (const auto& part : parts)
    for (const auto& c : part->columns) {
      const auto known =
          std::find_if(shapes.begin(), shapes.end(), [&](const Shape& s) { return s.name == c->name(); });
      if (known != shapes.end())
        join(*known, *c);
      else
        shapes.push_back({c->name(), c->domain(), c->kind(), c->width(), c->space()});
    }
  return shapes;
}

std::size_t rows_of(const Mesh& m, Domain d) {
  switch (d) {
    case Domain::vertex: return m.vertices();
    case Domain::corner: return 3 * m.faces();
    case Domain::face: return m.faces();
    case Domain::mesh: break;
  }
  return 1;
}

// The materials of all parts; a set that several share is taken once.
struct Materials {
  std::shared_ptr<MaterialSet> all = std::make_shared<MaterialSet>();
  std::vector<std::uint32_t> first;  // by part

  explicit Materials(const std::vector<Ref<Mesh>>& parts) {
    std::map<const MaterialSet*, std::uint32_t> known;
    for (const auto& part : parts) {
      const auto [at, is_new] = known.emplace(part->materials.get(), all->materials.size());
      first.push_back(at->second);
      if (!is_new) continue;
      if (part->materials && !part->materials->materials.empty())
        all->materials.insert(all->materials.end(), part->materials->materials.begin(),
                              part->materials->materials.end());
      else
        all->materials.emplace_back();
    }
  }
};

class Merge {
 public:
  explicit Merge(const std::vector<Ref<Mesh>>& parts) : parts_(parts), materials_(parts) {
    for (const auto& part : parts) vertices_ += part->vertices(), faces_ += part->faces();
    require_countable(vertices_, faces_);
  }

  Mesh merged(Context& ctx) {
    Mesh out;
    std::vector<Shape> shapes = shapes_of(parts_);
    const bool several = materials_.all->materials.size() > 1;
    if (several && std::none_of(shapes.begin(), shapes.end(), [](auto& s) { return s.name == "material"; }))
      shapes.push_back({"material", Domain::face, NumberKind::u32, 1, Space::none});
    for (const Shape& s : shapes) out.columns.push_back(column(s, ctx));
    const bool any_set =
        std::any_of(parts_.begin(), parts_.end(), [](const auto& p) { return p->materials != nullptr; });
    if (any_set) out.materials = materials_.all;
    out.closed = true;
    for (const auto& part : parts_) {
      if (part->closed == false) out.closed = false;
      if (!part->closed && out.closed == true) out.closed = std::nullopt;
    }
    return out;
  }

 private:
  Ref<Column> column(const Shape& s, Context& ctx) const {
    std::size_t rows = 0;
    for (const auto& part : parts_) {
      if (s.domain == Domain::mesh && part->find(s.name) != nullptr) return part->share(s.name);
      rows += rows_of(*part, s.domain);
    }
    ctx.claim(std::uint64_t{rows} * static_cast<std::uint64_t>(s.width) * bytes_of(s.kind));
    auto to = std::make_shared<Column>(s.name, s.domain, s.kind, s.width, rows, s.space);
    std::size_t at = 0, filled = 0;
    std::uint32_t vertex = 0, origin = 0;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const Mesh& part = *parts_[k];
      const std::size_t n = rows_of(part, s.domain);
      if (s.name == "triangle") {
        mesh::renumber(part.triangles(), vertex, to->values<glm::uvec3>().subspan(at, n));
      } else if (s.name == "origin") {
        origin = copy_origins(part, origin, to->values<std::uint32_t>().subspan(at, n));
      } else if (s.name == "material") {
        copy_materials(part, materials_.first[k], to->values<std::uint32_t>().subspan(at, n));
      } else if (part.find(s.name) != nullptr) {
        copy_rows(*in_shape(part, s), *to, at);
      } else if (n > 0) {
        std::memset(static_cast<std::byte*>(to->data()) + at * row_bytes(*to), 0, n * row_bytes(*to));
        ++filled;
      }
      at += n;
      vertex += static_cast<std::uint32_t>(part.vertices());
    }
    if (filled > 0 && is_real(s.kind) && s.name != "transparency")  // without it faces are opaque
      ctx.warn("column_filled",
               fmt::format("column '{}' is 0 on {} of {} meshes, which have none{}", s.name, filled,
                           parts_.size(), s.name == "normal" ? "; mesh.normals makes normals" : ""));
    return to;
  }

  // A part's column on the domain and in the kind of the whole.
  static Ref<Column> in_shape(const Mesh& part, const Shape& s) {
    Ref<Column> c = part.share(s.name);
    if (is_real(s.kind)) c = as_precision(std::move(c), s.kind);
    return c->domain() == s.domain ? c : on_corners(*c, part.triangles());
  }

  // Sources of one part follow those of the part before it. Returns where the next part's begin.
  static std::uint32_t copy_origins(const Mesh& part, std::uint32_t first, std::span<std::uint32_t> to) {
    const Ref<Column> origin = origin_of(part);
    const auto from = origin->values<std::uint32_t>();
    std::uint64_t next = first;
    for (const std::uint32_t o : from) next = std::max(next, std::uint64_t{first} + o + 1);
    if (next > 0xFFFFFFFFu)
      throw NodeError("too_large", "the source triangles are more than 32-bit numbers count");
    mesh::renumber(from, first, to);
    return static_cast<std::uint32_t>(next);
  }

  static void copy_materials(const Mesh& part, std::uint32_t first, std::span<std::uint32_t> to) {
    if (const Column* own = part.find("material"))
      mesh::renumber(own->values<std::uint32_t>(), first, to);
    else
      std::fill(to.begin(), to.end(), first);
  }

  const std::vector<Ref<Mesh>>& parts_;
  Materials materials_;
  std::size_t vertices_ = 0, faces_ = 0;
};

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  if (in.meshes.empty())
    throw NodeError("no_meshes", "there is no mesh to merge: link at least one", at_input("meshes"));
  if (in.meshes.size() == 1) return {in.meshes[0]};
  auto out = std::make_shared<Mesh>(Merge(in.meshes).merged(ctx));
  ctx.count("triangles", out->faces());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::mesh_merge() {
  return node("mesh.merge", run)
      .doc("Makes one mesh of several: vertices and faces one after the other, in the order of the links.")
      .input("meshes", &Inputs::meshes, "The parts; object space is taken to be world space.",
             {.space = {Space::object, Space::world}})
      .output("mesh", &Outputs::mesh,
              "All columns that a part has, 0 on parts without it, and all materials; nothing is welded.");
}

}  // namespace frustum
