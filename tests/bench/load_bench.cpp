// What it costs to read and check a graph file, per node, and to read meshes of a million triangles.
#include "runtime/buffers/value.h"
#include "runtime/graph/load.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/gltf.h"
#include "runtime/io/mesh_readers.h"

#include <benchmark/benchmark.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace frustum {
namespace {

struct Inputs {
  std::vector<Ref<Number>> numbers;
};
struct Params {
  std::vector<glm::dvec3> points;
  double scale = 1;
};
struct Outputs {
  Ref<Number> number;
};

Outputs run(const Inputs&, const Params&, Context&) { return {}; }

void check_chain(benchmark::State& state) {
  const Registry registry({node("bench.point", run)
                               .input("numbers", &Inputs::numbers, "")
                               .param("points", &Params::points, "")
                               .param("scale", &Params::scale, "")
                               .output("number", &Outputs::number, "")});
  std::string text =
      R"({ "format": "frustum.graph/1", "params": { "size": 2 }, "nodes": { "n0": { "type": "bench.point", "in": { "numbers": [] } })";
  for (int i = 1; i < state.range(0); ++i)
    text += ",\n\"n" + std::to_string(i) + "\": { \"type\": \"bench.point\", \"in\": { \"numbers\": [\"n" +
            std::to_string(i - 1) +
            "\"] }, \"params\": { \"points\": [[0, 1, 0], [1, 0, 0.5]], \"scale\": \"$size\" } }";
  text += " } }";
  for (auto _ : state) {
    const Loaded loaded = load_graph_text(text, "bench.json", registry);
    if (!loaded.graph) throw std::runtime_error(to_text(loaded.problems));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(check_chain)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

// ----- meshes

// A wavy sheet of (n - 1)^2 quads of two triangles; row() is given every vertex, face() every triangle.
template <class Row, class Face>
void sheet(int n, Row&& row, Face&& face) {
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(n),
                  v = static_cast<float>(j) / static_cast<float>(n);
      row(u, v, std::sin(7 * u) * std::cos(9 * v));
    }
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const int a = j * n + i;
      face(a, a + 1, a + n + 1), face(a, a + n + 1, a + n);
    }
}

template <class T>
void put(std::string& out, T v) {
  out.append(reinterpret_cast<const char*>(&v), sizeof v);
}

std::string ply_text(bool binary, int n) {
  std::string out = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      binary ? "binary_little_endian" : "ascii", n * n, 2 * (n - 1) * (n - 1));
  sheet(
      n,
      [&](float x, float y, float z) {
        if (binary)
          put(out, x), put(out, y), put(out, z);
        else
          out += fmt::format("{} {} {}\n", x, y, z);
      },
      [&](int a, int b, int c) {
        if (binary)
          put(out, std::uint8_t{3}), put(out, a), put(out, b), put(out, c);
        else
          out += fmt::format("3 {} {} {}\n", a, b, c);
      });
  return out;
}

std::string obj_text(int n) {
  std::string out;
  sheet(
      n,
      [&](float x, float y, float z) {
        out += fmt::format("v {} {} {}\nvt {} {}\nvn 0 0 1\n", x, y, z, x, y);
      },
      [&](int a, int b, int c) {
        out += fmt::format("f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", a + 1, b + 1, c + 1);
      });
  return out;
}

std::string stl_bytes(int n) {
  std::vector<glm::vec3> p;
  std::string out(84, ' ');
  std::uint32_t count = 0;
  sheet(
      n, [&](float x, float y, float z) { p.emplace_back(x, y, z); },
      [&](int a, int b, int c) {
        put(out, glm::vec3(0, 0, 1));
        for (const int i : {a, b, c}) put(out, p[static_cast<std::size_t>(i)]);
        put(out, std::uint16_t{0});
        ++count;
      });
  std::memcpy(out.data() + 80, &count, sizeof count);
  return out;
}

