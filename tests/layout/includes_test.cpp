// Dependencies run one way (docs/architecture.md), libraries stay behind their doors, and nodes call our own
// vector functions, not GLM's. Read from the text of every source file, so a fault is named by file and line.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Source {
  std::string path;  // from the root, with '/'
  std::string text;
};

struct Layer {
  std::string_view folder;
  std::string_view suffix;
  std::vector<std::string_view> may_include;  // prefixes
};

// The first row that matches a file is its layer. Kernels include no runtime header and so stand below
// everything; what a reader of nodes/io makes of a file is a buffer; app alone sees the nodes, through
// their list (docs/decisions/0001-build.md).
const std::vector<Layer>& layers() {
  static const std::vector<Layer> table = {
      {"nodes/kernels/", "", {"nodes/kernels/"}},
      {"nodes/io/", ".h", {"nodes/kernels/", "runtime/buffers/"}},
      {"nodes/", ".h", {"nodes/kernels/"}},
      {"nodes/", ".cpp", {"nodes/kernels/", "runtime/core/", "runtime/buffers/", "runtime/io/"}},
      {"runtime/core/", "", {"runtime/core/"}},
      {"runtime/buffers/", "", {"nodes/kernels/", "runtime/core/", "runtime/buffers/"}},
      {"runtime/graph/", "", {"runtime/core/", "runtime/graph/"}},
      {"runtime/io/", "", {"nodes/kernels/", "runtime/core/", "runtime/buffers/", "runtime/io/"}},
      {"runtime/app/",
       "",
       {"nodes/kernels/", "nodes/all_nodes.h", "runtime/core/", "runtime/buffers/", "runtime/graph/",
        "runtime/io/", "runtime/app/"}},
      {"runtime/cli/",
       "",
       {"runtime/core/", "runtime/buffers/", "runtime/graph/", "runtime/app/", "runtime/cli/",
        "runtime/studio/", "runtime/cluster/"}},
      {"runtime/studio/",
       "",
       {"runtime/core/", "runtime/buffers/", "runtime/graph/", "runtime/app/", "runtime/studio/"}},
      {"runtime/cluster/", "", {"runtime/core/", "runtime/graph/", "runtime/app/", "runtime/cluster/"}},
  };
  return table;
}

// Libraries that one part of the tree may name. A header that named one would hand it, and its seconds of
// compile time, to everyone above.
struct Door {
  std::string_view library;  // prefix of the included path
  std::string_view folder;
  bool in_headers;
};
constexpr Door doors[] = {
    {"nlohmann/json.hpp", "", false},
    {"OpenImageIO/", "runtime/io/oiio/", false},
    {"OpenColorIO/", "runtime/io/", false},
    {"tiny_gltf", "runtime/io/", false},
    {"embree", "nodes/", false},
    {"Eigen/", "", false},
    {"hwy/", "nodes/kernels/", true},
    {"CLI/", "runtime/cli/", true},
    {"gmp", "tests/hard/", true},
    {"mpfr", "tests/hard/", true},
    {"httplib", "runtime/studio/", false},
};

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool is_header(std::string_view path) { return path.ends_with(".h"); }

// The end of what begins at `i`: a comment, a literal, a number (whose ' separates digits), or one character.
std::size_t token_end(std::string_view text, std::size_t i) {
  const auto after = [&](std::string_view mark, std::size_t from) {
    const std::size_t found = text.find(mark, from);
    return found == std::string_view::npos ? text.size() : found + mark.size();
  };
  const auto rest = text.substr(i);
  const bool inside_a_word = i > 0 && is_word(text[i - 1]);
  if (rest.starts_with("//")) return std::min(text.find('\n', i), text.size());
  if (rest.starts_with("/*")) return after("*/", i + 2);
  if (rest.starts_with("R\"") && !inside_a_word) {
    const std::size_t open = std::min(text.find('(', i), text.size());
    return after(")" + std::string(text.substr(i + 2, open - i - 2)) + "\"", open);
  }
  if (text[i] == '"' || text[i] == '\'') {
    std::size_t end = i + 1;
    while (end < text.size() && text[end] != text[i] && text[end] != '\n') end += text[end] == '\\' ? 2 : 1;
    return std::min(end + 1, text.size());
  }
  if (inside_a_word || text[i] < '0' || text[i] > '9') return i + 1;
  std::size_t end = i + 1;
  while (end < text.size() && (is_word(text[end]) || text[end] == '\'')) ++end;
  return end;
}

