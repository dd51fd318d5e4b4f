// Outputs that take each other's place on the disk, here or on another system.
#include "runtime/graph/document_reader.h"

#include <fmt/format.h>
#include <wctype.h>

#include <algorithm>
#include <clocale>
#include <filesystem>
#include <unordered_map>
#include <utility>
#include <vector>

namespace frustum {
namespace {

// Letters of all scripts where the C library has a locale of UTF-8, else A to Z.
locale_t letters() {
  static const locale_t known = [] {
    const locale_t utf8 = newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
    return utf8 != nullptr ? utf8 : newlocale(LC_CTYPE_MASK, "C", nullptr);
  }();
  return known;
}

// The code points of a text in UTF-8, as all JSON is, with one for all cases of a letter: names that are equal then name
// one file on systems that ignore case. Those fold each code point by itself, and so does this.
std::u32string without_case(const std::string& text) {
  std::u32string out;
  for (const char byte : text) {
    const auto b = static_cast<unsigned char>(byte);
    if ((b & 0xC0) == 0x80)
      out.back() = (out.back() << 6) | (b & 0x3F);
    else
      out.push_back(b < 0x80 ? b : b & (b < 0xE0 ? 0x1F : b < 0xF0 ? 0x0F : 0x07));
  }
  for (char32_t& c : out)
    c = static_cast<char32_t>(towlower_l(towupper_l(static_cast<wint_t>(c), letters()), letters()));
  return out;
}

struct OutputFile {
  std::string path;     // shortest form
  std::u32string name;  // of it, for all that looks alike
  const DocumentOutput* output;
};

std::vector<OutputFile> files_of(const std::vector<DocumentOutput>& outputs) {
  std::vector<OutputFile> out;
  for (const DocumentOutput& o : outputs) {
    if (o.file.empty()) continue;
    std::string path = std::filesystem::path(o.file).lexically_normal().string();
    std::u32string name = without_case(path);
    out.push_back({std::move(path), std::move(name), &o});
  }
  return out;
}

struct Clash {
  const OutputFile *file, *other;
};

// Each file whose name an earlier one has, with the first of that name.
std::vector<Clash> equal_files(const std::vector<OutputFile>& files) {
  std::unordered_map<std::u32string, const OutputFile*> first;
  std::vector<Clash> found;
  for (const OutputFile& f : files)
    if (const auto [same, is_new] = first.try_emplace(f.name, &f); !is_new)
      found.push_back({same->second, &f});
  return found;
}

// Files that lie where another one would have to be a folder.
std::vector<Clash> files_inside_files(const std::vector<OutputFile>& files) {
  std::vector<const OutputFile*> sorted;
  for (const OutputFile& f : files) sorted.push_back(&f);
  // With '/' before every other character, what lies in a folder follows its name at once.
  const auto before = [](char32_t a, char32_t b) { return a != b && (a == '/' || (b != '/' && a < b)); };
  std::stable_sort(sorted.begin(), sorted.end(), [&](const OutputFile* a, const OutputFile* b) {
    return std::lexicographical_compare(a->name.begin(), a->name.end(), b->name.begin(), b->name.end(),
                                        before);
  });
  std::vector<Clash> found;
  for (std::size_t i = 1, outer = 0; i < sorted.size(); ++i) {
    const std::u32string &file = sorted[outer]->name, &inside = sorted[i]->name;
    if (inside.size() > file.size() && inside[file.size()] == '/' && inside.starts_with(file))
      found.push_back({sorted[outer], sorted[i]});
    else if (inside != file)
      outer = i;
  }
  return found;
}

constexpr std::string_view but_for_case = ", on systems that take no notice of the case of letters";

}  // namespace

void DocumentReader::check_same_files() {
  const auto clash = [&](const OutputFile& file, const OutputFile& other, std::string message,
                         const char* expected) {
    problem({.code = "duplicate_file",
             .pointer = child_pointer(other.output->pointer, "file"),
             .message = std::move(message),
             .expected = expected,
             .got = other.output->file,
             .related = {{.pointer = child_pointer(file.output->pointer, "file"),
                          .message = fmt::format("'{}' writes it here", file.output->name)}}});
  };
  const std::vector<OutputFile> files = files_of(doc_->outputs);
  for (const auto& [file, other] : equal_files(files))
    clash(*file, *other,
          fmt::format("'{}' and '{}' write the same file{}", file->output->name, other->output->name,
                      file->path == other->path ? "" : but_for_case),
          "a file for each output");
  for (const auto& [file, inside] : files_inside_files(files))
    clash(*file, *inside,
          fmt::format("'{}' writes into a folder that is the file of '{}'{}", inside->output->name,
                      file->output->name, inside->path.starts_with(file->path + "/") ? "" : but_for_case),
          "a file for each output, and none in the place of a folder");
}

}  // namespace frustum
