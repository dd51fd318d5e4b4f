// The stages of the catalogue, one file each.
#pragma once

#include "runtime/app/stability/hard_case.h"

#include <cstddef>
#include <vector>

namespace frustum::hard {

using stability::HardCase;
using stability::keep;
using stability::Trial;

extern const stability::CatalogueRow catalogue_rows[];
extern const std::size_t catalogue_size;

std::vector<HardCase> foundations();
std::vector<HardCase> transforms();
std::vector<HardCase> quaternions();
std::vector<HardCase> projection();
std::vector<HardCase> clipping();
std::vector<HardCase> culling();
std::vector<HardCase> lines();
std::vector<HardCase> triangles();
std::vector<HardCase> depth();
std::vector<HardCase> scanlines();
std::vector<HardCase> orders();
std::vector<HardCase> partitions();
std::vector<HardCase> shading();
std::vector<HardCase> shadows();
std::vector<HardCase> rays();
std::vector<HardCase> texture();
std::vector<HardCase> sampling();
std::vector<HardCase> colour();
std::vector<HardCase> curves();
std::vector<HardCase> runtime();

std::vector<stability::Illustration> illustrations();

}  // namespace frustum::hard
