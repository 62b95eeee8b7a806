#include "integration/tools/files/bytes.hpp"
#include "integration/tools/files/capture.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "integration/tools/files/exr.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/test_folder.hpp"
#include "tests/support/text_file.hpp"

#include <cmath>
#include <filesystem>
#include <tuple>

namespace dermis::tools {
namespace {

namespace fs = std::filesystem;

struct Captures : ::testing::Test {
  const dermis::test::TestFolder temporary;
  const fs::path& root = temporary.path();
  fs::path shipped = fs::path(DERMIS_SOURCE_DIR) / "configs" / "profiles";
  std::string error;
  Diagnostics diagnostics;

  // Returns 6 x 4 pixels with profile 1 on the left half and every picture.
  static CapturedFrame sample() {
    CapturedFrame frame;
    FrameDescription& d = frame.description;
    d.width = 6;
    d.height = 4;
    d.render = {1, 0, 5, 4};
    d.perspective = true;
    d.clip_from_view = {1.1, 0, 0, 0, 0, -1.7, 0, 0, 0, 0, 0, 0.1, 0, 0, -1, 0};
    d.previous_clip_from_view = d.clip_from_view;
    d.view_from_world = {1, 0, 0, 0.1, 0, 1, 0, 1.0 / 3, 0, 0, 1, -2, 0, 0, 0, 1};
    d.previous_view_from_world = d.view_from_world;
    d.previous_view_from_world[3] = 0.2;
    d.metres_per_unit = 0.01;
    d.jitter_px = {0.25, -0.125};
    d.frame_index = 12345678901;
    d.cut = true;
    d.exposure = 0.7;
    CaptureProfile skin;
    skin.id = 3;
    skin.profile.name = "inline";
    skin.profile.dmfp_mm = {3.67, 1.37, 0.68};
    skin.profile.albedo = {0.44, 0.22, 0.13};
    subsurface::derive(skin.profile);
    d.profiles = {skin};
    complete_projection(d, frame.rays);
    auto fill = [](uint32_t channels, float first) {
      Image image = Image::sized(6, 4, channels);
      for (size_t i = 0; i < image.values.size(); ++i)
        image.values[i] = first + float(i) / 64;
      return image;
    };
    frame.lighting = fill(3, 0);
    frame.depth = fill(1, 2);
    frame.albedo = fill(3, 0);
    frame.normal = fill(3, -0.5f);
    frame.velocity = fill(2, -0.25f);
    frame.scatter_scale = fill(1, 0);
    frame.specular = fill(3, 1);
    frame.thickness = fill(1, 0);
    frame.back_lighting = fill(3, 0.5f);
    frame.profile = {3, 3, 3, 0, 0, 0, 3, 3, 3, 0, 0, 0, 3, 3, 3, 0, 0, 0, 3, 3, 3, 0, 0, 0};
    return frame;
  }

