// One graph file as it was written: its structure checked, every name in it resolved, nothing bound to values yet.
#pragma once

#include "runtime/core/context.h"
#include "runtime/core/registry.h"
#include "runtime/core/sink.h"
#include "runtime/graph/source_text.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

namespace frustum {

struct Document;

// One end of a connection: "node.port", "node", "$input" or {"value": ...}. What none of the three is set in is wrong and
// was reported.
struct Link {
  std::string pointer;
  std::string text;                      // "cut.mesh", for messages
  std::optional<std::size_t> node = {};  // of Document::nodes
  std::size_t port = 0;  // of the node's outputs: of its type, or of Document::outputs of its graph
  std::optional<std::size_t> input = {};  // of Document::inputs
  const Json* literal = nullptr;
};

// What one input of a node is given.
struct Binding {
  std::size_t input = 0;  // of the node's inputs: of its type, or of Document::inputs of its graph
  std::string pointer;
  std::vector<Link> links;
};

struct WrittenParam {
  std::string name;  // of a parameter; of an override its address, "lit:interpolation"
  std::string pointer;
  const Json* value = nullptr;
};

struct DocumentNode {
  std::string id, pointer;
  const NodeType* type = nullptr;  // exactly one of these two, or none where that is wrong
  std::shared_ptr<const Document> graph = {};
  std::vector<Binding> inputs = {};
  std::vector<WrittenParam> params = {}, overrides = {};
  std::optional<Precision> precision = {};
  bool used = false;  // a link names it
};

// An input that the graph has when it is used as a node.
struct DocumentInput {
  std::string name, pointer;
  const BufferType* kind = nullptr;  // null where it is wrong
  bool list = false, optional = false, used = false;
};

struct DocumentLayer {
  std::string name;
  Link from;
};

struct DocumentOutput {
  std::string name, pointer;
  std::vector<DocumentLayer> layers = {};
  bool layered = false;   // written as "layers": no port
  std::string file = {};  // empty: only a port
  bool whole = false;     // the file holds a whole buffer and is no picture
  int bits = 0;
  std::string compression = {};
};

struct Document {
  std::shared_ptr<const SourceText> text;
  std::string folder;  // what relative paths start from
  std::string title;
  std::optional<Precision> precision;
  std::uint64_t seed = 0;
  std::vector<WrittenParam> params;
  std::vector<DocumentInput> inputs;
  std::vector<DocumentNode> nodes;
  std::vector<DocumentOutput> outputs;
  std::unordered_map<std::string, std::size_t> node_index;
  std::set<std::string, std::less<>> params_used;  // by "$name"
  std::size_t levels = 1;  // of graphs used as nodes, one inside the other, this one counted

  const std::string& file() const { return text->file(); }
  const WrittenParam* find_param(std::string_view name) const;
};

// Every address of a parameter: "samples", "lit:interpolation", "draw:samples", "draw/lit:interpolation".
std::vector<std::string> param_addresses(const Document&);
bool has_param_address(const Document&, std::string_view address);

// Adds a problem at `pointer` of a document with its place; at the key where `at_key`. Related places that name no file are
// placed in the same document.
void report(Diagnostics&, const SourceText&, Diagnostic, bool at_key = false);

// A value as a message may quote it: its JSON, cut to 60 characters.
std::string quoted_json(const Json&);

// Kinds of buffers by name: all that the registry's ports carry.
using Kinds = std::map<std::string, const BufferType*, std::less<>>;

// Opens graph files, each once, and those that they use as nodes.
class Documents {
 public:
  Documents(const Registry&, std::vector<std::string> library_folders, Diagnostics&, SavedAs = {});

  // `path` names the text in messages and is what its relative files start from.
  std::shared_ptr<const Document> read(std::string text, const std::string& path);
  // A file named by a graph: "lib:raster", or a path from `folder`. What is wrong is reported at `pointer` of `user`; null then.
  std::shared_ptr<const Document> open(const std::string& name, const std::string& folder,
                                       const SourceText& user, const std::string& pointer);

  const Registry& registry() const { return registry_; }
  const Kinds& kinds() const { return kinds_; }
  Diagnostics& problems() { return problems_; }
  // The extensions of files that a buffer of a kind can be saved as.
  std::vector<std::string> saved_as(const BufferType& kind) const {
    return saved_as_ ? saved_as_(kind) : std::vector<std::string>();
  }

  // nearest_names among `known()`, which is called only while there is work left: of ten thousand unknown
  // names among ten thousand known ones only the first have suggestions.
  std::vector<std::string> suggestions(std::string_view name,
                                       const std::function<std::vector<std::string>()>& known);

  // Graphs stand inside each other at most so deep, so that what walks down them needs a bounded stack.
  static constexpr std::size_t max_levels = 256;

 private:
  // Where `levels` more below the files being read are too many: reports that, and true.
  bool too_deep(std::size_t levels, const std::string& name, const SourceText& user,
                const std::string& pointer);
  std::string find_library(std::string_view name) const;
  std::vector<std::string> library_names() const;

  const Registry& registry_;
  std::vector<std::string> library_folders_;
  Diagnostics& problems_;
  SavedAs saved_as_;
  Kinds kinds_;
  std::size_t letters_left_ = 100'000'000;  // to compare for suggestions: about a second
  std::map<std::string, std::shared_ptr<const Document>> opened_;  // by canonical path
  std::vector<std::pair<std::string, std::string>> opening_;       // canonical path and name, outermost first
};

}  // namespace frustum
