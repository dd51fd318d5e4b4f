#include "runtime/graph/json_reader.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace frustum {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string lower(std::string_view s) {
  std::string out(s);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace

void JsonReader::read_document() {
  out_.items_.push_back({.parent = 0, .key = {}, .value = {}, .name = {}});
  if (starts_with("\xEF\xBB\xBF")) {
    problem("not_json", here(), "the text starts with a byte-order mark", "UTF-8 without a byte-order mark",
            "a byte-order mark");
    pos_ += 3;
    line_start_ = pos_;
  }
  skip_space();
  out_.items_[0].key = out_.items_[0].value = here();
  if (at_end()) stop("not_json", here(), "the text is empty", "an object", "nothing");
  Json value = stopped_ ? Json() : read_value();
  skip_space();
  if (!at_end())
    stop("not_json", here(), fmt::format("'{}' follows after the end of the document", shown_here()),
         "the end of the text", shown_here());
  if (stopped_) return;
  *out_.json_ = std::move(value);
  out_.complete_ = true;
}

Json JsonReader::read_value() {
  out_.items_[item_].value = here();
  const char c = peek();
  if (c == '{') return read_object();
  if (c == '[') return read_array();
  if (c == '"') return read_string();
  if (c == '-' || c == '+' || c == '.' || is_digit(c)) return read_number();
  return read_word();
}

bool JsonReader::too_deep() {
  if (++depth_ <= SourceText::max_depth) return false;
  // Where the brackets begin says more than 256 times "/0".
  for (int i = depth_ - 1; i > 2; --i) item_ = out_.items_[item_].parent;
  const std::string limit = fmt::format("at most {} levels", SourceText::max_depth);
  stop("too_deep", out_.items_[item_].value,
       fmt::format("brackets stand inside each other more than {} levels deep", SourceText::max_depth), limit,
       "more");
  return true;
}

bool JsonReader::another(char close, TextPlace opened) {
  const std::string_view inside = close == '}' ? "an object" : "an array";
  skip_space();
  if (stopped_) return false;
  if (at_end()) return stop_at_end(inside, opened), false;
  if (peek() == close) return ++pos_, false;
  const TextPlace at = here();
  if (peek() != ',') {
    const bool value_follows =
        peek() == '"' || peek() == '{' || peek() == '[' || is_word_char(peek()) || peek() == '-';
    const std::string expected = fmt::format("',' or '{}'", close), got = shown_here();
    const auto report = value_follows ? &JsonReader::problem : &JsonReader::stop;
    (this->*report)("not_json", at, fmt::format("expected {}, got '{}'", expected, got), expected, got);
    return !stopped_;
  }
  ++pos_;
  skip_space();
  while (!stopped_ && (peek() == close || peek() == ',')) {
    const bool last = peek() == close;
    problem("not_json", at, fmt::format("nothing stands between ',' and '{}'", peek()),
            last ? "no comma" : "one comma", ",");
    ++pos_;
    if (last) return false;
    skip_space();
  }
  if (!stopped_ && at_end()) stop_at_end(inside, opened);
  return !stopped_;
}

bool JsonReader::read_member(Json& object) {
  const TextPlace at = here();
  const std::uint32_t parent = item_;
  std::string name;
  if (peek() == '"') {
    name = read_string();
  } else if (is_word_char(peek())) {
    name = take_word();
    problem("not_json", at, fmt::format("the key {} has no double quotes", name), fmt::format("\"{}\"", name),
            name);
  } else {
    stop("not_json", at, fmt::format("expected a key in double quotes, got '{}'", shown_here()),
         "a key in double quotes", shown_here());
  }
  if (stopped_) return false;

  out_.unescaped_.push_back(name);
  const std::string_view kept = out_.unescaped_.back();
  item_ = static_cast<std::uint32_t>(out_.items_.size());
  out_.items_.push_back({.parent = parent, .key = at, .value = at, .name = kept});
  const auto [first, is_new] = out_.members_.try_emplace({parent, kept}, item_);
  if (!is_new) {
    const TextPlace other = out_.items_[first->second].key;
    if (Diagnostic* d =
            problem("duplicate_key", at, fmt::format("the key '{}' stands twice in this object", name),
                    "each key once", name))
      d->related.push_back(
          {.pointer = d->pointer, .message = "the first one", .line = other.line, .column = other.column});
  }
  skip_space();
  if (!stopped_ && peek() != ':') {
    if (at_end())
      stop_at_end("an object", out_.items_[parent].value);
    else
      stop("not_json", here(), fmt::format("expected ':' after the key '{}', got '{}'", name, shown_here()),
           "':'", shown_here());
  }
  if (stopped_) return false;
  ++pos_;
  skip_space();
  Json value = stopped_ ? Json() : read_value();
  if (is_new) object.get_ref<Json::object_t&>().emplace_back(std::move(name), std::move(value));
  item_ = parent;
  return !stopped_;
}

