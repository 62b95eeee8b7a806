#include "integration/abi/compiled_graph.hpp"

#include "framegraph/compile/availability.hpp"

#include "framegraph/model/read_graph.hpp"
#include "framegraph/text/document.hpp"
#include "integration/abi/host_files.hpp"
#include "integration/abi/kernel_environment.hpp"
#include "integration/abi/memory_budget.hpp"
#include "integration/abi/slots.hpp"
#include "passes/choice/missing_rows.hpp"
#include "passes/common/pass_types.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::abi {
namespace {

// Returns the values of all settings: the host's value or the declared default. Host values that no
// longer fit are reported and replaced by the default.
std::vector<SettingValue> settings_of(const Graph& graph, const std::vector<HostSetting>& given,
                                      Diagnostics& diagnostics) {
  std::vector<SettingValue> values;
  for (const SettingDeclaration& declared : graph.settings)
    values.push_back(declared.default_value);
  for (const HostSetting& setting : given) {
    const auto at = std::find_if(
        graph.settings.begin(), graph.settings.end(),
        [&](const SettingDeclaration& declared) { return declared.name == setting.name; });
    Diagnostics scratch; // the value fitted the previous graph, so it is not an error of this graph
    std::optional<SettingValue> value;
    if (at != graph.settings.end()) value = read_setting(*at, setting.json, scratch);
    if (value)
      values[static_cast<size_t>(at - graph.settings.begin())] = *value;
    else
      diagnostics.add(DiagnosticId::setting_not_carried,
                      at != graph.settings.end() ? at->where : SourceLocation{},
                      fmt::format("setting '{}' = {} is not carried over: {}", setting.name,
                                  setting.json,
                                  at == graph.settings.end()
                                      ? "the new graph declares none of that name"
                                      : "the new declaration does not accept the value"));
  }
  return values;
}

// Marks settings that the host set; the library does not change them.
std::vector<bool> pinned_settings(const Graph& graph, const std::vector<HostSetting>& given) {
  std::vector<bool> pinned;
  for (const SettingDeclaration& declared : graph.settings)
    pinned.push_back(std::any_of(given.begin(), given.end(), [&](const HostSetting& setting) {
      Diagnostics scratch; // a value that does not fit was already reported
      return setting.name == declared.name &&
             read_setting(declared, setting.json, scratch).has_value();
    }));
  return pinned;
}

// Asks the host only once for each name.
FileText open_file(CompiledGraphInput& input, std::string_view name) {
  const auto known = input.included.find(name);
  if (known != input.included.end()) return {known->second.name, known->second.text, ""};
  FileText file = ask_host(input.include, input.include_user, name);
  if (file.problem.empty()) input.included.emplace(name, SourceText{file.name, file.text});
  return file;
}

std::optional<Composition> compose_sources(CompiledGraphInput& input, Diagnostics& diagnostics) {
  auto graph = parse_document(input.source_name, input.source_text, diagnostics);
  std::vector<Document> overlays;
  for (const SourceText& overlay : input.overlays)
    if (auto document = parse_document(overlay.name, overlay.text, diagnostics))
      overlays.push_back(std::move(*document));
  if (!graph || overlays.size() != input.overlays.size()) return std::nullopt;
  const OpenFile open = [&](std::string_view name) { return open_file(input, name); };
  return compose(std::move(*graph), std::move(overlays), open, diagnostics);
}

// Returns the values that settings have in frames of a plan.
std::vector<std::vector<SettingValue>>
settings_of_plan(const CompiledGraph& compiled_graph,
                 std::span<const choice::Configuration> configurations, uint32_t plan) {
  std::vector<std::vector<SettingValue>> settings;
  for (const choice::Configuration& configuration : configurations)
    if (configuration.plan == plan ||
        compiled_graph.plans[configuration.plan].without_bounds == plan)
      settings.push_back(configuration.settings);
  return settings;
}

// Creates one executor per plan. If there are several plans, they share memory.
vulkan::Error make_executors(dermis_context_t& context, CompiledGraphInput& input,
                             vulkan::HistoryReason history, vulkan::KernelStore& kernels,
                             CompiledGraph& compiled_graph) {
  const std::vector<vulkan::KernelCode> codes = kernel_codes(input.shaders);
  subsurface::TableUse use = subsurface::table_use(compiled_graph.graph, context.pass_types);
  if (use.pyramid.surface || use.pyramid.plain) use.pyramid.pixel_grid = input.pixel_grid;
  if (!input.tables || input.tables->use != use)
    if (vulkan::Error error = make_tables(context, use, input)) return error;
  const KernelEnvironment environment = kernel_environment(*input.tables);
  vulkan::ExecutorInput executor;
  executor.device = &context.device;
  executor.graph = &compiled_graph.graph;
  executor.pass_types = &context.pass_types;
  executor.kernels = codes;
  executor.environment = environment;
  if (vulkan::Error error = vulkan::ViewTables::create(input.device_tables, compiled_graph.tables))
    return error;
  executor.tables = compiled_graph.tables;
  executor.frames_in_flight = context.frames_in_flight;
  executor.pipeline_cache = context.pipeline_cache;
  executor.kernel_store = &kernels;
  executor.history = history;
  executor.host_pass = record_host_pass;
  executor.host_pass_user = &context.host_passes;
  if (compiled_graph.plans.size() > 1) {
    std::vector<const Plan*> plans;
    for (const RunnablePlan& plan : compiled_graph.plans)
      plans.push_back(&plan.compiled->plan);
    if (vulkan::Error error = vulkan::HeapPool::create(
            context.device, plans, context.history_memory, compiled_graph.heap_pool))
      return error;
  }
  executor.heap_pool = compiled_graph.heap_pool.get();
  for (uint32_t p = 0; p < compiled_graph.plans.size(); ++p) {
    RunnablePlan& plan = compiled_graph.plans[p];
    const auto settings = settings_of_plan(compiled_graph, compiled_graph.configurations, p);
    executor.settings = settings;
    executor.plan = &plan.compiled->plan;
    executor.kept_plan = {plan.compiled, executor.plan};
    if (vulkan::Error error = vulkan::Executor::create(executor, plan.executor)) return error;
  }
  return {};
}

void reserve_bindings(CompiledGraph& compiled_graph) {
  compiled_graph.images.resize(compiled_graph.slots.size());
  compiled_graph.buffers.resize(compiled_graph.slots.size());
  compiled_graph.structures.resize(compiled_graph.slots.size());
}

void name_options(CompiledGraph& compiled_graph) {
  for (const SettingDeclaration& declared : compiled_graph.graph.settings) {
    std::vector<const char*>& names = compiled_graph.option_names.emplace_back();
    for (const std::string& option : declared.options)
      names.push_back(option.c_str());
  }
}

bool is_accessed(const Slot& slot) {
  return slot.read || slot.written;
}

// Adds what another plan requires of a slot. Format, size and layout are those of the first plan
// that accesses the slot.
void merge_slot(Slot& slot, const Slot& other, const Graph& graph, Diagnostics& diagnostics) {
  if (is_accessed(slot) && is_accessed(other) && slot.format != other.format)
    diagnostics.add(
        DiagnosticId::host_format, graph.resources[slot.resource.value].where,
        fmt::format("slot '{}' has format {} in some configurations and {} in others; name a "
                    "format that all can use in dermis_graph_desc.formats",
                    slot.name, format_info(slot.format).name, format_info(other.format).name));
  Slot merged = is_accessed(slot) ? slot : other;
  merged.vk_usage = slot.vk_usage | other.vk_usage;
  merged.read = slot.read || other.read;
  merged.written = slot.written || other.written;
  merged.in_plan = slot.in_plan || other.in_plan;
  slot = std::move(merged);
}

// Merges the plans' requirements on images that the host must provide.
std::vector<Slot> slots_of(const CompiledGraph& compiled_graph, Diagnostics& diagnostics) {
  const auto slots_of_plan = [&](const RunnablePlan& plan) {
    const bool replaced = plan.without_bounds != no_plan; // passes are left out in that plan
    return make_slots(compiled_graph.graph, plan.compiled->plan,
                      replaced ? std::span<const uint8_t>() : plan.left_out);
  };
  std::vector<Slot> slots = slots_of_plan(compiled_graph.plans.front());
  for (const RunnablePlan& plan : compiled_graph.plans) {
    const std::vector<Slot> others = slots_of_plan(plan);
    for (size_t i = 0; i < slots.size(); ++i)
      merge_slot(slots[i], others[i], compiled_graph.graph, diagnostics);
  }
  return slots;
}

// Compiles the plan for frames with empty bounds that replaces plan `number`. Adds a reason for
// each pass of `instead_of` that the new plan turns off.
std::optional<CompiledPlan>
compile_without_bounds(const CompileInput& input,
                       const std::vector<choice::Configuration>& configurations, uint32_t number,
                       PlanCache& cache, CompiledPlan& instead_of, Diagnostics& diagnostics) {
  Graph graph = *input.graph;
  turn_scattering_off(graph, *input.pass_types);
  explain_lacking_inputs(graph, instead_of);
  // an export that no pass writes keeps its contents
  for (ResourceDeclaration& resource : graph.resources)
    if (resource.exported && resource.origin != Origin::imported) resource.optional = true;
  CompileInput one = input;
  one.graph = &graph;
  const auto runs = [&](const choice::Configuration& configuration) {
    return configuration.plan == number;
  };
  one.settings = std::find_if(configurations.begin(), configurations.end(), runs)->settings;
  Diagnostics reported; // warnings repeat those of the graph's own plans
  auto compiled = compile(one, cache, reported);
  for (Diagnostic& message : reported.list) {
    if (compiled) break;
    message.text += ", in frames with empty bounds";
    diagnostics.list.push_back(std::move(message));
  }
  return compiled;
}

// Compiles the plans of all configurations that fit into memory.
bool make_plans(const dermis_context_t& context, const CompileInput& compile_input,
                const choice::Combinations& combinations, const CompiledGraphInput& input,
                PlanCache& cache, const choice::ErrorModel& errors, choice::CostEstimator& costs,
                Diagnostics& diagnostics, CompiledGraph& candidate) {
  std::vector<PlanChoice> made;
  for (const uint32_t first : combinations.first) {
    CompileInput one = compile_input;
    one.settings = combinations.settings[first];
    auto compiled = compile(one, cache, diagnostics);
    if (!compiled) return false;
    made.push_back({std::move(*compiled), std::nullopt});
  }
  if (diagnostics.has_errors()) return false; // including errors of profiles and slots
  const auto plans_of = [&] {
    std::vector<const Plan*> plans;
    for (const PlanChoice& one : made)
      plans.push_back(&one.own.plan);
    return plans;
  };
  candidate.configurations =
      choice::make_configurations(compile_input, combinations, plans_of(), errors, costs);
  for (uint32_t p = 0; p < made.size(); ++p) {
    CompiledPlan& own = made[p].own;
    if (candidate.without_material ||
        !reads_what_is_left_out(candidate.graph, context.pass_types, own.plan))
      continue;
    made[p].without_bounds =
        compile_without_bounds(compile_input, candidate.configurations, p, cache, own, diagnostics);
    if (!made[p].without_bounds) return false;
  }
  if (input.max_bytes > 0)
    keep_within_memory(candidate.graph, errors, {input.max_bytes, context.history_memory}, made,
                       candidate.configurations, diagnostics);
  report_missing_rows(candidate.graph, context.pass_types, plans_of(), errors, costs,
                      candidate.configurations, diagnostics);
  auto number = static_cast<uint32_t>(made.size()); // of the next plan for empty bounds
  for (PlanChoice& one : made) {
    RunnablePlan& plan = candidate.plans.emplace_back();
    plan.left_out = left_out_without_bounds(context.pass_types, one.own.plan);
    plan.compiled = std::make_shared<const CompiledPlan>(std::move(one.own));
    if (one.without_bounds) plan.without_bounds = number++;
  }
  for (PlanChoice& one : made) {
    if (!one.without_bounds) continue;
    RunnablePlan& plan = candidate.plans.emplace_back();
    plan.left_out.assign(one.without_bounds->plan.passes.size(), 0);
    plan.compiled = std::make_shared<const CompiledPlan>(std::move(*one.without_bounds));
  }
  return true;
}

// Compiles the plans of candidate.graph and what depends on them. Returns false with errors in
// `diagnostics`.
bool compile_plans(const dermis_context_t& context, const CompiledGraphInput& input,
                   PlanCache& cache, const choice::ErrorModel& errors, choice::CostEstimator& costs,
                   Diagnostics& diagnostics, CompiledGraph& candidate) {
  candidate.without_material = input.profiles.empty();
  if (candidate.without_material) turn_scattering_off(candidate.graph, context.pass_types);
  candidate.settings = settings_of(candidate.graph, input.settings, diagnostics);

  CompileInput compile_input;
  compile_input.graph = &candidate.graph;
  compile_input.pass_types = &context.pass_types;
  compile_input.device = &context.profile;
  compile_input.view_width = input.width;
  compile_input.view_height = input.height;
  compile_input.pixel_grid = input.pixel_grid;
  compile_input.settings = candidate.settings;
  report_unknown_slots(candidate.graph, input.unbound, input.formats, diagnostics);
  compile_input.bound = bound_resources(candidate.graph, input.unbound, diagnostics);
  compile_input.host_formats = host_formats(candidate.graph, input.formats);
  report_unavailable(candidate.graph, context.profile, compile_input.bound, diagnostics);
  for (size_t i = 0; i < candidate.settings.size(); ++i)
    candidate.settings[i] = available_option(candidate.graph.settings[i], candidate.settings[i],
                                             context.profile.features, compile_input.bound);
  compile_input.settings = candidate.settings;
  const auto combinations = choice::enumerate_combinations(
      compile_input, diagnostics, pinned_settings(candidate.graph, input.settings));
  if (!combinations || !make_plans(context, compile_input, *combinations, input, cache, errors,
                                   costs, diagnostics, candidate))
    return false;
  candidate.settings = candidate.configurations.front().settings; // the default may not fit
  candidate.plan = candidate.configurations[candidate.configuration].plan;
  candidate.slots = slots_of(candidate, diagnostics);
  return !diagnostics.has_errors();
}

} // namespace

