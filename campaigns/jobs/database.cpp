#include "campaigns/jobs/database.h"

#include "base/error.h"

#include <fmt/format.h>
#include <sqlite3.h>

namespace puckloop::jobs {

Database::Database(const std::filesystem::path& file, Access access, const Form& form)
    : file_(file.string()), form_(form) {
    const bool write = access == Access::Write;
    if (!write && !std::filesystem::exists(file))
        throw InputError(file_, "", fmt::format("there is no {}", form.what),
                         fmt::format("the results folder of `{}`", form.command));
    const int flags = write ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
    try {
        if (sqlite3_open_v2(file_.c_str(), &database_, flags, nullptr) != SQLITE_OK) fail();
        sqlite3_busy_timeout(database_, 10'000);
        if (write) {
            execute("create table if not exists notes(key text primary key, value text not null)");
            execute(form.tables);
        } else {
            execute("select 1 from notes limit 1");
            execute(form.probe);
        }
    } catch (...) {
        sqlite3_close(database_);
        throw;
    }
}

Database::~Database() {
    sqlite3_close(database_);
}

void Database::fail() const {
    const int code = sqlite3_errcode(database_) & 0xFF;
    if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT || code == SQLITE_ERROR)
        throw InputError(file_, "",
                         fmt::format("is no {}'s database: {}", form_.what, sqlite3_errmsg(database_)),
                         fmt::format("a file that `{}` wrote", form_.command));
    throw RunError(fmt::format("{}: {}; what it holds stays, the same command goes on from there", file_,
                               sqlite3_errmsg(database_)));
}

void Database::execute(const char* sql) const {
    if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

void Database::roll_back() const {
    sqlite3_exec(database_, "rollback", nullptr, nullptr, nullptr);
}

std::optional<std::string> Database::note(const std::string& key) const {
    Statement select(*this, "select value from notes where key = ?");
    if (!select.bind(key).next()) return std::nullopt;
    return select.text(0);
}

void Database::set_note(const std::string& key, const std::string& value) const {
    Statement(*this, "insert or replace into notes values(?, ?)").bind(key).bind(value).next();
}

Statement::Statement(const Database& database, const char* sql) : database_(database) {
    if (sqlite3_prepare_v2(database.database_, sql, -1, &statement_, nullptr) != SQLITE_OK) database.fail();
}

Statement::~Statement() {
    sqlite3_finalize(statement_);
}

Statement& Statement::bind(const std::string& text) {
    sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
    return *this;
}

Statement& Statement::bind(int number) {
    sqlite3_bind_int(statement_, ++bound_, number);
    return *this;
}

Statement& Statement::bind(const nlohmann::json& number) {
    if (number.is_number())
        sqlite3_bind_double(statement_, ++bound_, number.get<double>());
    else
        sqlite3_bind_null(statement_, ++bound_);
    return *this;
}

bool Statement::next() {
    const int status = sqlite3_step(statement_);
    if (status != SQLITE_ROW && status != SQLITE_DONE) database_.fail();
    return status == SQLITE_ROW;
}

std::string Statement::text(int column) const {
    const auto* bytes = sqlite3_column_blob(statement_, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return bytes == nullptr ? std::string() : std::string(static_cast<const char*>(bytes), size);
}

}  // namespace puckloop::jobs
