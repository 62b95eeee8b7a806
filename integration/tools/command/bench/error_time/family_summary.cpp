// Geometric means over the scenes of the family.

#include "integration/tools/command/bench/error_time/error_time_bench.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"
#include "integration/tools/command/present.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace dermis::tools {
namespace {

constexpr double min_rmse = 1e-5; // 100 dB: smaller figures only measure rounding
constexpr const char* all_classes = "all";

struct Mean {
  double sum = 0; // of logarithms
  size_t count = 0;

  void add(double value) {
    sum += std::log(std::max(value, min_rmse));
    ++count;
  }
  double result() const { return std::exp(sum / double(count)); }
};

// Means of one half and class, by technique.
struct ClassMeans {
  std::string half, scene_class;
  size_t scenes = 0;
  std::map<const TechniqueRequest*, double> rmse;
};

const ErrorTimeRow* row_of(const ErrorTimeBench& bench, const Subject& subject,
                           const TechniqueRequest* request) {
  for (const ErrorTimeRow& row : bench.measured)
    if (row.subject == &subject && row.request == request) return &row;
  return nullptr;
}

std::vector<const TechniqueRequest*> requests_of(const ErrorTimeBench& bench) {
  std::vector<const TechniqueRequest*> requests;
  for (const TechniqueRequest& folder : bench.pictures)
    requests.push_back(&folder);
  for (const auto& technique : bench.techniques)
    requests.push_back(&technique->request());
  return requests;
}

// Returns the mean over classes first, then each class, in order of the scenes.
std::vector<ClassMeans> means_of(const ErrorTimeBench& bench, const std::string& half) {
  std::vector<ClassMeans> means{{half, all_classes, 0, {}}};
  for (const Subject& subject : bench.subjects) {
    if (subject.member.half != half) continue;
    ++means.front().scenes;
    const auto known = std::find_if(means.begin(), means.end(), [&](const ClassMeans& one) {
      return one.scene_class == subject.member.scene_class;
    });
    if (known != means.end())
      ++known->scenes;
    else
      means.push_back({half, subject.member.scene_class, 1, {}});
  }
  for (const TechniqueRequest* request : requests_of(bench)) {
    Mean over_classes;
    for (size_t i = 1; i < means.size(); ++i) {
      Mean over_scenes;
      for (const ErrorTimeRow& row : bench.measured)
        if (row.request == request && row.subject->member.half == half &&
            row.subject->member.scene_class == means[i].scene_class)
          over_scenes.add(row.error.figures.rmse);
      means[i].rmse[request] = over_scenes.result();
      over_classes.add(over_scenes.result());
    }
    if (over_classes.count > 0) means.front().rmse[request] = over_classes.result();
  }
  return means;
}

// The columns of both tables: RMSE of each technique, and ratios to the baseline and to the
// pictures.
class FamilyTable {
public:
  explicit FamilyTable(const ErrorTimeBench& bench) : requests_(requests_of(bench)) {
    for (const TechniqueRequest* request : requests_)
      if (request->technique == bench.file.baseline_technique &&
          request->setting == bench.file.baseline_setting)
        baseline_ = request;
    if (!bench.pictures.empty()) pictures_ = &bench.pictures.front();
    table_.columns = {{"half", false}, {"class", false}, {"scene", false}, {"d, px", true}};
    for (const TechniqueRequest* request : requests_)
      table_.columns.push_back({name_of(*request), true});
    for (const TechniqueRequest* request : requests_)
      if (baseline_ != nullptr && request != baseline_)
        table_.columns.push_back({name_of(*request) + " / baseline", true});
    for (const TechniqueRequest* request : requests_)
      if (pictures_ != nullptr && request != pictures_)
        table_.columns.push_back({name_of(*request) + " / pictures", true});
  }

  // `rmse` and `ratio` return values of a technique; `ratio` is text.
  template <class Rmse, class Ratio>
  void add(std::vector<std::string> cells, const Rmse& rmse, const Ratio& ratio) {
    for (const TechniqueRequest* request : requests_)
      cells.push_back(fmt::format("{:.3f}", 1e3 * rmse(request)));
    for (const TechniqueRequest* request : requests_)
      if (baseline_ != nullptr && request != baseline_)
        cells.push_back(fmt::format("{:.3f}", rmse(request) / rmse(baseline_)));
    for (const TechniqueRequest* request : requests_)
      if (pictures_ != nullptr && request != pictures_) cells.push_back(ratio(request));
    table_.rows.push_back(std::move(cells));
  }
  void rule() { table_.rows.emplace_back(); }
  const TechniqueRequest* pictures() const { return pictures_; }
  std::string text() const { return format_table(table_); }

private:
  std::vector<const TechniqueRequest*> requests_;
  const TechniqueRequest* baseline_ = nullptr;
  const TechniqueRequest* pictures_ = nullptr;
  Table table_;
};

void add_scenes(const ErrorTimeBench& bench, FamilyTable& table) {
  for (const Subject& subject : bench.subjects)
    table.add(
        {subject.member.half, subject.member.scene_class, subject.scene + " " + subject.framing,
         fmt::format("{:.2g}", subject.d_px)},
        [&](const TechniqueRequest* request) {
          return row_of(bench, subject, request)->error.figures.rmse;
        },
        [&](const TechniqueRequest* request) {
          const auto& found = row_of(bench, subject, request)->pictures_ratio;
          return found
                     ? fmt::format("{:.3f} [{:.3f}, {:.3f}]", found->ratio, found->low, found->high)
                     : "-";
        });
}

void add_means(const std::vector<ClassMeans>& means, FamilyTable& table) {
  for (const ClassMeans& one : means) {
    const auto rmse = [&](const TechniqueRequest* request) { return one.rmse.at(request); };
    table.add({one.half, one.scene_class, format_count(one.scenes, "scene"), ""}, rmse,
              [&](const TechniqueRequest* request) {
                return fmt::format("{:.3f}", rmse(request) / rmse(table.pictures()));
              });
  }
  if (!means.empty()) table.rule();
}

} // namespace

void add_family_summary(ErrorTimeBench& bench) {
  FamilyTable table(bench);
  add_scenes(bench, table);
  table.rule();
  std::vector<ClassMeans> means;
  for (const char* half : {"tuning", "judging"}) {
    std::vector<ClassMeans> of_half = means_of(bench, half);
    if (of_half.size() < 2) continue;
    add_means(of_half, table);
    means.insert(means.end(), of_half.begin(), of_half.end());
  }
  bench.run.report.text = "RMSE in 1e-3; the last rows are geometric means\n" + table.text();

  bench.means.reserve(means.size()); // rows point to their subjects
  for (const ClassMeans& one : means) {
    bench.means.push_back({"geometric mean", one.half, {}, 0, {one.scene_class, one.half, 0}, 0});
    for (const auto& [request, rmse] : one.rmse) {
      ErrorTimeRow row{&bench.means.back(), request};
      row.error.figures.rmse = rmse;
      row.error.figures.psnr_db = psnr_from_mse(rmse * rmse);
      bench.measured.push_back(std::move(row));
    }
  }
}

} // namespace dermis::tools
