#include "runtime/core/error.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/ply_body.h"
#include "runtime/io/ply_numbers.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace frustum::ply {
namespace {

constexpr std::uint64_t piece_rows = 1 << 15;
constexpr std::size_t piece_bytes = std::size_t{1} << 20;

class BinaryCutter {
 public:
  BinaryCutter(const Header& header, std::string_view bytes, const FilePath& file, Context& ctx)
      : header_(header), bytes_(bytes), file_(file), ctx_(ctx), at_(header.bytes) {}

  std::vector<Piece> run(const std::vector<bool>& wanted, std::size_t& tail) {
    for (std::size_t e = 0; e < header_.elements.size(); ++e) {
      const std::size_t least = header_.elements[e].least_bytes();
      if (least != 0 && header_.elements[e].rows > left() / least) missing(header_.elements[e], least);
      if (header_.elements[e].has_lists())
        with_lists(e, wanted[e]);
      else if (least != 0)
        without_lists(e, least, wanted[e]);
    }
    tail = left();
    return std::move(pieces_);
  }

 private:
  std::size_t left() const { return bytes_.size() - at_; }

  [[noreturn]] void missing(const Element& e, std::size_t least) const {
    throw NodeError(
        "malformed_file",
        fmt::format("{}: byte {}: {} rows of '{}' need {} bytes each at least, and {} bytes are left",
                    file_.written, at_, e.rows, e.name, least, left()));
  }

  void without_lists(std::size_t e, std::size_t stride, bool wanted) {
    const std::uint64_t rows = header_.elements[e].rows;
    for (std::uint64_t first = 0; wanted && first < rows; first += piece_rows) {
      const std::uint64_t n = std::min(piece_rows, rows - first);
      pieces_.push_back({e, first, n, bytes_.substr(at_ + first * stride, n * stride)});
    }
    at_ += rows * stride;
  }

  // Row by row, since the place of a row is known only after the one before: some 3 ns a row.
  void with_lists(std::size_t e, bool wanted) {
    const Element& element = header_.elements[e];
    const bool swap = swaps(header_.encoding);
    for (std::uint64_t first = 0; first < element.rows; first += piece_rows) {
      ctx_.poll();
      const std::uint64_t n = std::min(piece_rows, element.rows - first);
      const std::size_t begin = at_;
      for (std::uint64_t row = first; row < first + n; ++row)
        for (const Property& p : element.properties) skip(element, p, row, swap);
      if (wanted) pieces_.push_back({e, first, n, bytes_.substr(begin, at_ - begin)});
    }
  }

  void skip(const Element& e, const Property& p, std::uint64_t row, bool swap) {
    const std::size_t head = bytes_of(p.count.value_or(p.type));
    if (left() < head) short_row(e, row);
    if (!p.count) {
      at_ += head;
      return;
    }
    const std::int64_t n = stored_whole(bytes_.data() + at_, *p.count, swap);
    if (n < 0)
      throw NodeError("malformed_file", fmt::format("{}: byte {}: row {} of '{}' has a list of {} numbers",
                                                    file_.written, at_, row, e.name, n));
    at_ += head;
    const std::size_t each = bytes_of(p.type);
    if (static_cast<std::uint64_t>(n) > left() / each) short_row(e, row);
    at_ += static_cast<std::size_t>(n) * each;
  }

  [[noreturn]] void short_row(const Element& e, std::uint64_t row) const {
    throw NodeError("malformed_file",
                    fmt::format("{}: byte {}: the file ends within row {} of '{}' ({} claimed)",
                                file_.written, at_, row, e.name, e.rows));
  }

  const Header& header_;
  std::string_view bytes_;
  const FilePath& file_;
  Context& ctx_;
  std::size_t at_;
  std::vector<Piece> pieces_;
};

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t\r\n\v\f") == std::string_view::npos;
}

