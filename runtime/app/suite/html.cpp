#include "runtime/app/suite/html.h"

#include "runtime/app/export.h"
#include "runtime/app/report/buffers.h"
#include "runtime/app/report/page.h"
#include "runtime/buffers/image.h"
#include "runtime/core/version.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace frustum {
namespace {

Json view_of(const std::string& file, const PictureEvidence& p, const PageOptions& options,
             report::Blobs& blobs) {
  if (file.empty()) return nullptr;
  const Raster stored = load_raster((std::filesystem::path(options.evidence) / file).string());
  Frame frame = stored.frame();
  frame.color_space = p.color_space;
  Raster raster(frame);
  copy(stored.view(), raster.view());
  const Buffer buffer = std::make_shared<const Image>(Image{std::move(raster)});
  Json described = report::describe_buffer(buffer, blobs, options.most_values);
  return described.contains("view") ? described["view"] : Json(nullptr);
}

Json case_of(const CaseResult& r, const PageOptions& options, report::Blobs& blobs) {
  Json out = case_to_json(r);
  out["pictures"] = Json::array();
  for (const PictureEvidence& p : r.pictures) {
    Json output = view_of(p.output, p, options, blobs);
    if (output.is_null()) continue;
    Json reference = view_of(p.reference, p, options, blobs);
    // Pictures of different sizes are not laid over each other: a sentence says how the sizes differ.
    if (!reference.is_null() &&
        (reference["width"] != output["width"] || reference["height"] != output["height"]))
      reference = nullptr;
    out["pictures"].push_back({{"port", p.port},
                               {"against", p.against},
                               {"output", std::move(output)},
                               {"reference", std::move(reference)}});
  }
  return out;
}

}  // namespace

std::string suite_page(const std::vector<CaseResult>& results, const PageOptions& options) {
  report::Blobs blobs;
  Json counts = to_json(results);
  counts.erase("cases");
  std::vector<std::string> suites;
  double ms = 0;
  Json data = {{"title", "frustum test"},
               {"version", version},
               {"date", options.date},
               {"counts", std::move(counts)},
               {"cases", Json::array()}};
  for (const CaseResult& r : results) {
    if (std::find(suites.begin(), suites.end(), r.suite_file) == suites.end()) suites.push_back(r.suite_file);
    ms += std::chrono::duration<double, std::milli>(r.time).count();
    data["cases"].push_back(case_of(r, options, blobs));
  }
  data["suites"] = suites, data["ms"] = ms;
  return report::page_text(report::Page::suite, data, blobs);
}

}  // namespace frustum
