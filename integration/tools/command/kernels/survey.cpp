#include "integration/tools/command/kernels/survey.hpp"

#include "framegraph/compile/availability.hpp"
#include "framegraph/vulkan/device_profile.hpp"
#include "integration/abi/kernel_environment.hpp"
#include "integration/abi/shaders/runtime_shaders.hpp"
#include "integration/examples/demo_engine/vulkan_host.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/files/roots.hpp"
#include "passes/choice/configurations.hpp"
#include "passes/common/kernel_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <set>

namespace dermis::tools {
namespace {

demo::Error graph_error(std::string text) {
  return {demo::ErrorKind::input, std::move(text)};
}

// Delivers the files of --shaders to the library's compiler. Texts live as long as this object.
struct ShaderFolder {
  OpenFile open;
  std::deque<FileText> delivered;

  static uint32_t DERMIS_CALL deliver(void* user, const char* name, dermis_source* source) {
    auto& self = *static_cast<ShaderFolder*>(user);
    FileText file = self.open(name);
    if (!file.problem.empty()) return 0;
    const FileText& kept = self.delivered.emplace_back(std::move(file));
    source->name = kept.name.c_str();
    source->text = kept.text.data();
    source->length = kept.text.size();
    return 1;
  }
};

std::string driver_of(VkPhysicalDevice physical) {
  auto driver = demo::vulkan_struct<VkPhysicalDeviceDriverProperties>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
  auto properties = demo::vulkan_struct<VkPhysicalDeviceProperties2>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  properties.pNext = &driver;
  vkGetPhysicalDeviceProperties2(physical, &properties);
  return fmt::format("{} {}", driver.driverName, driver.driverInfo);
}

std::string feature_names(Features features) {
  std::vector<std::string_view> names;
  for (uint32_t f = 0; f < static_cast<uint32_t>(Feature::count); ++f)
    if ((features & bit_of(static_cast<Feature>(f))) != 0)
      names.push_back(feature_name(static_cast<Feature>(f)));
  return fmt::format("{}", fmt::join(names, ", "));
}

// Returns the combinations of settings whose plans are surveyed: those of all choices by budget,
// and each value of each other switch or enumeration that --set leaves open.
std::vector<std::vector<SettingValue>> settings_of_plans(const CompileInput& input,
                                                         const std::vector<bool>& pinned,
                                                         Diagnostics& diagnostics) {
  const auto combinations = choice::enumerate_combinations(input, diagnostics, pinned);
  if (!combinations) return {};
  std::vector<std::vector<SettingValue>> all = combinations->settings;
  for (size_t s = 0; s < input.graph->settings.size(); ++s) {
    const SettingDeclaration& declared = input.graph->settings[s];
    const auto options =
        declared.type == SettingType::boolean ? 2 : static_cast<int64_t>(declared.options.size());
    if (pinned[s] || declared.type == SettingType::choice) continue;
    for (int64_t option = 0; option < options; ++option) {
      std::vector<SettingValue> values = input.settings;
      if (values[s].integer == option) continue;
      values[s].integer = option;
      const SettingValue offered =
          available_option(declared, values[s], input.device->features, input.bound);
      if (offered.integer == option) all.push_back(std::move(values));
    }
  }
  return all;
}

// Returns the entries of --set or --unbound that this graph declares.
template <class Entry, class Declarations, class NameOf>
std::vector<Entry> known_entries(const std::vector<Entry>& entries, const Declarations& declared,
                                 NameOf name_of) {
  std::vector<Entry> known;
  std::copy_if(entries.begin(), entries.end(), std::back_inserter(known), [&](const Entry& entry) {
    return std::any_of(declared.begin(), declared.end(),
                       [&](const auto& one) { return one.name == name_of(entry); });
  });
  return known;
}

class Survey {
public:
  Survey(const KernelsOptions& options, Diagnostics& diagnostics)
      : options_(options), diagnostics_(diagnostics) {}

  demo::Result<> open() {
    auto made = demo::create_vulkan_host({.device = options_.device, .compile_only = true});
    if (!made) return made.error();
    host_ = made.take();
    vulkan::DeviceInput input;
    input.get_instance_proc_addr = vkGetInstanceProcAddr;
    input.instance = host_->instance;
    input.physical = host_->physical_device;
    input.device = host_->device;
    input.queue_family = host_->queue_family;
    input.small_groups = options_.small_groups;
    input.features = host_->ray_query ? bit_of(Feature::ray_query) : Features{0};
    if (const vulkan::Error error = vulkan::make_device(input, device_))
      return demo::Error{demo::ErrorKind::environment, error.text};
    kernels_ = std::make_unique<vulkan::KernelStore>();
    profile_ = counter_.profile_for(device_);
    result.device = device_.properties.deviceName;
    result.driver = driver_of(host_->physical_device);
    result.statistics = host_->pipeline_statistics;
    if (!options_.shaders.empty()) {
      folder_.open = open_below({options_.shaders});
      abi::use_shaders(shaders_, &ShaderFolder::deliver, &folder_);
    }
    return demo::success();
  }

