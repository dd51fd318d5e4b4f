#include "runtime/app/diverge.h"

#include "runtime/app/run_failure.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/numbers.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace frustum {
namespace {

// ----- rounding a buffer to a precision, both ways

Raster in_precision(const Raster& raster, PlaneKind real) {
  Frame frame = raster.frame();
  bool same = true;
  for (Plane& p : frame.planes)
    if (p.kind != PlaneKind::u32) same &= p.kind == real, p.kind = real;
  if (same) return raster;
  Raster out(frame);
  const Tile to = out.view();
  for (int p = 0; p < static_cast<int>(frame.planes.size()); ++p)
    for (int s = 0; s < frame.samples(); ++s)
      for (int y = frame.window.y0; y < frame.window.y1; ++y)
        for (int i = 0; i < frame.window.width(); ++i) {
          const int x = frame.window.x0 + i;
          switch (frame.planes[static_cast<std::size_t>(p)].kind) {
            case PlaneKind::f32:
              to.row<float>(p, s, y)[i] = static_cast<float>(raster.value(p, s, x, y));
              break;
            case PlaneKind::f64: to.row<double>(p, s, y)[i] = raster.value(p, s, x, y); break;
            case PlaneKind::u32:
              to.row<std::uint32_t>(p, s, y)[i] = raster.at<std::uint32_t>(p, s, x, y);
              break;
          }
        }
  return out;
}

Ref<Column> in_precision(const Ref<Column>& column, NumberKind real) {
  if (column->kind() == real || column->kind() == NumberKind::i32 || column->kind() == NumberKind::u32)
    return column;
  if (real == NumberKind::f64) return as_precision(column, real);
  auto out = std::make_shared<Column>(column->name(), column->domain(), real, column->width(), column->rows(),
                                      column->space());
  const auto* from = static_cast<const double*>(column->data());
  auto* to = static_cast<float*>(out->data());
  for (std::size_t i = 0; i < column->rows() * static_cast<std::size_t>(column->width()); ++i)
    to[i] = static_cast<float>(from[i]);
  return out;
}

// Cameras, lights, surfaces and the like have one precision and are passed as they are.
Buffer in_precision(const Buffer& b, Precision precision) {
  const bool single = precision == Precision::single;
  if (b && b.type().is_pixels())
    return b.type().from_raster(
        in_precision(b.type().raster(b.data()), single ? PlaneKind::f32 : PlaneKind::f64));
  if (!b.is<Mesh>()) return b;
  Mesh mesh = *b.as<Mesh>();
  for (Ref<Column>& c : mesh.columns) c = in_precision(c, single ? NumberKind::f32 : NumberKind::f64);
  return Ref<Mesh>(std::make_shared<const Mesh>(std::move(mesh)));
}

// ----- errors

PortError error_of(const Buffer& y, const Buffer& reference) {
  PortError e;
  if (!y || !reference) return e;
  const Difference d = compare(y, reference);
  e.mismatch = d.mismatch;
  e.identical = d.mismatch.empty() && d.nan == 0 && d.wrong_ids == 0 && (d.differing == 0 || d.max == 0);
  e.max = d.max, e.rmse = d.rmse, e.flips = d.wrong_ids, e.nan = d.nan;
  if (d.max > 0) e.relative = d.largest > 0 ? d.max / d.largest : std::numeric_limits<double>::infinity();
  if (d.nan != 0) e.relative = std::numeric_limits<double>::quiet_NaN();
  return e;
}

// Something that has no number: sizes that differ, ids, NaN.
bool has_no_number(const PortError& e) { return !e.mismatch.empty() || e.nan != 0; }

std::string text_of(const std::vector<Setting>& settings) {
  std::string out;
  for (const Setting& s : settings)
    out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", s.address, s.value);
  return out.empty() ? "as it is" : out;
}

// One side: its graph, and the buffers that later nodes still read.
struct Side {
  Graph graph;
  std::map<PortRef, Buffer> buffers;
};

class Comparison {
 public:
  Comparison(Session& session, const DivergeOptions& options, Diagnostics& problems)
      : session_(session), o_(options), problems_(problems) {}

  std::optional<Divergence> run() {
    auto a = o_.a, b = o_.b;
    if (a.empty() && b.empty()) a = {{"precision", "single"}}, b = {{"precision", "double"}};
    auto graph_a = load(a), graph_b = load(b);
    if (!graph_a || !graph_b) return std::nullopt;
    a_.graph = std::move(*graph_a), b_.graph = std::move(*graph_b);
    require_same_nodes();
    if (!find_needed()) return std::nullopt;
    result_.a = text_of(a), result_.b = text_of(b);
    for (std::size_t n = 0; n < a_.graph.nodes.size(); ++n)
      if (needed_[n]) compare_node(n);
    rank();
    return std::move(result_);
  }

