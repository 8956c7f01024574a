#include "luxel/pipeline/solver/bake_options.h"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "luxel/base/file.h"
#include "luxel/pipeline/settings/bake_settings_options.h"
#include "luxel/pipeline/solver/solvers.h"

namespace luxel::pipeline {
namespace {

using Row = Option<BakeSettings>;
using nlohmann::json;

/// "gather, matrix": those of all solvers.
std::string names_of(const std::function<bool(const Solver&)>& wanted) {
  std::string names;
  for (const Solver& solver : solvers())
    if (wanted(solver)) names += (names.empty() ? "" : ", ") + std::string(solver.name);
  return names;
}

/// The rows that count for a solver: its own, and those that are nobody's own.
bool may_concern(const Row& row, std::string_view solver) {
  return row.solver.empty() || row.solver == solver;
}

/// Where a row's value stands in JSON: beside the others, or in its solver's object.
json* place_of(const Row& row, json& settings) {
  return row.solver.empty() ? &settings : &settings[row.solver];
}

Status check_capabilities(const Solver& solver, const BakeSettings& settings) {
  static const BakeSettings defaults;
  for (const Row& row : bake_options()) {
    if (!row.refused_without || looks_at(solver, row)) continue;
    if (row.to_json(settings) != row.to_json(defaults))
      return option_of(solver, row.flag).map([](auto) {});
  }
  return {};
}

/// The settings as JSON, of rows whose value matters.
json json_of(const BakeSettings& settings, const std::function<bool(const Row&)>& matters) {
  json out = json::object();
  for (const Row& row : bake_options()) {
    if (row.key.empty() || !may_concern(row, settings.solver) || !matters(row)) continue;
    json value = row.to_json(settings);
    if (!value.is_null()) (*place_of(row, out))[row.key] = std::move(value);
  }
  return out;
}

/// Files are known by what they hold, which scenes have digests of: where they lie does not matter.
void drop_file_names(json& value) {
  if (value.is_object()) value.erase("file");
  if (value.is_structured())
    for (json& part : value) drop_file_names(part);
}

/// A key of bake.json's settings that stood in its solver's object. It is written and read there as
/// well until version 0.2.
constexpr std::string_view kMovedKey = "vertex_colors", kMovedFrom = "hemicube";

/// Reads one value, where an option has that key. Errors: none has, or the value is wrong.
Status read_value(const std::string& key, const json& value, std::string_view solver,
                  BakeSettings& settings) {
  for (const Row& row : bake_options())
    if (row.key == key && row.solver == solver) return row.read_json(settings, value);
  return fail(ErrorCode::bad_setting, "there is no setting '{}{}{}'", solver,
              solver.empty() ? "" : ".", key);
}

Status read_object(const json& object, BakeSettings& settings) {
  for (const auto& [key, value] : object.items()) {
    if (key == "scene" || key == "solver") continue;  // read before
    if (find_solver(key) && value.is_object()) {
      for (const auto& [inner, of_solver] : value.items()) {
        const bool moved = key == kMovedFrom && inner == kMovedKey;
        LUXEL_TRY_STATUS(read_value(inner, of_solver, moved ? "" : key, settings));
      }
    } else {
      LUXEL_TRY_STATUS(read_value(key, value, "", settings));
    }
  }
  return {};
}

}  // namespace

const Options<BakeSettings>& bake_options() {
  static const Options<BakeSettings> table = [] {
    Options<BakeSettings> rows = bake_settings_options();
    for (const Solver& solver : solvers())
      rows.insert(rows.end(), solver.options.begin(), solver.options.end());
    return rows;
  }();
  return table;
}

bool looks_at(const Solver& solver, const Row& row) {
  if (!row.solver.empty()) return row.solver == solver.name;
  return row.needs == nullptr || solver.can.*row.needs;
}

std::string solvers_with(const Row& row) {
  return names_of([&](const Solver& solver) { return looks_at(solver, row); });
}

std::string solvers_with(std::string_view flag) {
  return names_of([&](const Solver& solver) {
    if (flag == "--plan") return solver.plan != nullptr;
    return std::any_of(bake_options().begin(), bake_options().end(),
                       [&](const Row& row) { return row.flag == flag && looks_at(solver, row); });
  });
}

Result<const Row*> option_of(const Solver& solver, std::string_view flag) {
  for (const Row& row : bake_options())
    if (row.flag == flag && looks_at(solver, row)) return &row;
  return not_used(fmt::format("--solver {}", solver.name), flag, solvers_with(flag));
}

Status check(const BakeSettings& s) {
  const Solver* solver = find_solver(s.solver);
  if (!solver)
    return fail(ErrorCode::bad_setting, "--solver {} is not known; choose from: {}", s.solver,
                solver_names());
  for (const Row& row : bake_options())
    if (may_concern(row, solver->name)) LUXEL_TRY_STATUS(row.check(s));
  LUXEL_TRY_STATUS(check_contradictions(s));
  if (solver->check) LUXEL_TRY_STATUS(solver->check(s));
  return check_capabilities(*solver, s);
}

json to_json(const BakeSettings& settings) {
  json out = json_of(settings, [](const Row&) { return true; });
  out["scene"] = settings.scene.string(), out["solver"] = settings.solver;
  if (out.contains(kMovedFrom)) out[kMovedFrom][kMovedKey] = out[kMovedKey];
  return out;
}

Status read_json(const json& all, BakeSettings& settings) {
  const json& object = all.contains("settings") ? all["settings"] : all;
  if (!object.is_object()) return fail(ErrorCode::bad_setting, "it has no settings");
  try {
    if (object.contains("scene")) settings.scene = object["scene"].get<std::string>();
    if (object.contains("solver")) settings.solver = object["solver"].get<std::string>();
    return read_object(object, settings);
  } catch (const json::exception&) {
    return fail(ErrorCode::bad_setting, "a value has the wrong type");
  }
}

Status read_settings(const std::filesystem::path& file, BakeSettings& settings) {
  LUXEL_TRY(const std::vector<std::byte> bytes, read_file(file));
  const char* begin = reinterpret_cast<const char*>(bytes.data());
  const json all = json::parse(begin, begin + bytes.size(), nullptr, false);
  if (all.is_discarded())
    return fail(ErrorCode::bad_input, "{} is not JSON; give the bake.json of an earlier bake",
                file.string());
  const Status done = read_json(all, settings);
  if (done) return {};
  return fail(done.error().code, "{}: {}", file.string(), done.error().message);
}

json settings_of_checkpoint(const BakeSettings& settings) {
  json out = json_of(settings, [](const Row& row) { return row.changes != Changes::nothing; });
  for (const Row& row : bake_options())
    if (row.changes == Changes::scene && out.contains(row.key)) drop_file_names(out[row.key]);
  out["solver"] = settings.solver;
  return out;
}

json settings_of_kept_bake(const BakeSettings& settings) {
  json out = json_of(settings, [](const Row& row) { return row.changes == Changes::light; });
  out["solver"] = settings.solver;
  return out;
}

}  // namespace luxel::pipeline
