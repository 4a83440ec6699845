// Every kind of node as its process gets it: by one list of fields per kind.

#include "base/error.h"
#include "base/fields/table.h"
#include "run/description/node_description.h"

#include <catch2/catch.hpp>

#include <set>
#include <string>
#include <utility>

using namespace puckloop;
using namespace puckloop::tools;

namespace {

template <class Do, std::size_t... I>
void for_each_kind(Do&& work, std::index_sequence<I...> /*all*/) {
    (work(std::variant_alternative_t<I, NodeKind>{}), ...);
}
template <class Do>
void for_each_kind(Do&& work) {
    for_each_kind(work, std::make_index_sequence<std::variant_size_v<NodeKind>>{});
}

cosim::FaultSpec fault(const std::string& kind) {
    cosim::FaultSpec spec;
    spec.kind = kind;
    spec.name = "f";
    spec.node = "n";
    spec.position = 7;
    spec.burst = cosim::Burst{0.1, 0.2, 0.3, 0.4};
    spec.set("volts", 0.25).set("pc", "main");
    return spec;
}

}  // namespace

TEST_CASE("every kind of node comes back from its process's text as it was") {
    std::set<std::string_view> kinds;
    for_each_kind([&]<class Kind>(Kind kind) {
        INFO(Kind::kKind);
        kinds.insert(Kind::kKind);
        NodeDescription node{std::move(kind)};
        node.faults = {{fault("sag"), 5, 3}, {fault("reset"), 5, 4}};
        const std::string text = encode(node);
        const NodeDescription back = decode(text);
        CHECK(std::holds_alternative<Kind>(back.kind));
        CHECK(encode(back) == text);
        REQUIRE(back.faults.size() == 2);
        CHECK(back.faults[0].spec == node.faults[0].spec);
        CHECK(back.faults[1].index == 4);
        CHECK(kind_name(back) == Kind::kKind);
    });
    CHECK(kinds.size() == std::variant_size_v<NodeKind>);
}

TEST_CASE("what is set in a description arrives") {
    MainBoard main;
    main.board.name = "robot0.pic";
    main.board.adc_noise = 0.75;
    main.board.phototransistor_noise = 1.0;
    main.board.resets = {1.5, 2.25};
    main.board.errata = {"one"};
    main.board.can = 3;
    main.camera = BoardCamera{.model = "po3030k", .turned = true, .robot = 2};
    NodeDescription node{main};
    node.care.from_state = FromState{.path = "/x.state", .board = "robot1.pic"};
    node.care.save_state = SaveState{"/y.state", 12'345'678'901'234'567};
    node.care.stats = true;
    const NodeDescription back = decode(encode(node));
    const auto& board = std::get<MainBoard>(back.kind);
    CHECK(board.board.phototransistor_noise == 1.0);
    CHECK(board.board.resets == main.board.resets);
    CHECK(board.board.can == 3);
    REQUIRE(board.camera);
    CHECK(board.camera->turned);
    CHECK(board.camera->robot == 2);
    CHECK(back.care.from_state->board == "robot1.pic");
    CHECK(back.care.save_state->at == 12'345'678'901'234'567);
    CHECK(back.care.stats);
    CHECK(back.care.gdb.empty());
}

TEST_CASE("times in seconds come back to the picosecond") {
    LinuxProgram program;
    for (const double seconds : {0.1, 1.0 / 3, 2251.7, 86'400.123456789012, 2'592'000.1}) {
        program.program.start = cosim::from_seconds(seconds);
        const auto back = decode(encode({program}));
        CHECK(std::get<LinuxProgram>(back.kind).program.start == program.program.start);
    }
}

TEST_CASE("a description with a key that its kind has not is refused") {
    CHECK_THROWS_WITH(decode(R"({"kind": "tam", "node": {"name": "t", "firmware": "f", "netwrok": 2}})"),
                      "tam.netwrok: unknown key");
    CHECK_THROWS_WITH(decode(R"({"kind": "tam", "node": {"name": "t", "firmware": "f", "network": 4}})"),
                      "tam.network: must be 0 to 3");
    CHECK_THROWS_WITH(decode(R"({"kind": "tam", "node": {"name": "t"}})"), "tam: has no firmware");
    CHECK_THROWS_WITH(decode(R"({"kind": "tram", "node": {}})"), "node: unknown kind 'tram'");
    CHECK_THROWS_AS(decode("[]"), InputError);
    CHECK_THROWS_AS(decode("{"), InputError);
}

TEST_CASE("every field has one key, a sentence, and a default within its range") {
    for_each_kind([]<class Kind>(Kind) {
        std::set<std::string> keys;
        for (const FieldRow& row : rows_of<Kind>()) {
            INFO(Kind::kKind << "." << row.key);
            CHECK(keys.insert(row.key).second);
            CHECK(row.about.size() > 3);
        }
        Kind standard{};
        JsonValue all = to_value(standard);
        CHECK_NOTHROW(from_value(standard, all, "standard"));
        CHECK(schema_of<Kind>().find("properties")->object()->size() == keys.size());
    });
}

TEST_CASE("only what decides what a node does is compared") {
    MainBoard main;
    main.board.name = "robot0.pic";
    const JsonValue state = compared({main}, Comparison::State), run = compared({main}, Comparison::Run);
    for (const char* key : {"name", "firmware", "log", "camera_log"})
        CHECK(state.find(key) == nullptr);
    CHECK(state.find("nvm") != nullptr);
    CHECK(run.find("nvm") == nullptr);
    CHECK(run.find("name") != nullptr);
}
