#include "tests/fuzz/support/check.h"

#include "runtime/buffers/numbers.h"
#include "tests/fuzz/support/target.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace frustum::fuzz {
namespace {

// A sentence quotes at most a few names, each cut to about a line.
constexpr std::size_t longest_sentence = 4096;

// The JSON forms take longer than most readings, and every eighth value shows as well what they cannot say.
bool takes_long_checks(std::string_view content) { return std::hash<std::string_view>()(content) % 8 == 0; }

void check_column(const Column& c) {
  const bool direction = c.name() == "normal";
  if (!direction && c.name() != "position") return;
  // Files hold floats, and what is as unit as floats are is kept bit for bit in both precisions: |n|^2 within 2^-20.
  constexpr double tolerance = 1e-6;
  for (std::size_t row = 0; row < c.rows(); ++row) {
    const double x = c.number(row, 0), y = c.number(row, 1), z = c.number(row, 2);
    require(std::isfinite(x) && std::isfinite(y) && std::isfinite(z),
            fmt::format("{} {} is not finite", c.name(), row));
    require(!direction || std::abs(std::hypot(x, y, z) - 1) <= tolerance,
            fmt::format("normal {} has length {}", row, std::hypot(x, y, z)));
  }
}

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check_material(const Material& m) {
  require(finite(m.ambient) && finite(m.diffuse) && finite(m.specular) && finite(m.emission),
          "a colour of a material is not finite");
  require(std::isfinite(m.shininess) && m.shininess >= 0, "a shininess is not finite, or negative");
  for (glm::length_t k = 0; k < 3; ++k) require(finite(m.texture_from_uv[k]), "a texture lies nowhere");
}

}  // namespace

void check_mesh(const Mesh& mesh) {
  require(mesh.validate().empty(), mesh.validate());
  if (mesh.materials)
    for (const Material& material : mesh.materials->materials) check_material(material);
  for (const Ref<Column>& column : mesh.columns) check_column(*column);
  const Buffer buffer(std::make_shared<const Mesh>(mesh));
  require(buffer.bytes() != 0, "a mesh takes no bytes");
  buffer.health();
  if (!takes_long_checks(to_hex(buffer.digest()))) return;
  buffer.type().summary(buffer.data());
  const Json table = buffer.type().table(buffer.data(), 0, 3);
  for (const Json& row : table["rows"])
    require(row.size() == table["columns"].size(), "a row of the table has holes");
}

void check_sentence(std::string_view code, std::string_view sentence) {
  require(!code.empty() &&
              code.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789") == std::string_view::npos,
          fmt::format("'{}' is no code", code));
  require(!sentence.empty(), fmt::format("{} says nothing", code));
  require(sentence.size() <= longest_sentence, fmt::format("{} takes {} bytes", code, sentence.size()));
}

void check_problems(const Diagnostics& problems, const std::string& file, std::string_view text) {
  const auto lines = 1 + std::count(text.begin(), text.end(), '\n');
  for (const Diagnostic& d : problems.list()) {
    check_sentence(d.code, d.message);
    if (d.file != file) continue;
    require(d.line >= 1 && d.line <= lines && d.column >= 1,
            fmt::format("{} stands at {}:{} of {} lines", d.code, d.line, d.column, lines));
    require(static_cast<std::size_t>(d.column) <= text.size() + 1,
            fmt::format("{} stands in column {} of {} bytes", d.code, d.column, text.size()));
  }
  if (!takes_long_checks(text)) return;
  require(to_text(problems).empty() == problems.empty(), "the text form is empty");
  require(to_json(problems).at("diagnostics").size() == problems.size(), "the JSON form has other problems");
}

void reading(const FilePath& file, const std::function<void(Context&)>& read, std::string_view beside) {
  Context ctx;
  const auto check = [&](const std::string& code, std::string_view message) {
    check_sentence(code, message);
    require(message.find(file.written) != std::string_view::npos ||
                (!beside.empty() && message.find(beside) != std::string_view::npos),
            fmt::format("{} does not name the file: {}", code, message));
  };
  try {
    read(ctx);
  } catch (const NodeError& e) {
    check(e.code, e.what());
  } catch (const WorldError& e) {
    require(e.code != "out_of_memory", e.what());
    if (e.code != "no_image_module") check(e.code, e.what());
  }
  for (const auto& [code, message] : ctx.warnings()) check(code, message);
}

void read_mesh(Mesh (*read)(std::string_view, const FilePath&, Context&), std::string_view input,
               const FilePath& file, std::string_view beside) {
  reading(
      file,
      [&](Context& ctx) {
        ctx.precision = input.size() % 2 == 0 ? Precision::single : Precision::real_double;
        check_mesh(read(input, file, ctx));
      },
      beside);
}

}  // namespace frustum::fuzz