  demo::Result<> add(const std::string& path) {
    const std::optional<LoadedGraph> loaded = load_graph(path, options_.inputs, diagnostics_);
    if (!loaded) return cannot_use(path);
    const std::string name = std::filesystem::path(path).stem().string();
    if (std::string why = lacking_features(*loaded); !why.empty()) {
      result.skipped.push_back({name, std::move(why)});
      return demo::success();
    }
    CompileChoices choices = choices_for(*loaded);
    if (!choices.problem.empty()) return demo::Error{demo::ErrorKind::usage, choices.problem};
    const CompileInput input = compile_input(*loaded, profile_, options_.size, choices);
    if (!abi::compile_missing(shaders_, loaded->graph, loaded->pass_types, diagnostics_))
      return cannot_use(path);
    const subsurface::KernelTables tables = subsurface::make_kernel_tables(
        subsurface::table_use(loaded->graph, loaded->pass_types), {});
    const abi::KernelEnvironment environment = abi::kernel_environment(tables);
    GraphCounts counts;
    counts.graph = name;
    if (auto done = add_plans(*loaded, input, environment, counts); !done) return done;
    if (diagnostics_.has_errors()) return cannot_use(path);
    result.graphs.push_back(std::move(counts));
    return demo::success();
  }

  // Returns a problem with names that no graph declares.
  std::string unknown_names() const {
    for (const auto& [name, value] : options_.settings)
      if (!known_names_.contains(name)) return fmt::format("no graph has a setting '{}'", name);
    for (const std::string& name : options_.unbound)
      if (!known_names_.contains(name)) return fmt::format("no graph has a resource '{}'", name);
    return "";
  }

  KernelSurvey result;

private:
  demo::Error cannot_use(const std::string& path) const {
    return graph_error(fmt::format("{}: the graph cannot be used", path));
  }

  // Returns why the device cannot run the graph with its default settings, although other devices
  // can; else "".
  std::string lacking_features(const LoadedGraph& loaded) const {
    for (const SettingDeclaration& setting : loaded.graph.settings) {
      const Features lacking =
          missing_requirements(setting, setting.default_value.integer, device_.features, {})
              .features;
      if (lacking != 0)
        return fmt::format("its default {} needs {}, which the device lacks",
                           setting_text(setting, setting.default_value), feature_names(lacking));
    }
    const CompileChoices choices = read_choices(loaded.graph);
    DeviceProfile able = profile_;
    able.features = (Features{1} << static_cast<uint32_t>(Feature::count)) - 1;
    Diagnostics reported; // by the caller, if the graph fails on every device
    if (compile(compile_input(loaded, profile_, options_.size, choices), reported)) return "";
    reported = {};
    const auto compiled = compile(compile_input(loaded, able, options_.size, choices), reported);
    Features lacking = 0;
    if (compiled)
      for (const PlanPass& pass : compiled->plan.passes)
        lacking |= loaded.pass_types[pass.type].features & ~device_.features;
    return lacking == 0
               ? ""
               : fmt::format("it needs {}, which the device lacks", feature_names(lacking));
  }

  CompileChoices choices_for(const LoadedGraph& loaded) {
    const Graph& graph = loaded.graph;
    const auto settings = known_entries(options_.settings, graph.settings,
                                        [](const NamedValue& entry) { return entry.first; });
    const auto unbound = known_entries(options_.unbound, graph.resources,
                                       [](const std::string& name) { return name; });
    pinned_.assign(graph.settings.size(), false);
    for (size_t s = 0; s < graph.settings.size(); ++s)
      for (const auto& [name, value] : settings)
        pinned_[s] = pinned_[s] || graph.settings[s].name == name;
    for (const auto& [name, value] : settings)
      known_names_.insert(name);
    known_names_.insert(unbound.begin(), unbound.end());
    CompileChoices choices = read_choices(graph, settings, unbound);
    for (size_t s = 0; choices.problem.empty() && s < choices.settings.size(); ++s)
      choices.settings[s] =
          available_option(graph.settings[s], choices.settings[s], device_.features, choices.bound);
    return choices;
  }

