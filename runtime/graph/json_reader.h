// The recursive descent behind SourceText::read. Nothing else includes this.
#pragma once

#include "runtime/graph/source_text.h"

#include <optional>
#include <string>
#include <string_view>

namespace frustum {

class JsonReader {
 public:
  JsonReader(SourceText& out, Diagnostics& problems) : out_(out), text_(out.text_), problems_(problems) {}
  void read_document();

 private:
  static bool is_word_char(char c);
  // ----- characters
  bool at_end() const { return pos_ >= text_.size(); }
  char peek() const { return at_end() ? '\0' : text_[pos_]; }
  bool starts_with(std::string_view word) const { return text_.substr(pos_).starts_with(word); }
  // The column is what stands before on the line, less the continuation bytes of UTF-8.
  TextPlace here() const { return {line_, static_cast<int>(pos_ - line_start_ - continuation_) + 1}; }
  void new_line();
  // Takes one code point; bytes that are no UTF-8 are taken one by one, reported, and appended as U+FFFD.
  void take_code_point(std::string* append);
  void skip_space();
  void skip_comment();
  std::string_view take_word();

  // ----- values
  Json read_value();
  Json read_object();
  Json read_array();
  Json read_number();
  Json read_word();
  std::string read_string();
  void read_escape(std::string& out);
  std::optional<unsigned> read_hex4();
  bool read_member(Json& object);
  // After an element: true where another one follows. Reports what stands there instead of a comma.
  bool another(char close, TextPlace opened);
  bool too_deep();

  // ----- problems
  // Null where reading has stopped: what follows from a problem is none.
  Diagnostic* problem(std::string code, TextPlace at, std::string message, std::string expected,
                      std::string got);
  // As problem(), and nothing after it is read.
  Diagnostic* stop(std::string code, TextPlace at, std::string message, std::string expected,
                   std::string got);
  void stop_at_end(std::string_view inside, TextPlace opened);
  std::string shown_here() const;

  SourceText& out_;
  std::string_view text_;
  Diagnostics& problems_;
  std::size_t pos_ = 0, line_start_ = 0, continuation_ = 0;
  int line_ = 1, depth_ = 0, reported_ = 0;
  bool stopped_ = false;
  std::uint32_t item_ = 0;  // the value being read
};

}  // namespace frustum
