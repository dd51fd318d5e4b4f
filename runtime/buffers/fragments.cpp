#include "runtime/buffers/fragments.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"
#include "runtime/buffers/pattern.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace frustum {
namespace {

constexpr std::uint32_t no_face = 0xFFFFFFFFu;

// Calls body with the values of a channel as a span of what is stored.
template <class Body>
decltype(auto) with_values(const Column& c, Body&& body) {
  switch (c.kind()) {
    case NumberKind::f64: return body(c.values<double>());
    case NumberKind::u32: return body(c.values<std::uint32_t>());
    default: return body(c.values<float>());
  }
}

Json channel_summary(const Column& c) {
  Json out = {{"name", c.name()}, {"kind", name_of(c.kind())}};
  with_values(c, [&]<class T>(std::span<const T> values) {
    out.update(to_json(measure(std::vector<T>(values.begin(), values.end()))));
  });
  return out;
}

Json json_value(const Column& c, std::size_t row) {
  return with_values(c, [&]<class T>(std::span<const T> values) {
    if constexpr (std::is_same_v<T, std::uint32_t>)
      return c.name() == "id" && values[row] == no_face ? Json(nullptr) : Json(values[row]);
    else
      return json_number(values[row]);
  });
}

struct Ops {
  static std::size_t bytes(const Fragments& f) {
    std::size_t sum = sizeof f + f.first.size() * sizeof f.first[0];
    for (const Ref<Column>& c : f.channels) sum += c->bytes();
    return sum;
  }
  static void parts(const Fragments& f, const std::function<void(const void*, std::size_t)>& visit) {
    visit(&f, sizeof f + f.first.size() * sizeof f.first[0]);
    for (const Ref<Column>& c : f.channels) visit(c->data(), c->bytes());
  }
  static void hash(const Fragments& f, Hasher& h) {
    h.value(f.window.x0).value(f.window.y0).value(f.window.x1).value(f.window.y1);
    h.value(f.pattern != nullptr);
    if (f.pattern) h.value(Buffer(f.pattern).digest());
    h.text(f.color_space).span<std::uint64_t>(f.first).value(f.channels.size());
    for (const Ref<Column>& c : f.channels) c->hash(h);
  }
  static Health health(const Fragments& f) {
    Health sum;
    for (const Ref<Column>& c : f.channels) sum.add(c->health());
    return sum;
  }
  static Json summary(const Fragments& f) {
    std::uint64_t deepest = 0, empty = 0;
    for (std::size_t i = 0; i < f.lists(); ++i) {
      const std::uint64_t n = f.first[i + 1] - f.first[i];
      deepest = std::max(deepest, n), empty += n == 0 ? 1 : 0;
    }
    Json channels = Json::array();
    for (const Ref<Column>& c : f.channels) channels.push_back(channel_summary(*c));
    return {{"window", {f.window.x0, f.window.y0, f.window.x1, f.window.y1}},
            {"width", f.window.width()},
            {"height", f.window.height()},
            {"samples", f.samples()},
            {"fragments", f.count()},
            {"lists", f.lists()},
            {"empty_lists", empty},
            {"longest_list", deepest},
            {"color_space", f.color_space},
            {"channels", std::move(channels)}};
  }
  // One row a fragment, pixels from the top left, each list from the front to the back.
  static Json table(const Fragments& f, std::size_t first, std::size_t count) {
    Json names = {"x", "y"};
    if (f.pattern) names.push_back("sample");
    names.push_back("layer");
    for (const Ref<Column>& c : f.channels) names.push_back(c->name());
    const auto samples = static_cast<std::size_t>(f.samples()),
               width = static_cast<std::size_t>(f.window.width());
    return json_table(std::move(names), f.count(), first, count, [&](std::size_t i) {
      const auto after = std::upper_bound(f.first.begin(), f.first.end(), i);
      const auto list = static_cast<std::size_t>(after - f.first.begin()) - 1;
      const std::size_t pixel = list / samples;
      Json row = {f.window.x0 + static_cast<int>(pixel % width),
                  f.window.y0 + static_cast<int>(pixel / width)};
      if (f.pattern) row.push_back(list % samples);
      row.push_back(i - f.of_list(list).begin);
      for (const Ref<Column>& c : f.channels) row.push_back(json_value(*c, i));
      return row;
    });
  }
  static void save(const Fragments& f, ArchiveWriter& w) {
    w.value(f.window.x0).value(f.window.y0).value(f.window.x1).value(f.window.y1);
    save_part(f.pattern, w);
    w.text(f.color_space).span<std::uint64_t>(f.first).value(std::uint64_t{f.channels.size()});
    for (const Ref<Column>& c : f.channels) c->save(w);
  }
  static Fragments load(ArchiveReader& r) {
    Fragments f;
    for (int* side : {&f.window.x0, &f.window.y0, &f.window.x1, &f.window.y1}) *side = r.value<int>();
    f.pattern = load_part<SamplePattern>(r);
    f.color_space = r.text();
    f.first = r.vector<std::uint64_t>();
    for (std::size_t n = r.count(1); n > 0; --n) f.channels.push_back(Column::load(r));
    if (const std::string fault = fault_of(f); !fault.empty()) throw ArchiveError(fault);
    return f;
  }
};

}  // namespace

std::string fault_of(const Fragments& f) {
  const auto lists = static_cast<std::uint64_t>(f.window.area()) * static_cast<std::uint64_t>(f.samples());
  if (f.first.size() != lists + 1)
    return fmt::format("{} lists need {} places, not {}", lists, lists + 1, f.first.size());
  if (f.first.front() != 0) return "the first list does not begin at the first fragment";
  if (!std::is_sorted(f.first.begin(), f.first.end())) return "a list ends before it begins";
  for (const Ref<Column>& c : f.channels)
    if (c->rows() != f.count() || c->width() != 1 || c->kind() == NumberKind::i32)
      return fmt::format("channel {} has {} rows of {} numbers for {} fragments", c->name(), c->rows(),
                         c->width(), f.count());
  return "";
}

template <>
const BufferType& buffer_type<Fragments>() {
  static const BufferType type = make_buffer_type<Fragments, Ops>(
      "fragments", "At every sample the list of all that was found there, from the front to the back.",
      "#5fb3a1");
  return type;
}

}  // namespace frustum
