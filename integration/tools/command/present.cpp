#include "integration/tools/command/present.hpp"
#include "integration/tools/command/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <unistd.h>

namespace dermis::tools {
namespace {

constexpr double quiet_seconds = 2.0; // shorter work shows no progress
constexpr double bar_interval_seconds = 0.1;
constexpr double line_interval_seconds = 5.0;
constexpr uint64_t bar_cells = 24;

// Counts characters of UTF-8 text: bytes other than continuation bytes.
size_t characters(std::string_view text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u;
  }));
}

std::string pad(std::string_view text, size_t width, bool right_aligned) {
  const std::string space(width - std::min(width, characters(text)), ' ');
  return right_aligned ? space + std::string(text) : std::string(text) + space;
}

void append_line(std::string& out, std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  out += line + '\n';
}

void replace_first(std::string& text, std::string_view from, std::string_view color) {
  if (const size_t at = text.find(from); at != std::string::npos)
    text.replace(at, from.size(), fmt::format("\x1b[{}m{}\x1b[0m", color, from));
}

} // namespace

bool use_color(ColorMode mode, int file_descriptor) {
  if (mode != ColorMode::automatic) return mode == ColorMode::always;
  const char* term = std::getenv("TERM");
  return isatty(file_descriptor) != 0 && std::getenv("NO_COLOR") == nullptr && term != nullptr &&
         std::string_view(term) != "dumb";
}

std::string color_diagnostic(std::string_view formatted) {
  std::string text(formatted);
  const size_t first_line = text.find('\n');
  std::string head = text.substr(0, first_line);
  replace_first(head, "error", "1;31");
  replace_first(head, "warning", "1;33");
  replace_first(head, "note", "1;36");
  return first_line == std::string::npos ? head : head + text.substr(first_line);
}

std::string format_table(const Table& table) {
  std::vector<size_t> widths;
  for (const Table::Column& column : table.columns)
    widths.push_back(characters(column.title));
  for (const auto& row : table.rows)
    for (size_t i = 0; i < row.size(); ++i)
      widths[i] = std::max(widths[i], characters(row[i]));

  const auto line_of = [&](auto&& cell) {
    std::string line;
    for (size_t i = 0; i < widths.size(); ++i)
      line += (i == 0 ? "" : "  ") + pad(cell(i), widths[i], table.columns[i].right_aligned);
    return line;
  };
  const std::string rule = line_of([&](size_t i) { return std::string(widths[i], '-'); });

  std::string out;
  append_line(out, line_of([&](size_t i) { return table.columns[i].title; }));
  append_line(out, rule);
  for (const auto& row : table.rows)
    append_line(out, row.empty() ? rule : line_of([&](size_t i) { return row[i]; }));
  return out;
}

std::string format_milliseconds(double milliseconds) {
  return fmt::format("{:.{}f} ms", milliseconds,
                     milliseconds < 1.0    ? 3
                     : milliseconds < 10.0 ? 2
                                           : 1);
}

std::string format_duration(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<uint64_t>(seconds + 0.5);
  return fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

std::string format_bytes(uint64_t bytes) {
  constexpr std::string_view units[] = {"KiB", "MiB", "GiB", "TiB"};
  if (bytes < 1024) return fmt::format("{} B", bytes);
  double value = static_cast<double>(bytes) / 1024.0;
  size_t unit = 0;
  for (; value >= 1024.0 && unit + 1 < std::size(units); ++unit)
    value /= 1024.0;
  return fmt::format("{:.1f} {}", value, units[unit]);
}

std::string format_decibels(double decibels) {
  return fmt::format("{:.2f} dB", decibels);
}

std::string format_list(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text.append(text.empty() ? "" : ", ").append(word);
  return text;
}

std::string format_count(uint64_t count, std::string_view unit, bool being) {
  const bool one = count == 1;
  return fmt::format("{} {}{}{}", count, unit, one ? "" : "s", !being ? "" : one ? " is" : " are");
}

ProgressStyle progress_style(bool quiet, bool json) {
  if (quiet || json) return ProgressStyle::none;
  return isatty(STDERR_FILENO) != 0 ? ProgressStyle::bar : ProgressStyle::lines;
}

Progress::Progress(ProgressStyle style, std::string what, std::string unit, uint64_t total)
    : style_(style), what_(std::move(what)), unit_(std::move(unit)),
      total_(std::max<uint64_t>(total, 1)) {}

Progress::~Progress() {
  if (bar_visible_) std::fputs("\r\x1b[K", stderr);
}

void Progress::update(uint64_t done) {
  if (style_ == ProgressStyle::none) return;
  const std::scoped_lock lock(mutex_);
  const Clock::time_point now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double expected =
      done > 0 ? elapsed * static_cast<double>(total_) / static_cast<double>(done) : elapsed;
  const double interval =
      style_ == ProgressStyle::bar ? bar_interval_seconds : line_interval_seconds;
  if (expected < quiet_seconds ||
      std::chrono::duration<double>(now - last_drawn_).count() < interval)
    return;
  last_drawn_ = now;
  draw(std::min(done, total_), elapsed);
}

void Progress::draw(uint64_t done, double elapsed_seconds) {
  const double rate = elapsed_seconds > 0.0 ? static_cast<double>(done) / elapsed_seconds : 0.0;
  const double left = rate > 0.0 ? static_cast<double>(total_ - done) / rate : 0.0;
  const std::string pace = fmt::format("{} of {} {}s, {:.3g} {}s/s, {} left", done, total_, unit_,
                                       rate, unit_, format_duration(left));
  if (style_ == ProgressStyle::lines) {
    print_message(fmt::format("{}: {}\n", what_, pace));
    return;
  }
  const uint64_t filled = bar_cells * done / total_;
  print_message(fmt::format("\r{} [{}{}] {:3}% {}\x1b[K", what_, std::string(filled, '#'),
                            std::string(bar_cells - filled, '.'), 100 * done / total_, pace));
  std::fflush(stderr);
  bar_visible_ = true;
}

} // namespace dermis::tools
