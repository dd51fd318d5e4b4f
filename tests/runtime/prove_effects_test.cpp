// Every effect of a picture, end to end: where the scene does not call for it, forcing it changes no bit;
// where it does, leaving it out changes bits; and a predicate that lies about that is caught by the proof.
#include "runtime/app/effects/plan_effects.h"
#include "runtime/app/effects/prove.h"
#include "tests/support/broken_effect.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>

namespace frustum {
namespace {

using testing::HasSubstr;

// A ball in view of a perspective camera, with lights, a material and a texture that call for as little as
// possible. Every part can be replaced by another.
using Parts = std::map<std::string, std::string>;

Parts plain() {
  return {{"mesh", R"({ "type": "mesh.sphere", "params": { "segments": 16, "rings": 9 } })"},
          {"eye", "[1.5, 1, 3]"},
          {"projection", R"("project.perspective")"},
          {"light", R"({ "type": "light.directional", "params": { "direction": [-1, -2, -1] } })"},
          {"material", R"({ "diffuse": [0.7, 0.3, 0.2] })"},
          {"texture", ""},
          {"shadow", ""},
          {"pyramid", "true"},
          {"filter", R"("trilinear")"},
          {"shading", R"({ "interpolation": "phong" })"},
          {"samples", "3"},
          {"resolve", R"({ "filter": "mitchell" })"},
          {"space", R"("lin_rec709")"}};
}

std::string text_of(const Parts& p, const std::string& folder) {
  const auto at = [&](const char* name) { return p.at(name); };
  std::string image, link;
  if (!at("texture").empty()) {
    image = fmt::format(R"("file": {{ "type": "io.load_image", "params": {{ "file": "{}/{}.ppm" }} }},
      "card": {{ "type": "texture.image", "in": {{ "image": "file" }}, "params": {{ "pyramid": {} }} }},)",
                        folder, at("texture"), at("pyramid"));
    link = R"(, "texture": "card")";
  }
  std::string shadow, visibility;
  if (!at("shadow").empty()) {
    shadow =
        fmt::format(R"("shadow": {{ "type": "shade.shadow", "in": {{ "points": "points", "mesh": "screen",
               "casters": "{}", "lights": ["light"] }} }},)",
                    at("shadow"));
    visibility = R"(, "visibility": "shadow")";
  }
  return fmt::format(R"({{ "format": "frustum.graph/1", "nodes": {{
      "mesh": {}, "light": {}, {} {}
      "camera": {{ "type": "scene.camera", "params": {{ "eye": {}, "resolution": [56, 40] }} }},
      "material": {{ "type": "shade.material", "params": {} }},
      "eye": {{ "type": "project.view", "in": {{ "mesh": "mesh", "camera": "camera" }} }},
      "clip": {{ "type": {}, "in": {{ "mesh": "eye", "camera": "camera" }} }},
      "near": {{ "type": "cull.frustum", "in": {{ "mesh": "clip" }} }},
      "cut": {{ "type": "clip.homogeneous", "in": {{ "mesh": "near" }} }},
      "screen": {{ "type": "project.viewport", "in": {{ "mesh": "cut", "camera": "camera" }} }},
      "pattern": {{ "type": "supersample.pattern", "params": {{ "samples": {}, "kind": "sobol" }} }},
      "hits": {{ "type": "rasterize.triangles", "in": {{ "mesh": "screen", "pattern": "pattern" }} }},
      "points": {{ "type": "rasterize.attributes", "in": {{ "hits": "hits", "mesh": "screen" }} }},
      "albedo": {{ "type": "texture.sample", "in": {{ "points": "points", "mesh": "screen"{} }}, "params": {{ "filter": {} }} }},
      "lit": {{ "type": "shade.surface", "in": {{ "points": "points", "mesh": "screen", "albedo": "albedo",
               "material": "material", "lights": ["light"]{} }}, "params": {} }},
      "pixels": {{ "type": "supersample.resolve", "in": {{ "image": "lit" }}, "params": {} }},
      "display": {{ "type": "color.convert", "in": {{ "image": "pixels" }}, "params": {{ "to": {} }} }} }},
    "outputs": {{ "image": {{ "from": "display" }} }} }})",
                     at("mesh"), at("light"), image, shadow, at("eye"), at("material"), at("projection"),
                     at("samples"), link, at("filter"), visibility, at("shading"), at("resolve"),
                     at("space"));
}

