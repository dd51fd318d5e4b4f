// What the judge says of buffers whose numbers are known: every kind of check once held and once broken.
#include "tests/support/suite_runs.h"

#include <gmock/gmock.h>

namespace frustum {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class SuiteCheckTest : public testing::Test {
 protected:
  CaseResult image(const std::string& checks, const std::string& params = "{}") {
    return folder_.check(params, checks);
  }
  CaseResult of(const std::string& graph, const std::string& checks, const std::string& more = "") {
    return folder_
        .run(R"({"id": "c", "graph": ")" + graph + R"(.json", "checks": [)" + checks + "]" + more + "}")
        .at(0);
  }
  test::SuiteFolder folder_;
};

void holds(const CaseResult& r) { EXPECT_THAT(r.failures, IsEmpty()) << r.id; }
void breaks(const CaseResult& r, const std::string& sentence) {
  EXPECT_THAT(r.failures, ElementsAre(HasSubstr(sentence)));
  EXPECT_EQ(r.verdict, CaseVerdict::fail);
}

TEST_F(SuiteCheckTest, Shape) {
  holds(image(R"({"port": "out", "shape": {"width": 8, "height": 4}})"));
  breaks(image(R"({"port": "out", "shape": {"width": 9}})"), "out: width is 8, expected 9");
  breaks(image(R"({"port": "out", "shape": {"widht": 8}})"), "did you mean 'width'?");
}

TEST_F(SuiteCheckTest, ProbeOfAPixel) {
  holds(image(R"({"port": "out", "probe": {"pixel": [2, 1], "plane": "G", "equals": 0.1875}})"));
  breaks(image(R"({"port": "out", "probe": {"pixel": [2, 1], "equals": 0.1}})"),
         "0.0625 for R at 2,1, expected 0.1");
  holds(
      image(R"({"port": "out", "probe": {"pixel": [2, 1], "equals": 0.06, "abs": 0.01}, "why": "a test"})"));
  breaks(image(R"({"port": "out", "probe": {"pixel": [8, 1], "equals": 0}})"), "are not all in the window");
  breaks(image(R"({"port": "out", "probe": {"pixel": [0, 0], "plane": "X", "equals": 0}})"),
         "no plane or column 'X'");
  breaks(image(R"({"port": "out", "probe": {"pixel": [0, 0], "sample": 1, "equals": 0}})"), "no sample 1");
}

TEST_F(SuiteCheckTest, ProbeOfARegion) {
  holds(image(R"({"port": "out", "probe": {"region": [0, 0, 8, 4], "between": [0, 0.21]}})"));
  breaks(image(R"({"port": "out", "probe": {"region": [0, 0, 8, 4], "between": [0, 0.19]}})"),
         "0.203125 for R at 7,3");
  holds(image(R"({"port": "out", "probe": {"region": [1, 0, 2, 1], "equals": [0.015625, 0.03125]}})"));
  breaks(image(R"({"port": "out", "probe": {"region": [1, 0, 2, 1], "equals": [0, 0, 0]}})"),
         "3 numbers are expected where there are 2");
}

TEST_F(SuiteCheckTest, ProbeOfAVertex) {
  holds(of("mesh", R"({"port": "out", "probe": {"row": 2, "column": "position", "equals": [0, 1, 0]}})"));
  breaks(of("mesh", R"({"port": "out", "probe": {"row": 2, "column": "position", "equals": [0, 2, 0]}})"),
         "position, row 2");
  breaks(of("mesh", R"({"port": "out", "probe": {"row": 4, "column": "position", "equals": 0}})"),
         "no row 4");
  breaks(of("mesh", R"({"port": "out", "probe": {"pixel": [0, 0], "equals": 0}})"), "needs pixels");
  holds(of("table", R"({"port": "out", "probe": {"row": 3, "column": "square", "equals": 9}})"));
}

TEST_F(SuiteCheckTest, Statistics) {
  holds(image(
      R"({"port": "out", "statistics": {"plane": "R", "min": 0, "max": 0.203125, "mean": [0.1015, 0.1016],
      "count": 32, "p50": [0.09, 0.11]}})"));
  breaks(image(R"({"port": "out", "statistics": {"plane": "R", "mean": [0, 0.1]}})"),
         "R mean is 0.1015625, expected 0 to 0.1");
  breaks(image(R"({"port": "out", "statistics": {"deviation": 0}})"), "deviation is");
  holds(of("table", R"({"port": "out", "statistics": {"column": "square", "sum": 14, "p100": 9, "p0": 0}})"));
}

