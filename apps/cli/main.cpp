// The `luxel` command: argv in, exit code out. Each subcommand is a file beside this one.
#include <csignal>
#include <cstdio>
#include <exception>

#include "apps/cli/cli.h"
#include "pipeline/version.h"

namespace {

int run(int argc, char** argv) {
  using namespace luxel::cli;
  CLI::App app{
      "luxel: diffuse global illumination. A scene in, lightmaps out.\n"
      "Try: luxel bake SCENE -o FOLDER"};
  app.set_version_flag("--version", std::string("luxel ") + luxel::pipeline::kVersion);
  app.require_subcommand(1);
  Action action;
  register_bake(app, action);
  register_render(app, action);
  register_info(app, action);
  register_bench(app, action);
  if (argc == 1) {
    std::fputs(app.help().c_str(), stderr);
    return kUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Help and version end with code 0; everything else is wrong usage.
    return app.exit(error) == 0 ? kDone : kUsage;
  }
  return action();
}

}  // namespace

int main(int argc, char** argv) {
  // Only the thread that shows progress takes Ctrl-C; every thread inherits this mask.
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGINT);
  sigaddset(&stop, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("luxel: out of memory; lower --resolution or --samples, or set --max-memory\n",
               stderr);
    return luxel::cli::kOutOfResource;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "luxel: internal error: %s; please report this\n", error.what());
    return luxel::cli::kBadInput;
  }
}
