#include "nodes/visibility/classify.h"

#include "nodes/visibility.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

using classify::Found;
using classify::Reason;

struct Inputs {
  Ref<Mesh> mesh, screen;
  Ref<Visibility> hits;
};
struct Params {};
struct Outputs {
  Ref<Table> table;
  Ref<Mesh> mesh;
};

// Which source face a face comes from.
class Sources {
 public:
  explicit Sources(const Mesh& mesh) {
    if (const Column* c = mesh.find("origin"); c != nullptr) origin_ = c->values<std::uint32_t>();
  }
  std::uint32_t of(std::uint32_t face) const { return origin_.empty() ? face : origin_[face]; }

 private:
  std::span<const std::uint32_t> origin_;
};

std::vector<Found> found_on_screen(const Inputs& in, Context& ctx) {
  const Sources of_mesh(*in.mesh), of_screen(*in.screen);
  std::uint32_t last = 0;
  for (std::uint32_t f = 0; f < in.mesh->faces(); ++f) last = std::max(last, of_mesh.of(f));
  ctx.claim((std::uint64_t{last} + 1) * sizeof(Found));
  std::vector<Found> found(std::size_t{last} + 1);
  const Raster& hits = in.hits->raster;
  const Rect& w = hits.frame().window;
  for (int s = 0; s < hits.frame().samples(); ++s)
    for (int y = w.y0; y < w.y1; ++y, ctx.poll())
      for (int x = w.x0; x < w.x1; ++x) {
        const auto id = hits.at<std::uint32_t>(0, s, x, y);
        if (id == no_face) continue;
        if (id >= in.screen->faces() || of_screen.of(id) > last)
          throw NodeError("wrong_mesh", "the hits are of another mesh", at_input("hits"));
        ++found[of_screen.of(id)].seen;
      }
  return found;
}

template <class R>
void find_covered(const Inputs& in, std::vector<Found>& found, Context& ctx) {
  const ScreenView<R> view(in.screen);
  const kernels::ScreenMesh<R> mesh = view.triangles();
  const Sources of_screen(*in.screen);
  const Frame& frame = in.hits->raster.frame();
  const kernels::SamplePositions pattern = sample_positions(frame.pattern.get());
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    if (f % 1024 == 0) ctx.poll();
    if (of_screen.of(f) >= found.size()) continue;
    Found& source = found[of_screen.of(f)];
    if (source.seen == 0 && !source.covers)
      source.covers = classify::covers_a_sample(mesh, f, pattern, pixel_rect(frame.window));
  }
}

Ref<Table> table_of(const std::array<std::uint64_t, classify::reasons>& faces) {
  auto table = std::make_shared<Table>();
  table->columns = {
      {.name = "reason",
       .texts = {"visible", "outside", "back_facing", "hidden", "between_samples", "undefined"}},
      {.name = "code"},
      {.name = "faces"}};
  for (std::size_t k = 0; k < faces.size(); ++k) {
    table->columns[1].numbers.push_back(static_cast<double>(k));
    table->columns[2].numbers.push_back(static_cast<double>(faces[k]));
  }
  return table;
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  picture_window(*in.screen);
  return ctx.real([&]<class R>() -> Outputs {
    std::vector<Found> found = found_on_screen(in, ctx);
    find_covered<R>(in, found, ctx);
    const auto position = in.mesh->real<R>("position");
    const auto p = position->template values<glm::vec<4, R>>();
    const Sources of_mesh(*in.mesh);
    const kernels::ClipSpace space = clip_space(in.screen->camera.get());
    std::vector<std::uint32_t> reason, samples;
    std::array<std::uint64_t, classify::reasons> faces{};
    for (const glm::uvec3& t : in.mesh->triangles()) {
      const Found& f = found[of_mesh.of(static_cast<std::uint32_t>(reason.size()))];
      const Reason r = classify::reason(p[t.x], p[t.y], p[t.z], space, f);
      reason.push_back(static_cast<std::uint32_t>(r));
      samples.push_back(static_cast<std::uint32_t>(std::min<std::uint64_t>(f.seen, no_face)));
      ++faces[static_cast<std::size_t>(r)];
    }
    const auto column = [](const char* name, const std::vector<std::uint32_t>& values) {
      return Column::make(name, Domain::face, std::span<const std::uint32_t>(values));
    };
    return {table_of(faces),
            std::make_shared<Mesh>(
                in.mesh->with(column("reason", reason)).with(column("samples_seen", samples)))};
  });
}

}  // namespace

NodeType nodes::visibility_classify() {
  return node("visibility.classify", run)
      .doc("Says of every face why it is not seen: outside the volume, facing away, hidden by others.")
      .cite(
          "Sutherland, Sproull & Schumacker 1974, A Characterization of Ten Hidden-Surface Algorithms, "
          "doi:10.1145/356625.356626")
      .covers(34)
      .input("mesh", &Inputs::mesh,
             "The source's triangles in clip space, before anything was cut or culled.",
             {.space = Space::clip})
      .input("screen", &Inputs::screen,
             "What became of them on the screen; faces name their source by origin.",
             {.space = Space::screen})
      .input("hits", &Inputs::hits, "Which face of `screen` is seen at each sample.")
      .output("table", &Outputs::table, "How many faces there are of each reason.")
      .output("mesh", &Outputs::mesh,
              "The source with columns reason (code of the table) and samples_seen for each face.");
}

}  // namespace frustum
