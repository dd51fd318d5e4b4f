// Projection and viewport.
#include "nodes/kernels/camera.h"
#include "nodes/kernels/clip.h"
#include "nodes/kernels/matrix.h"
#include "nodes/kernels/screen_triangle.h"
#include "nodes/project/orthographic.h"
#include "nodes/project/perspective.h"
#include "nodes/project/viewport.h"
#include "tests/hard/exact.h"
#include "tests/hard/screen.h"
#include "tests/hard/stages.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::dmat4, glm::dvec3, glm::vec3, glm::vec4;
constexpr double infinity = std::numeric_limits<double>::infinity();

bool finite(const vec4& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.w);
}

// Corners of what is left of a triangle on a screen of 64 x 64, after the real clip and viewport.
std::vector<vec4> on_screen(const ClipTriangle& t) {
  const auto planes = kernels::view_volume();
  const auto ring = kernels::clip_triangle<float>(planes, 0x3f, t[0], t[1], t[2]);
  std::vector<vec4> clip, screen(ring.size);
  for (std::size_t k = 0; k < ring.size; ++k) clip.push_back(ring.vertex[k].p);
  std::vector<std::uint8_t> no_point(ring.size);
  project::clip_to_screen<float>(true, kernels::Viewport({64, 64}), clip, screen, no_point);
  return screen;
}

void corner_on_the_eye_plane(Trial& t) {
  std::vector<ClipTriangle> inputs;
  for (const float x : {0.0F, 1.0F, -1.0F, 1e-30F, -1e-30F})
    for (const float y : {0.0F, 1.0F, -1e-30F})
      for (const float z : {0.0F, -1.0F, 1.0F})
        inputs.push_back({vec4(x, y, z, 0), vec4(-0.5F, -0.5F, 0, 1), vec4(0.5F, -0.25F, 0.5F, 1)});
  for (const auto& triangle : inputs) {
    const vec4& eye = triangle[0];
    const vec4 divided = eye * (1 / eye.w);
    const auto corners = on_screen(triangle);
    const bool all = std::all_of(corners.begin(), corners.end(), finite);
    t.tally(!finite(divided), !all, {eye.x, eye.y, eye.z});
    t.require(wrong_pixels(drawn({&triangle, 1}, 32, 32), seen(triangle, 32, 32)) == 0,
              "the picture is that of rays through the pixels", {eye.x, eye.y, eye.z});
  }
  t.price(
      [&] {
        for (const auto& x : inputs) keep(drawn_without_clipping({&x, 1}, 32, 32).id[0]);
      },
      [&] {
        for (const auto& x : inputs) keep(drawn({&x, 1}, 32, 32).id[0]);
      });
}

void tiny_w(Trial& t) {
  const auto reciprocal = [](const vec4& p) { return vec3(p) * (1 / p.w); };
  std::vector<vec4> inputs;
  const auto judge = [&](const vec4& p) {
    inputs.push_back(p);
    const vec3 got = kernels::divided(p), textbook = reciprocal(p);
    double naive_error = 0, error = 0;
    for (int i = 0; i < 3; ++i) {
      const Rational want = Rational(p[i]) / Rational(p.w);
      if (::abs(want) > Rational(std::numeric_limits<float>::max())) continue;  // beyond float: clipped away
      naive_error = std::max(naive_error, ulps(textbook[i], Real(want)));
      error = std::max(error, ulps(got[i], Real(want)));
    }
    t.measure(naive_error, error, {p.x, p.y, p.z, p.w});
  };
  for (const float w : {1e-30F, 1e-39F, -1e-45F, 0x1p-149F}) judge({w, 0.5F * w, 3 * w, w});
  for (std::size_t n = t.samples(1000, 100000); n-- > 0;) {
    const int e = -148 + static_cast<int>(t.random.below(270));
    vec4 p;
    for (int i = 0; i < 4; ++i) p[i] = static_cast<float>(t.random.magnitude(e, e + 4));
    judge(p);
  }
  t.price_over(inputs, reciprocal, [](const vec4& p) { return kernels::divided(p); });
}

