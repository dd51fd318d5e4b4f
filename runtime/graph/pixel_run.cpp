#include "runtime/graph/pixel_run.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>

namespace frustum {
namespace {

struct Grid {
  Rect area;
  int width, height;  // of a tile
  int columns() const { return (area.width() + width - 1) / width; }
  int rows() const { return (area.height() + height - 1) / height; }
  int tiles() const { return columns() * rows(); }
  Rect band(int row) const {
    const int y = area.y0 + row * height;
    return {area.x0, y, area.x1, std::min(area.y1, y + height)};
  }
  Rect tile(int column, int row) const {
    const int x = area.x0 + column * width;
    const Rect b = band(row);
    return {x, b.y0, std::min(area.x1, x + width), b.y1};
  }
};

// Throttles progress to what a person can see, whatever the number of threads.
class Progress {
 public:
  Progress(const std::function<void(double)>& report, int total) : report_(report), total_(total) {}
  void step() {
    const int done = done_.fetch_add(1, std::memory_order_relaxed) + 1;
    if (!report_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;
    const auto now = std::chrono::steady_clock::now();
    if (done != total_ && now - last_ < std::chrono::milliseconds(50)) return;
    last_ = now;
    report_(static_cast<double>(done) / total_);
  }

 private:
  const std::function<void(double)>& report_;
  int total_;
  std::atomic<int> done_{0};
  std::mutex mutex_;
  std::chrono::steady_clock::time_point last_{};
};

std::string inputs_at(const NodeType& type, std::span<const Tile> in, int x, int y) {
  std::string text;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (in[i].empty() || !in[i].rect().contains(x, y)) continue;
    const auto& planes = in[i].frame().planes;
    for (int p = 0; p < static_cast<int>(planes.size()); ++p) {
      if (!in[i].has(p)) continue;
      const Plane& plane = planes[static_cast<std::size_t>(p)];
      const int at = x - in[i].rect().x0;
      const double v = plane.kind == PlaneKind::f32   ? in[i].row<const float>(p, 0, y)[at]
                       : plane.kind == PlaneKind::f64 ? in[i].row<const double>(p, 0, y)[at]
                                                      : in[i].row<const std::uint32_t>(p, 0, y)[at];
      text += fmt::format("{}{}.{} = {:.9g}", text.empty() ? "" : ", ", type.inputs[i].name, plane.name, v);
    }
  }
  return text;
}

class PixelRun {
 public:
  explicit PixelRun(const PixelJob& job)
      : job_(job),
        program_(*job.program),
        edge_(job.tile_edge != 0 ? job.tile_edge : program_.choose_edge()) {
    grid_.area = job.region;
    grid_.width = edge_ > 0 ? edge_ : std::max(1, job.region.width());
    grid_.height = edge_ > 0 ? edge_ : std::max(1, job.region.height());
    // Every node spends some time on a row, however short: of two tiles of one size the wide one is done sooner.
    if (job.tile_edge == 0 && program_.estimate(edge_).area_ratio <= 1) grid_.width = 2 * edge_;
  }

  PixelOutcome run() {
    Progress progress(job_.progress, std::max(1, grid_.tiles()));
    if (!job_.region.empty()) {
      if (job_.sinks.empty())
        walk_tiles(progress);
      else
        walk_bands(progress);
    }
    return outcome();
  }

 private:
  using Targets = std::vector<Tile>;

  void fill(const Targets& targets, int index, Progress& progress) {
    if (job_.cancel != nullptr && job_.cancel->cancelled()) throw Cancelled();
    const std::vector<Rect> shown = program_.run(targets, workers_.local());
    for (std::size_t r = 0; r < targets.size(); ++r)
      if (!shown[r].empty() && !health_of(targets[r].part(shown[r])).finite()) {
        int known = first_bad_.load();
        while (index < known && !first_bad_.compare_exchange_weak(known, index)) {
        }
      }
    progress.step();
  }

