#pragma once
// A scenario's tables as they are made here, with the lines of what they were made from, and as text.

#include "base/text/toml_file.h"

#include <string>
#include <vector>

namespace puckloop::argos {

/// A table that grows key by key.
class Tree {
  public:
    explicit Tree(int line) : line_(line) {}

    Tree& set(const std::string& key, TomlValue value);
    Tree& text(const std::string& key, const std::string& value);
    Tree& texts(const std::string& key, const std::vector<std::string>& values);
    Tree& number(const std::string& key, double value);
    Tree& integer(const std::string& key, std::int64_t value);
    Tree& flag(const std::string& key, bool value);
    /// With unit: "0.66 m".
    Tree& quantity(const std::string& key, double value, const char* unit);
    Tree& lengths(const std::string& key, const std::vector<double>& metres);
    Tree& table(const std::string& key, const Tree& tree) { return set(key, tree.value()); }
    /// One more table of the list [[key]].
    Tree& add(const std::string& key, const Tree& tree);

    TomlValue value() const;
    int line() const { return line_; }

  private:
    int line_;
    TomlTable table_;
};

/// "0.66 m": as short as it reads back the same.
std::string quantity_text(double value, const char* unit);
TomlValue list_of(const std::vector<TomlValue>& items, int line);
TomlValue text_value(const std::string& text, int line);

/// As a TOML file: plain keys first, then tables, in the order in which they were made.
std::string toml_text(const TomlValue& root);

}  // namespace puckloop::argos
