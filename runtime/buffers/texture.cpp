#include "runtime/buffers/texture.h"

#include "nodes/kernels/half.h"
#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <mutex>

namespace frustum {
namespace {

Json json(const glm::dvec3& v) { return {json_number(v.x), json_number(v.y), json_number(v.z)}; }

Health health_of(const Checker& c) {
  const std::pair<std::string_view, double> values[] = {
      {"scale", c.scale}, {"even", c.even.x}, {"even", c.even.y}, {"even", c.even.z},
      {"odd", c.odd.x},   {"odd", c.odd.y},   {"odd", c.odd.z}};
  return frustum::health_of("checker", values);
}

Health health_of(const MipPyramid& p) {
  Health sum;
  for (std::size_t l = 0; l < p.levels.size(); ++l) {
    const auto& level = p.levels[l];
    const std::vector<float> wide =
        level.half_rgba.empty() ? std::vector<float>() : level.numbers(0, level.size());
    const std::span<const float> numbers = level.half_rgba.empty() ? std::span(level.rgba) : std::span(wide);
    sum.add(to_health(scan(numbers), numbers.size(), [&](std::size_t i) {
      const std::size_t texel = i / 4, width = static_cast<std::size_t>(level.width);
      return fmt::format("level {}, texel {},{}", l, texel % width, texel / width);
    }));
  }
  return sum;
}

void hash_source(const Checker& c, Hasher& h) {
  h.value(c.scale);
  for (const glm::dvec3& v : {c.even, c.odd}) h.value(v.x).value(v.y).value(v.z);
}

void hash_numbers(const MipPyramid::Level& level, Hasher& h) {
  if (level.half_rgba.empty())
    h.span<float>(level.rgba);
  else
    h.span<std::uint16_t>(level.half_rgba);
}

void hash_source(const MipPyramid& p, Hasher& h) {
  h.value(p.wrap_u).value(p.wrap_v).value(p.alpha_cutoff).value(p.levels.size());
  for (const auto& level : p.levels) hash_numbers(level, h.value(level.width).value(level.height));
}

Json summary_of(const Checker& c) {
  return {
      {"source", "checker"}, {"scale", json_number(c.scale)}, {"even", json(c.even)}, {"odd", json(c.odd)}};
}

Json summary_of(const MipPyramid& p) {
  Json levels = Json::array();
  for (const auto& level : p.levels) {
    Hasher h;
    hash_numbers(level, h);
    levels.push_back({{"width", level.width}, {"height", level.height}, {"digest", to_hex(h.done())}});
  }
  Json channels = Json::array();
  for (std::size_t k = 0; k < 4 && !p.levels.empty(); ++k) {
    std::vector<float> values;
    for (std::size_t i = k; i < p.levels[0].size(); i += 4) values.push_back(p.levels[0].number(i));
    Json channel = {{"name", std::string(1, "RGBA"[k])}};
    channel.update(to_json(measure(std::move(values))));
    channels.push_back(std::move(channel));
  }
  const bool half = !p.levels.empty() && !p.levels[0].half_rgba.empty();
  Json out = {{"source", "image"},
              {"storage", half ? "half" : "single"},
              {"wrap_u", choices(p.wrap_u)[static_cast<std::size_t>(p.wrap_u)].second},
              {"wrap_v", choices(p.wrap_v)[static_cast<std::size_t>(p.wrap_v)].second},
              {"levels", std::move(levels)},
              {"channels", std::move(channels)}};
  if (p.alpha_cutoff > 0) out["alpha_cutoff"] = json_number(p.alpha_cutoff);
  return out;
}

struct Ops {
  static std::size_t bytes(const Texture& t) { return t.bytes(); }
  static void hash(const Texture& t, Hasher& h) { h.value(t.digest()); }
  static Health health(const Texture& t) { return t.health(); }
  static void save(const Texture& t, ArchiveWriter& w) {
    w.value(std::uint64_t{t.source.index()});
    if (const auto* c = std::get_if<Checker>(&t.source)) {
      w.value(c->scale);
      for (const glm::dvec3& v : {c->even, c->odd}) w.raw(&v, sizeof v);
    }
    if (const auto* p = std::get_if<MipPyramid>(&t.source)) {
      w.value(p->wrap_u).value(p->wrap_v).value(p->alpha_cutoff).value(std::uint64_t{p->levels.size()});
      for (const auto& level : p->levels) {
        const bool half = !level.half_rgba.empty();
        w.value(level.width)
            .value(level.height)
            .value(std::uint64_t{half})
            .value(std::uint64_t{level.size()});
        // Apart and by content, since every mesh of a scene carries its textures along. Nobody owns a
        // pointer into a vector; it is only read here.
        const void* numbers = half ? static_cast<const void*>(level.half_rgba.data()) : level.rgba.data();
        w.shared({std::shared_ptr<const void>(), numbers}, level.bytes());
      }
    }
  }
  static Texture load(ArchiveReader& r) {
    if (r.choice<std::uint64_t>(1) == 0) {
      Checker c;
      c.scale = r.value<double>();
      for (glm::dvec3* v : {&c.even, &c.odd}) r.raw(v, sizeof *v);
      return {c};
    }
    MipPyramid p;
    p.wrap_u = r.choice(Wrap::border);
    p.wrap_v = r.choice(Wrap::border);
    p.alpha_cutoff = r.value<double>();
    for (std::size_t n = r.count(1); n > 0; --n) {
      const int width = r.value<int>(), height = r.value<int>();
      const bool half = r.choice<std::uint64_t>(1) == 1;
      const auto values = r.value<std::uint64_t>();
      if (width < 0 || height < 0 || values != 4 * static_cast<std::uint64_t>(std::int64_t{width} * height))
        throw ArchiveError("a level of another size");
      const auto storage = r.shared(values * (half ? sizeof(std::uint16_t) : sizeof(float)));
      MipPyramid::Level level{width, height, {}};
      const auto read = [&](auto& into) {
        const auto* first = static_cast<decltype(into.data())>(const_cast<void*>(storage.get()));
        into.assign(first, first + values);
      };
      half ? read(level.half_rgba) : read(level.rgba);
      p.levels.push_back(std::move(level));
    }
    return {std::move(p)};
  }
  static Json summary(const Texture& t) {
    return std::visit([](const auto& source) { return summary_of(source); }, t.source);
  }
};

}  // namespace

float MipPyramid::Level::number(std::size_t i) const {
  return half_rgba.empty() ? rgba[i] : kernels::from_half(half_rgba[i]);
}

std::vector<float> MipPyramid::Level::numbers(std::size_t first, std::size_t count) const {
  std::vector<float> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = number(first + i);
  return out;
}

struct Texture::Memo {
  std::once_flag hashed, counted;
  Digest digest;
  Health health;
};

Texture::Texture(std::variant<Checker, MipPyramid> from)
    : source(std::move(from)), memo_(std::make_shared<Memo>()) {}

std::size_t Texture::bytes() const {
  std::size_t sum = sizeof *this;
  if (const auto* p = std::get_if<MipPyramid>(&source))
    for (const auto& level : p->levels) sum += level.bytes();
  return sum;
}

Digest Texture::digest() const {
  std::call_once(memo_->hashed, [this] {
    Hasher h;
    h.value(source.index());
    std::visit([&](const auto& s) { hash_source(s, h); }, source);
    memo_->digest = h.done();
  });
  return memo_->digest;
}

Health Texture::health() const {
  std::call_once(memo_->counted,
                 [this] { memo_->health = std::visit([](const auto& s) { return health_of(s); }, source); });
  return memo_->health;
}

template <>
const BufferType& buffer_type<Texture>() {
  static const BufferType type =
      make_buffer_type<Texture, Ops>("texture", "A colour for every u and v.", "#c78f3f");
  return type;
}

}  // namespace frustum
