#include "runtime/app/sweep/sweep.h"

#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/app/sweep/analysis.h"
#include "runtime/app/sweep/journal.h"
#include "runtime/app/sweep/plot.h"
#include "runtime/app/sweep/report.h"
#include "runtime/core/error.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

namespace frustum {
namespace {

using test::TempFolder;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

const std::string teapot = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/gallery/teapot.json";

Session& session() {
  static Session s;
  return s;
}

SweepOptions small(const TempFolder& folder, std::vector<std::string> knobs) {
  SweepOptions o;
  o.graph = teapot;
  o.load.settings = {{"resolution", "[96,54]"}, {"samples", "4"}};
  o.knobs = std::move(knobs);
  o.repeats = 1;
  o.folder = folder.path();
  o.want = "draw.image";
  return o;
}

Sweep swept(const SweepOptions& o) {
  Diagnostics problems;
  auto s = run_sweep(session(), o, problems);
  EXPECT_TRUE(s) << to_text(problems);
  return s ? std::move(*s) : Sweep();
}

const SweepPoint& point(const Sweep& s, const std::string& value) {
  for (const SweepPoint& p : s.points)
    if (p.knob && p.values[*p.knob] == value) return p;
  throw std::runtime_error("no point " + value);
}

TEST(SweepFit, FindsTheSlopeOfAPowerLaw) {
  std::vector<std::pair<double, double>> xy;
  for (const double x : {1.0, 4.0, 16.0, 64.0}) xy.emplace_back(x, 3 * std::pow(x, -0.75));
  const auto fit = fit_slope(xy);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, -0.75, 1e-12);
  EXPECT_NEAR(std::pow(10, fit->intercept), 3, 1e-12);
  EXPECT_NEAR(fit->r2, 1, 1e-12);
}

TEST(SweepFit, LeavesOutWhatHasNoLogarithm) {
  const std::vector<std::pair<double, double>> xy{{1, 1}, {2, 0.5},  {4, 0.25},     {8, 0},
                                                  {0, 1}, {16, NAN}, {32, INFINITY}};
  const auto fit = fit_slope(xy);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->points, 3u);
  EXPECT_NEAR(fit->slope, -1, 1e-12);
  EXPECT_FALSE(fit_slope(std::vector<std::pair<double, double>>{{1, 1}, {2, 1}}))
      << "two points make any line";
  EXPECT_FALSE(fit_slope(std::vector<std::pair<double, double>>{{2, 1}, {2, 2}, {2, 3}}))
      << "nothing was turned";
}

SweepPoint made(double ms, double error) {
  SweepPoint p;
  p.errors["rmse"] = error;
  p.times = {std::chrono::nanoseconds(static_cast<std::int64_t>(ms * 1e6))};
  return p;
}

TEST(SweepAnalysis, TheFrontIsWhatNothingDominates) {
  Sweep s;
  s.points = {made(10, 0.1), made(5, 0.2), made(20, 0.05), made(12, 0.1), made(30, 0.06), made(1, NAN)};
  analyse(s);
  std::vector<bool> front;
  for (const SweepPoint& p : s.points) front.push_back(p.pareto);
  EXPECT_THAT(front, ElementsAre(true, true, true, false, false, false));
}

TEST(SweepAnalysis, BuysAreRankedByHalvingsPerMillisecond) {
  Sweep s;
  s.points = {made(10, 0.8), made(14, 0.4), made(11, 0.4), made(9, 0.7), made(12, 0.9), made(50, 0)};
  analyse(s);
  ASSERT_EQ(s.steps.size(), 3u) << "neither what is worse nor the reference itself";
  EXPECT_EQ(s.steps[0].point, 3u) << "better and faster";
  EXPECT_EQ(s.steps[1].point, 2u);
  EXPECT_NEAR(s.steps[1].halvings_per_ms, 1, 1e-9);
  EXPECT_NEAR(s.steps[2].halvings_per_ms, 0.25, 1e-9);
}