// The text with comments, and unless `keep_literals` also strings and characters, turned into blanks; every
// line keeps its number.
std::string blanked(std::string_view text, bool keep_literals) {
  std::string out(text);
  for (std::size_t i = 0, end = 0; i < text.size(); i = end) {
    end = token_end(text, i);
    const bool comment = text[i] == '/' && end > i + 1;
    const bool literal = text[i] == '"' || text[i] == '\'' || (text[i] == 'R' && end > i + 1);
    if (!comment && (!literal || keep_literals)) continue;
    const auto at = [&](std::size_t k) { return out.begin() + static_cast<std::ptrdiff_t>(k); };
    std::replace_if(
        at(i), at(end), [](char c) { return c != '\n'; }, ' ');
  }
  return out;
}

std::string at(const Source& source, std::string_view text, std::ptrdiff_t position) {
  return source.path + ":" + std::to_string(1 + std::count(text.begin(), text.begin() + position, '\n')) +
         ": ";
}

// What is wrong with one #include, or "".
std::string fault_of_include(const Source& source, bool quoted, const std::string& path) {
  for (const Door& door : doors) {
    if (!path.starts_with(door.library)) continue;
    if (!source.path.starts_with(door.folder)) return path + " is for " + std::string(door.folder) + " only";
    if (is_header(source.path) && !door.in_headers) return path + " in a header";
    return "";
  }
  const bool ours = path.starts_with("nodes/") || path.starts_with("runtime/");
  if (!ours) return quoted ? path + " does not start at the root (\"nodes/\" or \"runtime/\")" : "";
  const auto layer = std::find_if(layers().begin(), layers().end(), [&](const Layer& l) {
    return source.path.starts_with(l.folder) && source.path.ends_with(l.suffix);
  });
  if (layer == layers().end()) return "no layer is known for this file";
  const std::string own_header = source.path.substr(0, source.path.rfind('.')) + ".h";
  // "nodes/clip.h" is generated and declares the types of nodes/clip/*.cpp.
  const std::string own_family = source.path.substr(0, source.path.rfind('/')) + ".h";
  const bool of_its_own = path == own_header || (path == own_family && source.path.ends_with(".cpp"));
  const bool allowed = of_its_own || std::any_of(layer->may_include.begin(), layer->may_include.end(),
                                                 [&](auto prefix) { return path.starts_with(prefix); });
  return allowed ? ""
                 : path + " is not below " + std::string(layer->folder) + "*" + std::string(layer->suffix);
}

void check_includes(const Source& source, std::vector<std::string>& faults) {
  static const std::regex include(R"re((?:^|\n)[ \t]*#[ \t]*include[ \t]*([<"])([^>"\n]+)[>"])re");
  const std::string text = blanked(source.text, true);
  for (std::sregex_iterator it(text.begin(), text.end(), include), end; it != end; ++it) {
    const std::string fault = fault_of_include(source, (*it)[1] == "\"", (*it)[2]);
    if (!fault.empty()) faults.push_back(at(source, text, it->position(2)) + fault);
  }
}

// GLM's normalize(0) is NaN, its inverse divides by a zero determinant, its lookAt fails on a vertical view, its
// clamp passes NaN through, hsvColor of a grey is NaN, slerp of equal rotations 0/0, angle is acos(a.b), which is
// flat near 0. Calls without a qualifier count too, but in kernels, which have functions of these names:
// argument-dependent lookup finds GLM's. A word before the name (`Mat4 inverse(`) makes it a declaration, `x.`
// and `x::` somebody else's function.
void check_glm(const Source& source, std::vector<std::string>& faults) {
  if (!source.path.starts_with("nodes/")) return;
  static const std::regex unsafe(
      R"re(\bglm[ \t]*::[ \t]*(normalize|inverse|affineInverse|inverseTranspose|lookAt\w*|clamp|hsvColor)re"
      R"re(|rgbColor|slerp|angle|orientedAngle|fastNormalize)\b)re"
      R"re(|\busing[ \t]+namespace[ \t]+glm\b)re"
      R"re(|(?:[^\w\s.:>]|->\s*\w+\s*\{|\breturn\b|\n)[ \t]*\b(normalize|inverse|lookAt|clamp)[ \t]*\()re");
  const std::string text = blanked(source.text, false);
  for (std::sregex_iterator it(text.begin(), text.end(), unsafe), end; it != end; ++it) {
    const auto name = (*it)[1].matched   ? (*it)[1].str()
                      : (*it)[2].matched ? (*it)[2].str()
                                         : "using namespace glm";
    if ((*it)[2].matched && source.path.starts_with("nodes/kernels/")) continue;
    const auto group = (*it)[1].matched ? 1 : (*it)[2].matched ? 2 : 0;
    faults.push_back(at(source, text, it->position(static_cast<std::size_t>(group))) + name +
                     ": GLM's is not safe at the edges; call nodes/kernels by its qualified name");
  }
}

