#include "luxel/pipeline/bake/bake_team.h"

#include <nlohmann/json.hpp>

#include "luxel/base/shown_text.h"
#include "luxel/pipeline/reuse/checkpoint.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {
namespace {

/// Solvers that know teams, for messages.
std::string solvers_with_teams() {
  std::string out;
  for (const Solver& solver : solvers())
    if (solver.can.teams) out += (out.empty() ? "" : ", ") + std::string(solver.name);
  return out;
}

}  // namespace

Status check_team(const Team* team, const BakeSettings& settings, bool has_device) {
  if (!team) return {};
  const auto refuse = [&](const std::string& option) {
    return fail(ErrorCode::bad_setting,
                "{0} needs a single process, but {1} work together; leave out {0} or mpirun",
                option, team->size());
  };
  if (!find_solver(settings.solver)->can.teams)
    return fail(ErrorCode::bad_setting,
                "--solver {} needs a single process, but {} work together; leave mpirun out, or "
                "choose a solver that shares its work: {}",
                settings.solver, team->size(), solvers_with_teams());
  if (!settings.part.is_all())
    return refuse(fmt::format("--part {}/{}", settings.part.number, settings.part.of));
  if (settings.keep) return refuse("--keep");
  if (has_device) return refuse("--device");
  return {};
}

Status check_same_settings(Team* team, const nlohmann::json& identity, Progress& progress) {
  if (!team) return {};
  // Names of things may be no UTF-8, which JSON knows nothing else of.
  const std::string own = json_text(identity);
  LUXEL_TRY(const auto all, team->all_gather(std::as_bytes(std::span(own)), progress));
  const auto read = [&](size_t rank) {
    const auto* text = reinterpret_cast<const char*>(all[rank].data());
    return nlohmann::json::parse(text, text + all[rank].size(), nullptr, false);
  };
  for (size_t rank = 1; rank < all.size(); ++rank)
    if (all[rank] != all[0])
      return fail(ErrorCode::bad_setting,
                  "process {} (there) has other settings than process 0 (here): {}; start all with "
                  "the same command",
                  rank, difference(read(rank), read(0)));
  return {};
}

Result<std::vector<std::string>> failures_of_others(Team* team, const std::string& own,
                                                    Progress& progress) {
  std::vector<std::string> out;
  if (!team) return out;
  LUXEL_TRY(const auto all, team->all_gather(std::as_bytes(std::span(own)), progress));
  for (size_t rank = 0; rank < all.size(); ++rank)
    if (rank != team->rank() && !all[rank].empty())
      out.push_back(fmt::format(
          "process {}: {}", rank,
          std::string_view(reinterpret_cast<const char*>(all[rank].data()), all[rank].size())));
  return out;
}

nlohmann::json about_team(const Team* team) {
  if (!team) return nullptr;
  const Team::Gathered all = team->gathered();
  return {{"processes", team->size()}, {"exchanges", all.times}, {"bytes", all.bytes}};
}

}  // namespace luxel::pipeline
