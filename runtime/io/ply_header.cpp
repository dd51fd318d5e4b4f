#include "runtime/io/ply_header.h"

#include "runtime/core/error.h"
#include "runtime/io/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <utility>

namespace frustum::ply {
namespace {

constexpr std::array<std::pair<std::string_view, Number>, 16> types{{{"char", Number::i8},
                                                                     {"int8", Number::i8},
                                                                     {"uchar", Number::u8},
                                                                     {"uint8", Number::u8},
                                                                     {"short", Number::i16},
                                                                     {"int16", Number::i16},
                                                                     {"ushort", Number::u16},
                                                                     {"uint16", Number::u16},
                                                                     {"int", Number::i32},
                                                                     {"int32", Number::i32},
                                                                     {"uint", Number::u32},
                                                                     {"uint32", Number::u32},
                                                                     {"float", Number::f32},
                                                                     {"float32", Number::f32},
                                                                     {"double", Number::f64},
                                                                     {"float64", Number::f64}}};

class HeaderReader {
 public:
  HeaderReader(std::string_view text, const FilePath& file) : text_(text), file_(file) {}

  Header run() {
    find_line_end();
    if (next_line() != "ply") fail("it does not begin with a line 'ply'");
    bool format = false;
    for (;;) {
      if (at_ >= text_.size()) fail("the header has no 'end_header'");
      rest_ = next_line();
      const std::string_view key = word();
      if (key == "end_header") break;
      if (key == "format") {
        read_format();
        format = true;
      } else if (key == "element") {
        read_element();
      } else if (key == "property") {
        read_property();
      } else if (key == "comment") {
        if (word() == "TextureFile") header_.textures.emplace_back(word());
      } else if (key != "obj_info" && !key.empty()) {
        fail(fmt::format("'{}' is not a line of a PLY header", printable(key)));
      }
    }
    if (!format) fail("the header has no 'format'");
    header_.bytes = at_;
    header_.line_end = end_.back();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(std::string_view what) const {
    throw NodeError("malformed_file",
                    fmt::format("{}:{}: {}", file_.written, std::max<std::size_t>(line_, 1), what));
  }

  void find_line_end() {
    const std::size_t at = text_.find_first_of("\r\n");
    if (at == std::string_view::npos) fail("it does not begin with a line 'ply'");
    end_ = text_[at] == '\n' ? "\n" : text_.substr(at, 2) == "\r\n" ? "\r\n" : "\r";
  }

  std::string_view next_line() {
    ++line_;
    const std::size_t stop = text_.find(end_, at_);
    if (stop == std::string_view::npos) fail("the header has no 'end_header'");
    std::string_view line = text_.substr(at_, stop - at_);
    at_ = stop + end_.size();
    if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
    return line;
  }

  std::string_view word() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size()));
    const std::string_view out = rest_.substr(0, rest_.find_first_of(" \t"));
    rest_.remove_prefix(out.size());
    return out;
  }

  void read_format() {
    const std::string_view name = word(), version = word();
    if (name == "ascii")
      header_.encoding = Encoding::ascii;
    else if (name == "binary_little_endian")
      header_.encoding = Encoding::little_endian;
    else if (name == "binary_big_endian")
      header_.encoding = Encoding::big_endian;
    else
      fail(fmt::format("'{}' is not a format: ascii, binary_little_endian or binary_big_endian",
                       printable(name)));
    if (version != "1.0") fail(fmt::format("version '{}' is not known: 1.0 is", printable(version)));
  }

  void read_element() {
    Element e{.name = std::string(word())};
    const std::string_view count = word();
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), e.rows);
    if (e.name.empty() || error != std::errc() || end != count.data() + count.size() || count.empty())
      fail(fmt::format("'{}' is not how many elements there are", printable(count)));
    if (!element_names_.insert(e.name).second)
      fail(fmt::format("there are two elements '{}'", printable(e.name)));
    header_.elements.push_back(std::move(e));
    property_names_.clear();
  }

  Number type(std::string_view name) const {
    for (const auto& [known, number] : types)
      if (known == name) return number;
    fail(fmt::format("'{}' is not a type of numbers", printable(name)));
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property stands before the first element");
    Property p;
    std::string_view first = word();
    if (first == "list") {
      p.count = type(word());
      if (is_real(*p.count)) fail("the length of a list is a whole number");
      first = word();
    }
    p.type = type(first);
    p.name = word();
    if (p.name.empty()) fail("a property has no name");
    if (!property_names_.insert(p.name).second)
      fail(fmt::format("there are two properties '{}'", printable(p.name)));
    header_.elements.back().properties.push_back(std::move(p));
  }

  std::string_view text_;
  const FilePath& file_;
  std::string_view end_, rest_;
  std::size_t at_ = 0, line_ = 0;
  std::set<std::string, std::less<>> element_names_, property_names_;
  Header header_;
};

template <class List>
std::optional<std::size_t> find_name(const List& list, std::string_view name) {
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].name == name) return i;
  return {};
}

}  // namespace

std::size_t bytes_of(Number n) {
  constexpr std::array<std::size_t, 8> bytes{1, 1, 2, 2, 4, 4, 4, 8};
  return bytes[static_cast<std::size_t>(n)];
}

std::optional<std::size_t> Element::find(std::string_view property) const {
  return find_name(properties, property);
}

bool Element::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const Property& p) { return p.count; });
}

std::size_t Element::least_bytes() const {
  std::size_t sum = 0;
  for (const Property& p : properties) sum += bytes_of(p.count.value_or(p.type));
  return sum;
}

std::optional<std::size_t> Header::find(std::string_view element) const {
  return find_name(elements, element);
}

Header read_header(std::string_view bytes, const FilePath& file) { return HeaderReader(bytes, file).run(); }

}  // namespace frustum::ply
