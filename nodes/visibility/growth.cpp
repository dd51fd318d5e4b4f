#include "nodes/visibility/growth.h"

#include "nodes/kernels/random.h"
#include "nodes/visibility.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  std::vector<int> faces{64, 128, 256, 512, 1024};
  double layers = 4;
  int side = 256;
};
struct Outputs {
  Ref<Table> work;
};

void check(const Params& p) {
  if (p.faces.size() < 2 ||
      std::adjacent_find(p.faces.begin(), p.faces.end(), std::greater_equal<>()) != p.faces.end())
    throw NodeError("bad_sizes",
                    "growth needs two numbers of faces or more, each greater than the one before",
                    at_param("faces"));
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const auto random = [&](std::uint64_t i) {
    const auto bits = kernels::random_bits(ctx.seed, static_cast<int>(i), 0, 0, kernels::Dimension("growth"));
    return kernels::uniform_from<double>(bits[0], bits[1]);
  };
  std::vector<double> sizes(p.faces.begin(), p.faces.end());
  std::vector<growth::Work> works;
  for (const int faces : p.faces) {
    const auto n = static_cast<std::uint32_t>(faces);
    ctx.claim(n * std::uint64_t{4096});
    works.push_back(growth::work(growth::scene(n, p.layers, p.side, random), p.side, [&] { ctx.poll(); }));
  }
  using Counter = double growth::Work::*;
  constexpr std::array<std::tuple<const char*, const char*, Counter>, 5> methods{
      {{"depth buffer", "samples compared", &growth::Work::depth_buffer},
       {"scanline", "depths compared", &growth::Work::scanline},
       {"painter", "pairs compared", &growth::Work::painter},
       {"depth sort", "pairs compared", &growth::Work::depth_sort},
       {"bsp", "faces against planes", &growth::Work::bsp}}};
  auto table = std::make_shared<Table>();
  table->columns = {{.name = "method"}, {.name = "counts"}};
  for (const int n : p.faces) table->columns.push_back({.name = fmt::format("{} faces", n)});
  table->columns.push_back({.name = "exponent"});
  for (const auto& [method, counts, counter] : methods) {
    std::vector<double> work;
    for (const growth::Work& w : works) work.push_back(w.*counter);
    table->columns[0].texts.emplace_back(method);
    table->columns[1].texts.emplace_back(counts);
    for (std::size_t i = 0; i < work.size(); ++i) table->columns[2 + i].numbers.push_back(work[i]);
    table->columns.back().numbers.push_back(growth::exponent(sizes, work));
  }
  return {std::move(table)};
}

}  // namespace

NodeType nodes::visibility_growth() {
  return node("visibility.growth", run)
      .doc("Counts the work of each method of visibility on ever more faces, and fits how it grows.")
      .cite(
          "Sutherland, Sproull & Schumacker 1974, A Characterization of Ten Hidden-Surface Algorithms, "
          "doi:10.1145/356625.356626")
      .covers(46)
      .param("faces", &Params::faces,
             "How many faces the scenes have; raising them takes time that grows as fitted.",
             {.range = between(2, 1 << 20)})
      .param("layers", &Params::layers,
             "How often the faces of a scene cover the picture; raising it hides more.",
             {.range = between(0.01, 1000)})
      .param("side", &Params::side, "Width and height of the pictures; raising it is work for samples only.",
             {.unit = "px", .range = between(1, 4096)})
      .check(check)
      .output("work", &Outputs::work,
              "One row a method: its counter for each scene, and the power of faces it fits.");
}

}  // namespace frustum