TEST(SweepAnalysis, MedianAndDeviation) {
  SweepPoint p = made(1, 0);
  for (const int ms : {2, 3, 4, 100}) p.times.push_back(std::chrono::milliseconds(ms));
  EXPECT_EQ(median_of(p), std::chrono::milliseconds(3));
  EXPECT_EQ(min_of(p), std::chrono::milliseconds(1));
  EXPECT_EQ(deviation_of(p), std::chrono::milliseconds(1));
}

TEST(SweepKnobs, AreTheDeclaredOnesUpstreamButThoseOfTaste) {
  const Loaded loaded = session().load(teapot);
  ASSERT_TRUE(loaded.graph);
  SweepOptions o;
  o.graph = teapot;
  const auto addresses = [&](const char* want) {
    std::vector<std::string> out;
    for (const SweepKnob& k : sweep_knobs(session(), *loaded.graph, *loaded.graph->find_port(want), o))
      out.push_back(k.address);
    return out;
  };
  const auto of_beauty = addresses("display.image"), of_mesh = addresses("mesh.mesh");
  EXPECT_THAT(of_beauty, testing::IsSupersetOf(
                             {"draw/pattern:samples", "mesh:tolerance_px", "display:engine", "precision"}));
  EXPECT_THAT(of_beauty, testing::Not(testing::Contains("draw/pixels:filter"))) << "a filter is taste";
  EXPECT_THAT(of_mesh, testing::Not(testing::Contains("draw/pattern:samples"))) << "downstream of the mesh";
}

TEST(SweepKnobs, AGraphParameterHasTheSlopeOfWhatItFeeds) {
  const Loaded loaded = session().load(teapot);
  SweepOptions o;
  o.graph = teapot;
  o.knobs = {"samples=1,4,64", "draw/pixels:filter"};
  const auto knobs = sweep_knobs(session(), *loaded.graph, *loaded.graph->find_port("display"), o);
  EXPECT_EQ(knobs[0].slope, -0.75);
  EXPECT_EQ(knobs[0].current, "16");
  EXPECT_EQ(knobs[1].values.front(), "box") << "without values: those that it declares";
  for (const char* bad : {"sampels", "draw/pattern:samples=4", "samples=4,4", "precision=half"}) {
    o.knobs = {bad};
    EXPECT_THROW(sweep_knobs(session(), *loaded.graph, *loaded.graph->find_port("display"), o), NodeError)
        << bad;
  }
}

TEST(Sweep, ErrorsFallAndWorkRisesWithSamples) {
  const TempFolder folder;
  const Sweep s = swept(small(folder, {"samples=1,4,16,256"}));
  ASSERT_EQ(s.points.size(), 4u) << "4 is what the graph has";
  const SweepPoint &one = point(s, "1"), &sixteen = point(s, "16"), &all = point(s, "256");
  EXPECT_GT(one.error("rmse"), 2 * sixteen.error("rmse"));
  EXPECT_EQ(all.error("rmse"), 0);
  EXPECT_GE(sixteen.counters.at("draw/hits samples"), 12 * one.counters.at("draw/hits samples"))
      << "margins vary";
  EXPECT_GT(sixteen.work, one.work);
  EXPECT_EQ(s.points.front().values[0], "4");
  EXPECT_EQ(one.times.size(), 1u);
}

TEST(Sweep, WorkIsTheSameForEveryNumberOfThreads) {
  const TempFolder a, b;
  SweepOptions one = small(a, {"samples=1,4"}), three = small(b, {"samples=1,4"});
  one.threads = 1, three.threads = 3;
  const Sweep x = swept(one), y = swept(three);
  for (std::size_t i = 0; i < x.points.size(); ++i) {
    EXPECT_EQ(x.points[i].counters, y.points[i].counters);
    EXPECT_EQ(x.points[i].errors, y.points[i].errors);
  }
}

