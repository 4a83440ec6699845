#pragma once
// A TOML file as a plain tree with line numbers: what readers of scenarios and options walk.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace puckloop {

struct TomlValue;
using TomlArray = std::vector<TomlValue>;
/// Sorted by key.
using TomlTable = std::vector<std::pair<std::string, TomlValue>>;

struct TomlValue {
    std::variant<bool, std::int64_t, double, std::string, TomlArray, TomlTable> data;
    int line = 0;  ///< 1-based; of a table: its header
    /// The file that it is from, where that is not the one that was read first (an included one).
    std::shared_ptr<const std::string> source{};

    bool is_table() const { return std::holds_alternative<TomlTable>(data); }
    bool is_array() const { return std::holds_alternative<TomlArray>(data); }
    bool is_string() const { return std::holds_alternative<std::string>(data); }
};

/// Reads and parses a file; dates and times are refused. Throws InputError with the line.
TomlValue read_toml(const std::filesystem::path& file);

}  // namespace puckloop