std::vector<std::string> faults_of(const Source& source) {
  std::vector<std::string> faults;
  check_includes(source, faults);
  check_glm(source, faults);
  return faults;
}

std::vector<Source> sources_of_the_tree() {
  const fs::path root(FRUSTUM_SOURCE_DIR);
  std::vector<Source> sources;
  for (const char* top : {"nodes", "runtime"}) {
    if (!fs::exists(root / top)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
      const auto extension = entry.path().extension();
      if (!entry.is_regular_file() || (extension != ".h" && extension != ".cpp")) continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      sources.push_back({fs::relative(entry.path(), root).generic_string(), text.str()});
    }
  }
  return sources;
}

TEST(Includes, RunOneWayInTheWholeTree) {
  const auto sources = sources_of_the_tree();
  ASSERT_FALSE(sources.empty()) << "no source found under " << FRUSTUM_SOURCE_DIR;
  for (const Source& source : sources)
    for (const std::string& fault : faults_of(source)) ADD_FAILURE() << fault;
}

struct Case {
  std::string_view name;
  Source source;
  std::string_view fault;  // a part of the one message; empty: no fault
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class IncludesOf : public testing::TestWithParam<Case> {};

TEST_P(IncludesOf, JudgesAFileInMemory) {
  const auto faults = faults_of(GetParam().source);
  if (GetParam().fault.empty()) {
    EXPECT_THAT(faults, testing::IsEmpty());
  } else {
    EXPECT_THAT(faults, testing::ElementsAre(testing::HasSubstr(std::string(GetParam().fault))));
  }
}

const Case cases[] = {
    {"kernel_sees_runtime",
     {"nodes/kernels/a.h", "\n#include \"runtime/core/buffer.h\"\n"},
     "a.h:2: runtime/core"},
    {"algorithm_sees_buffers", {"nodes/clip/a.h", "#include \"runtime/buffers/mesh.h\""}, "a.h:1:"},
    {"node_sees_another_node",
     {"nodes/clip/a.cpp", "#include \"nodes/cull/b.h\""},
     "nodes/cull/b.h is not below"},
    {"node_sees_another_family", {"nodes/clip/a.cpp", "#include \"nodes/cull.h\""}, "is not below"},
    {"node_sees_all_nodes", {"nodes/clip/a.cpp", "#include \"nodes/all_nodes.h\""}, "is not below"},
    {"algorithm_sees_the_runtime", {"nodes/clip/a.h", "#include \"nodes/clip.h\""}, "is not below"},
    {"node_sees_graph", {"nodes/clip/a.cpp", "#include \"runtime/graph/plan.h\""}, "runtime/graph/plan.h"},
    {"core_sees_graph", {"runtime/core/a.h", "#include \"runtime/graph/plan.h\""}, "runtime/graph/plan.h"},
    {"graph_sees_buffers", {"runtime/graph/a.cpp", "#include \"runtime/buffers/mesh.h\""}, "is not below"},
    {"app_sees_one_node", {"runtime/app/a.cpp", "#include \"nodes/clip/homogeneous.h\""}, "is not below"},
    {"cli_sees_nodes", {"runtime/cli/a.cpp", "#include <nodes/all_nodes.h>"}, "nodes/all_nodes.h"},
    {"cli_sees_io", {"runtime/cli/a.cpp", "#include \"runtime/io/image.h\""}, "runtime/io/image.h"},
    {"unknown_folder", {"runtime/misc/a.cpp", "#include \"runtime/core/a.h\""}, "no layer"},
    {"relative_path", {"nodes/clip/a.cpp", "#include \"../cull/b.h\""}, "does not start at the root"},
    {"spaced_out", {"runtime/core/a.h", "#if 1\n  #  include   \"nodes/clip/a.h\"\n#endif"}, "a.h:2:"},
    {"json_in_a_header", {"runtime/core/a.h", "#include <nlohmann/json.hpp>"}, "in a header"},
    {"oiio_in_a_node", {"nodes/io/a.cpp", "#include <OpenImageIO/imageio.h>"}, "runtime/io/oiio/ only"},
    {"oiio_in_io", {"runtime/io/a.cpp", "#include <OpenImageIO/imageio.h>"}, "runtime/io/oiio/ only"},
    {"ocio_in_a_header", {"runtime/io/a.h", "#include <OpenColorIO/OpenColorIO.h>"}, "in a header"},
    {"embree_in_a_header", {"nodes/trace/a.h", "#include <embree3/rtcore.h>"}, "in a header"},
    {"embree_in_runtime", {"runtime/app/a.cpp", "#include <embree3/rtcore.h>"}, "nodes/ only"},
    {"highway_in_a_node", {"nodes/clip/a.cpp", "#include <hwy/highway.h>"}, "nodes/kernels/ only"},
    {"glm_normalize", {"nodes/clip/a.cpp", "auto n = glm::normalize(v);"}, "normalize: GLM"},
    {"glm_as_a_value", {"nodes/clip/a.h", "\n\nauto f = &glm :: inverse<4>;"}, "a.h:3: inverse"},
    {"glm_look_at", {"nodes/scene/a.cpp", "return glm::lookAtRH(a, b, c);"}, "lookAtRH"},
    {"glm_by_lookup", {"nodes/clip/a.cpp", "auto m = inverse(eye_from_world);"}, "inverse"},
    {"glm_by_lookup_returned", {"nodes/clip/a.cpp", "return clamp(v, lo, hi);"}, "clamp"},
    {"glm_by_lookup_after_a_string", {"nodes/clip/a.cpp", "f(\"a // b\", normalize (v));"}, "normalize"},
    {"glm_after_a_digit_separator", {"nodes/clip/a.cpp", "f(1'000, normalize(v), 1'0);"}, "normalize"},
    {"glm_in_a_kernel", {"nodes/kernels/a.h", "return glm::normalize(v);"}, "normalize"},
    {"own_inverse_in_a_kernel", {"nodes/kernels/a.h", "return inverse(m);"}, ""},
    {"glm_hsv", {"nodes/color/a.cpp", "auto c = glm::hsvColor(grey);"}, "hsvColor"},
    {"glm_slerp", {"nodes/transform/a.cpp", "auto q = glm::slerp(a, b, t);"}, "slerp"},
    {"glm_namespace", {"nodes/clip/a.cpp", "using namespace glm;"}, "using namespace glm"},
    {"oracle_in_a_kernel", {"nodes/kernels/a.cpp", "#include <mpfr.h>"}, "tests/hard/ only"},
    {"good_kernel",
     {"nodes/kernels/simd/a.cpp", "#include <hwy/highway.h>\n#include \"nodes/kernels/b.h\""},
     ""},
    {"good_node",
     {"nodes/clip/a.cpp",
      "#include \"nodes/clip/a.h\"\n#include \"nodes/clip.h\"\n#include \"nodes/kernels/vec.h\"\n"
      "#include \"runtime/buffers/mesh.h\"\n#include <nlohmann/json.hpp>\n#include <glm/vec3.hpp>\n"},
     ""},
    {"good_calls",
     {"nodes/clip/a.cpp",
      "n = kernels::normalize(v); x = std::clamp(x, 0, 1); m.inverse(); Mat4 inverse(Mat4 m); p->clamp(1);"},
     ""},
    {"commented_out",
     {"nodes/clip/a.cpp",
      "// #include \"runtime/graph/plan.h\"\n/* glm::inverse(m)\n#include \"runtime/app/a.h\" */\n"
      "auto s = \"glm::clamp\", r = R\"x(glm::lookAt \" )x\"; char q = '\"'; auto t = \"glm::clamp\";"},
     ""},
    {"good_reader", {"nodes/io/a.h", "#include \"runtime/buffers/mesh.h\""}, ""},
    {"reader_sees_graph", {"nodes/io/a.h", "#include \"runtime/graph/plan.h\""}, "is not below nodes/io/*.h"},
    {"good_oiio",
     {"runtime/io/oiio/a.cpp", "#include <OpenImageIO/imageio.h>\n#include \"runtime/io/oiio/a.h\""},
     ""},
    {"good_cli", {"runtime/cli/main.cpp", "#include <CLI/CLI.hpp>\n#include \"runtime/app/session.h\""}, ""},
};

INSTANTIATE_TEST_SUITE_P(Layout, IncludesOf, testing::ValuesIn(cases),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
