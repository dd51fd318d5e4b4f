// OBJ files. What follows the line "# m.mtl" is the material file of that name beside them.
#include "runtime/io/obj.h"

#include "runtime/io/mtl.h"
#include "tests/fuzz/support/check.h"
#include "tests/fuzz/support/target.h"
#include "tests/support/temp_file.h"

namespace frustum::fuzz {
namespace {

constexpr std::string_view marker = "\n# m.mtl\n";

void read(std::string_view input) {
  static const test::TempFolder folder;
  const std::size_t cut = input.find(marker);
  if (cut != std::string_view::npos) folder.write("m.mtl", input.substr(cut + marker.size()));
  const std::string_view text = input.substr(0, cut);
  const FilePath file{"input.obj", folder.file("input.obj")};
  read_mesh(read_obj, text, file, "m.mtl");
  visit_obj_files(text, file, [](const FilePath& beside) {
    require(beside.resolved.starts_with(folder.path()),
            "a file outside the folder would be read: " + beside.resolved);
  });
  if (cut != std::string_view::npos) std::filesystem::remove(folder.file("m.mtl"));
}
const Registered obj({"obj", read, {1 << 20, 1024}});

}  // namespace
}  // namespace frustum::fuzz
