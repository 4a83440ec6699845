#include "campaigns/experiment/experiment_store.h"

namespace puckloop::swarm {

namespace {

constexpr jobs::Database::Form kForm{"experiment", "puckloop experiment", R"(
create table if not exists runs(id integer primary key, program text not null, condition text not null,
    seed text not null);
create table if not exists results(id integer primary key references runs(id), score real, failed text not null,
    simulated_s real, wall_s real, trace_sha256 text not null, whole text not null);
)",
                                     "select 1 from runs, results limit 1"};

}  // namespace

using jobs::Statement;

ExperimentStore::ExperimentStore(const std::filesystem::path& file, Access access)
    : database_(file, access, kForm) {}

void ExperimentStore::plan(const Experiment& experiment, const std::vector<Run>& runs) {
    database_.transaction([&] {
        for (const Run& run : runs)
            Statement(database_, "insert or ignore into runs values(?, ?, ?, ?)")
                .bind(run.id)
                .bind(experiment.programs.at(run.program).name)
                .bind(experiment.conditions.at(run.condition).name)
                .bind(std::to_string(run.seed))
                .next();
    });
}

void ExperimentStore::add_result(int id, const nlohmann::json& result) {
    Statement(database_, "insert or ignore into results values(?, ?, ?, ?, ?, ?, ?)")
        .bind(id)
        .bind(result.at("score"))
        .bind(result.at("failed").get<std::string>())
        .bind(result.at("simulated_s"))
        .bind(result.at("wall_s"))
        .bind(result.at("trace_sha256").get<std::string>())
        .bind(result.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))
        .next();
}

std::map<int, RunResult> ExperimentStore::results() const {
    std::map<int, RunResult> results;
    Statement rows(database_, "select id, whole from results order by id");
    while (rows.next())
        results[std::stoi(rows.text(0))] = result_from_json(nlohmann::json::parse(rows.text(1)));
    return results;
}

}  // namespace puckloop::swarm