Json JsonReader::read_object() {
  Json out = Json::object();
  if (too_deep()) return out;
  const TextPlace opened = here();
  ++pos_;
  skip_space();
  if (peek() == '}')
    ++pos_;
  else if (at_end())
    stop_at_end("an object", opened);
  else
    while (!stopped_ && read_member(out) && another('}', opened)) {
    }
  --depth_;
  return out;
}

Json JsonReader::read_array() {
  Json out = Json::array();
  if (too_deep()) return out;
  const TextPlace opened = here();
  const std::uint32_t array = item_;
  out_.elements_[array];
  ++pos_;
  skip_space();
  if (at_end()) stop_at_end("an array", opened);
  for (bool more = !stopped_ && peek() != ']'; more; more = another(']', opened)) {
    auto& elements = out_.elements_[array];
    item_ = static_cast<std::uint32_t>(out_.items_.size());
    out_.items_.push_back({.parent = array,
                           .key = here(),
                           .value = here(),
                           .name = {},
                           .index = static_cast<std::uint32_t>(elements.size())});
    elements.push_back(item_);
    out.push_back(read_value());
    item_ = array;
  }
  if (!stopped_ && out.empty()) ++pos_;
  --depth_;
  return out;
}

Json JsonReader::read_word() {
  const TextPlace at = here();
  if (at_end())
    return stop("not_json", at, "the text ends where a value should stand", "a value", "the end"), Json();
  const std::string got = shown_here();
  if (peek() == '\'') return stop("not_json", at, "texts stand in double quotes", "\"", "'"), Json();
  const std::string word(take_word());
  if (word == "true") return true;
  if (word == "false") return false;
  if (word == "null") return nullptr;
  const std::string low = lower(word);
  if (low == "nan" || low == "inf" || low == "infinity") {
    problem("not_finite", at, fmt::format("'{}' is not a number", word), "a finite number", word);
    return 0;
  }
  const bool near = low == "true" || low == "false" || low == "null" || low == "none";
  const std::string meant = low == "none" ? "null" : low;
  stop("not_json", at,
       near ? fmt::format("'{}' is written {}", word, meant) : fmt::format("expected a value, got '{}'", got),
       near ? meant : "a value", got);
  return nullptr;
}

// number = [-] (0 | digits without a leading zero) [. digits] [(e|E) [+|-] digits]
Json JsonReader::read_number() {
  const TextPlace at = here();
  const std::string_view word = take_word();
  const std::string low = lower(word);
  if (low == "-inf" || low == "-infinity" || low == "-nan" || low == "+inf" || low == "+infinity" ||
      low == "+nan") {
    problem("not_finite", at, fmt::format("'{}' is not a number", word), "a finite number",
            std::string(word));
    return 0;
  }
  std::size_t i = word.starts_with('-') ? 1 : 0;
  const auto digits = [&] {
    const std::size_t from = i;
    while (i < word.size() && is_digit(word[i])) ++i;
    return i - from;
  };
  const std::size_t first = i, whole = digits();
  bool good = whole == 1 || (whole > 1 && word[first] != '0'), real = false;
  if (i < word.size() && word[i] == '.') ++i, real = true, good = digits() > 0 && good;
  if (i < word.size() && (word[i] == 'e' || word[i] == 'E')) {
    ++i, real = true;
    if (i < word.size() && (word[i] == '+' || word[i] == '-')) ++i;
    good = digits() > 0 && good;
  }
  if (!good || i != word.size()) {
    problem("not_json", at, fmt::format("'{}' is not how JSON writes a number", word.substr(0, 40)),
            "such as 1, -0.5 or 2e-3", std::string(word.substr(0, 40)));
    return 0;
  }
  const char *begin = word.data(), *end = word.data() + word.size();
  std::int64_t s = 0;
  if (!real && word != "-0" && std::from_chars(begin, end, s).ec == std::errc())
    return s < 0 ? Json(s) : Json(static_cast<std::uint64_t>(s));
  std::uint64_t u = 0;
  if (!real && word != "-0" && std::from_chars(begin, end, u).ec == std::errc()) return u;
  double d = 0;
  // Out of range is either way; what is too small is the nearest double, 0 or a denormal.
  if (std::from_chars(begin, end, d).ec == std::errc::result_out_of_range)
    d = std::strtod(std::string(word).c_str(), nullptr);
  if (std::isfinite(d)) return d;
  problem("not_finite", at, fmt::format("{} is beyond the largest number, 1.8e308", word.substr(0, 40)),
          "a finite number", std::string(word.substr(0, 40)));
  return 0;
}

}  // namespace frustum
