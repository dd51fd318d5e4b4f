#include "runtime/app/diverge.h"

#include "runtime/core/error.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace frustum {
namespace {

using testing::HasSubstr;
const std::string teapot = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/gallery/teapot.json";

Session& session() {
  static Session s;
  return s;
}

DivergeOptions small() {
  DivergeOptions o;
  o.graph = teapot;
  o.load.settings = {{"resolution", "[96,54]"}, {"samples", "4"}};
  return o;
}

Divergence diverged(const DivergeOptions& o) {
  Diagnostics problems;
  auto d = diverge(session(), o, problems);
  EXPECT_TRUE(d) << to_text(problems);
  return d ? std::move(*d) : Divergence();
}

const PortDivergence& port(const Divergence& d, const std::string& name) {
  for (const PortDivergence& p : d.ports)
    if (p.port == name) return p;
  throw std::runtime_error("no port " + name);
}

TEST(Diverge, SingleAgainstDoubleBeginsAtTheFirstComputedNumbers) {
  const Divergence d = diverged(small());
  ASSERT_TRUE(d.first);
  EXPECT_EQ(d.ports[*d.first].port, "mesh.mesh") << "files, cameras and lights are the same";
  const PortError& mesh = port(d, "mesh.mesh").total;
  EXPECT_GT(mesh.bits(), 20);
  EXPECT_LT(mesh.bits(), 26);
  EXPECT_TRUE(port(d, "camera.camera").total.identical);
  EXPECT_FALSE(port(d, "draw/lit.color").total.identical);
  EXPECT_THAT(diverge_text(d), HasSubstr("mesh.mesh is the first port that differs"));
}

TEST(Diverge, TotalIsLocalWhereInputsAreTheSame) {
  const PortDivergence p = port(diverged(small()), "mesh.mesh");
  EXPECT_EQ(p.total.max, p.local.max);
  EXPECT_TRUE(p.inherited.identical);
  EXPECT_EQ(p.input, 0);
}

TEST(Diverge, ANodeThatOnlyPassesOnLosesNothingItself) {
  const Divergence d = diverged(small());
  const PortDivergence& cut = port(d, "draw/cut.mesh");  // nothing of the teapot is cut
  EXPECT_FALSE(cut.total.identical);
  EXPECT_LE(cut.local.relative, std::ldexp(1.0, -23)) << "only the rounding of its inputs";
  EXPECT_GT(cut.inherited.max, 0);
}

TEST(Diverge, TheSameSettingsDoNotDiverge) {
  DivergeOptions o = small();
  o.a = {{"samples", "4"}};
  o.b = {{"draw/pattern:samples", "4"}};
  const Divergence d = diverged(o);
  EXPECT_FALSE(d.first);
  for (const PortDivergence& p : d.ports) EXPECT_TRUE(p.total.identical) << p.port;
}

TEST(Diverge, AKnobIsFoundInItsOwnNode) {
  DivergeOptions o = small();
  o.a = {{"draw/lit:interpolation", "flat"}};
  o.b = {{"draw/lit:interpolation", "phong"}};
  const Divergence d = diverged(o);
  ASSERT_TRUE(d.first);
  EXPECT_EQ(d.ports[*d.first].port, "draw/lit.color");
  EXPECT_EQ(port(d, "draw/lit.color").total.max, port(d, "draw/lit.color").local.max);
  const PortDivergence& display = port(d, "display.image");
  EXPECT_TRUE(display.local.identical) << "the next node only inherits";
  EXPECT_EQ(display.total.max, display.inherited.max);
  EXPECT_EQ(d.by_local.size(), 1u);
}

TEST(Diverge, OtherSizesAreSaidAndNotMeasured) {
  DivergeOptions o = small();
  o.a = {{"mesh:tolerance_px", "8"}};
  o.b = {{"mesh:tolerance_px", "0.5"}};
  const Divergence d = diverged(o);
  EXPECT_THAT(port(d, "mesh.mesh").total.mismatch, HasSubstr("sizes"));
  EXPECT_GT(port(d, "draw/hits.visibility").total.flips, 0u) << "samples see other faces";
  EXPECT_TRUE(to_json(d)["ports"].is_array());
}

TEST(Diverge, OnlyWhatFeedsTheWantedPortIsRun) {
  DivergeOptions o = small();
  o.wanted = {"draw/cut.mesh"};
  const Divergence d = diverged(o);
  EXPECT_EQ(d.ports.back().port, "draw/cut.mesh");
  o.wanted = {"nothing"};
  Diagnostics problems;
  EXPECT_FALSE(diverge(session(), o, problems));
  EXPECT_TRUE(problems.has_errors());
}

}  // namespace
}  // namespace frustum