dermis_result rejected(dermis_context_t& context, const vulkan::Error& error,
                       Diagnostics& diagnostics) {
  diagnostics.add(diagnostic_of(error.kind), {}, error.text);
  if (error.kind == vulkan::ErrorKind::device_lost) context.lost = true;
  // The library built the executor's input, so an argument error is a defect of the library.
  return error.kind == vulkan::ErrorKind::argument ? DERMIS_ERROR_INTERNAL : result_of(error.kind);
}

PlanBytes bytes_of_plan(const CompiledGraph& compiled_graph, uint32_t plan) {
  const RunnablePlan& own = compiled_graph.plans[plan];
  PlanBytes bytes{own.compiled->plan.transient_bytes, own.compiled->plan.history_bytes};
  if (own.without_bounds == no_plan) return bytes;
  const Plan& instead = compiled_graph.plans[own.without_bounds].compiled->plan;
  return {std::max(bytes.transient, instead.transient_bytes),
          bytes.history + instead.history_bytes};
}

vulkan::Error make_tables(dermis_context_t& context, const subsurface::TableUse& use,
                          CompiledGraphInput& input) {
  auto tables = std::make_shared<const subsurface::KernelTables>(
      subsurface::make_kernel_tables(use, input.profiles, input.tables.get()));
  if (vulkan::Error error = vulkan::EnvironmentTables::create(
          context.device, kernel_environment(*tables), input.device_tables))
    return error;
  input.tables = std::move(tables);
  return {};
}

