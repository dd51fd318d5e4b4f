// From a document and the graphs it uses as nodes to one flat list of nodes with their parameters read and their links
// followed to where the data comes from.
#pragma once

#include "runtime/graph/document.h"
#include "runtime/graph/load.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

// A value for a parameter, and who gave it.
struct GivenValue {
  std::shared_ptr<const Json> value;  // nothing in it stands for anything else any more
  std::string folder;                 // what relative paths in it start from
  const SourceText* text = nullptr;   // where it is written; null where it comes from outside
  std::string pointer;
  std::string setting = {};  // "samples=4" of --set samples=4
};

// One use of a document: the top one, or a graph-as-node.
struct Instance {
  const Document* document = nullptr;
  const Instance* parent = nullptr;
  const DocumentNode* node = nullptr;  // of the parent's document
  std::string prefix = {};             // of the ids inside: "draw/"
  Precision precision = Precision::single;
  std::map<std::string, GivenValue, std::less<>> params = {};     // of the document, by name
  std::map<std::string, GivenValue, std::less<>> overrides = {};  // of nodes inside, by address

  struct Member {
    std::optional<std::size_t> flat = {};  // a node of Flat
    std::unique_ptr<Instance> graph = {};
  };
  std::vector<Member> members = {};  // one a node of the document

  bool is_inside(const Instance* other) const;
};

// A link on its way into a graph-as-node.
struct Crossing {
  const Instance* instance;  // the graph that is entered
  std::size_t input;         // of its document
  const Link* link;          // written in the parent's document
};

// What a link leads to when it is followed through all graphs.
struct Edge {
  enum class Kind { bad, port, literal, open, left_out };
  Kind kind = Kind::bad;
  const Link* link = nullptr;  // as written at the reader
  PortRef from = {};           // port: of Flat
  const Json* literal = nullptr;
  const Instance* instance =
      nullptr;            // literal: where it is written; open, left_out: whose input is not given
  std::size_t input = 0;  // open, left_out: of that instance's document
  std::string literal_pointer = {};
  std::vector<Crossing> crossings = {};  // outermost first
};

// Why something is not there: an optional input of a graph-as-node that is not given.
struct LeftOut {
  const Instance* graph = nullptr;  // null: it is there
  std::size_t input = 0;            // of the graph's document
};

// The parameters of a node, and where those stand that are not left to their defaults.
struct FlatParams {
  struct Place {
    std::string name;
    const SourceText* text;
    std::string pointer;
    std::string setting = {};  // "samples=4" where the value comes from --set samples=4
  };
  std::shared_ptr<void> values;
  std::vector<Place> places;
};

struct FlatNode {
  const DocumentNode* node = nullptr;
  const Instance* instance = nullptr;
  std::string id;
  Precision precision = Precision::single;
  FlatParams params;
  std::vector<std::vector<Edge>> inputs;  // one list an input of the type
  LeftOut left_out = {};                  // it does not run

  const NodeType& type() const { return *node->type; }
};

struct Flat {
  std::unique_ptr<Instance> top;
  std::vector<FlatNode> nodes;  // by the order of the files
};

// Never fails: what is wrong is reported and left empty.
Flat flatten(const Document&, const LoadOptions&, Diagnostics&);

// Follows a link written in `scope`; more than one edge where it takes a list input. `budget` bounds the work on graphs that
// multiply links; -1 when it is spent.
std::vector<Edge> follow(const Instance& scope, const Link&, Diagnostics&, int& budget);

// `value` with every "$name" replaced by the graph parameter of `scope` and "$$" by '$'; null where one is not there.
// `used`, if given, becomes the first one that was taken.
std::optional<Json> substitute(const Json& value, const Instance& scope, const GivenValue** used = nullptr);

// Adds to the graph's parameters and overrides what stands outside of the file. Unknown addresses are reported.
void apply_settings(Instance& top, const LoadOptions&, Diagnostics&);

// The parameters of a node: defaults, then what is written, then what overrides it; and whether they fit together.
FlatParams read_params(const DocumentNode&, const Instance&, const LoadOptions&, Diagnostics&);

// A literal read as a buffer of `kind`; empty, and reported, where that fails.
Buffer read_literal(const Edge&, const BufferType& kind, const LoadOptions&, Diagnostics&);

// Adds the problems of a reader, placed; for a graph-as-node its use is a related place.
void report_inside(Diagnostics&, const Instance&, Diagnostic, bool at_key = false);

}  // namespace frustum
