#include "campaigns/engine/store.h"

namespace puckloop::faults {

namespace {

constexpr jobs::Database::Form kForm{"campaign", "puckloop faults campaign", R"(
create table if not exists phases(phase text primary key);
create table if not exists cases(id integer primary key, phase text not null, sweep text not null,
    place text not null, seed text not null, faults text not null, pruned text not null, whole text not null);
create table if not exists results(id integer primary key references cases(id), outcome text not null,
    fired text not null, first_s real, recovery_s real, departure_m real, detail text not null,
    trace_sha256 text not null, whole text not null);
)",
                                     "select 1 from cases, results limit 1"};

}  // namespace

using jobs::Statement;

Store::Store(const std::filesystem::path& file, Access access) : database_(file, access, kForm) {}

bool Store::planned(const std::string& phase) const {
    return Statement(database_, "select 1 from phases where phase = ?").bind(phase).next();
}

int Store::last_id() const {
    Statement select(database_, "select coalesce(max(id), 0) from cases");
    select.next();
    return std::stoi(select.text(0));
}

void Store::plan(const std::string& phase, const std::vector<Case>& cases) {
    database_.transaction([&] {
        for (const Case& one : cases)
            Statement(database_, "insert into cases values(?, ?, ?, ?, ?, ?, ?, ?)")
                .bind(one.id)
                .bind(one.phase)
                .bind(one.sweep)
                .bind(one.place)
                .bind(std::to_string(one.seed))
                .bind(in_one_line(one.faults))
                .bind(one.pruned)
                .bind(to_json(one).dump())
                .next();
        Statement(database_, "insert into phases values(?)").bind(phase).next();
    });
}

std::vector<Case> Store::select(const char* sql, const std::string& phase) const {
    std::vector<Case> list;
    Statement rows(database_, sql);
    rows.bind(phase);
    while (rows.next())
        list.push_back(case_from_json(nlohmann::json::parse(rows.text(0))));
    return list;
}

std::vector<Case> Store::cases(const std::string& phase) const {
    return select("select whole from cases where phase = ? order by id", phase);
}

std::vector<Case> Store::pending(const std::string& phase) const {
    return select(
        "select whole from cases where phase = ? and pruned = '' and id not in (select id from results) "
        "order by id",
        phase);
}

std::vector<Case> Store::pruned() const {
    return select("select whole from cases where pruned <> ?  order by id", "");
}

void Store::add_result(int id, const nlohmann::json& verdict) {
    Statement(database_, "insert or ignore into results values(?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .bind(id)
        .bind(verdict.at("outcome").get<std::string>())
        .bind(verdict.at("fired").dump())
        .bind(verdict.at("first_s"))
        .bind(verdict.at("recovery_s"))
        .bind(verdict.at("departure_m"))
        .bind(verdict.at("detail").get<std::string>())
        .bind(verdict.at("trace_sha256").get<std::string>())
        .bind(verdict.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))
        .next();
}

std::vector<CaseResult> Store::results() const {
    std::vector<CaseResult> list;
    Statement rows(database_,
                   "select cases.whole, results.whole from results join cases using(id) order by id");
    while (rows.next())
        list.push_back({case_from_json(nlohmann::json::parse(rows.text(0))),
                        verdict_from_json(nlohmann::json::parse(rows.text(1)))});
    return list;
}

}  // namespace puckloop::faults