  fs::path write(const CapturedFrame& frame, const std::string& name = "capture") {
    CaptureWriter writer;
    const bool written = writer.begin(root / name, error) && writer.add(frame, error);
    EXPECT_TRUE(written && writer.finish(error)) << error;
    return root / name / "frame_0000";
  }
  // Replaces a part of frame.json.
  void change(const fs::path& frame, const std::string& from, const std::string& to) {
    const fs::path file = frame / "frame.json";
    ASSERT_TRUE(write_text(file, test::replaced(test::read_text(file), from, to), error));
  }
  std::string messages() const {
    std::string all;
    for (const Diagnostic& one : diagnostics.list)
      all += format_for_people(diagnostics, one) + "\n";
    return all;
  }
  // Expects that reading fails with this diagnostic and text at this JSON pointer.
  void expect_rejected(const fs::path& frame, DiagnosticId id, const std::string& pointer,
                       const std::string& text) {
    EXPECT_FALSE(read_frame(frame, shipped, diagnostics));
    ASSERT_FALSE(diagnostics.list.empty());
    EXPECT_EQ(diagnostics.count(Severity::error), 1u) << messages();
    EXPECT_EQ(diagnostics.list[0].id, id) << messages();
    EXPECT_EQ(diagnostics.list[0].where.pointer, pointer) << messages();
    EXPECT_GT(diagnostics.list[0].where.line, 0u);
    EXPECT_THAT(messages(), HasAll(text, "frame.json:"));
  }
};

TEST_F(Captures, RoundTripIsBitForBit) {
  const CapturedFrame frame = sample();
  write(frame);
  const auto frames = find_frames(root / "capture", diagnostics);
  ASSERT_EQ(frames.size(), 1u);
  const auto back = read_frame(frames[0], shipped, diagnostics);
  ASSERT_TRUE(back && diagnostics.list.empty()) << messages();
  const auto numbers = [](const FrameDescription& d) {
    return std::tuple(d.clip_from_view, d.view_from_world, d.previous_view_from_world, d.jitter_px,
                      d.frame_index, d.cut, d.exposure, d.metres_per_unit);
  };
  EXPECT_EQ(std::pair(back->description.render.x, back->description.render.width),
            std::pair(1u, 5u));
  EXPECT_EQ(numbers(back->description), numbers(frame.description));
  ASSERT_TRUE(back->description.profiles.size() == 1 && back->description.profiles[0].id == 3);
  EXPECT_EQ(back->description.profiles[0].profile.d_mm, frame.description.profiles[0].profile.d_mm);
  EXPECT_EQ(back->rays.offset_x, frame.rays.offset_x);
  EXPECT_EQ(back->profile, frame.profile);
  for (Image CapturedFrame::*image :
       {&CapturedFrame::lighting, &CapturedFrame::depth, &CapturedFrame::albedo,
        &CapturedFrame::normal, &CapturedFrame::velocity, &CapturedFrame::scatter_scale,
        &CapturedFrame::specular, &CapturedFrame::thickness, &CapturedFrame::back_lighting})
    EXPECT_EQ(((*back).*image).values, (frame.*image).values);
}

TEST_F(Captures, ThicknessAndBackLightingComeTogether) {
  const fs::path frame = write(sample());
  fs::remove(frame / "back_lighting.exr");
  expect_rejected(frame, DiagnosticId::capture_picture, "",
                  "'thickness.exr' and 'back_lighting.exr'");
}

TEST_F(Captures, TransmissionAddsToTheReferencesLight) {
  CapturedFrame frame = sample();
  frame.scatter_scale = {};
  const ReferenceFrame without = make_reference_frame(frame);
  ReferenceFrame with = without;
  add_transmission(frame, with);
  const auto& shape = without.shapes[3];
  bool some = false;
  for (size_t i = 0; i < without.profile.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const double added = double(with.light[3 * i + c]) - double(without.light[3 * i + c]);
      if (without.profile[i] == 0) {
        EXPECT_EQ(added, 0);
        continue;
      }
      some = true;
      const size_t y = i / without.width + frame.description.render.y;
      const size_t at =
          y * frame.description.width + i % without.width + frame.description.render.x;
      const double expected =
          dermis::subsurface::shape_survival(shape[c], double(frame.thickness.values[at])) *
          double(frame.back_lighting.values[3 * at + c]);
      const double rounding = 1e-6 + 1e-7 * double(without.light[3 * i + c]); // fp32 sums
      EXPECT_NEAR(added, expected, rounding) << i;
    }
  EXPECT_TRUE(some);
}

TEST_F(Captures, HandMadeOrthographicFramesAreExact) {
  CapturedFrame frame = sample();
  frame.description.perspective = false;
  frame.description.pixel_pitch_m = 1e-3;
  frame.description.render = {0, 0, 6, 4};
  frame.description.jitter_px = {0, 0};
  const auto back = read_frame(write(frame), shipped, diagnostics);
  ASSERT_TRUE(back) << messages();
  EXPECT_FALSE(back->rays.perspective);
  EXPECT_NEAR(back->rays.scale_x, 1e-3, 1e-18);
  EXPECT_NEAR(back->rays.scale_y, -1e-3, 1e-18);
  EXPECT_NEAR(back->rays.offset_x, -2.5e-3, 1e-18);
  EXPECT_NEAR(back->rays.offset_y, 1.5e-3, 1e-18);
}

TEST_F(Captures, OnlyOptionalPicturesMayBeAbsent) {
  CapturedFrame frame = sample();
  frame.albedo = frame.normal = frame.velocity = frame.scatter_scale = frame.specular = {};
  frame.thickness = frame.back_lighting = {};
  const fs::path folder = write(frame);
  const auto back = read_frame(folder, shipped, diagnostics);
  ASSERT_TRUE(back) << messages();
  EXPECT_TRUE(back->albedo.values.empty());
  for (const char* name : {"lighting.exr", "depth.exr", "profile.exr"}) {
    const fs::path again = write(frame, name);
    fs::remove(again / name);
    diagnostics = {};
    expect_rejected(again, DiagnosticId::capture_picture, "", name);
  }
}

TEST_F(Captures, FrameInTheFolderItselfIsOneFrame) {
  const fs::path folder = write(sample());
  EXPECT_EQ(find_frames(folder, diagnostics), std::vector<fs::path>{folder});
}

TEST_F(Captures, FramesAreOrderedByName) {
  CaptureWriter writer;
  ASSERT_TRUE(writer.begin(root / "many", error));
  for (uint64_t i = 0; i < 12; ++i) {
    CapturedFrame frame = sample();
    frame.description.frame_index = i;
    ASSERT_TRUE(writer.add(frame, error)) << error;
  }
  EXPECT_FALSE(fs::exists(root / "many")); // Not before the capture is complete.
  ASSERT_TRUE(writer.finish(error)) << error;
  const auto frames = find_frames(root / "many", diagnostics);
  ASSERT_EQ(frames.size(), 12u);
  for (uint64_t i = 0; i < 12; ++i)
    EXPECT_EQ(read_frame(frames[i], shipped, diagnostics)->description.frame_index, i);
}

TEST_F(Captures, EmptyOrMissingFoldersAreRejected) {
  EXPECT_TRUE(find_frames(root, diagnostics).empty());
  EXPECT_TRUE(find_frames(root / "none", diagnostics).empty());
  ASSERT_EQ(diagnostics.list.size(), 2u);
  EXPECT_EQ(diagnostics.list[0].id, DiagnosticId::capture_empty);
  EXPECT_THAT(messages(), HasSubstr("none"));
}

TEST_F(Captures, UnfinishedCaptureLeavesNothing) {
  {
    CaptureWriter writer;
    ASSERT_TRUE(writer.begin(root / "a", error));
    ASSERT_TRUE(writer.add(sample(), error));
  }
  EXPECT_TRUE(fs::is_empty(root));
}

TEST_F(Captures, OnlyACaptureIsReplaced) {
  write(sample());
  CapturedFrame changed = sample();
  changed.description.frame_index = 5;
  EXPECT_EQ(read_frame(write(changed), shipped, diagnostics)->description.frame_index, 5u);
  EXPECT_EQ(std::distance(fs::directory_iterator(root), {}), 1);
  fs::create_directories(root / "thesis");
  ASSERT_TRUE(write_text(root / "thesis" / "chapter.txt", "years of work", error));
  CaptureWriter writer;
  EXPECT_FALSE(writer.begin(root / "thesis", error));
  EXPECT_THAT(error, HasSubstr("thesis"));
  EXPECT_TRUE(fs::exists(root / "thesis" / "chapter.txt"));
}

TEST_F(Captures, DamagedValuesAreRepairedAndReported) {
  CapturedFrame frame = sample();
  frame.lighting.values[0] = NAN;
  frame.lighting.values[1] = INFINITY;
  frame.lighting.values[2] = -1;
  frame.lighting.values[3 * 4] = NAN; // No profile there: the pixel does not count.
  frame.depth.values[1] = -3;
  frame.normal.values[0] = -1; // Normals may point in any direction.
  const auto back = read_frame(write(frame), shipped, diagnostics);
  ASSERT_TRUE(back) << messages();
  EXPECT_EQ(back->sanitised.not_finite, 2u);
  EXPECT_EQ(back->sanitised.negative, 2u);
  for (const float value : back->lighting.values)
    EXPECT_TRUE(std::isfinite(value) && value >= 0);
  EXPECT_EQ(back->depth.values[1], 0);
  EXPECT_EQ(back->normal.values[0], -1);
  ASSERT_EQ(diagnostics.list.size(), 2u);
  EXPECT_EQ(diagnostics.list[0].id, DiagnosticId::capture_sanitised);
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_THAT(messages(), AllOf(HasSubstr("lighting.exr': 2 val"), HasSubstr("depth.exr': 0 val")));
}

TEST_F(Captures, LightThatGraphsClampIsReported) {
  CapturedFrame frame = sample();
  frame.lighting.values[0] = 70000;
  frame.lighting.values[1] = 2e5f;          // The same pixel.
  frame.back_lighting.values[3 * 2] = 1e5f; // Another pixel.
  frame.lighting.values[3 * 1] = 65504;     // Within the limit.
  frame.lighting.values[3 * 4] = 1e6f;      // No profile there.
  const auto back = read_frame(write(frame), shipped, diagnostics);
  ASSERT_TRUE(back) << messages();
  EXPECT_EQ(back->lighting.values, frame.lighting.values);
  ASSERT_EQ(diagnostics.list.size(), 2u);
  EXPECT_EQ(diagnostics.list[0].id, DiagnosticId::capture_sanitised);
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_THAT(messages(), AllOf(HasSubstr("/lighting.exr': light of 1"), HasSubstr("200000"),
                                HasSubstr("/back_lighting.exr': light of 1")));
}

TEST_F(Captures, PicturesOfAnotherSizeAreRejected) {
  const fs::path folder = write(sample());
  ASSERT_TRUE(write_exr(folder / "albedo.exr", Image::sized(5, 4, 3), {"R", "G", "B"}, error));
  expect_rejected(folder, DiagnosticId::capture_picture_size, "/width", "5 x 4");
}

TEST_F(Captures, PicturesWithOtherChannelsAreRejected) {
  const fs::path folder = write(sample());
  ASSERT_TRUE(write_exr(folder / "lighting.exr", Image::sized(6, 4, 1), {"Y"}, error));
  expect_rejected(folder, DiagnosticId::capture_picture, "", "R,G,B");
}

TEST_F(Captures, ProfileIdsAreWholeNumbers) {
  const fs::path folder = write(sample());
  Image ids = Image::sized(6, 4, 1);
  ids.values[7] = 0.5f;
  ASSERT_TRUE(write_exr(folder / "profile.exr", ids, {"id"}, error));
  expect_rejected(folder, DiagnosticId::capture_profile, "/profiles", "0.5 at pixel (1, 1)");
}

TEST_F(Captures, ProfilesCanBeFiles) {
  const fs::path folder = write(sample());
  const std::string inline_profile =
      "\"dmfp_mm\": [3.67, 1.37, 0.68], \"albedo\": [0.44, 0.22, 0.13]";
  change(folder, inline_profile, "\"file\": \"skin\"");
  auto frame = read_frame(folder, shipped, diagnostics);
  ASSERT_TRUE(frame) << messages();
  EXPECT_EQ(frame->description.profiles[0].profile.name, "skin");
  change(folder, "\"file\": \"skin\"", "\"file\": \"own.json\"");
  expect_rejected(folder, DiagnosticId::capture_profile, "/profiles/0/file", "own.json");
  fs::copy_file(shipped / "wax.json", folder / "own.json");
  diagnostics = {};
  frame = read_frame(folder, shipped, diagnostics);
  ASSERT_TRUE(frame) << messages();
  EXPECT_EQ(frame->description.profiles[0].profile.name, "wax");
}

TEST_F(Captures, NothingOutsideTheirFolderIsRead) {
  const fs::path folder = write(sample());
  const std::string inline_profile =
      "\"dmfp_mm\": [3.67, 1.37, 0.68], \"albedo\": [0.44, 0.22, 0.13]";
  fs::copy_file(shipped / "wax.json", root / "wax.json");
  std::string before = inline_profile;
  for (const std::string& outside : {std::string("../../wax.json"), (root / "wax.json").string(),
                                     std::string("link/wax.json")}) {
    diagnostics = {};
    if (outside.starts_with("link")) fs::create_directory_symlink(root, folder / "link");
    change(folder, before, "\"file\": \"" + outside + "\"");
    before = "\"file\": \"" + outside + "\"";
    expect_rejected(folder, DiagnosticId::outside_root, "/profiles/0/file",
                    "outside the readable folders");
    diagnostics = {};
    EXPECT_TRUE(read_frame(folder, shipped, diagnostics, std::vector{root.string()})) << messages();
  }
}

TEST_F(Captures, LinksOutOfTheFolderAreRejected) {
  const fs::path folder = write(sample()), other = write(sample(), "other");
  fs::remove(folder / "lighting.exr");
  fs::create_symlink(other / "lighting.exr", folder / "lighting.exr");
  expect_rejected(folder, DiagnosticId::outside_root, "", "lighting.exr");
  diagnostics = {};
  EXPECT_TRUE(read_frame(folder, shipped, diagnostics, std::vector{(root / "other").string()}))
      << messages();
  fs::rename(folder / "albedo.exr", folder / "here.exr");
  fs::create_symlink("here.exr", folder / "albedo.exr"); // The link's target is inside.
  fs::remove(folder / "lighting.exr");
  fs::copy_file(other / "lighting.exr", folder / "lighting.exr");
  diagnostics = {};
  EXPECT_TRUE(read_frame(folder, shipped, diagnostics)) << messages();

  fs::create_directory_symlink(other, root / "capture" / "frame_0001");
  diagnostics = {};
  EXPECT_TRUE(find_frames(root / "capture", diagnostics).empty());
  ASSERT_EQ(diagnostics.list.size(), 1u);
  EXPECT_EQ(diagnostics.list[0].id, DiagnosticId::outside_root);
  EXPECT_EQ(
      find_frames(root / "capture", diagnostics, std::vector{(root / "other").string()}).size(),
      2u);
}

// Returns the frame in a left-handed view space: z of every view position and normal has the other
// sign.
CapturedFrame left_handed(CapturedFrame frame) {
  FrameDescription& d = frame.description;
  for (subsurface::Matrix4* clip : {&d.clip_from_view, &d.previous_clip_from_view})
    *clip = subsurface::with_mirrored_view(*clip);
  for (subsurface::Matrix4* view : {&d.view_from_world, &d.previous_view_from_world})
    for (size_t c = 0; c < 4; ++c)
      (*view)[8 + c] = -(*view)[8 + c];
  for (size_t i = 2; i < frame.normal.values.size(); i += 3)
    frame.normal.values[i] = -frame.normal.values[i];
  return frame;
}

// Reads `folder` and expects the matrices, rays and normals of `right`.
void expect_read_as(const std::optional<CapturedFrame>& read, const CapturedFrame& right) {
  ASSERT_TRUE(read);
  const FrameDescription &d = read->description, &stated = right.description;
  EXPECT_EQ(d.clip_from_view, stated.clip_from_view);
  EXPECT_EQ(d.view_from_world, stated.view_from_world);
  EXPECT_EQ(d.previous_clip_from_view, stated.previous_clip_from_view);
  EXPECT_EQ(d.previous_view_from_world, stated.previous_view_from_world);
  EXPECT_EQ(read->rays.scale_y, right.rays.scale_y);
  EXPECT_EQ(read->rays.offset_x, right.rays.offset_x);
  EXPECT_EQ(read->normal.values, right.normal.values);
}

TEST_F(Captures, LeftHandedFramesAreMirrored) {
  CapturedFrame right = sample();
  const fs::path seen = write(left_handed(right), "perspective");
  expect_read_as(read_frame(seen, shipped, diagnostics), right);
  change(seen, "\"perspective\"", "\"perspective\", \"view_space\": \"left_handed\"");
  expect_read_as(read_frame(seen, shipped, diagnostics), right);

  right.description.perspective = false;
  right.description.clip_from_view = {1.1, 0, 0, 0.1, 0, -1.7, 0, 0, 0, 0, -0.1, -0.05, 0, 0, 0, 1};
  right.description.previous_clip_from_view = right.description.clip_from_view;
  complete_projection(right.description, right.rays);
  const fs::path flat = write(left_handed(right), "orthographic");
  change(flat, "\"orthographic\"", "\"orthographic\", \"view_space\": \"left_handed\"");
  expect_read_as(read_frame(flat, shipped, diagnostics), right);

  // A pixel pitch has no handedness; the other matrices have the handedness of the file.
  right.description.pixel_pitch_m = 1e-3;
  complete_projection(right.description, right.rays);
  right.description.previous_clip_from_view = right.description.clip_from_view;
  const fs::path pitch = write(left_handed(right), "pitch");
  change(pitch, "\"orthographic\"", "\"orthographic\", \"view_space\": \"left_handed\"");
  expect_read_as(read_frame(pitch, shipped, diagnostics), right);
  EXPECT_TRUE(diagnostics.list.empty()) << messages();
}

TEST_F(Captures, ContradictingViewSpacesAreRejected) {
  const auto declare = [&](const fs::path& frame, const char* projection, const char* space) {
    change(frame, std::string("\"") + projection + "\"",
           std::string("\"") + projection + "\", \"view_space\": \"" + space + "\"");
  };
  CapturedFrame frame = sample();
  const auto rejected = [&](const fs::path& folder, const char* pointer, const char* text) {
    diagnostics = {};
    expect_rejected(folder, DiagnosticId::capture_projection, pointer, text);
    EXPECT_THAT(messages(), HasSubstr("\"view_space\": \"left_handed\""));
  };
  const fs::path right = write(frame, "right");
  declare(right, "perspective", "left_handed");
  rejected(right, "/clip_from_view", "declared left-handed, but clip_from_view has w = -z");
  const fs::path left = write(left_handed(frame), "left");
  declare(left, "perspective", "right_handed");
  rejected(left, "/clip_from_view", "declared right-handed, but clip_from_view has w = z");
  frame.description.previous_clip_from_view =
      subsurface::with_mirrored_view(frame.description.previous_clip_from_view);
  rejected(write(frame, "mixed"), "/previous_clip_from_view", "previous_clip_from_view has w = z");
  frame.description.perspective = false;
  frame.description.clip_from_view = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0.1, -0.05, 0, 0, 0, 1};
  frame.description.previous_clip_from_view = frame.description.clip_from_view;
  rejected(write(frame, "behind"), "/clip_from_view", "only points behind the camera");
}

struct WrongFrame {
  const char* name;
  const char *from, *to; // Part of frame.json.
  DiagnosticId id;
  const char *pointer, *text;
  friend void PrintTo(const WrongFrame& one, std::ostream* out) { *out << one.name; }
};
struct WrongFrames : Captures, ::testing::WithParamInterface<WrongFrame> {};

TEST_P(WrongFrames, AreRejectedWithThePlace) {
  const WrongFrame& wrong = GetParam();
  const fs::path folder = write(sample());
  change(folder, wrong.from, wrong.to);
  expect_rejected(folder, wrong.id, wrong.pointer, wrong.text);
}

const WrongFrame wrong_frames[] = {
    {"ProfileIdNotListed", R"("id": 3)", R"("id": 4)", DiagnosticId::capture_profile, "/profiles",
     "12 pixels have profile 3, which 'profiles' does not list; the first is at (0, 0)"},
    {"DuplicateProfileId", R"("profiles": [)", R"("profiles": [ { "id": 3, "file": "skin" },)",
     DiagnosticId::capture_profile, "/profiles/1/id", "declared twice"},
    {"NotAProjection", "[1.1, 0, 0, 0", "[1.1, 0.5, 0, 0", DiagnosticId::capture_projection,
     "/clip_from_view", "axis-aligned perspective"},
    {"NoPreviousProjection", R"("previous_clip_from_view": [1.1, 0)",
     R"("previous_clip_from_view": [1.1, 0.5)", DiagnosticId::capture_projection,
     "/previous_clip_from_view", "axis-aligned projection"},
    {"SingularView", R"("view_from_world": [1, 0)", R"("view_from_world": [0, 0)",
     DiagnosticId::capture_projection, "/view_from_world", "no inverse"},
    {"SingularPreviousView", R"("previous_view_from_world": [1, 0)",
     R"("previous_view_from_world": [0, 0)", DiagnosticId::capture_projection,
     "/previous_view_from_world", "no inverse"},
    {"ProjectionTypeAgainstTheMatrix", R"("perspective")", R"("orthographic")",
     DiagnosticId::capture_projection, "/clip_from_view", "axis-aligned orthographic"},
    {"PixelPitchAndMatrix", R"("perspective")", R"("orthographic", "pixel_pitch_m": 0.001)",
     DiagnosticId::capture_projection, "/pixel_pitch_m", "give one"},
    {"RectangleOutside", "[1, 0, 5, 4]", "[2, 0, 5, 4]", DiagnosticId::capture_rectangle,
     "/render_rectangle", "inside 6 x 4"},
    {"UnknownKey", R"("exposure")", R"("exposur")", DiagnosticId::unknown_key, "/exposur",
     "exposure"},
    {"NewerVersion", R"("dermis_capture": 1)", R"("dermis_capture": 2)",
     DiagnosticId::unsupported_version, "/dermis_capture", "2"},
    {"NoWidth", R"("width": 6)", R"("width": 0)", DiagnosticId::out_of_range, "/width", "width"},
};
INSTANTIATE_TEST_SUITE_P(Captures, WrongFrames, ::testing::ValuesIn(wrong_frames),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_F(Captures, ReferenceUsesOnlyTheRenderedPart) {
  const CapturedFrame frame = sample();
  const ReferenceFrame reference = make_reference_frame(frame);
  EXPECT_EQ(reference.width, 5u);
  EXPECT_EQ(reference.light.size(), 60u);
  EXPECT_EQ(reference.light[0], frame.lighting.at(1, 0, 0));
  EXPECT_EQ(reference.depth[5], frame.depth.at(1, 1, 0));
  EXPECT_EQ(reference.profile[0], 3);
  EXPECT_NEAR(reference.d_m[3][0], frame.description.profiles[0].profile.d_mm[0] * 1e-3, 1e-15);
  EXPECT_EQ(subsurface::reference_everywhere(reference.input()).size(), 60u);
}

} // namespace
} // namespace dermis::tools