std::vector<choice::Configuration> described(const PassTypeRegistry& pass_types,
                                             const CompiledGraph& compiled_graph,
                                             const choice::ErrorModel& errors,
                                             choice::CostEstimator& costs,
                                             std::vector<choice::Configuration> configurations) {
  std::vector<const Plan*> plans;
  for (const RunnablePlan& plan : compiled_graph.plans)
    plans.push_back(&plan.compiled->plan);
  describe_configurations(pass_types, plans, errors, costs, configurations);
  return configurations;
}

std::vector<choice::Configuration>
configurations_with(const CompiledGraph& compiled_graph, const PassTypeRegistry& pass_types,
                    const choice::ErrorModel& errors, choice::CostEstimator& costs,
                    uint32_t setting, const SettingValue& value) {
  std::vector<choice::Configuration> configurations = compiled_graph.configurations;
  for (choice::Configuration& configuration : configurations)
    configuration.settings[setting] = value;
  return described(pass_types, compiled_graph, errors, costs, std::move(configurations));
}

vulkan::Error make_pipelines(dermis_context_t& context, const CompiledGraphInput& input,
                             const CompiledGraph& compiled_graph,
                             std::span<const choice::Configuration> configurations,
                             vulkan::KernelStore& kernels, NewPipelines& pipelines) {
  const std::vector<vulkan::KernelCode> codes = kernel_codes(input.shaders);
  vulkan::ExecutorInput executor;
  executor.pass_types = &context.pass_types;
  executor.kernels = codes;
  executor.pipeline_cache = context.pipeline_cache;
  executor.kernel_store = &kernels;
  pipelines.resize(compiled_graph.plans.size());
  for (uint32_t p = 0; p < compiled_graph.plans.size(); ++p) {
    const auto settings = settings_of_plan(compiled_graph, configurations, p);
    executor.settings = settings;
    if (vulkan::Error error =
            compiled_graph.plans[p].executor->make_pipelines(executor, pipelines[p]))
      return error;
  }
  return {};
}