struct Case {
  const char* effect;
  Parts without;  // replaces parts of plain(): the scene does not call for it
  Parts with;     // it does
};

const char* const box = R"({ "type": "mesh.box" })";
const char* const floor_around =
    R"({ "type": "mesh.grid", "params": { "size": [60, 60], "segments": [3, 3] } })";
const char* const sheet = R"({ "type": "mesh.grid", "params": { "size": [2, 2] } })";
const char* const sky = R"({ "type": "light.ambient", "params": { "color": [0.3, 0.4, 0.5] } })";
const char* const lamp =
    R"({ "type": "light.point", "params": { "position": [2, 3, 1], "color": [4, 4, 4] } })";
const char* const fading =
    R"({ "type": "light.point", "params": { "position": [2, 3, 1], "color": [4, 4, 4], "attenuation": [1, 0.1, 0.2] } })";
const char* const shiny = R"({ "specular": 0.5, "shininess": 20 })";

std::vector<Case> cases() {
  return {
      {"clipping", {}, {{"mesh", floor_around}, {"eye", "[0, 1, 3]"}}},
      {"perspective_divide", {{"projection", R"("project.orthographic")"}}, {}},
      {"perspective_interpolation", {{"projection", R"("project.orthographic")"}}, {{"light", lamp}}},
      {"normal_interpolation", {{"mesh", box}}, {}},
      {"highlights", {}, {{"material", shiny}}},
      {"highlights", {{"light", sky}, {"material", shiny}}, {{"material", shiny}, {"light", lamp}}},
      {"highlights",
       {{"shading", R"({ "interpolation": "gouraud" })"}},
       {{"shading", R"({ "interpolation": "gouraud" })"}, {"material", shiny}}},
      {"highlights",
       {{"shading", R"({ "interpolation": "flat", "rate": "pixel" })"}},
       {{"shading", R"({ "interpolation": "flat", "rate": "pixel" })"}, {"material", shiny}}},
      {"shadows",
       {{"mesh", floor_around}, {"eye", "[0, 2, 3]"}, {"shadow", "mesh"}},
       {{"mesh", R"({ "type": "mesh.torus" })"}, {"shadow", "mesh"}}},
      {"shadows", {{"light", sky}, {"shadow", "mesh"}}, {{"light", fading}, {"shadow", "mesh"}}},
      {"ambient_light", {}, {{"light", sky}}},
      {"ambient_light",
       {{"light", sky}, {"material", R"({ "ambient": 0 })"}},
       {{"light", sky}, {"shading", R"({ "interpolation": "gouraud" })"}}},
      {"attenuation", {}, {{"light", fading}}},
      {"attenuation", {{"light", lamp}}, {{"light", fading}, {"shading", R"({ "rate": "pixel" })"}}},
      {"two_sided_lighting",
       {},
       {{"mesh", floor_around},
        {"eye", "[0, -1, 3]"},
        {"material", R"({ "two_sided": true })"},
        {"light", R"({ "type": "light.directional", "params": { "direction": [0, 1, 0] } })"}}},
      {"two_sided_lighting",
       {{"mesh", floor_around}, {"material", R"({ "two_sided": true })"}},
       {{"mesh", floor_around},
        {"eye", "[0, -1, 3]"},
        {"shading", R"({ "two_sided": true, "interpolation": "gouraud" })"},
        {"light", R"({ "type": "light.directional", "params": { "direction": [0, 1, 0] } })"}}},
      {"supersampling",
       {{"shading", R"({ "interpolation": "flat" })"}},
       {{"shading", R"({ "interpolation": "flat" })"}, {"texture", "varied"}}},
      {"supersampling",
       {{"shading", R"({ "interpolation": "flat", "two_sided": true })"},
        {"material", shiny},
        {"light", lamp}},
       {{"shading", R"({ "interpolation": "gouraud" })"}, {"light", lamp}}},
      {"supersampling",
       {{"shading", R"({ "interpolation": "flat" })"}, {"samples", "16"}},
       {{"light", lamp}}},
      {"texture_lookup", {}, {{"texture", "varied"}}},
      {"texture_lookup", {{"texture", "constant"}}, {{"texture", "varied"}, {"filter", R"("nearest")"}}},
      {"texture_lookup", {{"texture", "white"}, {"filter", R"("bilinear")"}}, {{"texture", "almost"}}},
      {"mip_levels", {{"texture", "varied"}, {"pyramid", "false"}}, {{"texture", "varied"}}},
      {"mip_levels",
       {{"mesh", sheet}, {"eye", "[0, 3, 1]"}, {"texture", "almost"}},
       {{"mesh", sheet}, {"eye", "[0, 3, 1]"}, {"texture", "varied"}}},
      {"mip_levels",
       {{"mesh", sheet}, {"eye", "[0, 3, 1]"}, {"texture", "almost"}, {"filter", R"("ewa")"}},
       {{"mesh", box}, {"texture", "varied"}, {"filter", R"("ewa")"}}},
      {"mip_levels",
       {{"mesh", sheet}, {"eye", "[0, 3, 1]"}, {"texture", "almost"}, {"filter", R"("mitchell")"}},
       {{"mesh", floor_around}, {"eye", "[0, 1, 3]"}, {"texture", "varied"}, {"filter", R"("mitchell")"}}},
      {"reconstruction", {{"samples", "1"}, {"resolve", R"({ "filter": "box" })"}}, {}},
      {"color_conversion", {}, {{"space", R"("srgb")"}}},
  };
}

