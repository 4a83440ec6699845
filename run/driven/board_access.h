#pragma once
// What the client of a driven run reads and writes of a board: registers by their data-sheet names, variables
// by the image's symbols, memory by address of data space.

#include "base/json.h"
#include "run/chips/chip_values.h"
#include "run/driven/driven_node.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::tools {

class BoardAccess {
  public:
    /// `firmware`: its image. Throws InputError: it cannot be read.
    BoardAccess(DrivenNode& node, const std::string& firmware);

    /// `request` has "register" (and "field"), "variable" or "memory" (and "bytes"). Throws InputError for
    /// what there is not.
    nlohmann::ordered_json read(const nlohmann::json& request) const { return values_.read(request); }
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
    void write_register(const std::string& name, std::uint64_t value);
    void write_bytes(std::uint32_t address, const std::vector<std::uint8_t>& bytes);
    nlohmann::ordered_json stack() const;
    nlohmann::ordered_json interrupts() const;

    DrivenNode& node_;
    std::string first_image_;
    ChipValues values_;
};

}  // namespace puckloop::tools