dermis_result build_compiled_graph(dermis_context_t& context, CompiledGraphInput& input,
                                   vulkan::HistoryReason history, PlanCache& cache,
                                   const choice::ErrorModel& errors, choice::CostEstimator& costs,
                                   Diagnostics& diagnostics,
                                   std::shared_ptr<CompiledGraph>& compiled_graph) {
  auto composition = compose_sources(input, diagnostics);
  if (!composition) return DERMIS_ERROR_CONFIG;
  const size_t reported = diagnostics.list.size();
  auto graph = read_graph(composition->document, context.pass_types, diagnostics);
  if (!graph) {
    relate_to_removals(composition->changes, reported, diagnostics);
    return DERMIS_ERROR_CONFIG;
  }
  auto candidate = std::make_shared<CompiledGraph>();
  candidate->graph = std::move(*graph);
  candidate->changes = std::move(composition->changes);
  for (const SourceFile& file : diagnostics.files)
    candidate->files.push_back({file.name, ""});
  const bool compiled =
      compile_plans(context, input, cache, errors, costs, diagnostics, *candidate);
  relate_to_removals(candidate->changes, reported, diagnostics);
  if (!compiled) return DERMIS_ERROR_CONFIG;
  reserve_bindings(*candidate);
  name_options(*candidate);

  candidate->kernels = std::make_unique<vulkan::KernelStore>(context.kernels);
  if (!compile_missing(input.shaders, candidate->graph, context.pass_types, diagnostics))
    return DERMIS_ERROR_SHADER;
  if (const vulkan::Error error =
          make_executors(context, input, history, *candidate->kernels, *candidate))
    return rejected(context, error, diagnostics);
  compiled_graph = std::move(candidate);
  return DERMIS_OK;
}

