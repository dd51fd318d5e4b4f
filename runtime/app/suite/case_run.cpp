#include "runtime/app/suite/case_run.h"

#include "runtime/app/export.h"
#include "runtime/app/files.h"
#include "runtime/app/suite/relation.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace frustum {
namespace {

const Raster* pixels(const Buffer& b) { return b.type().is_pixels() ? &b.type().raster(b.data()) : nullptr; }

Judged one(std::string check, bool held, std::string measured, std::string bound, std::string sentence) {
  return {{"", std::move(check), std::move(measured), std::move(bound), held}, std::move(sentence)};
}

// Prefixes the sentences with what was compared with.
std::vector<Judged> against(const std::string& what, std::vector<Judged> judged) {
  for (Judged& j : judged)
    if (!j.outcome.held) j.sentence = fmt::format("against {}: {}", what, j.sentence);
  return judged;
}

}  // namespace

void CaseRun::take(const std::string& port, const std::string& what,
                   const std::function<std::vector<Judged>()>& judge) {
  ++result_.checks;
  std::vector<Judged> judged;
  try {
    judged = judge();
  } catch (const NodeError& e) {
    judged = {one(what, false, "cannot be judged", "", e.what())};
  }
  for (Judged& j : judged) {
    if (!j.outcome.held) result_.failures.push_back(fmt::format("{}: {}", port, j.sentence));
    j.outcome.port = port;
    result_.outcomes.push_back(std::move(j.outcome));
  }
}

void CaseRun::check_finite(const std::string& name, const Buffer& buffer) {
  take(name, "finite", [&]() -> std::vector<Judged> {
    const Health h = buffer.health();
    const auto infinite = h.positive_infinity + h.negative_infinity;
    return {one(
        "finite", h.finite(), fmt::format("{} NaN, {} infinite", h.nan, infinite),
        fmt::format("{} values", h.values),
        fmt::format("{} NaN, {} infinite of {} values; the first: {}", h.nan, infinite, h.values, h.first))};
  });
}

std::vector<Judged> CaseRun::judge_alike(const SuiteCheck& check, const Buffer& mine, const Buffer& other,
                                         const std::string& what) {
  const bool same = mine.digest() == other.digest();
  if (!check.likeness.bounded())
    return {one("exact", same, same ? "the same" : "differs", what,
                fmt::format("it is not the same as {}", what))};
  if (&mine.type() != &other.type())
    return {
        one("kind", false, std::string(mine.type().name), std::string(other.type().name),
            fmt::format("it is of kind {}, and {} of kind {}", mine.type().name, what, other.type().name))};
  if (const Raster* raster = pixels(mine)) {
    auto judged = against(what, judge_pixels(check.likeness, *raster, *pixels(other)));
    return judged;
  }
  return against(what, judge_values(check.likeness, values_of(mine), values_of(other)));
}

void CaseRun::check_alike(const SuiteCheck& check, const Buffer& mine, const Buffer& other,
                          const std::string& what) {
  const std::size_t before = result_.failures.size();
  take(check.port, "same as " + what, [&] { return judge_alike(check, mine, other, what); });
  if (pixels(mine) != nullptr)
    keep_pictures(check, mine, pixels(other), what, result_.failures.size() == before);
}

void CaseRun::check_related(const SuiteCheck& check, const Buffer& own, const Buffer& changed,
                            const Relation& relation, const std::string& what) {
  RelatedPair pair{changed, own};
  bool good = true;
  if (check.metamorphic)
    take(check.port, "metamorphic", [&]() -> std::vector<Judged> {
      good = false;
      pair = related(relation, own, changed);
      good = true;
      return {};
    });
  if (!good) return;
  if (check.metamorphic)
    check_alike(check, pair.actual, pair.expected, "what " + what + " should give");
  else
    check_alike(check, pair.expected, pair.actual, what);
}

// ----- goldens

void CaseRun::check_golden(const SuiteCheck& check, PortRef port, const Buffer& buffer) {
  const std::string key = key_of(check);
  golden_ports_[port] = key;
  trace_ |= check.trace;
  const std::size_t before = result_.failures.size();
  take(check.port, "golden", [&] { return judge_golden(check, buffer); });
  golden_failed_ |= result_.failures.size() != before;
}

