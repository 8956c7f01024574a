#include "bench/validation.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/bench.h"
#include "bench/timing.h"
#include "luxel/base/file.h"
#include "luxel/base/parallel.h"
#include "luxel/pipeline/settings/version.h"
#include "luxel/validate/prepared.h"

namespace luxel::bench {

std::string markdown_table(const std::vector<std::string>& columns,
                           const std::vector<std::vector<std::string>>& rows) {
  std::string text;
  const auto add = [&](const std::vector<std::string>& cells) {
    for (const std::string& cell : cells) text += "| " + cell + " ";
    text += "|\n";
  };
  add(columns);
  add(std::vector<std::string>(columns.size(), "---"));
  for (const auto& cells : rows) add(cells);
  return text;
}

PageFile svg_file(std::string name, const std::string& svg) {
  return {name, text_file(name, svg).bytes};
}

PageFile png_file(std::string name, const image::Image8& picture) {
  return {std::move(name), image::encode_png(picture)};
}

std::string show(const PageFile& file, std::string_view words) {
  return fmt::format("![{}](../images/validation-{})", words, file.name);
}

std::string wrapped(std::string_view markdown) {
  constexpr size_t kWidth = 120;
  constexpr std::string_view kWhole = "|!# ";  // what a line begins with that is not prose
  std::string out;
  while (!markdown.empty()) {
    const size_t end = std::min(markdown.find('\n'), markdown.size());
    std::string_view line = markdown.substr(0, end);
    const bool prose = !line.empty() && kWhole.find(line.front()) == std::string_view::npos;
    while (prose && line.size() > kWidth) {
      const size_t space = line.rfind(' ', kWidth);
      if (space == std::string_view::npos || space == 0) break;
      out += std::string(line.substr(0, space)) + "\n";
      line.remove_prefix(space + 1);
    }
    out += line;
    if (end < markdown.size()) out += '\n';
    markdown.remove_prefix(std::min(end + 1, markdown.size()));
  }
  return out;
}

Result<Page> validate(const std::filesystem::path& shared, Progress& progress) {
  const std::clock_t start = std::clock();
  Page page;
  page.json = nlohmann::json::object();
  std::string body;
  const auto add = [&](std::string_view name, Result<Section> section) -> Status {
    if (!section) return Failure{section.error()};
    body += section->markdown + "\n";
    page.json[std::string(name)] = std::move(section->json);
    for (PageFile& file : section->files) page.files.push_back(std::move(file));
    return {};
  };
  // All sections, then what stands above them.
  LUXEL_TRY_STATUS(add("view_factors", validate_view_factors(shared, progress)));
  LUXEL_TRY_STATUS(add("exact_solutions", validate_exact_solutions(shared, progress)));
  LUXEL_TRY_STATUS(add("agreement", validate_agreement(progress)));
  LUXEL_TRY_STATUS(add("cornell_box", validate_cornell_box(progress)));
  LUXEL_TRY_STATUS(add("stated_errors", validate_stated_errors({}, progress)));
  page.markdown = fmt::format(
      "# Validation\n\n"
      "Is luxel right? One command, `luxel bench validation`, computed and wrote everything on "
      "this page: view factors against closed forms, and solvers against exact solutions and a "
      "brute-force path tracer. The path tracer shares only the scene and the ray tracer with the "
      "solvers ([reference.md](../method/reference.md)).\n\n"
      "This run: version {}, {}, {} threads, {:.0f} processor seconds. The exact values are those "
      "of `shared/reference`.\n\n",
      pipeline::kVersion, machine_name(), thread_count(), processor_seconds_since(start));
  page.markdown = wrapped(page.markdown + body);
  while (page.markdown.ends_with("\n\n")) page.markdown.pop_back();
  return page;
}

}  // namespace luxel::bench
