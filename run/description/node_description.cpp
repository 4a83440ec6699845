#include "run/description/node_description.h"

#include "base/error.h"

#include <fmt/format.h>

#include <stdexcept>
#include <type_traits>

namespace puckloop::tools {

namespace {

/// The alternative whose name is `kind`, with its defaults. False: there is none.
template <std::size_t I = 0>
bool make_kind(std::string_view kind, NodeKind& node) {
    if constexpr (I < std::variant_size_v<NodeKind>) {
        if (std::variant_alternative_t<I, NodeKind>::kKind != kind) return make_kind<I + 1>(kind, node);
        node.emplace<I>();
        return true;
    } else {
        return false;
    }
}

template <class Board>
BoardFields fields_of(Board& board) {
    std::string* nvm = nullptr;
    if constexpr (requires { board.nvm; }) nvm = &board.nvm;
    return {board.name, board.firmware, board.seed, board.log, nvm};
}

}  // namespace

JsonValue EventsForm::write(const physics::EventPlan& events) {
    return parse_json(physics::to_json(events));
}

void EventsForm::read(physics::EventPlan& events, const JsonValue& from, const std::string& /*place*/) {
    events = physics::plan_from_json(dump(from));
}

std::string_view kind_name(const NodeDescription& node) {
    return std::visit([]<class Kind>(const Kind&) { return Kind::kKind; }, node.kind);
}

bool has_board(const NodeDescription& node) {
    return std::visit([]<class Kind>(const Kind&) { return is_board<Kind>; }, node.kind);
}

BoardFields board_fields(NodeDescription& node) {
    if (auto* main = std::get_if<MainBoard>(&node.kind)) return fields_of(main->board);
    if (auto* rab = std::get_if<rab::RabSpec>(&node.kind)) return fields_of(*rab);
    return fields_of(std::get<tam::TamSpec>(node.kind));
}

NodeDescription without_files(NodeDescription node) {
    BoardFields board = board_fields(node);
    board.log.clear();
    if (board.nvm != nullptr) board.nvm->clear();
    return node;
}

std::string encode(const NodeDescription& node) {
    JsonValue text;
    text.set("kind", JsonValue(std::string(kind_name(node))));
    JsonValue fields = std::visit([](const auto& kind) { return to_value(kind); }, node.kind);
    text.set("node", std::move(fields));
    for (const cosim::NodeFault& fault : node.faults) {
        if (text.find("faults") == nullptr) text.set("faults", JsonValue::Array{});
        text.find("faults")->push(cosim::to_value(fault));
    }
    if (has_board(node)) text.set("care", to_value(node.care));
    return dump(text);
}

NodeDescription decode(std::string_view text) {
    try {
        const JsonValue all = parse_json(text);
        const JsonValue *kind = all.find("kind"), *fields = all.find("node");
        NodeDescription node{};
        if (kind == nullptr || kind->text() == nullptr || fields == nullptr)
            throw std::invalid_argument("no kind of node");
        if (!make_kind(*kind->text(), node.kind))
            throw InputError("", "node", fmt::format("unknown kind '{}'", *kind->text()));
        std::visit([&](auto& one) { from_value(one, *fields, *kind->text()); }, node.kind);
        if (const JsonValue* faults = all.find("faults")) node.faults = cosim::node_faults(*faults);
        if (const JsonValue* care = all.find("care")) from_value(node.care, *care, *kind->text());
        return node;
    } catch (const std::invalid_argument& error) {
        throw InputError("", "node description", error.what());
    }
}

JsonValue compared(const NodeDescription& node, Comparison comparison) {
    JsonValue object = JsonValue::Object{};
    object.set("kind", JsonValue(std::string(kind_name(node))));
    std::visit([&](const auto& kind) { write_compared(kind, comparison, object); }, node.kind);
    return object;
}

}  // namespace puckloop::tools