// Positions, normals, uv and 32-bit indices, as exporters write them.
std::string glb_bytes(int n) {
  std::string position, normal, uv, index;
  sheet(
      n,
      [&](float x, float y, float z) {
        put(position, glm::vec3(x, y, z)), put(normal, glm::vec3(0, 0, 1)), put(uv, glm::vec2(x, y));
      },
      [&](int a, int b, int c) { put(index, a), put(index, b), put(index, c); });
  const std::size_t vertices = position.size() / 12, at_normal = position.size(),
                    at_uv = at_normal + normal.size(), at_index = at_uv + uv.size(),
                    end = at_index + index.size();
  std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}},"indices":3}}]}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{0},"type":"VEC3"}},)"
      R"({{"bufferView":1,"componentType":5126,"count":{0},"type":"VEC3"}},)"
      R"({{"bufferView":2,"componentType":5126,"count":{0},"type":"VEC2"}},)"
      R"({{"bufferView":3,"componentType":5125,"count":{1},"type":"SCALAR"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":{2}}},{{"buffer":0,"byteOffset":{2},"byteLength":{2}}},)"
      R"({{"buffer":0,"byteOffset":{3},"byteLength":{4}}},{{"buffer":0,"byteOffset":{5},"byteLength":{6}}}],)"
      R"("buffers":[{{"byteLength":{7}}}]}})",
      vertices, index.size() / 4, at_normal, at_uv, uv.size(), at_index, index.size(), end);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string out = "glTF";
  const auto word = [&](std::size_t v) { put(out, static_cast<std::uint32_t>(v)); };
  word(2), word(28 + json.size() + end), word(json.size()), word(0x4E4F534A);
  out += json;
  word(end), word(0x004E4942);
  return out + position + normal + uv + index;
}

// 708 x 708 vertices are 999,698 triangles. The bytes are in memory: what a file costs besides is reading it.
void read_mesh_bytes(benchmark::State& state, std::string_view extension, const std::string& bytes) {
  for (const MeshReader& reader : mesh_readers()) {
    if (reader.extension != extension) continue;
    for (auto _ : state) {
      Context ctx;
      benchmark::DoNotOptimize(reader.read(bytes, {"bench", "bench"}, ctx));
    }
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}
void read_ply_binary(benchmark::State& state) { read_mesh_bytes(state, "ply", ply_text(true, 708)); }
void read_ply_text(benchmark::State& state) { read_mesh_bytes(state, "ply", ply_text(false, 708)); }
void read_obj_text(benchmark::State& state) { read_mesh_bytes(state, "obj", obj_text(708)); }
void read_stl_binary(benchmark::State& state) { read_mesh_bytes(state, "stl", stl_bytes(708)); }

// A GLB file of a million triangles, read whole; and the least that any reader does: the file into memory, and
// from there into columns of the same sizes.
class GlbFile {
 public:
  GlbFile()
      : path_((std::filesystem::temp_directory_path() / fmt::format("frustum_bench_{}.glb", getpid()))
                  .string()) {
    std::ofstream(path_, std::ios::binary) << glb_bytes(708);
  }
  ~GlbFile() { std::filesystem::remove(path_); }
  FilePath path() const { return {path_, path_}; }

 private:
  std::string path_;
};

void read_glb_file(benchmark::State& state) {
  const GlbFile file;
  for (auto _ : state) {
    Context ctx;
    const FileBytes bytes(file.path());
    benchmark::DoNotOptimize(read_gltf_mesh(bytes.text(), file.path(), ctx));
  }
}
void copy_glb_file(benchmark::State& state) {
  const GlbFile file;
  constexpr std::size_t vertices = 708 * 708, faces = 2 * 707 * 707;
  for (auto _ : state) {
    const FileBytes bytes(file.path());
    const std::shared_ptr<Column> columns[] = {Column::make<glm::vec3>("position", Domain::vertex, vertices),
                                               Column::make<glm::vec3>("normal", Domain::vertex, vertices),
                                               Column::make<glm::vec2>("uv", Domain::vertex, vertices),
                                               Column::make<glm::uvec3>("triangle", Domain::face, faces)};
    const char* from = bytes.text().data() + bytes.text().size() - vertices * 32 - faces * 12;
    for (const auto& c : columns) {
      constexpr std::size_t block = std::size_t{1} << 18;
      tbb::parallel_for(std::size_t{0}, (c->bytes() + block - 1) / block, [&](std::size_t i) {
        std::memcpy(static_cast<char*>(c->data()) + i * block, from + i * block,
                    std::min(block, c->bytes() - i * block));
      });
      from += c->bytes();
    }
    benchmark::DoNotOptimize(columns[0]->data());
  }
}
BENCHMARK(read_glb_file)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(copy_glb_file)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(read_ply_binary)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(read_ply_text)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(read_obj_text)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(read_stl_binary)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace frustum
