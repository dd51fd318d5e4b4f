// Numbers that are none, in the text of an OBJ file.
#include "runtime/buffers/mesh.h"
#include "runtime/core/error.h"
#include "runtime/io/buffer_files.h"
#include "runtime/io/file_bytes.h"
#include "tests/support/meshes.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr float infinity = std::numeric_limits<float>::infinity();
const float nan = std::numeric_limits<float>::quiet_NaN();

std::string saved(const Mesh& mesh) {
  const test::TempFolder folder;
  const std::string path = folder.file("m.obj");
  Context ctx;
  save_buffer_file(Ref<Mesh>(std::make_shared<const Mesh>(mesh)), {.path = path}, ctx);
  return std::string(FileBytes({path, path}).text());
}

// Processors and libraries differ in the sign that a NaN has, and not all readers know "-nan".
TEST(ObjWriter, NamesNumbersThatAreNoneWithoutASign) {
  Mesh m = test::mesh_of<glm::vec3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, Space::world);
  const std::vector<glm::vec3> normal{glm::vec3(std::copysign(nan, -1.0F), 0, 1), glm::vec3(nan, infinity, 1),
                                      glm::vec3(0, -infinity, 1)};
  m.columns.push_back(Column::make<glm::vec3>("normal", Domain::vertex, normal, Space::world));
  m.columns.push_back(Column::make<glm::vec3>("color", Domain::vertex, normal));
  const std::string text = saved(m);
  EXPECT_THAT(text, HasSubstr("vn nan 0 1\nvn nan inf 1\nvn 0 -inf 1\n"));
  EXPECT_THAT(text, HasSubstr("v 0 0 0 nan 0 1\n"));
  EXPECT_THAT(text, Not(HasSubstr("-nan")));
}

TEST(ObjWriter, APositionThatIsNowhereIsToldWithoutASign) {
  const std::vector<glm::vec3> p{glm::vec3(std::copysign(nan, -1.0F), 0, -infinity), glm::vec3(1, 0, 0),
                                 glm::vec3(0, 1, 0)};
  try {
    saved(test::mesh_of(p, {{0, 1, 2}}, Space::world));
    FAIL();
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "format_cannot_hold");
    EXPECT_THAT(e.what(), HasSubstr("vertex 0 is at (nan, 0, -inf)"));
  }
}

}  // namespace
}  // namespace frustum