TEST_F(SuiteCheckTest, Analytic) {
  holds(image(R"({"port": "out", "analytic": {"value": "R", "equals": "(x - 0.5 + 2 * (y - 0.5)) / 64"}})"));
  breaks(image(R"({"port": "out", "analytic": {"value": "R", "equals": "x / 64"}})"),
         "R is not x / 64 in 32 of 32 rows");
  holds(image(R"({"port": "out", "analytic": {"value": "B - R", "equals": "0.25", "where": "x < 4"}})"));
  breaks(image(R"({"port": "out", "analytic": {"value": "R", "equals": "0", "where": "x < 0"}})"),
         "holds nowhere");
  breaks(image(R"({"port": "out", "analytic": {"value": "Q", "equals": "0"}})"), "'Q' is neither a plane");
  holds(of("table", R"({"port": "out", "analytic": {"value": "square", "equals": "n^2"}})"));
  holds(of("mesh", R"json({"port": "out", "analytic": {"value": "position.x + position.y + position.z",
                                                       "equals": "min(row, 1)"}})json"));
}

TEST_F(SuiteCheckTest, InvariantsOfMeshes) {
  for (const char* law : {"watertight", "manifold", "winding", "outward"}) {
    SCOPED_TRACE(law);
    holds(of("mesh", R"({"port": "out", "invariant": ")" + std::string(law) + R"("})"));
  }
  folder_.graph("open.json", "test.mesh", R"({"open": true})");
  folder_.graph("inside_out.json", "test.mesh", R"({"inside_out": true})");
  breaks(of("open", R"({"port": "out", "invariant": "watertight"})"), "3 of 6 edges do not have two faces");
  holds(of("open", R"({"port": "out", "invariant": "winding"})"));
  breaks(of("inside_out", R"({"port": "out", "invariant": "outward"})"), "they look inward");
  breaks(of("image", R"({"port": "out", "invariant": "watertight"})"),
         "is about meshes; this buffer is of kind image");
  holds(of("mesh", R"({"port": "out", "invariant": {"name": "within_bounds", "of": "made.mesh"}})"));
}

TEST_F(SuiteCheckTest, InvariantsOfNumbers) {
  holds(image(R"({"port": "out", "invariant": "unit_range"})"));
  breaks(image(R"({"port": "out", "invariant": "unit_range"})", R"({"add": -0.1})"), "are not in [0, 1]");
  breaks(image(R"({"port": "out", "invariant": "non_negative"})", R"({"add": -0.1})"), "are below 0");
  breaks(image(R"({"port": "out", "invariant": "opaque"})"), "no plane A");
  holds(image(R"({"port": "out", "invariant": "opaque"})", R"({"planes": "A", "times": 0, "add": 1})"));
  holds(image(R"({"port": "out", "invariant": "partition_of_unity"})",
              R"({"planes": "RG", "times": 0, "add": 0.5})"));
  breaks(image(R"({"port": "out", "invariant": "partition_of_unity"})",
               R"({"planes": "RG", "times": 0, "add": 0.25})"),
         "add to 0.5");
  holds(image(R"({"port": "out", "invariant": {"name": "energy", "of": "made"}})"));
}

