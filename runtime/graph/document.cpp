#include "runtime/graph/document.h"

#include "runtime/core/error.h"
#include "runtime/core/missing_file.h"
#include "runtime/core/read_file.h"
#include "runtime/graph/document_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace frustum {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view library_prefix = "lib:";

// Suggestions look through so many addresses at most; a graph-as-node repeats those of its file.
constexpr std::size_t most_addresses = 100000;

void append_addresses(const Document& doc, const std::string& prefix, std::vector<std::string>& out) {
  for (const DocumentNode& node : doc.nodes) {
    if (out.size() > most_addresses) return;
    if (node.type != nullptr)
      for (const ParamField& f : node.type->params.fields)
        out.push_back(fmt::format("{}{}:{}", prefix, node.id, f.name));
    if (node.graph == nullptr) continue;
    for (const WrittenParam& p : node.graph->params)
      out.push_back(fmt::format("{}{}:{}", prefix, node.id, p.name));
    append_addresses(*node.graph, fmt::format("{}{}/", prefix, node.id), out);
  }
}

const DocumentNode* find_node(const Document& doc, std::string_view id) {
  const auto found = doc.node_index.find(std::string(id));
  return found != doc.node_index.end() ? &doc.nodes[found->second] : nullptr;
}

}  // namespace

const WrittenParam* Document::find_param(std::string_view name) const {
  const auto found =
      std::find_if(params.begin(), params.end(), [&](const WrittenParam& p) { return p.name == name; });
  return found != params.end() ? &*found : nullptr;
}

std::vector<std::string> param_addresses(const Document& doc) {
  std::vector<std::string> out;
  for (const WrittenParam& p : doc.params) out.push_back(p.name);
  append_addresses(doc, "", out);
  return out;
}

bool has_param_address(const Document& doc, std::string_view address) {
  const std::size_t colon = address.find(':');
  if (colon == std::string_view::npos) return doc.find_param(address) != nullptr;
  const Document* at = &doc;
  std::string_view path = address.substr(0, colon);
  const std::string_view param = address.substr(colon + 1);
  for (std::size_t slash; (slash = path.find('/')) != std::string_view::npos; path.remove_prefix(slash + 1)) {
    const DocumentNode* node = find_node(*at, path.substr(0, slash));
    if (node == nullptr || node->graph == nullptr) return false;
    at = node->graph.get();
  }
  const DocumentNode* node = find_node(*at, path);
  if (node == nullptr) return false;
  if (node->graph != nullptr) return node->graph->find_param(param) != nullptr;
  const auto has_name = [&](const ParamField& f) { return f.name == param; };
  return node->type != nullptr &&
         std::any_of(node->type->params.fields.begin(), node->type->params.fields.end(), has_name);
}

void report(Diagnostics& problems, const SourceText& text, Diagnostic d, bool at_key) {
  const TextPlace at = at_key ? text.key_place(d.pointer) : text.value_place(d.pointer);
  d.file = text.file();
  d.line = at.line;
  d.column = at.column;
  for (Related& r : d.related) {
    if (r.file == d.file) r.file.clear();
    if (!r.file.empty() || r.line != 0) continue;
    const TextPlace there = text.value_place(r.pointer);
    r.line = there.line;
    r.column = there.column;
  }
  problems.add(std::move(d));
}

std::string quoted_json(const Json& value) {
  // Of a long value only the first part is written out: messages cost no more than what they show.
  std::string s = value.is_structured() && value.size() > 30
                      ? (value.is_object() ? "{...}" : "[...]")
                      : value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (s.size() <= 60) return s;
  std::size_t end = 57;
  while (end > 0 && (static_cast<unsigned char>(s[end]) & 0xC0) == 0x80) --end;  // not within a code point
  return s.substr(0, end) + "...";
}

Documents::Documents(const Registry& registry, std::vector<std::string> library_folders,
                     Diagnostics& problems, SavedAs saved_as)
    : registry_(registry),
      library_folders_(std::move(library_folders)),
      problems_(problems),
      saved_as_(std::move(saved_as)) {
  const auto add = [this](const std::vector<Port>& ports) {
    for (const Port& port : ports)
      for (const BufferType* kind : port.types) kinds_.emplace(kind->name, kind);
  };
  for (const auto& [name, type] : registry_) add(type.inputs), add(type.outputs);
}

