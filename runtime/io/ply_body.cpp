#include "runtime/io/ply_body.h"

#include "runtime/io/decimal.h"
#include "runtime/io/ply_numbers.h"
#include "runtime/io/printable.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

namespace frustum::ply {
namespace {

// The same questions of both encodings: numbers one after another, ends of rows. An answer that is not there
// sets `error`.

class BinaryRows {
 public:
  BinaryRows(std::string_view bytes, const Header& header)
      : begin_(bytes.data()), at_(begin_), swap_(swaps(header.encoding)) {}

  std::string error;
  std::size_t byte() const { return static_cast<std::size_t>(at_ - begin_); }
  void begin_row() {}
  void end_row() {}
  void skip(Number type) { at_ += bytes_of(type); }

  // cut_rows has seen that every row is there.
  template <class R>
  R real(Number type) {
    const R v = with_stored(at_, type, swap_, [](auto x) { return static_cast<R>(x); });
    at_ += bytes_of(type);
    return v;
  }
  std::int64_t whole(Number type) {
    std::int64_t v = 0;
    if (!is_real(type)) {
      v = stored_whole(at_, type, swap_);
    } else {
      const double x =
          type == Number::f32 ? static_cast<double>(stored<float>(at_, swap_)) : stored<double>(at_, swap_);
      if (std::abs(x) < 1e15 && std::trunc(x) == x)
        v = static_cast<std::int64_t>(x);
      else
        error = fmt::format("{} is no whole number", x);
    }
    at_ += bytes_of(type);
    return v;
  }

 private:
  const char *begin_, *at_;
  bool swap_;
};

class AsciiRows {
 public:
  AsciiRows(std::string_view bytes, const Header& header)
      : begin_(bytes.data()), at_(begin_), end_(begin_ + bytes.size()), eol_(header.line_end) {}

  std::string error;
  std::size_t byte() const { return static_cast<std::size_t>(at_ - begin_); }
  void begin_row() {
    while (at_ != end_ && (blank() || *at_ == eol_)) ++at_;
  }
  void end_row() {
    skip_blanks();
    if (error.empty() && at_ != end_ && *at_ != eol_)
      error = fmt::format("'{}' is more than the row holds", printable(word()));
  }
  void skip(Number) {
    skip_blanks();
    if (word().empty()) too_few();
  }
  template <class R>
  R real(Number type) {
    if (!is_real(type)) return static_cast<R>(whole(type));
    skip_blanks();
    R v{};
    const char* stop = read_decimal(at_, end_, v);
    if (stop == nullptr || !ends(stop)) return not_a_number(type), R{};
    at_ = stop;
    return v;
  }
  std::int64_t whole(Number type) {
    skip_blanks();
    std::int64_t v = 0;
    const auto [stop, problem] = std::from_chars(at_, end_, v);
    if (problem != std::errc() || !ends(stop) || !fits(v, type)) return not_a_number(type), 0;
    at_ = stop;
    return v;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
  bool blank() const { return is_blank(*at_) && *at_ != eol_; }
  void skip_blanks() {
    while (at_ != end_ && blank()) ++at_;
  }
  std::string_view word() {
    const char* start = at_;
    while (at_ != end_ && !is_blank(*at_) && *at_ != eol_) ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
  }
  bool ends(const char* stop) const { return stop == end_ || is_blank(*stop) || *stop == eol_; }
  struct Range {
    std::int64_t least, most;
  };
  static Range range_of(Number whole_type) {
    const auto bits = static_cast<int>(8 * bytes_of(whole_type));
    const bool is_signed = whole_type == Number::i8 || whole_type == Number::i16 || whole_type == Number::i32;
    const std::int64_t count = std::int64_t{1} << bits, least = is_signed ? -count / 2 : 0;
    return {least, least + count - 1};
  }
  static bool fits(std::int64_t v, Number type) {
    if (is_real(type)) return true;
    const Range range = range_of(type);
    return v >= range.least && v <= range.most;
  }
  void too_few() {
    if (error.empty()) error = "the row ends before all of its numbers";
  }
  void not_a_number(Number type) {
    const std::string_view w = word();
    if (w.empty()) return too_few();
    if (!error.empty()) return;
    if (is_real(type)) {
      error = fmt::format("'{}' is not a number of the kind that stands here", printable(w));
    } else {
      const Range range = range_of(type);
      error = fmt::format("'{}' is no whole number from {} to {}", printable(w), range.least, range.most);
    }
  }

  const char *begin_, *at_, *end_;
  char eol_;
};

template <class R, class Rows>
class Decoder {
 public:
  Decoder(Rows rows, std::span<const Slot<R>> slots, std::uint64_t limit, bool breaks, Lists<R>& out)
      : in_(std::move(rows)), slots_(slots), limit_(limit), breaks_(breaks), out_(out) {}

