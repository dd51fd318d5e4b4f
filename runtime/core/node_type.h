// A node type: three plain structs and a function, described once.
//
//   struct Inputs  { Ref<Mesh> mesh; };
//   struct Params  { double guard_band = 1.0; };
//   struct Outputs { Ref<Mesh> mesh; };
//   Outputs run(const Inputs&, const Params&, Context&);
//
//   NodeType nodes::clip_homogeneous() {
//     return node("clip.homogeneous", run).doc("...").input("mesh", &Inputs::mesh, "...") ... ;
//   }
//
// Kinds of input members: Ref<T> (whole), Tiled<T> (streams; pixel nodes only), std::vector<Ref<T>> (a list of links),
// std::optional<Ref<T>> and std::optional<Tiled<T>> (may be left out), std::variant<Ref<A>, Ref<B>> (one of several kinds;
// an output that is the same variant follows the input).
//
// A pixel node has, instead of run():
//   Prepared<State, Outputs> prepare(const Inputs&, const Params&, Context&);
//   void tile(const State&, const TilesOf<Inputs>&, const TilesOf<Outputs>&, Arena&);
// where tile() is a pure function of absolute (x, y, sample): it fills the rectangle of each output tile (all output tiles of
// a call have the same rectangle), reads its input tiles (at least the rectangle that reads() names, cut to their windows),
// and knows no other pixel.
#pragma once

#include "runtime/core/buffer.h"
#include "runtime/core/context.h"
#include "runtime/core/param.h"
#include "runtime/core/space.h"
#include "runtime/core/tiled.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace frustum {

struct PortOptions {
  Spaces space =
      {};  // input: the spaces it takes; output: the space it gives (empty: that of the first input of its kind)
};

struct Port {
  std::string name;
  std::string doc;
  std::vector<const BufferType*> types;  // one, or the alternatives of a variant
  bool list = false, optional = false, tiled = false;
  Spaces spaces = {};
  std::size_t offset = 0;  // of the member in Inputs or Outputs

  bool takes(const BufferType& t) const {
    for (const BufferType* mine : types)
      if (mine == &t) return true;
    return false;
  }
};

// What the runtime hands to an input of a pixel node at preparation: a whole buffer, or the frame that will stream.
struct TiledInput {
  std::shared_ptr<const Frame> frame;              // null: the input is whole or left out
  std::shared_ptr<std::vector<bool>> planes_read;  // set by Tiled<T>::read()
};
struct PreparedInput {
  std::vector<Buffer> buffers;
  TiledInput tiled;
};

// A pixel node ready to fill tiles; immutable, shared by all threads.
struct PreparedNode {
  std::shared_ptr<const void> state;
  std::vector<std::shared_ptr<const Frame>> frames;  // one a declared output
};

class NodeType {
 public:
  // ----- what it is
  std::string name, doc;
  std::vector<std::string> citations;
  std::vector<int> rows;           // of the course's checklist
  int version = 1;                 // in the cache key: raised when the same inputs give other bytes
  bool foreign = false;            // a library computes its numbers: same bytes on one processor only
  std::vector<EffectDoc> effects;  // decided in this order, before run() or prepare()
  std::vector<Port> inputs, outputs;
  ParamType params{.kind = ParamType::Kind::record, .name = "an object"};

  // ----- what it does
  std::function<std::shared_ptr<void>()> default_params;
  // Throws NodeError for parameters that are wrong whatever the inputs are; empty: each is right by itself.
  std::function<void(const void* params)> check;
  // A sentence on what holds for other nodes because of these parameters, shown by `frustum plan`; may be empty.
  std::function<std::string(const void* params)> states;

  bool is_pixel() const { return static_cast<bool>(tile); }
  std::function<std::vector<Buffer>(std::span<const std::vector<Buffer>> inputs, const void* params,
                                    Context&)>
      run;

  std::function<PreparedNode(std::span<const PreparedInput> inputs, const void* params, Context&)> prepare;
  std::function<void(const void* state, std::span<const Tile> in, std::span<const Tile> out, Arena&)> tile;
  // The rectangle of an input that filling `rect` reads; not cut to the input's window.
  std::function<Rect(const void* state, std::size_t input, Rect rect)> reads;
  // A part of `rect` outside of which nothing is seen, whatever is drawn; empty: it may be seen anywhere.
  std::function<Rect(const void* state, Rect rect)> seen;
  // The input that must show something: where it is blank throughout what reads() names, all outputs are blank, so that
  // tile() need not be called there. Blank is 0, and no_face in planes of integers.
  std::optional<std::size_t> blank_where = {};

  // ----- checks of the declaration itself
  std::size_t input_members = 0, output_members = 0,
              param_members = 0;  // of the structs: all must be described

  std::optional<std::size_t> find_input(std::string_view port) const;
  std::optional<std::size_t> find_output(std::string_view port) const;
};

}  // namespace frustum

#include "runtime/core/node_builder.h"
