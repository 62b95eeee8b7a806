#include "integration/examples/demo_engine/scene/read_scene.hpp"
#include "integration/examples/demo_engine/scene/scene_state.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/test_folder.hpp"

#include <filesystem>
#include <fstream>
#include <string>

namespace demo {
namespace {

using dermis::HasAll;
using dermis::HasSubstr;

// Returns a complete scene with one part replaced.
std::string scene_with(const std::string& camera, const std::string& more = "") {
  return R"({ "dermis_scene": 1, "name": "s",
  "profiles": [ { "name": "skin", "file": "../profiles/skin.json" } ],
  "camera": )" +
         camera + R"(,
  "objects": [ { "shape": "sphere", "profile": "skin" )" +
         more + " } ] }";
}
const std::string plain_camera =
    R"({ "position": [0, 0, 2], "target": [0, 0, 0], "vertical_fov": 30 })";

void expect_rejected(const std::string& text, dermis::DiagnosticId id, uint32_t line,
                     const std::string& words) {
  dermis::Diagnostics diagnostics;
  EXPECT_FALSE(parse_scene("scenes/s.json", text, diagnostics)) << text;
  ASSERT_FALSE(diagnostics.list.empty());
  EXPECT_EQ(diagnostics.list[0].id, id) << diagnostics.list[0].text;
  EXPECT_EQ(diagnostics.list[0].where.line, line);
  EXPECT_THAT(diagnostics.list[0].text, HasSubstr(words));
}

TEST(SceneFile, ShippedScenesAreValid) {
  for (const char* name : {"bust", "head"}) {
    dermis::Diagnostics diagnostics;
    const std::string path = std::string(DERMIS_SOURCE_DIR "/configs/scenes/") + name + ".json";
    const auto scene = read_scene(path, diagnostics);
    ASSERT_TRUE(scene) << dermis::format_as_json(diagnostics);
    EXPECT_EQ(scene->name, name);
    EXPECT_GE(scene->lights.size(), 2u);
  }
}

TEST(SceneFile, ProfilesAreFoundNextToTheScene) {
  dermis::Diagnostics diagnostics;
  const auto scene = parse_scene("a/scenes/s.json", scene_with(plain_camera), diagnostics);
  ASSERT_TRUE(scene) << dermis::format_as_json(diagnostics);
  EXPECT_EQ(scene->profiles[0].file, "a/profiles/skin.json");
  EXPECT_EQ(scene->objects[0].profile, 1u);
}

// Folders next to a secret file, removed afterwards.
struct SceneFolders : ::testing::Test {
  const dermis::test::TestFolder temporary;
  const std::filesystem::path& top = temporary.path();
  void SetUp() override {
    for (const char* folder : {"project/scenes", "project/profiles", "elsewhere"})
      std::filesystem::create_directories(top / folder);
    for (const char* file : {"project/profiles/skin.json", "elsewhere/secret.json"})
      std::ofstream(top / file) << "{}";
    std::filesystem::create_symlink(top / "elsewhere", top / "project/scenes/link");
    std::filesystem::create_symlink(top / "project/profiles", top / "project/scenes/near");
  }
  // Returns a scene in `folder` with the profile `file`.
  static std::string scene_of(const std::string& file) {
    std::string text = scene_with(plain_camera);
    return text.replace(text.find("../profiles/skin.json"), 21, file);
  }
  std::optional<Scene> read(const std::string& folder, const std::string& file,
                            const std::vector<std::string>& roots = {}) {
    diagnostics = {};
    return parse_scene((top / folder / "s.json").string(), scene_of(file), diagnostics, roots);
  }
  dermis::Diagnostics diagnostics;
};

TEST_F(SceneFolders, SceneReadsOnlyInsideItsProject) {
  for (const char* inside :
       {"../profiles/skin.json", "own.json", "near/skin.json", "a/../../profiles/skin.json"})
    EXPECT_TRUE(read("project/scenes", inside)) << inside << dermis::format_as_json(diagnostics);
  EXPECT_TRUE(read("project/scenes", (top / "project/profiles/skin.json").string()));
  const std::string secret = (top / "elsewhere/secret.json").string();
  for (const std::string& outside :
       {std::string("../../elsewhere/secret.json"), std::string("link/secret.json"), secret,
        std::string("/etc/passwd"), std::string("../../elsewhere/not_there.json"),
        std::string("a/../../../../../../../../../../etc/passwd")}) {
    EXPECT_FALSE(read("project/scenes", outside)) << outside;
    ASSERT_EQ(diagnostics.list.size(), 1u) << outside;
    const dermis::Diagnostic& one = diagnostics.list[0];
    EXPECT_EQ(one.id, dermis::DiagnosticId::outside_root) << outside;
    EXPECT_EQ(one.where.line, 2u);
    EXPECT_EQ(one.where.column, 43u);
    EXPECT_EQ(one.where.pointer, "/profiles/0/file");
    EXPECT_THAT(one.text, HasAll("outside the readable folders", (top / "project").string()));
    EXPECT_THAT(dermis::format_for_people(diagnostics, one), HasSubstr("--root"));
  }
}

TEST_F(SceneFolders, SceneWithoutProject_ReadsInItsFolder) {
  EXPECT_TRUE(read("elsewhere", "secret.json"));
  EXPECT_FALSE(read("elsewhere", "../project/profiles/skin.json"));
  ASSERT_FALSE(diagnostics.list.empty());
  EXPECT_EQ(diagnostics.list[0].id, dermis::DiagnosticId::outside_root);
  EXPECT_TRUE(
      read("elsewhere", "../project/profiles/skin.json", {(top / "project").string() + "/"}));
}

TEST_F(SceneFolders, NonPortableNamesAreRejected) {
  EXPECT_FALSE(read("project/scenes", ""));
  ASSERT_FALSE(diagnostics.list.empty());
  EXPECT_EQ(diagnostics.list[0].id, dermis::DiagnosticId::outside_root);
  EXPECT_FALSE(read("project/scenes", std::string(5000, 'a')));
  ASSERT_FALSE(diagnostics.list.empty());
  EXPECT_EQ(diagnostics.list[0].id, dermis::DiagnosticId::outside_root);
  EXPECT_FALSE(read("project/scenes", R"(../profiles/skin.json\u0000.png)"));
  ASSERT_FALSE(diagnostics.list.empty());
  EXPECT_EQ(diagnostics.list[0].id, dermis::DiagnosticId::syntax);
}

TEST(SceneFile, ErrorsAreReportedWithTheirPlace) {
  using dermis::DiagnosticId;
  expect_rejected("{", DiagnosticId::syntax, 1, "");
  expect_rejected(R"({ "name": "s" })", DiagnosticId::missing_key, 1, "dermis_scene");
  expect_rejected(scene_with(plain_camera, R"(, "colour": [1, 1, 1])"), DiagnosticId::unknown_key,
                  4, "colour");
  expect_rejected(scene_with(plain_camera, R"(, "pattern": "wood")"), DiagnosticId::invalid_value,
                  4, "wood");
  expect_rejected(scene_with(R"({ "position": [0, 0], "target": [0, 0, 0], "vertical_fov": 30 })"),
                  DiagnosticId::wrong_type, 3, "position");
  expect_rejected(
      scene_with(R"({ "position": [0, 0, 1], "target": [0, 0, 0], "vertical_fov": 0 })"),
      DiagnosticId::out_of_range, 3, "vertical_fov");
  expect_rejected(
      scene_with(
          R"({ "position": [0, 0, 1], "target": [0, 0, 0], "vertical_fov": 30, "near": 30 })"),
      DiagnosticId::scene_range, 3, "near plane");
  expect_rejected(
      scene_with(R"({ "position": [1, 0, 1], "target": [1, 0, 1], "vertical_fov": 30 })"),
      DiagnosticId::scene_range, 3, "no direction");
  expect_rejected(scene_with(plain_camera, R"(, "profile": "skim")").replace(0, 0, ""),
                  DiagnosticId::duplicate_key, 4, "profile");
}

TEST(SceneFile, AnUnknownProfileListsTheKnownOnes) {
  std::string text = scene_with(plain_camera);
  text.replace(text.rfind("\"skin\""), 6, "\"wood\"");
  expect_rejected(text, dermis::DiagnosticId::scene_profile, 4, "'skin'");
}

TEST(SceneFile, BrokenProfile_CausesNoFurtherError) {
  std::string text = scene_with(plain_camera);
  text.replace(text.find("\"name\": \"skin\""), 14, "\"name\": \"s k\"");
  dermis::Diagnostics diagnostics;
  EXPECT_FALSE(parse_scene("scenes/s.json", text, diagnostics));
  EXPECT_EQ(diagnostics.list.size(), 1u) << dermis::format_as_json(diagnostics);
}

TEST(SceneFile, LightsHaveADirection) {
  for (const char* type : {"point", "spot", "directional"}) {
    std::string text = scene_with(plain_camera);
    const std::string target = type == std::string("point") ? "" : R"(, "target": [0, 1, 0])";
    text.insert(text.rfind('}'), R"(, "lights": [ { "type": ")" + std::string(type) +
                                     R"(", "position": [0, 1, 0], "intensity": 1)" + target +
                                     " } ]");
    if (!target.empty()) {
      expect_rejected(text, dermis::DiagnosticId::scene_range, 4, "light 0 are equal");
      continue;
    }
    dermis::Diagnostics diagnostics;
    EXPECT_TRUE(parse_scene("scenes/s.json", text, diagnostics));
  }
}