// Four times the same texel; all different; one of sixty-four a little darker.
void write_textures(const test::TempFolder& folder) {
  folder.write("constant.ppm", "P3 2 2 255\n200 90 40 200 90 40 200 90 40 200 90 40\n");
  folder.write("white.ppm", "P3 2 1 255\n255 255 255 255 255 255\n");
  std::string varied = "P3 64 64 255\n", almost = "P3 8 8 255\n";
  for (int i = 0; i < 64 * 64; ++i) varied += fmt::format("{} {} {}\n", i * 37 % 256, i * 59 % 256, i / 16);
  for (int i = 0; i < 8 * 8; ++i) almost += i == 27 ? "0 0 0\n" : "255 255 255\n";
  folder.write("varied.ppm", varied);
  folder.write("almost.ppm", almost);
}

class ProvenEffects : public testing::Test {
 protected:
  ProvenEffects() { write_textures(folder_); }

  Graph load(const Session& session, Parts parts, Precision precision) const {
    Parts all = std::move(parts);
    all.merge(plain());
    LoadOptions options;
    options.precision = precision;
    Loaded loaded =
        load_graph_text(text_of(all, folder_.path()), folder_.file("g.json"), session.registry(), options);
    if (!loaded.graph) throw std::runtime_error(to_text(loaded.problems));
    return std::move(*loaded.graph);
  }
  static Demand demand(const Graph& g) { return {.ports = named_ports(g)}; }

  static RunResult run(Session& session, const Graph& g, const EffectPolicy& policy,
                       Observer* observer = nullptr) {
    RunOptions o{.demand = demand(g), .observer = observer};
    o.effects = policy;
    RunResult r = session.run(g, o, false);
    if (r.end != RunResult::End::done) throw std::runtime_error(to_text(r.problems));
    return r;
  }
  static Verdict::Kind verdict(const RunResult& r, std::string_view effect) {
    for (const NodeVerdict& v : r.verdicts)
      if (v.effect == effect) return v.verdict.kind;
    throw std::runtime_error("not decided");
  }

  test::TempFolder folder_;
  Session session_;
};

constexpr std::array precisions{Precision::single, Precision::real_double};

TEST_F(ProvenEffects, WhatIsNotCalledForChangesNoBitWhenItIsForced) {
  for (const Case& c : cases())
    for (const Precision precision : precisions) {
      const Graph g = load(session_, c.without, precision);
      const RunResult planned = run(session_, g, {});
      EXPECT_EQ(verdict(planned, c.effect), Verdict::Kind::off_exact) << c.effect;
      const Proof proof = prove_effects(session_, g, demand(g), {.repeats = 0});
      EXPECT_TRUE(proof.holds()) << c.effect << "\n" << proof_text(proof) << to_text(proof.problems);
      EXPECT_TRUE(std::any_of(proof.runs.begin(), proof.runs.end(),
                              [&](const ProvedRun& r) { return r.forced == c.effect; }));
    }
}

