#include "runtime/graph/source_text.h"

#include "runtime/graph/json_reader.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>

namespace frustum {
namespace {

// One reference token of an RFC 6901 pointer, unescaped: "a~1b" -> "a/b".
std::string unescape_token(std::string_view token) {
  std::string out;
  for (std::size_t i = 0; i < token.size(); ++i) {
    const bool escape = token[i] == '~' && i + 1 < token.size();
    out += escape ? (token[i + 1] == '1' ? '/' : '~') : token[i];
    if (escape) ++i;
  }
  return out;
}

}  // namespace

SourceText::SourceText(std::string text, std::string file)
    : text_(std::move(text)), file_(std::move(file)), json_(std::make_unique<Json>()) {}

SourceText::~SourceText() = default;

std::shared_ptr<const SourceText> SourceText::read(std::string text, std::string file,
                                                   Diagnostics& problems) {
  std::shared_ptr<SourceText> out(new SourceText(std::move(text), std::move(file)));
  JsonReader(*out, problems).read_document();
  return out;
}

const SourceText::Item& SourceText::find(std::string_view pointer) const {
  std::uint32_t at = 0;
  while (!pointer.empty()) {
    pointer.remove_prefix(1);
    const std::size_t end = std::min(pointer.find('/'), pointer.size());
    const std::string token = unescape_token(pointer.substr(0, end));
    pointer.remove_prefix(end);
    if (const auto array = elements_.find(at); array != elements_.end()) {
      std::size_t index = 0;
      const auto [last, error] = std::from_chars(token.data(), token.data() + token.size(), index);
      if (error != std::errc() || last != token.data() + token.size() || index >= array->second.size()) break;
      at = array->second[index];
    } else {
      const auto member = members_.find({at, token});
      if (member == members_.end()) break;
      at = member->second;
    }
  }
  return items_[at];
}

TextPlace SourceText::value_place(std::string_view pointer) const { return find(pointer).value; }
TextPlace SourceText::key_place(std::string_view pointer) const { return find(pointer).key; }

std::string SourceText::pointer_of(std::uint32_t item) const {
  std::vector<std::uint32_t> path;
  for (; item != 0; item = items_[item].parent) path.push_back(item);
  std::string out;
  for (auto i = path.rbegin(); i != path.rend(); ++i) {
    const Item& part = items_[*i];
    out = elements_.contains(part.parent) ? child_pointer(out, std::size_t{part.index})
                                          : child_pointer(out, part.name);
  }
  return out;
}

}  // namespace frustum
