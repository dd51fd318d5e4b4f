#include "runtime/io/obj_parse.h"

#include "runtime/io/obj_cursor.h"
#include "runtime/io/printable.h"

#include <fmt/format.h>

#include <algorithm>

namespace frustum::obj {
namespace {

bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }

template <class R>
class Parser {
 public:
  Parser(std::string_view lines, Chunk<R>& out) : in_(lines), out_(out) {
    out_.text = lines;
    // Guesses from files in use: a line of numbers has some 30 bytes.
    out_.positions.reserve(lines.size() / 20), out_.corners.reserve(lines.size() / 12),
        out_.sizes.reserve(lines.size() / 36);
  }

  void run() {
    while (!in_.done() && out_.error.empty()) {
      in_.skip_blanks();
      line_ = in_.offset();
      if (!in_.line_done()) statement();
      in_.skip_line();
    }
  }

 private:
  void fail(std::string what) {
    if (!out_.error.empty()) return;
    out_.error = std::move(what);
    out_.error_at = line_;
  }

  void statement() {
    const std::string_view key = in_.word();
    if (key == "f") return face();
    if (key == "v") return vertex();
    if (key == "vn") return numbers(out_.normals, 3, 3);
    if (key == "vt") return numbers(out_.uvs, 1, 2);
    if (key == "usemtl" || key == "g" || key == "o") {
      in_.skip_blanks();
      const auto kind = key == "g"   ? FaceChange::group
                        : key == "o" ? FaceChange::object
                                     : FaceChange::material;
      out_.changes.push_back({kind, out_.sizes.size(), in_.rest_of_line()});
      return;
    }
    if (key == "mtllib") {
      in_.skip_blanks();
      out_.libraries.push_back(in_.rest_of_line());
      return;
    }
    if (!std::all_of(key.begin(), key.end(), [](char c) { return letter(c) || digit(c); }))
      return fail(fmt::format("'{}' is not a statement of an OBJ file", printable(key)));
    ++out_.other[key];
  }

  // v x y z, with a weight (not looked at) or red green blue after it.
  void vertex() {
    numbers(out_.positions, 3, 3);
    R rest[4];
    int n = 0;
    for (; n < 4 && out_.error.empty() && !in_.line_done(); in_.skip_blanks()) {
      const auto v = in_.template number<R>();
      if (!v) break;
      rest[n++] = *v;
      in_.skip_blanks();
    }
    const std::size_t before = out_.positions.size() - 3;
    if (n == 3) {
      out_.colors.resize(before, R{1});  // of the vertices that had none
      out_.colors.insert(out_.colors.end(), rest, rest + 3);
    } else if (!out_.colors.empty()) {
      out_.colors.resize(before + 3, R{1});
    }
  }

  // `least` numbers, up to `most` kept (zero where they are left out); more are not looked at.
  void numbers(std::vector<R>& to, int least, int most) {
    for (int i = 0; i < most; ++i) {
      in_.skip_blanks();
      if (i >= least && in_.line_done()) {
        to.push_back(0);
        continue;
      }
      const auto n = in_.template number<R>();
      if (!n)
        return fail(in_.line_done() ? fmt::format("{} numbers are needed, and there are {}", least, i)
                                    : no_number<R>(in_.word()));
      to.push_back(*n);
    }
  }

  std::int32_t local_count(int field) const {
    const std::size_t n = field == 0   ? out_.positions.size() / 3
                          : field == 1 ? out_.uvs.size() / 2
                                       : out_.normals.size() / 3;
    return static_cast<std::int32_t>(n);
  }

  bool field(std::int32_t& to, int which) {
    const auto i = in_.index();
    if (!i) return false;
    to = *i > 0 ? *i - 1 : local_count(which) + *i;
    if (*i < 0) out_.relative.push_back(3 * out_.corners.size() + static_cast<std::size_t>(which));
    return true;
  }

  // v, v/vt, v//vn or v/vt/vn
  bool corner() {
    Corner c;
    if (!field(c.v, 0)) return false;
    if (in_.take('/')) {
      if (in_.take('/')) {
        if (!field(c.vn, 2)) return false;
      } else {
        if (!field(c.vt, 1)) return false;
        if (in_.take('/') && !field(c.vn, 2)) return false;
      }
    }
    out_.corners.push_back(c);
    return true;
  }

  void face() {
    std::uint32_t n = 0;
    for (in_.skip_blanks(); !in_.line_done(); in_.skip_blanks(), ++n) {
      const std::size_t before = in_.offset();
      if (!corner()) {
        const std::string_view rest = out_.text.substr(before);
        return fail(fmt::format("'{}' is not a corner (v, v/vt, v//vn or v/vt/vn, counted from 1 or -1)",
                                printable(rest.substr(0, rest.find_first_of(" \t\r\n")))));
      }
    }
    if (n < 3) return fail(fmt::format("a face needs 3 corners, and this has {}", n));
    out_.sizes.push_back(n);
  }

  Cursor in_;
  Chunk<R>& out_;
  std::size_t line_ = 0;
};

}  // namespace

std::vector<std::string_view> split_lines(std::string_view text, std::size_t size) {
  std::vector<std::string_view> pieces;
  while (!text.empty()) {
    std::size_t end = std::min(size, text.size());
    while (end < text.size()) {
      const std::size_t eol = text.find('\n', end - 1);
      end = eol == std::string_view::npos ? text.size() : eol + 1;
      if (eol == std::string_view::npos || !Cursor::continues(text.data(), text.data() + eol)) break;
      ++end;
    }
    end = std::min(end, text.size());
    pieces.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return pieces;
}

template <class R>
void parse(std::string_view lines, Chunk<R>& out) {
  Parser<R>(lines, out).run();
}
template void parse(std::string_view, Chunk<float>&);
template void parse(std::string_view, Chunk<double>&);

std::size_t find_face(std::string_view lines, std::size_t face) {
  Cursor in(lines);
  while (!in.done()) {
    in.skip_blanks();
    const std::size_t line = in.offset();
    if (!in.line_done() && in.word() == "f" && face-- == 0) return line;
    in.skip_line();
  }
  return lines.size();
}

}  // namespace frustum::obj
