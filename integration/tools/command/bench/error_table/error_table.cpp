// dermis bench error-table: measures the error of every technique over the family of scenes at
// several d, and writes the error table of the choice by budget.

#include "integration/tools/command/bench/error_table/error_table_file.hpp"
#include "integration/tools/command/bench/error_table/judge_choice.hpp"
#include "integration/tools/command/bench/error_table/measured_rows.hpp"
#include "integration/tools/command/bench/error_table/table_fit.hpp"
#include "integration/tools/command/bench/family/family.hpp"
#include "integration/tools/command/bench/family/selected_scenes.hpp"
#include "integration/tools/command/bench/merged_profiles.hpp"
#include "integration/tools/command/bench/still_error.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"
#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/present.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "passes/common/environment.hpp"
#include "passes/common/reference/relief.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <ranges>
#include <set>

namespace dermis::tools {
namespace {

struct ErrorTableBench {
  SuiteRun& run;
  const ErrorTableFile& file;
  demo::VulkanHost& host;
  std::vector<Subject> subjects = {};
  std::vector<CaptureProfile> profiles = {}; // of all subjects, renumbered
  std::vector<float> sap_tables = {};
  std::vector<TabledTechnique> requests = {};
  std::vector<std::unique_ptr<TechniqueRun>> techniques = {}; // by request
  std::vector<ErrorTableRow> rows = {};
};

std::string table_row_name(const TechniqueRequest& request) {
  return request.setting.empty() ? request.technique : name_of(request);
}

// Adds the scene at every d of the table, or at its own d if it only judges.
void add_family_scene(ErrorTableBench& bench, FamilyScene scene, const subsurface::Profile& skin) {
  const bool judging = scene.member.half == "judging";
  const std::vector<double> own = {scene.d_px};
  for (const double d : judging ? own : bench.file.d_px) {
    scene.d_px = d;
    bench.subjects.push_back({scene.name, scene.parameters(),
                              generate_family_scene(scene, family_width, family_height, skin), d,
                              scene.member, bench.subjects.size()});
  }
}

void add_family(ErrorTableBench& bench, const subsurface::Profile& skin) {
  std::set<std::string> classes;
  for (const FamilyScene& scene : bench.run.quick ? few_family_scenes() : family_scenes()) {
    // Pixels are square in most hosts, and all techniques follow their shape.
    if (scene.aspect != 1 || scene.member.scene_class == "square") continue;
    if (!is_selected(bench.run, scene.name, scene.member)) continue;
    if (scene.member.half == "tuning" && !classes.insert(scene.member.scene_class).second) continue;
    add_family_scene(bench, scene, skin);
  }
}

demo::Result<> add_subjects(ErrorTableBench& bench) {
  if (auto known = check_scenes(bench.run, bench.file.scenes, true); !known) return known;
  Diagnostics diagnostics;
  const auto document = read_document(bench.file.skin, diagnostics);
  const auto skin = document ? subsurface::read_profile(*document, diagnostics) : std::nullopt;
  if (!skin) return bench.run.reject(bench.file.skin, diagnostics);
  add_family(bench, *skin);
  for (const SceneRequest& scene : bench.file.scenes) {
    if (interrupted()) return stopped();
    if (bench.run.quick || !is_selected(bench.run, scene.scene, scene.member)) continue;
    auto subject = render_subject(scene, {family_width, family_height, {}});
    if (!subject) return subject.error();
    bench.subjects.push_back(subject.take());
    bench.subjects.back().member = scene.member;
  }
  if (bench.subjects.empty())
    return demo::Error{demo::ErrorKind::usage,
                       "no scene is selected: --scenes takes names of scenes, classes (plane, "
                       "fold, hair, ...) and the halves tuning, judging"};
  for (Subject& subject : bench.subjects)
    merge_profiles(bench.profiles, subject.frame);
  return demo::success();
}

demo::Result<> add_techniques(ErrorTableBench& bench) {
  bench.sap_tables = subsurface::make_shared_sap_tables({true, true});
  auto selected = select_techniques(bench.run, bench.file.techniques);
  if (!selected) return selected.error();
  bench.requests = selected.take();
  if (bench.run.quick) keep_few(bench.requests);
  for (const TabledTechnique& request : bench.requests) {
    auto made = TechniqueRun::create(bench.host, request, bench.profiles, bench.sap_tables);
    if (!made) return made.error();
    bench.techniques.push_back(made.take());
  }
  return demo::success();
}

// Returns the light of the last of the technique's frames at rest.
demo::Result<std::vector<float>> scatter_frames(TechniqueRun& technique, const Subject& subject,
                                                uint32_t frames) {
  auto light = technique.scatter(subject.frame);
  for (uint32_t i = 1; light && i < frames; ++i) {
    if (interrupted()) return stopped();
    light = technique.scatter(subject.frame, true);
  }
  return light;
}

demo::Result<> measure_subject(ErrorTableBench& bench, const Subject& subject) {
  const auto reference =
      make_reference(bench.run.session, subject.frame,
                     fmt::format("reference of {} d {:g} px", subject.scene, subject.d_px),
                     bench.file.subset, bench.run.text("cache"));
  if (!reference) return stopped();
  const double relief = subsurface::mean_relief(make_reference_frame(subject.frame).input());
  for (size_t t = 0; t < bench.techniques.size(); ++t) {
    const TabledTechnique& request = bench.requests[t];
    const uint32_t frames = bench.run.quick ? std::min(request.frames, 2u) : request.frames;
    const auto light = scatter_frames(*bench.techniques[t], subject, frames);
    if (!light) return light.error();
    bench.rows.push_back(
        {{table_row_name(request), subject.scene, subject.member.scene_class, subject.member.half,
          subject.d_px, still_error(*light, *reference).figures.rmse, relief},
         frames});
  }
  return demo::success();
}

std::vector<MeasuredError> errors_of(std::span<const ErrorTableRow> rows) {
  std::vector<MeasuredError> errors;
  for (const ErrorTableRow& row : rows)
    errors.push_back(row.error);
  return errors;
}

std::string factor_text(double logarithm) {
  return fmt::format("{:.3f}", std::exp(logarithm));
}

// Sets the text of the terminal: how well the table predicts each half.
void add_predictions(SuiteRun& run, std::span<const MeasuredError> errors,
                     const choice::ErrorModel& table) {
  Table text;
  text.columns = {{"technique", false},
                  {"half", false},
                  {"scenes", true},
                  {"mean ratio", true},
                  {"RMS factor", true}};
  std::vector<std::string> names;
  for (const MeasuredError& error : errors)
    if (std::ranges::find(names, error.technique) == names.end()) names.push_back(error.technique);
  for (const std::string& name : names)
    for (const char* half : {"tuning", "judging"}) {
      const PredictionError found = judge_table(table, errors, name, half);
      if (found.scenes == 0) continue;
      text.rows.push_back({name, half, fmt::format("{}", found.scenes), factor_text(found.mean),
                           factor_text(found.rms)});
    }
  run.report.text = "Predicted RMSE relative to the measured RMSE\n" + format_table(text);
}

// Adds to the text of the terminal how far a choice among the techniques is from the best.
void add_choice(SuiteRun& run, std::span<const MeasuredError> errors,
                const choice::ErrorModel& table, const std::vector<std::string>& techniques) {
  Table text;
  text.columns = {{"choice by", false}, {"half", false}, {"scenes", true},
                  {"mean ratio", true}, {"worst", true}, {"switches", true}};
  for (const char* half : {"tuning", "judging"}) {
    const auto add = [&](const char* name, const ChoiceError& error) {
      if (error.scenes > 0)
        text.rows.push_back({name, half, fmt::format("{}", error.scenes),
                             fmt::format("{:.3f}", error.mean), fmt::format("{:.2f}", error.worst),
                             fmt::format("{:.1f}", error.switches)});
    };
    add("table", judge_choice(table, errors, techniques, half));
    add("table and probe", judge_measuring_choice(table, errors, techniques, half));
  }
  if (text.rows.empty()) return;
  run.report.text += fmt::format("\nRMSE of a choice among {}, relative to the best of them\n{}",
                                 fmt::join(techniques, ", "), format_table(text));
}

// Returns how the table was made, for its note.
std::string note_of(const MeasuredRows& measured, const ErrorTableFile& file) {
  std::set<std::pair<std::string, double>> scenes;
  for (const ErrorTableRow& row : measured.rows)
    scenes.emplace(row.error.scene, row.error.d_px);
  return fmt::format(
      "Written by: dermis bench error-table, {}, {} scenes of {}x{} pixels, {} pixels of each "
      "compared, except planes. A point is d in pixels, RMSE and its spread between scenes.",
      measured.device, scenes.size(), family_width, family_height, file.subset);
}

demo::Result<choice::ErrorModel> read_table(SuiteRun& run) {
  Diagnostics diagnostics;
  const std::string path = run.file("table");
  const auto document = read_document(path, diagnostics);
  auto table = document ? choice::read_error_model(*document, diagnostics) : std::nullopt;
  if (!table) return run.reject(path, diagnostics);
  return std::move(*table);
}

demo::Result<MeasuredRows> measure_rows(SuiteRun& run, const ErrorTableFile& file) {
  const auto host = run.open_device();
  if (!host) return host.error();
  ErrorTableBench bench{run, file, **host};
  if (auto ready = add_subjects(bench); !ready) return ready.error();
  if (auto ready = add_techniques(bench); !ready) return ready.error();
  Progress progress = run.progress("scene", bench.subjects.size());
  uint64_t done = 0;
  for (const Subject& subject : bench.subjects) {
    if (interrupted()) return stopped();
    if (auto measured = measure_subject(bench, subject); !measured) return measured.error();
    progress.update(++done);
  }
  return MeasuredRows{run.device, std::move(bench.rows)};
}

// Reads the rows of earlier runs, in place of measuring.
demo::Result<MeasuredRows> read_rows(SuiteRun& run) {
  if (!run.list("scenes").empty() || !run.list("techniques").empty())
    return demo::Error{demo::ErrorKind::usage, "--rows fits all rows of its files and measures "
                                               "nothing: leave out --scenes and --techniques"};
  MeasuredRows all;
  for (const std::string& path : run.list("rows")) {
    Diagnostics diagnostics;
    auto read = read_measured_rows(path, diagnostics);
    if (!read) return run.reject(path, diagnostics);
    if (all.device.find(read->device) == std::string::npos)
      all.device += (all.device.empty() ? "" : " and ") + read->device;
    std::ranges::move(read->rows, std::back_inserter(all.rows));
  }
  run.add_info("device of the rows", all.device);
  return all;
}

demo::Result<> measure_error_table(SuiteRun& run, const Emit<ErrorTableRow>& emit) {
  auto read = run.read(read_error_table);
  if (!read) return read.error();
  ErrorTableFile file = read.take();
  auto table = read_table(run);
  if (!table) return table.error();
  if (run.quick) {
    file.subset = std::min(file.subset, quick_subset);
    file.d_px = {file.d_px[file.d_px.size() / 2]};
  }
  auto measured = run.list("rows").empty() ? measure_rows(run, file) : read_rows(run);
  if (!measured) return measured.error();
  const MeasuredRows rows = measured.take();
  run.add_info("size", fmt::format("{}x{} pixels", family_width, family_height));
  run.add_info("truth",
               fmt::format("everywhere on planes, else at {} stratified pixels", file.subset));
  table->scenes = fmt::format("the seeded family of scenes, d from {:g} to {:g} px",
                              file.d_px.front(), file.d_px.back());
  const std::vector<MeasuredError> errors = errors_of(rows.rows);
  fit_table(*table, errors, file.d_px);
  add_predictions(run, errors, *table);
  add_choice(run, errors, *table, file.choice);
  for (const ErrorTableRow& row : rows.rows)
    emit(row);
  if (const std::string& out = run.text("out"); !out.empty())
    run.files.emplace_back(out, choice::write_error_model(*table, note_of(rows, file)));
  return demo::success();
}

template <auto Member> ReportValue measured_of(const ErrorTableRow& row) {
  return row.error.*Member;
}

} // namespace

Suite error_table_suite() {
  using Row = ErrorTableRow;
  using Error = MeasuredError;
  return make_suite<Row>(
      {.name = "error-table",
       .what = "Measure the error table of the choice by budget",
       .title = "Error table",
       .summary =
           "RMSE of the scattered light before albedo against the fp64 reference on the seeded "
           "family of scenes: linear Rec.709 luminance, the scene's 99.9th percentile of "
           "light at 1. The half \"tuning\" gives the table, the half \"judging\" judges "
           "its predictions.",
       .options = {{"table", "Table whose curves are replaced", "configs/choice/errors.json",
                    "FILE"},
                   {"rows",
                    "Rows that an earlier run wrote with --json, to fit without measuring; may be "
                    "repeated",
                    std::vector<std::string>(), "FILE"},
                   {"out", "Write the new table to this file, - for standard output", "", "FILE"},
                   only_option("scenes"),
                   only_option("techniques"),
                   file_option("tests/benchmark/error_table.json"),
                   cache_option()}},
      {{"scene", "scene", measured_of<&Error::scene>, {.groups = true}},
       {"class", "", measured_of<&Error::scene_class>},
       {"half", "half", measured_of<&Error::half>},
       {"d_px", "d, px", measured_of<&Error::d_px>, {.groups = true}},
       {"technique", "technique", measured_of<&Error::technique>},
       {"frames", "frames", &Row::frames},
       {"rmse", "RMSE", measured_of<&Error::rmse>},
       {"relief", "relief", measured_of<&Error::relief>}},
      measure_error_table);
}

} // namespace dermis::tools
