// The text of a JSON document: its value, where every part of it stands, and everything that is wrong with it as text.
//
// A parser of its own because the library's keeps no positions, merges duplicate keys without a word, stops at the first
// error and takes time quadratic in the number of keys of an ordered object.
#pragma once

#include "runtime/core/diagnostic.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace frustum {

// 1-based; the column counts code points, a tab as one.
struct TextPlace {
  int line = 1, column = 1;
};

class SourceText {
 public:
  // Deeper brackets are an error: a graph needs about ten levels, and everything that walks a document may recurse.
  static constexpr int max_depth = 256;

  // Reads `text` by RFC 8259. What is wrong is added to `problems` with file, pointer and place:
  //   not_json       the text is no JSON; where the meaning is clear (a comment, a comma too many, a byte-order mark)
  //                  reading goes on, so that all such places are found
  //   duplicate_key  the first one counts
  //   not_finite     NaN, Infinity and numbers beyond a double; they read as 0
  //   too_deep       more than max_depth brackets inside each other
  // Never throws, for any bytes. Linear in time and memory; recursion is bounded by max_depth.
  static std::shared_ptr<const SourceText> read(std::string text, std::string file, Diagnostics& problems);
  ~SourceText();
  SourceText(const SourceText&) = delete;
  SourceText& operator=(const SourceText&) = delete;

  const std::string& file() const { return file_; }
  const Json& json() const { return *json_; }
  // Whether the whole text was understood; otherwise json() is null.
  bool complete() const { return complete_; }

  // Where a value starts; for a pointer that leads nowhere, the deepest part of it that exists.
  TextPlace value_place(std::string_view pointer) const;
  // Where the key of a member starts; for an array element and the whole document, the value.
  TextPlace key_place(std::string_view pointer) const;

 private:
  friend class JsonReader;
  struct Item {
    std::uint32_t parent;
    TextPlace key, value;
    std::string_view name;    // of a member; empty for elements
    std::uint32_t index = 0;  // of an element
  };
  struct MemberKey {
    std::uint32_t parent;
    std::string_view name;
    bool operator==(const MemberKey&) const = default;
  };
  struct MemberHash {
    std::size_t operator()(const MemberKey& k) const {
      return std::hash<std::string_view>()(k.name) ^ (k.parent * std::size_t{0x9E3779B97F4A7C15});
    }
  };

  SourceText(std::string text, std::string file);
  const Item& find(std::string_view pointer) const;
  std::string pointer_of(std::uint32_t item) const;

  std::string text_, file_;
  std::unique_ptr<Json> json_;
  bool complete_ = false;
  std::deque<std::string> unescaped_;  // names that are not spelled as they stand in the text
  std::vector<Item> items_;            // 0 is the document; parents stand before their children
  std::unordered_map<MemberKey, std::uint32_t, MemberHash> members_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> elements_;
};

}  // namespace frustum