TEST(SceneFile, KeyframesAscendAndASineStaysInRange) {
  using dermis::DiagnosticId;
  const auto lit = [](const std::string& intensity) {
    std::string text = scene_with(plain_camera);
    text.insert(text.rfind('}'),
                R"(, "lights": [ { "type": "point", "position": [0, 1, 0], "intensity": )" +
                    intensity + " } ]");
    return text;
  };
  dermis::Diagnostics diagnostics;
  const auto scene =
      parse_scene("scenes/s.json", lit(R"({ "keys": [[0, 1], [2, 3]] })"), diagnostics);
  ASSERT_TRUE(scene) << dermis::format_as_json(diagnostics);
  EXPECT_DOUBLE_EQ(value_at(scene->lights[0].intensity, 0.5), 1.5);
  EXPECT_DOUBLE_EQ(value_at(scene->lights[0].intensity, 9.0), 3.0);
  expect_rejected(lit(R"({ "keys": [[1, 1], [1, 3]] })"), DiagnosticId::scene_range, 4, "ascend");
  expect_rejected(lit(R"({ "keys": [[0, -1]] })"), DiagnosticId::out_of_range, 4, "-1");
  expect_rejected(lit(R"({ "sine": { "mean": 1, "amplitude": 2, "hertz": 5 } })"),
                  DiagnosticId::scene_range, 4, "swings");
}