// Stratified samples across edges: n^-3/4, whether scrambled Sobol or jittered; docs/accuracy.md prints the same.
TEST(Sweep, SlopesAreThoseOfTheory) {
  for (const char* kind : {"sobol", "jittered"}) {
    const TempFolder folder;
    SweepOptions o = small(folder, {"samples=1,2,4,8,16,32,64,1024"});
    o.load.settings = {{"resolution", "[160,90]"}, {"draw/pattern:kind", kind}};
    const Sweep s = swept(o);
    ASSERT_EQ(s.fits.size(), 1u);
    ASSERT_TRUE(s.fits[0].over_value);
    EXPECT_NEAR(s.fits[0].over_value->slope, *s.knobs[0].slope, 0.15) << kind;
    EXPECT_GT(s.fits[0].over_value->r2, 0.95) << kind;
  }
}

TEST(Sweep, AGridHasEveryCombination) {
  const TempFolder folder;
  SweepOptions o = small(folder, {"samples=1,4", "draw/lit:interpolation=flat,gouraud,phong"});
  o.grid = true;
  const Sweep s = swept(o);
  EXPECT_EQ(s.points.size(), 6u);
  EXPECT_TRUE(s.fits.empty());
  const auto& exact = *std::find_if(s.points.begin(), s.points.end(), [](const SweepPoint& p) {
    return p.values == std::vector<std::string>{"4", "phong"};
  });
  EXPECT_EQ(exact.error("rmse"), 0) << "the reference is its last corner";
  for (const SweepPoint& p : s.points) {
    const bool dominated = std::any_of(s.points.begin(), s.points.end(), [&](const SweepPoint& q) {
      return median_of(q) < median_of(p) && q.error("rmse") < p.error("rmse");
    });
    EXPECT_TRUE(!p.pareto || !dominated) << p.values[0] << ", " << p.values[1];
  }
  EXPECT_TRUE(exact.pareto);
  o.knobs = {"samples=1,2,3,4,5,6,7,8,9,10", "mesh:tolerance_px=1,2,3,4,5,6,7,8,9,10",
             "mesh:min_segments=1,2,3,4,5,6,7,8,9,10", "draw/pixels:radius=1,2,3,4,5,6,7,8,9,10,11"};
  Diagnostics problems;
  EXPECT_THROW(run_sweep(session(), o, problems), NodeError) << "11000 points";
}

TEST(Sweep, AKnobThatChangesNothingIsSaidSo) {
  const TempFolder folder;
  const Sweep s = swept(small(folder, {"mesh:tolerance=0.1,0.001"}));  // the camera's tolerance_px counts
  ASSERT_EQ(s.fits.size(), 1u);
  EXPECT_TRUE(s.fits[0].without_effect);
  EXPECT_THAT(sweep_text(s, 5), HasSubstr("no effect"));
}

// What the graph has is a value of every knob: turned to the other one, a knob of two values has an effect.
TEST(Sweep, TheGraphAsItIsHasAnOwnErrorOfEveryKnob) {
  const TempFolder folder;
  const Sweep s = swept(small(folder, {"draw/lit:rate=pixel,sample", "samples=1,4,16"}));
  ASSERT_EQ(s.points.size(), 4u);
  EXPECT_GT(s.points.front().own_error(0).value(), 0);
  EXPECT_GT(s.points.front().own_error(1).value(), 0);
  EXPECT_NE(s.points.front().own_error(0), s.points.front().own_error(1));
  EXPECT_FALSE(s.fits[0].without_effect);
  EXPECT_EQ(point(s, "sample").own_error(), 0);
}

TEST(Sweep, SaysWhereItsTimeWent) {
  const TempFolder folder;
  Sweep s = swept(small(folder, {"samples=1,4,16"}));
  const auto files = write_sweep(s);
  const SweepCosts& c = s.costs;
  for (const double part : {c.timed, c.first, c.reference, c.loading, c.judging, c.journal, c.report})
    EXPECT_GT(part, 0);
  const double parts = c.runs() + c.loading + c.judging + c.journal + c.report;
  EXPECT_LE(parts, c.total);
  EXPECT_NEAR(c.overhead(), 1 - c.runs() / c.total, 1e-12);
  const Json json = Json::parse(read_text(files[0]));
  EXPECT_DOUBLE_EQ(json["overhead"].get<double>(), c.overhead());
  EXPECT_GT(json["seconds"]["report"].get<double>(), 0);
  EXPECT_THAT(read_text(files[2]), HasSubstr("measuring overhead"));
  EXPECT_THAT(sweep_text(s, 1), HasSubstr("measuring overhead"));
}

