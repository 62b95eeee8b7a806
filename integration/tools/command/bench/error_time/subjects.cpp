// The subjects of `dermis bench error-time`.

#include "integration/tools/command/bench/error_time/error_time_bench.hpp"
#include "integration/tools/command/bench/family/family.hpp"
#include "integration/tools/command/bench/family/selected_scenes.hpp"
#include "integration/tools/command/bench/merged_profiles.hpp"
#include "integration/tools/command/interrupt.hpp"

#include <fmt/format.h>

namespace dermis::tools {
namespace {

// Returns the reason to leave the scene out, or "".
std::string why_not(const ErrorTimeBench& bench, const SceneRequest& scene) {
  if (scene.study && !bench.run.flag("study")) return "only with --study";
  return scene.model ? why_no_head(bench.run.text("head")) : "";
}

// Numbers count all scenes, selected or not, so that pictures keep their numbers.
void add_family(ErrorTimeBench& bench, size_t& number, const SubjectOptions& options,
                const subsurface::Profile& skin) {
  for (const FamilyScene& scene : bench.run.quick ? few_family_scenes() : family_scenes()) {
    const size_t own = number++;
    if (!is_selected(bench.run, scene.name, scene.member)) continue;
    bench.subjects.push_back({scene.name, scene.parameters(),
                              generate_family_scene(scene, options.width, options.height, skin),
                              scene.d_px, scene.member, own});
  }
}

demo::Result<> add_scene(ErrorTimeBench& bench, size_t& number, const SceneRequest& scene,
                         const SubjectOptions& options, const subsurface::Profile& skin) {
  const size_t first = number;
  number += scene.file.empty() ? scene.d_px.size() : 1;
  if (!is_selected(bench.run, scene.scene, scene.member)) return demo::success();
  if (!scene.file.empty()) {
    auto subject = render_subject(scene, options);
    if (!subject) return subject.error();
    bench.subjects.push_back(subject.take());
    bench.subjects.back().member = scene.member;
    bench.subjects.back().number = first;
    return demo::success();
  }
  for (size_t i = 0; i < scene.d_px.size(); ++i)
    bench.subjects.push_back({scene.scene, scene.framing,
                              generate_scene(scene.scene, scene.framing, options.width,
                                             options.height, scene.d_px[i], skin),
                              scene.d_px[i], scene.member, first + i});
  return demo::success();
}

} // namespace

demo::Result<> add_subjects(ErrorTimeBench& bench) {
  if (auto known = check_scenes(bench.run, bench.file.scenes, bench.file.family); !known)
    return known;
  Diagnostics diagnostics;
  const auto document = read_document(bench.file.skin, diagnostics);
  const auto skin = document ? subsurface::read_profile(*document, diagnostics) : std::nullopt;
  if (!skin) return bench.run.reject(bench.file.skin, diagnostics);
  const SubjectOptions options{bench.size.width, bench.size.height,
                               head_model(bench.run.text("head"))};
  size_t number = 0;
  if (bench.file.family) add_family(bench, number, options, *skin);
  Progress progress = bench.run.progress("scene", bench.file.scenes.size(), "scenes");
  uint64_t done = 0;
  for (const SceneRequest& scene : bench.file.scenes) {
    if (interrupted()) return stopped();
    progress.update(done++);
    if (const std::string reason = why_not(bench, scene); !reason.empty())
      bench.run.add_note(fmt::format("scene {} {}: {}", scene.scene, scene.framing, reason));
    else if (auto added = add_scene(bench, number, scene, options, *skin); !added)
      return added;
  }
  if (bench.subjects.empty())
    return demo::Error{
        demo::ErrorKind::usage,
        "no scene is selected: --scenes takes names of scenes in the --file and, with "
        "--family, classes (plane, fold, hair, ...) and the halves tuning, judging"};
  for (Subject& subject : bench.subjects)
    merge_profiles(bench.profiles, subject.frame);
  return demo::success();
}

} // namespace dermis::tools