  Targets whole_targets(Rect rect) const {
    Targets targets(program_.roots().size());
    for (std::size_t r = 0; r < targets.size(); ++r)
      if (job_.whole[r]) {
        const Rect part = intersection(rect, job_.whole[r]->frame().window);
        if (!part.empty()) targets[r] = job_.whole[r]->view(part);
      }
    return targets;
  }

  void walk_tiles(Progress& progress) {
    tbb::parallel_for(0, grid_.tiles(), [&](int i) {
      fill(whole_targets(grid_.tile(i % grid_.columns(), i / grid_.columns())), i, progress);
    });
  }

  // The rows of one band: a raster for every root that a sink reads, filled by tiles in parallel.
  struct Band {
    Rect rect;
    std::vector<std::optional<Raster>> roots;
  };

  std::vector<bool> streamed_roots() const {
    std::vector<bool> streamed(program_.roots().size(), false);
    for (const SinkJob& s : job_.sinks)
      for (const SinkSource& l : s.layers)
        if (const auto* root = std::get_if<std::size_t>(&l.from)) streamed[*root] = true;
    return streamed;
  }

  void fill_band(int row, const std::vector<bool>& streamed, Progress& progress, Band& band) {
    band.rect = grid_.band(row);
    band.roots.assign(streamed.size(), std::nullopt);
    for (std::size_t r = 0; r < streamed.size(); ++r) {
      if (!streamed[r] || job_.whole[r]) continue;
      Frame f = program_.frame(program_.roots()[r]);
      f.window = intersection(f.window, band.rect);
      band.roots[r].emplace(std::move(f), Contents::anything);
    }
    tbb::parallel_for(0, grid_.columns(), [&](int column) {
      const Rect rect = grid_.tile(column, row);
      Targets targets = whole_targets(rect);
      for (std::size_t r = 0; r < targets.size(); ++r)
        if (band.roots[r]) {
          const Rect part = intersection(rect, band.roots[r]->frame().window);
          if (!part.empty()) targets[r] = band.roots[r]->view(part);
        }
      fill(targets, row * grid_.columns() + column, progress);
    });
  }

  void write_band(const Band& band) {
    for (const SinkJob& job : job_.sinks) {
      const Rect rect = intersection(band.rect, job.region);
      if (rect.empty()) continue;
      std::vector<Raster> keep;
      std::vector<Tile> layers;
      keep.reserve(job.layers.size());
      for (const SinkSource& source : job.layers) {
        const auto* root = std::get_if<std::size_t>(&source.from);
        const Raster& raster = root == nullptr     ? std::get<Raster>(source.from)
                               : job_.whole[*root] ? *job_.whole[*root]
                                                   : *band.roots[*root];
        const Rect part = intersection(raster.frame().window, rect);
        if (part == rect && raster.frame().samples() == 1) {
          layers.push_back(raster.view(part));
          continue;
        }
        const Tile whole = keep.emplace_back(sink_frame(raster.frame(), rect), Contents::anything).view();
        blank_around(whole, part);
        if (part.empty()) {
          // Outside the layer's window: blank.
        } else if (raster.frame().samples() == 1) {
          copy(raster.view(part), whole.part(part));
        } else {
          pick_central_samples(raster.view(part), whole.part(part));
        }
        layers.push_back(whole);
      }
      job.sink->write(layers);
    }
  }

  // Bands are filled while earlier ones are written: file compression hides behind the pixels' own work. They leave in
  // order, so those in flight follow one another, and each has a place of its own. What travels is the number of the row:
  // of a pipeline that is cancelled, oneTBB never destroys the items that are on their way.
  void walk_bands(Progress& progress) {
    const std::vector<bool> streamed = streamed_roots();
    constexpr int in_flight = 3;
    std::array<Band, in_flight> bands;
    const auto band_of = [&](int row) -> Band& { return bands[static_cast<std::size_t>(row % in_flight)]; };
    int next = 0;
    tbb::parallel_pipeline(
        in_flight,
        tbb::make_filter<void, int>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& flow) {
          if (next == grid_.rows()) flow.stop();
          return next++;
        }) & tbb::make_filter<int, int>(tbb::filter_mode::parallel, [&](int row) {
          fill_band(row, streamed, progress, band_of(row));
          return row;
        }) & tbb::make_filter<int, void>(tbb::filter_mode::serial_in_order, [&](int row) {
          write_band(band_of(row));
          band_of(row).roots.clear();
        }));
  }

