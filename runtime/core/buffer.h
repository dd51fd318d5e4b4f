// What flows between nodes: an immutable value of some kind, erased once an edge and never once an element.
#pragma once

#include "runtime/core/diagnostic.h"
#include "runtime/core/digest.h"
#include "runtime/core/health.h"
#include "runtime/core/raster.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace frustum {

class ArchiveReader;
class ArchiveWriter;
class Buffer;
class ParamReader;

// One kind of buffer: what the runtime can do with it without knowing what it is.
struct BufferType {
  std::string_view name = {};   // "mesh"
  std::string_view doc = {};    // one sentence
  std::string_view color = {};  // of its ports in the studio, "#rrggbb"

  std::size_t (*bytes)(const void*) = nullptr;
  void (*hash)(const void*, Hasher&) = nullptr;  // of the content, nothing of addresses
  Health (*health)(const void*) = nullptr;
  Json (*summary)(const void*) = nullptr;  // statistics for `frustum inspect`
  // Rows [first, first + count) as {"columns": [...], "rows": [[...]], "total": n}; null where there is no table form.
  Json (*table)(const void*, std::size_t first, std::size_t count) = nullptr;

  // Kinds that share storage: every piece with its bytes, so that memory shared by two buffers counts once.
  void (*parts)(const void*, const std::function<void(const void* storage, std::size_t bytes)>&) = nullptr;

  // Kinds that are pixels: the raster inside, and a buffer of this kind made from one.
  const Raster& (*raster)(const void*) = nullptr;
  Buffer (*from_raster)(Raster) = nullptr;

  // Kinds that the cache keeps on disk: all of the content, so that load(save(b)) has the digest of b. `load` throws
  // ArchiveError for bytes that are no such value.
  void (*save)(const void*, ArchiveWriter&) = nullptr;
  Buffer (*load)(ArchiveReader&) = nullptr;

  // Kinds that an input may hold as a literal, {"value": ...}.
  Buffer (*from_json)(const Json&, ParamReader&) = nullptr;

  bool is_pixels() const { return raster != nullptr; }
};

// Specialised beside each kind: `template <> const BufferType& buffer_type<Mesh>();`
template <class T>
const BufferType& buffer_type();

class Buffer {
 public:
  Buffer() = default;
  template <class T>
  Buffer(Ref<T> data) : data_(std::move(data)), type_(&buffer_type<T>()) {}

  explicit operator bool() const { return data_ != nullptr; }
  const BufferType& type() const { return *type_; }
  const void* data() const { return data_.get(); }

  template <class T>
  bool is() const {
    return data_ && type_ == &buffer_type<T>();
  }
  template <class T>
  Ref<T> as() const {  // null where the buffer is of another kind
    return is<T>() ? std::static_pointer_cast<const T>(data_) : nullptr;
  }

  std::size_t bytes() const { return data_ ? type_->bytes(data_.get()) : 0; }
  Health health() const { return data_ ? type_->health(data_.get()) : Health{}; }
  Digest digest() const {
    Hasher h;
    h.text(type_->name);
    type_->hash(data_.get(), h);
    return h.done();
  }

 private:
  std::shared_ptr<const void> data_;
  const BufferType* type_ = nullptr;
};

}  // namespace frustum
