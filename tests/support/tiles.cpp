#include "tests/support/tiles.h"

#include <fmt/format.h>
#include <hwy/highway.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <random>
#include <stdexcept>

namespace frustum::test {

std::shared_ptr<void> params_of(const NodeType& type, std::string_view json) {
  std::shared_ptr<void> params = type.default_params();
  Diagnostics problems;
  ParamReader reader(problems, "", FRUSTUM_SOURCE_DIR);
  read_record(type.params, Json::parse(json), params.get(), reader);
  if (!problems.empty()) throw std::invalid_argument(to_text(problems));
  return params;
}

std::vector<Buffer> run_geometry(const NodeType& type, std::string_view params, const NodeInputs& inputs,
                                 Precision precision, Context* used) {
  std::vector<std::vector<Buffer>> in;
  for (const Port& port : type.inputs) {
    const auto found = inputs.find(port.name);
    in.push_back(found == inputs.end() ? std::vector<Buffer>{} : found->second);
  }
  Context own;
  Context& ctx = used != nullptr ? *used : own;
  ctx.precision = precision;
  return type.run(in, params_of(type, params).get(), ctx);
}

PixelRun::PixelRun(NodeType type, std::string_view params, NodeInputs inputs, Precision precision)
    : type_(std::move(type)), inputs_(std::move(inputs)), params_(params_of(type_, params)) {
  std::vector<PreparedInput> in;
  for (const Port& port : type_.inputs) {
    PreparedInput p;
    const auto found = inputs_.find(port.name);
    if (found != inputs_.end() && port.tiled) {
      const Buffer& b = found->second.at(0);
      p.tiled.frame = std::make_shared<const Frame>(b.type().raster(b.data()).frame());
      p.tiled.planes_read = std::make_shared<std::vector<bool>>(p.tiled.frame->planes.size(), false);
    } else if (found != inputs_.end()) {
      p.buffers = found->second;
    }
    frames_.push_back(p.tiled.frame);
    planes_read_.push_back(p.tiled.planes_read);
    in.push_back(std::move(p));
  }
  Context ctx;
  ctx.precision = precision;
  prepared_ = type_.prepare(in, params_.get(), ctx);
}

std::vector<Raster> PixelRun::outputs() const {
  std::vector<Raster> made;
  for (const auto& f : prepared_.frames) made.emplace_back(*f);
  return made;
}

void PixelRun::fill(Rect rect, std::vector<Raster>& outputs) const {
  std::vector<Raster> copies;
  std::vector<std::vector<std::byte*>> planes(type_.inputs.size());
  std::vector<Tile> in;
  for (std::size_t i = 0; i < type_.inputs.size(); ++i) {
    if (!frames_[i]) {
      in.emplace_back();
      continue;
    }
    const Buffer& b = inputs_.at(type_.inputs[i].name).at(0);
    const Raster& source = b.type().raster(b.data());
    Frame cut = *frames_[i];
    cut.window = intersection(type_.reads(prepared_.state.get(), i, rect), frames_[i]->window);
    copies.emplace_back(cut);
    const Tile copied = copies.back().view();
    copy(source.view(cut.window), copied);
    for (std::size_t p = 0; p < cut.planes.size(); ++p) {
      const bool named = (*planes_read_[i])[p] && !cut.window.empty();
      const auto at = [&]<class T>() {
        return reinterpret_cast<std::byte*>(copied.row<T>(static_cast<int>(p), 0, cut.window.y0));
      };
      const PlaneKind kind = cut.planes[p].kind;
      planes[i].push_back(!named                   ? nullptr
                          : kind == PlaneKind::f32 ? at.operator()<float>()
                          : kind == PlaneKind::f64 ? at.operator()<double>()
                                                   : at.operator()<std::uint32_t>());
    }
    in.emplace_back(frames_[i].get(), cut.window, cut.window, copied.row_stride(), copied.sample_stride(),
                    planes[i]);
  }
  std::vector<Tile> out;
  for (const Raster& r : outputs) out.push_back(r.view(rect));
  Arena arena;
  type_.tile(prepared_.state.get(), in, out, arena);
}

Raster PixelRun::whole(std::size_t output) const {
  auto made = outputs();
  fill(frame(output).window, made);
  return made[output];
}

Raster PixelRun::pieced(std::span<const Rect> rects, std::size_t output) const {
  auto made = outputs();
  for (const Rect& r : rects) fill(r, made);
  return made[output];
}

std::string first_difference(const Raster& a, const Raster& b) {
  const Frame& f = a.frame();
  if (f.window != b.frame().window || f.planes != b.frame().planes || f.samples() != b.frame().samples())
    return "the frames differ";
  for (int p = 0; p < static_cast<int>(f.planes.size()); ++p)
    for (int s = 0; s < f.samples(); ++s)
      for (int y = f.window.y0; y < f.window.y1; ++y)
        for (int x = f.window.x0; x < f.window.x1; ++x) {
          const double u = a.value(p, s, x, y), v = b.value(p, s, x, y);
          if (std::memcmp(&u, &v, sizeof u) != 0)
            return fmt::format("plane {}, sample {}, pixel {},{}: {} and {}",
                               f.planes[static_cast<std::size_t>(p)].name, s, x, y, u, v);
        }
  return "";
}

std::string break_of_tile_law(const PixelRun& run, std::uint32_t seed) {
  const Rect w = run.frame().window;
  const Raster whole = run.whole();
  const auto tiled = [&](int tw, int th) {
    std::vector<Rect> rects;
    for (int y = w.y0; y < w.y1; y += th)
      for (int x = w.x0; x < w.x1; x += tw) rects.push_back(intersection({x, y, x + tw, y + th}, w));
    return rects;
  };
  std::mt19937 random(seed);
  std::vector<Rect> anywhere = tiled(16, 16);
  for (int i = 0; i < 24; ++i) {
    const int x = w.x0 + static_cast<int>(random() % static_cast<unsigned>(w.width()));
    const int y = w.y0 + static_cast<int>(random() % static_cast<unsigned>(w.height()));
    anywhere.push_back(intersection(
        {x, y, x + 1 + static_cast<int>(random() % 40), y + 1 + static_cast<int>(random() % 9)}, w));
  }
  std::shuffle(anywhere.begin(), anywhere.end(), random);
  const std::pair<const char*, std::vector<Rect>> ways[] = {
      {"1x1", tiled(1, 1)}, {"7x5", tiled(7, 5)}, {"16x16", tiled(16, 16)}, {"random", anywhere}};
  for (const auto& [name, rects] : ways)
    if (const std::string d = first_difference(whole, run.pieced(rects)); !d.empty())
      return fmt::format("whole against {} tiles: {}", name, d);
  return "";
}

void for_each_simd_target(const std::function<void(const char* name)>& body) {
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    body(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
}

}  // namespace frustum::test
