#include "runtime/io/mtl_parse.h"

#include "runtime/core/error.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/obj_cursor.h"
#include "runtime/io/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace frustum::mtl {
namespace {

using obj::Cursor;

constexpr double max_shininess = 1e6;  // of shade.material

class Parser {
 public:
  Parser(std::string_view text, const FilePath& file, Library& library, Told& told)
      : text_(text), file_(file), in_(text), library_(library), told_(told) {}

  void run() {
    if (text_.starts_with("\xEF\xBB\xBF")) in_.take('\xEF'), in_.take('\xBB'), in_.take('\xBF');
    while (!in_.done()) {
      in_.skip_blanks();
      line_ = in_.offset();
      if (!in_.line_done()) statement(in_.word());
      in_.skip_line();
    }
  }

 private:
  [[noreturn]] void fail(std::string_view what) const {
    throw NodeError("malformed_file", fmt::format("{}: {}", place(), what));
  }
  std::string place() const { return place_in(file_, text_, line_); }

  void statement(std::string_view key) {
    if (key == "newmtl") {
      in_.skip_blanks();
      const auto [at, fresh] = library_.try_emplace(std::string(in_.rest_of_line()));
      now_ = fresh ? &at->second : &repeated_;
      return;
    }
    const auto is_word = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    if (!is_word(key[0])) fail(fmt::format("'{}' is not a statement of an MTL file", printable(key)));
    if (now_ == nullptr) return skip(key);
    if (key == "Kd")
      now_->kd = color(key);
    else if (key == "Ka")
      now_->ka = color(key);
    else if (key == "Ks")
      now_->ks = color(key);
    else if (key == "Ke")
      now_->ke = color(key);
    else if (key == "Ns")
      now_->ns = held(key, number(), max_shininess);
    else if (key == "illum")
      illum();
    else if (key == "d" || key == "Tr")
      opacity(key);
    else if (key == "map_Kd")
      map();
    else
      skip(key);
  }

  void skip(std::string_view what) { ++told_.skipped[printable(what, 30)]; }

  double held(std::string_view key, double v, double most) {
    if (v >= 0 && v <= most) return v;
    if (told_.held.empty()) told_.held_at = place();
    ++told_.held[fmt::format("{} {:.3g}", key, v)];
    return std::clamp(v, 0.0, most);
  }

  [[noreturn]] void no_number() {
    fail(in_.line_done() ? "the line ends where a number is needed" : obj::no_number<double>(in_.word()));
  }

  double number() {
    const auto v = in_.number<double>();
    if (!v) no_number();
    return *v;
  }

  // r g b, or r for all three; "spectral" and "xyz" have no counterpart.
  std::optional<glm::dvec3> color(std::string_view key) {
    Cursor ahead = in_;
    ahead.skip_blanks();
    if (const auto w = ahead.word(); w == "spectral" || w == "xyz") {
      skip(fmt::format("{} {}", key, w));
      return {};
    }
    const auto channel = [&] { return held(key, number(), std::numeric_limits<double>::max()); };
    const double r = channel();
    in_.skip_blanks();
    if (in_.line_done()) return glm::dvec3(r);
    const double g = channel();
    in_.skip_blanks();
    if (in_.line_done()) fail(fmt::format("{} needs one number or three, and there are two", key));
    const double b = channel();
    return glm::dvec3(r, g, b);
  }

  void illum() {
    const double v = number();
    now_->illum = v == 1 ? 1 : 2;
    if (v != 1 && v != 2) skip(fmt::format("illum {:.3g}", v));
  }

  void opacity(std::string_view key) {
    in_.skip_blanks();
    Cursor ahead = in_;
    if (ahead.word() == "-halo") return skip("d -halo");
    const double v = number();
    if (!(v >= 0 && v <= 1)) return skip(fmt::format("{} {:.3g}", key, v));
    (key == "d" ? now_->d : now_->tr) = v;
  }

  // Up to three numbers, the last of which are left out; false where the first is none.
  bool numbers(glm::dvec3& to) {
    for (glm::length_t k = 0; k < 3; ++k) {
      Cursor ahead = in_;
      const auto v = ahead.number<double>();
      if (!v) return k > 0;
      in_ = ahead;
      to[k] = *v;
    }
    return true;
  }

  void map() {
    now_->map_place = place();
    now_->clamp = false, now_->scale = glm::dvec2(1), now_->offset = glm::dvec2(0);
    for (;;) {
      in_.skip_blanks();
      Cursor ahead = in_;
      const std::string_view option = ahead.word();
      if (option.size() < 2 || option[0] != '-' || !option_of_map(option, ahead)) break;
    }
    if (in_.line_done()) return skip("map_Kd without a file");
    now_->map_kd = in_.rest_of_line();
  }

  // Takes one option and its values; false where it is none, but a file whose name begins with '-'.
  bool option_of_map(std::string_view option, const Cursor& after) {
    static constexpr std::array words{"-blendu", "-blendv", "-cc", "-clamp", "-imfchan", "-type"};
    static constexpr std::array figures{"-bm", "-boost", "-mm", "-o", "-s", "-t", "-texres"};
    const auto among = [&](const auto& list) {
      return std::find(list.begin(), list.end(), option) != list.end();
    };
    if (among(words)) {
      in_ = after;
      in_.skip_blanks();
      const std::string_view value = in_.word();
      if (option == "-clamp")
        now_->clamp = value == "on";
      else
        skip(fmt::format("map_Kd {}", option));
      return true;
    }
    if (!among(figures)) return false;
    in_ = after;
    in_.skip_blanks();
    glm::dvec3 v = option == "-s" ? glm::dvec3(1) : glm::dvec3(0);
    if (!numbers(v)) no_number();
    if (option == "-s")
      now_->scale = glm::dvec2(v);
    else if (option == "-o")
      now_->offset = glm::dvec2(v);
    else
      skip(fmt::format("map_Kd {}", option));
    return true;
  }

  std::string_view text_;
  const FilePath& file_;
  Cursor in_;
  Library& library_;
  Told& told_;
  std::size_t line_ = 0;
  Written* now_ = nullptr;
  Written repeated_;
};

}  // namespace

void parse(std::string_view text, const FilePath& file, Library& library, Told& told) {
  Parser(text, file, library, told).run();
}

}  // namespace frustum::mtl
