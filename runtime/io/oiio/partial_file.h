// A file under a temporary name that becomes visible when it is whole.
#pragma once

#include <OpenImageIO/filesystem.h>

#include <cstdint>
#include <cstdio>
#include <string>

namespace frustum::oiio {

// What image writers write through: remembers the first error of the operating system (a full disk), which some of them drop.
class PartialFile : public OIIO::Filesystem::IOProxy {
 public:
  // Makes ".NAME.<process>-<number>.part" in the folder of `path`, and that folder where it is missing.
  // Throws WorldError("cannot_write_file").
  explicit PartialFile(const std::string& path);
  ~PartialFile() override;  // removes the file, unless commit() has renamed it

  void check() const;  // throws WorldError("cannot_write_file") where something has failed
  void commit();       // flushes, closes, renames

  const char* proxytype() const override { return "frustum"; }
  void close() override {}
  bool opened() const override { return file_ != nullptr; }
  std::int64_t tell() override { return static_cast<std::int64_t>(at_); }
  bool seek(std::int64_t offset) override;
  std::size_t read(void* to, std::size_t size) override;
  std::size_t write(const void* from, std::size_t size) override;
  std::size_t pread(void* to, std::size_t size, std::int64_t offset) override;
  std::size_t pwrite(const void* from, std::size_t size, std::int64_t offset) override;
  std::size_t size() const override { return static_cast<std::size_t>(size_); }
  void flush() const override {}

 private:
  [[noreturn]] void fail(int error) const;
  void remember();

  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
  std::int64_t at_ = 0, size_ = 0;
  int error_ = 0;
};

}  // namespace frustum::oiio
