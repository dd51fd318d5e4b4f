#include "tests/support/pixel_nodes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <mutex>
#include <optional>

namespace frustum::test {
namespace {

using testing::HasSubstr;

// Two chains that share their source, one with margins, joined: 5 pixel nodes.
GraphMaker diamond(int samples = 1, int radius = 2) {
  GraphMaker g;
  g.add("factor", "test.number", {}, R"({"value": 3})")
      .add("noise", "test.source", {{"scale", "factor"}},
           R"({"size": [150, 70], "samples": )" + std::to_string(samples) + "}")
      .add("soft", "test.blur", {{"image", "noise"}}, R"({"radius": )" + std::to_string(radius) + "}")
      .add("softer", "test.blur", {{"image", "soft"}})
      .add("sum", "test.add", {{"a", "softer"}, {"b", "noise"}});
  return g;
}

std::string bytes_of(const Buffer& b) {
  const Raster& r = b.type().raster(b.data());
  std::string bytes;
  const Tile t = r.view();
  for (int p = 0; p < static_cast<int>(r.frame().planes.size()); ++p)
    for (int s = 0; s < t.samples(); ++s)
      for (int y = t.rect().y0; y < t.rect().y1; ++y)
        bytes.append(reinterpret_cast<const char*>(t.row<const float>(p, s, y)),
                     static_cast<std::size_t>(t.rect().width()) * 4);
  return bytes;
}

std::string run_bytes(const GraphMaker& g, const std::string& port, RunOptions options = {}) {
  options.demand.ports = {g.port(port)};
  const RunResult r = run_graph(g.graph, options);
  EXPECT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
  return bytes_of(r.buffers.at(g.port(port)));
}

// Keeps the bands that it gets, and checks their order.
class Recorder : public Sink {
 public:
  struct Log {
    SinkRequest request;
    std::string bytes;
    int next_row = 0, bands = 0;
    bool finished = false, removed = false;
  };
  explicit Recorder(Log& log) : log_(log) { log_.next_row = log.request.region.y0; }
  ~Recorder() override { log_.removed = !log_.finished; }
  void write(std::span<const Tile> layers) override {
    const Tile& t = layers[0];
    EXPECT_EQ(t.rect().y0, log_.next_row);
    log_.next_row = t.rect().y1;
    ++log_.bands;
    for (int y = t.rect().y0; y < t.rect().y1; ++y)
      log_.bytes.append(reinterpret_cast<const char*>(t.row<const float>(0, 0, y)),
                        static_cast<std::size_t>(t.rect().width()) * 4);
  }
  void finish() override {
    EXPECT_EQ(log_.next_row, log_.request.region.y1);
    log_.finished = true;
  }

