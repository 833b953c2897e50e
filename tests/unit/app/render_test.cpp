#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "app/render/color.h"
#include "app/render/draw.h"
#include "app/render/film.h"
#include "app/render/surface.h"
#include "app/render/trace.h"
#include "core/error.h"
#include "core/random.h"
#include "folder.h"

/// The font library keeps patterns of its own until the process ends; under the address sanitizer they would
/// be reported as leaks of these tests.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig\n";
}

namespace cairn::render {
namespace {

namespace fs = std::filesystem;

const Vec3 kGrey = Vec3::Constant(0.5);

class RenderTest : public testing::Test {
 protected:
  const Folder scratch_;
  const fs::path folder_ = scratch_.path();
};

/// The camera looks down -z at a region of the given side around the origin.
View from_above(double side) {
  View view;
  view.direction = Vec3::UnitZ();
  view.up = Vec3::UnitY();
  view.width = view.height = side;
  return view;
}

Image bare(const std::vector<Ball>& balls, const View& view, int width, int height, const Style& style = {}) {
  Annotation nothing;
  nothing.scale_bar = false;
  return draw(balls, view, nothing, width, height, style);
}

bool is_paper(const std::uint8_t* p) {
  return p[0] == 255 && p[1] == 255 && p[2] == 255;
}

std::vector<Ball> heap(std::size_t count, double unit) {
  Random random(5, 1);
  std::vector<Ball> balls;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 place = 10.0 * random.in_ball();
    balls.push_back({unit * place, unit * random.uniform(0.5, 1.5), category_color(i % 5),
                     static_cast<std::uint32_t>(i / 3)});
  }
  return balls;
}

TEST_F(RenderTest, ASphereCoversItsDisc) {
  for (const double unit : {1e-6, 1.0, 1e6}) {
    const View view = from_above(4.0 * unit);
    const Image image = bare({{Vec3::Zero(), unit, kGrey}}, view, 200, 200);
    double covered = 0.0;
    for (int i = 0; i < 200 * 200; ++i)
      covered += is_paper(&image.rgb[3 * static_cast<std::size_t>(i)]) ? 0 : 1;
    // Pixels touched by the disc of radius 50: its area and half of the pixels along its border.
    const double disc = kPi * 50.0 * 50.0;
    EXPECT_GT(covered, disc);
    EXPECT_LT(covered, disc + 2.0 * kPi * 50.0);
  }
}

TEST_F(RenderTest, AColouredSphereKeepsItsColourAndFacesTheLight) {
  View view = from_above(4.0);
  view.sun = Vec3::UnitZ();
  const Vec3 color(0.8, 0.4, 0.2);
  const Image image = bare({{Vec3::Zero(), 1.0, color}}, view, 200, 200, Style::fine());
  const std::uint8_t* p = image.pixel(100, 100);
  // Full sunlight and sky on a surface that faces both: 0.8 + 0.42 of white in linear light.
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(p[c], 255.0 * to_srgb(1.22 * to_linear(color[c])), 6.0) << "channel " << c;
  EXPECT_GT(p[1], image.pixel(100, 145)[1]);
}

TEST_F(RenderTest, TheBallInFrontHidesTheOneBehind) {
  const Ball front{Vec3(0, 0, 3), 1.0, Vec3(1, 0, 0), 0}, behind{Vec3(0, 0, -3), 1.0, Vec3(0, 0, 1), 1};
  for (const auto& balls : {std::vector<Ball>{front, behind}, std::vector<Ball>{behind, front}}) {
    const Image image = bare(balls, from_above(4.0), 100, 100);
    EXPECT_GT(image.pixel(50, 50)[0], 100);
    EXPECT_LT(image.pixel(50, 50)[2], 10);
  }
}

TEST_F(RenderTest, UpIsUpAndRightIsRight) {
  const Image image = bare({{Vec3(1, 1, 0), 0.5, kGrey}}, from_above(4.0), 100, 100);
  EXPECT_FALSE(is_paper(image.pixel(75, 25)));
  EXPECT_TRUE(is_paper(image.pixel(25, 25)));
  EXPECT_TRUE(is_paper(image.pixel(75, 75)));
}

TEST_F(RenderTest, ABallThrowsAShadow) {
  View view = from_above(4.0);
  view.sun = Vec3(-1, 0, 1);
  const Ball floor{Vec3(0, 0, -30), 29.0, kGrey};
  const Ball stone{Vec3(-1.2, 0, 0.5), 0.4, kGrey};
  const Image lit = bare({floor}, view, 100, 100), shaded = bare({floor, stone}, view, 100, 100);
  // The shadow falls 1.5 to the right of the stone's centre.
  EXPECT_LT(shaded.pixel(57, 50)[0] + 40, lit.pixel(57, 50)[0]);
  EXPECT_NEAR(shaded.pixel(57, 90)[0], lit.pixel(57, 90)[0], 8);
}

TEST_F(RenderTest, LinesSeparateBodiesButNotTheSpheresOfOne) {
  const Ball left{Vec3(-0.3, 0, 0), 1.0, kGrey, 1}, right{Vec3(0.3, 0, 0), 1.0, kGrey, 1};
  Ball other = right;
  other.body = 2;
  View view = from_above(4.0);
  view.sun = Vec3::UnitZ();
  const auto darkest = [&](const Image& image) {
    int value = 255;
    for (int x = 80; x < 120; ++x) value = std::min<int>(value, image.pixel(x, 100)[0]);
    return value;
  };
  EXPECT_LT(darkest(bare({left, other}, view, 200, 200)), darkest(bare({left, right}, view, 200, 200)) - 10);
}

TEST_F(RenderTest, SameBytesForAnyNumberOfThreads) {
  const std::vector<Ball> balls = heap(300, 1.0);
  const View view = frame(balls);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const Image one = bare(balls, view, 150, 110);
  omp_set_num_threads(2);
  const Image two = bare(balls, view, 150, 110);
  omp_set_num_threads(before);
  EXPECT_EQ(one, two);
}

TEST_F(RenderTest, PerspectiveMagnifiesWhatIsNear) {
  View view = from_above(8.0);
  view.field_of_view = 40.0;
  const auto width_at = [&](double z) {
    const Image image = bare({{Vec3(0, 0, z), 1.0, kGrey}}, view, 200, 200);
    int count = 0;
    for (int x = 0; x < 200; ++x) count += is_paper(image.pixel(x, 100)) ? 0 : 1;
    return count;
  };
  // Eye at 4 / tan(20 degrees) = 10.99; a sphere's outline is that of its tangent cone.
  const double eye = 4.0 / std::tan(20.0 * kPi / 180.0);
  for (const double z : {-3.0, 0.0, 3.0}) {
    const double d = eye - z;
    EXPECT_NEAR(width_at(z), 2.0 * 25.0 * eye / std::sqrt(d * d - 1.0), 2.0) << "z = " << z;
  }
}

TEST_F(RenderTest, FramingSeesAllBallsOrLeavesFarOnesOut) {
  std::vector<Ball> balls = heap(200, 1e-3);
  const View near = frame(balls);
  const Mat3 camera = camera_frame(near);
  for (const Ball& ball : balls) {
    const Vec3 place = camera * (ball.center - near.target);
    EXPECT_LE(std::abs(place.x()) + ball.radius, 0.5 * near.width);
    EXPECT_LE(std::abs(place.y()) + ball.radius, 0.5 * near.height);
  }
  balls.push_back({Vec3(1e9, 0, 0), 1e-3, kGrey});
  EXPECT_GT(frame(balls).width, 1e8);
  EXPECT_LT(frame(balls, {}, {.fraction = 0.99}).width, 1.01 * near.width);
  // The far one costs the near ones no precision.
  EXPECT_EQ(bare(balls, near, 100, 80), bare({balls.begin(), balls.end() - 1}, near, 100, 80));
}

TEST_F(RenderTest, ScaleBarHasItsLengthInPixels) {
  const View view = from_above(100.0);
  Annotation annotation;
  const int width = 400, height = 400;
  const Rectangle room = free_room(annotation, width, height);
  const double scale = pixels_per_metre(view, room);
  const Image image = draw({}, view, annotation, width, height);
  int longest = 0;
  for (int y = height / 2; y < height; ++y) {
    for (int x = 0, run = 0; x < width; ++x) {
      run = image.pixel(x, y)[0] < 40 ? run + 1 : 0;
      longest = std::max(longest, run);
    }
  }
  EXPECT_NEAR(longest, scale * scale_bar_length(0.26 * width / scale), 1.0);
  EXPECT_NEAR(scale_bar_length(0.26 * width / scale), 20.0, 1e-12);
}

TEST_F(RenderTest, LengthsAreRoundAndInTheUnitThatSuits) {
  EXPECT_DOUBLE_EQ(scale_bar_length(99.0), 50.0);
  EXPECT_DOUBLE_EQ(scale_bar_length(0.021), 0.02);
  EXPECT_DOUBLE_EQ(scale_bar_length(1.0), 1.0);
  EXPECT_EQ(length_label(5000.0), "5 km");
  EXPECT_EQ(length_label(200.0), "200 m");
  EXPECT_EQ(length_label(0.01), "1 cm");
  EXPECT_EQ(length_label(2e-3), "2 mm");
  EXPECT_EQ(length_label(2e-5), "20 \u00b5m");
  EXPECT_EQ(round_ticks(-1.0, 1.0, 5), (std::vector<double>{-1.0, -0.5, 0.0, 0.5, 1.0}));
}

TEST_F(RenderTest, WhatIsNotFiniteIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const View view = from_above(4.0);
  EXPECT_THROW(bare({{Vec3(0, nan, 0), 1.0, kGrey}}, view, 20, 20), InputError);
  EXPECT_THROW(bare({{Vec3::Zero(), nan, kGrey}}, view, 20, 20), InputError);
  EXPECT_THROW(bare({{Vec3::Zero(), 0.0, kGrey}}, view, 20, 20), InputError);
  EXPECT_THROW(bare({{Vec3::Zero(), 1.0, Vec3(0, 0, nan)}}, view, 20, 20), InputError);
  EXPECT_THROW(bare({}, from_above(nan), 20, 20), InputError);
  EXPECT_THROW(bare({}, view, 0, 20), InputError);
  EXPECT_THROW(frame({}), InputError);
  Annotation annotation;
  annotation.color_bar = ColorBar{"p (Pa)", 1.0, 1.0};
  EXPECT_THROW(draw({}, view, annotation, 100, 100), InputError);
}

TEST_F(RenderTest, PngComesBackByteForByte) {
  const std::vector<Ball> balls = heap(50, 1.0);
  Annotation annotation{"Title", {"t = 1 h", "line two"}, true, {}, ColorBar{"v (m/s)", 0.0, 3.0}};
  for (std::size_t i = 0; i < kCategoryColors; ++i)
    annotation.key.push_back({"shape " + std::to_string(i), category_color(i)});
  const Image image = draw(balls, frame(balls), annotation, 300, 240, Style::draft(Background::dark));
  const fs::path path = folder_ / "picture.png";
  write_png(image, path);
  const Surface surface(cairo_image_surface_create_from_png(path.c_str()));
  ASSERT_EQ(cairo_surface_status(surface.get()), CAIRO_STATUS_SUCCESS);
  EXPECT_EQ(to_image(surface.get()), image);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
  EXPECT_THROW(write_png(image, folder_ / "no" / "such" / "folder.png"), InputError);
}

TEST_F(RenderTest, PanelsStandSideBySide) {
  const Image red = Image::filled(10, 20, Vec3(1, 0, 0)), blue = Image::filled(30, 10, Vec3(0, 0, 1));
  const Image row = side_by_side({red, blue}, 4);
  EXPECT_EQ(row.width, 44);
  EXPECT_EQ(row.height, 20);
  EXPECT_EQ(row.pixel(9, 0)[2], 0);
  EXPECT_TRUE(is_paper(row.pixel(12, 10)));
  EXPECT_EQ(row.pixel(14, 10)[0], 0);
  EXPECT_TRUE(is_paper(row.pixel(14, 2)));
  EXPECT_EQ(stacked({row, key_strip({{"cube", kGrey}}, 44, 8.0)}).width, 44);
  EXPECT_THROW(side_by_side({}), InputError);
}

TEST_F(RenderTest, ShapeSheetIsWritten) {
  const Shape pair{"pair", "", {Vec3(-0.5, 0, 0), Vec3(0.5, 0, 0)}, {1.0, 1.0}};
  render_shape_sheet({pair, pair}, folder_ / "sheet.png", Style::draft());
  EXPECT_GT(fs::file_size(folder_ / "sheet.png"), 1000u);
  EXPECT_THROW(render_shape_sheet({}, folder_ / "none.png"), InputError);
}

TEST_F(RenderTest, ColoursOfIdsAndScalars) {
  EXPECT_EQ(id_color(7), id_color(7));
  EXPECT_NE(id_color(7), id_color(8));
  for (std::uint64_t i = 0; i < 200; ++i) {
    EXPECT_GE(id_color(i).minCoeff(), 0.0);
    EXPECT_LE(id_color(i).maxCoeff(), 1.0);
  }
  // Luminance grows along the scalar map.
  const auto luminance = [](double t) {
    const Vec3 c = scalar_color(t);
    return 0.2126 * to_linear(c.x()) + 0.7152 * to_linear(c.y()) + 0.0722 * to_linear(c.z());
  };
  for (double t = 0.0; t < 0.99; t += 0.02) EXPECT_LT(luminance(t), luminance(t + 0.02));
}

TEST_F(RenderTest, FilmOfOddSizeInAFolderWithQuotes) {
  const std::vector<Image> frames(5, Image::filled(65, 33, Vec3(0.2, 0.5, 0.8)));
  const fs::path path = folder_ / "it's a: film.mp4";
  try {
    write_film(frames, path, 25.0);
  } catch (const InputError& error) {
    if (std::string(error.what()).find("not installed") != std::string::npos) GTEST_SKIP() << error.what();
    throw;
  }
  EXPECT_GT(fs::file_size(path), 500u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(RenderTest, FilmThatCannotBeMadeSaysWhyAndLeavesNothing) {
  EXPECT_THROW(Film(folder_ / "no" / "folder.mp4", 64, 64), InputError);
  EXPECT_THROW(write_film({}, folder_ / "film.mp4"), InputError);
  const char* found = std::getenv("PATH");
  const std::string path = found ? found : "";
  ::setenv("PATH", folder_.c_str(), 1);
  std::string words;
  try {
    const Film film(folder_ / "film.mp4", 64, 64);
  } catch (const InputError& error) {
    words = error.what();
  }
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_NE(words.find("ffmpeg is not installed"), std::string::npos) << words;
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(RenderTest, DeadFfmpegIsAnErrorAndNoSignal) {
  const fs::path fake = folder_ / "bin" / "ffmpeg";
  fs::create_directories(fake.parent_path());
  fs::create_symlink("/bin/false", fake);
  const char* found = std::getenv("PATH");
  const std::string path = found ? found : "";
  ::setenv("PATH", fake.parent_path().c_str(), 1);
  const Image frame = Image::filled(640, 480, kGrey);
  EXPECT_THROW(write_film(std::vector<Image>(8, frame), folder_ / "film.mp4"), InputError);
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);  // only the false ffmpeg
}

}  // namespace
}  // namespace cairn::render
