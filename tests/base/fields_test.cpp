// Structs that list their fields: written, read, compared, as a table and as a schema, all by one list.

#include "base/error.h"
#include "base/fields/table.h"

#include <catch2/catch.hpp>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

using namespace puckloop;

namespace {

struct Bulb {
    double watts = 5.0;
    bool on = true;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("watts", &Bulb::watts, "taken").in("W").above(0),
                     field("on", &Bulb::on, "it shines").not_in(Comparison::State));
    }
};
static_assert(lists_all_fields<Bulb>);

struct Reversed {
    static JsonValue write(const std::string& text) { return std::string(text.rbegin(), text.rend()); }
    static void read(std::string& text, const JsonValue& from, const std::string& place) {
        from_value(text, from, place);
        text = write(text).text()->c_str();
    }
};

struct Lamp {
    std::string name;
    Bulb bulb{};
    std::vector<Bulb> spares{};
    std::optional<int> socket{};
    std::array<int, 2> pins{1, 2};
    std::map<std::string, double> levels{};
    std::string word{};
    int hidden = 0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("name", &Lamp::name, "in reports").required(), part(&Lamp::bulb),
                     field("spares", &Lamp::spares, "in the drawer"),
                     field("socket", &Lamp::socket, "number of its socket").within(0, 9),
                     field("pins", &Lamp::pins, "of the socket").within(0, 40),
                     field("levels", &Lamp::levels, "by name").not_in(Comparison::Run),
                     field("word", &Lamp::word, "backwards").as<Reversed>(), unlisted(&Lamp::hidden));
    }
};
static_assert(lists_all_fields<Lamp>);

/// One whose list lacks a member: the last one, or one of many that are alike.
struct Short {
    double a = 0, b = 0, c = 0;
    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("a", &Short::a, "first"), field("c", &Short::c, "third"));
    }
};
static_assert(!lists_all_fields<Short>);
struct Shorter {
    std::string a;
    std::optional<Bulb> b{};
    bool c = false;
    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("a", &Shorter::a, "first"), field("b", &Shorter::b, "second"));
    }
};
static_assert(!lists_all_fields<Shorter>);

Lamp read(const std::string& text) {
    Lamp lamp;
    from_value(lamp, parse_json(text), "lamp");
    return lamp;
}

}  // namespace

TEST_CASE("what a list writes it reads") {
    Lamp lamp{.name = "desk"};
    lamp.bulb = {0.1, false};
    lamp.spares = {{}, {40.0, true}};
    lamp.socket = 3;
    lamp.pins = {7, 8};
    lamp.levels = {{"low", 0.25}};
    lamp.word = "abc";
    lamp.hidden = 5;
    const std::string text = dump(to_value(lamp));
    CHECK(text == R"({"name":"desk","watts":0.1,"on":false,"spares":[{"watts":5.0,"on":true},)"
                  R"({"watts":40.0,"on":true}],"socket":3,"pins":[7,8],"levels":{"low":0.25},"word":"cba"})");
    const Lamp back = read(text);
    CHECK(dump(to_value(back)) == text);
    CHECK(back.word == "abc");
    CHECK(back.hidden == 0);
}

TEST_CASE("what is not there has its default") {
    const Lamp lamp = read(R"({"name": "desk"})");
    CHECK(lamp.bulb.watts == 5.0);
    CHECK(!lamp.socket);
    CHECK(read(R"({"name": "desk", "watts": 12})").bulb.watts == 12.0);
}

TEST_CASE("what does not fit is refused with its place") {
    const auto refuse = [](const char* text, const char* message) { CHECK_THROWS_WITH(read(text), message); };
    refuse("{}", "lamp: has no name");
    refuse("3", "lamp: has the wrong type: 3");
    refuse(R"({"name": "x", "wats": 1})", "lamp.wats: unknown key");
    refuse(R"({"name": "x", "watts": "1"})", "lamp.watts: has the wrong type: \"1\"");
    refuse(R"({"name": "x", "watts": 0})", "lamp.watts: must be above 0 W");
    refuse(R"({"name": "x", "socket": 10})", "lamp.socket: must be 0 to 9");
    refuse(R"({"name": "x", "socket": 1.5})", "lamp.socket: has the wrong type: 1.5");
    refuse(R"({"name": "x", "pins": [1]})", "lamp.pins: has the wrong type: [1]");
    refuse(R"({"name": "x", "pins": [1, 41]})", "lamp.pins: must be 0 to 40");
    refuse(R"({"name": "x", "spares": [{}, {"watts": -1}]})", "lamp.spares[1].watts: must be above 0 W");
    refuse(R"({"name": "x", "levels": {"low": true}})", "lamp.levels.low: has the wrong type: true");
}

TEST_CASE("integers keep all their digits") {
    JsonValue value;
    value.set("big", ~std::uint64_t{0});
    value.set("small", std::numeric_limits<std::int64_t>::min());
    const JsonValue back = parse_json(dump(value));
    CHECK(back.find("big")->uint64() == ~std::uint64_t{0});
    CHECK(back.find("small")->int64() == std::numeric_limits<std::int64_t>::min());
    CHECK(back == value);
    CHECK(JsonValue(3) == JsonValue(3u));
    CHECK_THROWS_AS(parse_json("{"), std::invalid_argument);
}

TEST_CASE("a comparison leaves out what it does not ask") {
    JsonValue state, run;
    write_compared(Lamp{.name = "x"}, Comparison::State, state);
    write_compared(Lamp{.name = "x"}, Comparison::Run, run);
    CHECK(state.find("on") == nullptr);
    CHECK(state.find("levels") != nullptr);
    CHECK(run.find("on") != nullptr);
    CHECK(run.find("levels") == nullptr);
}

TEST_CASE("a table has key, unit, range, default and sentence of each field") {
    const std::vector<FieldRow> rows = rows_of<Lamp>();
    REQUIRE(rows.size() == 8);
    CHECK(rows[0].standard == "required");
    CHECK(rows[1].key == "watts");
    CHECK(rows[1].type == "number");
    CHECK(rows[1].unit == "W");
    CHECK(rows[1].range == "above 0");
    CHECK(rows[1].standard == "5");
    CHECK(rows[4].standard == "none");
    CHECK(rows[4].range == "0 to 9");
    CHECK_THAT(markdown_table(rows), Catch::Contains("| `watts` | number | W | above 0 | 5 | taken |\n"));
}

TEST_CASE("a schema accepts by the same list") {
    const JsonValue schema = schema_of<Lamp>();
    CHECK(dump(*schema.find("required")) == R"(["name"])");
    CHECK(*schema.find("additionalProperties")->boolean() == false);
    const JsonValue& properties = *schema.find("properties");
    CHECK(dump(*properties.find("watts")) ==
          R"json({"type":"number","description":"taken (W)","exclusiveMinimum":0.0,"default":5.0})json");
    CHECK(dump(*properties.find("socket")) ==
          R"({"type":"integer","description":"number of its socket","minimum":0.0,"maximum":9.0})");
    CHECK(dump(*properties.find("pins")->find("items")) ==
          R"({"type":"integer","minimum":0.0,"maximum":40.0})");
    CHECK(properties.find("hidden") == nullptr);
    CHECK(*properties.find("spares")->find("items")->find("type")->text() == "object");
}
