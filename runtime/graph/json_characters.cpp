#include "runtime/graph/json_reader.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cctype>
#include <charconv>

namespace frustum {
namespace {

// After so many the text is not JSON with mistakes but something else.
constexpr int most_text_problems = 20;

// Bytes of the code point that starts `s`, 0 where it is not well-formed UTF-8 (Unicode 15, table 3-7: no
// overlong forms, no surrogates, nothing above U+10FFFF).
std::size_t code_point_length(std::string_view s) {
  const auto byte = [s](std::size_t i) { return i < s.size() ? static_cast<unsigned char>(s[i]) : 0u; };
  const auto in = [&](std::size_t i, unsigned low, unsigned high) {
    return byte(i) >= low && byte(i) <= high;
  };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return in(1, 0x80, 0xBF) ? 2 : 0;
  if (lead >= 0xE0 && lead <= 0xEF) {
    const unsigned low = lead == 0xE0 ? 0xA0 : 0x80, high = lead == 0xED ? 0x9F : 0xBF;
    return in(1, low, high) && in(2, 0x80, 0xBF) ? 3 : 0;
  }
  if (lead >= 0xF0 && lead <= 0xF4) {
    const unsigned low = lead == 0xF0 ? 0x90 : 0x80, high = lead == 0xF4 ? 0x8F : 0xBF;
    return in(1, low, high) && in(2, 0x80, 0xBF) && in(3, 0x80, 0xBF) ? 4 : 0;
  }
  return 0;
}

void append_utf8(std::string& out, unsigned c) {
  const auto put = [&out](unsigned byte) { out += static_cast<char>(byte); };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0 | (c >> 6)), put(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    put(0xE0 | (c >> 12)), put(0x80 | ((c >> 6) & 0x3F)), put(0x80 | (c & 0x3F));
  } else {
    put(0xF0 | (c >> 18)), put(0x80 | ((c >> 12) & 0x3F)), put(0x80 | ((c >> 6) & 0x3F)),
        put(0x80 | (c & 0x3F));
  }
}

}  // namespace

// ----- problems

Diagnostic* JsonReader::problem(std::string code, TextPlace at, std::string message, std::string expected,
                                std::string got) {
  if (stopped_) return nullptr;
  problems_.add({.code = std::move(code),
                 .pointer = out_.pointer_of(item_),
                 .message = std::move(message),
                 .expected = std::move(expected),
                 .got = std::move(got),
                 .file = out_.file_,
                 .line = at.line,
                 .column = at.column});
  if (++reported_ >= most_text_problems) stopped_ = true;
  return &problems_.list().back();
}

Diagnostic* JsonReader::stop(std::string code, TextPlace at, std::string message, std::string expected,
                             std::string got) {
  Diagnostic* d = problem(std::move(code), at, std::move(message), std::move(expected), std::move(got));
  stopped_ = true;
  return d;
}

void JsonReader::stop_at_end(std::string_view inside, TextPlace opened) {
  if (Diagnostic* d = stop("not_json", here(), fmt::format("the text ends inside {}", inside),
                           "the rest of the text", "the end"))
    d->related.push_back({.pointer = d->pointer,
                          .message = fmt::format("{} starts here", inside),
                          .line = opened.line,
                          .column = opened.column});
}

bool JsonReader::is_word_char(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '$' || c == '.';
}

// The next word or character as a message may quote it.
std::string JsonReader::shown_here() const {
  if (at_end()) return "the end";
  std::size_t end = pos_;
  while (end < text_.size() && end - pos_ < 30 && is_word_char(text_[end])) ++end;
  if (end > pos_) return std::string(text_.substr(pos_, end - pos_));
  const std::size_t length = code_point_length(text_.substr(pos_));
  const auto byte = static_cast<unsigned char>(text_[pos_]);
  if (length == 0 || byte < 0x20 || byte == 0x7F) return fmt::format("byte 0x{:02X}", byte);
  return std::string(text_.substr(pos_, length));
}

// ----- characters

void JsonReader::new_line() {
  ++pos_, ++line_;
  line_start_ = pos_;
  continuation_ = 0;
}

