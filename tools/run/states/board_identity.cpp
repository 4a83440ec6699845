#include "tools/run/states/board_identity.h"

#include "emu/image/image.h"

#include <nlohmann/json.hpp>

namespace puckloop::tools {

bool has_state(const nlohmann::json& spec) {
    const std::string kind = spec.at("kind");
    return kind == "pic" || kind == "rab";
}

cosim::BoardIdentity identity_of(const nlohmann::json& spec) {
    const bool pic = spec.at("kind") == "pic";
    cosim::BoardIdentity board;
    board.node = spec.at("name");
    board.kind = pic ? "e-puck main board" : "range-and-bearing board";
    board.chip = pic ? "dsPIC30F6014A" : "dsPIC33FJ256GP710";
    board.image = image::load_image(spec.at("firmware").get<std::string>()).sha256;
    // Neither where the files are nor what is saved decides how the board runs.
    nlohmann::json parameters = spec;
    for (const char* key : {"kind", "name", "firmware", "log", "from_state", "save_state"})
        parameters.erase(key);
    board.parameters = parameters.dump();
    return board;
}

}  // namespace puckloop::tools
