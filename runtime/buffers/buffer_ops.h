// From typed functions over a kind of buffer to its BufferType.
#pragma once

#include "runtime/core/archive.h"
#include "runtime/core/buffer.h"

#include <functional>
#include <utility>

namespace frustum {

// `Ops` has the static functions bytes(const T&), hash(const T&, Hasher&), health(const T&), summary(const
// T&), and may have table(const T&, first, count), parts(const T&, visit), raster(const T&),
// from_raster(Raster), from_json(const Json&, ParamReader&), and the pair save(const T&, ArchiveWriter&) and
// T load(ArchiveReader&).
template <class T, class Ops>
BufferType make_buffer_type(std::string_view name, std::string_view doc, std::string_view color) {
  BufferType t{.name = name, .doc = doc, .color = color};
  t.bytes = [](const void* p) -> std::size_t { return Ops::bytes(*static_cast<const T*>(p)); };
  t.hash = [](const void* p, Hasher& h) { Ops::hash(*static_cast<const T*>(p), h); };
  t.health = [](const void* p) { return Ops::health(*static_cast<const T*>(p)); };
  t.summary = [](const void* p) { return Ops::summary(*static_cast<const T*>(p)); };
  if constexpr (requires { &Ops::table; })
    t.table = [](const void* p, std::size_t first, std::size_t count) {
      return Ops::table(*static_cast<const T*>(p), first, count);
    };
  if constexpr (requires { &Ops::parts; })
    t.parts = [](const void* p, const std::function<void(const void*, std::size_t)>& visit) {
      Ops::parts(*static_cast<const T*>(p), visit);
    };
  if constexpr (requires { &Ops::save; }) {
    t.save = [](const void* p, ArchiveWriter& w) { Ops::save(*static_cast<const T*>(p), w); };
    t.load = [](ArchiveReader& r) -> Buffer { return std::make_shared<const T>(Ops::load(r)); };
  }
  if constexpr (requires { &Ops::raster; })
    t.raster = [](const void* p) -> const Raster& { return Ops::raster(*static_cast<const T*>(p)); };
  if constexpr (requires { &Ops::from_raster; }) t.from_raster = &Ops::from_raster;
  if constexpr (requires { &Ops::from_json; }) t.from_json = &Ops::from_json;
  return t;
}

// A part of a buffer that is of a kind itself, or null: whether it is there, then its content.
template <class T>
void save_part(const Ref<T>& part, ArchiveWriter& w) {
  w.value(part != nullptr);
  if (part) buffer_type<T>().save(part.get(), w);
}
template <class T>
Ref<T> load_part(ArchiveReader& r) {
  return r.flag() ? buffer_type<T>().load(r).template as<T>() : nullptr;
}

}  // namespace frustum