 private:
  std::optional<Graph> load(const std::vector<Setting>& settings) {
    LoadOptions options = o_.load;
    for (const Setting& s : settings)
      if (s.address == "precision")
        options.precision = s.value == "double" ? Precision::real_double : Precision::single;
      else
        options.settings.push_back(s);
    Loaded loaded = session_.load(o_.graph, std::move(options));
    if (!loaded.graph) problems_.add(loaded.problems);
    return std::move(loaded.graph);
  }

  void require_same_nodes() const {
    const auto same = [](const GraphNode& x, const GraphNode& y) { return x.id == y.id && x.type == y.type; };
    if (!std::equal(a_.graph.nodes.begin(), a_.graph.nodes.end(), b_.graph.nodes.begin(),
                    b_.graph.nodes.end(), same))
      throw NodeError("not_comparable",
                      "the two settings make graphs of other nodes, which do not compare node by node");
  }

  // What feeds the wanted ports, and how often each port is read.
  bool find_needed() {
    needed_.assign(b_.graph.nodes.size(), false);
    std::vector<PortRef> ends = o_.wanted.empty() ? end_ports(b_.graph) : std::vector<PortRef>();
    for (const std::string& address : o_.wanted) {
      const auto port = port_of(b_.graph, address, problems_);
      if (!port) return false;
      ends.push_back(*port);
    }
    for (const PortRef p : ends) needed_[p.node] = true;
    for (std::size_t n = needed_.size(); n-- > 0;) {
      if (!needed_[n]) continue;
      for (const auto& list : b_.graph.nodes[n].inputs)
        for (const Source& s : list)
          if (const auto* from = std::get_if<PortRef>(&s)) needed_[from->node] = true, ++readers_[*from];
    }
    return true;
  }

  // ----- one node

  using Inputs = std::vector<std::vector<Source>>;

  // The node's inputs as buffers of one side, in the node's own precision.
  Inputs inputs_from(const GraphNode& node, const Side& side) const {
    Inputs in = node.inputs;
    for (auto& list : in)
      for (Source& s : list)
        if (const auto* from = std::get_if<PortRef>(&s))
          s = in_precision(side.buffers.at(*from), node.precision);
    return in;
  }

  // All outputs of one node, run alone.
  std::vector<Buffer> run_alone(const Graph& of, std::size_t n, Inputs inputs) {
    Graph graph;
    graph.file = of.file, graph.seed = of.seed;
    graph.nodes = {of.nodes[n]};
    graph.nodes[0].inputs = std::move(inputs);
    RunOptions options;
    for (std::size_t p = 0; p < graph.nodes[0].type->outputs.size(); ++p)
      options.demand.ports.push_back({0, p});
    options.threads = o_.threads;
    options.cancel = o_.cancel;
    RunResult r = finished(session_.run(graph, options, false));
    std::vector<Buffer> out;
    for (const PortRef p : options.demand.ports) out.push_back(r.buffers[p]);
    return out;
  }

  // Inputs that are the same on both sides need no second run.
  bool same_inputs(const GraphNode& node) const {
    for (const auto& list : node.inputs)
      for (const Source& s : list)
        if (const auto* from = std::get_if<PortRef>(&s); from != nullptr && !identical_.at(*from))
          return false;
    return true;
  }

  void compare_node(std::size_t n) {
    const GraphNode &node_a = a_.graph.nodes[n], &node_b = b_.graph.nodes[n];
    const auto y_a = run_alone(a_.graph, n, inputs_from(node_a, a_)),
               y_b = run_alone(b_.graph, n, inputs_from(node_b, b_));
    const bool same = same_inputs(node_b);
    const auto local = same ? y_a : run_alone(a_.graph, n, inputs_from(node_a, b_));
    const auto inherited = same ? y_b : run_alone(b_.graph, n, inputs_from(node_b, a_));
    const double roundoff =
        node_a.precision == Precision::single ? std::ldexp(1.0, -24) : std::ldexp(1.0, -53);
    for (std::size_t p = 0; p < y_b.size(); ++p) {
      if (!y_b[p]) continue;
      PortDivergence row{.port = b_.graph.name({n, p}),
                         .type = node_b.type->name,
                         .kind = std::string(y_b[p].type().name),
                         .file = node_b.place.file,
                         .line = node_b.place.line,
                         .total = error_of(y_a[p], y_b[p]),
                         .local = error_of(local[p], y_b[p]),
                         .inherited = error_of(inherited[p], y_b[p])};
      row.input = input_error(node_b);
      row.digits_lost = row.local.relative > roundoff ? std::log10(row.local.relative / roundoff) : 0;
      row.interacts = row.total.max > 2 * (row.local.max + row.inherited.max);
      identical_[{n, p}] = row.total.identical;
      error_[{n, p}] = row.total.relative;
      if (!row.total.identical && !result_.first) result_.first = result_.ports.size();
      result_.ports.push_back(std::move(row));
      if (readers_.contains({n, p})) a_.buffers[{n, p}] = y_a[p], b_.buffers[{n, p}] = y_b[p];
    }
    release(node_b);
  }

