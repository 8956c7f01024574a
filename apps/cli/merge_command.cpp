#include "apps/cli/bake_summary.h"
#include "apps/cli/cli.h"
#include "luxel/pipeline/bake/bake.h"
#include "luxel/pipeline/bake/merge_parts.h"

namespace luxel::cli {
namespace {

struct MergeOptions {
  Common common;
  std::vector<std::filesystem::path> parts;
  std::filesystem::path output, scene;
  std::string max_memory;
  Given reading, outside;
};

int run_merge(const MergeOptions& options) {
  auto settings = pipeline::settings_of_parts(options.parts);
  if (!settings) return report(settings.error(), options.common);
  settings->output = options.output, settings->threads = options.common.threads;
  if (!options.scene.empty()) settings->scene = options.scene;
  if (!options.max_memory.empty()) {
    const auto bytes = pipeline::parse_size(options.max_memory);
    if (!bytes) return report(bytes.error(), options.common);
    settings->max_memory_bytes = *bytes;
  }
  if (options.outside.has("--ies")) settings->outside.ies.clear();  // those given win
  if (const Status read =
          read_given(options.reading, pipeline::import_options(), settings->reading);
      !read)
    return report(read.error(), options.common);
  if (const Status read =
          read_given(options.outside, pipeline::outside_light_options(), settings->outside);
      !read)
    return report(read.error(), options.common);
  return run_and_print(
      options.common, [&](Progress& progress) { return pipeline::bake(*settings, progress); },
      [&](const nlohmann::json& json) { print_bake(*settings, json); });
}

}  // namespace

void register_merge(CLI::App& app, Action& action) {
  CLI::App* merge =
      app.add_subcommand("merge", "Finish a bake from the parts that `luxel bake --part` made");
  auto options = std::make_shared<MergeOptions>();
  merge->add_option("PART", options->parts, "Files of parts, or folders that hold them")
      ->required();
  merge->add_option("-o,--output", options->output, "Output folder; created if missing")
      ->required();
  merge
      ->add_option("--scene", options->scene,
                   "Scene file (default: the path that luxel bake --part was given, from the "
                   "current folder)")
      ->type_name("FILE");
  merge->add_option("--max-memory", options->max_memory, "Memory limit, as for luxel bake")
      ->type_name("SIZE");
  add_import(*merge, options->reading);
  add_outside_light(*merge, options->outside);
  add_common(*merge, options->common);
  merge->callback([options, &action] { action = [options] { return run_merge(*options); }; });
}

}  // namespace luxel::cli