TEST(SweepReport, SaysWhetherASlopeIsThatOfTheory) {
  SweepKnob knob{"samples", {"1", "4"}, "1", "", -0.75};
  KnobFit fit;
  EXPECT_EQ(theory_text(fit, knob), "") << "nothing was fitted";
  fit.over_value = SlopeFit{.slope = -0.84, .r2 = 1};
  EXPECT_EQ(theory_text(fit, knob), "within 0.15 of theory");
  fit.over_value->slope = -0.91;
  EXPECT_EQ(theory_text(fit, knob), "outside 0.15 of theory");
  knob.slope.reset();
  EXPECT_EQ(theory_text(fit, knob), "");
}

TEST(Sweep, GoesOnWhereItWasCutOff) {
  const TempFolder folder;
  SweepOptions o = small(folder, {"samples=1,4,16"});
  o.repeats = 2;
  const Sweep whole = swept(o);
  const fs::path journal = fs::path(folder.path()) / "points.jsonl";
  const std::string text = read_text(journal);
  // The header, the first point's error and half a line.
  const auto second = text.find('\n', text.find('\n') + 1) + 1;
  write_text(journal, text.substr(0, second) + "{\"point\": \"12");
  o.resume = true;
  const Sweep again = swept(o);
  EXPECT_EQ(again.resumed, 1u);
  for (std::size_t i = 0; i < whole.points.size(); ++i) {
    EXPECT_EQ(again.points[i].errors, whole.points[i].errors);
    EXPECT_EQ(again.points[i].own_errors, whole.points[i].own_errors);
    EXPECT_EQ(again.points[i].times.size(), 2u);
  }
  const Sweep third = swept(o);
  EXPECT_EQ(third.resumed, 3u);
  EXPECT_EQ(third.points[1].times, again.points[1].times) << "nothing was run again";
  o.metrics = {"max"};
  Diagnostics problems;
  EXPECT_THROW(run_sweep(session(), o, problems), NodeError) << "another sweep";
}

TEST(Sweep, CancellingKeepsWhatIsFinished) {
  const TempFolder folder;
  SweepOptions o = small(folder, {"samples=1,4,16"});
  CancelFlag flag;
  o.cancel = &flag;
  o.progress = [&](std::size_t done, std::size_t, const std::string&) {
    if (done >= 3) flag.cancel();
  };
  Diagnostics problems;
  EXPECT_THROW(run_sweep(session(), o, problems), Cancelled);
  SweepOptions rest = small(folder, {"samples=1,4,16"});
  rest.resume = true;
  EXPECT_GE(swept(rest).resumed, 1u);
  std::map<std::string, int> errors, times;
  std::istringstream journal(read_text(fs::path(folder.path()) / "points.jsonl"));
  std::string line;
  for (std::getline(journal, line); std::getline(journal, line);) {
    const Json entry = Json::parse(line);
    if (entry.contains("errors")) ++errors[entry["point"]];
    if (entry.contains("ns")) ++times[entry["point"]];
  }
  EXPECT_EQ(errors.size(), 3u);
  for (const auto& [point, n] : errors) EXPECT_EQ(n, 1) << point << " was measured twice";
  for (const auto& [point, n] : times) EXPECT_EQ(n, 1) << point << " was timed twice";
}