  demo::Result<> add_plans(const LoadedGraph& loaded, const CompileInput& input,
                           const abi::KernelEnvironment& environment, GraphCounts& counts) {
    const std::vector<vulkan::KernelCode> codes = abi::kernel_codes(shaders_);
    std::set<const vulkan::Pipeline*> used;
    for (const std::vector<SettingValue>& settings :
         settings_of_plans(input, pinned_, diagnostics_)) {
      if (interrupted()) return stopped();
      CompileInput one = input;
      one.settings = settings;
      const std::optional<CompiledPlan> compiled = compile(one, diagnostics_);
      if (!compiled) return demo::success(); // reported by the caller
      const Plan& plan = compiled->plan;
      const bool is_default = counts.configurations++ == 0;
      if (is_default) {
        count_bytes(loaded.graph, loaded.pass_types, plan, options_.assumptions, counts);
        const std::string problem = counter_.count_commands(loaded.graph, loaded.pass_types, plan,
                                                            codes, environment, counts);
        if (!problem.empty()) return graph_error(fmt::format("{}: {}", counts.graph, problem));
      }
      add_works(loaded.pass_types, plan, settings);
      std::vector<vulkan::CompiledPipeline> pipelines;
      const vulkan::PipelinesInput request{.device = &device_,
                                           .pass_types = &loaded.pass_types,
                                           .plan = &plan,
                                           .kernels = codes,
                                           .environment = environment,
                                           .statistics = result.statistics,
                                           .assembly = !options_.assembly.empty(),
                                           .store = kernels_.get()};
      if (const vulkan::Error error = vulkan::compile_pipelines(request, pipelines))
        return demo::Error{demo::ErrorKind::environment,
                           fmt::format("{}: {}", counts.graph, error.text)};
      for (const vulkan::CompiledPipeline& pipeline : pipelines) {
        for (const uint32_t pass : pipeline.passes)
          if (is_default) counts.passes[pass].constants = pipeline.constants;
        if (!used.insert(pipeline.pipeline.get()).second) continue;
        ++counts.pipelines;
        add_rows(loaded.pass_types[pipeline.type], pipeline, counts.graph);
      }
    }
    return demo::success();
  }

  void add_works(const PassTypeRegistry& pass_types, const Plan& plan,
                 const std::vector<SettingValue>& settings) {
    const std::vector<PassTraffic> traffic = count_traffic(plan, pass_types, options_.assumptions);
    std::vector<choice::Work> works = choice::works_of(pass_types, plan, settings);
    for (size_t p = 0; p < works.size(); ++p) {
      if (!works[p].load.launches || !known_works_.insert(works[p].name).second) continue;
      const uint64_t groups =
          groups_of(works[p].load, {options_.size.width, options_.size.height, 0, 0, 0});
      result.works.push_back({std::move(works[p].name),
                              std::string(pass_types[plan.passes[p].type].shader), works[p].load,
                              groups, traffic[p]});
    }
  }

  void add_rows(const PassType& type, const vulkan::CompiledPipeline& pipeline,
                const std::string& graph) {
    const auto known = std::find_if(rows_of_.begin(), rows_of_.end(), [&](const auto& one) {
      return one.pipeline == pipeline.pipeline;
    });
    if (known != rows_of_.end()) {
      for (size_t row = known->first; row < known->end; ++row)
        result.kernels[row].graphs.push_back(graph);
      return;
    }
    const size_t first = result.kernels.size();
    for (KernelRow& row : make_rows(type.shader, pipeline.executables)) {
      row.constants = pipeline.constants;
      row.graphs.push_back(graph);
      result.kernels.push_back(std::move(row));
    }
    rows_of_.push_back({pipeline.pipeline, first, result.kernels.size()});
  }

  struct RowsOfPipeline {
    std::shared_ptr<const vulkan::Pipeline> pipeline;
    size_t first = 0, end = 0; // into KernelSurvey::kernels
  };

  const KernelsOptions& options_;
  Diagnostics& diagnostics_;
  std::unique_ptr<demo::VulkanHost> host_;
  vulkan::Device device_; // of host_
  CountingDevice counter_;
  DeviceProfile profile_;
  ShaderFolder folder_;
  abi::RuntimeShaders shaders_;
  std::vector<bool> pinned_; // settings of the present graph that --set gives
  std::set<std::string> known_names_, known_works_;
  std::unique_ptr<vulkan::KernelStore> kernels_; // declared after host_: destroyed before
  std::vector<RowsOfPipeline> rows_of_;
};

} // namespace

demo::Result<KernelSurvey> survey_kernels(const KernelsOptions& options, const Session& session,
                                          Diagnostics& diagnostics) {
  const std::vector<std::string> graphs = options.graphs.empty()
                                              ? graph_files(shipped("configs/graphs"))
                                              : shipped_files("graphs", options.graphs);
  if (graphs.empty()) return graph_error("there are no graph files in configs/graphs");
  Survey survey(options, diagnostics);
  if (auto opened = survey.open(); !opened) return opened.error();
  Progress progress(progress_style(session.quiet, session.json), "kernels", "graph", graphs.size());
  for (size_t g = 0; g < graphs.size(); ++g) {
    if (auto added = survey.add(graphs[g]); !added) return added.error();
    progress.update(g + 1);
  }
  if (std::string problem = survey.unknown_names(); !problem.empty())
    return demo::Error{demo::ErrorKind::usage, std::move(problem)};
  std::stable_sort(survey.result.kernels.begin(), survey.result.kernels.end(),
                   [](const KernelRow& a, const KernelRow& b) { return a.kernel < b.kernel; });
  std::sort(survey.result.works.begin(), survey.result.works.end(),
            [](const WorkRow& a, const WorkRow& b) { return a.work < b.work; });
  return std::move(survey.result);
}

} // namespace dermis::tools
