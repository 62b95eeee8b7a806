// dermis compare: measures the difference of two images or of two folders of images.

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/verbs.hpp"
#include "integration/tools/files/difference.hpp"
#include "integration/tools/files/exr.hpp"
#include "integration/tools/files/flip.hpp"
#include "integration/tools/files/heat_color.hpp"
#include "integration/tools/files/metrics.hpp"
#include "integration/tools/files/png.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace dermis::tools {
namespace {

namespace fs = std::filesystem;

struct Pair {
  std::string name; // relative to both folders, or of the first file
  fs::path a, b;
};

// Output of `apply` and `reference` for one light.
constexpr const char *scattered = "scattered.exr", *reference = "reference.exr",
                     *mask_name = "mask.exr";

struct Loaded {
  Image a, b;                // values with peak 1
  std::optional<Image> mask; // 0 in pixels without a reference value
  std::vector<float> seen;   // FLIP per pixel, with B as the reference; empty if not requested
};

struct Compared {
  std::string name, region; // region "": the whole image
  Difference difference;
  double flip = -1, worst_flip = 0; // mean and maximum; -1 if not requested
};

bool is_picture(const fs::path& path) {
  return path.extension() == ".png" || path.extension() == ".exr";
}

// Returns whether the image is the mask of the reference next to it, which is not compared.
bool is_mask(const fs::path& path) {
  std::error_code ignored;
  return path.filename() == mask_name && fs::exists(path.parent_path() / reference, ignored);
}

std::vector<std::string> pictures_below(const fs::path& folder, std::string& problem) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error))
    if (at->is_regular_file(error) && is_picture(at->path()) && !is_mask(at->path()))
      names.push_back(fs::relative(at->path(), folder).string());
  if (error)
    problem = fmt::format("cannot list the folder '{}': {}", folder.string(), error.message());
  std::sort(names.begin(), names.end());
  return names;
}

// Returns the frame folders, such as "frame_0000/", that contain a picture named `file`.
std::vector<std::string> frames_with(const std::vector<std::string>& pictures,
                                     const std::string& file) {
  std::vector<std::string> frames;
  for (const std::string& name : pictures)
    if (fs::path(name).filename() == file)
      frames.push_back((fs::path(name).parent_path() / "").string());
  return frames;
}

// Pairs every image with the image of equal name in the other folder. Sets `problem` if one has no
// partner.
std::vector<Pair> pairs_of(const std::string& a, const std::string& b, std::string& problem) {
  std::error_code ignored;
  for (const std::string& path : {a, b})
    if (!fs::exists(path, ignored)) {
      problem = fmt::format("{}: the file does not exist", path);
      return {};
    }
  const bool folder = fs::is_directory(a, ignored);
  if (folder != fs::is_directory(b, ignored)) {
    problem = fmt::format("'{}' is a folder, '{}' is a file: name two images or two folders",
                          folder ? a : b, folder ? b : a);
    return {};
  }
  if (!folder) return {{fs::path(a).filename().string(), a, b}};
  std::vector<std::string> in_a = pictures_below(a, problem), in_b = pictures_below(b, problem);
  if (!problem.empty()) return {};
  // Output of apply and of reference: compare the scattered light of each frame.
  const auto are = [](const std::vector<std::string>& first,
                      const std::vector<std::string>& second) {
    return !frames_with(first, scattered).empty() && !frames_with(second, reference).empty() &&
           frames_with(first, reference).empty();
  };
  const bool a_is_applied = are(in_a, in_b), b_is_applied = are(in_b, in_a);
  if (a_is_applied || b_is_applied) {
    in_a = frames_with(in_a, a_is_applied ? scattered : reference);
    in_b = frames_with(in_b, b_is_applied ? scattered : reference);
  }
  std::vector<std::string> unmatched;
  std::set_symmetric_difference(in_a.begin(), in_a.end(), in_b.begin(), in_b.end(),
                                std::back_inserter(unmatched));
  if (!unmatched.empty())
    problem =
        fmt::format("'{}' is only in one of the folders{}", unmatched.front(),
                    unmatched.size() > 1 ? fmt::format(", and {} more", unmatched.size() - 1) : "");
  if (in_a.empty() && in_b.empty())
    problem = fmt::format("there are no .png or .exr files below '{}'", a);
  std::vector<Pair> pairs;
  for (const std::string& name : in_a) {
    const std::string of_a = a_is_applied   ? name + scattered
                             : b_is_applied ? name + reference
                                            : name;
    const std::string of_b = b_is_applied   ? name + scattered
                             : a_is_applied ? name + reference
                                            : name;
    pairs.push_back({of_a, fs::path(a) / of_a, fs::path(b) / of_b});
  }
  return pairs;
}

