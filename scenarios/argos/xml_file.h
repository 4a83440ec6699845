#pragma once
// An XML file with lines: elements, attributes that must be there, numbers. Every error names file and line.

#include <filesystem>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::argos {

/// What is not taken over from a file, or is taken over in another way.
struct Note {
    int line = 0;
    std::string text;
};

class XmlFile {
  public:
    /// Reads and parses; at most 16 MB. Throws InputError with the line of what is malformed.
    explicit XmlFile(const std::filesystem::path& file);

    pugi::xml_node root() const { return document_.document_element(); }
    const std::string& name() const { return name_; }
    int line_of(pugi::xml_node node) const;

    [[noreturn]] void fail(pugi::xml_node node, const std::string& problem,
                           std::string_view expected = {}) const;

    /// Throws where it is missing.
    std::string text(pugi::xml_node node, const char* attribute) const;
    std::string text(pugi::xml_node node, const char* attribute, std::string_view fallback) const;
    /// Finite and at most 1e6 in size. Without a fallback it must be there.
    double number(pugi::xml_node node, const char* attribute, std::optional<double> fallback = {}) const;
    long long integer(pugi::xml_node node, const char* attribute, long long low, long long high,
                      std::optional<long long> fallback = {}) const;
    bool flag(pugi::xml_node node, const char* attribute, bool fallback) const;
    /// Exactly `count` numbers, separated by commas.
    std::vector<double> numbers(pugi::xml_node node, const char* attribute, std::size_t count,
                                std::optional<std::vector<double>> fallback = {}) const;

    /// Noted once for each line and text.
    void note(pugi::xml_node node, const std::string& text);
    const std::vector<Note>& notes() const { return notes_; }

  private:
    std::string name_;
    pugi::xml_document document_;
    std::vector<std::size_t> line_ends_;  // offsets
    std::vector<Note> notes_;
};

/// "<box>", or "<box> 'wall_1'" where it has an id.
std::string described(pugi::xml_node node);

}  // namespace puckloop::argos