// Every law about meshes and matrices with a buffer that breaks it; those above have theirs beside them.
TEST_F(SuiteCheckTest, InvariantsThatAreBroken) {
  const auto law = [](const std::string& name) {
    return R"({"port": "out", "invariant": ")" + name + R"("})";
  };
  folder_.graph("flipped.json", "test.mesh", R"({"flipped": true})");
  folder_.graph("doubled.json", "test.mesh", R"({"doubled": true})");
  folder_.graph("unit.json", "test.mesh", R"({"normal": 1})");
  folder_.graph("long.json", "test.mesh", R"({"normal": 1.5})");
  folder_.graph("rigid.json", "test.matrix");
  folder_.graph("scaled.json", "test.matrix", R"({"scale": 2})");
  breaks(of("flipped", law("winding")), "are run in the same direction by two faces");
  breaks(of("doubled", law("manifold")), "more than two faces");
  holds(of("unit", law("unit_normals")));
  breaks(of("long", law("unit_normals")), "normal 0 has length 1.5");
  holds(of("rigid", law("orthonormal")));
  EXPECT_EQ(of("scaled", law("orthonormal")).verdict, CaseVerdict::fail);
  folder_.files().write("suites/two.json", R"({"format": "frustum.graph/1", "nodes": {
      "small": {"type": "test.mesh"}, "large": {"type": "test.mesh", "params": {"scale": 2}},
      "dark": {"type": "test.image"}, "bright": {"type": "test.image", "params": {"add": 1}}}})");
  const auto two = [&](const std::string& port, const std::string& name, const std::string& other) {
    return of("two", R"({"port": ")" + port + R"(", "invariant": {"name": ")" + name + R"(", "of": ")" +
                         other + R"("}})");
  };
  holds(two("small.mesh", "within_bounds", "large.mesh"));
  breaks(two("large.mesh", "within_bounds", "small.mesh"), "along x it reaches from 0 to 2, beyond 0 to 1");
  holds(two("dark.image", "energy", "dark.image"));
  breaks(two("bright.image", "energy", "dark.image"), "of the other");
}

TEST_F(SuiteCheckTest, SameAsAnotherPortOrRun) {
  holds(image(R"({"port": "out", "same_as": "made.image"})"));
  holds(image(R"({"port": "out", "same_as": {"graph": "image.json"}})"));
  breaks(image(R"({"port": "out", "same_as": {"set": {"made:add": 0.25}}})"),
         "it is not the same as the other run");
  holds(image(R"({"port": "out", "same_as": {"set": {"made:add": 0.25}}, "max": 0.25, "why": "a test"})"));
  breaks(image(R"({"port": "out", "same_as": {"set": {"made:add": 0.25}}, "max": 0.2, "why": "a test"})"),
         "max 0.25, expected at most 0.2");
  breaks(image(R"({"port": "out", "same_as": {"graph": "none.json"}})"), "/same_as: there is no file ");
  breaks(image(R"({"port": "out", "same_as": {"graph": "mesh.json"}, "abs": 1, "why": "a test"})"),
         "it is of kind image, and the other run of kind mesh");
}

TEST_F(SuiteCheckTest, ValuesWithinAFraction) {
  const auto check = [](const std::string& bounds) {
    return R"({"port": "out", "same_as": {"set": {"made:times": 1.001}}, "why": "a test", )" + bounds + "}";
  };
  holds(image(check(R"("rel": 0.0011)")));
  breaks(image(check(R"("rel": 0.0001)")), "values ");
  holds(image(check(R"("abs": 0.0001, "fraction": 0.1)")));
  breaks(image(check(R"("abs": 0.0001, "fraction": 0.9)")),
         "of 96 within, expected 0.9 of them within abs 0.0001");
  holds(image(check(R"("abs": 0.0001, "rel": 0.0011)")));
  breaks(image(check(R"("ulp": 2)")), "within ulp 2");
  holds(image(check(R"("percentile": {"p": 50, "at_most": 0.0003})")));
  breaks(image(check(R"("percentile": {"p": 100, "at_most": 0.0003})")), "percentile 100");
}

TEST_F(SuiteCheckTest, MeshesAndTablesHaveTolerancesToo) {
  const auto other = [](const std::string& set, const std::string& bounds) {
    return R"({"port": "out", "same_as": {"set": {)" + set + R"(}}, "why": "a test", )" + bounds + "}";
  };
  holds(of("mesh", other(R"("made:scale": 1.25)", R"("max": 0.25)")));
  breaks(of("mesh", other(R"("made:scale": 1.25)", R"("max": 0.1)")), "max 0.25");
  breaks(of("table", other(R"("made:rows": 5)", R"("max": 1)")), "their lengths differ");
}

