#include "runtime/io/buffer_files.h"

#include "runtime/core/error.h"
#include "runtime/core/partial_file.h"
#include "runtime/io/deep_files.h"
#include "runtime/io/mesh_writers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace frustum {
namespace {

constexpr std::size_t block_rows = 4096;

std::string cell(const Json& value) {
  if (value.is_null()) return "";
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

// Text that is no UTF-8 (names out of files) loses the bytes that are not.
std::string dump(const Json& j) { return j.dump(-1, ' ', false, Json::error_handler_t::replace); }

// Calls row(cells) for every row of the table form, a block at a time; returns the names of the columns.
template <class Head, class Row>
void for_rows(const Buffer& buffer, const PartialFile& file, const Context& ctx, Head&& head, Row&& row) {
  std::size_t total = 1;
  for (std::size_t first = 0; first < total || first == 0; first += block_rows) {
    const Json block = buffer.type().table(buffer.data(), first, block_rows);
    total = block.at("total").get<std::size_t>();
    if (first == 0) head(block.at("columns"), total);
    for (const Json& cells : block.at("rows")) row(cells);
    file.check();  // a full disk ends it here
    ctx.poll();
  }
}

void write_csv(const Buffer& buffer, PartialFile& file, const Context& ctx) {
  for_rows(
      buffer, file, ctx, [&](const Json& columns, std::size_t) { file.add(csv_row(columns)); },
      [&](const Json& cells) { file.add(csv_row(cells)); });
}

void write_json(const Buffer& buffer, const SaveRequest& request, PartialFile& file, const Context& ctx) {
  Json head = {{"format", "frustum.buffer/1"}, {"type", buffer.type().name}};
  for (const auto& [key, value] : request.metadata)
    head[key == "frustum:graph" ? "graph" : key == "ImageDescription" ? "title" : "program"] = value;
  head["summary"] = buffer.type().summary(buffer.data());
  std::string text = dump(head);
  text.pop_back();
  file.add(text);
  if (buffer.type().table != nullptr) {
    bool first = true;
    for_rows(
        buffer, file, ctx,
        [&](const Json& columns, std::size_t total) {
          file.add(fmt::format(",\n\"columns\":{},\n\"total\":{},\n\"rows\":[\n", dump(columns), total));
        },
        [&](const Json& cells) {
          file.add((first ? "" : ",\n") + dump(cells));
          first = false;
        });
    file.add("\n]");
  }
  file.add("}\n");
}

}  // namespace

std::string csv_row(const Json& cells) {
  std::string out;
  for (const Json& c : cells) out += (&c == &cells.front() ? "" : ",") + cell(c);
  return out + "\r\n";
}

std::vector<std::string> saved_as(const BufferType& kind) {
  std::vector<std::string> out;
  if (&kind == &buffer_type<Mesh>()) out = {"ply", "obj", "glb", "gltf"};
  if (&kind == &buffer_type<Fragments>()) out = {"exr"};
  if (kind.table != nullptr) out.emplace_back("csv");
  out.emplace_back("json");
  return out;
}

void save_buffer_file(const Buffer& buffer, const SaveRequest& request, Context& ctx) {
  std::string kind = std::filesystem::path(request.path).extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (!kind.empty()) kind.erase(0, 1);
  const std::vector<std::string> known = saved_as(buffer.type());
  if (std::find(known.begin(), known.end(), kind) == known.end())
    throw NodeError("unknown_format", fmt::format("{}: a {} is saved as {}", request.path, buffer.type().name,
                                                  fmt::join(known, ", ")));
  if (kind == "exr") return write_deep_file(*buffer.as<Fragments>(), request, ctx);
  PartialFile file(request.path);
  if (kind == "json")
    write_json(buffer, request, file, ctx);
  else if (kind == "csv")
    write_csv(buffer, file, ctx);
  else
    write_mesh(*buffer.as<Mesh>(), kind, request, file, ctx);
  ctx.poll();
  file.commit();
}

}  // namespace frustum
