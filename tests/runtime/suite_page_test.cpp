// The page of `frustum test --html`, as a person with a browser meets it.
#include "tests/support/browser.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace frustum {
namespace {

using test::Browser;
using test::frustum;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// A case whose golden differs by the light in it, and one whose id would be markup.
std::string suite(double fill) {
  return R"({"format": "frustum.suite/1", "cases": [
      {"id": "teapot", "graph": ")" +
         std::string(FRUSTUM_SOURCE_DIR) + R"(/graphs/gallery/teapot_stages.json",
       "set": {"resolution": [64, 36], "samples": 1, "fill:color": )" +
         std::to_string(fill) + R"(},
       "checks": [{"port": "beauty", "golden": true, "max": 0.001, "why": "a test"}]},
      {"id": "<img src=x onerror=alert(1)>", "graph": "none.json"}]})";
}

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(SuiteHtml, ShowsWhatDiffersAndSwapsThePictures) {
  const test::TempFolder folder;
  std::filesystem::create_directories(folder.file("suites"));
  const std::string file = folder.write("suites/s.json", suite(0.1)), page = folder.file("page.html");
  frustum({"test", file, "--filter", "teapot", "--accept", "--reason", "a test"});
  folder.write("suites/s.json", suite(0.4));
  EXPECT_EQ(frustum({"test", file, "--html", page}).code, 1);
  const std::string text = text_of(page);
  EXPECT_THAT(text, Not(HasSubstr("<img"))) << "no text of a suite is markup";

  Browser browser;
  browser.size(1280, 900);
  browser.open("file://" + page);
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('details.case').length"), 2);
  EXPECT_THAT(browser.evaluate("document.querySelector('h1').textContent").get<std::string>(),
              HasSubstr("2 cases of 2"));
  browser.evaluate(R"((async () => {
    for (const d of document.querySelectorAll("details.case")) d.open = true;
    for (let i = 0; document.querySelector(".compare")?.dataset.ready !== "true"; ++i) {
      if (i > 600) throw new Error("it was never drawn");
      await new Promise((f) => setTimeout(f, 50));
    }
  })())");
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('.triple canvas').length"), 3);
  EXPECT_EQ(browser.evaluate("JSON.stringify([0, 2].map((x) => [...document.querySelector('.triple canvas')"
                             ".getContext('2d').getImageData(x, 0, 1, 1).data]))"),
            "[[153,153,153,255],[204,204,204,255]]")
      << "the teapot stands on a checkerboard";
  // The two pictures change places as long as the pointer is on one of them.
  const std::string pixels =
      R"(JSON.stringify([...document.querySelectorAll('.triple canvas')].slice(0, 2).map(
      (c) => [...c.getContext('2d').getImageData(32, 18, 1, 1).data])))";
  const auto point = [](const char* event) {
    return std::string("document.querySelectorAll('.triple canvas')[1].dispatchEvent(new MouseEvent('") +
           event + "'))";
  };
  const auto before = nlohmann::json::parse(browser.evaluate(pixels).get<std::string>());
  browser.evaluate(point("mouseenter"));
  const auto swapped = nlohmann::json::parse(browser.evaluate(pixels).get<std::string>());
  browser.evaluate(point("mouseleave"));
  EXPECT_NE(before[0], before[1]) << "the light differs";
  EXPECT_EQ(swapped[0], before[1]);
  EXPECT_EQ(swapped[1], before[0]);
  EXPECT_EQ(nlohmann::json::parse(browser.evaluate(pixels).get<std::string>()), before);
  EXPECT_THAT(browser.evaluate("document.querySelector('.cases').textContent"),
              HasSubstr("--filter 'teapot'"));

  browser.size(400, 900, true);
  EXPECT_EQ(browser.evaluate("document.documentElement.scrollWidth"), 400)
      << "nothing is wider than a telephone";
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

}  // namespace
}  // namespace frustum
