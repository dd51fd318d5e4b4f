// What is wrong with the user's input, as data.
//
// A user's mistake is never an exception, a log line or a silent default: it is one Diagnostic, and all of a
// document's diagnostics are collected in one pass. Codes are stable and each has a section in docs/diagnostics.md.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

using Json = nlohmann::ordered_json;

enum class Severity { error, warning };

// Another place that the problem involves, such as the far end of a bad link.
struct Related {
  std::string pointer;
  std::string message;
  int line = 0, column = 0;
  std::string file = {};  // empty: the diagnostic's own file
};

struct Diagnostic {
  std::string code;  // snake_case, stable: "unknown_type"
  Severity severity = Severity::error;
  std::string pointer;  // RFC 6901, into `file`
  std::string message;  // one sentence without a full stop
  std::string expected = {}, got = {};
  std::vector<std::string> suggestions = {};
  std::vector<Related> related = {};
  std::string file = {};     // as the user would name it; empty for a document without a file
  int line = 0, column = 0;  // 1-based; 0 where the document has no text
};

class Diagnostics {
 public:
  void add(Diagnostic d) { list_.push_back(std::move(d)); }
  void add(const Diagnostics& more);
  bool has_errors() const;
  bool empty() const { return list_.empty(); }
  std::size_t size() const { return list_.size(); }
  const std::vector<Diagnostic>& list() const { return list_; }
  std::vector<Diagnostic>& list() { return list_; }

 private:
  std::vector<Diagnostic> list_;
};

// The text form, one block a diagnostic; of a code and severity 20 blocks, then a line that counts the rest:
//   error[unknown_type] teapot.json:17:24 /nodes/cut/type
//     'clip.homogenous' is not a node type
//     did you mean 'clip.homogeneous'?
std::string to_text(const Diagnostics&, bool color = false);

// {"diagnostics": [{code, severity, file, pointer, line, column, message, expected, got, suggestions, related}]}
Json to_json(const Diagnostics&);

// `pointer` with one more reference token, escaped by RFC 6901 ('~' -> "~0", '/' -> "~1").
std::string child_pointer(std::string_view pointer, std::string_view key);
std::string child_pointer(std::string_view pointer, std::size_t index);

// At most three names, nearest first, none more than one edit farther than the first (a swap of neighbours is one edit).
// Near are those within max(1, length / 3) edits that is_near (diagnostic.cpp) takes for meant. Where none is, the shortest
// name that begins with `name`, if three letters of its last part are there; else empty.
std::vector<std::string> nearest_names(std::string_view name, std::span<const std::string> known);

}  // namespace frustum