TEST_F(ProvenEffects, WhatIsCalledForChangesThePictureWhenItIsSkipped) {
  for (const Case& c : cases())
    for (const Precision precision : precisions) {
      const Graph g = load(session_, c.with, precision);
      const RunResult planned = run(session_, g, {}), skipped = run(session_, g, {.skipped = {c.effect}});
      EXPECT_EQ(verdict(planned, c.effect), Verdict::Kind::on) << c.effect;
      EXPECT_EQ(verdict(skipped, c.effect), Verdict::Kind::off_user) << c.effect;
      EXPECT_NE(planned.buffers.begin()->second.digest(), skipped.buffers.begin()->second.digest())
          << c.effect << ": the trap does not catch";
    }
}

TEST_F(ProvenEffects, TheProofCatchesAPredicateThatLies) {
  for (const Case& c : cases()) {
    Session liar(test::with_broken_effect(session_.registry(), c.effect));
    const Graph honest = load(session_, c.with, Precision::single), g = load(liar, c.with, Precision::single);
    EXPECT_TRUE(prove_effects(session_, honest, demand(honest), {.repeats = 0}).holds()) << c.effect;
    const Proof proof = prove_effects(liar, g, demand(g), {.repeats = 0});
    EXPECT_EQ(proof.end, RunResult::End::done) << c.effect << to_text(proof.problems);
    EXPECT_GT(proof.differing_bits(), 0u) << c.effect;
    EXPECT_FALSE(proof.holds()) << c.effect;
    for (const ProvedRun& r : proof.runs)
      EXPECT_EQ(!r.differences.empty(), r.forced == "all" || r.forced == c.effect)
          << c.effect << ", " << r.forced;
  }
}

TEST_F(ProvenEffects, PlanesAndOutputsThatNobodyReadsAreFilledWhenForced) {
  const Graph g = load(session_, {}, Precision::single);
  const RunResult planned = run(session_, g, {});
  EXPECT_EQ(verdict(planned, "unread_planes"), Verdict::Kind::off_exact);
  const RunResult forced = run(session_, g, {.forced = {"unread_planes", "unused_outputs"}});
  EXPECT_EQ(planned.buffers.begin()->second.digest(), forced.buffers.begin()->second.digest());
}

TEST_F(ProvenEffects, PixelsThatShowNothingAreComputedWhenForced) {
  struct Pixels : Observer {
    std::uint64_t points = 0;
    void pixel_times(const std::vector<PixelNodeTime>& times) override {
      for (const PixelNodeTime& t : times)
        if (t.node == "points") points += t.pixels;
    }
  } few, all;
  const Graph g = load(session_, {{"eye", "[0, 0, 12]"}}, Precision::single);
  const RunResult planned = run(session_, g, {}, &few);
  EXPECT_EQ(verdict(planned, "blank_pixels"), Verdict::Kind::off_exact);
  const RunResult forced = run(session_, g, {.forced = {"blank_pixels"}}, &all);
  EXPECT_EQ(planned.buffers.begin()->second.digest(), forced.buffers.begin()->second.digest());
  EXPECT_LT(2 * few.points, all.points);
}