std::vector<Judged> CaseRun::judge_golden(const SuiteCheck& check, const Buffer& buffer) {
  const std::string key = key_of(check), digest = to_hex(buffer.digest());
  const Golden* golden = book_.find(key);
  const Raster* raster = pixels(buffer);
  if (golden != nullptr && golden->digest == digest) {
    if (raster != nullptr) keep_pictures(check, buffer, raster, "the accepted one", true);
    return {one("golden", true, digest, "the accepted digest", "")};
  }
  if (options_.goldens == Goldens::propose) {
    if (!buffer.health().finite())
      return {one("golden", false, "not finite", "finite numbers", "not accepted, since it is not finite")};
    propose(key, check, buffer);
    return {one("golden", true, digest, "proposed", "")};
  }
  if (golden == nullptr) {
    if (raster != nullptr) keep_pictures(check, buffer, nullptr, "nothing accepted", false);
    return {one("golden", false, digest, "nothing was accepted yet",
                fmt::format("nothing was accepted yet; {}", result_.accept))};
  }
  if (raster != nullptr && book_.has_pixels(*golden)) {
    const Raster reference = book_.pixels(*golden, raster->frame());
    if (!check.likeness.bounded()) keep_pictures(check, buffer, &reference, "the accepted one", false);
    if (check.likeness.bounded()) {
      auto judged = against("the accepted one", judge_pixels(check.likeness, *raster, reference));
      const bool held =
          std::all_of(judged.begin(), judged.end(), [](const Judged& j) { return j.outcome.held; });
      keep_pictures(check, buffer, &reference, "the accepted one", held);
      return judged;
    }
  } else if (check.likeness.bounded() && book_.has_values(*golden)) {
    return against("the accepted one",
                   judge_values(check.likeness, values_of(buffer), values_from_json(book_.values(*golden))));
  }
  return {one("golden", false, digest, golden->digest,
              fmt::format("digest {} is not the accepted {}; {}", digest, golden->digest, result_.accept))};
}

std::string CaseRun::change_of(const Golden& old, const Buffer& buffer) const {
  std::string change = "was " + old.digest;
  const Raster* raster = pixels(buffer);
  if (raster == nullptr || !book_.has_pixels(old)) return change;
  const Difference d = compare(*raster, book_.pixels(old, raster->frame()));
  return change +
         (d.mismatch.empty() ? fmt::format(", rmse {:.3g}, max {:.3g}", d.rmse, d.max) : ", " + d.mismatch);
}

void CaseRun::propose(const std::string& key, const SuiteCheck& check, const Buffer& buffer) {
  const Golden* old = book_.find(key);
  Candidate c{.key = key,
              .digest = to_hex(buffer.digest()),
              .change = old == nullptr ? "new" : change_of(*old, buffer),
              .staged = {},
              .trace = false};
  const auto stage = [&](const char* extension) {
    c.staged = (std::filesystem::path(options_.staging) / (c.digest + extension)).string();
    return c.staged;
  };
  const Raster* raster = pixels(buffer);
  if (!options_.staging.empty() && raster != nullptr)
    GoldenBook::save_pixels(*raster, stage(".exr"));
  else if (!options_.staging.empty() && check.likeness.bounded())
    write_text(stage(".values.json"), to_json(values_of(buffer)).dump() + "\n");
  result_.accepted.push_back(std::move(c));
}

void CaseRun::name_first_divergence(const Graph& graph, const std::map<PortRef, Buffer>& buffers) {
  const bool propose = options_.goldens == Goldens::propose;
  if (!golden_failed_ && !(propose && trace_)) return;
  if (golden_ports_.size() < 2 && !trace_) return;  // the one that failed is all that is known
  for (const auto& [port, buffer] : buffers) {      // in running order
    if (!buffer) continue;                          // an optional output that was not made
    const std::string name = graph.name(port);
    const auto own = golden_ports_.find(port);
    const std::string key = trace_ && own == golden_ports_.end() ? trace_key(name)
                            : own == golden_ports_.end()         ? ""
                                                                 : own->second;
    if (key.empty()) continue;
    const Golden* golden = book_.find(key);
    const std::string digest = to_hex(buffer.digest());
    if (golden != nullptr && golden->digest == digest) continue;
    if (propose) {
      if (own == golden_ports_.end())
        result_.accepted.push_back(
            {key, digest, golden == nullptr ? "new" : "was " + golden->digest, "", true});
    } else if (golden != nullptr) {
      result_.failures.push_back(fmt::format("the first port that is not what was accepted: {}", name));
      return;
    }
  }
}

// ----- pictures

void CaseRun::keep_pictures(const SuiteCheck& check, const Buffer& mine, const Raster* reference,
                            const std::string& against, bool held) {
  if (options_.evidence.empty() || (held && !options_.evidence_of_all)) return;
  const auto save = [&](const Raster& raster, const char* what) {
    const std::string name =
        fmt::format("{}_{}_{}.exr", options_.evidence_name, result_.pictures.size(), what);
    save_raster(one_sample(raster, 0), (std::filesystem::path(options_.evidence) / name).string());
    return name;
  };
  PictureEvidence p{check.port, against, save(*pixels(mine), "output"), "",
                    pixels(mine)->frame().color_space};
  if (reference != nullptr) p.reference = save(*reference, "reference");
  result_.pictures.push_back(std::move(p));
}

}  // namespace frustum