void behind_the_eye(Trial& t) {
  std::vector<ClipTriangle> inputs{
      {vec4(0, 0.5F, 0, 1), vec4(-0.5F, -0.5F, 0, 1), vec4(0.3F, 0.1F, 0, -0.5F)}};
  for (std::size_t n = t.samples(12, 1000); n-- > 0;) {
    ClipTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto number = [&](double size) { return static_cast<float>(t.random.uniform(-size, size)); };
      triangle[k] = {number(2), number(2), number(0.5),
                     k == 0 ? -1 - std::fabs(number(1)) : 1 + std::fabs(number(1))};
    }
    inputs.push_back(triangle);
  }
  for (const auto& triangle : inputs) {
    const auto want = seen(triangle, 64, 64);
    t.measure(static_cast<double>(wrong_pixels(drawn_without_clipping({&triangle, 1}, 64, 64), want)),
              static_cast<double>(wrong_pixels(drawn({&triangle, 1}, 64, 64), want)),
              {triangle[0].x, triangle[0].y, triangle[0].z, triangle[0].w});
  }
  t.price(
      [&] {
        for (const auto& x : inputs) keep(drawn_without_clipping({&x, 1}, 64, 64).id[0]);
      },
      [&] {
        for (const auto& x : inputs) keep(drawn({&x, 1}, 64, 64).id[0]);
      });
}

void depth_resolution(Trial& t) {
  const kernels::ClipMap<float> standard(kernels::perspective(1, 1, 1e-3, 1e6));
  const kernels::ClipMap<float> reversed(
      kernels::perspective(1, 1, 1e-3, infinity, {.depth = kernels::DepthRange::one_to_zero}));
  const auto depth = [](const kernels::ClipMap<float>& map, float distance) {
    return kernels::divided(map({0, 0, -distance})).z;
  };
  std::vector<float> inputs;
  for (float z = 1000; z < 1001; z += 4 * 1000 * 0x1.04p-24F) inputs.push_back(z);
  for (std::size_t i = 1; i < inputs.size(); ++i) {
    const float here = inputs[i - 1], beyond = inputs[i];
    t.tally(!(depth(standard, here) < depth(standard, beyond)),
            !(depth(reversed, here) > depth(reversed, beyond)), {here, beyond});
  }
  t.price_over(
      inputs, [&](float z) { return depth(standard, z); }, [&](float z) { return depth(reversed, z); });
}

void thin_frustum(Trial& t) {
  // z_ndc of a distance by the matrix entries as they are stored, without further rounding.
  const auto depth = [](const Rational& scale, const Rational& offset, const Rational& distance) {
    return Rational(offset / distance - scale);
  };
  const auto judge = [&](double n, double f) {
    const auto near_f = static_cast<float>(n), far_f = static_cast<float>(f);
    const float scale_f = -(far_f + near_f) / (far_f - near_f),
                offset_f = -2 * far_f * near_f / (far_f - near_f);
    const auto p = kernels::perspective(1, 1, n, f);
    const Rational unit = Rational(u64) * Rational(f) / (Rational(f) - Rational(n));
    const auto error = [&](double scale, double offset) {
      const Rational at_near = depth(Rational(scale), Rational(offset), Rational(n)) + 1;
      const Rational at_far = depth(Rational(scale), Rational(offset), Rational(f)) - 1;
      return std::max(distance(0, at_near, unit), distance(0, at_far, unit));
    };
    const bool possible = std::isfinite(scale_f) && std::isfinite(offset_f);
    t.measure(possible ? error(scale_f, offset_f) : infinity, error(p.depth_scale, p.depth_offset), {n, f});
  };
  judge(1e6, 1e6 + 1);
  for (std::size_t n = t.samples(500, 50000); n-- > 0;) {
    const double near_z = std::fabs(t.random.magnitude(-20, 20));
    judge(near_z, near_z * (1 + std::fabs(t.random.magnitude(-30, 10))));
  }
  for (const auto& [n, f] : {std::pair{1.0, 1.0}, {0.0, 1.0}, {2.0, 1.0}, {-1.0, 1.0}})
    t.require(!project::fault_of_perspective(1, 1, n, f).empty(), "an impossible volume is an error", {n, f});
}

