#include "nodes/clip/line.h"

#include "nodes/clip.h"
#include "nodes/kernels/double_double.h"
#include "runtime/buffers/camera.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/step_table.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace clip {

enum class Against : std::uint8_t { volume, rectangle, planes };
enum class Joining : std::uint8_t { path, pairs };
constexpr auto choices(Against) {
  return std::array{std::pair{Against::volume, "volume"}, std::pair{Against::rectangle, "rectangle"},
                    std::pair{Against::planes, "planes"}};
}
constexpr auto choices(Joining) {
  return std::array{std::pair{Joining::path, "path"}, std::pair{Joining::pairs, "pairs"}};
}

struct Segment {
  glm::dvec4 from{0, 0, 0, 1}, to{0, 0, 0, 1};
};
inline void describe(Fields<Segment>& f) {
  f.field("from", &Segment::from, "Where it starts: x, y, z and w.");
  f.field("to", &Segment::to, "Where it ends.");
}

}  // namespace clip

namespace {

using namespace clip;

struct Inputs {
  std::optional<Ref<Points>> points;
  std::optional<Ref<Matrix>> matrix;
};
struct Params {
  std::vector<Segment> segments;
  Joining connect = Joining::path;
  Against against = Against::volume;
  glm::dvec2 low{-1}, high{1};
  std::vector<glm::dvec4> planes;
  Conventions conventions = Conventions::gl;
  bool reversed_z = false;
  int rows = 10000;
};
struct Outputs {
  Ref<Points> points;
  Ref<Table> ends, steps;
};

// Rows a . p >= 0 and what they are called.
struct Planes {
  std::vector<glm::dvec4> row;
  std::vector<std::string> name;
};

Planes planes_of(const Params& p) {
  switch (p.against) {
    case Against::volume:
      return {volume_planes(clip_space(p.conventions, p.reversed_z)),
              {"near", "far", "left", "right", "bottom", "top"}};
    case Against::rectangle:
      return {rectangle_planes(p.low, p.high), {"left", "right", "low", "high", "eye"}};
    case Against::planes: break;
  }
  Planes all{p.planes, {}};
  for (std::size_t i = 0; i < p.planes.size(); ++i) all.name.push_back(fmt::format("plane {}", i));
  return all;
}

void check(const Params& p) {
  if (p.against == Against::planes && p.planes.empty())
    throw NodeError("no_planes", "name at least one plane to clip against", at_param("planes"));
  if (p.against == Against::rectangle && !(p.low.x <= p.high.x && p.low.y <= p.high.y))
    throw NodeError("empty_rectangle", "low lies beyond high: nothing is inside", at_param("low"));
}

// m p, each component rounded once.
glm::dvec4 product(const glm::dmat4& m, const glm::dvec4& p) {
  glm::dvec4 out;
  for (glm::length_t r = 0; r < 4; ++r) {
    kernels::TwoTerms<double> sum{0, 0};
    for (glm::length_t k = 0; k < 4; ++k) sum = kernels::plus(sum, kernels::two_product(m[k][r], p[k]));
    out[r] = sum.hi;
  }
  return out;
}

std::vector<Segment> segments_of(const Inputs& in, const Params& p, Context& ctx) {
  std::vector<Segment> all = p.segments;
  const std::size_t points = in.points ? (*in.points)->at.size() : 0;
  const std::size_t step = p.connect == Joining::pairs ? 2 : 1;
  ctx.claim((points / step) * sizeof(Segment));
  for (std::size_t i = 0; i + 1 < points; i += step)
    all.push_back({glm::dvec4((*in.points)->at[i], 1), glm::dvec4((*in.points)->at[i + 1], 1)});
  if (!in.matrix) return all;
  for (Segment& s : all)
    for (glm::dvec4* end : {&s.from, &s.to}) *end = product((*in.matrix)->value, *end);
  return all;
}

std::string text_of(Role r) {
  switch (r) {
    case Role::inside: return "inside";
    case Role::enters: return "enters";
    case Role::leaves: return "leaves";
    case Role::outside: break;
  }
  return "outside";
}

StepTable step_table(int rows) {
  return {{{.name = "segment"},
           {.name = "plane"},
           {.name = "d_from"},
           {.name = "d_to"},
           {.name = "event"},
           {.name = "t"},
           {.name = "t_from"},
           {.name = "t_to"}},
          rows};
}
StepTable end_table(int rows) {
  return {{{.name = "segment"},
           {.name = "left"},
           {.name = "t_from"},
           {.name = "from_plane"},
           {.name = "t_to"},
           {.name = "to_plane"}},
          rows};
}

class Clipper {
 public:
  Clipper(const Params& p, bool tell)
      : planes_(planes_of(p)), steps_(step_table(p.rows)), ends_(end_table(p.rows)), tell_(tell) {}