// Reads RGB, or the only channel of an .exr file.
std::optional<Image> read_picture(const fs::path& path, std::string& problem) {
  if (path.extension() == ".png") return read_png(path, problem);
  if (path.extension() == ".exr")
    return read_exr(path, std::vector<ChannelNames>{{"R", "G", "B"}, {"*"}}, problem);
  problem = fmt::format("'{}' is neither a .png nor a .exr file", path.string());
  return std::nullopt;
}

// Reads the mask next to either image if the image is output of `reference`. Returns false and sets
// `problem` on failure.
bool read_mask(const Pair& pair, const Image& like, std::optional<Image>& mask,
               std::string& problem) {
  for (const fs::path& picture : {pair.b, pair.a}) {
    const fs::path path = picture.parent_path() / mask_name;
    std::error_code ignored;
    if (picture.filename() != reference || !fs::exists(path, ignored)) continue;
    mask = read_exr(path, std::vector<ChannelNames>{{"Y"}, {"*"}}, problem);
    if (!mask) return false;
    if (mask->width == like.width && mask->height == like.height) return true;
    problem = fmt::format("'{}' is {}x{}, the image next to it {}x{}", path.string(), mask->width,
                          mask->height, like.width, like.height);
    return false;
  }
  return true;
}

// Reads both images as values with peak 1: the values of a PNG, or the luminance of an EXR with the
// exposure of B.
bool read_both(const Pair& pair, const CompareOptions& options, Loaded& loaded,
               std::string& problem) {
  const auto first = read_picture(pair.a, problem);
  const auto second = first ? read_picture(pair.b, problem) : std::nullopt;
  if (!second) return false;
  if (first->width != second->width || first->height != second->height ||
      first->channels != second->channels) {
    problem = fmt::format("'{}' is {}x{} with {} channels, '{}' {}x{} with {}", pair.a.string(),
                          first->width, first->height, first->channels, pair.b.string(),
                          second->width, second->height, second->channels);
    return false;
  }
  if (pair.a.extension() != pair.b.extension()) {
    problem = fmt::format("'{}' and '{}' are files of different types, whose values mean different "
                          "things; compare two PNG or two EXR files",
                          pair.a.string(), pair.b.string());
    return false;
  }
  const bool is_png = pair.a.extension() == ".png";
  if (!read_mask(pair, *second, loaded.mask, problem)) return false;
  if (options.flip && loaded.mask) {
    problem = fmt::format("FLIP needs whole images, but the mask next to '{}' excludes pixels; run "
                          "reference without --subset",
                          pair.b.string());
    return false;
  }
  if (options.flip) loaded.seen = flip(*second, *first, !is_png, options.pixels_per_degree);
  if (is_png) {
    loaded.a = encoded(*first);
    loaded.b = encoded(*second);
    return true;
  }
  const double exposure = exposure_of(*second, loaded.mask ? &*loaded.mask : nullptr);
  loaded.a = exposed_luminance(*first, exposure);
  loaded.b = exposed_luminance(*second, exposure);
  return true;
}

std::string write_heat(const std::string& path, const Loaded& loaded) {
  const Image &a = loaded.a, &b = loaded.b;
  std::vector<uint8_t> rgb;
  for (uint32_t y = 0; y < a.height; ++y)
    for (uint32_t x = 0; x < a.width; ++x) {
      double squares = 0;
      for (uint32_t c = 0; c < a.channels; ++c) {
        const double error = double(a.at(x, y, c)) - double(b.at(x, y, c));
        squares += error * error / a.channels;
      }
      if (loaded.mask && loaded.mask->at(x, y, 0) == 0) squares = 0;
      for (const uint8_t value : heat_color(std::sqrt(squares)))
        rgb.push_back(value);
    }
  std::string problem;
  write_png(path, a.width, a.height, rgb, problem);
  return problem;
}