void far_thin_box(Trial& t) {
  const auto judge = [&](double near_z, double far_z) {
    const auto n = static_cast<float>(near_z), f = static_cast<float>(far_z);
    const kernels::ClipMap<float> map(kernels::orthographic(1, 1, near_z, far_z));
    const kernels::ClipMap<float> reversed(
        kernels::orthographic(1, 1, near_z, far_z, {.depth = kernels::DepthRange::one_to_zero}));
    const auto textbook = [&](float z) { return -2 / (f - n) * z - (f + n) / (f - n); };
    t.measure(ulps(textbook(-n), Real(-1.0)), ulps(map({0, 0, -n}).z, Real(-1.0)), {near_z, far_z});
    t.measure(ulps(textbook(-f), Real(1.0)), ulps(map({0, 0, -f}).z, Real(1.0)), {near_z, far_z});
    t.measure_robust(ulps(reversed({0, 0, -n}).z, Real(1.0)), {near_z, far_z});
    t.require(reversed({0, 0, -f}).z == 0, "reversed depth ends at 0", {near_z, far_z});
  };
  judge(1e6, 1e6 + 0.0625);
  for (std::size_t n = t.samples(500, 50000); n-- > 0;) {
    const auto near_z = static_cast<float>(t.random.uniform(1e5, 1e7));
    const auto depth = static_cast<float>(1 + t.random.below(64)) * std::ldexp(1.0F, std::ilogb(near_z) - 23);
    judge(near_z, static_cast<double>(near_z) + depth);
  }
  const kernels::ClipMap<float> map(kernels::orthographic(1, 1, 1, 20));
  std::vector<vec3> inputs(1000, vec3(1, 2, -3));
  t.price_over(
      inputs, [](const vec3& p) { return vec4(p.x * 2, p.y * 2, p.z * -0.1F - 1.1F, 1); },
      [&](const vec3& p) { return map(p); });
}

void middle_of_the_raster(Trial& t) {
  // The course: u_c = -W + 2 W c / (N - 1), here with W = 1.
  const auto textbook = [](double c, double n) { return -1 + 2 * c / (n - 1); };
  const auto ours = [](double c, int n) { return kernels::Viewport({n, 1}).ndc_from_px({c + 0.5, 0.5}).x; };
  t.tally(!(textbook(0, 1) == 0), ours(0, 1) != 0, {0, 1});
  const auto judge = [&](int n, int c) {
    const double mirrored = n - 1 - c;
    t.tally(textbook(c, n) != -textbook(mirrored, n), ours(c, n) != -ours(mirrored, n),
            {static_cast<double>(c), static_cast<double>(n)});
  };
  for (int n = 1; n <= 64; ++n)
    for (int c = 0; c < n; ++c) judge(n, c);
  for (std::size_t i = t.samples(100000, 10000000); i-- > 0;) {
    const int n = 1 + static_cast<int>(t.random.below((1 << 24) + 1));
    judge(n, static_cast<int>(t.random.below(static_cast<std::size_t>(n))));
  }
  std::vector<double> inputs;
  for (int i = 0; i < 1000; ++i) inputs.push_back(i);
  t.price_over(
      inputs, [&](double c) { return textbook(c, 1000); }, [&](double c) { return ours(c, 1000); });
}

void pixel_centres(Trial& t) {
  std::vector<float> inputs;
  for (const int width : {640, 1920, 4096, 16384}) {
    const kernels::Viewport viewport({width, 1});
    for (int k = 0; k < width; ++k) {
      const auto ndc = static_cast<float>(2 * (k + 0.5) / width - 1);
      const auto textbook = static_cast<int>((ndc + 1) * 0.5F * static_cast<float>(width) * 256);
      const int got = kernels::snap(static_cast<double>(viewport.x_px(ndc)), kernels::corner_bits);
      t.tally(textbook != k * 256 + 128, got != k * 256 + 128, {ndc, static_cast<double>(width)});
      if (width == 16384) inputs.push_back(ndc);
    }
  }
  const kernels::Viewport viewport({16384, 1});
  t.price_over(
      inputs, [](float x) { return static_cast<int>((x + 1) * 0.5F * 16384 * 256); },
      [&](float x) { return kernels::snap(static_cast<double>(viewport.x_px(x)), kernels::corner_bits); });
}

void course_matrix(Trial& t) {
  const auto all_finite = [](const glm::mat4& m) {
    bool all = true;
    for (int c = 0; c < 4; ++c) all = all && finite(m[c]);
    return all;
  };
  for (const double n : {0.1, 1.0, 5.0}) {
    dmat4 course(1.0);
    course[2][3] = -1 / n, course[3][3] = 0;
    t.tally(!all_finite(glm::inverse(glm::mat4(course))), kernels::inverse<4>(course).has_value(), {n});
    for (const bool reversed : {false, true}) {
      const auto ours = kernels::matrix_of(kernels::perspective(
          1, 1, n, 100,
          reversed ? kernels::ClipSpace{.depth = kernels::DepthRange::one_to_zero} : kernels::ClipSpace{}));
      t.require(kernels::inverse<4>(ours).has_value(), "ours has an inverse", {n});
    }
  }
}