  double input_error(const GraphNode& node) const {
    double worst = 0;
    for (const auto& list : node.inputs)
      for (const Source& s : list)
        if (const auto* from = std::get_if<PortRef>(&s)) worst = std::max(worst, error_.at(*from));
    return worst;
  }

  void release(const GraphNode& node) {
    for (const auto& list : node.inputs)
      for (const Source& s : list)
        if (const auto* from = std::get_if<PortRef>(&s); from != nullptr && --readers_[*from] == 0)
          a_.buffers.erase(*from), b_.buffers.erase(*from);
  }

  void rank() {
    auto& ports = result_.ports;
    for (std::size_t i = 0; i < ports.size(); ++i)
      if (!ports[i].local.identical) result_.by_local.push_back(i);
    const auto weight = [&](std::size_t i) {
      return has_no_number(ports[i].local) ? std::numeric_limits<double>::infinity()
                                           : ports[i].local.relative;
    };
    std::stable_sort(result_.by_local.begin(), result_.by_local.end(),
                     [&](std::size_t i, std::size_t j) { return weight(i) > weight(j); });
  }

  Session& session_;
  const DivergeOptions& o_;
  Diagnostics& problems_;
  Side a_, b_;
  std::vector<bool> needed_;
  std::map<PortRef, int> readers_;
  std::map<PortRef, bool> identical_;
  std::map<PortRef, double> error_;
  Divergence result_;
};

Json error_json(const PortError& e) {
  if (!e.mismatch.empty()) return {{"mismatch", e.mismatch}};
  return {{"max", json_number(e.max)},
          {"rmse", json_number(e.rmse)},
          {"relative", json_number(e.relative)},
          {"bits", json_number(e.bits())},
          {"flips", e.flips},
          {"nan", e.nan},
          {"identical", e.identical}};
}

std::string shown(const PortError& e) {
  if (!e.mismatch.empty()) return "other sizes";
  if (e.nan != 0) return fmt::format("{} NaN", e.nan);
  if (e.identical) return "0";
  std::string out = e.max > 0 ? fmt::format("{:.2g} ({:.0f} bits)", e.max, e.bits()) : "";
  if (e.flips != 0) out += fmt::format("{}{} flips", out.empty() ? "" : ", ", e.flips);
  return out;
}

}  // namespace

double PortError::bits() const {
  return relative > 0 ? std::max(0.0, -std::log2(relative)) : std::numeric_limits<double>::infinity();
}

double PortDivergence::amplification() const { return input > 0 ? inherited.relative / input : 0; }

std::optional<Divergence> diverge(Session& session, const DivergeOptions& options, Diagnostics& problems) {
  return Comparison(session, options, problems).run();
}

Json to_json(const Divergence& d) {
  Json ports = Json::array();
  for (const PortDivergence& p : d.ports)
    ports.push_back({{"port", p.port},
                     {"type", p.type},
                     {"kind", p.kind},
                     {"file", p.file},
                     {"line", p.line},
                     {"total", error_json(p.total)},
                     {"local", error_json(p.local)},
                     {"inherited", error_json(p.inherited)},
                     {"input", json_number(p.input)},
                     {"amplification", json_number(p.amplification())},
                     {"digits_lost", json_number(p.digits_lost)},
                     {"interacts", p.interacts}});
  Json out = {{"a", d.a}, {"b", d.b}, {"ports", ports}, {"by_local", d.by_local}};
  out["first"] = d.first ? Json(d.ports[*d.first].port) : Json(nullptr);
  return out;
}

std::string diverge_text(const Divergence& d) {
  std::string out = fmt::format("a: {}\nb: {} (the reference)\n\n", d.a, d.b);
  if (!d.first) return out + fmt::format("no difference in {} ports\n", d.ports.size());
  const PortDivergence& first = d.ports[*d.first];
  out += fmt::format("{} is the first port that differs ({}:{})\n\n", first.port, first.file, first.line);
  std::vector<std::vector<std::string>> rows{
      {"port", "total", "local", "inherited", "amplified", "digits lost"}};
  for (const PortDivergence& p : d.ports)
    rows.push_back({p.port, shown(p.total), shown(p.local), shown(p.inherited),
                    p.amplification() > 0 ? fmt::format("x {:.2g}", p.amplification()) : "",
                    (p.digits_lost > 0 ? fmt::format("{:.1f}", p.digits_lost) : "") +
                        (p.interacts ? "  total > 2 (local + inherited)" : "")});
  out += aligned(rows);
  if (d.by_local.empty()) return out;
  out += "\nmost is lost in";
  for (std::size_t i = 0; i < std::min<std::size_t>(3, d.by_local.size()); ++i)
    out += fmt::format("{} {} ({})", i == 0 ? "" : ",", d.ports[d.by_local[i]].port,
                       shown(d.ports[d.by_local[i]].local));
  return out + "\n";
}

}  // namespace frustum
