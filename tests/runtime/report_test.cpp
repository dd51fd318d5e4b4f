// The page of `frustum report`, as a person with a browser meets it.
#include "runtime/io/image_files.h"
#include "tests/support/browser.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace frustum {
namespace {

using nlohmann::json;
using test::Browser;
using test::frustum;
using test::TempFolder;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string stages = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/gallery/teapot_stages.json";

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> small(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--set", "resolution=[160, 90]", "--set", "samples=2"});
  return arguments;
}

// The page waits until what is near the window has been decoded and drawn.
void show_all(Browser& browser) {
  browser.evaluate(R"((async () => {
    for (const d of document.querySelectorAll(".buffer")) {
      d.scrollIntoView();
      const viewer = d.querySelector(".viewer");
      for (let i = 0; viewer && viewer.dataset.ready !== "true"; ++i) {
        if (i > 600) throw new Error(d.id + " was never drawn");
        await new Promise((f) => setTimeout(f, 50));
      }
    }
    scrollTo(0, 0);
  })())");
}

// Colours of the picture, as a set of 24-bit numbers: a blank one has one.
std::set<std::uint32_t> colors(const std::string& png, const TempFolder& folder) {
  const Raster r = read_image(folder.write("shot.png", png), "shot.png").raster;
  std::set<std::uint32_t> seen;
  const Rect w = r.frame().window;
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x) {
      std::uint32_t c = 0;
      for (int p = 0; p < 3; ++p) c = c << 8 | static_cast<std::uint32_t>(r.value(p, 0, x, y) * 255 + 0.5);
      seen.insert(c);
    }
  return seen;
}

// Kept where a person wants to look at them.
void keep(const std::string& name, const std::string& png) {
  if (const char* folder = std::getenv("FRUSTUM_TEST_PICTURES"))
    std::ofstream(std::filesystem::path(folder) / (name + ".png"), std::ios::binary) << png;
}

std::string card(const std::string& port) { return "document.getElementById('buffer-" + port + "')"; }

TEST(Report, ShowsTheRunInABrowserWithoutAComplaint) {
  const TempFolder folder;
  const auto made = frustum(small({"report", stages, "--all", "-o", folder.file("page.html"), "--json"}));
  ASSERT_EQ(made.code, 0) << made.err << made.out;
  const json said = json::parse(made.out);
  EXPECT_EQ(said["file"], folder.file("page.html"));
  const json plan = json::parse(frustum(small({"plan", stages, "--json"})).out);

  Browser browser;
  browser.size(1280, 900);
  browser.open("file://" + folder.file("page.html"));
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('.graph a.node').length"), plan["nodes"].size());
  EXPECT_EQ(browser.evaluate("document.querySelectorAll('.buffer').length"), said["ports"].size());
  show_all(browser);
  EXPECT_THAT(browser.complaints(), IsEmpty());
  const std::string light = browser.screenshot();
  keep("report_light", light);
  EXPECT_GT(colors(light, folder).size(), 100u);

  browser.size(1280, 900, true);
  EXPECT_NE(browser.evaluate("getComputedStyle(document.body).backgroundColor"), "rgb(247, 247, 245)");
  keep("report_dark", browser.screenshot());
  browser.size(400, 900);
  EXPECT_EQ(browser.evaluate("document.documentElement.scrollWidth"), 400)
      << "nothing sticks out of a narrow window";
  keep("report_narrow", browser.screenshot());
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

TEST(Report, TheProbeShowsTheStoredValue) {
  const TempFolder folder;
  ASSERT_EQ(frustum(small({"report", stages, "--want", "pixels", "--want", "hits.visibility", "-o",
                           folder.file("page.html")}))
                .code,
            0);
  Browser browser;
  browser.size(1280, 900);
  browser.open("file://" + folder.file("page.html"));
  show_all(browser);
  const json truth =
      json::parse(frustum(small({"inspect", stages, "pixels", "--pixel", "83,47", "--json"})).out);
  const json values = browser.evaluate("(() => { const c = " + card("pixels.image") + R"(;
    c.scrollIntoView();
    const canvas = c.querySelector("canvas"), r = canvas.getBoundingClientRect();
    canvas.dispatchEvent(new MouseEvent("mousemove", {clientX: r.left + 83.5 * r.width / 160, clientY: r.top + 47.5 * r.height / 90}));
    return Object.fromEntries([...c.querySelectorAll("tr[data-plane]")].map((t) => [t.dataset.plane, Number(t.lastChild.textContent)]));
  })())");
  const json& sample = truth["pixel"]["samples"][0];
  for (const char* plane : {"R", "G", "B", "A"}) {
    EXPECT_EQ(values[plane].get<float>(), sample[plane].get<float>()) << plane << truth["pixel"];
    EXPECT_NE(values[plane], 0) << "the teapot is there";
  }
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