TEST(SceneFile, TooManyShadowMapsAreRejected) {
  std::string lights;
  for (int i = 0; i < 5; ++i)
    lights +=
        std::string(i ? "," : "") + R"({ "type": "point", "position": [0, 1, 0], "intensity": 1 })";
  std::string text = scene_with(plain_camera);
  text.insert(text.rfind('}'), ", \"lights\": [" + lights + "]");
  expect_rejected(text, dermis::DiagnosticId::scene_range, 4, "30 shadow maps");
}

Scene scene_seen_by(bool orthographic) {
  Scene scene;
  scene.camera.orthographic = orthographic;
  scene.camera.position = Curve<glm::dvec3>(glm::dvec3(0.1, 0.2, 2.0));
  scene.camera.height = Curve<double>(0.5);
  scene.objects.emplace_back();
  return scene;
}

TEST(SceneState, DepthConvertsToMetresForEveryProjection) {
  for (const bool orthographic : {false, true}) {
    for (const bool reversed : {false, true}) {
      const Scene scene = scene_seen_by(orthographic);
      const SceneState state = state_at(scene, 0, {320, 180, reversed, true});
      for (const double metres : {0.06, 0.5, 2.0, 19.0}) {
        const glm::dvec4 clip = state.now.clip_from_view * glm::dvec4(0.01, 0.02, -metres, 1.0);
        // fp64; the division by w loses at most far / near of its 53 bits.
        EXPECT_NEAR(view_depth(state.now.clip_from_view, clip.z / clip.w), metres, 1e-9);
      }
      const glm::dvec4 near =
          state.now.clip_from_view * glm::dvec4(0, 0, -scene.camera.near_plane, 1.0);
      EXPECT_NEAR(near.z / near.w, reversed ? 1.0 : 0.0, 1e-12);
    }
  }
}

