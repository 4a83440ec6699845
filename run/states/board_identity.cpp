#include "run/states/board_identity.h"

#include "emu/avr/devices/device.h"
#include "emu/image/avr_image.h"
#include "emu/image/image.h"

#include <set>
#include <stdexcept>

namespace puckloop::tools {

namespace {

cosim::BoardIdentity dspic_board(const std::string& firmware, const char* kind, const char* chip) {
    return {.node = {},
            .kind = kind,
            .chip = chip,
            .image = image::load_image(firmware).sha256,
            .parameters = {}};
}

struct Identity {
    cosim::BoardIdentity operator()(const MainBoard& main) const {
        return dspic_board(main.board.firmware, "e-puck main board", "dsPIC30F6014A");
    }
    cosim::BoardIdentity operator()(const rab::RabSpec& rab) const {
        return dspic_board(rab.firmware, "range-and-bearing board", "dsPIC33FJ256GP710");
    }
    cosim::BoardIdentity operator()(const tam::TamSpec& tam) const {
        const auto image = image::load_avr_image(tam.firmware, avr::atmega1284p().image_part());
        return {
            .node = {}, .kind = "TAM board", .chip = "ATmega1284P", .image = image.sha256, .parameters = {}};
    }
    cosim::BoardIdentity operator()(const auto& /*other*/) const { throw std::logic_error("no board"); }
};

/// Neither where files are nor what is saved decides how the board runs; its faults do.
JsonValue parameters_of(const NodeDescription& board) {
    JsonValue parameters = compared(board, Comparison::State);
    parameters.erase("kind");
    for (const cosim::NodeFault& fault : board.faults) {
        if (parameters.find("faults") == nullptr) parameters.set("faults", JsonValue::Array{});
        parameters.find("faults")->push(cosim::to_value(fault));
    }
    return parameters;
}

/// The same board with everything as it is by default.
NodeDescription standard(const NodeDescription& board) {
    return std::visit([]<class Kind>(const Kind&) { return NodeDescription{Kind{}}; }, board.kind);
}

}  // namespace

cosim::BoardIdentity identity_of(const NodeDescription& board) {
    cosim::BoardIdentity identity = std::visit(Identity{}, board.kind);
    NodeDescription copy = board;
    identity.node = board_fields(copy).name;
    identity.parameters = dump(parameters_of(board));
    return identity;
}

std::string other_parameters(const cosim::BoardIdentity& saved, const NodeDescription& board) {
    JsonValue before;
    try {
        before = parse_json(saved.parameters);
    } catch (const std::invalid_argument&) {
        // As of what is no object.
    }
    if (before.object() == nullptr) return "parameters";
    const JsonValue now = parameters_of(board), defaults = parameters_of(standard(board));
    std::set<std::string> names;
    for (const JsonMember& member : *now.object()) {
        const JsonValue* then = before.find(member.key);
        if (then == nullptr) then = defaults.find(member.key);
        if (then == nullptr || !(*then == member.value)) names.insert(member.key);
    }
    std::string list;
    for (const std::string& name : names)
        list += (list.empty() ? "" : ", ") + name;
    return list;
}

}  // namespace puckloop::tools