void JsonReader::take_code_point(std::string* append) {
  const std::size_t length = code_point_length(text_.substr(pos_));
  if (length == 0) {
    problem("not_json", here(), fmt::format("{} is not UTF-8", shown_here()), "UTF-8", shown_here());
    if (append != nullptr) append_utf8(*append, 0xFFFD);
    ++pos_;
    return;
  }
  if (append != nullptr) append->append(text_.substr(pos_, length));
  pos_ += length;
  continuation_ += length - 1;
}

void JsonReader::skip_space() {
  for (;;) {
    const char c = peek();
    if (at_end()) return;
    if (c == '\n')
      new_line();
    else if (c == ' ' || c == '\t' || c == '\r')
      ++pos_;
    else if (c == '#' || starts_with("//") || starts_with("/*"))
      skip_comment();
    else
      return;
    if (stopped_) return;
  }
}

void JsonReader::skip_comment() {
  const TextPlace start = here();
  problem("not_json", start, "JSON has no comments", "JSON without comments",
          std::string(text_.substr(pos_, peek() == '#' ? 1 : 2)));
  const bool block = starts_with("/*");
  pos_ += block ? 2 : 1;
  while (!at_end() && !stopped_) {
    if (block ? starts_with("*/") : peek() == '\n') {
      pos_ += block ? 2 : 0;
      return;
    }
    if (peek() == '\n')
      new_line();
    else
      take_code_point(nullptr);
  }
  if (block) stop_at_end("a comment", start);
}

std::string_view JsonReader::take_word() {
  const std::size_t start = pos_;
  while (!at_end() && (is_word_char(peek()) || peek() == '+' || peek() == '-')) ++pos_;
  return text_.substr(start, pos_ - start);
}

// ----- texts

std::string JsonReader::read_string() {
  const TextPlace opened = here();
  std::string out;
  ++pos_;
  while (!stopped_) {
    if (at_end() || peek() == '\n') {
      if (at_end())
        stop_at_end("a text", opened);
      else
        stop("not_json", opened, "this text has no closing quote on its line", "\"", "the end of the line");
      break;
    }
    const char c = peek();
    if (c == '"') {
      ++pos_;
      break;
    }
    if (c == '\\')
      read_escape(out);
    else if (static_cast<unsigned char>(c) < 0x20) {
      problem("not_json", here(), fmt::format("{} in a text is written as an escape", shown_here()),
              fmt::format("\\u{:04x}", c), shown_here());
      ++pos_;
    } else
      take_code_point(&out);
  }
  return out;
}

std::optional<unsigned> JsonReader::read_hex4() {
  unsigned value = 0;
  const std::string_view digits = text_.substr(pos_, 4);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (error != std::errc() || end != digits.data() + 4 || digits.size() != 4) return std::nullopt;
  pos_ += 4;
  return value;
}

void JsonReader::read_escape(std::string& out) {
  const TextPlace at = here();
  ++pos_;
  constexpr std::string_view names = "\"\\/bfnrt", meant = "\"\\/\b\f\n\r\t";
  if (const std::size_t i = names.find(peek()); !at_end() && i != std::string_view::npos) {
    out += meant[i];
    ++pos_;
    return;
  }
  if (peek() != 'u') {
    problem("not_json", at, fmt::format("'\\{}' is not an escape of JSON", shown_here()),
            R"(one of \" \\ \/ \b \f \n \r \t \uXXXX)", "\\" + shown_here());
    return;
  }
  ++pos_;
  auto code = read_hex4();
  const bool high = code && *code >= 0xD800 && *code <= 0xDBFF;
  if (high && starts_with("\\u")) {
    pos_ += 2;
    const auto low = read_hex4();
    code = low && *low >= 0xDC00 && *low <= 0xDFFF
               ? std::optional(0x10000 + ((*code - 0xD800) << 10) + (*low - 0xDC00))
               : std::nullopt;
  }
  if (!code || (*code >= 0xD800 && *code <= 0xDFFF)) {
    problem("not_json", at, "'\\u' needs four hexadecimal digits, and halves of a pair stand together",
            R"(\uXXXX)", "\\u");
    append_utf8(out, 0xFFFD);
    return;
  }
  append_utf8(out, *code);
}

}  // namespace frustum