TEST(SceneState, YPointsUpAndJitterIsInPixels) {
  for (const bool orthographic : {false, true}) {
    const Scene scene = scene_seen_by(orthographic);
    const SceneState state = state_at(scene, 3, {320, 180, false, true});
    const glm::dvec4 point(0.01, 0.02, -2.0, 1.0);
    const auto pixel = [&](const glm::dmat4& projection) {
      const glm::dvec4 clip = projection * point;
      return (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * glm::dvec2(320, 180);
    };
    const glm::dvec2 steady = pixel(state.now.clip_from_view_steady);
    EXPECT_GT(steady.x, 160.0);
    EXPECT_LT(steady.y, 90.0);
    const glm::dvec2 moved = pixel(state.now.clip_from_view) - steady;
    EXPECT_NEAR(moved.x, state.now.jitter.x, 1e-9);
    EXPECT_NEAR(moved.y, state.now.jitter.y, 1e-9);
    EXPECT_NE(state.now.jitter.x, 0.0);
  }
}

TEST(SceneState, PixelsAreAsWideAsTheCameraStates) {
  for (const bool orthographic : {false, true}) {
    Scene scene = scene_seen_by(orthographic);
    const glm::dmat4 square = state_at(scene, 0, {320, 180}).now.clip_from_view;
    scene.camera.pixel_aspect = 2;
    const glm::dmat4 wide = state_at(scene, 0, {320, 180}).now.clip_from_view;
    EXPECT_NEAR(square[0][0] / wide[0][0], 2, 1e-12);
    EXPECT_EQ(square[1][1], wide[1][1]);
  }
}

TEST(SceneState, ZoomHoldsForAnyCurve) {
  Scene scene = scene_seen_by(true);
  scene.camera.height = Curve<double>(1);
  scene.camera.height.amplitude = 0.5;
  scene.camera.height.hertz = 0.25;
  for (uint32_t frame = 0; frame < 100; frame += 10) {
    scene.camera.zoom = 1;
    const glm::dmat4 whole = state_at(scene, frame, {320, 180}).now.clip_from_view;
    scene.camera.zoom = 4;
    const glm::dmat4 close = state_at(scene, frame, {320, 180}).now.clip_from_view;
    EXPECT_NEAR(close[1][1] / whole[1][1], 4, 1e-9) << frame;
  }
}

// A light may pass through its target while it moves.
TEST(SceneState, LightAtItsTarget_HasADirection) {
  Scene scene = scene_seen_by(false);
  Light light;
  light.position = Curve<glm::dvec3>(light.target.keys.front().value);
  scene.lights.push_back(light);
  EXPECT_EQ(direction_of(light, 0), glm::dvec3(0, 0, -1));
  const SceneState state = state_at(scene, 0, {320, 180});
  ASSERT_EQ(state.shadow_from_world.size(), 1u);
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      EXPECT_TRUE(std::isfinite(state.shadow_from_world[0][c][r]));
}

TEST(SceneState, TheFirstFrameHasNoMotion) {
  Scene scene = scene_seen_by(false);
  scene.objects[0].position.keys = {{0.0, glm::dvec3(0.0)}, {1.0, glm::dvec3(1.0, 0.0, 0.0)}};
  const SceneState first = state_at(scene, 0, {320, 180});
  EXPECT_EQ(first.world, first.previous_world);
  const SceneState second = state_at(scene, 5, {320, 180});
  // 25 frames per second.
  EXPECT_NEAR(second.world[0][3][0] - second.previous_world[0][3][0], 0.04, 1e-12);
}

} // namespace
} // namespace demo
