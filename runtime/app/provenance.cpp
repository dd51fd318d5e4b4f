#include "runtime/app/provenance.h"

#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>

namespace frustum {
namespace {

bool is_pixels(const Port& p) {
  return std::any_of(p.types.begin(), p.types.end(), [](const BufferType* t) { return t->is_pixels(); });
}
bool is_mesh(const Port& p) { return p.takes(buffer_type<Mesh>()); }

// The ports that feed a node and are of a kind, in the order of its inputs.
std::vector<PortRef> feeding(const Graph& graph, std::size_t node, bool (*wanted)(const Port&)) {
  std::vector<PortRef> out;
  for (const auto& list : graph.nodes[node].inputs)
    for (const Source& source : list)
      if (const auto* from = std::get_if<PortRef>(&source); from != nullptr && wanted(graph.port(*from)))
        out.push_back(*from);
  return out;
}

// `port` and every pixel port above it, nearest first.
std::vector<PortRef> pixels_above(const Graph& graph, PortRef port) {
  std::vector<PortRef> found{port};
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const PortRef above : feeding(graph, found[i].node, is_pixels))
      if (std::find(found.begin(), found.end(), above) == found.end()) found.push_back(above);
  return found;
}

const Raster* raster_of(const Buffer& b) {
  return b && b.type().is_pixels() ? &b.type().raster(b.data()) : nullptr;
}

bool has_ids(const std::map<PortRef, Buffer>& buffers, PortRef port) {
  const auto found = buffers.find(port);
  const Raster* raster = found != buffers.end() ? raster_of(found->second) : nullptr;
  const auto plane = raster != nullptr ? raster->frame().find("id") : std::nullopt;
  return plane && raster->frame().planes[static_cast<std::size_t>(*plane)].kind == PlaneKind::u32;
}

// The port at which the ids that reach `port` were first written: the rasterizer's.
std::optional<PortRef> first_ids(const Graph& graph, const std::map<PortRef, Buffer>& buffers, PortRef port) {
  std::optional<PortRef> at;
  for (const PortRef p : pixels_above(graph, port))
    if (has_ids(buffers, p)) {
      at = p;
      break;
    }
  for (bool higher = at.has_value(); higher;) {
    higher = false;
    for (const PortRef above : feeding(graph, at->node, is_pixels))
      if (!higher && has_ids(buffers, above)) at = above, higher = true;
  }
  return at;
}

std::uint32_t origin_of(const Mesh& mesh, std::uint32_t face) {
  const Column* origin = mesh.find("origin");
  return origin != nullptr ? origin->values<std::uint32_t>()[face] : face;
}

// Samples by the face they see; those that see nothing are counted.
std::map<std::uint32_t, std::vector<int>> faces_seen(const Raster& raster, int x, int y, int& empty) {
  std::map<std::uint32_t, std::vector<int>> seen;
  const int plane = *raster.frame().find("id");
  for (int s = 0; s < raster.frame().samples(); ++s) {
    const auto face = raster.at<std::uint32_t>(plane, s, x, y);
    if (face == no_face)
      ++empty;
    else
      seen[face].push_back(s);
  }
  return seen;
}

struct Finder {
  Session& session;
  const Graph& graph;
  RunOptions options;
  Diagnostics& problems;
  RunResult::End& end;

  std::nullopt_t fail(PortRef port, std::string code, std::string message, std::string expected,
                      std::vector<std::string> suggestions = {}) {
    Diagnostic d = at_port(graph, port, std::move(code), std::move(message));
    d.expected = std::move(expected), d.suggestions = std::move(suggestions);
    problems.add(std::move(d));
    return std::nullopt;
  }

  std::optional<std::map<PortRef, Buffer>> run(std::vector<PortRef> ports) {
    options.demand = {.ports = std::move(ports), .outputs = {}};
    RunResult r = session.run(graph, options);
    end = r.end;
    if (r.end == RunResult::End::done) return std::move(r.buffers);
    problems.add(r.problems);
    return std::nullopt;
  }

  // The ports that may hold meshes, from the rasterized one upwards: an output that follows its input may hold another
  // kind, which ends the chain once it is known.
  std::vector<PortRef> mesh_chain(PortRef rasterized) const {
    std::vector<PortRef> chain{rasterized};
    for (auto above = feeding(graph, rasterized.node, is_mesh); !above.empty();
         above = feeding(graph, chain.back().node, is_mesh))
      chain.push_back(above.front());
    return chain;
  }

  void follow(SeenTriangle& t, const std::vector<PortRef>& chain,
              const std::map<PortRef, Buffer>& meshes) const {
    for (const PortRef p : chain) {
      const Ref<Mesh> mesh = meshes.at(p).as<Mesh>();
      MeshOnTheWay step{graph.name(p)};
      const auto faces = static_cast<std::uint32_t>(mesh->faces());
      for (std::uint32_t f = 0; f < faces; ++f)
        if (origin_of(*mesh, f) == t.source_triangle && step.faces++ == 0) step.first = f;
      t.path.push_back(step);
    }
    const Ref<Mesh> made = meshes.at(chain.back()).as<Mesh>();
    if (t.source_triangle >= made->faces()) return;
    const Column& position = made->at("position");
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k)
        t.corners[static_cast<std::size_t>(c)][k] =
            position.number(made->triangles()[t.source_triangle][c], k);
  }

