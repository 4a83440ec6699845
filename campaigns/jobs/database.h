#pragma once
// An SQLite file of a campaign or experiment: each result committed when it comes.

#include "base/json.h"

#include <filesystem>
#include <optional>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace puckloop::jobs {

class Database {
  public:
    enum class Access { Read, Write };

    struct Form {
        const char* what;     ///< "campaign", in messages
        const char* command;  ///< that writes it
        const char* tables;   ///< SQL that makes them where they are not there; `notes` is made by itself
        const char* probe;    ///< SQL that fails where they are not there
    };

    /// Opens or, with Write, makes it. InputError if it is another file; RunError if the disk does not take
    /// it.
    Database(const std::filesystem::path& file, Access access, const Form& form);
    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    void execute(const char* sql) const;
    /// All of `work`, or nothing of it if it throws.
    template <typename Work>
    void transaction(Work work) const {
        execute("begin immediate");
        try {
            work();
            execute("commit");
        } catch (...) {
            roll_back();
            throw;
        }
    }

    std::optional<std::string> note(const std::string& key) const;
    void set_note(const std::string& key, const std::string& value) const;

  private:
    friend class Statement;
    [[noreturn]] void fail() const;
    void roll_back() const;

    std::string file_;
    Form form_;
    sqlite3* database_ = nullptr;
};

class Statement {
  public:
    Statement(const Database& database, const char* sql);
    ~Statement();
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    Statement& bind(const std::string& text);
    Statement& bind(int number);
    Statement& bind(const nlohmann::json& number);  ///< null unless it is a number
    bool next();                                    ///< whether there is a row
    std::string text(int column) const;

  private:
    const Database& database_;
    sqlite3_stmt* statement_ = nullptr;
    int bound_ = 0;
};

}  // namespace puckloop::jobs
