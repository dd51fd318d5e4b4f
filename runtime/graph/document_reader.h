// From the JSON of one graph file to a Document. Nothing outside runtime/graph/document*.cpp includes this.
#pragma once

#include "runtime/graph/document.h"

#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

struct PictureFormat;

class DocumentReader {
 public:
  DocumentReader(Documents& documents, std::shared_ptr<const SourceText> text, std::string folder);
  // Null where the text is no graph at all.
  std::shared_ptr<const Document> read();

 private:
  // ----- the top of the file (document_reader.cpp)
  bool read_format(const Json& file);
  void read_params(const Json& file);
  void read_inputs(const Json& file);
  void read_input(const std::string& name, const Json& j, const std::string& pointer);

  // ----- nodes (document_nodes.cpp)
  void read_nodes(const Json& file);
  void read_node(DocumentNode&, const Json&);
  void read_node_type(DocumentNode&, const Json&);
  void read_node_params(DocumentNode&, const Json&);
  void read_overrides(DocumentNode&, const Json&);
  void read_bindings(DocumentNode&, const Json&);
  void read_binding(DocumentNode&, Binding, const Json&, bool list);
  std::vector<std::string> unknown_input(const DocumentNode&, const std::string& name, const std::string& at,
                                         const std::vector<std::string>& names);
  void check_dollars(const Json& value, const std::string& pointer);
  // What a wrong part of the file seems to read is not reported as read by nothing.
  void mark_used(const Json& links);
  void mark_used(const std::string& id);

  // ----- links, once all nodes are known (document_links.cpp)
  Link read_link(const Json&, const std::string& pointer, bool literals);
  void resolve_links();
  void resolve(Link&, bool list);
  void resolve_input(Link&, bool list);
  void resolve_port(Link&, const DocumentNode&, std::string_view port);

  // ----- outputs (document_outputs.cpp)
  void read_outputs(const Json& file);
  void read_output(DocumentOutput&, const Json&);
  void read_layers(DocumentOutput&, const Json&);
  void read_file(DocumentOutput&, const Json&);
  bool check_file_name(const DocumentOutput&);  // false where it names no file
  void check_format(DocumentOutput&, const Json&);
  bool check_buffer_format(const DocumentOutput&, const std::string& extension);
  void check_bits(DocumentOutput&, const Json&, const PictureFormat&);
  void check_compression(DocumentOutput&, const Json&, const PictureFormat&);
  void check_same_files();

  // ----- reports
  void problem(Diagnostic d, bool at_key = false) {
    report(documents_.problems(), *doc_->text, std::move(d), at_key);
  }
  void wrong_type(const std::string& pointer, std::string expected, const Json& got);
  void missing_key(const std::string& pointer, std::string_view key, std::string_view of);
  void unknown_keys(const Json& object, const std::string& pointer,
                    std::initializer_list<std::string_view> known, std::string_view of);
  // The member if it is there and of that type; null, and reported, where it is of another.
  const Json* object_at(const Json&, std::string_view key, const std::string& pointer);
  const Json* text_at(const Json&, std::string_view key, const std::string& pointer);
  bool bool_at(const Json&, std::string_view key, const std::string& pointer);
  bool good_id(const std::string& id, const std::string& pointer, std::string_view what);
  std::optional<Precision> read_precision(const Json&, const std::string& pointer);

  Documents& documents_;
  std::shared_ptr<Document> doc_;
  std::vector<std::string> also_used_;      // ids
  std::vector<std::string> dollar_params_;  // "$name" of every graph parameter
};

// Calls `visit` for every text in a value that stands for a graph parameter: "$name", and not "$$...", which is a '$' of
// the text itself.
using VisitDollar = std::function<void(const std::string& text, const std::string& pointer)>;
void each_dollar(const Json& value, const std::string& pointer, const VisitDollar& visit);

// "one of: a, b", for what was expected.
std::string one_of(std::span<const std::string> names);

// "a graph as a node", or the quoted name of its type.
std::string kind_of(const DocumentNode&);

}  // namespace frustum
