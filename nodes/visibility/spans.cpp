#include "nodes/visibility/spans.h"

#include "nodes/visibility.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/buffers/step_table.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {
  int line = 0;
};
struct Outputs {
  Ref<Table> spans;
};

void report(const scanline::Counts& counts, Context& ctx) {
  ctx.count("lines", counts.lines);
  ctx.count("active_edges", counts.edges);
  ctx.count("spans", counts.spans);
  ctx.count("segments", counts.segments);
  ctx.count("comparisons", counts.comparisons);
  ctx.count("halvings", counts.halvings);
  ctx.count("most_active", counts.most_active);
}

Ref<Table> table_of(const std::vector<scanline::Segment>& segments, Context& ctx) {
  StepTable table({{.name = "begin", .unit = "px"},
                   {.name = "end", .unit = "px"},
                   {.name = "active"},
                   {.name = "face"},
                   {.name = "comparisons"}},
                  std::numeric_limits<int>::max());
  for (const scanline::Segment& s : segments) table.add(s.begin, s.end, s.active, s.face, s.comparisons);
  return table.table(ctx, 0);
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const Rect window = picture_window(*in.mesh);
  if (p.line >= window.y1)
    throw NodeError("outside_window", fmt::format("the picture has {} lines, from 0 on", window.height()),
                    at_param("line"));
  return ctx.real([&]<class R>() -> Outputs {
    const ScreenView<R> view(in.mesh);
    const Ref<SamplePattern> pattern = in.pattern.value_or(nullptr);
    const scanline::Scanner<R> scanner(view.triangles(), sample_positions(pattern.get()), pixel_rect(window),
                                       depth_order(*in.mesh),
                                       [&ctx](std::uint64_t bytes) { ctx.claim(bytes); });
    const auto survey = scanline::survey(scanner, pixel_rect(window), p.line, [&] { ctx.poll(); });
    report(survey.counts, ctx);
    return {table_of(survey.segments, ctx)};
  });
}

}  // namespace

NodeType nodes::visibility_spans() {
  return node("visibility.spans", run)
      .doc("Shows one line of the scanline algorithm, span by span, and counts the work of all lines.")
      .cite("Watkins 1970, A Real Time Visible Surface Algorithm, University of Utah UTEC-CSc-70-101")
      .covers(46, 47)
      .input("mesh", &Inputs::mesh, "Opaque triangles of either winding.", {.space = Space::screen})
      .input("pattern", &Inputs::pattern, "Where a pixel's samples lie; the line shown is that of the first.")
      .param("line", &Params::line, "Which line of the picture is shown; raising it goes down.",
             {.unit = "px", .range = at_least(0)})
      .output("spans", &Outputs::spans,
              "Stretches between begins and ends of spans: how many cover it, and who is seen at its begin.");
}

}  // namespace frustum