  // Runs the first bad tile again and looks at every operation on the way.
  std::optional<PixelCulprit> find_culprit() {
    const int bad = first_bad_.load();
    if (bad == std::numeric_limits<int>::max()) return std::nullopt;
    const Rect rect = grid_.tile(bad % grid_.columns(), bad / grid_.columns());
    std::vector<Raster> scratch;
    Targets targets;
    for (const TileRoot& root : program_.roots()) {
      Frame f = program_.frame(root);
      f.window = intersection(f.window, rect);
      scratch.emplace_back(std::move(f));
      targets.push_back(scratch.back().frame().window.empty() ? Tile{} : scratch.back().view());
    }
    std::optional<PixelCulprit> culprit;
    program_.run(
        targets, workers_.local(), [&](std::size_t op, std::span<const Tile> in, std::span<const Tile> out) {
          for (std::size_t port = 0; port < out.size() && !culprit; ++port) {
            Health h = health_of(out[port]);
            if (h.finite()) continue;
            const auto [x, y] = h.pixel.value_or(std::pair{0, 0});
            culprit = PixelCulprit{op, port, std::move(h), inputs_at(*program_.ops()[op].type, in, x, y)};
          }
        });
    return culprit;
  }

  PixelOutcome outcome() {
    PixelOutcome out;
    out.tile_edge = edge_;
    out.costs.time.resize(program_.ops().size());
    out.costs.pixels.resize(program_.ops().size());
    for (const TileWorker& w : workers_) {
      out.worker_bytes += w.memory.peak() + w.arena.capacity();
      for (std::size_t i = 0; i < w.costs.time.size(); ++i) {
        out.costs.time[i] += w.costs.time[i];
        out.costs.pixels[i] += w.costs.pixels[i];
      }
    }
    out.culprit = find_culprit();
    return out;
  }

  const PixelJob& job_;
  const TileProgram& program_;
  int edge_;
  Grid grid_{};
  tbb::enumerable_thread_specific<TileWorker> workers_;
  std::atomic<int> first_bad_{std::numeric_limits<int>::max()};
};

template <class T>
void pick_row(const Tile& from, const Tile& to, int plane, int y, const SamplePattern& pattern) {
  T* out = to.row<T>(plane, 0, y);
  for (int x = from.rect().x0; x < from.rect().x1; ++x) {
    int nearest = 0;
    long best = std::numeric_limits<long>::max();
    for (int s = 0; s < pattern.samples; ++s) {
      const std::size_t i = pattern.index(s, x, y);
      const long dx = pattern.x[i] - 2048L, dy = pattern.y[i] - 2048L;
      if (dx * dx + dy * dy < best) best = dx * dx + dy * dy, nearest = s;
    }
    out[x - from.rect().x0] = from.row<const T>(plane, nearest, y)[x - from.rect().x0];
  }
}

}  // namespace

PixelOutcome run_pixels(const PixelJob& job) { return PixelRun(job).run(); }

void pick_central_samples(const Tile& sampled, const Tile& out) {
  const auto& planes = sampled.frame().planes;
  for (int p = 0; p < static_cast<int>(planes.size()); ++p)
    for (int y = sampled.rect().y0; y < sampled.rect().y1; ++y) {
      const SamplePattern& pattern = *sampled.frame().pattern;
      switch (planes[static_cast<std::size_t>(p)].kind) {
        case PlaneKind::f32: pick_row<float>(sampled, out, p, y, pattern); break;
        case PlaneKind::f64: pick_row<double>(sampled, out, p, y, pattern); break;
        case PlaneKind::u32: pick_row<std::uint32_t>(sampled, out, p, y, pattern); break;
      }
    }
}

Frame sink_frame(const Frame& frame, Rect region) {
  Frame f = frame;
  f.window = region;
  f.pattern = nullptr;
  return f;
}

}  // namespace frustum
