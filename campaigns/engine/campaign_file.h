#pragma once
// A campaign as its file describes it (docs/faults.md).

#include "base/json.h"
#include "base/text/toml_file.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::faults {

/// What counts as mission: the length of a robot's path, or a number of report.json.
struct Metric {
    std::string name;
    std::string robot;       ///< its path in m; empty: `value` or `log`
    std::string value;       ///< JSON pointer into report.json; empty: `robot` or `log`
    double tolerance = 0.0;  ///< in the metric's unit, or a share of the nominal value
    bool relative = false;
    std::string log{}, lines{};  ///< in place of both: lines of a program's log that hold this text
};

/// When a run is not like the nominal one. Times in s.
struct Limits {
    double silence = 1.0;
    double pause = 0.02;
    int resets = 3;
    double departure = 0.005;  ///< m
};

/// A grid of faults.
struct Sweep {
    std::string name;
    nlohmann::json fault;                                                   ///< keys of a [[fault]] table
    std::vector<std::pair<std::string, std::vector<nlohmann::json>>> over;  ///< in the order of their names
    std::vector<std::string> times;                                         ///< values of `begin`
    bool positions = false;                                                 ///< `byte` is given
    std::optional<std::vector<int>> bytes;                                  ///< of a record; none: all
    std::vector<int> records;                                               ///< counted from 0
    double after = 0.0;                                                     ///< s: where counting begins
    int line = 0;
};

struct Campaign {
    std::filesystem::path file;
    std::filesystem::path scenario;
    std::optional<double> duration;  ///< s
    std::vector<std::string> firmware;
    std::vector<std::string> program;
    std::vector<std::uint64_t> seeds;
    std::size_t cases = 2000;
    std::size_t pairs = 0;
    std::uint64_t sample_seed = 1;
    Limits limits;
    std::vector<Metric> metrics;
    std::vector<Sweep> sweeps;
    std::map<std::string, std::string> environment;  ///< the variables that it names
};

/// Throws InputError with file and line.
Campaign read_campaign(const std::filesystem::path& file);

nlohmann::json to_json(const TomlValue& value);
/// Every value has line `line`.
TomlValue to_toml(const nlohmann::json& value, int line);

}  // namespace puckloop::faults
