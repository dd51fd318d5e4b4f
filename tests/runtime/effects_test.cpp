// The law of effects, node by node: what is left out by a certificate changes no bit when it is forced, and
// what is on changes bits when it is skipped, so that the comparison could have failed.
#include "nodes/clip.h"
#include "nodes/color.h"
#include "nodes/cull.h"
#include "nodes/project.h"
#include "nodes/supersample.h"
#include "runtime/buffers/image.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

struct Result {
  Digest digest;
  Verdict verdict;
};

Result result_of(const NodeType& type, const Json& params, const test::NodeInputs& inputs,
                 const EffectPolicy& policy = {}) {
  Context ctx;
  ctx.effects = &policy;
  const Digest digest = test::run_node(type, params, inputs, &ctx).at(0).digest();
  return {digest, ctx.verdicts().at(0).second};
}

void expect_left_out(const NodeType& type, const test::NodeInputs& inputs,
                     const Json& params = Json::object()) {
  const Result planned = result_of(type, params, inputs);
  EXPECT_EQ(planned.verdict.kind, Verdict::Kind::off_exact) << planned.verdict.why;
  EXPECT_FALSE(planned.verdict.why.empty());
  EXPECT_EQ(result_of(type, params, inputs, {.force_all = true}).digest, planned.digest) << type.name;
}

void expect_needed(const NodeType& type, const test::NodeInputs& inputs,
                   const Json& params = Json::object()) {
  const Result planned = result_of(type, params, inputs);
  EXPECT_EQ(planned.verdict.kind, Verdict::Kind::on) << planned.verdict.why;
  EXPECT_EQ(result_of(type, params, inputs, {.force_all = true}).digest, planned.digest) << type.name;
  const Result skipped = result_of(type, params, inputs, {.skipped = {type.effects.at(0).name}});
  EXPECT_EQ(skipped.verdict.kind, Verdict::Kind::off_user);
  EXPECT_NE(skipped.digest, planned.digest) << type.name << ": the trap does not catch";
}

Ref<Mesh> triangle(float reach, float w) {
  return test::shared(test::mesh_of<glm::vec4>(
      {{-reach, -reach, 0, w}, {reach, -reach, 0.25f, w}, {0, reach, 0.5f, w}}, {{0, 1, 2}}, Space::clip));
}

TEST(Effects, ClippingIsForWhatLeavesTheView) {
  expect_left_out(nodes::clip_homogeneous(), {{triangle(0.5f, 1)}});
  expect_needed(nodes::clip_homogeneous(), {{triangle(1.5f, 1)}});
}

TEST(Effects, TheDivideIsForPerspective) {
  const auto camera = std::make_shared<const Camera>();
  expect_left_out(nodes::project_divide(), {{triangle(0.5f, 1)}});
  expect_needed(nodes::project_divide(), {{triangle(0.5f, 3)}});
  expect_left_out(nodes::project_viewport(), {{triangle(0.5f, 1)}, {camera}});
  expect_needed(nodes::project_viewport(), {{triangle(0.5f, 3)}, {camera}});
}

TEST(Effects, FacesOutsideTheViewAreWhatClippingDrops) {
  const auto faces = test::shared(test::mesh_of<glm::vec4>(
      {{0, 0, 0, 1}, {0.5f, 0, 0, 1}, {0, 0.5f, 0, 1}, {2, 0, 0, 1}, {3, 0, 0, 1}, {2, 1, 0, 1}},
      {{0, 1, 2}, {3, 4, 5}}, Space::clip));
  const auto culled = [&](const EffectPolicy& policy) {
    Context ctx;
    ctx.effects = &policy;
    return test::run_node(nodes::cull_frustum(), Json::object(), {{faces}}, &ctx).at(0).as<Mesh>();
  };
  const Ref<Mesh> planned = culled({}), forced = culled({.force_all = true});
  EXPECT_EQ(planned->faces(), 1u);
  EXPECT_EQ(forced->faces(), 2u);
  const auto clipped = [](const Ref<Mesh>& m) {
    return test::run_node(nodes::clip_homogeneous(), Json::object(), {{m}}).at(0).as<Mesh>();
  };
  EXPECT_EQ(test::column<glm::uvec3>(*clipped(planned), "triangle"),
            test::column<glm::uvec3>(*clipped(forced), "triangle"));
}

// Samples that differ, but for a block of equal ones.
Ref<Image> picture(int samples) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = samples;
  pattern->x.assign(static_cast<std::size_t>(samples), 1000), pattern->y = pattern->x;
  for (int s = 1; s < samples; ++s)
    pattern->x[static_cast<std::size_t>(s)] = static_cast<std::uint16_t>(3000 - s);
  Frame f;
  f.window = {0, 0, 12, 9};
  if (samples > 1) f.pattern = pattern;
  for (const char* name : {"R", "G", "B"}) f.planes.push_back({name, PlaneKind::f32});
  f.color_space = std::string(linear_rec709);
  Raster r(f);
  for (int p = 0; p < 3; ++p)
    for (int s = 0; s < samples; ++s)
      for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 12; ++x)
          r.view().row<float>(p, s, y)[x] =
              x < 6 ? 0.3f : static_cast<float>((7 * x + 5 * y + 3 * s + p) % 11) / 10;
  return std::make_shared<const Image>(Image{std::move(r)});
}

TEST(Effects, ReconstructionIsForMoreThanOneSample) {
  const Json box = {{"filter", "box"}}, mitchell = {{"filter", "mitchell"}};
  expect_left_out(nodes::supersample_resolve(), {{picture(1)}}, box);
  expect_needed(nodes::supersample_resolve(), {{picture(1)}}, mitchell);
  expect_needed(nodes::supersample_resolve(), {{picture(3)}}, box);
}

TEST(Effects, ColorsAreConvertedBetweenTwoSpaces) {
  expect_left_out(nodes::color_convert(), {{picture(1)}}, {{"to", "lin_rec709"}});
  expect_needed(nodes::color_convert(), {{picture(1)}}, {{"to", "srgb"}});
}

}  // namespace
}  // namespace frustum
