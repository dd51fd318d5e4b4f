#include "tests/support/suite_runs.h"

#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"
#include "tests/support/process.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <csignal>
#include <iterator>
#include <limits>

namespace frustum::test {
namespace {

namespace fs = std::filesystem;

struct None {};

// ----- test.image
struct ImageParams {
  glm::ivec2 size{8, 4}, shift{0};
  std::string planes = "RGB";
  double add = 0, times = 1;
  bool nan = false;
};
struct ImageOut {
  Ref<Image> image;
};

ImageOut make_image(const None&, const ImageParams& p, Context& context) {
  Frame frame{.window = {0, 0, p.size.x, p.size.y},
              .pattern = {},
              .planes = {},
              .color_space = {},
              .alpha = Alpha::none};
  for (const char c : p.planes)
    frame.planes.push_back({std::string(1, c), c == 'I' ? PlaneKind::u32 : PlaneKind::f32});
  Raster raster(frame);
  for (int k = 0; k < static_cast<int>(frame.planes.size()); ++k)
    for (int y = 0; y < p.size.y; ++y)
      for (int x = 0; x < p.size.x; ++x) {
        const int ramp = (x - p.shift.x) + 2 * (y - p.shift.y);
        if (frame.planes[static_cast<std::size_t>(k)].kind == PlaneKind::u32)
          raster.view().row<std::uint32_t>(k, 0, y)[x] = static_cast<std::uint32_t>(ramp);
        else
          raster.view().row<float>(k, 0, y)[x] =
              static_cast<float>((ramp / 64.0 + k / 8.0) * p.times + p.add);
      }
  if (p.nan && !frame.planes.empty())
    raster.view().row<float>(0, 0, 0)[1] = std::numeric_limits<float>::quiet_NaN();
  context.count("pixels_made", static_cast<std::uint64_t>(frame.window.area()));
  return {std::make_shared<const Image>(Image{std::move(raster)})};
}

// ----- test.copy
struct CopyIn {
  Ref<Image> image;
};
struct NoParams {};
ImageOut copy_image(const CopyIn& in, const NoParams&, Context&) { return {in.image}; }

// ----- test.mesh
struct MeshParams {
  bool open = false, inside_out = false, flipped = false, doubled = false;
  double normal = 0, scale = 1;
};
struct MeshOut {
  Ref<Mesh> mesh;
};

MeshOut make_mesh(const None&, const MeshParams& p, Context&) {
  const auto s = static_cast<float>(p.scale);
  const std::vector<glm::vec3> corners{{0, 0, 0}, {s, 0, 0}, {0, s, 0}, {0, 0, s}};
  std::vector<glm::uvec3> faces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  if (p.open) faces.pop_back();
  if (p.inside_out)
    for (auto& f : faces) std::swap(f.y, f.z);
  if (p.flipped) std::swap(faces[0].y, faces[0].z);
  if (p.doubled) faces.push_back(faces[0]);
  auto mesh = std::make_shared<Mesh>();
  mesh->columns = {Column::make<glm::uvec3>("triangle", Domain::face, std::span<const glm::uvec3>(faces)),
                   Column::make<glm::vec3>("position", Domain::vertex, std::span<const glm::vec3>(corners),
                                           Space::object)};
  if (p.normal != 0) {
    const std::vector<glm::vec3> normals(4, glm::vec3(0, static_cast<float>(p.normal), 0));
    mesh->columns.push_back(
        Column::make<glm::vec3>("normal", Domain::vertex, std::span<const glm::vec3>(normals)));
  }
  return {mesh};
}

// ----- test.matrix
struct MatrixParams {
  double scale = 1;
};
struct MatrixOut {
  Ref<Matrix> matrix;
};
MatrixOut make_matrix(const None&, const MatrixParams& p, Context&) {
  Matrix m;
  m.value[0] *= p.scale;
  return {std::make_shared<const Matrix>(m)};
}

// ----- test.table
struct TableParams {
  int rows = 4;
};
struct TableOut {
  Ref<Table> table;
};

TableOut make_table(const None&, const TableParams& p, Context&) {
  Table t;
  t.columns = {{.name = "n"}, {.name = "square"}};
  for (int i = 0; i < p.rows; ++i) t.columns[0].numbers.push_back(i), t.columns[1].numbers.push_back(i * i);
  return {std::make_shared<const Table>(std::move(t))};
}

// ----- test.act
struct ActParams {
  std::string what = "nothing", file;
};

ImageOut act(const None&, const ActParams& p, Context& context) {
  if (p.what == "crash") {
    std::signal(SIGSEGV, SIG_DFL);  // a sanitizer's handler would make it an exit code
    std::raise(SIGSEGV);
  }
  if (p.what == "exit") ::_exit(7);
  if (p.what == "say") std::fputs("what it said \xff\n", stderr);
  if (p.what == "throw" || p.what == "say") throw std::runtime_error("no reason");
  if (p.what == "hang")
    for (;;) ::pause();
  if (p.what == "flaky" && !fs::exists(p.file)) {
    std::ofstream(p.file) << "here";
    throw NodeError("not_yet", "it fails the first time");
  }
  return make_image({}, {.size = {1, 1}}, context);
}

}  // namespace

Registry suite_nodes() {
  std::vector<NodeType> types;
  types.push_back(node("test.image", make_image)
                      .param("size", &ImageParams::size, "")
                      .param("shift", &ImageParams::shift, "")
                      .param("planes", &ImageParams::planes, "")
                      .param("add", &ImageParams::add, "")
                      .param("times", &ImageParams::times, "")
                      .param("nan", &ImageParams::nan, "")
                      .output("image", &ImageOut::image, ""));
  types.push_back(
      node("test.copy", copy_image).input("image", &CopyIn::image, "").output("image", &ImageOut::image, ""));
  types.push_back(node("test.mesh", make_mesh)
                      .param("open", &MeshParams::open, "")
                      .param("inside_out", &MeshParams::inside_out, "")
                      .param("flipped", &MeshParams::flipped, "")
                      .param("doubled", &MeshParams::doubled, "")
                      .param("normal", &MeshParams::normal, "")
                      .param("scale", &MeshParams::scale, "")
                      .output("mesh", &MeshOut::mesh, ""));
  types.push_back(node("test.matrix", make_matrix)
                      .param("scale", &MatrixParams::scale, "")
                      .output("matrix", &MatrixOut::matrix, ""));
  types.push_back(node("test.table", make_table)
                      .param("rows", &TableParams::rows, "")
                      .output("table", &TableOut::table, ""));
  types.push_back(node("test.act", act)
                      .param("what", &ActParams::what, "")
                      .param("file", &ActParams::file, "")
                      .output("image", &ImageOut::image, ""));
  return Registry(std::move(types));
}

SuiteFolder::SuiteFolder() {
  fs::create_directories(suites());
  graph("image.json", "test.image"), graph("mesh.json", "test.mesh");
  graph("table.json", "test.table"), graph("act.json", "test.act");
}

void SuiteFolder::graph(const std::string& name, const std::string& type, const std::string& params) const {
  folder_.write("suites/" + name, R"({"format": "frustum.graph/1", "nodes": {"made": {"type": ")" + type +
                                      R"(", "params": )" + params +
                                      R"(}}, "outputs": {"out": {"from": "made"}}})");
}

