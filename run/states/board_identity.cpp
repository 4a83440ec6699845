#include "run/states/board_identity.h"

#include "emu/avr/device.h"
#include "emu/image/avr_image.h"
#include "emu/image/image.h"

#include <nlohmann/json.hpp>

namespace puckloop::tools {

bool has_state(const nlohmann::json& spec) {
    const std::string kind = spec.at("kind");
    return kind == "pic" || kind == "rab" || kind == "tam";
}

cosim::BoardIdentity identity_of(const nlohmann::json& spec) {
    const std::string kind = spec.at("kind");
    const std::string firmware = spec.at("firmware");
    cosim::BoardIdentity board;
    board.node = spec.at("name");
    if (kind == "tam") {
        board.kind = "TAM board";
        board.chip = "ATmega1284P";
        board.image = image::load_avr_image(firmware, avr::atmega1284p().image_part()).sha256;
    } else {
        board.kind = kind == "pic" ? "e-puck main board" : "range-and-bearing board";
        board.chip = kind == "pic" ? "dsPIC30F6014A" : "dsPIC33FJ256GP710";
        board.image = image::load_image(firmware).sha256;
    }
    // Neither where the files are nor what is saved decides how the board runs.
    nlohmann::json parameters = spec;
    for (const char* key : {"kind", "name", "firmware", "log", "camera_log", "from_state", "save_state",
                            "pins_linked", "ir_linked", "stats"})
        parameters.erase(key);
    board.parameters = parameters.dump();
    return board;
}

}  // namespace puckloop::tools
