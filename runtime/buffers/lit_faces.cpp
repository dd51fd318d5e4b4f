#include "runtime/buffers/lit_faces.h"

#include "runtime/buffers/shading_scene.h"

#include <tbb/parallel_for.h>

namespace frustum {
namespace {

using kernels::ShadingScene, kernels::triple;

template <class Body>
void for_faces(const Mesh& mesh, const Context& ctx, Body&& body) {
  const auto triangles = mesh.triangles();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), 4096), [&](const auto& range) {
    ctx.poll();
    for (std::size_t f = range.begin(); f < range.end(); ++f) body(f, triangles[f]);
  });
}

}  // namespace

template <std::floating_point R>
std::vector<R> sides_of_faces(const ShadingScene<R>& s, const Mesh& mesh, const Context& ctx) {
  const Ref<Column> world = world_positions<R>(mesh);
  const auto q = world->template values<glm::vec<3, R>>();
  std::vector<R> side(mesh.faces());
  for_faces(mesh, ctx, [&](std::size_t f, const glm::uvec3& t) {
    side[f] = s.surface(f).two_sided ? kernels::seen_side(q[t[0]], q[t[1]], q[t[2]], s.eye) : R(1);
  });
  return side;
}

template <std::floating_point R>
LitFaces<R> light_faces(const ShadingScene<R>& s, const Mesh& mesh, const Context& ctx) {
  const Ref<Column> world = world_positions<R>(mesh);
  const auto q = world->template values<glm::vec<3, R>>();
  LitFaces<R> lit;
  lit.received.resize(mesh.faces());
  for_faces(mesh, ctx, [&](std::size_t f, const glm::uvec3& t) {
    lit.received[f] = kernels::light_face(s, f, q[t[0]], q[t[1]], q[t[2]]);
  });
  return lit;
}

template <std::floating_point R>
LitFaces<R> light_vertices(const ShadingScene<R>& s, const Mesh& mesh, const Context& ctx) {
  using V3 = glm::vec<3, R>;
  const Ref<Column> world = world_positions<R>(mesh), normals = mesh.real<R>("normal");
  if (normals->width() != 3)
    throw NodeError("wrong_column", "normals have three components", at_input("mesh"));
  const auto position = world->template values<V3>(), normal = normals->template values<V3>();
  const bool corner_normals = normals->domain() == Domain::corner,
             by_corner = corner_normals || !s.surface_of.empty() || !s.side.empty();
  LitFaces<R> lit;
  lit.domain = by_corner ? LitFaces<R>::Domain::corner : LitFaces<R>::Domain::vertex;
  lit.received.resize(by_corner ? 3 * mesh.faces() : mesh.vertices());
  if (by_corner)
    for_faces(mesh, ctx, [&](std::size_t f, const glm::uvec3& t) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t v = t[static_cast<glm::length_t>(c)];
        const V3 n = normal[corner_normals ? 3 * f + c : v] * s.side_of(f);
        lit.received[3 * f + c] = kernels::receive(s.setup(s.surface(f)), triple(n), triple(position[v]));
      }
    });
  else
    tbb::parallel_for(std::size_t{0}, mesh.vertices(), [&](std::size_t i) {
      lit.received[i] = kernels::receive(s.setup(s.surfaces[0]), triple(normal[i]), triple(position[i]));
    });
  if (mesh.space() != Space::screen)
    throw NodeError("wrong_space", "Gouraud shading needs the mesh in screen space", at_input("mesh"));
  lit.screen = mesh.real<R>("position");
  return lit;
}

template <std::floating_point R>
std::vector<LitFaces<R>> light_by_source(const ShadingScene<R>& s, const Mesh& mesh, bool flat, bool apart,
                                         const Context& ctx) {
  const auto light = [&](const ShadingScene<R>& by) {
    return flat ? light_faces(by, mesh, ctx) : light_vertices(by, mesh, ctx);
  };
  std::vector<LitFaces<R>> lit;
  if (!apart) {
    lit.push_back(light(s));
    return lit;
  }
  ShadingScene<R> one = s;
  for (const auto& source : s.lights) {
    one.lights = {source};
    lit.push_back(light(one));
  }
  return lit;
}

template std::vector<float> sides_of_faces(const ShadingScene<float>&, const Mesh&, const Context&);
template std::vector<double> sides_of_faces(const ShadingScene<double>&, const Mesh&, const Context&);
template LitFaces<float> light_faces(const ShadingScene<float>&, const Mesh&, const Context&);
template LitFaces<double> light_faces(const ShadingScene<double>&, const Mesh&, const Context&);
template LitFaces<float> light_vertices(const ShadingScene<float>&, const Mesh&, const Context&);
template LitFaces<double> light_vertices(const ShadingScene<double>&, const Mesh&, const Context&);
template std::vector<LitFaces<float>> light_by_source(const ShadingScene<float>&, const Mesh&, bool, bool,
                                                      const Context&);
template std::vector<LitFaces<double>> light_by_source(const ShadingScene<double>&, const Mesh&, bool, bool,
                                                       const Context&);

}  // namespace frustum
