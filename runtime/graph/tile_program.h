// A chain of pixel nodes, ready to fill any rectangle of its roots.
#pragma once

#include "runtime/core/node_type.h"
#include "runtime/core/pages.h"
#include "runtime/core/raster.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace frustum {

// Where an operation's tiled input comes from.
struct TileInput {
  std::optional<std::size_t> op;     // an earlier operation of the program
  std::size_t port = 0;              // of that operation
  std::optional<Raster> whole = {};  // or a raster in memory; neither: the input is left out or not tiled
};

struct TileOp {
  const NodeType* type = nullptr;
  std::shared_ptr<const PreparedNode> prepared;
  std::vector<TileInput> inputs;               // one an input of the type
  std::vector<std::vector<bool>> planes_read;  // [output][plane]; an output that nobody reads has none set
  bool everywhere = false;                     // runs where it is blank, too
};

// A port whose pixels are wanted, and the root's index among the targets of run().
struct TileRoot {
  std::size_t op = 0, port = 0;
};

// What running tiles cost, summed by operation.
struct TileCosts {
  std::vector<std::chrono::nanoseconds> time;
  std::vector<std::uint64_t> pixels;
};

// Memory of one thread: tiles are carved from one block and given back after their last reader.
class TileMemory {
 public:
  std::byte* take(std::size_t bytes);
  void give_back(std::byte* p);
  void clear();                               // everything given back
  std::size_t peak() const { return peak_; }  // of bytes taken at once, since construction

 private:
  struct Piece {
    std::size_t offset, size;
    bool used;
  };
  void grow(std::size_t bytes);
  std::vector<Pages> retired_;
  Pages block_;
  std::size_t in_use_ = 0, peak_ = 0;
  std::vector<Piece> pieces_;
};

// The scratch of one thread.
struct TileWorker {
  TileMemory memory;
  Arena arena;
  TileCosts costs;
};

class TileProgram {
 public:
  TileProgram(std::vector<TileOp> ops, std::vector<TileRoot> roots);

  const std::vector<TileOp>& ops() const { return ops_; }
  const std::vector<TileRoot>& roots() const { return roots_; }
  const Frame& frame(const TileRoot& r) const { return *ops_[r.op].prepared->frames[r.port]; }

  // Fills the rectangle of each target (one a root; an empty rect is skipped). `after` sees every operation's finished
  // outputs with its inputs, for health checks and inspections. Returns the part of each target that may show something:
  // around it, it is blank.
  using After = std::function<void(std::size_t op, std::span<const Tile> in, std::span<const Tile> out)>;
  std::vector<Rect> run(std::span<const Tile> targets, TileWorker& worker, const After& after = {}) const;

  // What one operation does for given targets: tile() fills `filled`, and around it `stored` is blank.
  struct Area {
    Rect stored, filled;
  };
  // Where nothing is seen, what is blank there (NodeType::blank_where) is not run, nor is what only that reads.
  std::vector<Area> areas(std::span<const Rect> targets) const;

  // The pixels that each operation would fill whatever is seen there, and how many of them are left out, in tiles of 256 px
  // over the roots' windows.
  struct Pixels {
    std::uint64_t all = 0, blank = 0;
  };
  std::vector<Pixels> count_blank() const;

  // The rectangle that each operation fills for the given targets, whatever is seen there: propagated backwards through
  // reads().
  std::vector<Rect> rectangles(std::span<const Rect> targets) const;

  struct Estimate {
    std::size_t live_bytes = 0;  // the most that is live at once
    double area_ratio = 1;       // the worst of pixels filled by an operation over pixels asked for
    std::optional<std::size_t> worst = {};  // the operation whose reads() makes it so
  };
  // For a square tile of `edge` in the middle of the roots' windows.
  Estimate estimate(int edge) const;

  // The edge from 16 to 128 whose live planes stay within 1 MB, or larger where smaller tiles would compute more than
  // 1.5 times the pixels.
  int choose_edge() const;

 private:
  struct Live;
  void place_outputs(std::size_t op, const Area&, std::span<const Tile> targets, TileMemory&, Live&) const;
  void find_inputs(std::size_t op, Live&) const;
  void give_back(std::size_t op, TileMemory&, const Live&) const;
  std::vector<Rect> seen_in(std::span<const Rect> rects) const;
  Tile place(std::size_t op, std::size_t port, Rect rect, std::span<const Tile> targets, TileMemory&,
             std::vector<std::byte*>& planes) const;

  std::vector<TileOp> ops_;
  std::vector<TileRoot> roots_;
  std::vector<std::size_t> last_reader_;  // of each operation's tiles; ops_.size() for a root's
};

}  // namespace frustum
