#include "tests/passes/device/real_graph.hpp"

#include "framegraph/model/read_graph.hpp"
#include "framegraph/model/splitmix.hpp"
#include "framegraph/text/diagnostic.hpp"
#include "framegraph/text/document.hpp"
#include "tests/support/shipped_graphs.hpp"
#include "tests/support/text_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>

namespace dermis::testing {
namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t max_steps = 6; // An integer setting is at most this much above its minimum.

Json read_shipped(const std::string& name) {
  std::ifstream file(DERMIS_SOURCE_DIR "/" + shipped::graph_file(name));
  return Json::parse(file, nullptr, true, true);
}

std::optional<RealGraph> made(std::string name, std::string text,
                              const PassTypeRegistry& pass_types) {
  Diagnostics diagnostics;
  auto document = parse_document(name, text, diagnostics);
  auto graph = document ? read_graph(*document, pass_types, diagnostics) : std::nullopt;
  if (!graph) {
    ADD_FAILURE() << format_as_json(diagnostics) << "\n" << text;
    return std::nullopt;
  }
  return RealGraph{std::move(name), std::move(text), std::move(*graph)};
}

struct Draft {
  SplitMix64 random;
  Json graph = {{"dermis", 2},
                {"name", "random"},
                {"settings", Json::object()},
                {"imports", Json::object()},
                {"resources", Json::object()},
                {"passes", Json::array()},
                {"exports", Json::array()}};
  std::vector<std::string> lights = {"lighting"}; // Light that a part may scatter.

  bool chance(uint32_t percent) { return random.below(100) < percent; }

  // Replaces the default by a random allowed value, because graphs are compiled with their
  // defaults.
  void draw_value(Json& setting) {
    if (setting.contains("int")) {
      const int64_t minimum = setting["min"], maximum = setting["max"];
      const auto steps = static_cast<size_t>(std::min(maximum - minimum, max_steps));
      setting["int"] = minimum + static_cast<int64_t>(random.below(steps + 1));
    } else if (setting.contains("real")) {
      const Json ends[] = {setting["min"], setting["max"]};
      if (chance(30)) setting["real"] = ends[random.below(2)];
    } else if (setting.contains("bool")) {
      setting["bool"] = chance(50);
    } else {
      const Json& options = setting.contains("enum") ? setting["enum"] : setting["choice"];
      setting["default"] = options[random.below(options.size())];
    }
  }

  using Names = std::map<std::string, std::string>;

  static std::string renamed(const Names& names, const std::string& name) {
    const auto found = names.find(name);
    return found == names.end() ? name : found->second;
  }

  // Renames resources and settings in a text: every resource name in "ratio#1@-1?other", settings
  // outside of quotes in "technique == 'sap'", and "$samples".
  static std::string renamed_words(const Names& names, const std::string& text) {
    std::string out, word;
    bool quoted = false;
    const auto flush = [&] {
      out += quoted ? word : renamed(names, word);
      word.clear();
    };
    for (const char c : text) {
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
        word += c;
        continue;
      }
      flush();
      if (c == '\'') quoted = !quoted;
      out += c;
    }
    flush();
    return out;
  }

  void rename_pass(Json& pass, const std::string& prefix, const Names& resources,
                   const Names& settings) {
    pass["pass"] = prefix + std::string(pass["pass"]);
    for (const char* side : {"read", "write"})
      if (pass.contains(side))
        for (auto& [port, resource] : pass[side].items())
          resource = renamed_words(resources, resource);
    if (pass.contains("when")) pass["when"] = renamed_words(settings, pass["when"]);
    if (pass.contains("set"))
      for (auto& [name, value] : pass["set"].items())
        if (value.is_string() && std::string(value).starts_with("$"))
          value = fmt::format("${}", renamed(settings, std::string(value).substr(1)));
    if (!pass.contains("otherwise")) return;
    Json otherwise = Json::object();
    for (auto& [resource, instead] : pass["otherwise"].items())
      otherwise[renamed(resources, resource)] = renamed(resources, instead);
    pass["otherwise"] = otherwise;
  }

  void add(Json part, const std::string& prefix) {
    Names resources, settings;
    for (auto& [name, declared] : part["settings"].items()) {
      settings[name] = prefix + name;
      draw_value(declared);
      graph["settings"][prefix + name] = declared;
    }
    for (auto& [name, declared] : part["imports"].items())
      if (!graph["imports"].contains(name)) graph["imports"][name] = declared;
    for (auto& [name, declared] : part["resources"].items()) {
      resources[name] = prefix + name;
      graph["resources"][prefix + name] = declared;
    }
    const std::string light = lights[random.below(lights.size())];
    Names redirected = resources;
    redirected["lighting"] = light;
    const bool puts_back = chance(80); // Whether the part scatters into the host's light.
    for (Json& pass : part["passes"]) {
      const std::string type = pass["type"];
      if (type == "subsurface.combine" && !puts_back) continue;
      // If a pass writes light back, light is the host's image.
      const bool writes_light = pass.contains("write") && pass["write"].contains("lighting");
      rename_pass(pass, prefix, writes_light ? resources : redirected, settings);
      if (!graph["passes"].empty() && chance(10)) {
        const Json& earlier = graph["passes"][random.below(graph["passes"].size())];
        pass["after"] = Json::array({{{"pass", earlier["pass"]}, {"reason", "random"}}});
      }
      graph["passes"].push_back(pass);
    }
    for (const Json& one : part["exports"]) {
      const std::string name = renamed(resources, one);
      Json& exports = graph["exports"];
      if (std::find(exports.begin(), exports.end(), name) == exports.end()) exports.push_back(name);
      if (one == "scattered_light") lights.push_back(name);
    }
  }
};

} // namespace

std::vector<std::string> graphs_of_images() {
  std::vector<std::string> names;
  for (const std::string& file : shipped::graph_files()) {
    const std::string name = std::filesystem::path(file).stem().string();
    const Json imports = read_shipped(name)["imports"];
    if (std::none_of(imports.begin(), imports.end(), [](const Json& declared) {
          return declared.contains("buffer") || declared.contains("acceleration_structure");
        }))
      names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::optional<RealGraph> shipped_graph(const std::string& name,
                                       const PassTypeRegistry& pass_types) {
  return made(name, test::read_text(DERMIS_SOURCE_DIR "/" + shipped::graph_file(name)), pass_types);
}

std::optional<RealGraph> random_real_graph(uint64_t seed, const PassTypeRegistry& pass_types) {
  const std::vector<std::string> files = graphs_of_images();
  Draft draft{{seed}};
  std::string name;
  const size_t parts = 1 + draft.random.below(3);
  for (size_t i = 0; i < parts; ++i) {
    const std::string& file = files[draft.random.below(files.size())];
    draft.add(read_shipped(file), i == 0 ? "" : fmt::format("p{}_", i));
    name += (i == 0 ? "" : "+") + file;
  }
  return made(name, draft.graph.dump(1), pass_types);
}

} // namespace dermis::testing