void unprojecting(Trial& t) {
  const auto standard = kernels::perspective(1, 1, 1e-3, 1e6),
             reversed = kernels::perspective(1, 1, 1e-3, 1e6, {.depth = kernels::DepthRange::one_to_zero});
  const kernels::ClipMap<float> to_standard(standard), to_reversed(reversed);
  const glm::mat4 back(glm::inverse(kernels::matrix_of(standard)));
  const auto textbook = [&](float z) {
    const vec4 p = back * vec4(kernels::divided(to_standard({0, 0, -z})), 1);
    return p.z / p.w;
  };
  const auto ours = [&](float z) {
    return kernels::eye_from_ndc(reversed, dvec3(kernels::divided(to_reversed({0, 0, -z})))).z;
  };
  std::vector<float> inputs;
  for (std::size_t n = t.samples(2000, 200000); n-- > 0;) {
    const auto z = static_cast<float>(std::exp2(t.random.uniform(std::log2(10), std::log2(1e5))));
    inputs.push_back(z);
    t.measure(distance(textbook(z), Rational(-z), Rational(z) * Rational(u32)),
              distance(ours(z), Rational(-z), Rational(z) * Rational(u32)), {z});
  }
  t.price_over(inputs, textbook, ours);
}

}  // namespace

std::vector<HardCase> projection() {
  return {
      {"PRJ-01", "triangles with a corner (x, y, z, 0), x and y in {0, +-1, +-1e-30}",
       "divide by w, then clip", "kernels::clip_triangle, project::clip_to_screen",
       "rays through pixels, 113 bits", "no infinity and no NaN after the clip; the picture of the rays",
       "corners not finite", 0, corner_on_the_eye_plane},
      {"PRJ-02", "w = 1e-30, 1e-39, -1e-45, random quadruples down to 2^-149", "(x, y, z) * (1 / w), float",
       "kernels::divided", "rationals", "within 1.5 ulp wherever the quotient is in range", "ulp", 1.5,
       tiny_w},
      {"PRJ-03", "triangles with one corner behind the eye", "divide by w, rasterize",
       "clip, viewport and fill kernels", "rays through pixels, 113 bits",
       "the pixels of the rays, but for those on an edge", "wrong pixels", 0, behind_the_eye},
      {"PRJ-04", "near 1e-3, far 1e6; planes at 1000 to 1001, 4 z 2^-24 apart", "depth from -1 to 1, float",
       "kernels::perspective reversed, far at infinity", "exact order", "no two in the wrong order",
       "pairs not in order", 0, depth_resolution},
      {"PRJ-06", "near 1e6, far 1e6 + 1; f / n - 1 down to 2^-30", "the same entries in float",
       "kernels::perspective", "rationals",
       "near and far map to the ends within 2 u64 f / (f - n); impossible volumes are errors",
       "u64 f / (f - n)", 2, thin_frustum},
      {"PRJ-07", "an orthographic box from 1e6 to 1e6 + 1/16, others 1 to 64 ulp thin",
       "-2 z / (f - n) - (f + n) / (f - n), float", "kernels::orthographic, ClipMap", "the ends themselves",
       "ends map to +-1 within 2 ulp", "ulp", 2, far_thin_box},
      {"PRJ-08", "rasters of 1 to 2^24 + 1 columns", "-1 + 2 c / (N - 1)", "kernels::Viewport::ndc_from_px",
       "integers", "one column is at 0; columns mirror each other bit for bit", "asymmetric columns", 0,
       middle_of_the_raster},
      {"PRJ-09", "NDC of every pixel centre, rounded to float; widths up to 16384",
       "(x + 1) W / 2 in float, truncated to 1/256 px", "kernels::Viewport, snap", "integers",
       "every centre lands on itself", "centres missed", 0, pixel_centres},
      {"PRJ-10", "the course's perspective matrix, whose rank is 3", "glm::inverse", "kernels::inverse<4>",
       "rank", "no inverse is given; ours has one", "useless inverses", 0, course_matrix},
      {"PRJ-12", "near 1e-3, far 1e6, float depth; points at 10 to 1e5, there and back",
       "depth from -1 to 1, inverse matrix", "reversed depth, kernels::eye_from_ndc", "the point itself",
       "relative error <= 4 u", "u", 4, unprojecting},
  };
}

}  // namespace frustum::hard
