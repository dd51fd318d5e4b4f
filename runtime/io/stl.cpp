#include "runtime/io/stl.h"

#include "runtime/io/decimal.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/normals.h"
#include "runtime/io/printable.h"
#include "runtime/io/weld.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>

namespace frustum {
namespace {

constexpr std::size_t header_bytes = 84, facet_bytes = 50;

// What either kind of file says.
template <class R>
struct Facets {
  std::vector<glm::vec<3, R>> corners;  // three a facet
  std::vector<glm::vec<3, R>> normals;  // as stated
  std::vector<std::uint32_t> groups;    // of each facet; empty where there is one solid
  std::size_t tail = 0;                 // bytes after the last facet
  std::size_t attributes = 0;           // facets whose two attribute bytes are not 0
  bool header_color = false;            // whether the header states a colour
};

std::uint32_t stated_count(std::string_view bytes) {
  std::uint32_t n = 0;
  for (std::size_t i = 4; i-- > 0;) n = n << 8 | static_cast<unsigned char>(bytes[80 + i]);
  return n;
}

// Little-endian, whatever this processor is.
float stored_float(const char* at) {
  std::uint32_t bits = 0;
  for (std::size_t i = 4; i-- > 0;) bits = bits << 8 | static_cast<unsigned char>(at[i]);
  return std::bit_cast<float>(bits);
}

template <class R>
glm::vec<3, R> stored_vector(const char* at) {
  return {static_cast<R>(stored_float(at)), static_cast<R>(stored_float(at + 4)),
          static_cast<R>(stored_float(at + 8))};
}

template <class Vec3>
bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <class R>
Facets<R> read_binary(std::string_view bytes, const FilePath& file, Context& ctx) {
  if (bytes.size() < header_bytes)
    throw NodeError("malformed_file",
                    fmt::format("{}: neither a text that begins with 'solid' nor the {} bytes with "
                                "which a binary STL file begins",
                                file.written, header_bytes));
  const std::size_t n = stated_count(bytes);
  if (n > (bytes.size() - header_bytes) / facet_bytes)
    throw NodeError("malformed_file",
                    fmt::format("{}: byte 80: {} facets of {} bytes are claimed, and {} bytes are left",
                                file.written, n, facet_bytes, bytes.size() - header_bytes));
  Facets<R> out;
  out.corners.resize(3 * n), out.normals.resize(n);
  out.tail = bytes.size() - header_bytes - n * facet_bytes;
  constexpr std::size_t text_bytes = 80;
  out.header_color = bytes.substr(0, text_bytes).find("COLOR=") != std::string_view::npos;
  std::atomic<std::size_t> wrong{n}, attributes{0};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 1 << 13), [&](const auto& range) {
    std::size_t some = 0;
    for (std::size_t f = range.begin(); f < range.end(); ++f) {
      const char* at = bytes.data() + header_bytes + f * facet_bytes;
      some += at[48] != 0 || at[49] != 0;
      out.normals[f] = stored_vector<R>(at);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto corner = out.corners[3 * f + k] = stored_vector<R>(at + 12 + 12 * k);
        if (is_finite(corner)) continue;
        for (std::size_t old = wrong; f < old && !wrong.compare_exchange_weak(old, f);) {
        }
      }
    }
    attributes += some;
  });
  ctx.poll();
  out.attributes = attributes;
  if (wrong < n)
    throw NodeError("malformed_file",
                    fmt::format("{}: byte {}: facet {} has a corner that is not finite", file.written,
                                header_bytes + wrong * facet_bytes, wrong.load()));
  return out;
}

// solid NAME, then facet normal x y z / outer loop / 3 x vertex x y z / endloop / endfacet, then endsolid; all of
// it separated by blanks and line ends of any kind, keywords in any case.
template <class R>
class TextReader {
 public:
  TextReader(std::string_view text, const FilePath& file, Context& ctx)
      : text_(text), file_(file), ctx_(ctx), at_(text.data()), end_(at_ + text.size()) {}

  Facets<R> run() {
    std::uint32_t solids = 0;
    skip_blanks();
    while (at_ != end_) {
      expect("solid");
      skip_line();  // its name
      const std::size_t before = out_.normals.size();
      std::string_view w = word();
      for (; is(w, "facet"); w = word()) facet(solids);
      if (!is(w, "endsolid")) fail(w, "'facet' or 'endsolid'");
      skip_line();
      if (out_.normals.size() != before) ++solids;
      skip_blanks();
    }
    if (solids < 2) out_.groups.clear();
    return std::move(out_);
  }

 private:
  void facet(std::uint32_t solid) {
    if (out_.normals.size() % 4096 == 0) ctx_.poll();
    expect("normal");
    out_.normals.push_back(vector(false));
    expect("outer");
    expect("loop");
    for (int k = 0; k < 3; ++k) {
      expect("vertex");
      out_.corners.push_back(vector(true));
    }
    expect("endloop");
    expect("endfacet");
    out_.groups.push_back(solid);
  }

