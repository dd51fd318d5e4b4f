// What run_suite() found, as text, JSON and JUnit XML.
#include "runtime/app/suite_run.h"
#include "runtime/app/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <map>

namespace frustum {
namespace {

// Escaped for XML 1.0, which has no way to write most control characters: they become '?'.
std::string xml(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\n': out += "&#10;"; break;
      default: out += static_cast<unsigned char>(c) < 0x20 && c != '\t' ? '?' : c;
    }
  return out;
}

double seconds(std::chrono::nanoseconds t) { return std::chrono::duration<double>(t).count(); }

std::string junit_case(const CaseResult& r) {
  const std::string head = fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.6f}\"",
                                       xml(r.suite), xml(r.id), seconds(r.time));
  if (r.verdict == Verdict::pass) return head + "/>\n";
  const char* element = r.verdict == Verdict::crash ? "error" : "failure";
  return fmt::format("{}>\n      <{} message=\"{}\">{}</{}>\n    </testcase>\n", head, element,
                     xml(r.failures.empty() ? "" : r.failures.front()),
                     xml(fmt::format("{}\nrerun: {}", fmt::join(r.failures, "\n"), r.rerun)), element);
}

}  // namespace

Json to_json(const std::vector<CaseResult>& results) {
  Json cases = Json::array();
  std::map<std::string, int> counts{{"pass", 0}, {"fail", 0}, {"crash", 0}};
  for (const CaseResult& r : results) {
    ++counts[std::string(name_of(r.verdict))];
    cases.push_back({{"suite", r.suite},
                     {"id", r.id},
                     {"result", name_of(r.verdict)},
                     {"checks", r.checks},
                     {"ms", seconds(r.time) * 1e3},
                     {"failures", r.failures},
                     {"accepted", r.accepted},
                     {"rerun", r.rerun}});
  }
  Json out = Json::object();
  for (const auto& [name, n] : counts) out[name] = n;
  out["cases"] = std::move(cases);
  return out;
}

std::string to_text(const CaseResult& r, bool color) {
  const bool good = r.verdict == Verdict::pass;
  const char* const on = !color ? "" : good ? "\033[32m" : "\033[31m";
  std::string out = fmt::format("{}{}{}  {}: {}  ({} checks, {})\n", on, name_of(r.verdict),
                                color ? "\033[0m" : "", r.suite, r.id, r.checks, human_time(r.time));
  for (const std::string& s : r.accepted) out += "      accepted " + s + "\n";
  for (const std::string& s : r.failures) out += "      " + s + "\n";
  if (!good) out += "      rerun: " + r.rerun + "\n";
  return out;
}

std::string junit_text(const std::vector<CaseResult>& results) {
  std::map<std::string, std::vector<const CaseResult*>> suites;
  for (const CaseResult& r : results) suites[r.suite].push_back(&r);
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const auto& [name, cases] : suites) {
    int failures = 0, errors = 0;
    double time = 0;
    std::string body;
    for (const CaseResult* r : cases) {
      failures += r->verdict == Verdict::fail ? 1 : 0;
      errors += r->verdict == Verdict::crash ? 1 : 0;
      time += seconds(r->time);
      body += junit_case(*r);
    }
    out += fmt::format(
        "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{:.6f}\">\n{}  "
        "</testsuite>\n",
        xml(name), cases.size(), failures, errors, time, body);
  }
  return out + "</testsuites>\n";
}

}  // namespace frustum
