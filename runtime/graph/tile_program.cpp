#include "runtime/graph/tile_program.h"

#include "runtime/core/float_environment.h"

#include <algorithm>
#include <new>

namespace frustum {
namespace {

constexpr std::size_t alignment = 64;
constexpr std::size_t cache_budget = std::size_t{1}
                                     << 20;  // a core's share of L2 on the processors of the last decade
constexpr double worst_area_ratio = 1.5;
constexpr int pixels_apart = 16;  // of f32, 64 bytes

std::size_t aligned(std::size_t n) { return (n + alignment - 1) / alignment * alignment; }

bool any(const std::vector<bool>& v) { return std::find(v.begin(), v.end(), true) != v.end(); }

// What of `stored` lies in `r`, begun and ended a little further out, so that its rows lie on vector boundaries, too.
Rect aligned_within(const Rect& stored, const Rect& r) {
  Rect part = intersection(stored, r);
  if (part.empty()) return part;
  part.x0 = stored.x0 + (part.x0 - stored.x0) / pixels_apart * pixels_apart;
  part.x1 =
      std::min(stored.x1, stored.x0 + (part.x1 - stored.x0 + pixels_apart - 1) / pixels_apart * pixels_apart);
  return part;
}

// Bytes of the planes that somebody reads, for a rectangle of this size.
std::size_t tile_bytes(const Frame& f, const std::vector<bool>& read, Rect r) {
  const auto values = static_cast<std::size_t>(padded_row(r.width())) * static_cast<std::size_t>(r.height()) *
                      static_cast<std::size_t>(f.samples());
  std::size_t sum = 0;
  for (std::size_t p = 0; p < f.planes.size(); ++p)
    if (read[p]) sum += aligned(values * bytes_of(f.planes[p].kind));
  return sum;
}

// Where in `r` an operation shows something because of the input that it is blank without: a pixel that is seen there shows
// in all that read it, as far to one side as reads() looks to the other.
Rect shown_through(const TileOp& op, std::size_t input, const Rect& seen, const Rect& r) {
  if (seen.empty()) return {};
  const Rect read = op.type->reads(op.prepared->state.get(), input, r);
  return intersection({seen.x0 - (read.x1 - r.x1), seen.y0 - (read.y1 - r.y1), seen.x1 + (r.x0 - read.x0),
                       seen.y1 + (r.y0 - read.y0)},
                      r);
}

}  // namespace

// ----- memory

void TileMemory::grow(std::size_t bytes) {
  const std::size_t size = std::max(aligned(bytes), 2 * block_.size());
  // Tiles in flight keep pointing into the old block, which lives until everything is given back.
  if (block_.size() > 0) retired_.push_back(std::move(block_));
  block_ = Pages(size, Contents::anything);
  pieces_ = {{0, size, false}};
}

std::byte* TileMemory::take(std::size_t bytes) {
  bytes = std::max(aligned(bytes), alignment);
  in_use_ += bytes;
  peak_ = std::max(peak_, in_use_);
  for (int attempt = 0; attempt < 2; ++attempt) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (pieces_[i].used || pieces_[i].size < bytes) continue;
      const Piece rest{pieces_[i].offset + bytes, pieces_[i].size - bytes, false};
      pieces_[i] = {pieces_[i].offset, bytes, true};
      if (rest.size != 0) pieces_.insert(pieces_.begin() + static_cast<std::ptrdiff_t>(i) + 1, rest);
      return block_.data() + pieces_[i].offset;
    }
    grow(in_use_);
  }
  throw std::bad_alloc();
}