std::string write_flip(const std::string& path, const Image& like, const std::vector<float>& seen) {
  constexpr double decades = 3,
                   minimum = -4; // the logarithmic scale of heat_color, here mapped to 0..1
  std::vector<uint8_t> rgb;
  for (const float value : seen)
    for (const uint8_t channel : heat_color(std::pow(10.0, minimum + decades * double(value))))
      rgb.push_back(channel);
  std::string problem;
  write_png(path, like.width, like.height, rgb, problem);
  return problem;
}

Compared compare_region(const std::string& name, const std::string& region, const Loaded& loaded,
                        const PixelRectangle& where) {
  const Image& a = loaded.a;
  const std::vector<float>& seen = loaded.seen;
  Compared row{name, region,
               compare_pictures(a, loaded.b, where, loaded.mask ? &*loaded.mask : nullptr)};
  if (seen.empty()) return row;
  row.flip = 0;
  for (uint32_t y = where.y; y < where.y + where.height; ++y)
    for (uint32_t x = where.x; x < where.x + where.width; ++x) {
      const auto value = double(seen[size_t{y} * a.width + x]);
      row.flip += value / (double(where.width) * where.height);
      row.worst_flip = std::max(row.worst_flip, value);
    }
  return row;
}

// Combines all whole images: PSNR and RMSE of the mean of their squared errors.
Compared all_of(const std::vector<Compared>& rows) {
  Compared all{"all", "", {}};
  double squares = 0, ssim = 0, seen = 0, pictures = 0;
  bool structural = true;
  Difference& d = all.difference;
  for (const Compared& row : rows) {
    if (!row.region.empty()) continue;
    const Difference& one = row.difference;
    squares += one.rmse * one.rmse;
    structural = structural && one.ssim;
    ssim += one.ssim.value_or(0);
    seen += row.flip;
    pictures += 1;
    d.pixels += one.pixels;
    d.nonfinite += one.nonfinite;
    d.max_error = std::max(d.max_error, one.max_error);
    all.worst_flip = std::max(all.worst_flip, row.worst_flip);
  }
  d.rmse = std::sqrt(squares / pictures);
  d.psnr_db = psnr_from_mse(squares / pictures);
  if (structural) d.ssim = ssim / pictures;
  all.flip = seen / pictures;
  return all;
}

void write_row(JsonWriter& json, const Compared& row, bool of_all) {
  const Difference& d = row.difference;
  json.open_object(true);
  if (!of_all) json.member("picture", row.name);
  if (!row.region.empty()) json.member("region", row.region);
  json.member("psnr_db", d.psnr_db);
  if (d.ssim) json.member("ssim", *d.ssim);
  json.member("rmse", d.rmse).member("max_error", d.max_error);
  if (!of_all) json.member("worst_x", d.worst_x).member("worst_y", d.worst_y);
  json.member("nonfinite_pixels", d.nonfinite);
  if (row.flip >= 0) json.member("flip", row.flip).member("flip_max", row.worst_flip);
  json.member("pixels", d.pixels).close();
}

std::string as_json(const std::vector<Compared>& rows, bool several, bool ok) {
  JsonWriter json;
  json.open_object().member("ok", ok).key("rows").open_array();
  for (const Compared& row : rows)
    write_row(json, row, false);
  json.close();
  if (several) write_row(json.key("all"), all_of(rows), true);
  json.close();
  return std::move(json).finish();
}

std::string as_table(std::vector<Compared> rows, bool several) {
  if (several) rows.push_back(all_of(rows));
  Table table{{{"picture"},
               {"region"},
               {"PSNR", true},
               {"SSIM", true},
               {"RMSE", true},
               {"largest", true},
               {"at"},
               {"pixels", true},
               {"not finite", true}},
              {}};
  const bool with_flip = !rows.empty() && rows.front().flip >= 0;
  if (with_flip) table.columns.insert(table.columns.begin() + 4, {"FLIP", true});
  for (const Compared& row : rows) {
    const Difference& d = row.difference;
    const bool of_all = several && &row == &rows.back();
    if (of_all) table.rows.emplace_back();
    table.rows.push_back(
        {row.name, row.region, format_decibels(d.psnr_db),
         d.ssim ? fmt::format("{:.4f}", *d.ssim) : "-", fmt::format("{:.5f}", d.rmse),
         fmt::format("{:.4f}", d.max_error),
         d.max_error > 0 && !of_all ? fmt::format("{},{}", d.worst_x, d.worst_y) : "",
         fmt::format("{}", d.pixels), d.nonfinite > 0 ? fmt::format("{}", d.nonfinite) : ""});
    auto& cells = table.rows.back();
    if (with_flip) cells.insert(cells.begin() + 4, fmt::format("{:.4f}", row.flip));
  }
  return format_table(table);
}

} // namespace

