#include "runtime/io/oiio/deep.h"

#include "runtime/core/error.h"
#include "runtime/core/partial_file.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfDeepTiledInputPart.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfTestFile.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <new>

// OpenImageIO reads the counts and takes memory for them in one step, so a file that lies about them would be
// believed; the library below it lets the counts be looked at first.
namespace frustum::oiio {
namespace {

// Rows pass between us and the library a band at a time; it takes as much memory again as it is handed.
constexpr int band_rows = 64;

struct File {
  std::string_view name;
  std::uint64_t bytes = 0;

  [[noreturn]] void malformed(std::string_view why) const {
    throw NodeError("malformed_file", fmt::format("{}: {}", name, why));
  }
  // Deflate makes at most 1032 bytes of one.
  void check_claim(std::uint64_t n, std::string_view what, std::uint64_t bytes_each) const {
    if (n > (bytes * 1032 + (std::uint64_t{1} << 20)) / bytes_each)
      malformed(fmt::format("it says {} {}, more than its {} bytes can hold", n, what, bytes));
  }
};

// What the library says, without the name of the file, which stands before it already, and as part of a sentence.
std::string said_by(const std::exception& e) {
  std::string why = e.what();
  const std::size_t name = why.find("image file \""), end = why.find("\". ", name);
  if (name != std::string::npos && end != std::string::npos) why.erase(0, end + 3);
  while (!why.empty() && (why.back() == '.' || why.back() == '\n')) why.pop_back();
  return why;
}

std::uint64_t size_of(const std::string& path, std::string_view name) {
  struct stat info {};
  std::string_view why;
  if (stat(path.c_str(), &info) != 0)
    why = std::strerror(errno);
  else if (!S_ISREG(info.st_mode))
    why = "it is not a regular file";
  if (!why.empty()) throw WorldError("cannot_read_file", fmt::format("cannot read {}: {}", name, why));
  return static_cast<std::uint64_t>(info.st_size);
}

// "N.X" is our "N.x", and back.
std::string renamed(std::string name, bool to_file) {
  const std::size_t n = name.size();
  const char low = to_file ? 'w' : 'W', high = to_file ? 'z' : 'Z';
  if (n > 2 && name[n - 2] == '.' && name[n - 1] >= low && name[n - 1] <= high)
    name[n - 1] = static_cast<char>(name[n - 1] + (to_file ? -32 : 32));
  return name;
}

// The lists of one part, read in two steps: how long they are, then what is in them.
class Reader {
 public:
  Reader(const Imf::Header& header, const File& file, Context& ctx) : file_(file), ctx_(ctx) {
    const Imath::Box2i window = header.dataWindow();
    out_.window = {window.min.x, window.min.y, window.max.x + 1, window.max.y + 1};
    const auto pixels = static_cast<std::uint64_t>(out_.window.area());
    if (pixels == 0) file.malformed("the picture has no pixels");
    file.check_claim(pixels, "pixels", sizeof(unsigned));
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
        file.malformed(fmt::format("channel {} has not one value a fragment", c.name()));
      channels_.push_back({c.name(), c.channel().type == Imf::UINT});
    }
    if (channels_.empty()) file.malformed("it has no channels");
    if (const auto* space = header.findTypedAttribute<Imf::StringAttribute>("frustum:colorSpace"))
      out_.color_space = space->value();
    ctx_.claim(pixels * (sizeof(unsigned) + sizeof(std::uint64_t) + channels_.size() * sizeof(char*)));
    counts_.resize(pixels);
    for (auto& c : channels_) c.places.resize(pixels);
  }

  // The library addresses pixels by their absolute coordinates from a pointer to pixel 0, 0.
  Imf::DeepFrameBuffer frame_buffer() {
    const auto width = static_cast<std::size_t>(out_.window.width());
    const auto origin = [&](auto* first) {
      const std::ptrdiff_t before = std::ptrdiff_t{out_.window.y0} * out_.window.width() + out_.window.x0;
      return reinterpret_cast<char*>(reinterpret_cast<std::uintptr_t>(first) -
                                     static_cast<std::uintptr_t>(before) * sizeof *first);
    };
    Imf::DeepFrameBuffer to;
    to.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, origin(counts_.data()), sizeof(unsigned), sizeof(unsigned) * width));
    for (auto& c : channels_)
      to.insert(c.name, Imf::DeepSlice(c.integer ? Imf::UINT : Imf::FLOAT, origin(c.places.data()),
                                       sizeof(char*), sizeof(char*) * width, sizeof(float)));
    return to;
  }

  void take_memory() {
    out_.first.resize(counts_.size() + 1);
    for (std::size_t i = 0; i < counts_.size(); ++i) out_.first[i + 1] = out_.first[i] + counts_[i];
    file_.check_claim(out_.count(), "fragments", channels_.size() * sizeof(float));
    ctx_.claim(out_.count() * channels_.size() * sizeof(float));
    for (auto& c : channels_) {
      const NumberKind kind = c.integer ? NumberKind::u32 : NumberKind::f32;
      c.column = std::make_shared<Column>(renamed(c.name, false), Domain::vertex, kind, 1, out_.count());
      auto* data = static_cast<char*>(c.column->data());
      for (std::size_t i = 0; i < counts_.size(); ++i) c.places[i] = data + out_.first[i] * sizeof(float);
    }
  }

  Fragments finish() {
    for (auto& c : channels_) out_.channels.push_back(c.column);
    if (out_.find("R") == nullptr)
      out_.color_space.clear();
    else if (out_.color_space.empty())
      out_.color_space = "lin_rec709";
    return std::move(out_);
  }

 private:
  struct Channel {
    std::string name;
    bool integer;
    std::vector<char*> places = {};  // of each pixel's fragments
    std::shared_ptr<Column> column = {};
  };

  const File& file_;
  Context& ctx_;
  Fragments out_;
  std::vector<unsigned> counts_;
  std::vector<Channel> channels_;
};