 private:
  Log& log_;
};

TEST(Run, GivesTheSameBytesForEveryTileEdgeThreadCountAndFusion) {
  const GraphMaker g = diamond(3);
  const std::string truth = run_bytes(g, "sum", {.threads = 1, .tile_edge = -1, .fuse = false});
  for (const int threads : {1, 2, 7})
    for (const int edge : {0, 16, 17, 32, 128, -1})
      for (const bool fuse : {true, false})
        EXPECT_EQ(run_bytes(g, "sum", {.threads = threads, .tile_edge = edge, .fuse = fuse}), truth)
            << threads << " threads, tile edge " << edge << (fuse ? ", fused" : ", not fused");
}

TEST(Run, CutsTheChainWhereAWideMarginWouldRecomputeIt) {
  const GraphMaker g = [] {
    GraphMaker m;
    m.add("noise", "test.source", {}, R"({"size": [300, 280]})")
        .add("soft", "test.blur", {{"image", "noise"}}, R"({"radius": 24})");
    return m;
  }();
  struct Times : Observer {
    std::vector<PixelNodeTime> seen;
    void pixel_times(const std::vector<PixelNodeTime>& t) override { seen = t; }
  } times;
  const std::string bytes = run_bytes(g, "soft", {.observer = &times});
  EXPECT_EQ(bytes, run_bytes(g, "soft", {.tile_edge = -1}));
  ASSERT_EQ(times.seen.size(), 2u);
  EXPECT_EQ(times.seen[0].pixels, 300u * 280u) << "noise is made once and not once a tile";
}

TEST(Run, StreamsBandsInOrderToASinkWithTheBytesOfTheWhole) {
  GraphMaker g = diamond();
  g.output("picture", "sum", "sum.exr");
  for (const int edge : {0, 16, -1}) {
    Recorder::Log log;
    RunOptions o{.demand = {.outputs = {0}}, .tile_edge = edge};
    o.make_sink = [&](const SinkRequest& r) {
      log.request = r;
      return std::make_unique<Recorder>(log);
    };
    const RunResult r = run_graph(g.graph, o);
    ASSERT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
    EXPECT_TRUE(log.finished);
    EXPECT_EQ(log.bytes, run_bytes(g, "sum"));
    EXPECT_EQ(r.files, std::vector<std::string>{"out/sum.exr"});
    EXPECT_TRUE(edge != 16 || log.bands > 1);
  }
}

TEST(Run, SavesWholeBuffersBesidePictures) {
  GraphMaker g = diamond();
  g.output("picture", "sum", "sum.exr")
      .output("statistics", "sum", "sum.json")
      .output("factor", "factor", "n.csv");
  g.graph.outputs[1].whole = g.graph.outputs[2].whole = true;
  for (const std::optional<Rect> region : {std::optional<Rect>(), std::optional<Rect>({10, 10, 40, 20})})
    for (const bool fuse : {true, false}) {
      Recorder::Log log;
      std::map<std::string, Buffer> saved;
      std::mutex mutex;
      RunOptions o{.demand = {.outputs = {0, 1, 2}}, .region = region, .fuse = fuse};
      o.make_sink = [&](const SinkRequest& r) {
        log.request = r;
        return std::make_unique<Recorder>(log);
      };
      o.save_buffer = [&](const Buffer& b, const SaveRequest& r) {
        const std::lock_guard lock(mutex);
        saved[r.path] = b;
        if (r.path == "out/n.csv") r.warn("left_out", "a digit");
        EXPECT_EQ(r.metadata, log.request.metadata.empty() ? r.metadata : log.request.metadata);
      };
      const RunResult r = run_graph(g.graph, o);
      ASSERT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
      EXPECT_TRUE(log.finished);
      ASSERT_EQ(saved.size(), 2u);
      if (region)
        EXPECT_EQ(saved.at("out/sum.json").as<Image>()->raster.frame().window, *region);
      else
        EXPECT_TRUE(bytes_of(saved.at("out/sum.json")) == run_bytes(g, "sum"));
      EXPECT_EQ(saved.at("out/n.csv").type().name, "number");
      EXPECT_EQ(r.files, (std::vector<std::string>{"out/sum.exr", "out/sum.json", "out/n.csv"}));
      ASSERT_EQ(r.problems.size(), 1u);
      EXPECT_EQ(r.problems.list()[0].message, "output 'factor': a digit");
    }
}

// A writer's memory comes on top of all buffers that live, not of the saved one alone.
TEST(Run, AWriterIsRefusedWhatTheRunHasNoMemoryFor) {
  GraphMaker g = diamond();
  g.output("statistics", "sum", "sum.json");
  g.graph.outputs[0].whole = true;
  const auto run = [&](std::uint64_t writer, std::uint64_t limit) {
    RunOptions o{.demand = {.ports = {g.port("sum"), g.port("soft")}, .outputs = {0}}, .memory = limit};
    o.save_buffer = [&](const Buffer&, const SaveRequest& r) { r.admit(writer); };
    return run_graph(g.graph, o);
  };
  const std::uint64_t gib = std::uint64_t{1} << 30;
  EXPECT_EQ(run(gib - 1, 2 * gib).end, RunResult::End::done);
  const RunResult r = run(gib - 1, gib);
  EXPECT_EQ(r.end, RunResult::End::failed);
  ASSERT_FALSE(r.problems.empty());
  EXPECT_EQ(r.problems.list()[0].code, "memory");
}

TEST(Run, FilesNameTheGraphThatMadeThem) {
  const auto metadata = [](const GraphMaker& maker) {
    GraphMaker g = maker;
    g.graph.title = "a title";
    g.output("n", "factor", "n.json");
    g.graph.outputs[0].whole = true;
    std::vector<std::pair<std::string, std::string>> out;
    RunOptions o{.demand = {.outputs = {0}}};
    o.save_buffer = [&](const Buffer&, const SaveRequest& r) { out = r.metadata; };
    run_graph(g.graph, o);
    return out;
  };
  const auto first = metadata(diamond());
  ASSERT_EQ(first.size(), 3u);
  EXPECT_THAT(first[0].second, testing::StartsWith("frustum "));
  EXPECT_EQ(first[1].second, "a title");
  EXPECT_EQ(first[2].first, "frustum:graph");
  EXPECT_EQ(first[2].second.size(), 32u);
  EXPECT_EQ(metadata(diamond()), first);
  EXPECT_NE(metadata(diamond(1, 3)), first) << "another radius is another graph";
}

TEST(Run, ARegionHasTheBytesOfThatPartOfTheWhole) {
  GraphMaker g = diamond();
  RunOptions o{.demand = {.ports = {g.port("sum")}}, .region = Rect{33, 11, 94, 52}};
  const RunResult part = run_graph(g.graph, o);
  o.region.reset();
  const RunResult whole = run_graph(g.graph, o);
  const Raster& a = part.buffers.at(g.port("sum")).as<Image>()->raster;
  const Raster& b = whole.buffers.at(g.port("sum")).as<Image>()->raster;
  EXPECT_EQ(a.frame().window, (Rect{33, 11, 94, 52}));
  for (int y = 11; y < 52; ++y)
    ASSERT_EQ(std::memcmp(a.view().row<const float>(0, 0, y),
                          b.view(a.frame().window).row<const float>(0, 0, y), 61 * 4),
              0)
        << y;
}

TEST(Run, ARegionOfSeveralPortsOfOneChainIsCutFromEach) {
  GraphMaker g = diamond();
  g.add("total", "test.total", {{"image", "soft"}});
  const std::vector<PortRef> ports{g.port("noise"), g.port("soft"), g.port("softer"), g.port("sum"),
                                   g.port("total")};
  const RunResult whole = run_graph(g.graph, {.demand = {.ports = ports}});
  const RunResult part = run_graph(g.graph, {.demand = {.ports = ports}, .region = Rect{70, 33, 71, 34}});
  ASSERT_EQ(part.end, RunResult::End::done) << to_text(part.problems);
  for (std::size_t i = 0; i < 4; ++i) {
    const Raster& a = part.buffers.at(ports[i]).as<Image>()->raster;
    const Raster& b = whole.buffers.at(ports[i]).as<Image>()->raster;
    EXPECT_EQ(a.frame().window, (Rect{70, 33, 71, 34}));
    EXPECT_EQ(a.at<float>(0, 0, 70, 33), b.at<float>(0, 0, 70, 33)) << g.graph.name(ports[i]);
  }
  EXPECT_EQ(part.buffers.at(ports[4]).as<Number>()->value, whole.buffers.at(ports[4]).as<Number>()->value);
}

TEST(Run, RunsNothingThatNobodyAskedFor) {
  GraphMaker g = diamond();
  g.add("bad", "test.number", {}, R"({"value": -1})");
  EXPECT_FALSE(run_bytes(g, "sum").empty());
}

TEST(Run, ReadsWholePixelsFromMemoryAndContinues) {
  GraphMaker g = diamond();
  g.add("total", "test.total", {{"image", "soft"}}).add("again", "test.source", {{"scale", "total"}});
  const RunResult r = run_graph(g.graph, {.demand = {.ports = {g.port("total"), g.port("again")}}});
  ASSERT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
  const double sum = r.buffers.at(g.port("total")).as<Number>()->value;
  EXPECT_NEAR(sum / (150 * 70), 1.5, 0.02) << "the mean of noise in [0, 1) times 3";
  EXPECT_EQ(r.buffers.at(g.port("again")).as<Image>()->raster.at<float>(0, 0, 1, 0),
            static_cast<float>(sum) * source::value(1, 0, 0));
}

TEST(Run, ChangingALateParameterRerunsOnlyWhatFollowsIt) {
  MemoryCache cache;
  const auto chain = [](const char* late) {
    GraphMaker g;
    g.add("early", "test.number", {})
        .add("noise", "test.source", {{"scale", "early"}})
        .add("total", "test.total", {{"image", "noise"}})
        .add("late", "test.source", {{"scale", "total"}}, late);
    return g;
  };
  const auto runs = [&](const char* late) {
    struct Seen : Observer {
      std::vector<std::string> ids;
      void done(const WorkDone& w) override { ids.insert(ids.end(), w.nodes.begin(), w.nodes.end()); }
    } seen;
    const GraphMaker g = chain(late);
    EXPECT_EQ(
        run_graph(g.graph, {.demand = {.ports = {g.port("late")}}, .observer = &seen, .cache = &cache}).end,
        RunResult::End::done);
    return seen.ids;
  };
  EXPECT_EQ(runs(R"({"size": [8, 8]})"),
            (std::vector<std::string>{"early", "noise", "noise", "total", "late", "late"}));
  EXPECT_EQ(runs(R"({"size": [9, 8]})"), (std::vector<std::string>{"late", "late"}));
  EXPECT_TRUE(runs(R"({"size": [9, 8]})").empty());
}

TEST(Run, NamesTheFirstNodeThatMadeANaN) {
  GraphMaker g;
  g.add("noise", "test.source", {}, R"({"size": [90, 90], "nan_at": [61, 47]})")
      .add("soft", "test.blur", {{"image", "noise"}})
      .add("sum", "test.add", {{"a", "soft"}, {"b", "soft"}});
  const RunResult r = run_graph(g.graph, {.demand = {.ports = {g.port("sum")}}, .tile_edge = 32});
  ASSERT_TRUE(r.culprit.has_value());
  EXPECT_EQ(r.culprit->node, "noise");
  ASSERT_EQ(r.problems.size(), 1u);
  EXPECT_EQ(r.problems.list()[0].code, "not_finite_result");
  EXPECT_EQ(r.problems.list()[0].severity, Severity::warning);
  EXPECT_EQ(r.culprit->where, "plane R, sample 0, pixel 61,47");
  EXPECT_EQ(run_graph(diamond().graph, {.demand = {.ports = {diamond().port("sum")}}}).culprit, std::nullopt);
}

TEST(Run, AFailingNodeEndsTheRunAtItsPlace) {
  GraphMaker g;
  g.add("bad", "test.number", {}, R"({"value": -1})")
      .add("noise", "test.source", {{"scale", "bad"}})
      .output("o", "noise", "o.exr");
  RunOptions o{.demand = {.outputs = {0}}};
  bool opened = false;
  o.make_sink = [&](const SinkRequest&) -> std::unique_ptr<Sink> {
    opened = true;
    return nullptr;
  };
  const RunResult r = run_graph(g.graph, o);
  EXPECT_EQ(r.end, RunResult::End::failed);
  ASSERT_EQ(r.problems.size(), 1u);
  EXPECT_EQ(r.problems.list()[0].code, "negative");
  EXPECT_EQ(r.problems.list()[0].pointer, "/nodes/bad");
  EXPECT_FALSE(opened);
}

TEST(Run, ACancelledRunFinishesNoSink) {
  GraphMaker g = diamond();
  g.output("picture", "sum", "sum.exr");
  CancelFlag flag;
  struct Breaker : Observer {
    CancelFlag& flag;
    explicit Breaker(CancelFlag& f) : flag(f) {}
    void started(std::string_view node) override {
      if (node == "softer") flag.cancel();
    }
  } breaker(flag);
  Recorder::Log log;
  RunOptions o{.demand = {.outputs = {0}}, .tile_edge = 16, .cancel = &flag, .observer = &breaker};
  o.make_sink = [&](const SinkRequest& r) {
    log.request = r;
    return std::make_unique<Recorder>(log);
  };
  EXPECT_EQ(run_graph(g.graph, o).end, RunResult::End::cancelled);
  EXPECT_FALSE(log.finished);
}

TEST(Run, RefusesWhatDoesNotFitInMemoryBeforePixelsStart) {
  GraphMaker g;
  g.add("noise", "test.source", {}, R"({"size": [4096, 4096]})");
  const RunResult r = run_graph(g.graph, {.demand = {.ports = {g.port("noise")}}, .memory = 32u << 20});
  EXPECT_EQ(r.end, RunResult::End::failed);
  ASSERT_EQ(r.problems.size(), 1u);
  EXPECT_EQ(r.problems.list()[0].code, "memory");
  EXPECT_THAT(r.problems.list()[0].message, HasSubstr("64.0 MiB more"));
}

TEST(Run, OnePixelAndOneRowAreNoSpecialCase) {
  for (const char* size : {"[1, 1]", "[1, 4096]", "[4096, 1]", "[7, 5]"}) {
    GraphMaker g;
    g.add("noise", "test.source", {}, std::string(R"({"size": )") + size + "}")
        .add("soft", "test.blur", {{"image", "noise"}}, R"({"radius": 3})");
    EXPECT_EQ(run_bytes(g, "soft"), run_bytes(g, "soft", {.threads = 1, .tile_edge = -1, .fuse = false}))
        << size;
  }
}

}  // namespace
}  // namespace frustum::test
