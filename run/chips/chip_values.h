#pragma once
// What is read of a board's chip by name: registers by their data-sheet names, variables by the image's
// symbols, memory by address of data space.

#include "debug/debug_chip.h"
#include "debug/places.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <map>
#include <string>

namespace puckloop::tools {

class ChipValues {
  public:
    static constexpr std::uint32_t kDataBytes = 0x10000;  ///< of data space

    /// `node` is what errors name; `firmware`: its image; the chip must outlive this.
    /// Throws InputError: it cannot be read.
    ChipValues(const debug::DebugChip& chip, std::string node, const std::string& firmware);

    /// Names are those of another image from now on.
    void use_image(const std::string& file);
    const std::string& image() const { return image_; }
    const debug::Places& places() const { return places_; }

    /// `request` has "register" (and "field"), "variable" or "memory" (and "bytes"); the reply "value" and
    /// what describes it. Throws InputError for what there is not.
    nlohmann::ordered_json read(const nlohmann::json& request) const;
    /// Any letters' case.
    nlohmann::ordered_json read_register(std::string name) const;

    struct Place {
        std::uint32_t address = 0;  ///< as a debugger has it
        std::uint32_t bytes = 0;
    };
    /// Of a variable or memory. Throws InputError.
    Place place_of(const nlohmann::json& request) const;

  private:
    Place variable(const std::string& name) const;
    nlohmann::ordered_json read_field(const std::string& name, const std::string& field) const;

    struct Variable {
        std::uint32_t address = 0, bytes = 0;  ///< data address; bytes 0: the image does not say
    };
    const debug::DebugChip& chip_;
    std::string node_, image_;
    std::map<std::string, Variable> variables_;
    debug::Places places_;
};

}  // namespace puckloop::tools