Suite SuiteFolder::suite(const std::string& cases) const {
  Diagnostics problems;
  const std::string path =
      folder_.write("suites/s.json", R"({"format": "frustum.suite/1", "cases": [)" + cases + "]}");
  auto suite = load_suite(path, problems);
  if (!suite) throw std::runtime_error(to_text(problems));
  return *suite;
}

std::vector<CaseResult> SuiteFolder::run(const std::string& cases, const SuiteOptions& options) const {
  Session session(suite_nodes());
  return run_suites(session, {suite(cases)}, options, [](const CaseResult&) {});
}

std::vector<CaseResult> SuiteFolder::run(const std::string& cases) const {
  SuiteOptions options;
  options.isolate = false;
  return run(cases, options);
}

CaseResult SuiteFolder::check(const std::string& params, const std::string& checks) const {
  graph("checked.json", "test.image", params);
  return run(R"({"id": "c", "graph": "checked.json", "checks": [)" + checks + "]}").at(0);
}

std::vector<CaseResult> SuiteFolder::accept(const std::string& cases, const std::string& reason) const {
  SuiteOptions options;
  options.isolate = false, options.goldens = Goldens::propose,
  options.staging = folder_.file("golden/staged");
  fs::create_directories(options.staging);
  const auto results = run(cases, options);
  record_goldens({suite(cases)}, results, reason);
  fs::remove_all(options.staging);
  return results;
}

bool done_in_a_fresh_process() {
  const auto threads = std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator());
  if (threads == 1) return false;
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const auto r = run_process(
      {"/proc/self/exe", std::string("--gtest_filter=") + test->test_suite_name() + "." + test->name()});
  EXPECT_EQ(r.code, 0) << r.out << r.err;
  return true;
}

}  // namespace frustum::test