Fragments read_part(Imf::MultiPartInputFile& in, int part, const File& file, Context& ctx) {
  const Imf::Header& header = in.header(part);
  const std::string type = header.hasType() ? header.type() : "";
  if (type != Imf::DEEPSCANLINE && type != Imf::DEEPTILE)
    throw NodeError("not_deep", fmt::format("{}: part {} has one value a pixel: io.load_image reads it",
                                            file.name, part));
  Reader reader(header, file, ctx);
  if (type == Imf::DEEPSCANLINE) {
    Imf::DeepScanLineInputPart rows(in, part);
    rows.setFrameBuffer(reader.frame_buffer());
    const Imath::Box2i window = header.dataWindow();
    rows.readPixelSampleCounts(window.min.y, window.max.y);
    reader.take_memory();
    for (int y = window.min.y; y <= window.max.y; y += band_rows) {
      rows.readPixels(y, std::min(y + band_rows - 1, window.max.y));
      ctx.poll();
    }
  } else {
    Imf::DeepTiledInputPart tiles(in, part);
    tiles.setFrameBuffer(reader.frame_buffer());
    const int x = tiles.numXTiles(0) - 1, y = tiles.numYTiles(0) - 1;
    tiles.readPixelSampleCounts(0, x, 0, y, 0);
    reader.take_memory();
    for (int row = 0; row <= y; ++row) {
      tiles.readTiles(0, x, row, row, 0);
      ctx.poll();
    }
  }
  return reader.finish();
}

// The library's view of a partial file, which itself knows what failed.
class Stream : public Imf::OStream {
 public:
  Stream(const std::string& path, PartialFile& file) : OStream(path.c_str()), file_(file) {}
  void write(const char c[], int n) override { file_.write(c, static_cast<std::size_t>(n)); }
  std::uint64_t tellp() override { return static_cast<std::uint64_t>(file_.tell()); }
  void seekp(std::uint64_t pos) override { file_.seek(static_cast<std::int64_t>(pos)); }

 private:
  PartialFile& file_;
};

Imf::Header header_of(const Fragments& f, const SaveRequest& request) {
  const Imath::Box2i window({f.window.x0, f.window.y0}, {f.window.x1 - 1, f.window.y1 - 1});
  Imf::Header header(window, window);
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  if (!f.color_space.empty()) header.insert("frustum:colorSpace", Imf::StringAttribute(f.color_space));
  for (const auto& [key, value] : request.metadata) header.insert(key.c_str(), Imf::StringAttribute(value));
  for (const Ref<Column>& c : f.channels)
    header.channels().insert(renamed(c->name(), true),
                             Imf::Channel(c->kind() == NumberKind::u32 ? Imf::UINT : Imf::FLOAT));
  return header;
}

// Where the lists of one band lie.
class Band {
 public:
  explicit Band(const Fragments& f)
      : f_(f), counts_(pixels_of(f)), places_(f.channels.size(), std::vector<char*>(pixels_of(f))) {}

  static std::size_t pixels_of(const Fragments& f) {
    return static_cast<std::size_t>(f.window.width()) *
           static_cast<std::size_t>(std::min(band_rows, f.window.height()));
  }
  static std::uint64_t bytes(const Fragments& f) {
    const auto wide = std::count_if(f.channels.begin(), f.channels.end(),
                                    [](const Ref<Column>& c) { return c->kind() == NumberKind::f64; });
    std::uint64_t most = 0;  // fragments of a band
    for (std::size_t first = 0, end = 0; first + 1 < f.first.size(); first = end) {
      end = std::min(first + pixels_of(f), f.first.size() - 1);
      most = std::max(most, f.first[end] - f.first[first]);
    }
    return pixels_of(f) * (sizeof(unsigned) + f.channels.size() * sizeof(char*)) +
           static_cast<std::uint64_t>(wide) * most * sizeof(float);
  }