void TileMemory::give_back(std::byte* p) {
  if (p < block_.data() || p >= block_.data() + block_.size())
    return;  // of a retired block: freed by clear()
  const auto offset = static_cast<std::size_t>(p - block_.data());
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    if (pieces_[i].offset != offset) continue;
    pieces_[i].used = false;
    in_use_ -= std::min(in_use_, pieces_[i].size);
    if (i + 1 < pieces_.size() && !pieces_[i + 1].used) {
      pieces_[i].size += pieces_[i + 1].size;
      pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
    if (i > 0 && !pieces_[i - 1].used) {
      pieces_[i - 1].size += pieces_[i].size;
      pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return;
  }
}

void TileMemory::clear() {
  retired_.clear();
  in_use_ = 0;
  if (block_.size() > 0) pieces_ = {{0, block_.size(), false}};
}

// ----- program

TileProgram::TileProgram(std::vector<TileOp> ops, std::vector<TileRoot> roots)
    : ops_(std::move(ops)), roots_(std::move(roots)), last_reader_(ops_.size()) {
  for (std::size_t i = 0; i < ops_.size(); ++i) {
    last_reader_[i] = i;
    for (const TileInput& in : ops_[i].inputs)
      if (in.op) last_reader_[*in.op] = i;
  }
  for (const TileRoot& r : roots_) last_reader_[r.op] = ops_.size();
}

std::vector<Rect> TileProgram::rectangles(std::span<const Rect> targets) const {
  std::vector<Rect> rects(ops_.size());
  for (std::size_t i = 0; i < roots_.size(); ++i) rects[roots_[i].op] = hull(rects[roots_[i].op], targets[i]);
  for (std::size_t i = ops_.size(); i-- > 0;) {
    if (rects[i].empty()) continue;
    const TileOp& op = ops_[i];
    // Linked, but prepare() of those who might have read it named none of its planes: it does not run.
    if (std::none_of(op.planes_read.begin(), op.planes_read.end(), any)) {
      rects[i] = {};
      continue;
    }
    for (std::size_t k = 0; k < op.inputs.size(); ++k) {
      if (!op.inputs[k].op) continue;
      const TileOp& from = ops_[*op.inputs[k].op];
      const Rect read = op.type->reads(op.prepared->state.get(), k, rects[i]);
      Rect& r = rects[*op.inputs[k].op];
      r = hull(r, intersection(read, from.prepared->frames[op.inputs[k].port]->window));
    }
  }
  return rects;
}

// The part of each operation's rectangle that may show something, in the order of the data: what it finds by itself (seen),
// and what its input shows, where it is blank else. Of what says neither, all.
std::vector<Rect> TileProgram::seen_in(std::span<const Rect> rects) const {
  std::vector<Rect> seen(rects.begin(), rects.end());
  for (std::size_t i = 0; i < ops_.size(); ++i) {
    const TileOp& op = ops_[i];
    const Rect r = rects[i];
    const auto& blank_where = op.type->blank_where;
    const bool finds = static_cast<bool>(op.type->seen);
    if (r.empty() || (!finds && !blank_where)) continue;
    Rect shown;
    if (finds) shown = intersection(op.type->seen(op.prepared->state.get(), r), r);
    if (blank_where) {
      const auto from = op.inputs[*blank_where].op;
      shown = hull(shown, from ? shown_through(op, *blank_where, seen[*from], r) : r);
    }
    seen[i] = shown;
  }
  return seen;
}

std::vector<TileProgram::Area> TileProgram::areas(std::span<const Rect> targets) const {
  const std::vector<Rect> rects = rectangles(targets), seen = seen_in(rects);
  std::vector<Area> areas(ops_.size());
  for (std::size_t i = 0; i < roots_.size(); ++i) {
    Rect& stored = areas[roots_[i].op].stored;
    stored = hull(stored, targets[i]);
  }
  for (std::size_t i = ops_.size(); i-- > 0;) {
    const TileOp& op = ops_[i];
    Area& area = areas[i];
    if (rects[i].empty()) area.stored = {};
    area.filled = op.type->blank_where && !op.everywhere ? aligned_within(area.stored, seen[i]) : area.stored;
    for (std::size_t k = 0; k < op.inputs.size() && !area.filled.empty(); ++k) {
      if (!op.inputs[k].op) continue;
      const Rect read = op.type->reads(op.prepared->state.get(), k, area.filled);
      const Rect window = ops_[*op.inputs[k].op].prepared->frames[op.inputs[k].port]->window;
      Rect& stored = areas[*op.inputs[k].op].stored;
      stored = hull(stored, intersection(read, window));
    }
  }
  return areas;
}

std::vector<TileProgram::Pixels> TileProgram::count_blank() const {
  constexpr int edge = 256;
  std::vector<Pixels> pixels(ops_.size());
  Rect all;
  for (const TileRoot& r : roots_) all = hull(all, frame(r).window);
  std::vector<Rect> targets(roots_.size());
  for (int y = all.y0; y < all.y1; y += std::min(edge, all.y1 - y))
    for (int x = all.x0; x < all.x1; x += std::min(edge, all.x1 - x)) {
      const Rect tile{x, y, x + std::min(edge, all.x1 - x), y + std::min(edge, all.y1 - y)};
      for (std::size_t r = 0; r < roots_.size(); ++r)
        targets[r] = intersection(tile, frame(roots_[r]).window);
      const std::vector<Rect> rects = rectangles(targets);
      const std::vector<Area> areas = this->areas(targets);
      for (std::size_t i = 0; i < ops_.size(); ++i) {
        pixels[i].all += static_cast<std::uint64_t>(rects[i].area());
        pixels[i].blank += static_cast<std::uint64_t>(rects[i].area() - areas[i].filled.area());
      }
    }
  return pixels;
}

// The tiles of one call of run(): plane pointers and views by operation and output.
struct TileProgram::Live {
  struct Output {
    std::vector<std::byte*> planes;
    Tile tile;
  };
  std::vector<std::vector<Output>> outputs;
  std::vector<Tile> in, out;  // of the operation that runs

  explicit Live(std::span<const TileOp> ops) : outputs(ops.size()) {
    for (std::size_t i = 0; i < ops.size(); ++i) outputs[i].resize(ops[i].planes_read.size());
  }
};

// Where an output's tile lies: in the target itself for a root that is filled exactly, else in the worker's memory.
Tile TileProgram::place(std::size_t op, std::size_t port, Rect rect, std::span<const Tile> targets,
                        TileMemory& memory, std::vector<std::byte*>& planes) const {
  for (std::size_t r = 0; r < roots_.size(); ++r)
    if (roots_[r].op == op && roots_[r].port == port && !targets[r].empty() && targets[r].rect() == rect)
      return targets[r];
  const Frame& frame = *ops_[op].prepared->frames[port];
  const std::ptrdiff_t row = padded_row(rect.width());
  for (std::size_t p = 0; p < frame.planes.size(); ++p) {
    const auto bytes = static_cast<std::size_t>(row) * static_cast<std::size_t>(rect.height()) *
                       static_cast<std::size_t>(frame.samples()) * bytes_of(frame.planes[p].kind);
    planes.push_back(ops_[op].planes_read[port][p] ? memory.take(bytes) : nullptr);
  }
  return {&frame, rect, rect, row, row * rect.height(), planes};
}

// Places the outputs of an operation, blank but for what tile() is to fill.
void TileProgram::place_outputs(std::size_t op, const Area& area, std::span<const Tile> targets,
                                TileMemory& memory, Live& live) const {
  live.out.clear();
  for (std::size_t port = 0; port < live.outputs[op].size(); ++port) {
    auto& [planes, tile] = live.outputs[op][port];
    if (any(ops_[op].planes_read[port])) {
      tile = place(op, port, area.stored, targets, memory, planes);
      if (area.filled != area.stored) blank_around(tile, area.filled);
    }
    live.out.push_back(tile.empty() ? tile : tile.part(area.filled));
  }
}

void TileProgram::find_inputs(std::size_t op, Live& live) const {
  live.in.clear();
  for (const TileInput& input : ops_[op].inputs) {
    if (input.op)
      live.in.push_back(live.outputs[*input.op][input.port].tile);
    else if (input.whole)
      live.in.push_back(input.whole->view());
    else
      live.in.emplace_back();
  }
}

// Gives back what nobody reads after this operation.
void TileProgram::give_back(std::size_t op, TileMemory& memory, const Live& live) const {
  for (std::size_t earlier = 0; earlier <= op; ++earlier) {
    if (last_reader_[earlier] != op) continue;
    for (const auto& o : live.outputs[earlier])
      for (std::byte* p : o.planes)
        if (p != nullptr) memory.give_back(p);
  }
}

std::vector<Rect> TileProgram::run(std::span<const Tile> targets, TileWorker& worker,
                                   const After& after) const {
  using Clock = std::chrono::steady_clock;
  worker.memory.clear();
  worker.costs.time.resize(ops_.size());
  worker.costs.pixels.resize(ops_.size());

  std::vector<Rect> wanted;
  for (const Tile& t : targets) wanted.push_back(t.empty() ? Rect{} : t.rect());
  const std::vector<Area> areas = this->areas(wanted);

  Live live(ops_);
  for (std::size_t i = 0; i < ops_.size(); ++i) {
    const TileOp& op = ops_[i];
    const auto start = Clock::now();
    if (!areas[i].stored.empty()) place_outputs(i, areas[i], targets, worker.memory, live);
    if (!areas[i].filled.empty()) {
      find_inputs(i, live);
      worker.arena.reset();
      {
        const FloatEnvironment environment;
        op.type->tile(op.prepared->state.get(), live.in, live.out, worker.arena);
      }
      if (after) after(i, live.in, live.out);
    }
    worker.costs.time[i] += Clock::now() - start;
    worker.costs.pixels[i] += static_cast<std::uint64_t>(areas[i].filled.area());
    give_back(i, worker.memory, live);
  }
  for (std::size_t r = 0; r < roots_.size(); ++r) {
    if (wanted[r].empty()) continue;
    const Tile& made = live.outputs[roots_[r].op][roots_[r].port].tile;
    if (!made.shares_storage(targets[r])) copy(made, targets[r]);
    wanted[r] = intersection(wanted[r], areas[roots_[r].op].filled);
  }
  return wanted;
}

TileProgram::Estimate TileProgram::estimate(int edge) const {
  std::vector<Rect> targets;
  for (const TileRoot& r : roots_) {
    const Rect w = frame(r).window;
    const int x = (w.x0 + w.x1 - edge) / 2, y = (w.y0 + w.y1 - edge) / 2;
    targets.push_back(intersection({x, y, x + edge, y + edge}, w));
  }
  const std::vector<Rect> rects = rectangles(targets);
  double asked = 1;
  for (const Rect& t : targets) asked = std::max(asked, static_cast<double>(t.area()));

  Estimate e;
  std::vector<std::size_t> bytes(ops_.size());
  std::size_t live = 0;
  for (std::size_t i = 0; i < ops_.size(); ++i) {
    for (std::size_t o = 0; o < ops_[i].planes_read.size(); ++o)
      bytes[i] += tile_bytes(*ops_[i].prepared->frames[o], ops_[i].planes_read[o], rects[i]);
    live += bytes[i];
    e.live_bytes = std::max(e.live_bytes, live);
    for (std::size_t earlier = 0; earlier <= i; ++earlier)
      if (last_reader_[earlier] == i) live -= bytes[earlier];
    const double ratio = static_cast<double>(rects[i].area()) / asked;
    if (ratio > e.area_ratio) {
      e.area_ratio = ratio;
      e.worst = i;
    }
  }
  return e;
}

int TileProgram::choose_edge() const {
  int edge = 128;
  while (edge > 16 && estimate(edge).live_bytes > cache_budget) edge /= 2;
  while (edge < 128 && estimate(edge).area_ratio > worst_area_ratio) edge *= 2;
  return edge;
}

}  // namespace frustum