std::shared_ptr<const Document> Documents::read(std::string text, const std::string& path) {
  std::error_code error;
  opening_.emplace_back(fs::weakly_canonical(path, error).string(), path);
  const auto source = SourceText::read(std::move(text), path, problems_);
  auto doc = DocumentReader(*this, source, fs::path(path).parent_path().string()).read();
  opening_.pop_back();
  return doc;
}

std::vector<std::string> Documents::suggestions(std::string_view name,
                                                const std::function<std::vector<std::string>()>& known) {
  if (letters_left_ == 0) return {};
  const std::vector<std::string> names = known();
  letters_left_ -= std::min(letters_left_, names.size() * (name.size() * name.size() + 1));
  return nearest_names(name, names);
}

std::string Documents::find_library(std::string_view name) const {
  if (name.find_first_of("/.") != std::string_view::npos) return {};  // would lead out of the library
  std::error_code error;
  for (const std::string& folder : library_folders_) {
    const fs::path path = fs::path(folder) / fmt::format("{}.json", name);
    if (fs::is_regular_file(path, error)) return path.string();
  }
  return {};
}

std::vector<std::string> Documents::library_names() const {
  std::vector<std::string> names;
  for (const std::string& folder : library_folders_) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (entry.path().extension() == ".json")
        names.push_back(fmt::format("{}{}", library_prefix, entry.path().stem().string()));
  }
  std::sort(names.begin(), names.end());
  return names;
}

bool Documents::too_deep(std::size_t levels, const std::string& name, const SourceText& user,
                         const std::string& pointer) {
  if (opening_.size() + levels <= max_levels) return false;
  report(
      problems_, user,
      {.code = "too_deep",
       .pointer = pointer,
       .message = fmt::format("graphs used as nodes stand inside each other more than {} levels deep at '{}'",
                              max_levels, name),
       .expected = fmt::format("at most {} levels", max_levels),
       .got = name});
  return true;
}

namespace {

// Why a graph used as a node is not there.
std::string why_no_graph(const std::string& name, const std::string& path, bool library) {
  if (!library) return why_missing(path, name);
  if (name.find_first_of("/.", library_prefix.size()) != std::string::npos)
    return fmt::format("'{}' is not the name of a library graph: it has neither slashes nor dots", name);
  return path.empty() ? fmt::format("the library has no graph '{}'", name) : "";
}

}  // namespace

std::shared_ptr<const Document> Documents::open(const std::string& name, const std::string& folder,
                                                const SourceText& user, const std::string& pointer) {
  const bool library = name.starts_with(library_prefix);
  const std::string path = library ? find_library(std::string_view(name).substr(library_prefix.size()))
                                   : (fs::path(folder) / name).lexically_normal().string();
  if (std::string why = why_no_graph(name, path, library); !why.empty()) {
    std::vector<std::string> near;
    if (library)
      near = suggestions(name, [&] { return library_names(); });
    else if (problems_.size() < most_looked_beside)
      near = near_files(path, name);
    report(problems_, user,
           {.code = "missing_file",
            .pointer = pointer,
            .message = std::move(why),
            .expected = library ? "a graph of the library" : "a graph file",
            .got = name,
            .suggestions = std::move(near)});
    return nullptr;
  }
  std::error_code error;
  const std::string canonical = fs::weakly_canonical(path, error).string();
  if (const auto known = opened_.find(canonical); known != opened_.end()) {
    const bool deep = known->second != nullptr && too_deep(known->second->levels, name, user, pointer);
    return deep ? nullptr : known->second;
  }

  const auto same = [&](const auto& o) { return o.first == canonical; };
  if (const auto outer = std::find_if(opening_.begin(), opening_.end(), same); outer != opening_.end()) {
    std::string chain;
    for (auto o = outer; o != opening_.end(); ++o)
      chain += fmt::format("{} -> ", fs::path(o->second).filename().string());
    chain += fs::path(path).filename().string();
    report(problems_, user,
           {.code = "file_cycle",
            .pointer = pointer,
            .message = fmt::format("a graph cannot contain itself: {}", chain),
            .expected = "another graph",
            .got = name});
    return nullptr;
  }
  if (too_deep(1, name, user, pointer)) return nullptr;
  std::string text;
  try {
    text = read_file(path);
  } catch (const WorldError& e) {  // it is there: nothing is wrong with what the user wrote
    const TextPlace at = user.value_place(pointer);
    throw WorldError(e.code,
                     fmt::format("{}:{}:{} {}: {}", user.file(), at.line, at.column, pointer, e.what()));
  }
  auto doc = read(std::move(text), path);
  opened_.emplace(canonical, doc);
  return doc;
}

}  // namespace frustum