  static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
  }
  void skip_line() {
    while (at_ != end_ && *at_ != '\n' && *at_ != '\r') ++at_;
  }
  std::string_view word() {
    skip_blanks();
    const char* start = at_;
    while (at_ != end_ && !is_blank(*at_)) ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
  }
  static bool is(std::string_view word, std::string_view keyword) {
    return word.size() == keyword.size() && std::equal(word.begin(), word.end(), keyword.begin(),
                                                       [](char a, char b) { return (a | 32) == b; });
  }
  void expect(std::string_view keyword) {
    if (const auto w = word(); !is(w, keyword)) fail(w, fmt::format("'{}'", keyword));
  }
  [[noreturn]] void fail(std::string_view word, std::string_view expected) const {
    const auto at = static_cast<std::size_t>((word.data() != nullptr ? word.data() : end_) - text_.data());
    throw NodeError("malformed_file",
                    word.empty() ? fmt::format("{}: the file ends where {} is expected",
                                               place_in(file_, text_, at), expected)
                                 : fmt::format("{}: '{}' stands where {} is expected",
                                               place_in(file_, text_, at), printable(word), expected));
  }
  // A normal may be what it likes (some programs write nan for a facet without area); corners are finite.
  glm::vec<3, R> vector(bool finite) {
    glm::vec<3, R> v{};
    for (glm::length_t k = 0; k < 3; ++k) {
      const std::string_view w = word();
      const char* stop = read_decimal(w.data(), w.data() + w.size(), v[k]);
      if (w.empty() || (finite && (stop != w.data() + w.size() || !std::isfinite(v[k]))))
        fail(w, is_beyond<R>(w) ? fmt::format("a number of {}", precision_name<R>()) : "a finite number");
    }
    return v;
  }

  std::string_view text_;
  const FilePath& file_;
  Context& ctx_;
  const char *at_, *end_;
  Facets<R> out_;
};

bool begins_as_text(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  const std::size_t start = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  constexpr std::string_view solid = "solid";
  const std::string_view begin = bytes.substr(start, solid.size());
  return std::equal(begin.begin(), begin.end(), solid.begin(), solid.end(),
                    [](char a, char b) { return (a | 32) == b; });
}

bool is_binary(std::string_view bytes) {
  if (bytes.size() >= header_bytes &&
      bytes.size() == header_bytes + facet_bytes * std::size_t{stated_count(bytes)})
    return true;
  return !begins_as_text(bytes) || std::memchr(bytes.data(), 0, bytes.size()) != nullptr;
}

template <class R>
Mesh to_mesh(Facets<R> facets, const FilePath& file, Context& ctx) {
  using Vec3 = glm::vec<3, R>;
  const std::size_t n = facets.normals.size();
  if (3 * n > std::size_t{1} << 31)
    throw NodeError("too_large", fmt::format("{} has more than 2^31 corners", file.written));
  auto normals = Column::make<Vec3>("normal", Domain::corner, 3 * n);
  const auto out = normals->template values<Vec3>();
  std::atomic<std::uint64_t> against{0};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 1 << 13), [&](const auto& range) {
    std::uint64_t wrong = 0;
    for (std::size_t f = range.begin(); f < range.end(); ++f) {
      const Vec3* corner = &facets.corners[3 * f];
      const auto normal = unit(area_normal(corner[0], corner[1], corner[2]));
      const auto stated = unit(glm::dvec3(facets.normals[f]));
      if (normal && stated && normal->x * stated->x + normal->y * stated->y + normal->z * stated->z < 0)
        ++wrong;
      std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(3 * f), 3,
                  Vec3(normal.value_or(glm::dvec3(0, 0, 1))));
    }
    against += wrong;
  });
  ctx.poll();
  facets.normals = {};
  Mesh m;
  m.columns = weld_exact<R>(facets.corners, ctx);
  m.columns.push_back(std::move(normals));
  if (!facets.groups.empty())
    m.columns.push_back(
        Column::make<std::uint32_t>("group", Domain::face, std::span<const std::uint32_t>(facets.groups)));
  ctx.count("triangles", n);
  ctx.count("vertices", m.vertices());
  if (against != 0)
    ctx.warn(
        "facet_normals",
        fmt::format("{}: {} facets state a normal on the other side of their winding; the winding is taken",
                    file.written, against.load()));
  if (facets.attributes != 0 || facets.header_color)
    ctx.warn("properties_skipped",
             fmt::format("{}: skipped {}the attribute bytes of {} facets, which may be colours", file.written,
                         facets.header_color ? "the colour of its header and " : "", facets.attributes));
  if (facets.tail != 0)
    ctx.warn("trailing_bytes",
             fmt::format("{}: {} bytes stand after the last facet", file.written, facets.tail));
  if (n == 0) ctx.warn("no_faces", fmt::format("{} has no faces", file.written));
  return m;
}

}  // namespace

Mesh read_stl(std::string_view bytes, const FilePath& file, Context& ctx) {
  return ctx.real([&]<class R>() {
    if (is_binary(bytes)) return to_mesh(read_binary<R>(bytes, file, ctx), file, ctx);
    std::string_view text = bytes;
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    return to_mesh(TextReader<R>(text, file, ctx).run(), file, ctx);
  });
}

}  // namespace frustum
