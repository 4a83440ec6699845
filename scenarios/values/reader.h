#pragma once
// Reads one table of a scenario key by key. Keys that nobody asked for are errors, with the nearest known key
// named.

#include "base/text/toml_file.h"
#include "scenarios/values/quantity.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::scenarios {

/// "line 7", or "line 7 of arena.toml" where a table is from an included file; empty where it is from none.
std::string place_of(const TomlValue& value);

class Reader {
  public:
    /// `where` names the table in messages ("robot 2", "arena"); `table` must outlive the reader.
    Reader(std::string file, std::string where, const TomlValue& table);

    bool has(std::string_view key);
    /// Whether it is there and a text.
    bool is_text(std::string_view key);
    int line_of(std::string_view key);

    /// The forms without a default throw InputError when the key is missing.
    double quantity(std::string_view key, Dimension dimension);
    double quantity(std::string_view key, Dimension dimension, double fallback);
    std::optional<double> optional_quantity(std::string_view key, Dimension dimension);
    /// A list of exactly `count` quantities.
    std::vector<double> quantities(std::string_view key, Dimension dimension, std::size_t count);
    /// A list of lists of exactly `count` quantities each.
    std::vector<std::vector<double>> quantity_lists(std::string_view key, Dimension dimension,
                                                    std::size_t count);
    /// A list of bare numbers, of any length; empty where absent.
    std::vector<double> bare_numbers(std::string_view key);
    /// A list of such lists.
    std::vector<std::vector<double>> bare_number_lists(std::string_view key);
    std::string text(std::string_view key);
    std::string text(std::string_view key, std::string_view fallback);
    std::int64_t integer(std::string_view key, std::int64_t fallback, std::int64_t low, std::int64_t high);
    bool flag(std::string_view key, bool fallback);
    std::vector<std::string> texts(std::string_view key);
    /// One of `choices`.
    std::string choice(std::string_view key, std::string_view fallback,
                       const std::vector<std::string>& choices);

    /// Sub-table, or nullptr where absent.
    const TomlValue* table(std::string_view key);
    /// [[key]] tables, in file order; empty where absent.
    std::vector<const TomlValue*> tables(std::string_view key);
    /// Every key of this table, as (key, value): for free-form tables such as parameters.
    const TomlTable& everything();

    /// Throws InputError at the first key that none of the calls above asked for.
    void finish() const;

    /// An InputError at `key` (or at the table's header if it is absent).
    [[noreturn]] void fail(std::string_view key, std::string_view problem, std::string_view expected = {});
    /// The same where the key is absent; one that is near to it is named.
    [[noreturn]] void fail_missing(std::string_view key, std::string_view expected = {});
    const std::string& file() const { return file_; }
    /// Of the file that the table is in: what paths in it are relative to.
    std::filesystem::path folder() const;

  private:
    const TomlValue* find(std::string_view key);
    const TomlValue& require(std::string_view key);
    [[noreturn]] void fail_unknown(std::string_view name, const TomlValue& value,
                                   const std::string& meant) const;
    [[noreturn]] void fail_at(const TomlValue& value, const std::string& problem,
                              std::string_view expected) const;
    double number(std::string_view key, const TomlValue& value, Dimension dimension);
    std::vector<double> numbers(std::string_view key, const TomlValue& value, Dimension dimension,
                                std::size_t count);
    const TomlArray& list(std::string_view key, const TomlValue& value);

    std::string file_;
    std::string where_;
    const TomlValue& table_;
    std::vector<std::string> asked_;
};

}  // namespace puckloop::scenarios