  void run(std::uint64_t first, std::uint64_t count) {
    for (row_ = first; row_ < first + count; ++row_) {
      in_.begin_row();
      row_byte_ = in_.byte();
      for (const Slot<R>& slot : slots_) {
        value(slot);
        if (!in_.error.empty()) return stop();
      }
      match_uv();
      in_.end_row();
      if (!in_.error.empty()) return stop();
    }
  }

 private:
  using Use = typename Slot<R>::Use;

  void stop() {
    out_.error = std::move(in_.error);
    out_.row = row_, out_.byte = row_byte_;
  }

  void value(const Slot<R>& slot) {
    switch (slot.use) {
      case Use::skip: return skip(slot);
      case Use::real: return real(slot);
      case Use::whole:
        slot.whole[row_ * slot.stride] = static_cast<std::uint32_t>(in_.whole(slot.type));
        return;
      case Use::indices: return indices(slot);
      case Use::corner_uv: return corner_uv(slot);
    }
  }

  void real(const Slot<R>& slot) {
    const R v = in_.template real<R>(slot.type);
    if (slot.finite && !std::isfinite(v) && in_.error.empty())
      in_.error = fmt::format("{} is not finite{}", v,
                              sizeof(R) == 4 && std::isinf(v) ? ", or was beyond single precision" : "");
    slot.real[row_ * slot.stride] = v;
  }

  // The length of a list; a text may claim any, and then ends too early.
  std::int64_t length(const Slot<R>& slot) {
    const std::int64_t n = in_.whole(*slot.count);
    if (n < 0 && in_.error.empty()) in_.error = fmt::format("a list has {} numbers", n);
    return in_.error.empty() ? n : 0;
  }

  void skip(const Slot<R>& slot) {
    if (!slot.count) return in_.skip(slot.type);
    for (std::int64_t n = length(slot); n > 0 && in_.error.empty(); --n) in_.skip(slot.type);
  }

  void indices(const Slot<R>& slot) {
    const std::int64_t n = length(slot);
    if (static_cast<std::size_t>(n) > (std::size_t{1} << 31) - out_.indices.size())
      in_.error = "the file has more than 2^31 corners";
    for (std::int64_t i = 0; i < n && in_.error.empty(); ++i) {
      const std::int64_t v = in_.whole(slot.type);
      if (in_.error.empty() && (v < 0 || static_cast<std::uint64_t>(v) >= limit_) && !(breaks_ && v == -1))
        in_.error = fmt::format("index {} is not one of {} vertices", v, limit_);
      out_.indices.push_back(static_cast<std::uint32_t>(v));
    }
    out_.sizes.push_back(static_cast<std::uint32_t>(n));
  }

  void corner_uv(const Slot<R>& slot) {
    has_uv_ = true;
    uv_.clear();
    for (std::int64_t n = length(slot); n > 0 && in_.error.empty(); --n) {
      uv_.push_back(in_.template real<R>(slot.type));
      if (!std::isfinite(uv_.back()) && in_.error.empty())
        in_.error = fmt::format("{} is not finite", uv_.back());
    }
  }

  void match_uv() {
    if (!has_uv_ || out_.sizes.empty()) return;
    const std::size_t need = 2 * std::size_t{out_.sizes.back()};
    if (uv_.size() != need) ++out_.odd_uv, uv_.assign(need, R{0});
    out_.corner_uv.insert(out_.corner_uv.end(), uv_.begin(), uv_.end());
  }

  Rows in_;
  std::span<const Slot<R>> slots_;
  std::uint64_t limit_;
  bool breaks_, has_uv_ = false;
  Lists<R>& out_;
  std::vector<R> uv_;
  std::uint64_t row_ = 0;
  std::size_t row_byte_ = 0;
};

}  // namespace

template <class R>
void decode(const Header& header, const Piece& piece, std::span<const Slot<R>> slots, std::uint64_t limit,
            bool breaks, Lists<R>& out) {
  const auto run = [&](auto rows) {
    Decoder<R, decltype(rows)>(std::move(rows), slots, limit, breaks, out).run(piece.first, piece.rows);
  };
  if (header.encoding == Encoding::ascii)
    run(AsciiRows(piece.bytes, header));
  else
    run(BinaryRows(piece.bytes, header));
}
template void decode(const Header&, const Piece&, std::span<const Slot<float>>, std::uint64_t, bool,
                     Lists<float>&);
template void decode(const Header&, const Piece&, std::span<const Slot<double>>, std::uint64_t, bool,
                     Lists<double>&);

}  // namespace frustum::ply
