#pragma once
// What the client of a driven run reads and writes of a board: registers by their data-sheet names, variables
// by the image's symbols, memory by address of data space.

#include "debug/places.h"
#include "run/driven/driven_node.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace puckloop::tools {

class BoardAccess {
  public:
    /// `firmware`: its image, of an AVR or of a dsPIC. Throws InputError: it cannot be read.
    BoardAccess(DrivenNode& node, const std::string& firmware, bool avr);

    /// `request` has "register" (and "field"), "variable" or "memory" (and "bytes"). Throws InputError for
    /// what there is not.
    nlohmann::ordered_json read(const nlohmann::json& request) const;
    /// The same with "value", or "data" in hexadecimal.
    void write(const nlohmann::json& request);
    /// Where its program is: "pc", "place" ("main+0x12") and "line" ("main.c:43") where the image has them,
    /// "asleep", "instructions" around it, "registers" of the core, the top of the "stack"; "interrupts"
    /// since they are counted.
    nlohmann::ordered_json where() const;
    DrivenNode& node() { return node_; }
    /// Names are those of another image from now on; empty: of the one that the board began with.
    void use_image(const std::string& file);

  private:
    struct Place {
        std::uint32_t address = 0;  ///< as a debugger has it
        std::uint32_t bytes = 0;
    };
    Place variable(const std::string& name) const;
    Place place_of(const nlohmann::json& request) const;
    nlohmann::ordered_json read_register(std::string name) const;
    nlohmann::ordered_json read_field(const std::string& name, const std::string& field) const;
    void write_register(std::string name, std::uint64_t value);
    void write_bytes(std::uint32_t address, const std::vector<std::uint8_t>& bytes);

    void read_names(const std::string& file);
    nlohmann::ordered_json stack() const;
    nlohmann::ordered_json interrupts() const;

    struct Variable {
        std::uint32_t address = 0, bytes = 0;  ///< data address; bytes 0: the image does not say
    };
    DrivenNode& node_;
    std::string first_image_, image_;
    bool avr_;
    std::map<std::string, Variable> variables_;
    debug::Places places_;
};

}  // namespace puckloop::tools