TEST(Sweep, TheReferenceMayBeSetOrAFile) {
  const TempFolder folder;
  SweepOptions o = small(folder, {"samples=1,16"});
  o.reference = {"samples=64"};
  const Sweep s = swept(o);
  EXPECT_GT(point(s, "16").error("rmse"), 0);
  EXPECT_EQ(s.reference, "samples = 64");
  o.reference = {"samples=4", "precision=double"};
  EXPECT_GT(swept(o).points.front().error("rmse"), 0) << "4 samples in single precision";
  EXPECT_LT(swept(o).points.front().error("rmse"), 0.1 * s.points.front().error("rmse"));
  o.reference = {"samples"};
  Diagnostics problems;
  EXPECT_THROW(run_sweep(session(), o, problems), NodeError);

  // A picture of the graph at another setting, saved and read again, is that reference.
  LoadOptions exact = o.load;
  exact.settings.push_back({"samples", "64"});
  const Loaded loaded = session().load(teapot, exact);
  const PortRef want = *loaded.graph->find_port("draw.image");
  const Buffer b = session().run(*loaded.graph, {.demand = {.ports = {want}}}, false).buffers.at(want);
  const std::string file = folder.file("exact.exr");
  save_raster(b.type().raster(b.data()), file);
  o.reference.clear(), o.reference_file = file;
  const Sweep from_file = swept(o);
  EXPECT_EQ(from_file.reference, file);
  for (std::size_t i = 0; i < s.points.size(); ++i)
    EXPECT_NEAR(from_file.points[i].error("rmse"), s.points[i].error("rmse"),
                1e-3 * s.points[i].error("rmse"));
}

TEST(Sweep, ABadSettingIsADiagnostic) {
  const TempFolder folder;
  SweepOptions o = small(folder, {"draw/lit:interpolation=flat,fong"});
  Diagnostics problems;
  EXPECT_FALSE(run_sweep(session(), o, problems));
  EXPECT_TRUE(problems.has_errors());
  o = small(folder, {"samples=1,4"});
  o.metrics = {"rsme"};
  EXPECT_THROW(run_sweep(session(), o, problems), NodeError);
}

TEST(Sweep, MeshesAreSweptToo) {
  const TempFolder folder;
  SweepOptions o = small(folder, {"precision=single,double"});
  o.want = "mesh.mesh";
  Sweep s = swept(o);
  EXPECT_GT(s.points.front().error("rmse"), 0);
  EXPECT_THAT(sweep_html(s), HasSubstr("mesh.mesh"));
}

TEST(SweepReport, ThePageNeedsNoOtherFile) {
  const TempFolder folder;
  SweepOptions o = small(folder, {"samples=1,4,16"});
  o.metrics = {"rmse", "flip"};
  Sweep s = swept(o);
  const auto files = write_sweep(s);
  ASSERT_EQ(files.size(), 3u);
  const std::string page = read_text(files[2]);
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,iVBOR"));
  for (const char* outside : {"src=\"http", "href=\"http", "url(", "@import"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  EXPECT_THAT(page, HasSubstr("Pareto front"));
  const Json json = Json::parse(read_text(files[0]));
  EXPECT_EQ(json["points"].size(), 3u);
  EXPECT_EQ(json["points"][0]["values"][0], "4");
  const std::string csv = read_text(files[1]);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  EXPECT_THAT(csv, HasSubstr("turned,samples,rmse,flip,own_error,min_ms"));
}

TEST(SweepPlot, TicksAreDecadesAndTextIsEscaped) {
  Plot plot;
  plot.title = "a < b & \"c\"";
  plot.series = {{"s", 0, {{1, 1e-3, "<b>", 0, false}, {1000, 1, "", 1, true}, {10, 0, "exact", 2, false}}}};
  const std::string text = svg(plot);
  EXPECT_THAT(text, HasSubstr("a &lt; b &amp; &quot;c&quot;"));
  EXPECT_THAT(text, HasSubstr("&lt;b&gt;"));
  for (const char* tick : {">0.001<", ">0.01<", ">1<", ">100<", ">1000<"}) EXPECT_THAT(text, HasSubstr(tick));
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(svg(Plot()).find("inf"), std::string::npos) << "an empty plot is drawn";
}

}  // namespace
}  // namespace frustum