  std::optional<Provenance> find(PortRef port, int x, int y) {
    if (!is_pixels(graph.port(port)))
      return fail(port, "not_pixels", graph.name(port) + " holds no pixels", "a port of pixels",
                  near_ports(graph, port, [](const BufferType& t) { return t.is_pixels(); }));
    options.region = Rect{x, y, x + 1, y + 1};
    const auto pixels = run(pixels_above(graph, port));
    if (!pixels) return std::nullopt;
    const auto ids = first_ids(graph, *pixels, port);
    if (!ids)
      return fail(port, "no_ids", "no port above " + graph.name(port) + " says which face a sample sees",
                  "a port below one with a plane 'id'");
    const Raster& raster = *raster_of(pixels->at(*ids));
    if (!raster.frame().window.contains(x, y))
      return fail(port, "outside_window", fmt::format("pixel {},{} lies outside the picture", x, y),
                  "a pixel of the picture");
    const auto rasterized = feeding(graph, ids->node, is_mesh);
    if (rasterized.empty())
      return fail(*ids, "no_mesh", "no mesh feeds " + graph.nodes[ids->node].id, "a mesh that is drawn");
    auto chain = mesh_chain(rasterized.front());
    options.region.reset();
    const auto meshes = run(chain);
    if (!meshes) return std::nullopt;
    const auto is_other = [&](PortRef p) { return !meshes->at(p).is<Mesh>(); };
    chain.erase(std::find_if(chain.begin(), chain.end(), is_other), chain.end());

    Provenance out;
    out.ids = graph.name(*ids);
    const GraphNode& maker = graph.nodes[chain.back().node];
    out.made_by = maker.id, out.made_type = maker.type->name, out.made_place = maker.place;
    out.samples = raster.frame().samples();
    const Mesh& seen_mesh = *meshes->at(chain.front()).as<Mesh>();
    for (const auto& [face, samples] : faces_seen(raster, x, y, out.empty)) {
      SeenTriangle t;
      t.face = face, t.source_triangle = origin_of(seen_mesh, face), t.samples = samples;
      follow(t, chain, *meshes);
      out.triangles.push_back(std::move(t));
    }
    std::stable_sort(out.triangles.begin(), out.triangles.end(),
                     [](const auto& a, const auto& b) { return a.samples.size() > b.samples.size(); });
    return out;
  }
};

}  // namespace

std::optional<Provenance> provenance(Session& session, const Graph& graph, PortRef port, int x, int y,
                                     RunOptions options, Diagnostics& problems, RunResult::End& end) {
  end = RunResult::End::done;
  return Finder{session, graph, std::move(options), problems, end}.find(port, x, y);
}

Json to_json(const Provenance& p) {
  Json triangles = Json::array();
  for (const SeenTriangle& t : p.triangles) {
    Json corners = Json::array(), path = Json::array();
    for (const glm::dvec3& c : t.corners) corners.push_back({c.x, c.y, c.z});
    for (const MeshOnTheWay& m : t.path)
      path.push_back({{"port", m.port}, {"faces", m.faces}, {"first", m.first}});
    triangles.push_back({{"face", t.face},
                         {"source_triangle", t.source_triangle},
                         {"samples", t.samples},
                         {"corners", corners},
                         {"path", path}});
  }
  return {{"ids", p.ids},
          {"samples", p.samples},
          {"empty", p.empty},
          {"made_by",
           {{"node", p.made_by},
            {"type", p.made_type},
            {"file", p.made_place.file},
            {"line", p.made_place.line},
            {"column", p.made_place.column}}},
          {"triangles", triangles}};
}

std::string to_text(const Provenance& p) {
  std::string out =
      fmt::format("{} of {} samples see a surface ({})\n", p.samples - p.empty, p.samples, p.ids);
  for (const SeenTriangle& t : p.triangles) {
    out += fmt::format("face {} in sample{} {}: triangle {} of '{}' ({}, {}:{}:{})\n", t.face,
                       t.samples.size() == 1 ? "" : "s", fmt::join(t.samples, " "), t.source_triangle,
                       p.made_by, p.made_type, p.made_place.file, p.made_place.line, p.made_place.column);
    for (const glm::dvec3& c : t.corners)
      out += fmt::format("    corner {:.9g} {:.9g} {:.9g}\n", c.x, c.y, c.z);
    for (const MeshOnTheWay& m : t.path)
      out += m.faces == 1 ? fmt::format("    {}: face {}\n", m.port, m.first)
                          : fmt::format("    {}: {} faces, the first is {}\n", m.port, m.faces, m.first);
  }
  return out;
}

}  // namespace frustum