void share_kernels(CompiledGraph& compiled_graph) noexcept {
  if (compiled_graph.kernels == nullptr) return;
  compiled_graph.kernels->hand_over();
  compiled_graph.kernels.reset();
}

dermis_result copy_compiled_graph(dermis_context_t& context, CompiledGraphInput& input,
                                  const CompiledGraph& of, vulkan::HistoryReason history,
                                  Diagnostics& diagnostics,
                                  std::shared_ptr<CompiledGraph>& compiled_graph) {
  auto candidate = std::make_shared<CompiledGraph>();
  candidate->without_material = of.without_material;
  candidate->graph = of.graph;
  candidate->changes = of.changes;
  candidate->files = of.files;
  candidate->configurations = of.configurations;
  for (const RunnablePlan& plan : of.plans)
    candidate->plans.push_back({plan.compiled, nullptr, false, plan.without_bounds, plan.left_out});
  candidate->plan = candidate->configurations[candidate->configuration].plan;
  candidate->settings = of.settings;
  candidate->slots = of.slots;
  reserve_bindings(*candidate);
  name_options(*candidate);
  if (of.kernels == nullptr)
    candidate->kernels = std::make_unique<vulkan::KernelStore>(context.kernels);
  vulkan::KernelStore& kernels = of.kernels != nullptr ? *of.kernels : *candidate->kernels;
  if (const vulkan::Error error = make_executors(context, input, history, kernels, *candidate))
    return rejected(context, error, diagnostics);
  compiled_graph = std::move(candidate);
  return DERMIS_OK;
}

} // namespace dermis::abi