ExitCode compare(const Session& session, const CompareOptions& options) {
  std::string problem;
  const std::vector<Pair> pairs = pairs_of(options.a, options.b, problem);
  if (!problem.empty()) return fail(session, ExitCode::problems, problem);
  if ((!options.heat.empty() || !options.flip_map.empty()) && pairs.size() > 1)
    return fail(session, ExitCode::usage,
                "--heat and --flip-map write one image; name two files instead of folders");
  Progress progress(progress_style(session.quiet, session.json), "compare", "picture",
                    pairs.size());
  std::vector<Compared> rows;
  for (const Pair& pair : pairs) {
    Loaded loaded;
    if (!read_both(pair, options, loaded, problem))
      return fail(session, ExitCode::problems, problem);
    const Image& a = loaded.a;
    rows.push_back(compare_region(pair.name, "", loaded, {0, 0, a.width, a.height}));
    if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
    progress.update(static_cast<uint64_t>(&pair - pairs.data()) + 1);
    for (const PictureRegion& region : options.regions) {
      if (uint64_t{region.x} + region.size.width > a.width ||
          uint64_t{region.y} + region.size.height > a.height)
        return fail(session, ExitCode::usage,
                    fmt::format("the region {} is outside the {}x{} pixels of '{}'", region.text,
                                a.width, a.height, pair.name));
      rows.push_back(compare_region(pair.name, region.text, loaded,
                                    {region.x, region.y, region.size.width, region.size.height}));
    }
    if (!options.heat.empty()) problem = write_heat(options.heat, loaded);
    if (problem.empty() && !options.flip_map.empty())
      problem = write_flip(options.flip_map, a, loaded.seen);
    if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  }
  const bool ok = std::all_of(rows.begin(), rows.end(), [&](const Compared& row) {
    return row.difference.nonfinite == 0 && row.difference.pixels > 0 &&
           row.difference.psnr_db >= options.min_psnr && row.flip <= options.max_flip;
  });
  say(session, as_table(rows, pairs.size() > 1));
  if (!options.heat.empty())
    say(session,
        fmt::format("\n{}: RMS error of a pixel's channels, logarithmic; dark blue 1e-4 or less, "
                    "light yellow 0.1 or more\n",
                    options.heat));
  if (!options.flip_map.empty())
    say(session, fmt::format("{}{}: FLIP of a pixel, dark blue 0, light yellow 1\n",
                             options.heat.empty() ? "\n" : "", options.flip_map));
  if (session.json) print(as_json(rows, pairs.size() > 1, ok));
  if (ok) return ExitCode::ok;
  if (session.json) return ExitCode::problems;
  std::string allowed;
  if (std::isfinite(options.min_psnr))
    allowed = fmt::format("at least {}", format_decibels(options.min_psnr));
  if (options.max_flip < 1)
    allowed +=
        fmt::format("{}a FLIP of at most {}", allowed.empty() ? "" : " and ", options.max_flip);
  const auto empty = std::find_if(rows.begin(), rows.end(),
                                  [](const Compared& row) { return row.difference.pixels == 0; });
  if (empty != rows.end())
    return fail(session, ExitCode::problems,
                fmt::format("'{}'{}{} has no pixel to compare: the mask of the reference has "
                            "none there",
                            empty->name, empty->region.empty() ? "" : ", region ", empty->region));
  const bool finite = std::all_of(
      rows.begin(), rows.end(), [](const Compared& row) { return row.difference.nonfinite == 0; });
  return fail(session, ExitCode::problems,
              finite ? fmt::format("the images differ more than allowed: {}", allowed)
                     : "some values are not finite");
}

} // namespace dermis::tools
