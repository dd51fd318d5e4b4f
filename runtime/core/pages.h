// Memory for large buffers, kept for the next one when it is given back.
#pragma once

#include <cstddef>

namespace frustum {

// What a block holds when it is taken.
enum class Contents { zero, anything };

// A block on a 64-byte boundary. From one huge page (2 MiB) on it lies in huge pages where the system has them.
//   Cost: a page that the system hands out is cleared by it when first touched, one thread at a time; a block
//   that was given back before is there already. Clearing was a fifth of the
//   profile of frames of 1920 x 1080 in linear float. Blocks that must be zero are always new ones, cleared as
//   they are touched.
class Pages {
 public:
  Pages() = default;
  explicit Pages(std::size_t size, Contents contents = Contents::zero);  // throws std::bad_alloc
  ~Pages();
  Pages(Pages&& other) noexcept;
  Pages& operator=(Pages&& other) noexcept;

  std::byte* data() const { return data_; }  // null where the size is 0
  std::size_t size() const { return size_; }

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0, mapped_ = 0;
};

// How many bytes of blocks that nobody holds are kept, in the whole process; what is beyond goes back to the
// system at once. To begin with 256 MiB. Any thread may call it.
void keep_idle_pages(std::size_t bytes);
std::size_t idle_page_bytes();

}  // namespace frustum