TEST_F(SuiteCheckTest, Metamorphic) {
  const auto check = [](const std::string& set, const std::string& expect) {
    return R"({"port": "out", "metamorphic": {"set": {)" + set + R"(}, "expect": )" + expect + "}}";
  };
  holds(image(check(R"("made:shift": [1, 2])", R"({"shift": [1, 2]})")));
  breaks(image(check(R"("made:shift": [1, 2])", R"({"shift": [1, 1]})")),
         "it is not the same as what the changed run should give");
  breaks(image(check(R"("made:shift": [1, 2])", R"("same")")), "not the same");
  holds(image(check(R"("made:times": 2)", R"({"times": 2})")));
  breaks(image(check(R"("made:add": 1)", R"("mirror_x")")), "not the same");
  breaks(image(check(R"("made:shift": [9, 0])", R"({"shift": [9, 0]})")), "leaves no pixel");
  holds(of("mesh", check(R"("made:scale": 2)",
                         R"({"matrix": [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]})")));
  breaks(of("mesh", check(R"("made:scale": 2)",
                          R"({"matrix": [[1, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]})")),
         "not the same");
  holds(image(check(R"("made:times": 0, "made:add": 0.5)", R"("same")"), R"({"times": 0, "add": 0.5})"));
}

TEST_F(SuiteCheckTest, MirrorsAreTheirOwnInverse) {
  // A ramp mirrored is the ramp of the other direction: x -> 7 - x, so 7 - ramp.
  for (const char* m : {"mirror_x", "mirror_y", "rotate_180"})
    breaks(image(R"({"port": "out", "metamorphic": {"precision": "double", "expect": ")" + std::string(m) +
                 R"("}})"),
           "not the same");
  holds(image(R"({"port": "out", "metamorphic": {"precision": "double", "expect": "rotate_180"}})",
              R"({"times": 0, "add": 0.5})"));
}

TEST_F(SuiteCheckTest, BudgetsOfBytesAndCounters) {
  const std::string none = R"({"port": "out"})";
  holds(of("image", none,
           R"(, "budget": {"bytes": "1M", "counters": {"pixels_made": 32, "made:pixels_made": 32}})"));
  breaks(of("image", none, R"(, "budget": {"bytes": 100})"), "above the budget of 100");
  breaks(of("image", none, R"(, "budget": {"counters": {"pixels_made": 31}})"),
         "pixels_made: 32 is above the budget of 31");
  breaks(of("image", none, R"(, "budget": {"counters": {"pixels_maed": 31}})"),
         "did you mean 'pixels_made'?");
  const CaseResult slow = of("image", none, R"(, "budget": {"time": 1e-9})");
  holds(slow);
  EXPECT_THAT(slow.notes, ElementsAre(HasSubstr("above the 1e-09 s")));
}

// ----- every bound holds and breaks

struct Bound {
  const char *holds, *breaks;
};
class EveryMetric : public testing::TestWithParam<Bound> {};

// Against a picture that is brighter by a twentieth.
TEST_P(EveryMetric, HoldsAboveTheDifferenceAndBreaksBelowIt) {
  test::SuiteFolder folder;
  const auto with = [&](const std::string& bound) {
    return folder.check(
        "{}", R"({"port": "out", "same_as": {"set": {"made:add": 0.05}}, "why": "a test", )" + bound + "}");
  };
  holds(with(GetParam().holds));
  const CaseResult broken = with(GetParam().breaks);
  EXPECT_EQ(broken.verdict, CaseVerdict::fail);
  EXPECT_EQ(broken.failures.size(), 1u)
      << "the bound and nothing else: " << testing::PrintToString(broken.failures);
}

INSTANTIATE_TEST_SUITE_P(
    SuiteCheck, EveryMetric,
    testing::Values(Bound{R"("abs": 0.051)", R"("abs": 0.049)"}, Bound{R"("rel": 1)", R"("rel": 0.1)"},
                    Bound{R"("ulp": 2e9)", R"("ulp": 100)"}, Bound{R"("max": 0.051)", R"("max": 0.049)"},
                    Bound{R"("percentile": {"p": 50, "at_most": 0.051})",
                          R"("percentile": {"p": 50, "at_most": 0.049})"},
                    Bound{R"("rmse": 0.051)", R"("rmse": 0.049)"}, Bound{R"("mrse": 100)", R"("mrse": 1e-4)"},
                    Bound{R"("psnr": 25.9)", R"("psnr": 26.1)"}, Bound{R"("ssim": 0.1)", R"("ssim": 0.9999)"},
                    Bound{R"("flip": 0.9)", R"("flip": 1e-3)"},
                    Bound{R"("delta_e_2000": 50)", R"("delta_e_2000": 0.1)"},
                    Bound{R"("delta_e_2000_max": 90)", R"("delta_e_2000_max": 0.1)"}));

