// Runs glslang as the build does (shaders/CMakeLists.txt), so that an unchanged kernel gives the
// same SPIR-V.
#include "framegraph/text/limits.hpp"
#include "integration/abi/memory/host_memory.hpp"
#include "integration/abi/shaders/compiler.hpp"
#include "passes/glsl_bindings/bindings.hpp"

#include <fmt/format.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <glslang/build_info.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>

namespace dermis::abi {
namespace {

constexpr size_t include_nesting = 16;
constexpr size_t includes = 256;     // per kernel; repeated includes count each time
constexpr int default_version = 100; // of a text without #version, as in glslangValidator

// glslang's process-wide state.
struct Process {
  Process() { glslang::InitializeProcess(); }
  ~Process() { glslang::FinalizeProcess(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
};

// Files of one kernel, by the name that glslang uses.
using Files = std::map<std::string, FileText, std::less<>>;

std::string why_not_to_be_opened(std::string_view name) {
  Diagnostics found;
  return check_file_name(name, fmt::format("'{}'", name), {}, found) ? "" : found.list.front().text;
}

class Includer final : public glslang::TShader::Includer {
public:
  Includer(const std::vector<GeneratedFile>& generated, const OpenFile& open, Files& files)
      : generated_(generated), open_(open), files_(files) {}

  // If this returns null, glslang calls includeSystem and takes the message from there.
  IncludeResult* includeLocal(const char* header, const char*, size_t depth) override {
    problem_.clear();
    if (depth > include_nesting)
      return reject(fmt::format("more than {} files include each other", include_nesting));
    if (++count_ > includes)
      return reject(fmt::format("more than {} files are included", includes));
    const std::string name = header;
    for (const GeneratedFile& file : generated_)
      if (file.name == name) return keep(name, {name, file.text, ""});
    if (std::string problem = why_not_to_be_opened(name); !problem.empty()) return reject(problem);
    if (const auto known = files_.find(name); known != files_.end()) return give(*known);
    FileText file = open_(name);
    if (!file.problem.empty()) return reject(fmt::format("'{}': {}", name, file.problem));
    return keep(name, std::move(file));
  }
  IncludeResult* includeSystem(const char*, const char*, size_t) override {
    if (problem_.empty()) problem_ = "only #include \"FILE\" is known";
    return new IncludeResult("", problem_.data(), problem_.size(), nullptr);
  }
  void releaseInclude(IncludeResult* result) override { delete result; }

private:
  static IncludeResult* give(const Files::value_type& file) {
    return new IncludeResult(file.first, file.second.text.data(), file.second.text.size(), nullptr);
  }
  IncludeResult* keep(std::string name, FileText file) {
    return give(*files_.try_emplace(std::move(name), std::move(file)).first);
  }
  IncludeResult* reject(std::string problem) {
    problem_ = std::move(problem);
    return nullptr;
  }

  const std::vector<GeneratedFile>& generated_;
  const OpenFile& open_;
  Files& files_;
  size_t count_ = 0;
  std::string problem_; // of the include that was rejected last
};

struct CompilerMessage {
  FileText file;
  uint32_t line = 0, column = 0;
  std::string text;
};

// Returns the column, from 1, where the word that the message quotes first occurs. glslang
// reports no columns.
uint32_t column_of(std::string_view line, std::string_view message) {
  const size_t begin = message.find('\''), end = message.find('\'', begin + 1);
  const auto in_word = [&](size_t at) {
    return at < line.size() &&
           (std::isalnum(static_cast<unsigned char>(line[at])) != 0 || line[at] == '_');
  };
  if (end != std::string_view::npos && end > begin + 1) {
    const std::string_view word = message.substr(begin + 1, end - begin - 1);
    for (size_t at = line.find(word); at != std::string_view::npos; at = line.find(word, at + 1))
      if (!in_word(at + word.size()) && (at == 0 || !in_word(at - 1)))
        return static_cast<uint32_t>(at + 1);
  }
  const size_t first = line.find_first_not_of(" \t");
  return static_cast<uint32_t>(first == std::string_view::npos ? 1 : first + 1);
}

std::string_view line_of(std::string_view text, uint32_t number) {
  for (uint32_t line = 1; line < number; ++line) {
    const size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

// Parses "ERROR: afis/afis.glsl:12: 'x' : undeclared identifier", one per line. Ignores glslang's
// summary.
std::vector<CompilerMessage> messages_in(std::string_view log, const std::string& kernel,
                                         const Files& files) {
  constexpr std::string_view mark = "ERROR: ";
  std::vector<CompilerMessage> found;
  std::string rest;
  for (; !log.empty(); log.remove_prefix(std::min(log.find('\n'), log.size() - 1) + 1)) {
    std::string_view line = log.substr(0, log.find('\n'));
    if (line.substr(0, mark.size()) != mark) continue;
    line.remove_prefix(mark.size());
    const size_t name_end = line.find(':');
    const auto file = files.find(line.substr(0, name_end));
    uint32_t number = 0;
    const char* const begin = line.data() + std::min(name_end + 1, line.size());
    const auto [end, code] = std::from_chars(begin, line.data() + line.size(), number);
    if (file == files.end() || code != std::errc()) {
      if (rest.empty()) rest = line;
      continue;
    }
    std::string text(end, line.data() + line.size());
    text.erase(0, std::min(text.find_first_not_of(": "), text.size()));
    if (text.find("compilation terminated") != std::string::npos && !found.empty()) continue;
    text.erase(text.find_last_not_of(' ') + 1);
    const uint32_t column = column_of(line_of(file->second.text, number), text);
    constexpr std::string_view nothing_quoted = "'' :";
    if (text.starts_with(nothing_quoted))
      text.erase(0, std::min(text.find_first_not_of(' ', nothing_quoted.size()), text.size()));
    found.push_back({file->second, number, column, std::move(text)});
  }
  if (found.empty())
    found.push_back(
        {files.at(kernel), 0, 0, rest.empty() ? std::string("glslang rejects it") : rest});
  return found;
}

struct Answer {
  std::vector<uint32_t> spirv;
  std::vector<CompilerMessage> messages;
};

Answer compile_one(const std::string& shader, const std::vector<GeneratedFile>& generated,
                   const OpenFile& open) {
  const std::string name = shader + ".comp";
  FileText file = open(name);
  if (!file.problem.empty()) return {};
  Files files;
  const FileText& kept = files.try_emplace(name, std::move(file)).first->second;
  const char* const text = kept.text.data();
  const char* const text_name = name.c_str();
  const int length = static_cast<int>(kept.text.size()); // at most limits::file_bytes
  glslang::TShader compiled(EShLangCompute);
  compiled.setStringsWithLengthsAndNames(&text, &length, &text_name, 1);
  compiled.setEnvInput(glslang::EShSourceGlsl, EShLangCompute, glslang::EShClientVulkan, 100);
  compiled.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_2);
  compiled.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);
  constexpr auto rules = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
  Includer includer(generated, open, files);
  if (!compiled.parse(GetDefaultResources(), default_version, false, rules, includer))
    return {{}, messages_in(compiled.getInfoLog(), name, files)};
  glslang::TProgram program;
  program.addShader(&compiled);
  if (!program.link(rules)) return {{}, messages_in(program.getInfoLog(), name, files)};
  Answer answer;
  glslang::GlslangToSpv(*program.getIntermediate(EShLangCompute), answer.spirv);
  return answer;
}

FileId file_id(const FileText& file, Diagnostics& diagnostics) {
  const auto known = std::find_if(diagnostics.files.begin(), diagnostics.files.end(),
                                  [&](const SourceFile& one) { return one.name == file.name; });
  const FileId id{static_cast<uint32_t>(known - diagnostics.files.begin())};
  if (known == diagnostics.files.end()) diagnostics.files.push_back({file.name, file.text});
  return id;
}

} // namespace

std::string shader_compiler() {
  return fmt::format("glslang {}.{}.{}", GLSLANG_VERSION_MAJOR, GLSLANG_VERSION_MINOR,
                     GLSLANG_VERSION_PATCH);
}

bool compile_shaders(std::span<const std::string> shaders, const OpenFile& open,
                     std::vector<std::vector<uint32_t>>& spirv, Diagnostics& diagnostics) {
  std::vector<Answer> answers;
  {
    const MemoryScope memory(HostAllocator{}); // glslang does not handle allocation failures
    const Process process;
    const std::vector<GeneratedFile> generated = generated_glsl();
    for (const std::string& shader : shaders)
      answers.push_back(compile_one(shader, generated, open));
  }
  // Copies, so that the result is in the host's memory.
  spirv.clear();
  bool fine = true;
  // errors of a file that many kernels include are reported once
  std::vector<const CompilerMessage*> reported;
  for (const Answer& answer : answers) {
    spirv.emplace_back(answer.spirv.begin(), answer.spirv.end());
    for (const CompilerMessage& one : answer.messages) {
      fine = false;
      const bool again =
          std::any_of(reported.begin(), reported.end(), [&](const CompilerMessage* other) {
            return other->file.name == one.file.name && other->line == one.line &&
                   other->text == one.text;
          });
      if (again) continue;
      reported.push_back(&one);
      diagnostics.add(DiagnosticId::shader_error,
                      {file_id(one.file, diagnostics), one.line, one.column, ""}, one.text);
    }
  }
  return fine;
}

} // namespace dermis::abi
