// The numbers of a glTF file: buffers, views of them, and accessors that read views as vectors.
#pragma once

#include "runtime/io/file_bytes.h"
#include "runtime/io/gltf_json.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::gltf {

// Where another file that the document names lies. Throws NodeError("unsafe_path") for a URI with a scheme,
// an absolute path, or one that leads out of the folder of `file`.
FilePath resolved_uri(const FilePath& file, std::string_view uri, std::string_view element);

// The bytes that a URI stands for: of a file beside the document, or in the URI itself ("data:...;base64,").
class UriBytes {
 public:
  UriBytes(const FilePath& file, std::string_view uri, std::string_view element);
  std::string_view bytes() const { return file_ ? file_->text() : std::string_view(own_); }

 private:
  std::unique_ptr<FileBytes> file_;
  std::string own_;
};

struct View {
  std::string_view bytes;
  std::size_t stride = 0;  // 0: packed
};

enum class Component : std::uint16_t { i8 = 5120, u8, i16, u16, u32 = 5125, f32 };
std::size_t bytes_of(Component);

// A checked way to read `count` elements: whatever is read through it lies inside its views.
struct Accessor {
  std::string path;  // "accessors[3]"
  Component component = Component::f32;
  int width = 1;  // 1 to 4; matrices are not read
  bool normalized = false;
  std::size_t count = 0;
  std::size_t stride = 0;       // bytes from one element to the next
  const char* first = nullptr;  // null: all zero
  struct Sparse {
    std::size_t count = 0;
    Component index = Component::u32;
    const char *indices = nullptr, *values = nullptr;  // packed
  };
  std::optional<Sparse> sparse;

  bool is_packed() const {
    return first != nullptr && !sparse && stride == bytes_of(component) * static_cast<std::size_t>(width);
  }
};

// Everything that a document says of its numbers, read on demand. `document` and `file` outlive it.
class Data {
 public:
  // `binary`: the BIN chunk of a GLB file.
  Data(const Object& document, const FilePath& file, std::optional<std::string_view> binary);

  bool is_matrix(std::size_t accessor) const;
  std::size_t accessors() const { return accessors_.size(); }
  std::size_t views() const { return views_.size(); }
  // Throw NodeError("malformed_file") naming the accessor, view or buffer.
  Accessor accessor(std::size_t i);
  View view(std::size_t i);

  // Bytes that all buffers read so far hold.
  std::size_t bytes() const { return bytes_; }

 private:
  struct Buffer {
    bool read = false;
    std::string_view bytes;
    std::unique_ptr<UriBytes> own;
  };
  std::string_view buffer(std::size_t i);
  Accessor::Sparse sparse_of(const Object& sparse, const Accessor& a);

  const FilePath& file_;
  std::optional<std::string_view> binary_;
  std::vector<Object> buffers_, views_, accessors_;
  std::vector<Buffer> read_;
  std::size_t bytes_ = 0;
};

}  // namespace frustum::gltf