  void clip(std::size_t segment, const Segment& s) {
    const auto part = clip_segment(s.from, s.to, planes_.row, [&](const Crossing& c) {
      if (tell_ && steps_.full())
        steps_.leave_out();
      else if (tell_)
        steps_.add(segment, planes_.name[c.plane], c.d_from, c.d_to, text_of(c.role), c.t, c.t_from, c.t_to);
    });
    const auto keep = part ? divided(*part) : std::nullopt;
    if (part && !keep) ++at_infinity_;
    if (keep) points_->at.push_back(keep->first), points_->at.push_back(keep->second);
    if (!part) ++gone_;
    if (tell_ && ends_.full()) ends_.leave_out();
    if (!tell_ || ends_.full()) return;
    const auto name = [&](const std::optional<std::size_t>& plane) {
      return plane ? planes_.name[*plane] : "";
    };
    if (keep)
      ends_.add(segment, std::string("yes"), part->t_from, name(part->from_plane), part->t_to,
                name(part->to_plane));
    else
      ends_.add(segment, std::string("no"), 0, std::string(), 0, std::string());
  }

  Outputs out(Context& ctx) {
    ctx.count("segments_gone", gone_);
    if (at_infinity_ > 0)
      ctx.warn("points_at_infinity",
               fmt::format("{} segments were left out: an end has w = 0, or is not finite after the divide",
                           at_infinity_));
    return {std::move(points_), ends_.table(ctx, 1), steps_.table(ctx, 2)};
  }

 private:
  static std::optional<std::pair<glm::dvec3, glm::dvec3>> divided(const Part& part) {
    const auto point = [](const glm::dvec4& h) { return glm::dvec3(h.x / h.w, h.y / h.w, h.z / h.w); };
    const glm::dvec3 a = point(part.from), b = point(part.to);
    for (glm::length_t i = 0; i < 3; ++i)
      if (!std::isfinite(a[i]) || !std::isfinite(b[i])) return std::nullopt;
    return std::pair{a, b};
  }

  Planes planes_;
  StepTable steps_, ends_;
  bool tell_;
  std::shared_ptr<Points> points_ = std::make_shared<Points>();
  std::uint64_t gone_ = 0, at_infinity_ = 0;
};

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const std::vector<Segment> segments = segments_of(in, p, ctx);
  ctx.claim(segments.size() * 2 * sizeof(glm::dvec3));
  Clipper clipper(p, ctx.wants(1) || ctx.wants(2));
  for (std::size_t i = 0; i < segments.size(); ++i) {
    clipper.clip(i, segments[i]);
    if (i % 1024 == 0) ctx.poll();
  }
  ctx.count("segments", segments.size());
  return clipper.out(ctx);
}

}  // namespace

NodeType nodes::clip_line() {
  return node("clip.line", run)
      .doc("Cuts segments against half-spaces by their parameter, and says which plane cut which end where.")
      .cite("Cyrus & Beck 1978; Liang & Barsky 1984, ACM TOG 3(1); Blinn & Newell 1978 (before the divide)")
      .covers(36)
      .input("points", &Inputs::points, "Ends of segments, with w = 1.")
      .input("matrix", &Inputs::matrix, "Takes ends into clip space first, as project.mvp's factors do.")
      .param("segments", &Params::segments, "Further segments in homogeneous coordinates, clipped first.")
      .param("connect", &Params::connect, "path joins each point to the next, pairs every two.")
      .param("against", &Params::against,
             "volume is -w <= x, y, z <= w, or 0 <= z; rectangle lies between low and high; planes are your "
             "own.")
      .param("low", &Params::low, "Left and lower side of the rectangle; raising it cuts more away.")
      .param("high", &Params::high, "Right and upper side of the rectangle; raising it cuts less away.")
      .param("planes", &Params::planes, "Rows [a, b, c, d]: inside is a x + b y + c z + d w >= 0.")
      .param("conventions", &Params::conventions,
             "Of the volume: in Vulkan and Direct3D its depth begins at 0, and Vulkan's y points down.")
      .param("reversed_z", &Params::reversed_z, "Of the volume: depth falls from w at near to 0 at far.")
      .param("rows", &Params::rows, "How many rows of tables are kept; raising it keeps more of a long list.",
             {.range = at_least(1)})
      .check(check)
      .output("points", &Outputs::points,
              "Two ends for every segment of which something is left, divided by w.")
      .output("ends", &Outputs::ends,
              "For every segment what is left, and which plane cut which end at which t.")
      .output("steps", &Outputs::steps,
              "For every plane the distances of both ends, the crossing, and the interval that is left.");
}

}  // namespace frustum