// A row is a line that is not blank.
class AsciiCutter {
 public:
  AsciiCutter(const Header& header, std::string_view bytes, const FilePath& file, Context& ctx)
      : header_(header), bytes_(bytes), file_(file), ctx_(ctx) {}

  std::vector<Piece> run(const std::vector<bool>& wanted, std::size_t& tail) {
    const auto chunks = split();
    std::vector<std::uint64_t> lines(chunks.size());
    tbb::parallel_for(std::size_t{0}, chunks.size(),
                      [&](std::size_t i) { lines[i] = count_lines(chunks[i]); });
    ctx_.poll();
    to_next_element();
    for (std::size_t i = 0; i < chunks.size(); ++i) add_chunk(chunks[i], lines[i], wanted, tail);
    if (element_ < header_.elements.size())
      throw NodeError("malformed_file",
                      fmt::format("{}: the file ends after {} of {} rows of '{}'", file_.written, row_,
                                  header_.elements[element_].rows, header_.elements[element_].name));
    return std::move(pieces_);
  }

 private:
  std::vector<std::string_view> split() const {
    std::vector<std::string_view> chunks;
    for (std::string_view rest = bytes_.substr(header_.bytes); !rest.empty();) {
      const std::size_t eol = rest.find(header_.line_end, std::min(piece_bytes, rest.size()) - 1);
      chunks.push_back(rest.substr(0, eol == std::string_view::npos ? rest.size() : eol + 1));
      rest.remove_prefix(chunks.back().size());
    }
    return chunks;
  }

  std::string_view take_line(std::string_view& text) const {
    const std::size_t eol = text.find(header_.line_end);
    const std::string_view line = text.substr(0, eol == std::string_view::npos ? text.size() : eol + 1);
    text.remove_prefix(line.size());
    return line;
  }

  std::uint64_t count_lines(std::string_view text) const {
    std::uint64_t n = 0;
    while (!text.empty())
      if (!is_blank(take_line(text))) ++n;
    return n;
  }

  // Elements without rows or without properties have no lines.
  void to_next_element() {
    while (element_ < header_.elements.size() &&
           (row_ == header_.elements[element_].rows || header_.elements[element_].properties.empty())) {
      ++element_;
      row_ = 0;
    }
  }

  void add(std::string_view text, std::uint64_t rows, const std::vector<bool>& wanted) {
    if (rows != 0 && wanted[element_]) pieces_.push_back({element_, row_, rows, text});
    row_ += rows;
    to_next_element();
  }

  // One pass, however many elements begin in the chunk.
  void add_chunk(std::string_view text, std::uint64_t lines, const std::vector<bool>& wanted,
                 std::size_t& tail) {
    while (element_ < header_.elements.size() && header_.elements[element_].rows - row_ < lines) {
      const std::uint64_t rows = header_.elements[element_].rows - row_;
      std::string_view rest = text;
      for (std::uint64_t n = 0; n < rows;)
        if (!is_blank(take_line(rest))) ++n;
      add(text.substr(0, text.size() - rest.size()), rows, wanted);
      text = rest, lines -= rows;
    }
    if (element_ < header_.elements.size())
      add(text, lines, wanted);
    else
      tail += lines != 0 ? text.size() : 0;
  }

  const Header& header_;
  std::string_view bytes_;
  const FilePath& file_;
  Context& ctx_;
  std::size_t element_ = 0;
  std::uint64_t row_ = 0;
  std::vector<Piece> pieces_;
};

}  // namespace

std::vector<Piece> cut_rows(const Header& header, std::string_view file_bytes,
                            const std::vector<bool>& wanted, const FilePath& file, Context& ctx,
                            std::size_t& tail) {
  tail = 0;
  if (header.encoding == Encoding::ascii) return AsciiCutter(header, file_bytes, file, ctx).run(wanted, tail);
  return BinaryCutter(header, file_bytes, file, ctx).run(wanted, tail);
}

}  // namespace frustum::ply