  // The rows from y0 (of the window's top) to y1.
  Imf::DeepFrameBuffer rows(int y0, int y1) {
    const auto width = static_cast<std::size_t>(f_.window.width());
    first_ = static_cast<std::size_t>(y0) * width, count_ = static_cast<std::size_t>(y1 - y0) * width;
    before_ = (std::ptrdiff_t{f_.window.y0} + y0) * f_.window.width() + f_.window.x0;
    for (std::size_t i = 0; i < count_; ++i)
      counts_[i] = static_cast<unsigned>(f_.first[first_ + i + 1] - f_.first[first_ + i]);
    Imf::DeepFrameBuffer from;
    from.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, origin(counts_.data()), sizeof(unsigned), sizeof(unsigned) * width));
    for (std::size_t k = 0; k < f_.channels.size(); ++k) {
      const Column& c = *f_.channels[k];
      place(k);
      from.insert(
          renamed(c.name(), true),
          Imf::DeepSlice(c.kind() == NumberKind::u32 ? Imf::UINT : Imf::FLOAT, origin(places_[k].data()),
                         sizeof(char*), sizeof(char*) * width, sizeof(float)));
    }
    return from;
  }

 private:
  // The library addresses pixels by their absolute coordinates from a pointer to pixel 0, 0.
  char* origin(auto* first) const {
    return reinterpret_cast<char*>(reinterpret_cast<std::uintptr_t>(first) -
                                   static_cast<std::uintptr_t>(before_) * sizeof *first);
  }

  void place(std::size_t k) {
    const Column& c = *f_.channels[k];
    const std::uint64_t first = f_.first[first_], end = f_.first[first_ + count_];
    const char* data = static_cast<const char*>(c.data()) + first * sizeof(float);
    if (c.kind() == NumberKind::f64) {
      auto& narrowed = narrowed_[k];
      narrowed.clear();
      for (const double v : c.values<double>().subspan(first, end - first))
        narrowed.push_back(static_cast<float>(v));
      data = reinterpret_cast<const char*>(narrowed.data());
    }
    for (std::size_t i = 0; i < count_; ++i)  // the library takes them as writable, and only reads
      places_[k][i] = const_cast<char*>(data) + (f_.first[first_ + i] - first) * sizeof(float);
  }

  const Fragments& f_;
  std::size_t first_ = 0, count_ = 0;  // pixels
  std::ptrdiff_t before_ = 0;
  std::vector<unsigned> counts_;
  std::vector<std::vector<char*>> places_;
  std::map<std::size_t, std::vector<float>> narrowed_;
};

void write_rows(const Fragments& f, Imf::DeepScanLineOutputFile& out, PartialFile& file, Context& ctx) {
  ctx.claim(Band::bytes(f));
  Band band(f);
  for (int y = 0; y < f.window.height(); y += band_rows) {
    const int end = std::min(y + band_rows, f.window.height());
    out.setFrameBuffer(band.rows(y, end));
    out.writePixels(end - y);
    file.check();  // a full disk ends it here
    ctx.poll();
  }
}

}  // namespace

Fragments read_deep(const std::string& path, std::string_view name, int part, Context& ctx) {
  const File file{name, size_of(path, name)};
  try {
    if (!name.ends_with(".exr") && !Imf::isOpenExrFile(path.c_str()))
      throw NodeError("not_deep", fmt::format("{}: it is no EXR file, which alone holds lists of fragments: "
                                              "io.load_image reads other pictures",
                                              name));
    Imf::MultiPartInputFile in(path.c_str());
    if (part < 0 || part >= in.parts()) file.malformed(fmt::format("there is no subimage {}", part));
    return read_part(in, part, file, ctx);
  } catch (const std::bad_alloc&) {
    throw WorldError("out_of_memory", fmt::format("no memory for the fragments of {}", name));
  } catch (const NodeError&) {
    throw;
  } catch (const WorldError&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& e) {
    file.malformed(said_by(e));
  }
}

void write_deep(const Fragments& fragments, const SaveRequest& request, Context& ctx) {
  if (fragments.window.empty() || fragments.channels.empty())
    throw NodeError("format_cannot_hold",
                    fmt::format("{}: EXR holds no picture without pixels", request.path));
  PartialFile file(request.path);
  try {
    Stream stream(request.path, file);
    Imf::DeepScanLineOutputFile out(stream, header_of(fragments, request));
    write_rows(fragments, out, file, ctx);
  } catch (const std::bad_alloc&) {
    throw WorldError("out_of_memory", fmt::format("no memory to write {}", request.path));
  } catch (const NodeError&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& e) {
    file.check();  // says it better
    throw WorldError("cannot_write_file", fmt::format("cannot write {}: {}", request.path, e.what()));
  }
  file.commit();
}

}  // namespace frustum::oiio
