// Small graphs as text, and what loading them gives.
#pragma once

#include "runtime/graph/load.h"

#include <nlohmann/json.hpp>

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::test {

inline std::string graph_with(const std::string& nodes, const std::string& more = "") {
  return "{ \"format\": \"frustum.graph/1\", " + more + " \"nodes\": { " + nodes + " } }";
}

// "code pointer" of every error, in order.
inline std::vector<std::string> errors(const Loaded& l) {
  std::vector<std::string> out;
  for (const Diagnostic& d : l.problems.list())
    if (d.severity == Severity::error) out.push_back(d.code + " " + d.pointer);
  return out;
}
using Lines = std::vector<std::string>;

inline Diagnostic first_error(const Loaded& l) {
  for (const Diagnostic& d : l.problems.list())
    if (d.severity == Severity::error) return d;
  return {};
}

inline std::vector<std::string> ids(const Graph& g) {
  std::vector<std::string> out;
  for (const GraphNode& n : g.nodes) out.push_back(n.id);
  return out;
}

template <class T>
T param(const Graph& g, std::string_view id, std::string_view name) {
  for (const GraphNode& n : g.nodes)
    if (n.id == id)
      for (const ParamField& f : n.type->params.fields)
        if (f.name == name) return write_record(n.type->params, n.params.get())[std::string(name)].get<T>();
  throw std::runtime_error("no such parameter");
}

inline const std::string front =
    R"("teapot": { "type": "io.load_patches" },
       "camera": { "type": "scene.camera" },
       "mesh": { "type": "surface.tessellate", "in": { "surface": "teapot", "camera": "camera" } },
       "eye": { "type": "project.view", "in": { "mesh": "mesh", "camera": "camera" } },
       "clip": { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } })";
inline const std::string inner =
    R"({ "format": "frustum.graph/1", "params": { "samples": 4, "fov": 30 },
         "inputs": { "mesh": { "type": "mesh" }, "camera": { "type": "camera" }, "lights": { "type": "light", "list": true },
                     "texture": { "type": "texture", "optional": true } },
         "nodes": {
           "screen": { "type": "project.viewport", "in": { "mesh": "$mesh", "camera": "$camera" } },
           "pattern": { "type": "supersample.pattern", "params": { "samples": "$samples" } },
           "hits": { "type": "rasterize.triangles", "in": { "mesh": "screen", "pattern": "pattern" } },
           "albedo": { "type": "texture.sample", "in": { "hits": "hits", "texture": "$texture" } },
           "lit": { "type": "shade.surface", "in": { "hits": "hits", "albedo": "albedo", "lights": ["$lights"] } } },
         "outputs": { "image": { "from": "lit" }, "albedo": { "from": "albedo" }, "depth": { "from": "hits.depth" } } })";

// A graph that uses `inner` as its node "draw".
inline std::string user(const std::string& in, const std::string& more = "",
                        const std::string& outputs = R"("o": { "from": "draw", "file": "o.exr" })") {
  return graph_with(
      front +
          R"(, "checks": { "type": "texture.checker" }, "a": { "type": "light.directional" }, "b": { "type": "light.directional" },
    "draw": { "type": "graph", "file": "inner.json", "in": { "mesh": "clip", "camera": "camera", "lights": ["a", "b"])" +
          in + " }" + more + " }",
      "\"outputs\": { " + outputs + " },");
}

}  // namespace frustum::test
