#include "campaigns/engine/store.h"

#include "base/error.h"

#include <fmt/format.h>
#include <sqlite3.h>

namespace puckloop::faults {

namespace {
constexpr const char* kTables = R"(
create table if not exists notes(key text primary key, value text not null);
create table if not exists phases(phase text primary key);
create table if not exists cases(id integer primary key, phase text not null, sweep text not null,
    place text not null, seed text not null, faults text not null, pruned text not null, whole text not null);
create table if not exists results(id integer primary key references cases(id), outcome text not null,
    fired text not null, first_s real, recovery_s real, departure_m real, detail text not null,
    trace_sha256 text not null, whole text not null);
)";
}  // namespace

class Store::Statement {
  public:
    Statement(const Store& store, const char* sql) : store_(store) {
        if (sqlite3_prepare_v2(store.database_, sql, -1, &statement_, nullptr) != SQLITE_OK) store.fail();
    }
    ~Statement() { sqlite3_finalize(statement_); }
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    Statement& bind(const std::string& text) {
        sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
        return *this;
    }
    Statement& bind(int number) {
        sqlite3_bind_int(statement_, ++bound_, number);
        return *this;
    }
    Statement& bind(const nlohmann::json& number) {
        if (number.is_number())
            sqlite3_bind_double(statement_, ++bound_, number.get<double>());
        else
            sqlite3_bind_null(statement_, ++bound_);
        return *this;
    }
    bool next() {
        const int status = sqlite3_step(statement_);
        if (status != SQLITE_ROW && status != SQLITE_DONE) store_.fail();
        return status == SQLITE_ROW;
    }
    std::string text(int column) const {
        const auto* bytes = sqlite3_column_blob(statement_, column);
        const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
        return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
    }

  private:
    const Store& store_;
    sqlite3_stmt* statement_ = nullptr;
    int bound_ = 0;
};

Store::Store(const std::filesystem::path& file, Access access) : file_(file.string()) {
    const bool write = access == Access::Write;
    if (!write && !std::filesystem::exists(file))
        throw InputError(file_, "", "there is no campaign",
                         "the results folder of `puckloop faults campaign`");
    const int flags = write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
    try {
        if (sqlite3_open_v2(file_.c_str(), &database_, flags, nullptr) != SQLITE_OK) fail();
        sqlite3_busy_timeout(database_, 10'000);
        if (write)
            execute(kTables);
        else
            execute("select 1 from cases, results, notes limit 1");
    } catch (...) {
        sqlite3_close(database_);
        throw;
    }
}

Store::~Store() {
    sqlite3_close(database_);
}

void Store::fail() const {
    const int code = sqlite3_errcode(database_) & 0xFF;
    if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT || code == SQLITE_ERROR)
        throw InputError(file_, "", fmt::format("is no campaign's database: {}", sqlite3_errmsg(database_)),
                         "a file that `puckloop faults campaign` wrote");
    throw RunError(fmt::format("{}: {}; what it holds stays, the same command goes on from there", file_,
                               sqlite3_errmsg(database_)));
}

void Store::execute(const char* sql) const {
    if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

std::optional<std::string> Store::note(const std::string& key) const {
    Statement select(*this, "select value from notes where key = ?");
    if (!select.bind(key).next()) return std::nullopt;
    return select.text(0);
}

void Store::set_note(const std::string& key, const std::string& value) {
    Statement(*this, "insert or replace into notes values(?, ?)").bind(key).bind(value).next();
}

bool Store::planned(const std::string& phase) const {
    return Statement(*this, "select 1 from phases where phase = ?").bind(phase).next();
}

int Store::last_id() const {
    Statement select(*this, "select coalesce(max(id), 0) from cases");
    select.next();
    return std::stoi(select.text(0));
}

void Store::plan(const std::string& phase, const std::vector<Case>& cases) {
    execute("begin immediate");
    try {
        for (const Case& one : cases)
            Statement(*this, "insert into cases values(?, ?, ?, ?, ?, ?, ?, ?)")
                .bind(one.id)
                .bind(one.phase)
                .bind(one.sweep)
                .bind(one.place)
                .bind(std::to_string(one.seed))
                .bind(in_one_line(one.faults))
                .bind(one.pruned)
                .bind(to_json(one).dump())
                .next();
        Statement(*this, "insert into phases values(?)").bind(phase).next();
        execute("commit");
    } catch (...) {
        sqlite3_exec(database_, "rollback", nullptr, nullptr, nullptr);
        throw;
    }
}

std::vector<Case> Store::select(const char* sql, const std::string& phase) const {
    std::vector<Case> list;
    Statement rows(*this, sql);
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
    Statement(*this, "insert or ignore into results values(?, ?, ?, ?, ?, ?, ?, ?, ?)")
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
    Statement rows(*this, "select cases.whole, results.whole from results join cases using(id) order by id");
    while (rows.next())
        list.push_back({case_from_json(nlohmann::json::parse(rows.text(0))),
                        verdict_from_json(nlohmann::json::parse(rows.text(1)))});
    return list;
}

}  // namespace puckloop::faults