// Points that have lost their ids are coloured everywhere; colours of nothing are 0, not -0, whatever the albedo's
// opacity is there.
TEST_F(ProvenEffects, WhatShowsWithoutAFaceShowsWithoutOneInFewerPixels) {
  const std::string front = R"({ "format": "frustum.graph/1", "nodes": {
    "ball":   { "type": "mesh.sphere" },
    "camera": { "type": "scene.camera", "params": { "eye": [3, 2, 9], "resolution": [120, 90] } },
    "eye":    { "type": "project.view", "in": { "mesh": "ball", "camera": "camera" } },
    "clip":   { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } },
    "screen": { "type": "project.viewport", "in": { "mesh": "clip", "camera": "camera" } },
    "hits":   { "type": "rasterize.triangles", "in": { "mesh": "screen" } },
    "points": { "type": "rasterize.attributes", "in": { "hits": "hits", "mesh": "screen" } },
    "means":  { "type": "supersample.resolve", "in": { "image": "points" }, "params": { "filter": "box" } },
    "board":  { "type": "texture.checker" },
    "sun":    { "type": "light.directional" },
    "albedo": { "type": "texture.sample", "in": { "points": "points", "texture": "board" } },
    "soft":   { "type": "supersample.resolve", "in": { "image": "albedo" },
                "params": { "filter": "mitchell", "radius": 3 } },
)";
  for (
      const std::string last :
      {R"("last": { "type": "texture.sample", "in": { "points": "means", "texture": "board" },
                     "params": { "filter": "nearest" } })",
       R"("last": { "type": "texture.noise", "in": { "points": "means" }, "params": { "bounded": false } })",
       R"("last": { "type": "texture.marble", "in": { "points": "means" }, "params": { "bounded": false } })",
       R"("last": { "type": "shade.surface", "in": { "points": "points", "mesh": "screen", "lights": ["sun"],
                     "albedo": "soft" } })"}) {
    const Loaded loaded =
        load_graph_text(front + last + R"( }, "outputs": { "image": { "from": "last" } } })",
                        folder_.file("g.json"), session_.registry(), {});
    ASSERT_TRUE(loaded.graph) << to_text(loaded.problems);
    const auto digest = [&](RunOptions o) {
      o.demand = demand(*loaded.graph);
      const RunResult r = session_.run(*loaded.graph, o, false);
      EXPECT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
      return r.buffers.begin()->second.digest();
    };
    RunOptions forced;
    forced.effects.forced = {"blank_pixels"};
    const auto truth = digest({.tile_edge = -1, .fuse = false});
    EXPECT_EQ(digest(forced), truth) << last;
    for (const int edge : {0, 8, 64}) EXPECT_EQ(digest({.tile_edge = edge}), truth) << last << edge;
  }
}

TEST_F(ProvenEffects, AShortcutChangesGeometryAndNoPicture) {
  const Graph g = load(session_, {{"eye", "[0, 0, 1.2]"}, {"mesh", floor_around}}, Precision::single);
  const PortRef near = *g.find_port("near.mesh"), image = *g.find_port("image");
  const Proof proof = prove_effects(session_, g, {.ports = {near, image}}, {.repeats = 0});
  EXPECT_TRUE(proof.holds()) << proof_text(proof);
  ASSERT_EQ(proof.layers.size(), 2u);
  EXPECT_THAT(proof.layers[0].left_out, HasSubstr("'near' takes a shortcut"));
  EXPECT_EQ(proof.layers[1].left_out, "");
}

TEST_F(ProvenEffects, ShadowsAreAbsentWhereSomethingMayCastOne) {
  const auto shadows = [&](Parts parts) {
    const Graph g = load(session_, std::move(parts), Precision::single);
    const EffectPlan plan = plan_effects(session_, g, demand(g));
    for (const PlannedEffect& e : plan.effects)
      if (e.effect == "shadows") return *e.verdict;
    return on("not decided");
  };
  EXPECT_EQ(shadows({}).kind, Verdict::Kind::off_exact) << "one convex body";
  EXPECT_EQ(shadows({{"light", sky}}).kind, Verdict::Kind::off_exact);
  EXPECT_EQ(shadows({{"material", R"({ "unlit": true })"}}).kind, Verdict::Kind::off_exact);
  const Verdict ring = shadows({{"mesh", R"({ "type": "mesh.torus" })"}});
  EXPECT_EQ(ring.kind, Verdict::Kind::absent);
  EXPECT_THAT(ring.why, HasSubstr("stands in front of face"));
  // A body that clipping cut may have lost what casts the shadow.
  EXPECT_EQ(shadows({{"eye", "[0, 0, 1.05]"}}).kind, Verdict::Kind::absent);
}

