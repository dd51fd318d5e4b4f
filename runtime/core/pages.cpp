#include "runtime/core/pages.h"

#include <sys/mman.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace frustum {
namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20, page = 4096;

struct Block {
  std::byte* data;
  std::size_t size;
};

void unmap(const Block& b) { munmap(b.data, b.size); }

Block map(std::size_t size) {
  void* p = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) throw std::bad_alloc();
  // A 1080p RGBA raster then costs 16 page faults instead of 8100.
  if (size >= huge_page) madvise(p, size, MADV_HUGEPAGE);
  return {static_cast<std::byte*>(p), size};
}

// Blocks that nobody holds, the latest given back last.
class IdleBlocks {
 public:
  // The smallest block that is large enough and wastes no more than an eighth; nothing where there is none.
  Block take(std::size_t size) {
    const std::scoped_lock lock(mutex_);
    auto best = blocks_.end();
    for (auto b = blocks_.begin(); b != blocks_.end(); ++b)
      if (b->size >= size && b->size - size <= size / 8 && (best == blocks_.end() || b->size <= best->size))
        best = b;
    if (best == blocks_.end()) return {nullptr, 0};
    const Block found = *best;
    blocks_.erase(best);
    bytes_ -= found.size;
    return found;
  }

  void give_back(Block block) {
    const std::scoped_lock lock(mutex_);
    blocks_.push_back(block);
    bytes_ += block.size;
    trim();
  }

  void keep(std::size_t bytes) {
    const std::scoped_lock lock(mutex_);
    limit_ = bytes;
    trim();
  }

  std::size_t bytes() {
    const std::scoped_lock lock(mutex_);
    return bytes_;
  }

 private:
  // The oldest go first. At most 64 are kept, so that a search stays short.
  void trim() {
    auto b = blocks_.begin();
    for (; b != blocks_.end() && (bytes_ > limit_ || blocks_.end() - b > 64); ++b) {
      bytes_ -= b->size;
      unmap(*b);
    }
    blocks_.erase(blocks_.begin(), b);
  }

  std::mutex mutex_;
  std::vector<Block> blocks_;
  std::size_t bytes_ = 0, limit_ = std::size_t{256} << 20;
};

// Never destroyed: buffers with static lifetime give their blocks back after it would have been.
IdleBlocks& idle_blocks() {
  static auto* const blocks = new IdleBlocks;
  return *blocks;
}

}  // namespace

Pages::Pages(std::size_t size, Contents contents) : size_(size) {
  if (size == 0) return;
  Block block{nullptr, 0};
  if (contents == Contents::anything) block = idle_blocks().take(size);
  if (block.data == nullptr) block = map((size + page - 1) / page * page);
  data_ = block.data;
  mapped_ = block.size;
}

Pages::~Pages() {
  if (data_ != nullptr) idle_blocks().give_back({data_, mapped_});
}

Pages::Pages(Pages&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      mapped_(other.mapped_) {}

Pages& Pages::operator=(Pages&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(mapped_, other.mapped_);
  return *this;
}

void keep_idle_pages(std::size_t bytes) { idle_blocks().keep(bytes); }
std::size_t idle_page_bytes() { return idle_blocks().bytes(); }

}  // namespace frustum