TEST_F(SuiteCheckTest, WrongIdsAreCounted) {
  const auto ids = [&](const char* bound) {
    return folder_.check(R"({"planes": "RI"})", R"({"port": "out", "same_as": {"set": {"made:shift": [1, 0]}},
        "max": 1, "why": "a test", "wrong_ids": )" + std::string(bound) +
                                                    "}");
  };
  EXPECT_EQ(ids("32").verdict,
            ids("0").verdict == CaseVerdict::fail ? CaseVerdict::pass : CaseVerdict::crash);
  EXPECT_EQ(ids("0").verdict, CaseVerdict::fail);
}

// ----- NaN passes nothing

class EveryBound : public testing::TestWithParam<const char*> {};

TEST_P(EveryBound, FailsForNaN) {
  test::SuiteFolder folder;
  const std::string bound = GetParam();
  const std::string comparing =
      R"({"port": "out", "same_as": {"set": {"made:nan": false}}, "why": "a test", )" + bound + "}";
  const CaseResult mine = folder.check(R"({"nan": true})", comparing);
  EXPECT_EQ(mine.verdict, CaseVerdict::fail) << "NaN on this side";
  EXPECT_GE(mine.failures.size(), 2u) << "the bound fails of itself, beside what is always on";
  const CaseResult other = folder.check(
      "{}", R"({"port": "out", "same_as": {"set": {"made:nan": true}}, "why": "a test", )" + bound + "}");
  EXPECT_EQ(other.verdict, CaseVerdict::fail) << "NaN on the other side";
  EXPECT_GE(other.failures.size(), 2u);
  const CaseResult both = folder.check(
      R"({"nan": true})", R"({"port": "out", "same_as": "made.image", "why": "a test", )" + bound + "}");
  EXPECT_EQ(both.verdict, CaseVerdict::fail) << "NaN on both sides is not the same either";
  const CaseResult none =
      folder.check("{}", R"({"port": "out", "same_as": "made.image", "why": "a test", )" + bound + "}");
  EXPECT_EQ(none.verdict, CaseVerdict::pass) << testing::PrintToString(none.failures);
}

INSTANTIATE_TEST_SUITE_P(SuiteCheck, EveryBound,
                         testing::Values(R"("abs": 1e30)", R"("rel": 1e30)", R"("ulp": 1e30)",
                                         R"("abs": 1e30, "fraction": 0)", R"("max": 1e30)",
                                         R"("percentile": {"p": 0, "at_most": 1e30})", R"("rmse": 1e30)",
                                         R"("mrse": 1e30)", R"("psnr": -1000)", R"("ssim": -1)",
                                         R"("flip": 1)", R"("delta_e_2000": 1e30)",
                                         R"("delta_e_2000_max": 1e30)", R"("wrong_ids": 1000)"));

TEST_F(SuiteCheckTest, StatementsFailForNaN) {
  for (const char* check : {R"("probe": {"region": [0, 0, 8, 4], "between": [-1e30, 1e30]})",
                            R"("statistics": {"plane": "R", "mean": [-1e30, 1e30]})",
                            R"("statistics": {"sum": [-1e30, 1e30]})", R"("invariant": "unit_range")",
                            R"("invariant": {"name": "non_negative", "tolerance": 1e30}, "why": "a test")",
                            R"("analytic": {"value": "R", "equals": "R"})",
                            R"("analytic": {"value": "1", "equals": "1", "where": "R > 100"})"}) {
    const CaseResult r = image(R"({"port": "out", )" + std::string(check) + "}", R"({"nan": true})");
    EXPECT_GE(r.failures.size(), 2u) << check;
  }
}

TEST_F(SuiteCheckTest, WhatIsNotFiniteFailsWithoutAnyCheck) {
  breaks(image("", R"({"nan": true})"), "1 NaN, 0 infinite of 96 values");
}

}  // namespace
}  // namespace frustum
