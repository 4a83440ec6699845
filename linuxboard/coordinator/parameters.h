#pragma once
// Parameters of the program and of experiments: each has one line in a table, and is set by an option of the
// command line (--dead-time 10) or by a key of a TOML file (dead_time = 10); the command line wins.

#include "linuxboard/coordinator/color.h"

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::coordinator {

struct Parameter {
    const char* name;      ///< as an option, without "--"
    const char* fallback;  ///< values separated by commas; null: a switch, off
    const char* help;      ///< with the unit
};

class Parameters {
  public:
    /// A value of a parameter; it replaces what was there if `place` is of the command line, or nothing was.
    /// `values` empty: a switch that is on.
    void set(const std::string& name, std::vector<std::string> values, std::string file, std::string place);
    /// All keys of a TOML file. Throws InputError.
    void read_file(const std::string& file);
    /// All options of a command line; also the file of --config. Throws InputError.
    void read_options(std::span<const char* const> words);
    /// The parameters there are. Throws InputError if another one was set.
    void declare(std::vector<std::span<const Parameter>> tables);

    bool given(const std::string& name) const { return set_.contains(name); }
    /// The value as it was set, or empty; for what decides on the tables.
    std::string first(const std::string& name) const;
    bool flag(const std::string& name) const;
    std::string text(const std::string& name) const;
    double number(const std::string& name, double low, double high) const;
    std::uint64_t whole(const std::string& name) const;
    std::vector<std::string> list(const std::string& name) const;
    std::vector<double> numbers(const std::string& name, double low, double high) const;
    Color color(const std::string& name) const;
    std::vector<Color> colors(const std::string& name) const;
    /// Throws InputError with the place at which `name` was set.
    [[noreturn]] void fail(const std::string& name, const std::string& problem,
                           const std::string& expected) const;

  private:
    struct Value {
        std::vector<std::string> values;
        std::string file, place;
    };
    const Parameter& declared(const std::string& name) const;
    double parse_number(const std::string& name, const std::string& text, double low, double high) const;
    Color parse(const std::string& name, const std::string& text) const;

    std::map<std::string, Value> set_;
    std::vector<std::span<const Parameter>> tables_;
};

/// Lines of a --help about the parameters of a table.
std::string help_of(std::span<const Parameter> table);

}  // namespace puckloop::coordinator
