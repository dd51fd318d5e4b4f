#include "runtime/app/suite/result.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>

namespace frustum {
namespace {

constexpr std::array<std::string_view, verdicts> names{"pass",  "fail",   "skip", "timeout",
                                                       "crash", "waived", "flaky"};

Json to_json(const CheckOutcome& o) {
  return {
      {"port", o.port}, {"check", o.check}, {"measured", o.measured}, {"bound", o.bound}, {"held", o.held}};
}
Json to_json(const Candidate& c) {
  return {
      {"key", c.key}, {"digest", c.digest}, {"change", c.change}, {"staged", c.staged}, {"trace", c.trace}};
}
Json to_json(const PictureEvidence& p) {
  return {{"port", p.port},
          {"against", p.against},
          {"output", p.output},
          {"reference", p.reference},
          {"color_space", p.color_space}};
}
template <class T>
Json list(const std::vector<T>& items) {
  Json out = Json::array();
  for (const T& item : items) out.push_back(to_json(item));
  return out;
}

}  // namespace

std::string_view name_of(CaseVerdict v) { return names[static_cast<std::size_t>(v)]; }

bool counts_against(CaseVerdict v) {
  return v == CaseVerdict::fail || v == CaseVerdict::timeout || v == CaseVerdict::crash;
}

Json case_to_json(const CaseResult& r) {
  return {{"suite", r.suite},
          {"file", r.suite_file},
          {"id", r.id},
          {"tags", r.tags},
          {"result", name_of(r.verdict)},
          {"checks", r.checks},
          {"ms", std::chrono::duration<double, std::milli>(r.time).count()},
          {"peak_bytes", r.peak_bytes},
          {"counters", r.counters},
          {"attempts", r.attempts},
          {"failures", r.failures},
          {"notes", r.notes},
          {"outcomes", list(r.outcomes)},
          {"accepted", list(r.accepted)},
          {"pictures", list(r.pictures)},
          {"said", r.said},
          {"images_read", r.images_read},
          {"rerun", r.rerun},
          {"accept", r.accept}};
}

CaseResult case_from_json(const Json& j) {
  CaseResult r;
  const auto get = [&](const char* key, auto& to) { j.at(key).get_to(to); };
  get("suite", r.suite), get("file", r.suite_file), get("id", r.id), get("tags", r.tags),
      get("checks", r.checks);
  get("peak_bytes", r.peak_bytes), get("counters", r.counters), get("attempts", r.attempts);
  get("failures", r.failures), get("notes", r.notes), get("said", r.said), get("images_read", r.images_read);
  get("rerun", r.rerun), get("accept", r.accept);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (j.at("result") == names[i]) r.verdict = static_cast<CaseVerdict>(i);
  r.time = std::chrono::nanoseconds(std::llround(j.at("ms").get<double>() * 1e6));
  for (const Json& o : j.at("outcomes"))
    r.outcomes.push_back({o.at("port"), o.at("check"), o.at("measured"), o.at("bound"), o.at("held")});
  for (const Json& c : j.at("accepted"))
    r.accepted.push_back({c.at("key"), c.at("digest"), c.at("change"), c.at("staged"), c.at("trace")});
  for (const Json& p : j.at("pictures"))
    r.pictures.push_back(
        {p.at("port"), p.at("against"), p.at("output"), p.at("reference"), p.at("color_space")});
  return r;
}

Json to_json(const std::vector<CaseResult>& results) {
  std::array<int, verdicts> counts{};
  Json cases = Json::array();
  for (const CaseResult& r : results) {
    ++counts[static_cast<std::size_t>(r.verdict)];
    cases.push_back(case_to_json(r));
  }
  Json out = Json::object();
  for (std::size_t i = 0; i < names.size(); ++i) out[std::string(names[i])] = counts[i];
  out["cases"] = std::move(cases);
  return out;
}

}  // namespace frustum
