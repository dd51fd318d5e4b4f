// What libpng would say on stderr, found before it is asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace frustum::oiio {

// The next `bytes` of a file, into `to`; fewer at its end.
using ReadBytes = std::function<std::size_t(void* to, std::size_t bytes)>;

// What is wrong with the chunks of a PNG file of that size, or "": one that is cut off, whose bytes do not
// give its checksum, that stands out of place, or a header that libpng refuses. Also "" for what does not
// begin like a PNG. libpng tells of all these on stderr, where no reader of OpenImageIO (2.4.7) can stop it.
// The compressed pixels are not looked into. Reads the file once, in blocks.
// Source: PNG specification, 3rd edition, 2023, sections 5 and 11.2.
std::string png_fault(std::uint64_t size, const ReadBytes& read);

}  // namespace frustum::oiio