TEST(Report, NoTextOfAGraphIsMarkup) {
  const TempFolder folder;
  const std::string evil =
      "</script><script>window.pwned = 1</script><img src=x onerror=window.pwned=1>{{data}}";
  const json graph = {{"format", "frustum.graph/1"},
                      {"title", evil},
                      {"params", {{"name", evil}}},
                      {"nodes", {{"clay", {{"type", "shade.material"}, {"params", {{"name", "$name"}}}}}}}};
  ASSERT_EQ(frustum({"report", folder.write("evil.json", graph.dump()), "-o", folder.file("page.html")}).code,
            0);
  Browser browser;
  browser.open("file://" + folder.file("page.html"));
  EXPECT_EQ(browser.evaluate("document.title"), evil);
  EXPECT_EQ(browser.evaluate("document.querySelector('h1').textContent"), evil);
  EXPECT_EQ(browser.evaluate("typeof window.pwned"), "undefined");
  EXPECT_EQ(browser.evaluate("document.images.length"), 0);
  EXPECT_THAT(browser.evaluate("document.body.textContent").get<std::string>(), HasSubstr("shade.material"));
  EXPECT_THAT(browser.complaints(), IsEmpty());
}

TEST(Report, LoadsNothingFromAnywhere) {
  const TempFolder folder;
  ASSERT_EQ(frustum(small({"report", stages, "-o", folder.file("page.html")})).code, 0);
  const std::string page = text_of(folder.file("page.html"));
  EXPECT_THAT(page, Not(HasSubstr("src=\"")));
  EXPECT_THAT(page, Not(HasSubstr("<link")));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_EQ(page.find("{{"), std::string::npos);
}

TEST(Report, ThinsLargePicturesToValuesThatAreThere) {
  const TempFolder folder;
  ASSERT_EQ(frustum(small({"report", stages, "--want", "pixels", "--max-values", "10000", "-o",
                           folder.file("page.html")}))
                .code,
            0);
  Browser browser;
  browser.size(1280, 900);
  browser.open("file://" + folder.file("page.html"));
  show_all(browser);
  EXPECT_EQ(browser.evaluate(card("pixels.image") + ".querySelector('canvas').width"), 53)
      << "every third of 160 pixels";
  EXPECT_THAT(browser.evaluate(card("pixels.image") + ".textContent").get<std::string>(),
              HasSubstr("every 3rd pixel"));
  const json values = browser.evaluate("(() => { const c = " + card("pixels.image") + R"(;
    const canvas = c.querySelector("canvas"), r = canvas.getBoundingClientRect();
    canvas.dispatchEvent(new MouseEvent("mousemove", {clientX: r.left + 27.5 * r.width / 53, clientY: r.top + 15.5 * r.height / 30}));
    return [c.querySelector(".probe").textContent, Number(c.querySelector("tr[data-plane=R]").lastChild.textContent)];
  })())");
  EXPECT_THAT(values[0].get<std::string>(), HasSubstr("x 82, y 46"));
  const json truth =
      json::parse(frustum(small({"inspect", stages, "pixels", "--pixel", "82,46", "--json"})).out);
  EXPECT_EQ(values[1].get<float>(), truth["pixel"]["samples"][0]["R"].get<float>());
}

TEST(Report, AMistakeIsExit2AndAFolderThatIsNoneExit3) {
  const TempFolder folder;
  EXPECT_EQ(frustum({"report", stages}).code, 2) << "no -o";
  const auto unknown = frustum({"report", stages, "--want", "dysplay", "-o", folder.file("page.html")});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("display"));
  EXPECT_EQ(frustum(small({"report", stages, "-o", folder.write("file", "") + "/page.html"})).code, 3);
  EXPECT_FALSE(std::filesystem::exists(folder.file("page.html")));
}

}  // namespace
}  // namespace frustum
