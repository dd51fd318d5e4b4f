// What run_suites() found, as text and as JUnit XML.
#include "runtime/app/suite/result.h"
#include "runtime/core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
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

std::string indented(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out += fmt::format("        {}\n", text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}

double seconds(std::chrono::nanoseconds t) { return std::chrono::duration<double>(t).count(); }

const char* color_of(CaseVerdict v) {
  switch (v) {
    case CaseVerdict::pass: return "\033[32m";
    case CaseVerdict::skip:
    case CaseVerdict::waived:
    case CaseVerdict::flaky: return "\033[33m";
    default: return "\033[31m";
  }
}

std::string junit_case(const CaseResult& r) {
  const std::string head = fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.6f}\"",
                                       xml(r.suite), xml(r.id), seconds(r.time));
  const std::string notes = r.notes.empty() ? ""
                                            : fmt::format("      <system-out>{}</system-out>\n",
                                                          xml(fmt::format("{}", fmt::join(r.notes, "\n"))));
  if (r.verdict == CaseVerdict::skip || r.verdict == CaseVerdict::waived)
    return fmt::format("{}>\n      <skipped message=\"{}\"/>\n    </testcase>\n", head,
                       xml(r.notes.empty() ? "" : r.notes.front()));
  if (!counts_against(r.verdict))
    return notes.empty() ? head + "/>\n" : head + ">\n" + notes + "    </testcase>\n";
  const char* element = r.verdict == CaseVerdict::fail ? "failure" : "error";
  const std::string said = r.said.empty() ? "" : "\n" + r.said;
  return fmt::format("{}>\n      <{} type=\"{}\" message=\"{}\">{}</{}>\n{}    </testcase>\n", head, element,
                     name_of(r.verdict), xml(r.failures.empty() ? "" : r.failures.front()),
                     xml(fmt::format("{}\nrerun: {}{}", fmt::join(r.failures, "\n"), r.rerun, said)), element,
                     notes);
}

}  // namespace

std::string to_text(const CaseResult& r, bool color) {
  std::string out = fmt::format("{}{}{}  {}: {}  ({} {}, {})\n", color ? color_of(r.verdict) : "",
                                name_of(r.verdict), color ? "\033[0m" : "", r.suite, r.id, r.checks,
                                r.checks == 1 ? "check" : "checks", human_time(r.time));
  std::size_t traced = 0;
  for (const Candidate& c : r.accepted) {
    if (c.trace)
      ++traced;
    else
      out += fmt::format("      golden {}: {} ({})\n", c.key, c.digest, c.change);
  }
  if (traced > 0) out += fmt::format("      and the digests of {} ports on the way\n", traced);
  for (const std::string& s : r.failures) out += "      " + s + "\n";
  for (const std::string& s : r.notes) out += "      note: " + s + "\n";
  if (!counts_against(r.verdict)) return out;
  if (!r.said.empty()) out += "      it wrote:\n" + indented(r.said);
  return out + "      rerun: " + r.rerun + "\n";
}

std::string summary_text(const std::vector<CaseResult>& results) {
  std::map<CaseVerdict, int> counts;
  for (const CaseResult& r : results) ++counts[r.verdict];
  std::string out = fmt::format("{} of {} cases pass", counts[CaseVerdict::pass], results.size());
  for (const auto& [verdict, n] : counts)
    if (verdict != CaseVerdict::pass && n > 0) out += fmt::format(", {} {}", n, name_of(verdict));
  return out + "\n";
}

std::string junit_text(const std::vector<CaseResult>& results) {
  std::map<std::string, std::vector<const CaseResult*>> suites;
  for (const CaseResult& r : results) suites[r.suite].push_back(&r);
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const auto& [name, cases] : suites) {
    int failures = 0, errors = 0, skipped = 0;
    double time = 0;
    std::string body;
    for (const CaseResult* r : cases) {
      failures += r->verdict == CaseVerdict::fail ? 1 : 0;
      errors += r->verdict == CaseVerdict::crash || r->verdict == CaseVerdict::timeout ? 1 : 0;
      skipped += r->verdict == CaseVerdict::skip || r->verdict == CaseVerdict::waived ? 1 : 0;
      time += seconds(r->time);
      body += junit_case(*r);
    }
    out += fmt::format(
        "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" "
        "time=\"{:.6f}\">\n{}  "
        "</testsuite>\n",
        xml(name), cases.size(), failures, errors, skipped, time, body);
  }
  return out + "</testsuites>\n";
}

}  // namespace frustum