TEST_F(ProvenEffects, APlanRunsNoPixelsAndSaysWhatItWouldSave) {
  const Graph g = load(session_, {}, Precision::single);
  const EffectPlan plan = plan_effects(session_, g, demand(g));
  EXPECT_EQ(plan.facts.end, RunResult::End::done);
  EXPECT_GE(plan.count(Verdict::Kind::off_exact), 6u);
  EXPECT_GT(plan.estimate(Verdict::Kind::off_exact).count(), 0);
  const std::string text = effects_text(plan);
  EXPECT_THAT(text, HasSubstr("no face has a material with a highlight"));
  EXPECT_THAT(text, HasSubstr("an estimate"));
  EXPECT_THAT(text, HasSubstr("nobody reads"));
}

// Samples that show nothing cost nothing: an estimate counts the share of the picture that faces may cover.
TEST_F(ProvenEffects, AnEstimateCountsWhatFacesMayCover) {
  const auto share = [&](const char* eye) {
    const Graph g = load(session_, {{"eye", eye}}, Precision::single);
    for (const PlannedEffect& e : plan_effects(session_, g, demand(g)).effects)
      if (e.effect == "highlights") {
        EXPECT_EQ(e.item, "point");
        EXPECT_NEAR(static_cast<double>(e.estimate.count()),
                    static_cast<double>(e.verdict->items) * e.share *
                        find_effect(*session_.registry().find("shade.surface"), "highlights")->cost.ns,
                    1);
        return e.share;
      }
    return -1.0;
  };
  const double near = share("[0, 0, 1.3]"), middle = share("[0, 0, 6]"), far = share("[0, 0, 60]");
  EXPECT_EQ(near, 1) << "the ball fills the picture";
  EXPECT_LT(middle, 0.5);
  EXPECT_NEAR(far / middle, 0.01, 0.002) << "an area falls with the square of the distance";
}

TEST(EffectPolicy, UnknownNamesGetSuggestions) {
  const Session session;
  Diagnostics problems;
  const EffectPolicy policy = effect_policy(session.registry(), {"all"}, {"cliping", "clipping"}, problems);
  EXPECT_TRUE(policy.force_all);
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems.list()[0].code, "unknown_effect");
  EXPECT_THAT(problems.list()[0].suggestions, testing::ElementsAre("clipping"));
  EXPECT_EQ(problems.list()[1].code, "contradiction");
}

// ----- the command line

const std::string stages = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/gallery/teapot_stages.json";

std::vector<std::string> small(std::vector<std::string> arguments) {
  for (const char* a : {"--set", "resolution=[64,36]", "--set", "samples=2"}) arguments.push_back(a);
  return arguments;
}

TEST(EffectsCli, PlanProvesAndExitsWithZero) {
  const auto r = test::frustum(small({"plan", stages, "--prove", "--repeats", "1", "--json"}));
  ASSERT_EQ(r.code, 0) << r.err << r.out;
  const Json proof = Json::parse(r.out);
  EXPECT_TRUE(proof["holds"].get<bool>());
  EXPECT_EQ(proof["bits_differ"], 0);
  EXPECT_GT(proof["skipped"].get<int>(), 4);
  EXPECT_EQ(proof["runs"][0]["forced"], "");
  EXPECT_EQ(proof["runs"][1]["forced"], "all");
  EXPECT_THAT(test::frustum(small({"plan", stages, "--prove", "--repeats", "1"})).out,
              HasSubstr("0 bits differ"));
}

TEST(EffectsCli, RunForcesAndSkipsEffects) {
  const auto digest = [](std::vector<std::string> more) {
    std::vector<std::string> all = small({"run", stages, "--want", "display.image", "--json"});
    all.insert(all.end(), more.begin(), more.end());
    const auto r = test::frustum(all);
    EXPECT_EQ(r.code, 0) << r.err << r.out;
    return Json::parse(r.out)["ports"]["display.image"]["digest"].get<std::string>();
  };
  const std::string planned = digest({});
  EXPECT_EQ(digest({"--force-effects"}), planned);
  EXPECT_EQ(digest({"--force-effects=clipping,attenuation"}), planned);
  EXPECT_NE(digest({"--skip-effects", "highlights,texture_lookup"}), planned);
  const auto wrong = test::frustum(small({"run", stages, "--skip-effects", "highlight"}));
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean 'highlights'?"));
}

}  // namespace
}  // namespace frustum
