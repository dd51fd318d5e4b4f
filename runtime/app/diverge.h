// Where two settings of a graph part: node by node, what each loses itself and what it inherits.
//
// With y_a and y_b a port on the two sides (b is the reference), and node(inputs) the node run once more:
//   total      y_a against y_b
//   local      node_a(inputs of b, rounded to a's precision) against y_b: what this node loses by itself
//   inherited  node_b(inputs of a) against y_b: what it makes of the error in its inputs
// To first order total <= local + inherited; more than that is said (`interacts`). The course of the method
// is that of forward error analysis, Higham 2002, sections 1.5 and 3.4.
#pragma once

#include "runtime/app/metrics/difference.h"
#include "runtime/app/session.h"

#include <optional>
#include <string>
#include <vector>

namespace frustum {

struct DivergeOptions {
  std::string graph;
  LoadOptions load = {};  // settings of both sides
  std::vector<Setting> a = {},
                       b = {};  // "precision" sets that of the whole graph; both empty: single against double
  std::vector<std::string> wanted =
      {};  // outputs and ports whose upstream is compared; none: all of the graph
  int threads = 0;
  const CancelFlag* cancel = nullptr;
};

// One error of one port, as numbers that compare across ports.
struct PortError {
  std::string mismatch;  // of sizes: decisions went other ways, and no numbers compare
  double max = 0, rmse = 0;
  double relative = 0;      // max over the largest number of the reference
  std::uint64_t flips = 0;  // ids that are other ones
  std::uint64_t nan = 0;
  bool identical = true;
  // log2(1 / relative): bits that both agree in; infinite where they are equal (MFC's scale-free measure).
  double bits() const;
};

struct PortDivergence {
  std::string port, type, kind;  // "draw/hits.visibility", "rasterize.triangles", "visibility"
  std::string file;              // of the node, and where it stands there
  int line = 0;
  PortError total, local, inherited;
  double input = 0;        // largest relative total error of the node's inputs
  double digits_lost = 0;  // log10(local relative error / unit roundoff of a), 0 below it
  bool interacts = false;  // total is more than twice local + inherited
  // inherited over input: what the node makes of the error it is given; 0 where the inputs are the same.
  double amplification() const;
};

struct Divergence {
  std::string a, b;                   // the two settings, as text
  std::vector<PortDivergence> ports;  // in running order
  std::optional<std::size_t> first;   // of ports: the first that differs
  std::vector<std::size_t> by_local;  // those that lose something themselves, most digits first
};

// Nothing where a graph has problems, which are reported. The two graphs must have the same nodes. Every node
// runs four times, one at a time, so memory holds only what later nodes still read. Throws NodeError,
// RunFailure, WorldError, Cancelled.
std::optional<Divergence> diverge(Session&, const DivergeOptions&, Diagnostics& problems);

Json to_json(const Divergence&);
std::string diverge_text(const Divergence&);

}  // namespace frustum
